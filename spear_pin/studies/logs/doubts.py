"""What to keep in mind of values that were fitted, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.studies.logs.measured import STANCE
from spear_pin.studies.logs.residuals import Residuals
from spear_pin.studies.logs.shooting import Shot
from spear_pin.studies.logs.spread import Found

ALIKE = 0.98  # correlation of two values that are hardly told apart
POOR = 0.02  # of the motion: residuals that no sensor explains
LARGE = 0.2  # of the motion: what hardly any leg misses
FEW = 4  # phases, with fewer of which it is not seen how they differ
WORSE = 4.0  # times the median rms of all phases: one that fits worse is perhaps something else


def doubts(
    problem: Residuals,
    found: Mapping[str, Found],
    correlation: Array,
    solution: Any,
    shots: Sequence[tuple[Shot, Array, Array]],
) -> Iterator[str]:
    """Lists sentences that warn, if any.

    Args:
        problem: the least squares.
        found: the fitted values.
        correlation: their correlations, (k, k).
        solution: solution of SciPy.
        shots: of each arc the shot, the residuals and their Jacobian.
    """
    if not solution.success:
        yield f"the search did not converge in {solution.nfev} evaluations"
    for name, side in zip(problem.over, solution.active_mask, strict=False):
        if side:
            sign = "; is the torque's sign that of its joint?" if name == "torque_scale" else ""
            yield f"{name} is at its bound, {found[name].value:g}: its deviation means nothing{sign}"
    for i, one in enumerate(problem.over):
        for other, alike in zip(problem.over[:i], correlation[i], strict=False):
            if abs(alike) > ALIKE:
                larger = (1.0 - min(alike**2, 1.0 - 1e-12)) ** -0.5
                pair = f"{other} and {one} are hardly told apart (correlation {alike:.3f})"
                yield f"{pair}: with one held, the other's deviation would be {larger:.0f} times less"
    if "torque_scale" in problem.over:
        yield "masses were held: torque_scale and all inertias and forces go with them"
    if (n := len(problem.arcs)) < FEW:
        yield f"{n} phase{'s are' if n > 1 else ' is'} few: the deviations do not tell how hops differ"
    moved = float(np.median([np.ptp(arc.positions, axis=0).max() for arc in problem.arcs]))
    m = len(problem.joints.rows)
    sizes = [float(np.sqrt(np.mean(residual[:, :m] ** 2))) for _, residual, _ in shots]
    if (share := float(np.median(sizes)) / moved) > POOR:
        hint = "" if share < LARGE else "; are units and signs right?"
        yield f"the model misses something: the residuals are {100.0 * share:.1f} % of the motion{hint}"
    for arc, (shot, _, _), size in zip(problem.arcs, shots, sizes, strict=True):
        where = f"the {arc.phase.name} from {arc.phase.begin:.3f} s of {arc.phase.source}"
        if arc.phase.name == STANCE and float(shot.forces[:-3, -1].min()) < 0.0:
            yield f"in {where} the toe pulls on the ground: perhaps it is in the air"
        if size > WORSE * float(np.median(sizes)):
            yield f"{where} fits worse than the others, rms {size:.2g}: perhaps it is something else"
