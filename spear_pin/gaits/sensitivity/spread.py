"""Covariance of parameters, from standard deviations by name or from a matrix."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.words import number

ROUNDING = 1e-9  # tolerance of a correlation matrix's symmetry and definiteness


def covariance_of(spread: Mapping[str, float | str] | ArrayLike, over: Sequence[str], values: Array) -> Array:
    """Returns the covariance of parameters, (m, m).

    Args:
        spread: standard deviations by name, as numbers or in per cent of a value as text; or a covariance, (m, m).
        over: names of the parameters.
        values: values of the parameters, (m,).

    Raises:
        UnknownName: a name is not among the parameters.
        BadValue: a deviation is not a finite number >= 0 or is a share of a value that is zero, or a matrix is not a
            covariance.
    """
    if not isinstance(spread, Mapping):
        return _checked(spread, len(over))
    for name in spread:
        if name not in over:
            raise UnknownName("parameter", name, over)
    given = [deviation(name, spread.get(name, 0.0), value) for name, value in zip(over, values.tolist(), strict=True)]
    return np.diag(np.square(given))


def deviation(name: str, word: float | str, value: float) -> float:
    """Returns a standard deviation, read from a number or from text such as "0.5" or "2 %".

    Raises:
        BadValue: the word is not a finite number >= 0, or is a share of zero.
    """
    expected = "a finite number >= 0, or a share of the value such as '2 %'"
    text = str(word).strip()
    try:
        found = number(text.removesuffix("%").strip()) if isinstance(word, str) else float(word)
    except ValueError:
        raise BadValue(f"spread[{name!r}]", word, expected) from None
    if not (np.isfinite(found) and found >= 0.0):
        raise BadValue(f"spread[{name!r}]", word, expected)
    if isinstance(word, str) and text.endswith("%"):
        if value == 0.0:
            raise BadValue(f"spread[{name!r}]", word, "a number in the parameter's unit, for its value is 0")
        return 0.01 * found * abs(value)
    return found


def factor(covariance: Array) -> Array:
    """Returns L with Σ = L Lᵀ, (m, m), for a covariance that may be singular."""
    scale = np.sqrt(np.diag(covariance))
    unit = np.where(scale > 0.0, scale, 1.0)
    shares, vectors = np.linalg.eigh(covariance / np.outer(unit, unit))
    found: Array = unit[:, None] * vectors * np.sqrt(np.maximum(shares, 0.0))
    return found


def _checked(spread: Any, m: int) -> Array:
    expected = f"a covariance: finite, {m} by {m}, symmetric, without a negative variance in any direction"
    try:
        matrix = np.array(spread, dtype=float)
    except (TypeError, ValueError):
        raise BadValue("spread", spread, expected) from None
    if matrix.shape != (m, m) or not np.isfinite(matrix).all():
        raise BadValue("spread", spread, expected)
    scale = np.sqrt(np.maximum(np.diag(matrix), 0.0))
    unit = np.where(scale > 0.0, scale, 1.0)
    correlation = matrix / np.outer(unit, unit)
    if np.abs(correlation - correlation.T).max() > ROUNDING or np.linalg.eigvalsh(correlation).min() < -ROUNDING:
        raise BadValue("spread", spread, expected)
    return np.asarray(0.5 * (matrix + matrix.T), np.float64)
