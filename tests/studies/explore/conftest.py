"""No time limit on the way to a gait: a slow machine finds what a fast one finds."""

import math

import pytest

from spear_pin.studies.explore import carried


@pytest.fixture(scope="module", autouse=True)
def no_time_limit():
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(carried, "PATIENCE", math.inf)
        yield
