"""A motion as the polynomials of a Taylor integrator's steps, which give the state at any time."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array


@dataclass(frozen=True, eq=False)
class Polynomials:
    """States over time, one polynomial for each step.

    Attributes:
        begins: time at which each step begins, in s, increasing, (steps,).
        coefficients: coefficients of the powers of the time since a step began, (steps, rows, order + 1).
    """

    begins: Array
    coefficients: Array

    def __call__(self, times: Array) -> Array:
        """Returns the states, (rows, n), at n times, (n,)."""
        step = np.maximum(np.searchsorted(self.begins, times, side="right") - 1, 0)
        powers = np.ones((len(times), self.coefficients.shape[-1]))
        powers[:, 1:] = (times - self.begins[step])[:, None]
        np.multiply.accumulate(powers, axis=1, out=powers)
        states: Array = (self.coefficients[step] @ powers[..., None])[..., 0].T
        return states
