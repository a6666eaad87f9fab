"""Hops with one flight time, by the numbers of law and spring that are chosen; the rest of each is solved for."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import NoGait
from spear_pin.studies.payoff.cycles import CLOSED, REACH, Cycle, Cycles

Array = NDArray[np.float64]
FAR = 10.0  # of the units: the gap where no cycle closes
BAD = 1e2  # the cost where there is no hop, of that of the start
HALVINGS = 3  # of the way to a hop
CORRECTIONS = 8  # by Newton's method with the tangent of a hop nearby
DEARER, OTHERS = 2e-3, 8  # of the cost: hops that are tried where there is no fixed point beside the cheapest


@dataclass(frozen=True)
class _Hop:
    """A hop by what is chosen: its unknowns, its cycle, and once asked for the tangent there."""

    x: Array
    cycle: Cycle


@dataclass(frozen=True)
class _Tangent:
    """Derivatives at a hop: of the gap by the unknowns; of these, the cost and what is spared by what is chosen."""

    x: Array
    gap: Array
    along: Array
    cost: Array
    spare: Array


@dataclass
class HopFamily:
    """Hops by what is chosen, each solved for from the nearest one whose tangent is known."""

    cycles: Cycles
    x: Array  # of the first one
    known: dict[bytes, _Hop | None] = field(default_factory=dict)
    tangents: list[_Tangent] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.start = self.x[self.cycles.solved :]
        cycle = self.cycles.at(self.x)
        assert cycle is not None
        self.unit, self.limits = cycle.cost or 1.0, len(cycle.spare)
        self.known[self.start.tobytes()] = _Hop(self.x, cycle)
        self.slopes(self.start)

    def at(self, y: Array) -> Cycle:
        """The cycle, its cost over that of the start."""
        hop = self._hop(y)
        if hop is None:
            return Cycle(BAD, np.array([FAR]), np.full(self.limits, -1.0))
        return replace(hop.cycle, cost=hop.cycle.cost / self.unit)

    def slopes(self, y: Array) -> tuple[Array, Array]:
        """Derivatives of the cost and of what is spared along the hops."""
        hop = self._hop(y)
        if hop is None:
            return np.zeros(len(y)), np.zeros((self.limits, len(y)))
        for each in self.tangents:
            if each.x is hop.x:
                return each.cost / self.unit, each.spare
        n = self.cycles.solved
        cost, gap, spare = self.cycles.slopes(hop.x, hop.cycle)
        along = np.concatenate([-np.linalg.lstsq(gap[:, :n], gap[:, n:], rcond=None)[0], np.eye(len(y))])
        self.tangents.append(_Tangent(hop.x, gap, along, cost @ along, spare @ along))
        return self.slopes(y)

    def _hop(self, y: Array, halvings: int = HALVINGS) -> _Hop | None:
        key = y.tobytes()
        if key not in self.known:
            self.known[key] = self._solved(y, halvings)
        return self.known[key]

    def _solved(self, y: Array, halvings: int) -> _Hop | None:
        """The hop, from the nearest one whose tangent is known, or by way of one between; None where that fails."""
        n = self.cycles.solved
        near = min(self.tangents, key=lambda each: float(np.abs(each.x[n:] - y).max()))
        hop = self._beside(near, y)
        if hop is None and halvings:
            middle = 0.5 * (near.x[n:] + y)
            if self._hop(middle, halvings - 1) is None:
                return None
            self.slopes(middle)
            hop = self._solved(y, halvings - 1)
        return hop

    def _beside(self, near: _Tangent, y: Array) -> _Hop | None:
        """The hop by Newton's method with the Jacobian of another; None where that leads nowhere."""
        n, last = self.cycles.solved, np.inf
        moved = near.x + near.along @ (y - near.x[n:])
        if np.abs(moved - near.x).max() > 2.0 * REACH:
            return None
        for _ in range(CORRECTIONS):
            cycle = self.cycles.at(moved)
            if cycle is None or not (size := float(np.abs(cycle.gap).max())) < last:
                return None
            if size < CLOSED:
                return _Hop(moved, cycle)
            moved = moved.copy()
            moved[:n] -= np.linalg.lstsq(near.gap[:, :n], cycle.gap, rcond=None)[0]
            last = size
        return None

    def cheapest(self) -> list[Array]:
        """The unknowns of the cheapest hops within limits, each dearer than the one before by more than a little.

        Raises:
            NoGait: there is none.
        """
        fitting = [hop for hop in self.known.values() if hop is not None and hop.cycle.fits]
        if not fitting:
            left = max(float(hop.cycle.spare.min()) for hop in self.known.values() if hop is not None)
            raise NoGait(f"none of the hops keeps to limits of joints and motors, by {-100 * left:.2g} % of one", 0.0)
        chosen: list[_Hop] = []
        for hop in sorted(fitting, key=lambda hop: hop.cycle.cost):
            if not chosen or hop.cycle.cost > (1.0 + DEARER) * chosen[-1].cycle.cost:
                chosen.append(hop)
        return [hop.x for hop in chosen[:OTHERS]]
