"""Names of columns: what they are of, their units, their headings and their order."""

import pytest

from spear_pin import load, sagittal
from spear_pin.hybrid.column_names import (
    PAIRED,
    heading,
    of_a_pair,
    quantity,
    read_heading,
    sort_columns,
    split_column_name,
    unit,
)


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("q_knee", ("q", "knee")),
        ("force_x_toe", ("force_x", "toe")),
        ("u_left_hip", ("u", "left_hip")),
        ("cycle", ("", "cycle")),
        ("quality_x", ("", "quality_x")),
    ],
)
def test_parts(name, parts):
    assert split_column_name(name) == parts


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("t", "s"),
        ("cycle", ""),
        ("v_boom_z", "m/s"),
        ("v_knee", "rad/s"),
        ("v_lost", "m/s or rad/s"),
        ("u_lost", "N or N·m"),
        ("current_knee", "A"),
        ("force_z_toe", "N"),
    ],
)
def test_units(name, expected):
    assert unit(name, {"boom_z": "m", "knee": "rad"}) == expected


@pytest.mark.parametrize(("name", "its_unit", "text"), [("q_knee", "rad", "q_knee [rad]"), ("cycle", "", "cycle")])
def test_headings(name, its_unit, text):
    assert heading(name, its_unit) == text and read_heading(text) == (name, its_unit)


def test_pairs():
    """Forces and torques of a plane's legs are of two; their angles, and what a leg of four has, are of one."""
    together = ["u_posterior_knee", "force_z_anterior_toe", "spring_anterior_knee", "friction_posterior_hip"]
    alone = ["q_posterior_knee", "u_knee", "u_posterior_left_knee", "friction_pitch", "force_x_toe", "cycle"]
    assert [of_a_pair(name) for name in [*together, *alone]] == [True] * 4 + [False] * 6
    assert quantity("u_posterior_knee") == "motor torque, a pair" and quantity("q_pitch") == "position"
    assert quantity("cycle") == "cycle"


def test_the_names_are_those_of_a_plane():
    for robot in (load("q_spear"), sagittal(load("q_spear_full"))):
        assert {f"{leg.name}_{part}" for leg in robot.legs for part in ("hip", "knee", "toe")} == PAIRED


def test_order():
    assert sort_columns(["engaged_knee", "q_knee", "cycle", "domain", "u_knee", "t"]) == [
        *("t", "domain", "cycle", "q_knee", "u_knee", "engaged_knee")
    ]
