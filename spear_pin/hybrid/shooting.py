"""Shooting: the return map P of (4.11) in the section's coordinates, and the equations of a gait, x = P(x) and targets.

The equations are for many lanes, and any engine may run their cycles; one lane is a search for one gait.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.charts import Charts
from spear_pin.hybrid.newton import Lanes, Roots, Words, differentiate_stencil, newton, stencil
from spear_pin.hybrid.orders import Order

SHORTEST_CYCLE = 1e-3  # s: a toe that leaves and returns within this makes no gait, though it is nearly periodic
NOT_FINITE, SHORT_CYCLE = "not_finite", "short_cycle"


@dataclass(frozen=True)
class Cycles:
    """One cycle of some lanes; NaN where it does not close.

    Attributes:
        q: final configurations, (n, nq).
        v: final velocities, (n, nv).
        measured: the measures that have targets, (n, k).
        durations: time in each phase, in s, (n,) each.
        reason: why the cycle does not close, "" where it does, (n,).
        reference: whether the reference engine ran the cycle, (n,).
        orders: orders of the events, (n,); empty where they are not known, as for many lanes together.
    """

    q: Array
    v: Array
    measured: Array
    durations: Mapping[str, Array]
    reason: Words
    reference: NDArray[np.bool_]
    orders: Sequence[Order] = ()


Cycle = Callable[[Lanes, Array, Array, Array], Cycles]
"""One cycle of some lanes, (n,), from states q and v with values of what varies, (n, k)."""
Slopes = Callable[[Lanes, Array, Array, Array], tuple[Array, Array, Array]]
"""Derivatives of such cycles' ends (q, v), (n, 2 nv, 2 nv + k), and of what is measured, (n, r, 2 nv + k), by the state
and by what varies; NaN where they are not known."""


@dataclass(frozen=True)
class Shooting:
    """Cycles of lanes from states near those of charts; unknowns are ξ, then the varied parameters, (n, d + k).

    Attributes:
        charts: a chart for each lane.
        cycle: runs the cycles.
        vary: names of the parameters that are solved for.
        wanted: the targets, (n, k).
        slopes: returns the derivatives of the cycles, if they are known.
    """

    charts: Charts
    cycle: Cycle
    vary: tuple[str, ...] = ()
    wanted: Array = field(default_factory=lambda: np.empty((1, 0)))
    slopes: Slopes | None = None

    def states(self, lanes: Lanes, unknowns: Array) -> tuple[Array, Array]:
        """Returns the states on the section, (n, nq) and (n, nv); the section follows a varying ground."""
        return self._on_ground(lanes, unknowns).states(unknowns[:, : self.charts.dimension])

    def _on_ground(self, lanes: Lanes, unknowns: Array) -> Charts:
        values = unknowns[:, self.charts.dimension :]
        return self.charts.take(lanes).on(dict(zip(self.vary, values.T, strict=True)))

    def mapped(self, lanes: Lanes, unknowns: Array) -> tuple[Array, Words]:
        """Returns ξ of P(x), (n, d), and why there is none."""
        charts, d = self._on_ground(lanes, unknowns), self.charts.dimension
        after = self.cycle(lanes, *charts.states(unknowns[:, :d]), unknowns[:, d:])
        return charts.coordinates(after.q, after.v), after.reason

    def residuals(self, lanes: Lanes, unknowns: Array) -> tuple[Array, Words]:
        """Returns ξ of P(x) minus ξ of x, and measures minus targets, (n, d + k), and why there is none."""
        charts, d = self._on_ground(lanes, unknowns), self.charts.dimension
        q, v = charts.states(unknowns[:, :d])
        after = self.cycle(lanes, q, v, unknowns[:, d:])
        moved = charts.coordinates(after.q, after.v) - charts.coordinates(q, v)
        values = np.concatenate([moved, after.measured - self.wanted[lanes]], axis=1)
        reason = after.reason.copy()
        reason[(reason == "") & (sum(after.durations.values()) < SHORTEST_CYCLE)] = SHORT_CYCLE
        reason[(reason == "") & ~np.isfinite(values).all(axis=1)] = NOT_FINITE
        values[reason != ""] = np.nan
        return values, reason

    def jacobians(self, lanes: Lanes, unknowns: Array) -> Array:
        """Returns exact Jacobians of the residuals, (n, d + k, d + k), NaN where they are not known.

        The change of a state on the section with ξ and with the ground is geometry. It comes from differences, which
        run no cycle.
        """
        n, width = unknowns.shape
        charts, d = self._on_ground(lanes, unknowns), self.charts.dimension
        assert self.slopes is not None
        offsets = stencil(width)
        beside = self.states(np.repeat(lanes, 2 * width), (unknowns[:, None] + offsets).reshape(-1, width))
        moves = differentiate_stencil(np.concatenate(beside, axis=1).reshape(n, 2 * width, -1))
        held = np.broadcast_to(np.eye(width - d, width, d), (n, width - d, width))
        q, v = charts.states(unknowns[:, :d])
        after, ends, measured = self.slopes(lanes, q, v, unknowns[:, d:])
        along, nq = np.concatenate([moves, held], axis=1), q.shape[1]
        moved = charts.changes(after[:, :nq], after[:, nq:], ends @ along) - charts.changes(q, v, moves)
        return np.concatenate([moved, measured @ along], axis=1)

    def solve(self, start: Array, tolerance: float, **options: Any) -> Roots:
        """Solves for a gait of each lane by Newton's method, from the charts' origins.

        Args:
            start: initial values of the varied parameters, (n, k).
            tolerance: tolerance on the residual's largest component.
            **options: `calls`, `always` and `on_iterates` of `newton`.
        """
        still = np.zeros((len(start), self.charts.dimension))
        scale = np.concatenate([np.ones_like(still), np.maximum(1.0, np.abs(start))], axis=1)
        begin = np.concatenate([still, start], axis=1)
        slopes = None if self.slopes is None else self.jacobians
        return newton(self.residuals, begin, scale, tolerance, slopes=slopes, **options)
