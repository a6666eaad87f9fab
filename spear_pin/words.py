"""Numbers in words that somebody typed: ASCII digits, nothing that only Python or Unicode takes for one."""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[+-]?((\d+\.?\d*|\.\d+)(e[+-]?\d+)?|inf|infinity|nan)", re.ASCII | re.IGNORECASE)
_WHOLE = re.compile(r"[+-]?\d{1,300}", re.ASCII)


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
