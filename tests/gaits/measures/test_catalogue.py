"""The table of names: every measure is in it once, with the unit that it has."""

import pytest

from spear_pin.errors import UnknownName
from spear_pin.gaits.measures.catalogue import CATALOGUE, describe_measure, unit_on
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.model.unit_masses import unit_masses
from tests.gaits.bounding_gaits import gait, trajectory


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        ("stance_time", "s"),
        ("apex_height", "m"),
        ("knee_at_touchdown", "rad"),
        ("posterior_knee_rate_at_posterior_touchdown", "rad/s"),
        ("greatest_height_toe", "m"),
        ("greatest_knee", "rad"),
        ("peak_torque_posterior_hip", "N·m"),
        ("cost_of_transport", "1"),
        ("effort_per_distance", "N²·m·s"),
        ("electricity", "J"),
        ("electricity_knee", "J"),
        ("multiplier_3", "1"),
    ],
)
def test_units(name, unit):
    assert describe_measure(name).unit == unit


def test_what_samples_give_is_in_it():
    found = Sampled(gait("long_stride").system.robot, trajectory("long_stride")).values()
    assert {describe_measure(name).pattern for name in found} >= {"effort", "cost_of_transport", "friction_used_TOE"}


def test_each_says_what_it_is_in_a_sentence():
    assert all(each.text.endswith(".") and each.text[0] in "∫ABCDEFGHIJKLMNOPQRSTUVWXYZ" for each in CATALOGUE)
    assert len({each.pattern for each in CATALOGUE}) == len(CATALOGUE)


def test_an_unknown_name():
    with pytest.raises(UnknownName, match="clearance"):
        describe_measure("clearance_toe")


@pytest.mark.parametrize(
    ("name", "unit"),
    [
        *(("peak_torque_slide", "N"), ("rms_torque_turn", "N·m"), ("peak_speed_slide", "m/s"), ("least_turn", "rad")),
        *(("greatest_slide", "m"), ("slide_rate_at_lands", "m/s"), ("slide_at_lands", "m"), ("reserve_slide", "N")),
        *(("turn", "rad"), ("mean_speed", "m/s"), ("effort", "N²·m²·s"), ("deflection_slide", "m")),
    ],
)
def test_joints_that_slide_have_units_of_their_own(name, unit):
    both, rails = unit_masses(slide="m", turn="rad"), unit_masses(slide="m", lift="m")
    assert unit_on(both, describe_measure(name), name) == unit
    of_rails = {"effort": "N²·s", "effort_per_distance": "N²·s/m", "turn": "rad"}
    assert {each: unit_on(rails, describe_measure(each), each) for each in of_rails} == of_rails
