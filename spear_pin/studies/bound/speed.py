"""Mean speed of a bound, and the same gait at another speed, by continuation in small steps."""

from __future__ import annotations

from collections.abc import Callable

from spear_pin.errors import BadValue, NoGait, require
from spear_pin.gaits.attempts import MeasureOfRun
from spear_pin.gaits.bounding import SPEED_BY
from spear_pin.gaits.feedback import add_feedback, speed_regulated, without_feedback
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.leading import Way, lead_along
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.kinds import typed

SPEED_STEP, SHORTEST_STEP = 0.25, 0.06  # m/s
FARTHEST = 1.0  # m/s from a gait's own speed; no gait that ships can be continued so far
PATIENCE = 12  # iterations of the solver for a step; one that succeeds takes six to nine


@typed
def mean_speed(gait: Gait, rtol: float = 1e-8) -> float:
    """Returns the mean forward speed of a gait, in m/s, from one cycle.

    Raises:
        BadValue: the cycle is not completed.
    """
    result = run(gait.system, gait.state, 1, Options(rtol))
    if not result.cycles:
        raise BadValue("gait", result.message, "a gait whose cycle ends")
    return float(gait.system.measures["mean_speed"](result))


@typed
def at_speed(gait: Gait, speed: float, *, on_iteration: Callable[[int, float], object] = lambda n, norm: None) -> Gait:
    """Finds the gait at another mean speed by continuation in small steps; β_sp is solved for.

    Event feedback would pull back to the old speed. So it is left out on the way and designed again at the end.

    Args:
        gait: a bounding gait.
        speed: mean forward speed, in m/s, within `FARTHEST` of the gait's own.
        on_iteration: called with the iteration and the residual of the solver.

    Raises:
        BadValue: the gait does not bound or has both kinds of event feedback, or the speed is not positive, or too far
            from the gait's own.
        NoGait: there is no gait at this speed, or it cannot be reached from here.
    """
    require("speed", speed, lambda v: v > 0, "a number > 0, in m/s")
    if gait.system.kind != "bounding":
        raise BadValue("gait", gait.system.kind, "a bounding gait")
    law = gait.system.law
    feedback = feedback_of(gait.system)
    if feedback is not None and any(law.speed_gain):
        raise BadValue("gait", "one with two kinds of event feedback", "one kind at most")
    begin = mean_speed(gait)
    expected = f"within {FARTHEST:g} m/s of the gait's own, {begin:.2f}"
    require("speed", speed, lambda v: abs(v - begin) <= FARTHEST + 1e-6, expected)
    gait = without_feedback(gait)
    whole = speed - begin

    def solve(share: float, near: Gait) -> Gait:
        return _continued(near, speed if share == 1.0 else begin + share * whole, on_iteration)

    step, shortest = (each / max(abs(whole), 1e-12) for each in (SPEED_STEP, SHORTEST_STEP))
    way = lead_along(solve, gait, first=step, shortest=shortest, longest=step) if whole else Way(1.0, gait)
    if way.failure is not None:
        problem = f"it continues from {begin:.2f} to {begin + way.done * whole:.2f} m/s, and none was found beyond"
        raise NoGait(problem, way.failure.residual, remedy=f"a speed nearer to {begin:.2f} m/s")
    gait = way.end
    if law.nominal:
        q, v = gait.state
        gait = gait.with_law(nominal=(*q[1:].tolist(), *v.tolist()))
    if feedback is not None:
        return add_feedback(gait, feedback.inputs)
    return speed_regulated(gait, law.speed_gain) if any(law.speed_gain) else gait


def _continued(gait: Gait, speed: float, on_iteration: Callable[[int, float], object]) -> Gait:
    """Finds the gait at a speed near its own; gives up sooner than `find_gait` would."""
    seen: list[float] = []

    def tell(iteration: int, residual: float) -> None:
        on_iteration(iteration, residual)
        seen.append(residual)
        if len(seen) > PATIENCE:
            raise _Enough

    target: dict[str | MeasureOfRun, float] = {"mean_speed": speed}
    try:
        return find_gait(gait.system, [SPEED_BY], target, guess=gait.state, on_iteration=tell)
    except _Enough:
        raise NoGait("Newton's method takes too long", min(seen)) from None


class _Enough(Exception):
    """Raised when the solver has used enough time."""
