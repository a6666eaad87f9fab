"""`continue_gait` follows the branch of gaits through a given gait."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait, UnknownName, require
from spear_pin.gaits.attempts import WHY
from spear_pin.gaits.continuation.borders import Border
from spear_pin.gaits.continuation.branch import BorderPoint, Branch, End, SpecialPoint
from spear_pin.gaits.continuation.follow import BORDER, CLOSED, LOST, Way, follow
from spear_pin.gaits.continuation.gaits import Gaits
from spear_pin.gaits.continuation.problem import NoValue
from spear_pin.gaits.continuation.stepping import FAR, Point, correct_point, orient_tangent
from spear_pin.gaits.family import Family
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.targets import check_wanted, measures_of
from spear_pin.hybrid.parameters import numbers_of_robot, parameter
from spear_pin.hybrid.result import Options
from spear_pin.kinds import typed

NEAR = 0.1  # largest scaled distance of the first point from the given gait
LEAST_STEP = 1e-4
STILL = 1e-10  # relative to a tangent: a smaller change of a measure counts as zero


@typed
def continue_gait(
    gait: Gait,
    over: str,
    within: tuple[float, float],
    vary: Sequence[str] = (),
    target: Mapping[str, float] | None = None,
    *,
    step: float = 0.05,
    points: int = 500,
    rtol: float = 1e-9,
    on_point: Callable[[float], object] = lambda value: None,
) -> Branch:
    """Follows the branch of gaits through a given gait over a parameter, both ways, by pseudo-arclength continuation.

    The continuation passes folds. It also passes borders, where the order of events changes, if the gaits on both sides
    meet. It locates folds, flips, Neimark-Sacker points and borders.

    Args:
        gait: the gait at which the continuation begins.
        over: the parameter: a number of law, spring, contact or robot, or a measure as a target.
        within: least and largest value of the parameter.
        vary: numbers to solve for; see `find_gait`; one more than there are targets where `over` is a measure.
        target: target values of as many measures, by name; they stay the same along the branch.
        step: longest step along the arc; 1 is the whole range of the parameter, 1 m, rad, m/s or rad/s, or the whole
            value of a number that is solved for.
        points: largest number of points each way.
        rtol: relative tolerance; see `simulate_many`; where lanes cannot run the cycles, that of the reference engine.
        on_point: called with the parameter's value at each point.

    Raises:
        UnknownName: unknown parameter or measure.
        BadValue: the range is empty or does not hold the gait's own value, there are not as many targets as numbers to
            solve for, a number is not valid, or a measure stays the same along the branch.
        NoGait: the given gait does not solve the equations.

    Example:
        >>> from spear_pin import continue_gait, find_gait, hopping, load
        >>> gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
        >>> branch = continue_gait(gait, "stance_torque", (7.0, 9.0))
        >>> branch.why[1]
        'the end of the range'
    """
    Options(rtol=rtol)  # it says what is valid
    require("step", step, lambda length: LEAST_STEP <= length <= 1.0, f"a number from {LEAST_STEP:g} to 1")
    require("points", points, lambda n: n >= 2 and n % 1 == 0, "a whole number, at least 2")
    problem, state, values = _equations(gait, over, within, tuple(vary), dict(target or {}), rtol)
    scale = problem.scale[-1]
    low, high = within[0] / scale, within[1] / scale
    start = _start(problem, state, values)
    if abs(start.tangent[-1]) < STILL:
        raise BadValue("over", over, f"a number that changes along the branch; this one stays {values[-1]:g}")

    def tell(point: Point) -> None:
        on_point(float(point.local.u[-1] * scale))

    ways = []
    for sign in (-1.0, 1.0):
        way = follow(problem, Point(start.local, sign * start.tangent), (low, high), step, points, tell)
        ways.append(way)
        if way.end == CLOSED:
            ways = [Way([start], [], CLOSED), way][:: int(sign)]
            break
    return _branch(problem, over, tuple(vary), dict(target or {}), ways[0], ways[1])


def _equations(
    gait: Gait, over: str, within: tuple[float, float], vary: tuple[str, ...], target: dict[str, float], rtol: float
) -> tuple[Gaits, Any, Array]:
    """Returns the equations, the gait's state, and its values of the solved numbers and the parameter."""
    system = gait.system
    measured = over in measures_of(system, sampled=True)
    for name in target:
        if name not in measures_of(system, sampled=True):
            raise UnknownName("target", name, measures_of(system, sampled=True))
    if len(vary) != len(target) + measured:
        count = f"{len(target) + measured}" + (f", one for {over} too" if measured else "")
        raise BadValue("vary", list(vary), f"as many parameters as targets, {count}")
    if over in vary or over in target:
        raise BadValue("over", over, "a name that is in neither vary nor target")
    robots = numbers_of_robot(system.robot)
    for name in vary:
        parameter(system, name)  # it says what there is
    if not measured and over not in robots:
        try:
            parameter(system, over)
        except UnknownName as error:
            raise UnknownName("parameter", over, (*error.valid, *robots, *measures_of(system, sampled=True))) from None
    check_wanted(system, {**target, **({over: within} if measured else {})})
    names = vary if measured else (*vary, over)
    family = Family(system, names, (*target, *([over] if measured else [])), rtol)
    own = family.values()
    if measured:
        own.append(_measured(family, gait, own))
    low, high = within
    if not (np.isfinite(within).all() and low < high and low <= own[-1] <= high):
        raise BadValue(
            "within", within, f"two numbers, the lower one first, with the gait's {own[-1]:.6g} between them"
        )
    if not measured:
        for value in within:
            member = family.member([*own[:-1], value])  # it says what is valid
            if member.mirrored_toes != system.mirrored_toes:
                expected = "a number that keeps left and right alike: half a stride of this gait mirrors the other"
                raise BadValue("over", over, expected)
    scale = np.array([abs(value) or 1.0 for value in own[:-1]] + [high - low])
    return Gaits(family, np.array([*target.values()], dtype=float), measured, scale), gait.state, np.array(own)


def _measured(family: Family, gait: Gait, own: list[float]) -> float:
    """Returns the gait's value of the last measure."""
    q, v = gait.state
    cycles = family.run(q[None], v[None], np.array([own]))
    if cycles.reason[0]:
        raise NoGait(f"the gait's cycle does not close: {cycles.reason[0]}", np.inf)
    return float(cycles.measured[0, -1])


def _start(problem: Gaits, state: Any, values: Array) -> Point:
    """Finds the point of the branch near the gait; its tangent points towards greater values of the parameter."""
    u = problem.point(state, values)
    row = np.zeros_like(u)
    row[-1] = 1.0
    try:
        return orient_tangent(correct_point(problem, u, row, float(u[-1]), NEAR), row)
    except NoValue as nothing:
        try:
            residual = float(np.abs(problem.glance(u)[0]).max())
        except NoValue:
            residual = np.inf
        why = {FAR: "it is far from the nearest gait with these values; expected the gait at them"}.get(nothing.reason)
        why = why or WHY.get(nothing.reason, nothing.reason)
        raise NoGait(f"the gait cannot be continued from where it is: {why}", residual) from None


def _branch(problem: Gaits, over: str, vary: tuple[str, ...], target: dict[str, float], back: Way, on: Way) -> Branch:
    """Joins the two ways from the start to one branch."""
    start = len(back.points) - 1
    turned = [Point(point.local, -point.tangent) for point in back.points[:0:-1]]
    points = [*turned, *on.points]
    states = [problem.read(point.local.u) for point in points]
    values = np.array([each for _, each in states])
    specials: list[SpecialPoint] = []
    borders: list[BorderPoint] = []
    for way, sign in ((back, -1), (on, 1)):
        for i, met in way.met:
            index = start + sign * i
            value = float(values[index, -1])
            if isinstance(met, Border):
                beyond = None if met.outer is None else index + sign
                order = met.inner.local.order
                borders.append(BorderPoint(met.kind, index, beyond, value, order, met.after, met.reason, met.jump))
            else:
                specials.append(SpecialPoint(met.kind, index, value, met.critical))
    borders.sort(key=lambda each: each.index)
    specials.sort(key=lambda each: each.index)
    about = [point.local.more for point in points]
    multipliers = np.full((len(points), max(len(point.local.multipliers) for point in points)), np.nan + 0j)
    for row, point in zip(multipliers, points, strict=True):
        row[: len(point.local.multipliers)] = point.local.multipliers
    whole = np.concatenate([np.ones(len(points[0].tangent) - len(problem.scale)), problem.scale])
    return Branch(
        family=problem.family,
        over=over,
        vary=vary,
        target=target,
        start=start,
        values=values[:, -1],
        q=np.array([q for (q, _), _ in states]),
        v=np.array([v for (_, v), _ in states]),
        solved={name: values[:, i] for i, name in enumerate(vary)},
        multipliers=multipliers,
        durations={phase: np.array([each.durations.get(phase, 0.0) for each in about]) for phase in about[0].durations},
        residual=np.array([each.residual for each in about]),
        orders=tuple(point.local.order for point in points),
        tangents=np.array([point.tangent * whole for point in points]),
        specials=tuple(specials),
        borders=tuple(borders),
        ends=(_end(back, borders[:1], values[0]), _end(on, borders[-1:], values[-1])),
    )


def _end(way: Way, nearest: list[BorderPoint], values: Array) -> End:
    return End(float(values[-1]), way.end, nearest[0] if way.end in (BORDER, LOST) else None)
