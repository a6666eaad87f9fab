"""What is asked of each subject: everything that tells numbers of one and the same gait."""

import base64
import json
import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from unittest import mock

import numpy as np

from spear_pin import Gait, Trajectory, simulate
from spear_pin.gaits.lane_measures import MEASURES
from spear_pin.gaits.many import find_many
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.sensitivity.many_measures import measure_lanes
from spear_pin.hybrid.parameters import number
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.model.robot import Robot
from spear_pin.studies.energetics import costs
from spear_pin.studies.payoff import Motors
from spear_pin.studies.payoff.bounding import figures_of, request
from spear_pin.studies.payoff.figures import Figures
from spear_pin.studies.payoff.grid import SWITCHED, Point
from spear_pin.studies.payoff.searches import Search
from spear_pin.viz.notebook.cards import described
from tests.names.comparison import Table
from tests.names.said import called, command, first_number, numbers, text
from tests.solve.kept import FOLDER
from tests.studies.payoff.stub import SOLUTION, Stubbed, of_leg

MOTOR, RATIOS, EFFICIENCY, BUS = "assumed_600w", {"knee": 15.0, "hip": 60.0}, 0.83, 48.0
NOT_HERE = ("files", "shown", "cycles", "retouches", "slips")  # of a run, its length and its files


def fill_hop(table: Table, folder: Path) -> None:
    """SPEAR-II's hop of 0.2 s."""
    asked = ("hop", "--cycles", 2, "--out", folder)
    said = command(*asked, "--save")
    table.add("hop --json", _of(said))
    gait = Gait.load(folder / "hop.json")
    _derived(table, folder, "hop", gait, "stiffness", 0.02, ["stance_torque"], {"flight_time": 0.2})
    _of_motion(table, folder / "hop.npz", gait)
    _lanes(table, gait, ["stance_torque"], {"flight_time": 0.2})
    _compare(table, folder, folder / "hop.json")
    _sweep(table, folder, gait, "hop", "--flight-time", 0.2)
    _explored_hop(table)
    _printed(table, "hop", *asked)
    _shown(table, gait, folder / "hop.html")


def fill_bound(table: Table, folder: Path) -> None:
    """The bound that ships as long_stride."""
    asked = ("bound", "--gait", "long_stride", "--cycles", 2, "--out", folder)
    table.add("bound --json", _of(command(*asked)))
    gait = Gait.load("long_stride")
    solved = ["posterior_hip_torque"], {"mean_speed": 2.5}
    _derived(table, folder, "long_stride", gait, "stiffness", 0.02, *solved)
    _of_motion(table, folder / "bound.npz", gait)
    _lanes(table, gait, *solved)
    _compare(table, folder, "long_stride")
    _explored_bound(table)
    _printed(table, "bound", *asked)
    _shown(table, gait, folder / "bound.html")


def fill_trot(table: Table, folder: Path) -> None:
    """The trot that ships, held by feedback."""
    steady = FOLDER / "trot_steady.json"
    table.add("trot --json", _of(command("trot", steady, "--cycles", 2, "--out", folder)))
    gait = Gait.load(steady)
    _of_motion(table, folder / "trot.npz", gait)
    _compare(table, folder, steady)
    _printed(table, "trot", "trot", steady, "--cycles", 2, "--out", folder)


def fill_payoff(table: Table, folder: Path) -> None:
    """A study of bounds whose searches end at the shipped gait: its figures are those of this gait with motors."""
    gait, speed, stiffness = Gait.load("long_stride"), 2.5, 56.0
    options: list[object] = ["--speeds", "2,2.5", "--stiffnesses", f"40,{stiffness}", "--workers", 1]
    for part, ratio in RATIOS.items():
        options += [f"--{part}-motor", MOTOR, f"--{part}-ratio", ratio]
    ends: dict[Point, tuple[Gait, Figures, object]] = {}

    def end_of(robot: Robot, motors: Motors, search: Search) -> tuple[Gait, Figures, object]:
        if search.point not in ends:  # a point is searched from several neighbours
            ends[search.point] = _shipped_for(robot, motors, search)
        return ends[search.point]

    with mock.patch("spear_pin.studies.payoff.bounding.BOUNDS", Stubbed(end_of)):
        said = command("payoff", "q_spear", *options, "--bus", BUS, "--efficiency", EFFICIENCY, "--out", folder)
    points = [each for each in said["points"] if "figures" in each and each["speed"] == speed]
    (found,) = (each for each in points if each["kind"] == SWITCHED and each["stiffness_per_leg"] == stiffness)
    table.add("payoff --json, a point", {name: found[name] for name in ("speed", "stiffness_per_leg", "electricity")})
    table.add("payoff --json, its figures", _of(found["figures"]))
    table.add("bound --json", _of(command("bound", "--gait", "long_stride", "--cycles", 1, "--out", folder)))
    motors = {
        joint: Drive(motor(MOTOR), Gearbox(RATIOS[joint.split("_")[1]], EFFICIENCY), BUS)
        for joint in gait.system.robot.actuated
    }
    table.add("sensitivity, with drives", gait.sensitivity(["stiffness"], motors=motors).outputs)


def _shipped_for(robot: Robot, motors: Motors, search: Search) -> tuple[Gait, Figures, object]:
    """The shipped gait, its cost referred to the study's robot, which has the mass of the given motors."""
    point = search.point
    gait = of_leg(point.stiffness if point.stiffness is not None else 56.0)
    found = figures_of(gait, motors, request(gait.system.robot, point, motors))
    return gait, replace(found, cost=found.cost * gait.system.robot.weight / robot.weight), SOLUTION


SUBJECTS: dict[str, Callable[[Table, Path], None]] = {
    "hop": fill_hop,
    "bound": fill_bound,
    "trot": fill_trot,
    "payoff": fill_payoff,
}


def _of(said: dict[str, object]) -> dict[str, float]:
    return {name: value for name, value in numbers({k: v for k, v in said.items() if k not in NOT_HERE})}


def _derived(
    table: Table,
    folder: Path,
    what: str,
    gait: Gait,
    over: str,
    share: float,
    vary: list[str],
    target: dict[str, float],
) -> None:
    """Tables of derivatives, of what errors do, a design that may go nowhere, and a branch at its beginning."""
    from spear_pin import continue_gait

    table.add("sensitivity --json", command("sensitivity", what, "--over", over, "--out", folder)["values"])
    written = json.loads((folder / "sensitivity.json").read_text(encoding="utf-8"))
    table.add("sensitivity.json", {name: each["value"] for name, each in written["outputs"].items()})
    table.add("sensitivity.json", written["parameters"])
    spread = command("uncertainty", what, "--sigma", f"{over}=1%", "--out", folder)["uncertainty"]
    table.add("uncertainty --json", {name: each["value"] for name, each in spread["outputs"].items()})
    value = number(gait.system, over)
    for minimize in ("work", "effort"):
        words = ("--minimize", minimize, "--over", f"{over}={value * (1 - share)}:{value * (1 + share)}")
        kept = ",".join(f"{name}={wanted}" for name, wanted in target.items())
        found = command(
            "design", what, *words, "--keep", kept, *(word for name in vary for word in ("--vary", name)),
            "--iterations", 1, "--out", folder,
        )  # fmt: skip
        table.add("design --json, its start", {minimize: found["start"]})
    branch = continue_gait(gait, over, (value * (1 - share), value * (1 + share)), vary, target, points=2)
    at = int(np.abs(branch.values - value).argmin())
    table.add("family, at its beginning", {over: float(branch.values[at])})
    table.add("family, at its beginning", {name: float(values[at]) for name, values in branch.solved.items()})


def _of_motion(table: Table, path: Path, gait: Gait) -> None:
    """What was simulated, from its file, as it is exported and played."""
    run, robot = Trajectory.load(path), gait.system.robot
    halves = bool(gait.system.mirrored_toes)
    sampled = Sampled(robot, run, (1, 2) if halves else (1,), halves)  # a whole stride, of each leg
    table.add("measures of samples", sampled.values())
    if robot.dimension == 2:
        finer = simulate(gait.system, gait.state, 1, samples=1000, progress=False)
        table.add("measures of ten times the samples", Sampled(robot, finer).values())
    if gait.system.cyclic:
        found = costs(gait.system, run)
        absolute, positive = (found.energy[f"mechanical_{kind}"] for kind in ("absolute", "positive"))
        table.add("energetics", {"absolute_work": absolute, "positive_work": positive})
        table.add("energetics", {"cost_of_transport": found.of_transport["mechanical_absolute"]})
    frame = run.to_pandas()
    csv = run.export(path.with_suffix(".csv"))
    rows = np.genfromtxt(csv, delimiter=",", names=None, dtype=None, skip_header=1, encoding="utf-8")
    heads = [head.split(" [")[0] for head in csv.read_text(encoding="utf-8").splitlines()[0].split(",")]
    middle = len(frame) // 3
    for name in frame.columns:
        if frame[name].dtype.kind == "f":
            table.add("a row of to_pandas", {f"column {name}": float(frame[name].iloc[middle])})
            table.add("a row of the CSV file", {f"column {name}": float(rows[middle][heads.index(name)])})


def _shown(table: Table, gait: Gait, page: Path) -> None:
    """The card of a gait, as rounded as it is, and a row of the samples that a page holds."""
    for row in described(gait).rows:
        told = first_number(row.value)
        if told is not None:
            table.rounded("card of the gait", called(row.name), *told)
    data = page.read_text(encoding="utf-8")
    found = re.search(r'"samples":(\{.*?"plotted":\[[^\]]*\]\})', data)
    assert found is not None
    held = json.loads(found[1])
    t, moving = _floats(held["times"], "<f8"), [each for each in held["columns"] if "still" not in each]
    values = _floats(held["values"], "<f4").reshape(len(moving), len(t))
    run = Trajectory.load(page.with_suffix(".npz"))
    alone = [i for i in range(len(t)) if (run.t - run.t[0] == t[i]).sum() == 1]  # of an event there are two
    for i in (alone[0], alone[len(alone) // 2]):
        row = int(np.flatnonzero(run.t - run.t[0] == t[i])[0])
        frame = run.to_pandas().iloc[row]
        for column, shown in zip(moving, values[:, i].tolist(), strict=True):
            if column["name"] in frame:
                table.add("a row of the page", {f"{column['name']} at {t[i]:.6f} s": shown})
                table.add("the same of to_pandas", {f"{column['name']} at {t[i]:.6f} s": float(frame[column["name"]])})


def _floats(packed: str, kind: str) -> np.ndarray:
    return np.frombuffer(base64.b64decode(packed), kind).astype(float)


def _lanes(table: Table, gait: Gait, vary: list[str], target: dict[str, float]) -> None:
    """Measures of lanes, and of gaits that are asked for by them."""
    q, v = (part[None] for part in gait.state)
    given = {"friction": np.array([number(gait.system, "friction")])}
    found, _ = measure_lanes(gait.system, given, q, v)
    table.add("lanes", {name: float(values[0]) for name, values in found.items()})
    start = {name: np.array([number(gait.system, name)]) for name in vary}
    lanes = find_many(gait.system, start, vary, target, guess=(q, v))
    table.add("find_many", {name: float(values[0]) for name, values in lanes.parameters.items()})
    table.add("targets", {name: wanted for name, wanted in target.items() if name in MEASURES})


def _compare(table: Table, folder: Path, what: object) -> None:
    """The table of a comparison of a gait with itself."""
    said = command("compare", what, what, "--out", folder)
    for row in said["measures"]:
        table.add("compare --json", {called(row["measure"]): row["values"][0] * (0.01 if row["unit"] == "%" else 1.0)})
    table.add("compare --json", {row["parameter"]: row["values"][0] for row in said["parameters"]})


def _sweep(table: Table, folder: Path, gait: Gait, *words: object) -> None:
    """The point of a sweep that is the gait."""
    import xarray

    value = number(gait.system, "stiffness")
    path = folder / "sweep.zarr"
    command("sweep", *words, "--over", f"stiffness={value!r},{1.01 * value!r}", "--out", path)
    found = xarray.open_zarr(path, consolidated=False).isel(point=0)
    single = [name for name in found.variables if found[name].ndim == 0 and found[name].dtype.kind == "f"]
    table.add("sweep", {str(name): float(found[name]) for name in single})


def _explored_hop(table: Table) -> None:
    from spear_pin.studies.explore.engines import best_engine
    from spear_pin.studies.explore.figures import figures
    from spear_pin.studies.explore.hops import settle_hops
    from spear_pin.studies.explore.legs import spear_ii_hop

    motion = settle_hops(spear_ii_hop().at(kept=True), best_engine())
    _explored(table, motion, figures(motion))


def _explored_bound(table: Table) -> None:
    from spear_pin.studies.explore.carried import carry_gait
    from spear_pin.studies.explore.figures import figures
    from spear_pin.studies.explore.gaits import bound_to_explore

    motion = carry_gait(bound_to_explore(Gait.load("long_stride"), "a bound").at())
    _explored(table, motion, figures(motion))


def _explored(table: Table, motion: object, found: dict[str, float | None]) -> None:
    """Figures and sliders of the page."""
    table.add("explore, figures", {name: value for name, value in found.items() if value is not None})
    table.add("explore, sliders", motion.knobs.values)


def _printed(table: Table, *words: object) -> None:
    """What the command prints without --json, as far as it has the name of a number."""
    for label, row in text(*words[1:]).items():
        told = first_number(row)
        if told is not None:
            table.rounded(f"{words[0]}, as text", called(label), *told)
