"""Sums, products, sines and cosines of scalars of any kind; entries that are the number zero are left out."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

import numpy as np


def vanishes(value: Any) -> bool:
    """Tells whether a scalar is the number zero."""
    return isinstance(value, float) and value == 0.0


def plus(a: Any, b: Any) -> Any:
    """Returns the sum, leaving out zeros."""
    if vanishes(b):
        return a
    return b if vanishes(a) else a + b


def times(a: Any, b: Any) -> Any:
    """Returns the product, which is the number zero if a factor is."""
    return 0.0 if vanishes(a) or vanishes(b) else a * b


def dot(a: Sequence[Any], b: Sequence[Any]) -> Any:
    """Returns Σ a b, leaving out zeros."""
    total: Any = 0.0
    for x, y in zip(a, b, strict=True):
        if not (vanishes(x) or vanishes(y)):
            total = x * y if vanishes(total) else total + x * y
    return total


def negate(value: Any) -> Any:
    """Returns the negative; the number zero stays zero."""
    return 0.0 if vanishes(value) else -value


def turn(angle: Any) -> tuple[Any, Any]:
    """Returns cosine and sine of an angle: a number, or a scalar that takes NumPy's functions."""
    if isinstance(angle, float):
        return math.cos(angle), math.sin(angle)
    return np.cos(angle), np.sin(angle)
