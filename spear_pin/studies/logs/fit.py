"""Fits numbers of a leg to a log of its hops, by shooting over its stances and flights."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from scipy.interpolate import CubicHermiteSpline
from scipy.optimize import least_squares

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, listed, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number, unit, with_numbers
from spear_pin.kinds import typed
from spear_pin.showing import Shown
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import FLIGHT, STANCE, Measured, measured
from spear_pin.studies.logs.phases import GRAVITY, LogPhase, find_phases
from spear_pin.studies.logs.played import FRICTION, number_of, played
from spear_pin.studies.logs.shooting import Shooter, Shot, with_torques

SETTLE = 0.012  # s after a touchdown that are left out: the foot bounces, and the leg rings
MARGIN = 0.002  # s on both sides of a lift-off, which is not known better
ZERO, LAG, HYSTERESIS = "_zero", "lag", "hysteresis"
RATE = 8  # samples from which a first rate follows
STEP = 1e-5  # rad or m, by which a start is differentiated
ALIKE = 0.98  # correlation of two values that are hardly told apart
SINGULAR = 1e-5  # of the largest singular value, with columns of length one: what the data do not tell at all
TOLERANCE = 1e-10
EVALUATIONS = 60


@dataclass(frozen=True)
class Found:
    """A value that was fitted.

    Attributes:
        value: the value, in its unit.
        deviation: its standard deviation, inflated for residuals that are correlated in time.
        unit: the unit.
    """

    value: float
    deviation: float
    unit: str


@dataclass(frozen=True)
class Arc:
    """A phase of a log that is shot over.

    Attributes:
        phase: the phase.
        t: times of its samples, (n,), in s.
        positions: measured positions at them, (n, m).
        torques: torques of the motors at them, (n, nu).
        near: configuration at the first sample, (nv,), with the toe on the ground.
        latched: configuration at touchdown, (nv,).
        base: rates of the base at the first sample of a flight, in m/s, from the push-off; None for a stance.
        source: the log's name.
    """

    phase: LogPhase
    t: Array
    positions: Array
    torques: Array
    near: Array
    latched: Array
    base: Array | None
    source: str


@dataclass(frozen=True, repr=False)
class MotionFit(Shown):
    """Values fitted to logs, and how far to trust them.

    Attributes:
        source: the system as it was given.
        system: the system with the values that are its own numbers.
        leg: the leg as it was shot, with all values, see `played`.
        joints: names of the measured joints.
        found: the values, by name.
        correlation: their correlations, (k, k), in that order.
        arcs: the phases that were shot over.
        shots: the model's motion over each of them.
        residuals: model less log, for each of them, (n, m), in rad or m.
        rms: root of their mean square.
        inflation: factor by which deviations are larger than those of white residuals.
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
    arcs: tuple[Arc, ...]
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

    Measured torques drive the model over each stance and flight, from a state of its own that is fitted as well: touchdown
    and lift-off need not be modelled. Derivatives are exact.

    Args:
        system: the leg, such as `hopping(load("crank_hopper"))`; its law is not used.
        log: a log, or several.
        over: names of what is fitted: numbers of robot and springs, such as "crank_armature", "stiffness", "rest" and
            "hysteresis"; "torque_scale", by which measured torques are multiplied; Coulomb's friction of a joint,
            "crank_friction"; the zero of a joint's sensor, "crank_zero"; and "lag", how late positions are stamped.
        start: values from which the search begins, or that are held if they are not in `over`.
        phases: which phases are shot over: "stance", "flight" or both.
        settle: time after each touchdown that is left out, in s.

    Raises:
        BadFile: a log has no hop.
        BadValue: a robot, a log or a value does not fit; or the log does not tell two numbers apart at all.
        UnknownName: there is no number of a name.
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
    joints = measured(system.robot, logs[0])
    leg, of_sensors = played(system), [*(f"{joint}{ZERO}" for joint in joints.joints), LAG]
    own = tuple(name for name in over if name not in of_sensors)
    for name in (*own, *(name for name in given if name not in of_sensors)):
        _known(leg, number_of(system, name)[0], of_sensors)
    leg = played_with(leg, system, {name: value for name, value in given.items() if name not in of_sensors})
    arcs, left_out = [], list[LogPhase]()
    for each in logs:
        some, others = arcs_of(system, joints, each, settle)
        arcs += [arc for arc in some if arc.phase.name in phases]
        left_out += others
    if not arcs:
        raise BadValue("log", [each.source for each in logs], "one with a stance or flight that can be used")
    sensors = {name: float(given.get(name, 0.0)) for name in of_sensors}
    problem = _Problem(system, leg, joints, tuple(arcs), over, own, sensors)
    return _solved(problem, tuple(left_out))


def played_with(leg: HybridSystem, system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns a played leg with other numbers, by the names of `identify_motion`."""
    named = {name: number_of(system, name) for name in values}
    return with_numbers(leg, {named[name][0]: value - named[name][1] for name, value in values.items()})


def _unit(problem: _Problem, name: str) -> str:
    """Returns the unit of a fitted value."""
    if name == LAG:
        return "s"
    joint = name.removesuffix(ZERO)
    if name in problem.sensors:
        return problem.leg.robot.units[problem.leg.robot.index(joint)]
    return unit(problem.system, name) or unit(problem.leg, name)


def _known(leg: HybridSystem, name: str, of_sensors: Sequence[str]) -> None:
    try:
        number(leg, name)
    except UnknownName as error:
        raise UnknownName("number of the leg", name, [*error.valid, *of_sensors]) from None


def arcs_of(
    system: HybridSystem, joints: Measured, log: Log, settle: float, whole: bool = False
) -> tuple[list[Arc], list[LogPhase]]:
    """Returns the arcs of a log, and the phases that are left out.

    Args:
        system: the leg.
        joints: its measured joints.
        log: the log.
        settle: time after each touchdown that is left out, in s; half of it before one.
        whole: whether a stance goes on to the next touchdown.
    """
    found, left_out = list[Arc](), list[LogPhase]()
    ratios = {joint: system.robot.gear_ratio(joint) for joint in system.robot.actuated}
    torques = with_torques(log, system.robot.actuated, ratios)
    positions = np.column_stack([log[name] for name in joints.joints])
    good = np.isfinite(positions).all(axis=1) & np.isfinite(torques).all(axis=1)
    latched: Array | None = None
    phases = find_phases(system.robot, log)
    for i, phase in enumerate(phases):
        stance, ends = phase.name == STANCE, phase.end
        begin = phase.begin + (settle if stance else MARGIN)
        if whole and stance and i + 1 < len(phases):
            ends = phases[i + 1].end
        end = ends - (MARGIN if stance and ends == phase.end else settle / 2)
        inside = np.flatnonzero(good & (log.t >= begin) & (log.t <= end))
        before = np.flatnonzero(good & (log.t <= phase.begin))
        if stance:
            at = [np.interp(phase.begin, log.t[good], each) for each in positions[good].T]
            latched = joints.configuration(np.array(at), latched)
        if not stance and len(before) < RATE:
            phase = replace(phase, left_out=phase.left_out or "its lift-off is not in the log")
        elif len(inside) < RATE:
            phase = replace(phase, left_out=phase.left_out or f"only {len(inside)} samples of it can be used")
        if phase.left_out:
            left_out.append(phase)
            continue
        near = joints.configuration(positions[inside[0]], latched)
        base = None
        if not stance:  # until lift-off the toe was at rest
            last = before[-RATE:]
            at = joints.state(STANCE, positions[last[-1]], rates_of(joints, STANCE, log.t[last], positions[last], -1), near)
            base = at[[joints.robot.nv + row for row in joints.base]]
            falls = [GRAVITY if joints.robot.coordinates[row] == "boom_z" else 0.0 for row in joints.base]
            base = base - np.array(falls) * (log.t[inside[0]] - log.t[last[-1]])
        source = near if latched is None else latched
        found.append(Arc(phase, log.t[inside], positions[inside], torques[inside], near, source, base, log.source))
    return found, left_out


def rates_of(joints: Measured, name: str, t: Array, positions: Array, place: int) -> Array:
    """Returns the leading rates at the first or the last of some samples, by a parabola through them."""
    lines = np.polyfit(t - t[place], positions, 2)[1]
    return np.array([lines[joints.rows.index(row)] for row in joints.leading[name]])


@dataclass(frozen=True)
class _Problem:
    """Residuals of all arcs, with their Jacobian by the fitted values, then by where each arc sets out."""

    system: HybridSystem
    leg: HybridSystem
    joints: Measured
    arcs: tuple[Arc, ...]
    over: tuple[str, ...]
    own: tuple[str, ...]
    sensors: Mapping[str, float]

    @cached_property
    def places(self) -> list[slice]:
        """Places of the unknowns of each arc's start."""
        sizes = [len(self.joints.rows) + len(self.joints.leading[arc.phase.name]) for arc in self.arcs]
        ends = len(self.over) + np.cumsum([0, *sizes])
        return [slice(int(i), int(j)) for i, j in zip(ends[:-1], ends[1:], strict=True)]

    @cached_property
    def weights(self) -> Array:
        """Weights of the measured joints, (m,): those of a length in m count as angles of its leg do."""
        length = max(self.joints.length(arc.near) for arc in self.arcs)
        units = [self.leg.robot.units[row] for row in self.joints.rows]
        return np.array([1.0 if unit == "rad" else 1.0 / length for unit in units])

    def number(self, name: str) -> float:
        """Returns a number of the leg, by its name for users."""
        key, offset = number_of(self.system, name)
        return number(self.leg, key) + offset

    def first(self) -> Array:
        """Returns the values from which the search begins."""
        values = [self.sensors[name] if name in self.sensors else self.number(name) for name in self.over]
        some = slice(0, RATE)
        rates = [rates_of(self.joints, arc.phase.name, arc.t[some], arc.positions[some], 0) for arc in self.arcs]
        starts = [np.concatenate([arc.positions[0], own]) for arc, own in zip(self.arcs, rates, strict=True)]
        return np.concatenate([values, *starts])

    def bounds(self, first: Array) -> tuple[Array, Array]:
        """Returns least and largest values: what is positive stays so, and friction may vanish."""
        lower = np.full(len(first), -np.inf)
        for i, (name, value) in enumerate(zip(self.over, first, strict=False)):
            if name.endswith((FRICTION, HYSTERESIS)):
                lower[i] = 0.0
            elif name in self.own and value > 0.0 and not ("_com_" in name or "." in name or name.endswith("rest")):
                lower[i] = 1e-6 * value
        return lower, np.full(len(first), np.inf)

    def leg_with(self, x: Array) -> HybridSystem:
        """Returns the leg with the fitted values among x."""
        values = dict(zip(self.over, x[: len(self.over)].tolist(), strict=True))
        return played_with(self.leg, self.system, {name: values[name] for name in self.own})

    def shots(self, x: Array, steps: int = 1) -> list[tuple[Shot, Array, Array]]:
        """Returns, of each arc, the shot, the residuals, (n, m), and their Jacobian, (n, m, unknowns)."""
        k, keys = len(self.over), tuple(number_of(self.system, name)[0] for name in self.own)
        shooter = Shooter(self.leg_with(x), keys)
        values = dict(self.sensors) | dict(zip(self.over, x[:k].tolist(), strict=True))
        zeros = np.array([values[f"{joint}{ZERO}"] for joint in self.joints.joints])
        rows = self.joints.rows
        rate_rows = [self.leg.robot.nv + row for row in rows]
        found = []
        for mine, arc in zip(self.places, self.arcs, strict=True):
            y, slope = self._begin(x[mine], arc)
            dy = np.hstack([np.zeros((len(y), len(self.own))), slope])
            shot = shooter.shoot(arc.phase.name, arc.t, arc.torques, y, dy, arc.latched, steps)
            late = values[LAG]
            positions = CubicHermiteSpline(arc.t, shot.y[:, rows], shot.y[:, rate_rows])
            residual = positions(arc.t - late) + zeros - arc.positions
            jacobian = np.zeros((*residual.shape, len(x)))
            whole = CubicHermiteSpline(arc.t, shot.dy[:, rows], shot.dy[:, rate_rows])(arc.t - late)
            jacobian[:, :, [self.over.index(name) for name in self.own]] = whole[:, :, : len(self.own)]
            jacobian[:, :, mine] = whole[:, :, len(self.own) :]
            for j, joint in enumerate(self.joints.joints):
                if f"{joint}{ZERO}" in self.over:
                    jacobian[:, j, self.over.index(f"{joint}{ZERO}")] = 1.0
            if LAG in self.over:
                jacobian[:, :, self.over.index(LAG)] = -positions(arc.t - late, 1)
            found.append((shot, residual, jacobian))
        return found

    def _begin(self, at: Array, arc: Arc) -> tuple[Array, Array]:
        """Returns the state at which an arc sets out, (2 nv,), and its derivatives, (2 nv, d), by differences."""
        m = len(self.joints.rows)

        def state(at: Array) -> Array:
            return self.joints.state(arc.phase.name, at[:m], at[m:], arc.near, arc.base)

        steps = STEP * np.eye(len(at))
        return state(at), np.array([(state(at + h) - state(at - h)) / (2.0 * STEP) for h in steps]).T

    def joined(self, x: Array) -> tuple[Array, Array]:
        """Returns all residuals, (N,), weighted, and their Jacobian, (N, unknowns)."""
        shots = self.shots(x)
        residuals = [(self.weights * residual).ravel() for _, residual, _ in shots]
        jacobians = [(self.weights[:, None] * jacobian).reshape(-1, len(x)) for _, _, jacobian in shots]
        return np.concatenate(residuals), np.vstack(jacobians)


def _solved(problem: _Problem, left_out: tuple[LogPhase, ...]) -> MotionFit:
    first = problem.first()
    bounds = problem.bounds(first)
    first = np.clip(first, bounds[0] + 1e-9, bounds[1])
    last: dict[bytes, tuple[Array, Array]] = {}

    def at(x: Array) -> tuple[Array, Array]:
        key = x.tobytes()
        if key not in last:
            last.clear()
            last[key] = problem.joined(x)
        return last[key]

    _spread(problem, at(first), 1.0)  # what is not told apart is refused before the search
    solution = least_squares(
        lambda x: at(x)[0],
        first,
        lambda x: at(x)[1],
        bounds=bounds,
        x_scale="jac",
        ftol=TOLERANCE,
        xtol=TOLERANCE,
        gtol=TOLERANCE,
        max_nfev=EVALUATIONS,
    )
    x, k = np.asarray(solution.x), len(problem.over)
    shots = problem.shots(x)
    residuals = tuple(residual for _, residual, _ in shots)
    inflation = float(np.sqrt(np.mean([_correlation_time(each) for residual in residuals for each in residual.T])))
    deviations, correlation = _spread(problem, at(x), inflation)
    units = {name: _unit(problem, name) for name in problem.over}
    values = zip(problem.over, x[:k].tolist(), deviations.tolist(), strict=True)
    found = {name: Found(value, deviation, units[name]) for name, value, deviation in values}
    leg = problem.leg_with(x)
    return MotionFit(
        problem.system,
        _with_own(problem.system, leg, {name: found[name].value for name in problem.own}),
        leg,
        problem.joints.joints,
        found,
        correlation,
        problem.arcs,
        tuple(shot for shot, _, _ in shots),
        residuals,
        float(np.sqrt(np.mean(np.concatenate([(problem.weights * each).ravel() for each in residuals]) ** 2))),
        inflation,
        left_out,
        tuple(_doubts(problem, found, correlation, solution, shots)),
        bool(solution.success),
        int(solution.nfev),
    )


def _with_own(system: HybridSystem, leg: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns the user's system with those fitted values that it has itself."""
    of_law = {*type(leg.law).__dataclass_fields__}
    return with_numbers(system, {name: value for name, value in values.items() if name not in of_law})


def _spread(problem: _Problem, at: tuple[Array, Array], inflation: float) -> tuple[Array, Array]:
    """Returns the standard deviations of the fitted values, and their correlations.

    Raises:
        BadValue: some values cannot be told apart at all.
    """
    residual, jacobian = at
    k = len(problem.over)
    own, starts = jacobian[:, :k], jacobian[:, k:]
    basis, _ = np.linalg.qr(starts)
    seen = own - basis @ (basis.T @ own)  # what no start explains
    lengths = np.linalg.norm(seen, axis=0)
    scaled = seen / np.where(lengths > 0.0, lengths, 1.0)
    _, sizes, rows = np.linalg.svd(scaled, full_matrices=False)
    if sizes[-1] < SINGULAR * sizes[0]:
        alike = [name for name, share in zip(problem.over, np.abs(rows[-1]), strict=True) if share > 0.2]
        expected = f"fewer of them: the log does not tell {listed(alike)} apart"
        raise BadValue("over", list(problem.over), f"{expected}; hold one, {_anchor(alike)}")
    free = max(len(residual) - jacobian.shape[1], 1)
    covariance = np.linalg.inv(scaled.T @ scaled) * float(residual @ residual) / free
    spread = np.sqrt(np.diag(covariance))
    return inflation * spread / lengths, covariance / np.outer(spread, spread)


def _anchor(alike: Sequence[str]) -> str:
    if any(name == "torque_scale" or name.endswith(("_mass", "_armature", "_inertia")) for name in alike):
        return "such as a mass that was weighed, or the torque's scale from a force that was measured"
    return "at a value that was measured otherwise"


def _correlation_time(residual: Array) -> float:
    """Returns how many samples in a row say the same: 1 + 2 Σ of the correlations until they vanish."""
    away = residual - residual.mean()
    products = np.correlate(away, away, "full")[len(away) - 1 :]
    if not products[0] > 0.0:
        return 1.0
    shares = products / products[0]
    ends = np.flatnonzero(shares <= 0.0)
    return float(1.0 + 2.0 * shares[1 : ends[0] if ends.size else len(shares)].sum())


def _doubts(problem: _Problem, found: Mapping[str, Found], correlation: Array, solution: Any, shots: Any) -> list[str]:
    doubts = []
    if not solution.success:
        doubts.append(f"the search did not converge in {solution.nfev} evaluations")
    for name, side in zip(problem.over, solution.active_mask, strict=False):
        if side:
            doubts.append(f"{name} is at its bound, {found[name].value:g}: its deviation means nothing")
    for i, one in enumerate(problem.over):
        for j, other in enumerate(problem.over[:i]):
            if abs(correlation[i, j]) > ALIKE:
                larger = (1.0 - min(correlation[i, j] ** 2, 1.0 - 1e-12)) ** -0.5
                pair = f"{other} and {one} are hardly told apart (correlation {correlation[i, j]:.3f})"
                doubts.append(f"{pair}: with one held, the other's deviation would be {larger:.0f} times less")
    if "torque_scale" in problem.over:
        doubts.append("masses were held: torque_scale and all inertias and forces go with them")
    for arc, (shot, residual, _) in zip(problem.arcs, shots, strict=True):
        where = f"the {arc.phase.name} from {arc.phase.begin:.3f} s of {arc.source}"
        if arc.phase.name == STANCE and float(shot.forces[:-3, -1].min()) < 0.0:
            doubts.append(f"in {where} the toe pulls on the ground: perhaps it is in the air")
        worst = float(np.sqrt(np.mean(residual**2)))
        if worst > 4.0 * float(np.median([np.sqrt(np.mean(each**2)) for _, each, _ in shots])):
            doubts.append(f"{where} fits worse than the others, rms {worst:.2g}: perhaps it is something else")
    return doubts
