"""A motion as the polynomials by which a Taylor integrator took its steps, to be looked at anywhere along it."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Polynomials(NamedTuple):
    """States over time, a step after the other.

    Attributes:
        begins: when each step does, in s, rising, (steps,).
        coefficients: of powers of the time since then, (steps, rows, order + 1).
    """

    begins: Array
    coefficients: Array

    def at(self, times: Array) -> Array:
        """States at times, (rows, n)."""
        step = np.maximum(np.searchsorted(self.begins, times, side="right") - 1, 0)
        since, of_step = (times - self.begins[step])[:, None], self.coefficients[step]
        states = of_step[..., -1]
        for k in range(of_step.shape[-1] - 2, -1, -1):
            states = states * since + of_step[..., k]
        return states.T
