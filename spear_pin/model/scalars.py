"""Sums and products of scalars of any kind, in which entries that are the number zero are left out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any


def vanishes(value: Any) -> bool:
    """Whether a scalar is the number zero."""
    return isinstance(value, float) and value == 0.0


def plus(a: Any, b: Any) -> Any:
    """The sum, leaving out what is zero."""
    if vanishes(b):
        return a
    return b if vanishes(a) else a + b


def times(a: Any, b: Any) -> Any:
    """The product, zero if a factor is."""
    return 0.0 if vanishes(a) or vanishes(b) else a * b


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Σ a b, leaving out what is zero."""
    total: Any = 0.0
    for x, y in zip(a, b, strict=True):
        product = times(x, y)
        if not vanishes(product):
            total = product if vanishes(total) else total + product
    return total


def negated(value: Any) -> Any:
    """The negative, zero of zero."""
    return 0.0 if vanishes(value) else -value
