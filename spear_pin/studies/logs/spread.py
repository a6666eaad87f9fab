"""How far fitted values may be off: standard deviations, correlations, and what the data do not tell apart."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.studies.logs.residuals import Residuals

SINGULAR = 1e-5  # of the largest singular value, with columns of length one: what the data do not tell at all


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
    scaled, lengths = _seen(problem, jacobian)
    _, sizes, rows = np.linalg.svd(scaled, full_matrices=False)
    if sizes[-1] < SINGULAR * sizes[0]:
        alike = [name for name, share in zip(problem.over, np.abs(rows[-1]), strict=True) if share > 0.2]
        expected = f"fewer of them: the log does not tell {' and '.join(alike)} apart"
        raise BadValue("over", list(problem.over), f"{expected}; hold one, {_anchor(alike)}")
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
    scaled, lengths = _seen(problem, jacobian)
    kept = [parts != part for part in np.unique(parts)]
    moved = [np.linalg.lstsq(scaled[rows], residual[rows], rcond=None)[0] / lengths for rows in kept]
    return np.asarray(np.sqrt((1.0 - 1.0 / len(kept)) * np.sum(np.square(moved), axis=0)))


def _seen(problem: Residuals, jacobian: Array) -> tuple[Array, Array]:
    """Returns the slopes by the fitted values that no start explains, of length one, (N, k), and their lengths."""
    own, starts = np.split(jacobian, [len(problem.over)], axis=1)
    basis, _ = np.linalg.qr(starts)
    seen = own - basis @ (basis.T @ own)
    lengths = np.linalg.norm(seen, axis=0)
    return seen / np.where(lengths > 0.0, lengths, 1.0), lengths


def _anchor(alike: Sequence[str]) -> str:
    if any(name == "torque_scale" or name.endswith(("_mass", "_armature", "_inertia")) for name in alike):
        return "such as a mass that was weighed, or the torque's scale from a force that was measured"
    return "at a value that was measured otherwise"


def correlation_time(residual: Array) -> float:
    """Returns how many samples in a row say the same: 1 + 2 Σ of the correlations until they vanish."""
    away = residual - residual.mean()
    products = np.correlate(away, away, "full")[len(away) - 1 :]
    if not products[0] > 0.0:
        return 1.0
    shares = products / products[0]
    ends = np.flatnonzero(shares <= 0.0)
    return float(1.0 + 2.0 * shares[1 : ends[0] if ends.size else len(shares)].sum())
