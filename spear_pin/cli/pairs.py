"""Names with values on the command line: `a=1,b=2`, and ranges, `a=1:2`."""

from __future__ import annotations

import argparse

RANGE = "NAME=LOW:HIGH"


def names(word: str) -> list[str]:
    """Read names, apart by commas."""
    found = [part.strip() for part in word.split(",")]
    if not all(found):
        raise argparse.ArgumentTypeError(f"{word!r} is no name, or several apart by commas")
    return found


def ranges(word: str) -> list[tuple[str, tuple[float, float]]]:
    """Read ranges, `NAME=LOW:HIGH`, apart by commas."""
    return [(name, (_number(low, name), _number(high, name))) for name, (low, high) in _parts(word, RANGE, ":")]


def one_range(word: str) -> tuple[str, tuple[float, float]]:
    """Read one range."""
    found = ranges(word)
    if len(found) != 1:
        raise argparse.ArgumentTypeError(f"{word!r} is more than one range")
    return found[0]


def values(word: str) -> list[tuple[str, float]]:
    """Read values, `NAME=VALUE`, apart by commas."""
    return [(name, _number(value, name)) for name, (value,) in _parts(word, "NAME=VALUE")]


def words(word: str) -> list[tuple[str, str]]:
    """Read names that belong to names, `NAME=NAME`, apart by commas."""
    return [(name, value) for name, (value,) in _parts(word, "NAME=NAME")]


def _parts(word: str, expected: str, between: str = "") -> list[tuple[str, list[str]]]:
    found = []
    for part in word.split(","):
        name, sign, value = part.partition("=")
        pieces = value.split(between) if between else [value]
        if not (name and sign and all(pieces) and len(pieces) == 1 + bool(between)):
            raise argparse.ArgumentTypeError(f"{part!r} is not {expected}")
        found.append((name.strip(), pieces))
    return found


def _number(text: str, name: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r} of {name} is no number") from None
