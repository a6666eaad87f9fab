"""What is in the way of a request: the wish that has to be missed, and what to try instead."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from spear_pin.errors import Infeasible, NoGait
from spear_pin.gaits.collocation import Solution, resample
from spear_pin.gaits.footfalls.programme import Transcription
from spear_pin.gaits.request import Wishes

MET = 1e-5  # relative to a wish's scale: a wish with a smaller miss is met
SLIPPED, SLOWER = 1.25, 0.9  # factors on the requested friction and speed
PATIENCE = 300  # iterations of the relaxed search
# wishes, by how their labels begin, and what to try where one is missed most: of the request and by how much it is
REMEDIES: Mapping[str, Callable[[Any, float], str]] = {
    "mean speed": lambda asked, by: f"speed={max(asked.speed - by, 0.5 * asked.speed):.3g}",
    "duration of the stride": lambda asked, by: _longer_or_shorter(asked, by),
    "friction": lambda asked, by: f"friction={SLIPPED * asked.friction:.2g}{_less_bent(asked)}",
    "normal force": lambda asked, by: f"minimum_force={max(asked.minimum_force - by, 0.0):.3g}",
    "clearance": lambda asked, by: f"clearance={max(asked.clearance - by, 0.0):.2g}",
    "speed": lambda asked, by: f"a gearbox of a smaller ratio, or speed={SLOWER * asked.speed:.3g}",
    "envelope": lambda asked, by: f"a stronger motor, another ratio{_free_spring(asked)}, or a slower speed",
    "torque": lambda asked, by: f"{_stronger(asked, by)}speed={SLOWER * asked.speed:.3g}",
}


def obstacle(transcription: Transcription, solution: Solution) -> Infeasible | NoGait:
    """Finds the obstacle to a request: the wish that a relaxed solve misses most, counted in its scale."""
    asked = transcription.room.request
    relaxed, margins = transcription.programme.relaxed(resample(solution))
    loosened = relaxed.solve(iterations=PATIENCE)
    if not loosened.success:
        reason = f"the optimiser ended with {solution.status} and its relaxed search with {loosened.status}"
        return _stopped(reason, solution, f"speed={SLOWER * asked.speed:.3g}, or {_again(asked)}")
    missed = {label: float(loosened.values[margin.unknown][0]) for label, margin in margins.items()}
    worst = max(missed, key=lambda label: missed[label])
    if missed[worst] < MET:
        reason = f"the optimiser ended with {solution.status}, though every wish can be met"
        return _stopped(reason, solution, _again(asked))
    by = missed[worst] * margins[worst].scale
    return Infeasible(worst, by, margins[worst].unit, remedy(transcription.room.request, worst, by))


def _stopped(reason: str, solution: Solution, remedy: str) -> NoGait:
    """Returns the error for a search that ended without a wish to blame: it names the worst violation at the end."""
    worst = max(solution.violations, key=lambda label: solution.violations[label])
    return NoGait(reason, solution.violations[worst], f"its last iterate misses {worst!r} most", remedy)


def remedy(request: Wishes, wish: str, missed: float) -> str:
    """Suggests one thing to try where a wish is missed; returns empty text where nothing is known.

    Args:
        request: the request that has the wish.
        wish: label of the wish.
        missed: by how much the wish is missed, in its unit.
    """
    if wish.startswith("torque") and "hip" not in wish:
        return f"speed={SLOWER * request.speed:.3g}"
    known = (say for begin, say in REMEDIES.items() if wish.startswith(begin))
    return next((say(request, missed) for say in known), "")


def _again(asked: Any) -> str:
    """Suggests another beginning: in space a search has no seed."""
    return "start= of a gait that is near" if hasattr(asked, "footfalls") else "another seed"


def _longer_or_shorter(asked: Any, by: float) -> str:
    if hasattr(asked, "longest_stride"):
        return f"longest_stride={asked.longest_stride + by:.3g}"
    return f"minimum_stride={max(asked.minimum_stride - by, 0.0):.3g}"


def _less_bent(asked: Any) -> str:
    """Suggests a straighter knee at touchdown, which strikes the ground less at a slant, where its angle is given."""
    bent = getattr(asked, "knee_touchdown", None)
    return "" if bent is None else f" or a smaller knee_touchdown than {bent:.3g}"


def _free_spring(asked: Any) -> str:
    return "" if getattr(asked, "stiffness", None) is None else ", stiffness=None, which leaves it free"


def _stronger(asked: Wishes, missed: float) -> str:
    """Suggests more hip torque, where it is bounded."""
    return "" if asked.hip_torque is None else f"hip_torque={asked.hip_torque + asked.legs * missed:.3g} or "
