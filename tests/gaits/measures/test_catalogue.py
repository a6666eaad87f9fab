"""The table of names: every measure is in it once, with the unit that it has."""

import pytest

from spear_pin.errors import UnknownName
from spear_pin.gaits.measures.catalogue import CATALOGUE, described
from spear_pin.gaits.measures.of_samples import Sampled
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
    assert described(name).unit == unit


def test_what_samples_give_is_in_it():
    found = Sampled(gait("long_stride").system.robot, trajectory("long_stride")).values()
    assert {described(name).pattern for name in found} >= {"effort", "cost_of_transport", "friction_used_TOE"}


def test_each_says_what_it_is_in_a_sentence():
    assert all(each.text.endswith(".") and each.text[0] in "∫ABCDEFGHIJKLMNOPQRSTUVWXYZ" for each in CATALOGUE)
    assert len({each.pattern for each in CATALOGUE}) == len(CATALOGUE)


def test_an_unknown_name():
    with pytest.raises(UnknownName, match="clearance"):
        described("clearance_toe")
