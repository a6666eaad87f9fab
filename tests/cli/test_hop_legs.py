"""`spear hop --robot`: one leg of somebody else's robot, and one line for every mistake."""

import io
import json
from contextlib import redirect_stdout
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, Spring, Trajectory, hopping, load, monopod, simulate
from spear_pin.cli import main
from spear_pin.gaits.proportions import usual_flight
from spear_pin.hybrid.periodic import residual
from spear_pin.model.origin import robot_of
from tests.cli.calls import printed, refused, run, words


@pytest.fixture(scope="module")
def hopped(dog, tmp_path_factory):
    """What the command prints of a leg's hop that it saves, and the folder of its files."""
    folder = tmp_path_factory.mktemp("hopped")
    asked = ("--leg", "HR", "--flight-time", "0.18", "--save", "--out", str(folder), "--json")
    with redirect_stdout(io.StringIO()) as out:
        assert main(["hop", "--robot", str(dog), *asked]) == 0
    return json.loads(out.getvalue()), folder


@pytest.fixture(scope="module")
def cut(dog):
    """The monopod of that leg by the Python API."""
    return monopod(load(dog, base="fixed", motors="all"), "HR", locked=["boom_x"])


@pytest.mark.slow
def test_a_leg_hops(hopped, cut):
    """As the monopod that is cut out does by the Python API; page, plots and samples are its own."""
    result, folder = hopped
    assert result["cut"] == str(cut.cut) and result["beyond_limits"] == []
    assert result["stiffness"] == Spring.scaled(cut).stiffness
    assert result["residual"] < 1e-9 and result["energy_residual"] < 1e-8 * cut.mass * 9.81
    trajectory = Trajectory.load(folder / "hop.npz")
    assert trajectory.cycles == 11
    gait = hopping(cut, replace(HoppingLaw.scaled(cut), stance_torque=result["stance_torque"]), Spring.scaled(cut))
    hop = simulate(gait, (trajectory.q[0], trajectory.v[0]), 1)
    np.testing.assert_allclose(hop.q[-1], trajectory.q[trajectory.cycle == 1][-1], rtol=0, atol=1e-8)
    page = (folder / "hop.html").read_text(encoding="utf-8")
    assert "made, leg HR, hopping in place" in page and "not drawn" not in page and "drawn as bones" not in page


@pytest.mark.slow
def test_a_leg_with_a_loop_hops(capsys, tmp_path):
    found = printed(capsys, "hop", "--robot", "crank_hopper", "--cycles", "2", "--out", tmp_path)
    assert found["cycles"] == 2 and found["residual"] < 1e-9 and found["peak_speed"].keys() == {"crank"}
    assert found["flight_time"] == pytest.approx(usual_flight(load("crank_hopper")))
    names: dict[str, object] = {}
    exec(found["python"], names)
    assert names["gait"].parameters["stance_torque"] == pytest.approx(found["stance_torque"])


@pytest.mark.parametrize("option", ["--leg=leg", "--bends=1", "--body=2", "--free-x", "--hardware"])
def test_a_leg_with_a_loop_has_no_such_option(capsys, option):
    said = refused(capsys, "hop", "--robot", "crank_hopper", option)
    assert said.startswith(f"spear: {option.split('=')[0]} is ") and "to be left out" in said


@pytest.mark.slow
def test_a_leg_is_saved(hopped, cut):
    """The gait and the samples know the robot that was cut, and the leg."""
    result, folder = hopped
    assert str(folder / "hop.json") in result["files"]
    gait = Gait.load(folder / "hop.json")
    assert gait.system.robot.model == cut.model and str(gait.system.robot.cut) == result["cut"]
    assert gait.residual == result["residual"] and residual(gait.system, gait.state) < 1e-9
    trajectory = Trajectory.load(folder / "hop.npz")
    moved = robot_of(trajectory.origin)
    assert moved.model == cut.model and moved.coordinates == trajectory.coordinates


@pytest.fixture(scope="module")
def told(blank):
    """A TOML file that says what that URDF cannot: sides, springs and motors."""
    path = blank.with_name("told.toml")
    path.write_text(
        """
        urdf = "blank.urdf"
        base = "free"
        legs.HR.side = 1
        springs.knee = {stiffness = 14.2, damping = 0.277}
        motors.hip = {motor = "faulhaber_3863h024cr", rotor_inertia = 1e-4}
        motors.knee = {motor = "faulhaber_3863h024cr", rotor_inertia = 1e-4, efficiency = 0.9}
        """,
        encoding="utf-8",
    )
    return path


@pytest.mark.slow
def test_a_file_says_springs_and_sides(capsys, told, tmp_path):
    asked = ("hop", "--robot", told, "--leg", "HR", "--flight-time", "0.18", "--cycles", "1", "--out", tmp_path)
    result = printed(capsys, *asked, "--save")
    assert result["stiffness"] == 14.2
    gait = Gait.load(tmp_path / "hop.json").system
    assert gait.spring == Spring(14.2, 0.277) == gait.robot.settings.springs["knee"]
    assert printed(capsys, *asked, "--stiffness", "14")["stiffness"] == 14.0


@pytest.mark.slow
def test_a_file_says_motors(capsys, told, tmp_path):
    asked = ("--leg", "HR", "--flight-time", "0.18", "--cycles", "1", "--out", tmp_path)
    result = printed(capsys, "hop", "--robot", told, *asked, "--hardware", "--current-limit", "40")
    assert set(result["peak_current"]) == {"hip", "knee"} and "electrical" in result


def test_a_file_that_is_wrong(capsys, told):
    wrong = told.with_name("wrong.toml")
    wrong.write_text('urdf = "blank.urdf"\nlegs.HR.side = 3\n', encoding="utf-8")
    assert "wrong.toml: legs.HR.side is 3; expected 1 or -1" in refused(capsys, "hop", "--robot", wrong)


def test_hardware_is_not_saved(capsys):
    assert "--save is True; expected to be left out with --hardware" in refused(capsys, "hop", "--hardware", "--save")


@pytest.mark.slow
def test_what_it_rests_on_is_printed(capsys, dog, tmp_path):
    status, out, _ = run(capsys, "hop", "--robot", dog, "--flight-time", "0.18", "--cycles", "1", "--out", tmp_path)
    assert status == 0
    for said in (
        "monopod of made",
        "hip = FL_pitch, knee = -FL_bend",
        "held at zero: FL_swing",
        "toe out of the hip's",
        "neither a file nor an option gives: SPEAR-II's, scaled",
    ):
        assert said in out


@pytest.mark.slow
def test_a_shipped_robot(capsys, tmp_path):
    """SPEAR-II is a leg of its own, and hops as it does."""
    named, plain = (printed(capsys, "hop", *words, "--out", tmp_path) for words in (("--robot", "spear_ii"), ()))
    for name in ("stance_torque", "flight_time", "apex_height", "peak_force"):
        assert named[name] == pytest.approx(plain[name], rel=1e-9)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (["--leg", "XX"], "unknown leg 'XX'; valid: FL, FR, HL, HR"),
        (["--leg", "FL", "--bends", "2"], "2"),
        (["--body", "-1"], "-1"),
        (["--body", "nan"], "nan"),
        (["--hardware"], "known motors: name that of its hip in a TOML file"),
    ],
    ids=words,
)
def test_mistakes(capsys, dog, options, said):
    assert said in refused(capsys, "hop", "--robot", dog, *options)


def test_a_knee_of_which_the_side_is_not_known(capsys, blank):
    assert (
        "--bends is None; expected 1 if FL_bend points forward as it flexes, -1 if backward: the file of made"
        in refused(capsys, "hop", "--robot", blank)
    )


def test_knees_of_which_the_sides_are_not_known(capsys, blank):
    said = refused(capsys, "bound", "--robot", blank)
    assert "--bends is None; expected 1 or -1 for each pair, 1 if" in said and "made does not say" in said


@pytest.mark.parametrize("option", [["--leg", "FL"], ["--bends", "1"], ["--body", "2"], ["--repair"]], ids=words)
def test_goes_with_a_robot(capsys, option):
    assert f"{option[0]} is" in refused(capsys, "hop", *option)
