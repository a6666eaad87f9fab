"""Plain numbers and arrays of lanes alike: what Python has no operator for."""

from __future__ import annotations

from typing import Any

import numpy as np


def where(condition: Any, one: Any, other: Any) -> Any:
    """One value where a condition holds and another elsewhere, lane by lane if the condition is an array."""
    if isinstance(condition, np.ndarray):
        return np.where(condition, one, other)
    return one if condition else other
