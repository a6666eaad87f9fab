"""The crank leg's model beside its logged hops: `python -m benchmarks.measured FOLDER`, Markdown; without one it ends.

The logs are those of arXiv 2505.22898, published in June 2024: one CSV file a hop, named by condition and mass, such as
`no_hsa_1300g_hop20.csv`, and `configs.json` with the numbers of the controller. Nothing is tuned to a file: all values
are fitted by `identify_motion`, on hops without spring at the lowest mass, and on the first hop with a spring.
"""

import json
import re
import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from math import degrees
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.markdown import table
from spear_pin import hopping, load, simulate, vary
from spear_pin.errors import BadFile
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.model.spring import Spring
from spear_pin.studies.logs import Log, MotionFit, Replay, find_phases, identify_motion, replay
from spear_pin.studies.logs.measured import find_measured
from spear_pin.studies.logs.phases import LogPhase, smooth_rate
from spear_pin.studies.logs.played import SLOW
from tests.studies.logs.crank_leg import ConfiguredLaw, configured, sampled

COLUMNS = {"time": "t_s", "crank": "x_deg", "crank_torque": "torque_Nm"}
FREE = ["torque_scale", "crank_armature", "crank_viscous", "crank_friction", "boom_z_friction"]
SPRING = ["stiffness", "rest", "hysteresis"]
FOOT = 0.152  # kg: foot, crank and rod of the model
GRID, BENCH = 0.12136, "hsa_static_map.csv"  # m: length of the spring at the bench's zero
PLAIN = re.compile(r"(?P<condition>(no_)?hsa_(?P<mass>\d+)g)_hop(?P<hop>\d+)\.csv")
MEASURES = "compression", "stance", "push_off"
HYSTERESIS, BENCH_ROW = "a spring with hysteresis, fitted on the first hop", "the bench's map as it is"
SETTLES = 0.012, 0.03, 0.05  # s
LONGEST = 0.6  # s of a hop: what takes longer has a gap
CYCLES = 12  # until the configured hop repeats itself


@dataclass(frozen=True)
class Condition:
    """The hops of one mass with or without spring: each by itself, and all joined."""

    name: str
    mass: float
    hops: tuple[Log, ...]
    whole: Log

    @property
    def sprung(self) -> bool:
        """Whether there was a spring."""
        return not self.name.startswith("no_")


def main() -> None:
    """Print the tables, or end where no folder of logs is named."""
    folders = [Path(each) for each in sys.argv[1:]]
    conditions = read(folders)
    plain = [each for each in conditions if not each.sprung]
    if not plain:
        print("no folder with logs of the leg is named: nothing is compared")
        return
    config = json.loads(
        next(folder / "configs.json" for folder in folders if (folder / "configs.json").is_file()).read_text()
    )
    fits = {each.name: identify_motion(leg(each.mass), each.whole, FREE) for each in plain}
    table(("fit", *FREE, "rms, deg", "phases"), [fitted(name, fit) for name, fit in fits.items()])
    springy = next((each for each in conditions if each.sprung), None)
    heads = "left out after touchdown, ms", *FREE, "hysteresis of the spring, N"
    table(heads, [settled(plain[0], springy, settle) for settle in SETTLES])
    first = fits[plain[0].name]
    values = {name: found.value for name, found in first.found.items()}
    kinds = {each.name: "its own fit" if each is plain[0] else "unseen" for each in plain}
    rows = [Row(each.name, kinds[each.name], replay(leg(each.mass), each.whole, values)) for each in plain]
    for each in (each for each in conditions if each.sprung):
        rows += with_spring(each, values, folders)
    heads = "replay", "by", "compression, %", "stance, %", "push-off, %", "hops"
    table(heads, [row.cells() for row in rows])
    alone = [row for each in plain for row in configured_rows(each, config, values)]
    heads = "hop by its configuration", "model", "log", "off, %"
    cells = [(f"{name}, {what}", f"{model:.4f}", f"{log:.4f}", f"{off:+.1f}") for name, what, model, log, off in alone]
    table(heads, cells)
    table(("asked", "off by", "holds"), accepted(fits, rows, alone))


@dataclass(frozen=True)
class Row:
    """A replay: of which condition, by which values, and what it found; with the residuals of all hops, in rad."""

    name: str
    kind: str
    found: Replay
    words: str = ""
    rms: float = np.nan

    def off(self, name: str) -> float:
        """By how much the model is off, in percent of the log."""
        return 100.0 * self.found.off(name)

    def cells(self) -> tuple[str, ...]:
        """What the table prints."""
        said = f"{self.kind}: {self.words}" if self.words else self.kind
        return self.name, said, *(f"{self.off(name):+.1f}" for name in MEASURES), str(len(self.found.hops))


Alone = tuple[str, str, float, float, float]  # condition, what, of the model, of the log, off in percent


def accepted(fits: Mapping[str, MotionFit], rows: list[Row], alone: list[Alone]) -> list[tuple[str, ...]]:
    """Rows of what is asked of the model, and whether it holds."""
    scales = [100.0 * abs(fit["torque_scale"].value / 1.12 - 1.0) for fit in fits.values()]
    asked: list[tuple[str, float, float, str]] = [
        ("rms without spring within 0.2 deg", degrees(max(fit.rms for fit in fits.values())), 0.2, "deg"),
        ("torque_scale within 5 % of 1.12", max(scales), 5.0, "%"),
    ]
    rotors = [fit["crank_armature"].value for fit in fits.values()]
    if len(rotors) > 1:
        asked.append(("rotors of all masses alike within 5 %", 100.0 * (max(rotors) / min(rotors) - 1.0), 5.0, "%"))
    limits = {"its own fit": (8.0, 3.0, 3.0), "unseen": (8.0, 3.0, 3.0), HYSTERESIS: (2.0, 1.0, 6.0)}
    for row in rows:
        for what, limit in zip(MEASURES, limits.get(row.kind, ()), strict=False):
            asked.append((f"replay of {row.name}, {what} within {limit:g} %", abs(row.off(what)), limit, "%"))
        if row.kind == BENCH_ROW:
            words = f"the bench's map misses the compression of {row.name} by more than 50 %"
            asked.append((words, -abs(row.off("compression")), -50.0, "%"))
    for one, other in pairwise(rows):
        if one.kind == HYSTERESIS:
            words = f"hysteresis lowers the rms of {one.name} more than 3 times"
            asked.append((words, -other.rms / one.rms, -3.0, "times"))
    most = {"stance": 3.0, "flight": 6.0, "compression": 5.0, "heat": 10.0}
    for name, what, _, _, off in alone:
        kind = next(kind for kind in most if what.startswith(kind))
        asked.append((f"{name} by the configuration, {kind} within {most[kind]:g} %", abs(off), most[kind], "%"))
    return [(what, f"{abs(off):.3g} {unit}", "yes" if off < limit else "NO") for what, off, limit, unit in asked]


def read(folders: list[Path]) -> list[Condition]:
    """Reads all hops in folders, by condition."""
    found: dict[tuple[bool, float, str], list[tuple[int, Log]]] = {}
    for path in sorted(path for folder in folders for path in folder.iterdir()):
        if name := PLAIN.fullmatch(path.name):
            key = not name["condition"].startswith("no_"), float(name["mass"]) / 1000.0, name["condition"]
            found.setdefault(key, []).append((int(name["hop"]), Log.read(path, COLUMNS)))
    conditions = []
    for (_, mass, name), hops in sorted(found.items()):
        logs = tuple(log for _, log in sorted(hops, key=lambda each: each[0]))
        with_stance = tuple(log for log in logs if has_stance(log))
        conditions.append(Condition(name, mass, with_stance, Log.join(logs, name)))
    return conditions


def has_stance(log: Log) -> bool:
    """Tells whether a file is a hop: the controller takes the air for the ground at times."""
    try:
        phases = find_phases(load("crank_hopper"), log)
    except BadFile:
        return False
    return any(phase.name == "stance" and not phase.left_out and phase.duration > 0.1 for phase in phases)


def leg(mass: float, spring: Spring | None = None) -> HybridSystem:
    """The leg at a mass, by default without a spring."""
    robot = vary(load("crank_hopper"), boom_z_mass=mass - FOOT)
    own = robot.settings.springs["leg"]
    return hopping(robot, spring={"leg": replace(own, stiffness=0.0, damping=0.0) if spring is None else spring})


def fitted(name: str, fit: MotionFit) -> tuple[str, ...]:
    """A row of fitted values."""
    values = [f"{fit[each].value:.4g} ± {fit[each].deviation:.2g}" for each in FREE]
    return (name, *values, f"{degrees(fit.rms):.3f}", str(len(fit.arcs)))


def settled(plain: Condition, springy: Condition | None, settle: float) -> tuple[str, ...]:
    """A row of values fitted with another time left out, and of the hysteresis that follows with them.

    The guide's friction was held for it, and adds its deviation: what one takes from the motion, the other does not.
    """
    fit = identify_motion(leg(plain.mass), plain.whole, FREE, settle=settle)
    found = [f"{fit[each].value:.4g} ± {fit[each].deviation:.2g}" for each in FREE]
    if springy is None:
        return (f"{1e3 * settle:.0f}", *found, "")
    own = replace(load("crank_hopper").settings.springs["leg"], damping=0.0)
    values = {name: fit[name].value for name in FREE}
    spring = identify_motion(leg(springy.mass, own), springy.hops, SPRING, start=values, phases=["stance"])[
        "hysteresis"
    ]
    deviation = np.hypot(spring.deviation, fit["boom_z_friction"].deviation)
    return (f"{1e3 * settle:.0f}", *found, f"{spring.value:.3g} ± {deviation:.2g}")


def with_spring(condition: Condition, values: Mapping[str, float], folders: list[Path]) -> list[Row]:
    """Rows of hops with a spring, fitted on the first hop with and without hysteresis, and by the bench's map."""
    own = load("crank_hopper").settings.springs["leg"]
    first, others = condition.hops[0], condition.hops[1:]
    system = leg(condition.mass, replace(own, damping=0.0))
    last = Log.join(others, "others") if others else condition.whole
    rows = []
    for kind, over in ((HYSTERESIS, SPRING), ("a linear spring, fitted on the first hop", SPRING[:-1])):
        fit = identify_motion(system, first, over, start=values, phases=["stance"])
        both = identify_motion(system, condition.hops, over, start=values, phases=["stance"])
        words = ", ".join(f"{name} {fit[name].value:.4g} ± {fit[name].deviation:.2g}" for name in over)
        words += f"; rms {degrees(fit.rms):.3f} deg, of all hops {degrees(both.rms):.3f}"
        found = replay(system, last, {**values, **{name: fit[name].value for name in over}})
        rows.append(Row(condition.name, kind, found, words, both.rms))
    for folder in folders:
        if (folder / BENCH).is_file():
            taken = leg(condition.mass, bench(folder / BENCH))
            rows.append(Row(condition.name, BENCH_ROW, replay(taken, condition.whole, values)))
    return rows


def bench(path: Path) -> Spring:
    """The spring as measured on a bench, at the twist nearest to none."""
    turns, lengths, forces = np.genfromtxt(path, delimiter=",", skip_header=1).T
    here = turns == turns[np.argmin(np.abs(turns))]
    lengths, forces = 1e-3 * lengths[here], forces[here]
    zero = float(np.interp(0.0, forces, lengths))
    points = sorted([(0.0, 0.0), *zip((lengths - zero).tolist(), forces.tolist(), strict=True)])
    own = load("crank_hopper").settings.springs["leg"]
    return replace(own, stiffness=0.0, damping=0.0, unilateral=False, rest=GRID + zero, table=tuple(points))


def configured_rows(condition: Condition, config: Mapping[str, Any], values: Mapping[str, float]) -> list[Alone]:
    """Rows that compare the hop by its configuration, a limit cycle, with the log; events found alike in both."""
    said = config["controller"][condition.name]
    _, flight, stance = said["kp_Nm_per_rad_startup_flight_stance"]
    law = ConfiguredLaw(
        values["torque_scale"],
        stance,
        flight,
        said["kd_startup_flight_stance"][1],
        said["x0_rad"],
        said["x_td_rad"],
        said["x_lo_rad"],
        *said["u_ff_stance_coefficients_in_s_eq_t_minus_0p1_over_0p1"],
        values["crank_friction"],
        values["boom_z_friction"],
    )
    numbers = {name: values[name] for name in ("crank_armature", "crank_viscous")}
    robot = vary(load("crank_hopper"), boom_z_mass=condition.mass - FOOT, **numbers)
    system = configured(robot, law)
    run = simulate(system, system.guess(), CYCLES, samples=400, progress=False)
    t, angle, torque = sampled(run, system.robot, begin=run.t[-1] - 2.5)
    rates = np.gradient(angle, t)  # the model's torque on the crank has its friction taken off
    logged = (torque + law.crank_friction * np.tanh(rates / SLOW["rad"])) / values["torque_scale"]
    hops = Log("model", t - t[0], {"crank": angle, "crank_torque": logged})
    lands, motor = said["x_td_rad"], config["motor"]
    model, log = (measures(robot, each, lands, motor) for each in (hops, condition.whole))
    if run.reason != "complete":
        return [(condition.name, f"stance: {run.reason}", np.nan, np.nan, np.nan)]
    return [(condition.name, what, model[what], log[what], 100.0 * (model[what] / log[what] - 1.0)) for what in model]


def measures(robot: Any, log: Log, lands: float, motor: Mapping[str, Any]) -> dict[str, float]:
    """Measures of a log, alike for the model's and the leg's.

    They are the durations of stances and flights, how far the leg is compressed beyond the angle at which the law
    lands, and the heat of the windings with the net work of the motor in a hop, by the torque as logged.
    """
    phases = [phase for phase in find_phases(robot, log) if not phase.left_out]
    joints = find_measured(robot, log)

    def mean(name: str, of: Any, parts: list[LogPhase]) -> float:
        return float(np.mean([of(part) for part in parts if part.name == name]))

    def compression(phase: LogPhase) -> float:
        inside = (log.t >= phase.begin) & (log.t <= phase.end)
        lengths = joints.lengths(log["crank"][inside, None])
        return float(joints.lengths(np.array([[lands]]))[0] - lengths.min())

    rates = np.interp(log.t, *smooth_rate(log.t, log["crank"]))
    torque, per_ampere = log["crank_torque"], motor["logged_torque_over_q_current_Nm_per_A"]
    power = torque * rates + motor["R_ohm"] * (torque / per_ampere) ** 2

    def energy(begin: float, end: float) -> float:
        inside = (log.t >= begin) & (log.t <= end)
        return float(np.trapezoid(power[inside], log.t[inside]))

    landings = [phase.begin for phase in phases if phase.name == "stance"]
    hops = [(one, other) for one, other in pairwise(landings) if other - one < LONGEST]
    stances = [phase for phase in phases if phase.name == "flight" or phase.duration > 0.1]
    return {
        "stance, s": mean("stance", lambda phase: phase.duration, stances),
        "flight, s": mean("flight", lambda phase: phase.duration, [phase for phase in phases if phase.whole]),
        "heat and work a hop, J": float(np.mean([energy(*hop) for hop in hops])),
        "compression, m": mean("stance", compression, [phase for phase in stances if phase.begin > 0.0]),
    }


if __name__ == "__main__":
    main()
