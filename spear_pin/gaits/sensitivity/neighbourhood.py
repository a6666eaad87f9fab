"""Gaits near a gait: where they are to first order, and which of their multipliers is which."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.result import State
from spear_pin.hybrid.section import section
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.model.motor import Drive, Motor


@dataclass(frozen=True)
class Neighbourhood:
    """A gait, and how gaits near it differ from it to first order.

    Attributes:
        system: the system.
        state: (q, v) on the section.
        over: names of the parameters that differ.
        values: values of these parameters, (m,).
        vary: names of the numbers that are solved for.
        solved: values of the numbers that are solved for, (k,).
        keep: names of as many measures that keep their values.
        kept: values of these measures, (k,).
        state_slopes: derivatives of (q, v), (2 nv, m).
        solved_slopes: derivatives of the numbers that are solved for, (k, m).
        multipliers: Floquet multipliers, (d,).
        motors: motors whose heat, or drives whose electricity, is measured, by the names of their joints.
    """

    system: HybridSystem
    state: State
    over: tuple[str, ...]
    values: Array
    vary: tuple[str, ...]
    solved: Array
    keep: tuple[str, ...]
    kept: Array
    state_slopes: Array
    solved_slopes: Array
    multipliers: NDArray[np.complex128]
    motors: Mapping[str, Motor | Drive] = field(default_factory=dict)

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of the numbers of a state, the same as a trajectory's columns."""
        names = self.system.robot.coordinates
        return (*(f"q_{name}" for name in names), *(f"v_{name}" for name in names))

    @property
    def units(self) -> dict[str, str]:
        """Units of these numbers."""
        units = self.system.robot.units
        return dict(zip(self.columns, (*units, *(f"{unit}/s" for unit in units)), strict=True))

    def predicted(self, parameters: Array) -> tuple[Array, Array]:
        """Predicts states, (n, 2 nv), near the section, and solved numbers, (n, k), for parameters, (n, m)."""
        change = parameters - self.values
        return (
            np.concatenate(self.state) + change @ self.state_slopes.T,
            self.solved + change @ self.solved_slopes.T,
        )

    def placed(self, system: HybridSystem, y: Array, numbers: Mapping[str, Array] | None = None) -> tuple[Array, Array]:
        """Puts states, (n, 2 nv), onto the section, with the same toes sliding as in this gait.

        Args:
            system: the system whose section it is.
            y: the states.
            numbers: numbers that differ between the states, (n,) each.
        """
        nv, whole = self.system.robot.nv, section(system, numbers)
        slides = section(self.system).sliding(self.state[0][None], self.state[1][None])[0]
        charts = whole.charts(y[:, :nv], y[:, nv:], slides)
        return charts.states(np.zeros((len(y), charts.dimension)))

    def moduli(self, multipliers: NDArray[np.complex128]) -> Array:
        """Returns moduli of multipliers in the order of this gait's, (d,); NaN where the numbers differ."""
        try:
            return np.abs(match_multipliers(self.multipliers, multipliers[np.isfinite(multipliers)]))
        except NotDifferentiable:
            return np.full(len(self.multipliers), np.nan)


def match_multipliers(here: NDArray[np.complex128], others: Any) -> NDArray[np.complex128]:
    """Returns multipliers in the order of nearby ones.

    Raises:
        NotDifferentiable: there are more or fewer multipliers than nearby.
    """
    if len(here) != len(others):
        raise NotDifferentiable("a toe begins to slide as it lands")
    _, order = scipy.optimize.linear_sum_assignment(np.abs(here[:, None] - others))
    return np.asarray(others[order], np.complex128)
