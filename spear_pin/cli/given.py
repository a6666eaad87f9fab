"""Options that were given, and the refusal of those that have no place."""

from __future__ import annotations

import argparse
from typing import Any

from spear_pin.errors import BadValue


def given(arguments: argparse.Namespace, *names: str) -> dict[str, Any]:
    """Options of these names that were given, with their values."""
    values = {name: getattr(arguments, name, None) for name in names}
    return {name: value for name, value in values.items() if value is not None and value is not False and value != []}


def refuse(arguments: argparse.Namespace, expected: str, *names: str) -> None:
    """Refuse options of these names, which have no place.

    Raises:
        BadValue: one was given.
    """
    for name, value in given(arguments, *names).items():
        raise BadValue(f"--{name.replace('_', '-')}", value, expected)
