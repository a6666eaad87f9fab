"""Measures of a cycle with their derivatives, each found when it is asked for."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array

MULTIPLIER = "multiplier_"
ROUNDING, ROOT = 1e-12, 1e-6  # in units of an output; repeated zero multipliers keep a root of rounding


def estimate_rounding(output: str) -> float:
    """Returns the modulus up to which an output counts as zero, because of rounding, in the output's unit."""
    return ROOT if output.startswith(MULTIPLIER) else ROUNDING


@dataclass(frozen=True)
class DualMeasure:
    """A measure of a cycle.

    Attributes:
        value: value in the measure's unit.
        derivative: along each direction, (c,).
        unit: the measure's unit.
    """

    value: float
    derivative: Array
    unit: str


class Group(NamedTuple):
    """Measures that are found together.

    Attributes:
        names: a pattern of the measures' names.
        found: finds the measures; its argument is all measures, so that it can use others.
    """

    names: str
    found: Callable[[Mapping[str, DualMeasure]], Mapping[str, DualMeasure]]


class Measures(Mapping[str, DualMeasure]):
    """Measures by name: reading one finds it, with the other measures of its group.

    Args:
        groups: groups of all measures.
    """

    def __init__(self, groups: Sequence[Group]) -> None:
        self._groups, self._found = tuple(groups), dict[int, Mapping[str, DualMeasure]]()

    def __getitem__(self, name: str) -> DualMeasure:
        for i, group in enumerate(self._groups):
            if re.fullmatch(group.names, name) and name in self._of(i):
                return self._of(i)[name]
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return (name for i in range(len(self._groups)) for name in self._of(i))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _of(self, i: int) -> Mapping[str, DualMeasure]:
        if i not in self._found:
            self._found[i] = self._groups[i].found(self)
        return self._found[i]


def total(parts: Sequence[DualMeasure]) -> DualMeasure:
    """Returns the sum of measures that have the same unit."""
    value = float(sum(each.value for each in parts))
    return DualMeasure(value, np.sum([each.derivative for each in parts], axis=0), parts[0].unit)


def ratio(above: DualMeasure, below: DualMeasure, unit: str) -> DualMeasure:
    """Returns the ratio of two measures, in a given unit."""
    value = above.value / below.value
    return DualMeasure(value, (above.derivative - value * below.derivative) / below.value, unit)
