"""The leg that is released, from where, and when it is looked at."""

import numpy as np

from spear_pin.studies.push_test import spear_ii

LEG = spear_ii()
START = 1.8  # a spring that only pulls from 1.1 rad on then becomes slack
TIMES = np.linspace(0.0, 1.2, 241)
