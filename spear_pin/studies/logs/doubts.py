"""What to keep in mind of values that were fitted, in sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.studies.fitting import doubt
from spear_pin.studies.logs.measured import STANCE
from spear_pin.studies.logs.residuals import Residuals
from spear_pin.studies.logs.shooting import Shot

POOR = 0.02  # of the motion: residuals that no sensor explains
LARGE = 0.2  # of the motion: what hardly any leg misses
FEW = 4  # phases, with fewer of which it is not seen how they differ
WORSE = 4.0  # times the median rms of all phases: one that fits worse is perhaps something else


def doubts(
    problem: Residuals,
    correlation: Array,
    solution: Any,
    shots: Sequence[tuple[Shot, Array, Array]],
) -> Iterator[str]:
    """Lists sentences that warn, if any.

    Args:
        problem: the least squares.
        correlation: correlations of the fitted values, (k, k).
        solution: solution of SciPy.
        shots: of each arc the shot, the residuals and their Jacobian.
    """
    values = dict(zip(problem.over, solution.x.tolist(), strict=False))
    yield from doubt(solution, values, correlation)
    if "torque_scale" in problem.over:
        yield "masses were held: torque_scale and all inertias and forces go with them"
        if solution.active_mask[problem.over.index("torque_scale")]:
            yield "torque_scale is at its bound: is the torque's sign that of its joint?"
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
