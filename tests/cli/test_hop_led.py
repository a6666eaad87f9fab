"""`spear hop --robot` where a search finds none: how far hops go from one that there is, and what to type."""

import shlex

import pytest

from spear_pin.errors import NoGait
from spear_pin.studies.hop_led import Way
from tests.cli.calls import refused
from tests.model.legged import quadruped

ENDS = "there the branch of hops turns back"


@pytest.fixture
def call(capsys, monkeypatch, tmp_path):
    """What is said where a search finds no hop, and a way is this one, or there is none."""
    robot = tmp_path / "my dog.urdf"
    robot.write_text(quadruped(), encoding="utf-8")

    def call(way, *options):
        asked = []

        def lead(system, target):
            asked.append((system.spring, dict(target)))
            if way is None:
                raise NoGait("there either", 1.0)
            return way

        def none(*arguments, **named):
            raise NoGait("Newton's method makes no progress", 3.1)

        monkeypatch.setattr("spear_pin.studies.hop_of_another.hop_of", none)
        monkeypatch.setattr("spear_pin.find_gait", none)
        monkeypatch.setattr("spear_pin.studies.hop_led.lead_hop", lead)
        words = ("--robot", robot, "--leg", "HR", *options, "--out", tmp_path)
        said = refused(capsys, "hop", *words)
        ((spring, target),) = asked
        return said, said.partition("; try ")[2].strip(), spring, target, robot

    return call


def test_how_far_it_goes_what_ends_it_and_what_to_type(call):
    way = Way(None, "stiffness", 8.54, 6.47, 0.17304, ENDS)
    said, typed, spring, target, robot = call(way, "--stiffness", "6", "--damping", "0.1", "--knee", "1.1")
    assert f"hops continue from stiffness 8.54 to 6.47 N·m/rad with 0.173 s of flight: {ENDS}" in said
    assert (spring.stiffness, spring.damping) == (6.0, 0.1) and target == {}
    words = ["--leg", "HR", "--stiffness", "6.511", "--damping", "0.1", "--knee", "1.1", "--flight-time", "0.173"]
    assert shlex.split(typed) == ["spear", "hop", "--robot", str(robot), *words]


@pytest.mark.parametrize(
    ("number", "options", "words"),
    [
        ("flight_time", ["--flight-time", "0.4"], ["--flight-time", "0.216"]),
        ("stance_torque", ["--stance-torque", "4"], ["--stance-torque", "0.216"]),
        ("damping", ["--stance-torque", "4"], ["--flight-time", "0.17", "--damping", "0.216"]),
    ],
)
def test_the_number_that_ends_it_is_the_one_to_type(call, number, options, words):
    _, typed, _, target, robot = call(Way(None, number, 0.2, 0.2163, 0.17, ENDS), *options)
    assert shlex.split(typed) == ["spear", "hop", "--robot", str(robot), "--leg", "HR", *words]
    assert target == {options[0][2:].replace("-", "_"): float(options[1])}


def test_an_angle_of_the_hip_has_no_option_to_type(call):
    said, typed, _, target, _ = call(Way(None, "hip_touchdown", 0.3, 0.2163, 0.17, ENDS), "--knee", "0.4")
    assert f"hops continue from hip 0.3 to 0.2163 rad with 0.17 s of flight: {ENDS}" in said
    assert typed == "" and "--knee" not in said and target == {}


def test_where_there_is_nowhere_to_begin(call):
    assert "SPEAR-II's numbers, scaled to this leg, give no hop either" in call(None, "--stiffness", "6")[0]
