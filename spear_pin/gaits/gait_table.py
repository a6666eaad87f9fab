"""Outcomes of a search for very many gaits, and why each gait was found or not."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.gaits.lane_cycles import NO_MULTIPLIERS, NOT_VALID
from spear_pin.hybrid import reasons
from spear_pin.hybrid.newton import CONVERGED as CONVERGED
from spear_pin.hybrid.shooting import SHORT_CYCLE
from spear_pin.showing import Shown

NO_CONVERGENCE = "no_convergence"
REASONS: Mapping[str, str] = {
    CONVERGED: "a fixed point was found, with its multipliers",
    NO_CONVERGENCE: "Newton's method makes no progress",
    NO_MULTIPLIERS: "a fixed point was found, but a cycle that begins beside it does not close",
    SHORT_CYCLE: "the toe leaves the ground and returns at once",
    NOT_VALID: "a parameter is out of its range",
    **{name: text for name, text in reasons.REASONS.items() if name != "complete"},
}


@dataclass(frozen=True, repr=False)
class GaitTable(Shown):
    """Outcomes of the lanes, one row each; NaN where no fixed point was found.

    Attributes:
        q: configurations on the section, (n, nq).
        v: velocities on the section, (n, nv).
        parameters: given and solved parameters, by name, (n,) each.
        residual: ‖P(x) - x‖∞, (n,), in m, rad, m/s, rad/s.
        multipliers: Floquet multipliers by decreasing modulus, (n, d); NaN beyond the section's dimension.
        durations: duration of each phase in s, (n,) each.
        reason: a key of `REASONS`, (n,).
    """

    q: Array
    v: Array
    parameters: Mapping[str, Array]
    residual: Array
    multipliers: NDArray[np.complex128]
    durations: Mapping[str, Array]
    reason: NDArray[np.str_]

    def __len__(self) -> int:
        """Returns the number of lanes."""
        return len(self.reason)

    def __repr__(self) -> str:
        return f"GaitTable({len(self)} lanes: {self.converged.sum()} gaits found, {self.stable.sum()} stable)"

    @property
    def converged(self) -> NDArray[np.bool_]:
        """Whether the gait was found, (n,)."""
        return np.asarray(self.reason == CONVERGED)

    @property
    def largest(self) -> Array:
        """Modulus of the largest multiplier, (n,)."""
        return np.asarray(np.abs(self.multipliers[:, 0]))

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether the gait was found and every multiplier lies inside the unit circle, (n,)."""
        return self.converged & (self.largest < 1.0)
