"""A measure of a cycle with its derivatives, and many of them, each found when it is asked for."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array

MULTIPLIER = "multiplier_"
ROUNDING, ROOT = 1e-12, 1e-6  # in units of an output; of multipliers that are zero several times rounding leaves a root


def rounding(output: str) -> float:
    """Up to which modulus an output is zero but for rounding, in its unit."""
    return ROOT if output.startswith(MULTIPLIER) else ROUNDING


@dataclass(frozen=True)
class Measure:
    """A measure of a cycle.

    Attributes:
        value: in its unit.
        derivative: along each direction, (c,).
        unit: the unit.
    """

    value: float
    derivative: Array
    unit: str


class Group(NamedTuple):
    """Measures that are found together.

    Attributes:
        names: a pattern of their names.
        found: finds them, given all measures, of which it may make use of others.
    """

    names: str
    found: Callable[[Mapping[str, Measure]], Mapping[str, Measure]]


class Measures(Mapping[str, Measure]):
    """Measures by name: what is asked for is found, at the cost of what is found with it.

    Args:
        groups: all of them.
    """

    def __init__(self, groups: Sequence[Group]) -> None:
        self._groups, self._found = tuple(groups), dict[int, Mapping[str, Measure]]()

    def __getitem__(self, name: str) -> Measure:
        for i, group in enumerate(self._groups):
            if re.fullmatch(group.names, name) and name in self._of(i):
                return self._of(i)[name]
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return (name for i in range(len(self._groups)) for name in self._of(i))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _of(self, i: int) -> Mapping[str, Measure]:
        if i not in self._found:
            self._found[i] = self._groups[i].found(self)
        return self._found[i]


def total(parts: Sequence[Measure]) -> Measure:
    """The sum of measures of one unit."""
    value = float(sum(each.value for each in parts))
    return Measure(value, np.sum([each.derivative for each in parts], axis=0), parts[0].unit)


def product(one: Measure, other: Measure, unit: str) -> Measure:
    """The product of two measures, in a unit."""
    change = one.derivative * other.value + one.value * other.derivative
    return Measure(one.value * other.value, change, unit)


def ratio(above: Measure, below: Measure, unit: str) -> Measure:
    """The ratio of two measures, in a unit."""
    value = above.value / below.value
    return Measure(value, (above.derivative - value * below.derivative) / below.value, unit)
