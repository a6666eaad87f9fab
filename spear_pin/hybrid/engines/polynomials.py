"""A motion as the polynomials by which a Taylor integrator took its steps, to be looked at anywhere along it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array


@dataclass(frozen=True, eq=False)
class Polynomials:
    """States over time, a step after the other.

    Attributes:
        begins: when each step does, in s, rising, (steps,).
        coefficients: of powers of the time since then, (steps, rows, order + 1).
    """

    begins: Array
    coefficients: Array

    def __call__(self, times: Array) -> Array:
        """States at times, (n,): (rows, n)."""
        step = np.maximum(np.searchsorted(self.begins, times, side="right") - 1, 0)
        powers = np.ones((len(times), self.coefficients.shape[-1]))
        powers[:, 1:] = (times - self.begins[step])[:, None]
        np.multiply.accumulate(powers, axis=1, out=powers)
        states: Array = (self.coefficients[step] @ powers[..., None])[..., 0].T
        return states
