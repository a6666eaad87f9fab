"""How far fitted values may be off: standard deviations, correlations, and what the data do not tell apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.studies.fitting import tell_apart
from spear_pin.studies.logs.residuals import Residuals


@dataclass(frozen=True)
class Found:
    """A value that was fitted.

    Attributes:
        value: the value, in its unit.
        deviation: its standard deviation: that of residuals that are correlated in time, or, where it is larger, that
            by which the value moves as a quarter of all stances or flights is left out.
        unit: the unit.
    """

    value: float
    deviation: float
    unit: str

    def __str__(self) -> str:
        return f"{self.value:.6g} ± {self.deviation:.2g} {self.unit}".removesuffix(" 1")


def spread(problem: Residuals, at: tuple[Array, Array], inflation: float) -> tuple[Array, Array]:
    """Returns the standard deviations of the fitted values, and their correlations.

    Raises:
        BadValue: some values cannot be told apart at all.
    """
    residual, jacobian = at
    scaled, lengths = tell_apart("over", problem.over, jacobian)
    free = max(len(residual) - jacobian.shape[1], 1)
    covariance = np.linalg.inv(scaled.T @ scaled) * float(residual @ residual) / free
    widths = np.sqrt(np.diag(covariance))
    return inflation * widths / lengths, covariance / np.outer(widths, widths)


def spread_by_parts(problem: Residuals, at: tuple[Array, Array], parts: Array) -> Array:
    """Returns the standard deviations of the fitted values by the jackknife that leaves out one part at a time.

    What the model misses at one instant of every hop is one error, not many: such a part has these instants of all
    hops. What starts explain of the residuals stays explained.

    Args:
        problem: the least squares.
        at: residuals, (N,), at the solution, and their Jacobian.
        parts: number of the part that a residual belongs to, (N,).
    """
    residual, jacobian = at
    scaled, lengths = tell_apart("over", problem.over, jacobian)
    kept = [parts != part for part in np.unique(parts)]
    moved = [np.linalg.lstsq(scaled[rows], residual[rows], rcond=None)[0] / lengths for rows in kept]
    return np.asarray(np.sqrt((1.0 - 1.0 / len(kept)) * np.sum(np.square(moved), axis=0)))


def correlation_time(residual: Array) -> float:
    """Returns how many samples in a row say the same: 1 + 2 Σ of the correlations until they vanish."""
    away = residual - residual.mean()
    products = np.correlate(away, away, "full")[len(away) - 1 :]
    if not products[0] > 0.0:
        return 1.0
    shares = products / products[0]
    ends = np.flatnonzero(shares <= 0.0)
    return float(1.0 + 2.0 * shares[1 : ends[0] if ends.size else len(shares)].sum())
