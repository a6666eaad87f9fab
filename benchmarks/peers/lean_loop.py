"""The yardstick: SciPy's `solve_ivp` on lean right-hand sides with Pinocchio, `benchmarks/lean.py`."""

from __future__ import annotations

import numpy as np

from benchmarks.lean import lean_hop
from benchmarks.peers.task import STATES, Lane, Task

RTOLS = (1e-8, 1e-9)


def lanes(task: Task) -> list[Lane]:
    """One for each tolerance."""

    def lane(rtol: float) -> Lane:
        hops = [lean_hop(task.at(i), rtol) for i in range(STATES)]
        return Lane(
            "the lean loop, SciPy and Pinocchio",
            f"DOP853, rtol {rtol:.0e}",
            lambda: np.array([np.concatenate(hop()) for hop in hops]),
        )

    return [lane(rtol) for rtol in RTOLS]
