"""Times of each foot on the ground, and the colour of each foot in pages and plots."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array

COLORS = ("#0072B2", "#56B4E9", "#D55E00", "#E69F00", "#009E73", "#CC79A7")  # of Okabe and Ito, those of a pair alike


@dataclass(frozen=True)
class Footfall:
    """A foot's times on the ground.

    Attributes:
        toe: name of the toe.
        color: colour of the foot.
        spans: times at which it comes down and lifts off, in s.
    """

    toe: str
    color: str
    spans: tuple[tuple[float, float], ...]

    @property
    def label(self) -> str:
        """Foot in words: "posterior left"."""
        return label_of(self.toe)


def label_of(toe: str) -> str:
    """Returns the foot of a toe in words: "posterior left"."""
    return re.sub("_(toe|foot)$", "", toe, flags=re.IGNORECASE).replace("_", " ")


def color_of(number: int, feet: int) -> str:
    """Returns the colour of a foot by its number among the robot's feet; feet of a pair have similar colours."""
    return COLORS[(number if feet > len(COLORS) // 2 else 2 * number) % len(COLORS)]


def footfalls(toes: Sequence[str], t: Array, force: Array) -> tuple[Footfall, ...]:
    """Returns when the ground pushes on each toe.

    Args:
        toes: names of the toes.
        t: times, (n,), in s; an event has two samples.
        force: forces, (n, toes, 2) or (n, toes, 3), in N; the last component is normal to the ground.
    """
    found = []
    for number, toe in enumerate(toes):
        runs = [(float(t[first]), float(t[last])) for first, last in contacts(force[:, number])]
        spans = tuple((begin, end) for begin, end in runs if end > begin)
        found.append(Footfall(toe, color_of(number, len(toes)), spans))
    return tuple(found)


def contacts(force: Array) -> list[tuple[int, int]]:
    """Returns first and last sample of each run in which the ground pushes on a toe; force (n, 2) or (n, 3), in N."""
    bears = np.concatenate(([False], force[:, -1] > 0.0, [False]))
    edges = np.flatnonzero(np.diff(bears.astype(int))).reshape(-1, 2)
    return [(int(first), int(end) - 1) for first, end in edges]
