"""Groups of lanes in the same domain."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.fields import map_nested

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
    if isinstance(value, tuple):  # often called: a function of each value would cost more
        return tuple(take(item, chosen) for item in value)
    return value[chosen] if isinstance(value, np.ndarray) else value


def alone(held: Held) -> Held:
    """Returns the held values of a group of one lane as plain numbers."""
    return {name: map_nested(np.ndarray.item, value) for name, value in held.items()}


def finite(value: Any, n: int) -> Flags:
    """Tells which of n lanes hold only finite numbers."""
    items = value.values() if isinstance(value, Mapping) else value if isinstance(value, tuple) else None
    if items is None:
        return np.array(np.broadcast_to(np.isfinite(value), (n,)), dtype=bool)
    return np.asarray(np.all([np.ones(n, bool), *(finite(item, n) for item in items)], axis=0), dtype=bool)


def spread_held(held: Held, n: int) -> dict[str, Any]:
    """Repeats held values for each of n lanes."""

    def repeated(number: Any) -> Array:
        return np.array(np.broadcast_to(np.asarray(number, dtype=float), (n,)))

    return {name: map_nested(repeated, value) for name, value in held.items()}


def join_held(values: Sequence[Any]) -> Any:
    """Joins the held values of several groups, or of single lanes, into arrays."""
    if isinstance(values[0], dict):
        return {name: join_held([value[name] for value in values]) for name in values[0]}
    if isinstance(values[0], tuple):
        return tuple(join_held(items) for items in zip(*values, strict=True))
    return np.hstack(values, dtype=float)


def merge_groups(groups: list[Group]) -> Group:
    """Merges groups of the same domain into one."""
    if len(groups) == 1:
        return groups[0]
    return Group(
        np.concatenate([group.lanes for group in groups]),
        np.concatenate([group.t for group in groups]),
        np.concatenate([group.y for group in groups], axis=1),
        join_held([group.held for group in groups]),
    )


def stack_matrices(rows: list[list[Any]], n: int) -> Array:
    """Turns a matrix of arrays into an array of matrices, (n, rows, columns)."""
    return np.array([[np.broadcast_to(value, n) for value in row] for row in rows], dtype=float).transpose(2, 0, 1)
