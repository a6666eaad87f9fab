"""Inputs of event feedback: what counts as one, and the largest change."""

import pytest

from spear_pin import Gait, HoppingLaw, hopping, load, monopod
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.inputs import ANGLE, Input, inputs_of, list_inputs
from spear_pin.model.scale import scale_of


def test_as_listed():
    system = Gait.load("trot").system
    assert inputs_of(system, ("posterior_squeeze", "anterior_leg_touchdown")) == [Input(10.0, 30.0, True), ANGLE]
    assert list_inputs(system.law)["anterior_spread"] == Input(0.05, 0.3)
    assert list_inputs(object()) == {}


@pytest.mark.extra("example-robot-data")
def test_torques_go_by_size():
    leg = monopod(load("solo12", base="free", motors="all"), "FL", locked=["boom_x"])
    system, ratio = hopping(leg, HoppingLaw.scaled(leg)), scale_of(leg).torque
    torque, angle = inputs_of(system, ("stance_torque", "hip_touchdown"))
    assert 0.0 < ratio < 0.5 and torque == Input(2.0 * ratio, 4.0 * ratio, True) and angle == ANGLE


def test_what_is_not_listed_counts_by_its_value():
    system = hopping(load("spear_ii", locked=["boom_x"]))
    assert inputs_of(system, ("frequency", "knee_touchdown")) == [Input(0.25 * 2.56, 0.5 * 2.56), ANGLE]
    with pytest.raises(BadValue, match="other than zero"):
        inputs_of(system, ("hip_stance_torque",))
    with pytest.raises(UnknownName, match="thrust"):
        inputs_of(system, ("thrust",))
