"""Criteria that numbers have to meet for a statement to hold, in words and as a test; both from the same limits."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from typing import TypeAlias

Value: TypeAlias = float | tuple[float, ...]


@dataclass(frozen=True)
class Criterion:
    """A test of numbers.

    Attributes:
        text: in words.
        holds: whether numbers meet it.
    """

    text: str
    holds: Callable[[Value], bool]


def near(printed: Value, tolerance: float) -> Criterion:
    """Each number within an absolute tolerance of the printed one."""
    wanted = "; ".join(f"{number:g}" for number in _tuple(printed))
    text = f"within {tolerance:g} of {wanted}" if tolerance else f"exactly {wanted}"
    return Criterion(text, lambda value: _all_within(value, printed, tolerance))


def about(printed: float, share: float) -> Criterion:
    """Within a share of the printed number."""
    tolerance = share * abs(printed)
    return Criterion(f"within {100 * share:g} % of {printed:g}", lambda value: _all_within(value, printed, tolerance))


def equal(share: float) -> Criterion:
    """Two numbers within a share of the second of each other."""

    def holds(value: Value) -> bool:
        first, second = _tuple(value)
        return abs(first - second) <= share * abs(second)

    return Criterion(f"the two within {100 * share:g} % of each other", holds)


def below(limit: float) -> Criterion:
    """Every number below a limit."""
    return Criterion(f"below {limit:g}", lambda value: max(_tuple(value)) < limit)


def above(limit: float) -> Criterion:
    """Every number above a limit."""
    return Criterion(f"above {limit:g}", lambda value: min(_tuple(value)) > limit)


def between(low: float, high: float) -> Criterion:
    """Every number between two limits, these included."""
    return Criterion(
        f"from {low:g} to {high:g}", lambda value: low <= min(_tuple(value)) and max(_tuple(value)) <= high
    )


def first(criterion: Criterion) -> Criterion:
    """A criterion for the first number alone; the others are there to compare with."""
    return Criterion(f"the first {criterion.text}", lambda value: criterion.holds(_tuple(value)[0]))


def rising() -> Criterion:
    """Each number larger than the one before."""
    return Criterion("each larger than the one before", lambda value: all(a < b for a, b in pairwise(_tuple(value))))


def falling() -> Criterion:
    """Each number smaller than the one before."""
    return Criterion("each smaller than the one before", lambda value: all(a > b for a, b in pairwise(_tuple(value))))


def least(which: int) -> Criterion:
    """One of the numbers, counted from 0, smaller than each of the others."""

    def holds(value: Value) -> bool:
        numbers = _tuple(value)
        return all(numbers[which] < other for i, other in enumerate(numbers) if i != which)

    return Criterion(f"number {which + 1} smaller than the others", holds)


def _tuple(value: Value) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)


def _all_within(value: Value, printed: Value, tolerance: float) -> bool:
    numbers, wanted = _tuple(value), _tuple(printed)
    # the printed number is a decimal: a tolerance of half its last digit shall not fail by rounding
    return len(numbers) == len(wanted) and all(
        abs(a - b) <= tolerance * (1 + 1e-9) for a, b in zip(numbers, wanted, strict=True)
    )
