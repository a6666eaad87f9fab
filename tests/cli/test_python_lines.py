"""Python that commands print: it runs as it is, and gives the numbers of the command."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, Ground, HoppingLaw, Spring, Trajectory, find_gait, load
from spear_pin.cli import _parser
from spear_pin.cli.output import IN_PYTHON
from spear_pin.cli.python_lines import Code, Program
from spear_pin.cli.request import make_request
from spear_pin.model.catalogue import motor
from tests.cli.calls import printed, run

SLOW = pytest.mark.slow


def slow(*values):
    return pytest.param(*values, marks=SLOW)


def joined(value):
    return " ".join(map(str, value)) if isinstance(value, tuple) else ""


class TestProgram:
    def test_imports_what_it_calls(self):
        program = Program()
        robot = program.let("robot", program.call(load, "spear_ii", locked=["boom_x"], repair=False))
        program.let("law", program.change(Code("usual.law"), HoppingLaw(), HoppingLaw(stance_torque=8.5)))
        program.show(program.method(robot, "gravity", [0.0, 1.0], option=None))
        assert str(program).splitlines() == [
            "from dataclasses import replace",
            "from spear_pin import load",
            "",
            'robot = load("spear_ii", locked=["boom_x"])',
            "law = replace(usual.law, stance_torque=8.5)",
            "print(robot.gravity([0.0, 1.0]))",
        ]

    @pytest.mark.parametrize(
        ("value", "source"),
        [
            (Spring(), "Spring()"),
            (Spring(stiffness=55), "Spring(stiffness=55)"),
            (Ground(slope=0.1), "Ground(slope=0.1)"),
            (motor("spear_ii_knee"), 'motor("spear_ii_knee")'),
            ({"a": (1.5,), "b": []}, '{"a": (1.5,), "b": []}'),
            (np.float64(0.25), "0.25"),
            ('it\'s "a"\u202e', "'it\\'s \"a\"\\u202e'"),
            (None, "None"),
        ],
        ids=str,
    )
    def test_values(self, value, source):
        assert Program().source(value) == source

    def test_what_has_no_source(self):
        with pytest.raises(TypeError, match="no source of object"):
            Program().source(object())

    def test_a_change_that_is_none(self):
        program = Program()
        assert program.change(Code("law"), HoppingLaw(), HoppingLaw()) == "law" and str(program) == ""

    def test_a_long_call_is_broken_into_lines(self):
        program = Program()
        program.let("gait", program.call(find_gait, Code("system"), vary=["x" * 50], target={"y" * 40: 1.0}))
        lines = str(program).splitlines()[2:]
        assert lines[0] == "gait = find_gait(" and lines[-1] == ")" and max(map(len, lines)) < 100

    def test_fields_that_differ_are_said(self):
        @dataclass(frozen=True)
        class Pair:
            first: int
            second: float = 2.0

        Pair.__module__, Pair.__qualname__ = HoppingLaw.__module__, "HoppingLaw"
        assert Program().source(replace(Pair(1), second=3.0)) == "HoppingLaw(first=1, second=3.0)"

    def test_functions_where_no_few_lines_do(self):
        program = Program()
        program.say_functions(load)
        assert str(program) == "# this command calls spear_pin.model.loading.load"


def lines_of(capsys, *words):
    """What a command prints as JSON, and the variables that its lines of Python leave."""
    found, space = printed(capsys, *words), {}
    exec(compile(found["python"], "lines", "exec"), space)
    capsys.readouterr()
    return found, space


SHORT = ("--cycles", 1, "--rtol", 1e-7)
HOPS = (
    ("--stiffness", 55, "--slope", 0.05, "--friction", 0.7, "--flight-time", 0.21),
    ("--switch-delay", 0.004, "--tooth", 0.05),
    slow(("--stance-torque", 8.2, "--knee", 0.95, "--frequency", 2.6, "--hardening", 30, "--preload", 2)),
    slow(("--free-x", "--foot-placement", 0.15, "--max-step", 0.01)),
    slow(("--hardware", "--noise", 0.005, "--losses", 5, "--seed", 3, "--bandwidth", 500, "--current-limit", 8)),
    slow(("--robot", "hoppy", "--friction", 0.8)),
    slow(("--robot", "q_spear_full", "--leg", "anterior_left", "--body", 9)),
    slow(("--robot", "q_spear_full", "--bends", 1, "--stiffness", 76)),
)


@pytest.mark.parametrize("options", HOPS, ids=joined)
@pytest.mark.slow
def test_hops(capsys, tmp_path, options):
    found, space = lines_of(capsys, "hop", *options, *SHORT, "--out", tmp_path)
    assert '"knee":' not in found["python"]  # a single spring at the knee needs no name
    gait, trajectory = space["gait"], space["trajectory"]
    assert gait.period == found["period"] and gait.residual == found["residual"]
    assert trajectory.t[-1] == found["shown"][-1] and trajectory.cycles == found["cycles"]
    if "stance_torque" in found:
        assert gait.system.law.stance_torque == found["stance_torque"]
    if "electrical" in found:
        assert trajectory.electrical["battery_knee"].mean() == found["electrical"]["battery_knee"]


@SLOW
@pytest.mark.parametrize(
    "call",
    [("bound",), ("bound", "--speed", 2.6), ("turn", "turn_9")],
    ids=joined,
)
def test_strides(capsys, tmp_path, call):
    found, space = lines_of(capsys, *call, *SHORT, "--out", tmp_path)
    assert space["gait"].residual == found["residual"] and space["trajectory"].cycles == 1
    assert space["trajectory"].t[-1] == found["shown"][-1]


@SLOW
def test_a_push(capsys, tmp_path):
    """The state of the gait stays as it is."""
    path = Path(__file__).parents[1] / "solved" / "trot_steady.json"
    _, space = lines_of(capsys, "trot", path, "--push", 0.1, *SHORT, "--out", tmp_path)
    np.testing.assert_array_equal(space["trajectory"].v, Trajectory.load(tmp_path / "trot.npz").v)
    np.testing.assert_array_equal(space["gait"].state, Gait.load(path).state)


@pytest.mark.parametrize(
    "options",
    [
        (
            "long_stride",
            "--speed",
            "2.6",
            "--hip-distance",
            "0.75",
            "--stiffness-per-leg",
            "free",
            "--hip-torque",
            "50",
        ),
        ("--knee-motor", "ec_90_flat_260w", "--bus", "40", "--minimize", "electrical"),
        ("--robot", "q_spear_full", "--bends", "-1", "-1", "--clearance", "0.02"),
    ],
    ids=joined,
)
def test_a_request(options):
    program, space = Program(), {}
    robot, request = make_request(_parser().parse_args(["search", *options]), program)
    exec(str(program), space)
    assert space["request"] == request
    assert space["robot"].varied == robot.varied and str(space["robot"]) == str(robot)


def mass(space):
    return space["robot"].mass_matrix(space["q"])


@pytest.mark.parametrize(
    ("call", "in_python", "name"),
    [
        (("dynamics", "spear_ii", "--q", 0, 0.5, 0.5, 1), mass, "D"),
        (("dynamics", "q_spear_full", "--leg", "anterior_left", "--bends", -1, "--body", 8), mass, "D"),
        (("dynamics", "q_spear_full", "--plane", "--bends", 1, -1), mass, "D"),
        (
            ("push-test", "--no-motor", "--stiffness", 50, "--static-rest", "--duration", 0.5),
            lambda space: space["result"].rest,
            "rest_angle",
        ),
    ],
    ids=joined,
)
def test_numbers(capsys, tmp_path, monkeypatch, call, in_python, name):
    monkeypatch.chdir(tmp_path)
    found, space = lines_of(capsys, *call)
    np.testing.assert_array_equal(in_python(space), found[name])


@SLOW
def test_derivatives(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call = ("sensitivity", "hop", "--over", "stiffness", "--motor", "knee=spear_ii_knee", "--bus", 24)
    found, space = lines_of(capsys, *call)
    assert dict(space["table"].outputs) == pytest.approx(found["values"], rel=1e-12)


@SLOW
def test_slower_studies(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found, space = lines_of(
        capsys, "family", "hop", "--over", "stiffness=48:50", "--at", 49, "--flight-time", 0.2, "--step", 0.4
    )
    assert len(space["branch"]) == found["points"] and space["branch"].values.max() == found["to"]
    found, space = lines_of(
        capsys, "uncertainty", "hop", "--sigma", "stiffness=1%,damping=0.05", "--correlation", "stiffness,damping=-0.3"
    )
    np.testing.assert_allclose(space["spread"].covariance, found["uncertainty"]["covariance"], rtol=1e-12)
    found, space = lines_of(
        capsys, "design", "hop", "--minimize", "work", "--keep", "flight_time=0.2", "--over", "stiffness=46:56"
    )
    assert space["design"].objective == pytest.approx(found["objective"], rel=1e-9)


@SLOW
def test_a_comparison(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call = ("compare", "stiffness=40", "stiffness=60", "--flight-time", 0.21, "--names", "soft", "stiff", "--cycles", 1)
    found, space = lines_of(capsys, *call)
    assert space["comparison"].measures[0].values == pytest.approx(found["measures"][0]["values"])


@SLOW
def test_records(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found, space = lines_of(capsys, "push-test", "--write-csv", "lab", "--repeats", 1, "--drift", 0.01)
    assert space["record"].t.size == found["samples"]
    call = (
        "identify",
        "lab.csv",
        "--volts-per-rad",
        1.06,
        "--offset",
        0.4,
        "--window",
        20,
        "--vary",
        "stiffness,damping",
    )
    found, space = lines_of(capsys, *call)
    first = found["estimates"][0]["parameters"][0]
    assert space["estimate"]["stiffness"].value == first["value"]
    found, space = lines_of(capsys, "push-test", "--ratios", "none", 15, "--duration", 0.5)
    assert [row.swing.frequency for row in space["rows"]] == [row["frequency"] for row in found["ratios"]]


@pytest.mark.extra("heyoka")
@SLOW
def test_logs(capsys, lab, tmp_path):
    columns = ("--column", "crank=theta_deg", "--unit", "theta_deg=degrees", "--column", "crank_torque=drive_mNm")
    asked = ("hops.csv", "--settle", 0.015, "--set", "rest=0.146", "--out", tmp_path)
    found, space = lines_of(capsys, "fit", "leg.toml", *asked, "--over", "stiffness", "--phases", "stance")
    assert space["fit"]["stiffness"].value == found["found"]["stiffness"]["value"]
    found, space = lines_of(capsys, "replay", "leg.toml", *asked, *columns, "--window", 0.03)
    assert [hop.rms for hop in space["replayed"].hops] == [hop["rms"] for hop in found["hops"]]


@pytest.mark.extra("heyoka", "joblib", "xarray", "zarr")
@SLOW
def test_a_sweep(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    found = printed(capsys, "sweep", "hop", "--over", "stiffness=48:50:3", "--flight-time", 0.2)
    space = {}
    exec(found["python"].replace("sweep.zarr", "again.zarr"), space)
    assert int(space["dataset"]["stable"].sum()) == found["stable"] == 3


def test_it_is_the_last_of_the_text(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    call = ("dynamics", "spear_ii", "--lock", "boom_x")
    python = printed(capsys, *call)["python"]
    assert run(capsys, *call)[1].endswith(f"\n\n{IN_PYTHON}\n{python}\n")
