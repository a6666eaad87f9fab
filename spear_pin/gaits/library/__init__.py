"""Solved gaits, as JSON, each with its parameters, residual and multipliers."""

from __future__ import annotations

from importlib.resources import files
from pathlib import Path

from spear_pin.errors import UnknownName


def names() -> tuple[str, ...]:
    """Names of the gaits that ship."""
    return tuple(
        sorted(entry.name.removesuffix(".json") for entry in files(__name__).iterdir() if entry.name.endswith(".json"))
    )


def path(name: str) -> Path:
    """Path of a shipped gait.

    Raises:
        UnknownName: there is none of that name.
    """
    if name not in names():
        raise UnknownName("gait", name, [*names(), "the path of a saved gait"])
    return Path(str(files(__name__).joinpath(f"{name}.json")))
