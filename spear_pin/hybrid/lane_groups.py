"""Groups of lanes in the same domain: what they are made of, and which domain fits them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import STICK
from spear_pin.hybrid.engines.taylor import Compiled, Point
from spear_pin.hybrid.modes import STARTS_TO_SLIDE
from spear_pin.hybrid.phases import AT_REST, SIGN, UNLOADED

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
Flags = NDArray[np.bool_]


@dataclass
class Group:
    """Lanes in the same domain: their numbers, clocks of the phase, states (2 nv, n) and what is held."""

    lanes: Indices
    t: Array
    y: Array
    held: dict[str, Any]

    def take(self, chosen: Any) -> Group:
        """Some of the lanes."""
        held = {name: take(value, chosen) for name, value in self.held.items()}
        return Group(self.lanes[chosen], self.t[chosen], self.y[:, chosen], held)


def moves(ready: Compiled, point: Point) -> Flags:
    """Whether the sliding of every closed toe fits its mode."""
    fits = np.ones(point.slopes.shape[1], bool)
    for (_, mode), sliding in zip(ready.closed, point.sliding, strict=True):
        at_rest = np.abs(sliding) <= AT_REST
        fits &= at_rest if mode == STICK else at_rest | (sliding * SIGN[mode] > 0.0)
    return fits


def _stays(ready: Compiled, point: Point, friction: Any) -> Flags:
    """Whether the forces keep each closed toe in its mode, (c, n)."""
    stays = np.empty(point.sliding.shape, bool)
    for i, (_, mode) in enumerate(ready.closed):
        tangential, normal = point.forces[i]
        if mode == STICK:
            stays[i] = np.abs(tangential) < friction * normal - UNLOADED
        else:
            pushed = point.accelerations[i] * SIGN[mode] > -STARTS_TO_SLIDE
            stays[i] = pushed | (np.abs(point.sliding[i]) > AT_REST)
        stays[i] &= normal > 0.0
    return stays & (point.pivots > 0.0).all(axis=0)


def keeps(ready: Compiled, point: Point, friction: Any) -> Flags:
    """Whether the forces keep every closed toe in its mode."""
    return np.asarray(_stays(ready, point, friction).all(axis=0))


def leaves(ready: Compiled, point: Point, friction: Any) -> Flags:
    """Whether those that are not kept would have to be held down."""
    pulled = (point.forces[:, 1] <= 0.0) & (point.pivots > 0.0).all(axis=0)
    return np.asarray((_stays(ready, point, friction) | pulled).all(axis=0))


# what is held, by lane


def take(value: Any, chosen: Any) -> Any:
    """What some lanes hold."""
    if isinstance(value, tuple):
        return tuple(take(item, chosen) for item in value)
    return value[chosen] if isinstance(value, np.ndarray) else value


def spread(value: Any, n: int) -> Any:
    """The same for n lanes, as arrays."""
    if isinstance(value, tuple):
        return tuple(spread(item, n) for item in value)
    return np.array(np.broadcast_to(np.asarray(value, dtype=float), (n,)))


def collected(values: list[Any]) -> Any:
    """What lanes hold, one by one, as arrays."""
    if isinstance(values[0], tuple):
        return tuple(collected(list(items)) for items in zip(*values, strict=True))
    return np.array(values, dtype=float)


def appended(values: list[Any]) -> Any:
    """What several groups hold."""
    if isinstance(values[0], tuple):
        return tuple(appended(list(items)) for items in zip(*values, strict=True))
    return np.concatenate(values)


def merged(groups: list[Group]) -> Group:
    """Groups of the same domain as one."""
    if len(groups) == 1:
        return groups[0]
    return Group(
        np.concatenate([group.lanes for group in groups]),
        np.concatenate([group.t for group in groups]),
        np.concatenate([group.y for group in groups], axis=1),
        {name: appended([group.held[name] for group in groups]) for name in groups[0].held},
    )


def stacked(rows: list[list[Any]], n: int) -> Array:
    """A matrix of arrays as an array of matrices, (n, rows, columns)."""
    return np.array([[np.broadcast_to(value, n) for value in row] for row in rows], dtype=float).transpose(2, 0, 1)


def along(row: list[Any], vector: Array) -> Any:
    """A row times vectors."""
    return sum(value * rate for value, rate in zip(row, vector, strict=True))
