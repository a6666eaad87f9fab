"""The covariance of some of an estimate's parameters, for what is made of them."""

import numpy as np
import pytest

from spear_pin.errors import UnknownName
from spear_pin.studies.identification import identify
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import WITH_MOTOR, spear_ii


def test_it_is_in_the_order_of_the_names():
    leg = spear_ii(15.0)
    found = identify(leg, [synthetic_trial(leg, WITH_MOTOR, 0.1, 0.003, np.random.default_rng(0))])
    names = ["rest_angle", "stiffness"]
    covariance = found.covariance_of(names)
    assert np.sqrt(np.diag(covariance)) == pytest.approx([found[name].deviation for name in names], rel=1e-12)
    labels = [parameter.name for parameter in found.parameters]
    i, j = (labels.index(name) for name in names)
    scale = found["rest_angle"].deviation * found["stiffness"].deviation
    assert covariance[0, 1] == covariance[1, 0] == pytest.approx(found.correlation[i, j] * scale)
    with pytest.raises(UnknownName, match="coulomb"):
        found.covariance_of(["coulomb"])
