"""Names of columns: what they are of, their units, their headings and their order."""

import pytest

from spear_pin.hybrid.column_names import arranged, heading, parted, read_heading, unit


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
    assert parted(name) == parts


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


def test_order():
    assert arranged(["engaged_knee", "q_knee", "cycle", "domain", "u_knee", "t"]) == [
        *("t", "domain", "cycle", "q_knee", "u_knee", "engaged_knee")
    ]
