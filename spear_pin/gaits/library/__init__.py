"""Shipped gaits, as JSON files, each with its parameters, residual and multipliers."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from importlib.resources import files
from pathlib import Path
from types import MappingProxyType
from typing import Any

from spear_pin.errors import UnknownName
from spear_pin.gaits.request import Request

_LONG_STRIDE = Request(minimum_stride=0.35, minimum_knee_torque=30.0)
_SPEEDS = (1.5, 1.75, 2.0, 2.25, 2.75, 3.0, 3.25, 3.5)  # m/s

REQUESTS: Mapping[str, Request] = MappingProxyType(
    {
        "least_effort": Request(),
        "long_stride": _LONG_STRIDE,
        "force_lift_off": Request(lift_off="force", minimum_stride=0.3, minimum_knee_torque=30.0),
        **{f"long_stride_{speed:.2f}": replace(_LONG_STRIDE, speed=speed) for speed in _SPEEDS},
    }
)
"""Request for each gait that ships, by name."""
TURNS: Mapping[str, tuple[float, float]] = MappingProxyType(
    {f"turn_{angle}": (angle, 2.5) for angle in (4, 6, 9, 10, 13)}
    | {f"turn_9_{speed:.2f}": (9, speed) for speed in (2.25, 2.75)}
)
"""Turning gaits that ship, by name: degrees a stride, and speed along the heading, in m/s."""
IN_SPACE = ("trot", "pace", "pronk", "gallop", *TURNS)


def names() -> tuple[str, ...]:
    """Returns the names of the planar gaits that ship; `IN_SPACE` lists those in space."""
    stems = (entry.name.removesuffix(".json") for entry in files(__name__).iterdir() if entry.name.endswith(".json"))
    return tuple(sorted(stem for stem in stems if stem not in IN_SPACE))


def all_names() -> tuple[str, ...]:
    """Returns the names of all gaits that ship."""
    return (*names(), *IN_SPACE)


def path(name: str) -> Path:
    """Returns the path of a shipped gait.

    Raises:
        UnknownName: no shipped gait has that name.
    """
    if name not in all_names():
        raise UnknownName("gait", name, all_names(), "the path of a saved gait")
    return Path(str(files(__name__).joinpath(f"{name}.json")))


def written() -> dict[str, dict[str, Any]]:
    """Returns the contents of each shipped gait's file, as `Gait.save` wrote it, by name."""
    return {name: json.loads(path(name).read_text(encoding="utf-8")) for name in names()}
