"""Hops with one flight time, by the chosen numbers of law and spring; the other unknowns are solved for."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait
from spear_pin.studies.payoff.cycles import CLOSED, REACH, Cycle, Cycles

SHORT = 0.2  # units: nearer than that no way between is tried
HALVINGS = 2  # of the way to a hop
CORRECTIONS = 6  # by Newton's method with the Jacobian of a hop nearby, which they improve
DEARER, OTHERS = 1e-2, 12  # of the cost: hops that are tried where there is no fixed point beside the cheapest


@dataclass(frozen=True)
class Hop:
    """A hop: its unknowns, its cycle, and the gap's Jacobian by all unknowns, exact or by Broyden's rule."""

    x: Array
    cycle: Cycle
    jacobian: Array
    exact: bool = False


@dataclass
class HopFamily:
    """Hops by their chosen numbers, each solved for from the nearest known hop."""

    cycles: Cycles
    start: Array = field(init=False)
    known: dict[bytes, Hop | None] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Finds the first hop."""
        x = self.cycles.first()
        cycle = self.cycles.at(x)
        assert cycle is not None
        self.start = x[self.cycles.solved :]
        self.known[self.start.tobytes()] = Hop(x, cycle, self.cycles.jacobian(x, cycle), exact=True)

    def at(self, y: Array) -> Hop | None:
        """Returns the hop with chosen numbers, in units; None where none was found."""
        return self._hop(y, HALVINGS)

    def nearest(self, y: Array) -> Hop:
        """Returns the nearest known hop."""
        n = self.cycles.solved
        hops = [hop for hop in self.known.values() if hop is not None]
        return min(hops, key=lambda hop: float(np.abs(hop.x[n:] - y).max()))

    def _hop(self, y: Array, halvings: int) -> Hop | None:
        key = y.tobytes()
        if key not in self.known:
            self.known[key] = self._solved(y, halvings)
        return self.known[key]

    def _solved(self, y: Array, halvings: int) -> Hop | None:
        """Solves from the nearest hop, or by way of a hop between."""
        near = self.nearest(y)
        hop = self._beside(near, y)
        if hop is None and not near.exact:
            near = self._known_exactly(near)
            hop = self._beside(near, y)
        middle = 0.5 * (near.x[self.cycles.solved :] + y)
        if hop is None and halvings and np.abs(middle - y).max() > 0.5 * SHORT:
            return None if self._hop(middle, halvings - 1) is None else self._solved(y, halvings - 1)
        return hop

    def _known_exactly(self, hop: Hop) -> Hop:
        """Returns a hop with its Jacobian by differences, so that errors of Broyden's rule do not persist."""
        exact = Hop(hop.x, hop.cycle, self.cycles.jacobian(hop.x, hop.cycle), exact=True)
        self.known[hop.x[self.cycles.solved :].tobytes()] = exact
        return exact

    def _beside(self, near: Hop, y: Array) -> Hop | None:
        """Solves by Newton's method from another hop; returns None where that leads nowhere."""
        n, jacobian, last = self.cycles.solved, near.jacobian, near.cycle.gap
        moved = np.concatenate([near.x[:n], y])
        moved[:n] -= np.linalg.lstsq(jacobian[:, :n], last + jacobian[:, n:] @ (y - near.x[n:]), rcond=None)[0]
        if np.abs(moved - near.x).max() > 2.0 * REACH:
            return None
        seen = self.cycles.glance(moved)
        return self._by_broyden(near, moved) if seen is None else self._by_derivatives(near, moved, *seen)

    def _by_derivatives(self, near: Hop, moved: Array, gap: Array, jacobian: Array) -> Hop | None:
        """Solves by exact derivatives, from a place where they are known."""
        n, size = self.cycles.solved, np.inf
        for _ in range(CORRECTIONS):
            before, size = size, float(np.abs(gap).max())
            if size < CLOSED:
                cycle = self.cycles.at(moved)
                if cycle is None or np.abs(cycle.gap).max() > 2.0 * CLOSED:
                    return None
                return Hop(moved, cycle, jacobian, exact=True)
            moved = moved.copy()
            moved[:n] -= np.linalg.lstsq(jacobian[:, :n], gap, rcond=None)[0]
            if not size < before or np.abs(moved - near.x).max() > 2.0 * REACH:
                return None
            seen = self.cycles.glance(moved)
            if seen is None:
                return None
            gap, jacobian = seen
        return None

    def _by_broyden(self, near: Hop, moved: Array) -> Hop | None:
        """Solves by cycles without derivatives, with the Jacobian of another hop and Broyden's rule."""
        n, before, jacobian, last = self.cycles.solved, near.x, near.jacobian, near.cycle.gap
        size = np.inf
        for _ in range(CORRECTIONS):
            if np.abs(moved - near.x).max() > 2.0 * REACH:
                return None
            cycle = self.cycles.at(moved)
            if cycle is None or not (now := float(np.abs(cycle.gap).max())) < size:
                return None
            step, size = moved - before, now
            length = max(float(step @ step), CLOSED**2)
            jacobian = jacobian + np.outer(cycle.gap - last - jacobian @ step, step) / length
            if size < CLOSED:
                return Hop(moved, cycle, jacobian)
            before, last, moved = moved, cycle.gap, moved.copy()
            moved[:n] -= np.linalg.lstsq(jacobian[:, :n], last, rcond=None)[0]
        return None

    def cheapest(self) -> list[Hop]:
        """Lists the cheapest hops within limits, each dearer than the one before by more than a little.

        Raises:
            NoGait: there is no hop within limits.
        """
        hops = [hop for hop in self.known.values() if hop is not None]
        fitting = [hop for hop in hops if hop.cycle.fits]
        if not fitting:
            left = max(float(hop.cycle.spare.min()) for hop in hops)
            raise NoGait(f"every hop exceeds a limit, the best one by {-100 * left:.2g} %", 0.0)
        chosen: list[Hop] = []
        for hop in sorted(fitting, key=lambda hop: hop.cycle.cost):
            if not chosen or hop.cycle.cost > (1.0 + DEARER) * chosen[-1].cycle.cost:
                chosen.append(hop)
        return chosen[:OTHERS]
