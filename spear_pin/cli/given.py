"""Options that were given, the refusal of those that have no place, and their names and values in errors."""

from __future__ import annotations

import argparse
from collections.abc import Iterator
from contextlib import contextmanager
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
        raise BadValue(f"--{name.replace('_', '-')}", write_typed(value), expected)


@contextmanager
def name_options(**options: str) -> Iterator[None]:
    """Name options, instead of a function's arguments, in the errors of the block.

    Args:
        **options: the option that gives each argument, such as over="--over".

    Raises:
        BadValue: an argument is not valid; `over['stiffness']` is `--over stiffness`.
    """
    try:
        yield
    except BadValue as error:
        argument, _, place = error.name.removesuffix("']").partition("['")
        if argument not in options:
            raise
        raise BadValue(f"{options[argument]} {place}".strip(), _write_range(error.value), error.expected) from None


def write_typed(value: Any) -> Any:
    """Write the value of an option as it is typed: ranges and values by name, or numbers, between commas."""
    if isinstance(value, list) and isinstance(value[0], tuple):
        return ",".join(f"{name}={_write_range(each)}" for name, each in value)
    return ",".join(f"{each:g}" for each in value) if isinstance(value, tuple) else value


def _write_range(value: Any) -> Any:
    return ":".join(f"{end:g}" for end in value) if isinstance(value, tuple) else value
