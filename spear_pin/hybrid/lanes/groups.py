"""Groups of lanes in the same domain."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array

Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]
Held = Mapping[str, Any]


@dataclass(frozen=True)
class Group:
    """Lanes in the same domain.

    Attributes:
        lanes: indices of the lanes, (n,).
        t: time since the phase began, in s, (n,).
        y: states, (2 nv, n).
        held: held values, arrays of n or nested tuples of them.
    """

    lanes: Indices
    t: Array
    y: Array
    held: dict[str, Any]

    def __len__(self) -> int:
        return len(self.lanes)

    def take(self, chosen: Any) -> Group:
        """Returns the group of the chosen lanes."""
        held = {name: take(value, chosen) for name, value in self.held.items()}
        return Group(self.lanes[chosen], self.t[chosen], self.y[:, chosen], held)


# held values, by lane


def take(value: Any, chosen: Any) -> Any:
    """Returns the held values of the chosen lanes."""
    if isinstance(value, tuple):
        return tuple(take(item, chosen) for item in value)
    return value[chosen] if isinstance(value, np.ndarray) else value


def alone(value: Any) -> Any:
    """Returns the held values of a group of one lane as plain numbers."""
    if isinstance(value, dict):
        return {name: alone(item) for name, item in value.items()}
    if isinstance(value, tuple):
        return tuple(alone(item) for item in value)
    return value.item() if isinstance(value, np.ndarray) else value


def finite(value: Any, n: int) -> Flags:
    """Tells which of n lanes hold only finite numbers."""
    items = value.values() if isinstance(value, Mapping) else value if isinstance(value, tuple) else None
    if items is None:
        return np.array(np.broadcast_to(np.isfinite(value), (n,)), dtype=bool)
    return np.asarray(np.all([np.ones(n, bool), *(finite(item, n) for item in items)], axis=0), dtype=bool)


def spread(value: Any, n: int) -> Any:
    """Repeats a value, or nested tuples of values, for each of n lanes."""
    if isinstance(value, tuple):
        return tuple(spread(item, n) for item in value)
    return np.array(np.broadcast_to(np.asarray(value, dtype=float), (n,)))


def collected(values: list[Any]) -> Any:
    """Collects the held values of single lanes into arrays."""
    if isinstance(values[0], tuple):
        return tuple(collected(list(items)) for items in zip(*values, strict=True))
    return np.array(values, dtype=float)


def appended(values: list[Any]) -> Any:
    """Concatenates the held values of several groups."""
    if isinstance(values[0], tuple):
        return tuple(appended(list(items)) for items in zip(*values, strict=True))
    return np.concatenate(values)


def merged(groups: list[Group]) -> Group:
    """Merges groups of the same domain into one."""
    if len(groups) == 1:
        return groups[0]
    return Group(
        np.concatenate([group.lanes for group in groups]),
        np.concatenate([group.t for group in groups]),
        np.concatenate([group.y for group in groups], axis=1),
        {name: appended([group.held[name] for group in groups]) for name in groups[0].held},
    )


def stacked(rows: list[list[Any]], n: int) -> Array:
    """Turns a matrix of arrays into an array of matrices, (n, rows, columns)."""
    return np.array([[np.broadcast_to(value, n) for value in row] for row in rows], dtype=float).transpose(2, 0, 1)


def along(row: list[Any], vector: Array) -> Any:
    """Returns the product of a row with each vector."""
    return sum(value * rate for value, rate in zip(row, vector, strict=True))
