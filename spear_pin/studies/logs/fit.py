"""Fits numbers of a leg to a log of its hops, by shooting over its stances and flights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from os.path import realpath
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import unit
from spear_pin.kinds import typed
from spear_pin.showing import Shown
from spear_pin.studies.fitting import search
from spear_pin.studies.logs.arcs import SETTLE, LogArc, find_arcs
from spear_pin.studies.logs.doubts import doubts
from spear_pin.studies.logs.given import UNBOUNDED, check_names, check_values
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import FLIGHT, STANCE, find_measured
from spear_pin.studies.logs.phases import LogPhase
from spear_pin.studies.logs.played import make_played, played_with, with_own
from spear_pin.studies.logs.residuals import HEIGHT, HEIGHT_SENSOR, LAG, ZERO, Residuals
from spear_pin.studies.logs.shooting import Shot
from spear_pin.studies.logs.spread import Found, correlation_time, spread, spread_by_parts

TOLERANCE = 1e-10
EVALUATIONS = 60
REWEIGHTED = 2  # times that a second sensor's noise is taken anew
COARSE, FINEST = 0.05, 8  # of residuals or slopes, by which halved steps may change them; and times shorter steps
NOTHING = 1e-4  # size of residuals, in rad, below which such changes do not matter
STIFF = "friction makes the motion stiffer than the integration resolves: deviations may be wrong"


@dataclass(frozen=True, repr=False)
class MotionFit(Shown):
    """Values fitted to logs, and how far to trust them.

    Attributes:
        source: the system as it was given.
        system: the system with the values that are its own numbers.
        leg: the leg as it was shot, with all values, see `make_played`.
        joints: names of the measured joints, then "boom_z" if its sensor was fitted.
        found: the values, by name.
        correlation: their correlations, (k, k), in that order.
        arcs: the phases that were shot over.
        shots: the model's motion over each of them.
        residuals: model less log, for each of them, (n, m), in rad or m; NaN where nothing was measured.
        rms: root of the mean square of the weighted residuals, in rad: those in m are divided by the leg's length, and
            those of "boom_z" count by their own noise.
        inflation: factor by which deviations are larger than those of white residuals, at least.
        left_out: phases that were not used, with the reason.
        doubts: what to keep in mind, in sentences.
        converged: whether the search met its tolerance.
        evaluations: how often all arcs were shot.
    """

    source: HybridSystem
    system: HybridSystem
    leg: HybridSystem
    joints: tuple[str, ...]
    found: Mapping[str, Found]
    correlation: Array
    arcs: tuple[LogArc, ...]
    shots: tuple[Shot, ...]
    residuals: tuple[Array, ...]
    rms: float
    inflation: float
    left_out: tuple[LogPhase, ...]
    doubts: tuple[str, ...]
    converged: bool
    evaluations: int

    def __getitem__(self, name: str) -> Found:
        """Returns a value by its name.

        Raises:
            UnknownName: it was not fitted.
        """
        if name not in self.found:
            raise UnknownName("fitted value", name, self.found)
        return self.found[name]

    @property
    def unit(self) -> str:
        """The unit of `rms`, and how lengths count in it."""
        units = [self.leg.robot.units[self.leg.robot.index(name)] for name in self.joints]
        return "rad, lengths weighted" if "m" in units else "rad"

    def __repr__(self) -> str:
        values = ", ".join(f"{name} {each.value:.4g} ± {each.deviation:.2g}" for name, each in self.found.items())
        return f"MotionFit({values}; {len(self.arcs)} phases, rms {self.rms:.3g})"


@typed
def identify_motion(
    system: HybridSystem,
    log: Log | Sequence[Log],
    over: Sequence[str],
    *,
    start: Mapping[str, float] | None = None,
    phases: Sequence[str] = (STANCE, FLIGHT),
    settle: float = SETTLE,
) -> MotionFit:
    """Fits numbers of a leg to logs of hops, by least squares of the measured positions.

    Measured torques drive the model over each stance and flight, each from a state that is fitted, too: touchdown and
    lift-off need not be modelled. Derivatives are exact.

    Args:
        system: the leg, such as `hopping(load("crank_hopper"))`; its law is not used.
        log: a log, or several.
        over: names of what is fitted: numbers of robot and springs, such as "crank_armature", "stiffness", "rest" and
            "hysteresis"; "torque_scale", by which measured torques are multiplied; Coulomb's friction of a joint,
            "crank_friction"; the zero of a joint's sensor, "crank_zero"; and "lag", how late positions are stamped.
            With "boom_z_zero" or "boom_z_lag" the log's "boom_z", the height of the base, is used with its own noise.
        start: values from which the search begins, or that are held if they are not in `over`.
        phases: which phases are shot over: "stance", "flight" or both.
        settle: time after each touchdown that is left out, in s.

    Raises:
        BadFile: a log has no hop.
        BadValue: a robot, a log or a value does not fit; the model's motion blows up; or the log does not tell two
            numbers apart at all.
        UnknownName: there is no number of a name.

    Example:
        >>> from tempfile import mkdtemp
        >>> from spear_pin import Log, hopping, identify_motion, load, simulate
        >>> leg = hopping(load("spear_ii", locked=["boom_x"]))
        >>> file = simulate(leg, leg.guess(), cycles=2).export(f"{mkdtemp()}/hops.csv")
        >>> identify_motion(leg, Log.read(file), ["stiffness"])
        MotionFit(stiffness 4...; 4 phases, rms 0.000...)
    """
    logs = [log] if isinstance(log, Log) else list(log)
    over, given = tuple(over), dict(start or {})
    require("settle", settle, lambda time: time >= 0, "a number >= 0, in s")
    if not over or len(set(over)) < len(over):
        raise BadValue("over", list(over), "names of some numbers, each once")
    if not phases or {*phases} - {STANCE, FLIGHT}:
        raise BadValue("phases", list(phases), "'stance', 'flight' or both")
    if not logs:
        raise BadValue("log", logs, "a log at least")
    if len({realpath(each.source) for each in logs}) < len(logs):
        raise BadValue("log", [each.source for each in logs], "different logs, each once")
    joints = find_measured(system.robot, logs[0])
    beside = (HEIGHT,) if {*HEIGHT_SENSOR} & {*over, *given} else ()
    leg, of_sensors = make_played(system), [*(f"{joint}{ZERO}" for joint in joints.joints), LAG]
    of_sensors += HEIGHT_SENSOR if beside else ()
    own = tuple(name for name in over if name not in of_sensors)
    check_names(leg, system, (*over, *given), of_sensors)
    check_values(given)
    leg = played_with(leg, system, {name: value for name, value in given.items() if name not in of_sensors})
    arcs, left_out = [], list[LogPhase]()
    for each in logs:
        some, others = find_arcs(system, joints, each, settle, beside=beside)
        arcs += [arc for arc in some if arc.phase.name in phases]
        left_out += others
    if not arcs:
        raise BadValue("log", [each.source for each in logs], "one with a stance or flight that can be used")
    sensors = {name: float(given.get(name, 0.0)) for name in of_sensors}
    problem = Residuals(system, leg, joints, tuple(arcs), over, own, sensors, beside)
    return _solved(problem, given, tuple(left_out))


def _unit(problem: Residuals, name: str) -> str:
    """Returns the unit of a fitted value."""
    if name in (LAG, HEIGHT_SENSOR[1]):
        return "s"
    joint = name.removesuffix(ZERO)
    if name in problem.sensors:
        return problem.leg.robot.units[problem.leg.robot.index(joint)]
    return unit(problem.system, name) or unit(problem.leg, name)


def _solved(problem: Residuals, given: Mapping[str, float], left_out: tuple[LogPhase, ...]) -> MotionFit:
    first = problem.first()
    problem = _bounded(problem, first, given)
    spread(problem, problem.joined(first), 1.0)  # what is not told apart is refused before the search
    while True:
        solution = _search(problem, first)
        for _ in range(REWEIGHTED if problem.beside else 0):
            problem = problem.balanced(np.asarray(solution.x))
            solution = _search(problem, np.asarray(solution.x))
        x, k = np.asarray(solution.x), len(problem.over)
        finer = replace(problem, steps=2 * problem.steps)
        coarse = _differ(problem.joined(x), finer.joined(x))
        if not coarse or finer.steps > FINEST:
            break
        problem, first = _bounded(finer, x, given), x
    shots = problem.shots(x)
    residuals = tuple(residual for _, residual, _ in shots)
    each_alone = [each[np.isfinite(each)] for residual in residuals for each in residual.T]
    inflation = float(np.sqrt(np.mean([correlation_time(each) for each in each_alone if each.size])))
    last = problem.joined(x)
    noisy, correlation = spread(problem, last, inflation)
    deviations = np.maximum(noisy, spread_by_parts(problem, last, problem.parts))
    units = {name: _unit(problem, name) for name in problem.over}
    values = zip(problem.over, x[:k].tolist(), deviations.tolist(), strict=True)
    found = {name: Found(value, deviation, units[name]) for name, value, deviation in values}
    leg = problem.leg_with(x)
    return MotionFit(
        problem.system,
        with_own(problem.system, leg, {name: found[name].value for name in problem.own}),
        leg,
        problem.names,
        found,
        correlation,
        problem.arcs,
        tuple(shot for shot, _, _ in shots),
        residuals,
        float(np.sqrt(np.mean(last[0] ** 2))),
        inflation,
        left_out,
        (*doubts(problem, correlation, solution, shots), *([STIFF] if coarse else [])),
        bool(solution.success),
        int(solution.nfev),
    )


def _bounded(problem: Residuals, x: Array, given: Mapping[str, float]) -> Residuals:
    """Returns the same with steps that are short enough for the motion not to blow up.

    Raises:
        BadValue: there are none.
    """
    while not all(shot.bounded for shot, _, _ in problem.shots(x)):
        if problem.steps >= FINEST:
            raise BadValue("start", {**given, **dict(zip(problem.over, x.tolist(), strict=False))}, UNBOUNDED)
        problem = replace(problem, steps=2 * problem.steps)
    return problem


def _search(problem: Residuals, first: Array) -> Any:
    lower, upper = problem.bounds(first)
    return search(problem.joined, np.clip(first, lower + 1e-9, upper), (lower, upper), TOLERANCE, EVALUATIONS)


def _differ(one: tuple[Array, Array], other: tuple[Array, Array]) -> bool:
    """Tells whether residuals, or a column of their Jacobian, change much as the steps are halved."""
    return any(
        np.linalg.norm(a - b) > COARSE * max(float(np.linalg.norm(b)), NOTHING)
        for a, b in zip((one[0], *one[1].T), (other[0], *other[1].T), strict=True)
    )
