"""Operations on plain numbers and arrays of lanes alike, for which Python has no operator."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np


def where(condition: Any, one: Any, other: Any) -> Any:
    """Returns one value where a condition holds and another elsewhere, lane by lane if the condition is an array."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, one, other)
    return one if condition else other


def nowhere(condition: Any) -> bool:
    """Tells whether a condition holds in no lane."""
    return not (condition.any() if isinstance(condition, np.ndarray) else condition)


def first(choices: Sequence[tuple[Any, Any]], otherwise: Any) -> Any:
    """Returns the value of the first condition that holds.

    Args:
        choices: conditions with their values.
        otherwise: the value where no condition holds.
    """
    for condition, value in choices:
        if isinstance(condition, np.ndarray):
            conditions, values = zip(*choices, strict=True)
            return np.select(conditions, values, otherwise)
        if condition:
            return value
    return otherwise


def quotient(condition: Any, dividend: Any, divisor: Any, otherwise: Any) -> Any:
    """Returns the quotient where a condition holds, and another value elsewhere, where the divisor may be zero."""
    if not isinstance(condition, np.ndarray):
        return dividend / divisor if condition else otherwise
    return np.divide(dividend, divisor, out=np.broadcast_to(otherwise, condition.shape).copy(), where=condition)
