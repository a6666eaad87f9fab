"""Criteria for the numbers of a statement, in words and as a test; both come from the same limits."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, TypeAlias

Value: TypeAlias = float | tuple[float, ...]


@dataclass(frozen=True)
class Criterion:
    """A test of numbers.

    Attributes:
        text: the criterion in words.
        holds: tells whether numbers meet it.
    """

    text: str
    holds: Callable[[Value], bool]


def near(printed: Value, tolerance: float) -> Criterion:
    """Makes the criterion that each number is within an absolute tolerance of the printed one."""
    wanted = "; ".join(f"{number:g}" for number in _tuple(printed))
    text = f"within {tolerance:g} of {wanted}" if tolerance else f"exactly {wanted}"
    return Criterion(text, lambda value: _all_within(value, printed, tolerance))


def about(printed: float, share: float) -> Criterion:
    """Makes the criterion that each number is within a share of the printed one."""
    tolerance = share * abs(printed)
    return Criterion(f"within {100 * share:g} % of {printed:g}", lambda value: _all_within(value, printed, tolerance))


def equal(share: float) -> Criterion:
    """Makes the criterion that two numbers differ by at most a share of the second."""

    def holds(value: Value) -> bool:
        first, second = _tuple(value)
        return abs(first - second) <= share * abs(second)

    return Criterion(f"the two within {100 * share:g} % of each other", holds)


def below(limit: float) -> Criterion:
    """Makes the criterion that every number is below a limit."""
    return Criterion(f"below {limit:g}", lambda value: max(_tuple(value)) < limit)


def above(limit: float) -> Criterion:
    """Makes the criterion that every number is above a limit."""
    return Criterion(f"above {limit:g}", lambda value: min(_tuple(value)) > limit)


def between(low: float, high: float) -> Criterion:
    """Makes the criterion that every number is between two limits, limits included."""
    return Criterion(
        f"from {low:g} to {high:g}", lambda value: low <= min(_tuple(value)) and max(_tuple(value)) <= high
    )


def first(criterion: Criterion) -> Criterion:
    """Makes a criterion for the first number alone; the other numbers are there for comparison."""
    return Criterion(f"the first {criterion.text}", lambda value: criterion.holds(_tuple(value)[0]))


def rising() -> Criterion:
    """Makes the criterion that each number is larger than the one before."""
    return Criterion("each larger than the one before", lambda value: all(a < b for a, b in pairwise(_tuple(value))))


def falling() -> Criterion:
    """Makes the criterion that each number is smaller than the one before."""
    return Criterion("each smaller than the one before", lambda value: all(a > b for a, b in pairwise(_tuple(value))))


def least(which: int) -> Criterion:
    """Makes the criterion that one number, counted from 0, is smaller than each of the others."""

    def holds(value: Value) -> bool:
        numbers = _tuple(value)
        return all(numbers[which] < other for i, other in enumerate(numbers) if i != which)

    return Criterion(f"number {which + 1} smaller than the others", holds)


def named(said: Mapping[str, Any], printed: Value | None) -> Criterion:
    """Makes a criterion from its name and what it takes, such as {"below": 1.0} or {"first": {"below": 1.0}}.

    Args:
        said: the name, with a number, or several.
        printed: the number of the source, from which `near` and `about` count unless they have another.
    """
    ((name, given),) = said.items()
    if name == "first":
        return first(named(given, printed))
    given = given if isinstance(given, tuple) else (given,)
    from_printed = name in ("near", "about") and len(given) == 1
    return CRITERIA[name](*(printed, *given) if from_printed else given)


CRITERIA: dict[str, Callable[..., Criterion]] = {
    make.__name__: make for make in (near, about, equal, below, above, between, rising, falling, least)
}


def _tuple(value: Value) -> tuple[float, ...]:
    return value if isinstance(value, tuple) else (value,)


def _all_within(value: Value, printed: Value, tolerance: float) -> bool:
    numbers, wanted = _tuple(value), _tuple(printed)
    # the printed number is a decimal: a tolerance of half its last digit shall not fail by rounding
    return len(numbers) == len(wanted) and all(
        abs(a - b) <= tolerance * (1 + 1e-9) for a, b in zip(numbers, wanted, strict=True)
    )
