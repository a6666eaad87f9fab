"""Impulses of impacts that may not be over, with their derivatives."""

from __future__ import annotations

from collections.abc import Container, Sequence
from dataclasses import dataclass, field

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.strikes import Overlap


@dataclass
class DualOverlap:
    """Impacts that may not be over, as `Overlap` counts them, with derivatives along c directions.

    Attributes:
        overlap: the impulses since each toe was struck.
        c: number of directions.
        changes: derivatives of these impulses, (3, c) each, in N·s.
    """

    overlap: Overlap
    c: int
    changes: dict[str, Array] = field(default_factory=dict)

    def received(self, toes: Sequence[str], now: float) -> tuple[Array, Array]:
        """Returns the impulses that toes have received, (m, 3), in N·s, and their derivatives, (m, 3, c)."""
        values, nothing = self.overlap.received(toes, now), np.zeros((3, self.c))
        return values, np.array([self.changes[toe] if toe in self.overlap.recent else nothing for toe in toes])

    def add(self, toes: Sequence[str], striking: Container[str], impulse: Array, change: Array, now: float) -> None:
        """Records an impact; see `Overlap.add`.

        Args:
            toes: toes that took part.
            striking: toes among them that were in the air.
            impulse: impulse on each, (m, 3), in N·s.
            change: its derivatives, (m, 3, c).
            now: time of the impact, in s.
        """
        counted = {toe for toe in toes if toe in self.overlap.recent}
        self.overlap.add(toes, striking, impulse, now)
        for toe, own in zip(toes, change, strict=True):
            if toe in self.overlap.recent:
                self.changes[toe] = self.changes[toe] + own if toe in counted else own
