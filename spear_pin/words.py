"""Numbers in words, with their units: those that somebody typed, in ASCII digits, and those that somebody reads."""

from __future__ import annotations

import re
from decimal import Decimal

_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf|infinity|nan)", re.ASCII | re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?\d{1,300}", re.ASCII)


def significant(value: float, digits: int = 3) -> str:
    """Write a number with so many digits that count, and without an exponent.

    Example:
        >>> from spear_pin.words import significant
        >>> significant(11.3456), significant(0.0286479), significant(-4.0, 4)
        ('11.3', '0.0286', '-4.000')
    """
    return f"{Decimal(f'{value:.{digits - 1}e}'):f}"


def show_unit(unit: str) -> str:
    """Writes a unit as it stands behind a number: that of numbers without one, "1", is not written.

    Example:
        >>> from spear_pin.words import show_unit
        >>> show_unit("1/s"), show_unit("1")
        ('1/s', '')
    """
    return "" if unit == "1" else unit


def number(word: str) -> float:
    """Read a number; 5_0 and ٥ are none.

    Raises:
        ValueError: it is none.
    """
    if not _NUMBER.fullmatch(word.strip(" ")):
        raise ValueError(f"not a number: {word!r}")
    return float(word)


def whole(word: str) -> int:
    """Read a whole number.

    Raises:
        ValueError: it is none.
    """
    if not _WHOLE.fullmatch(word.strip(" ")):
        raise ValueError(f"not a whole number: {word!r}")
    return int(word)
