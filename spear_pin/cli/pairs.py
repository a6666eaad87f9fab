"""Names with values on the command line: `a=1,b=2`, and ranges, `a=1:2`; `help` stands for a name that is unknown."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import TypeVar

from spear_pin.errors import ALL, BadValue

RANGE = "NAME=LOW:HIGH"
T = TypeVar("T")


def names(word: str) -> list[str]:
    """Read names, apart by commas."""
    found = [part.strip() for part in word.split(",")]
    if not all(found):
        raise argparse.ArgumentTypeError(
            f"{word!r} is no list of names; expected names separated by commas, such as stiffness,damping"
        )
    return found


def ranges(word: str) -> list[tuple[str, tuple[float, float]]]:
    """Read ranges, `NAME=LOW:HIGH`, apart by commas."""
    if word == ALL:
        return [(ALL, (0.0, 1.0))]
    found = []
    for name, value in _pairs(word, RANGE):
        ends = value.split(":")
        if len(ends) != 2 or not all(ends):
            raise argparse.ArgumentTypeError(f"'{name}={value}' is not {RANGE}")
        found.append((name, (_number(ends[0], name), _number(ends[1], name))))
    return found


def one_range(word: str) -> tuple[str, tuple[float, float]]:
    """Read one range."""
    found = ranges(word)
    if len(found) != 1:
        raise argparse.ArgumentTypeError(f"{word!r} is more than one range; give one, such as stiffness=40:60")
    return found[0]


def values(word: str) -> list[tuple[str, float]]:
    """Read values, `NAME=VALUE`, apart by commas."""
    if word == ALL:
        return [(ALL, 1.0)]
    return [(name, _number(value, name)) for name, value in _pairs(word, "NAME=VALUE")]


def words(word: str) -> list[tuple[str, str]]:
    """Read words that belong to names, `NAME=VALUE`, apart by commas."""
    return _pairs(word, "NAME=VALUE")


def one_pair(word: str, expected: str = "NAME=VALUE") -> tuple[str, str]:
    """Read one `NAME=VALUE`, of which either side may have commas."""
    name, sign, value = (piece.strip() for piece in word.partition("="))
    if not (name and sign and value):
        raise argparse.ArgumentTypeError(f"{word!r} is not {expected}")
    return name, value


def once(pairs: Iterable[tuple[str, T]], option: str) -> dict[str, T]:
    """Pairs of an option by their names.

    Raises:
        BadValue: a name is given twice.
    """
    found: dict[str, T] = {}
    for name, value in pairs:
        if name in found:
            raise BadValue(option, name, "each name once")
        found[name] = value
    return found


def _pairs(word: str, expected: str) -> list[tuple[str, str]]:
    return [one_pair(part, expected) for part in word.split(",")]


def _number(text: str, name: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} of {name} is no number; expected one such as 40 or 1e-3") from None
