"""The terms of the equations of motion at a state, for scalars of any kind."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, NamedTuple


class Feet(NamedTuple):
    """Kinematics of the toes at a state, in two dimensions or in three.

    Attributes:
        positions: x, in space y, and z of each toe.
        jacobians: J of each toe, as many rows of nv.
        drifts: J̇ v of each toe.
    """

    positions: dict[str, tuple[Any, ...]]
    jacobians: dict[str, list[list[Any]]]
    drifts: dict[str, tuple[Any, ...]]


@dataclass(frozen=True)
class Terms:
    """The equations of motion at a state: D v̇ + bias = B u + Σ Jᵀ F, (3.16).

    Attributes:
        mass_matrix: D, nv rows of nv.
        bias: C v + G, nv.
        positions, jacobians, drifts: position, J and J̇ v of each toe, as `Feet` has them.
    """

    mass_matrix: list[list[Any]]
    bias: list[Any]
    positions: dict[str, tuple[Any, ...]]
    jacobians: dict[str, list[list[Any]]]
    drifts: dict[str, tuple[Any, ...]]
