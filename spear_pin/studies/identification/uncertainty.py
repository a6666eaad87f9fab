"""Uncertainty of a least-squares estimate: covariance, conditioning, whiteness of residuals, fit."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.studies.identification.smoothing import MovingAverage

LAGS = 20  # of the test of whiteness


@dataclass(frozen=True)
class Scatter:
    """Covariance of an estimate.

    Attributes:
        covariance: covariance, (m, m).
        noise: standard deviation of the white noise before smoothing.
        condition: condition of the Jacobian with columns of length one.
        inflation: standard deviations over those without correlated errors, (m,).
    """

    covariance: Array
    noise: float
    condition: float
    inflation: Array


def scatter(
    residuals: Sequence[Array],
    jacobians: Sequence[Array],
    smoothings: Sequence[MovingAverage | None],
    influence: tuple[Array, Array] | None = None,
    unsmoothed: Sequence[Array] | None = None,
    used: Sequence[NDArray[np.bool_]] | None = None,
    correlated: Iterable[Array] = (),
) -> Scatter:
    """Returns the covariance of a least-squares estimate from records that were smoothed, or not.

    White noise of variance σ² that went through F with the data leaves an estimate with the covariance
    σ² A⁻¹ (FᵀJ)ᵀ(FᵀJ) A⁻¹, A = JᵀJ, and a sum of squared residuals of σ² (tr FFᵀ - tr PFFᵀ) in the mean,
    P projecting on the columns of J. Without smoothing, F = 1, this is σ² A⁻¹ and σ² (n - m). Correlated errors
    of covariance Σ L Lᵀ add Σ (A⁻¹ (FᵀJ)ᵀ L) (…)ᵀ; σ² stays the same, as if residuals did not show them.

    Args:
        residuals: residuals of each record, (n,).
        jacobians: Jacobian of each record, (n, m), which tells all parameters apart.
        smoothings: smoothing of each record.
        influence: ψ and ψ' at all residuals for a robust loss (default: those of least squares, r and 1).
        unsmoothed: the residuals before smoothing, if known: they give the noise more accurately.
        used: which samples of each record count (default: all); residuals and Jacobian are 0 at the others.
        correlated: L of errors before smoothing that are not white, (N, any) for all samples (default: none).
    """
    jacobian = np.vstack(jacobians)
    scale = np.linalg.norm(jacobian, axis=0)
    left, singular, right = np.linalg.svd(jacobian / scale, full_matrices=False)
    count = scale.size
    back = _backwards(left, jacobians, smoothings)
    if influence is None and unsmoothed is not None:
        rows = np.concatenate(unsmoothed)
        variance = float(rows @ rows) / max(rows.size - count, 1)
    else:
        psi, slope = influence or (np.concatenate(residuals), np.ones(1))
        kept = used or [np.ones(r.size, dtype=bool) for r in residuals]
        gains = [np.ones(k.size) if f is None else f.gain(k.size) for k, f in zip(kept, smoothings, strict=True)]
        gain = sum(float(g[k].sum()) for g, k in zip(gains, kept, strict=True))
        variance = float(psi @ psi) / float(slope.mean()) ** 2 / max(gain - float((back**2).sum()), 1e-12)
    root = back @ (right / singular[:, None]) / scale
    white = variance * (root.T @ root)
    covariance = white + sum((image := root.T @ factor) @ image.T for factor in correlated)
    inflation = np.sqrt(np.diag(covariance) / np.maximum(np.diag(white), np.finfo(float).tiny))
    return Scatter(covariance, float(np.sqrt(variance)), float(singular[0] / singular[-1]), inflation)


def _backwards(left: Array, jacobians: Sequence[Array], smoothings: Sequence[MovingAverage | None]) -> Array:
    """Applies Fᵀ to the rows of each record."""
    ends = np.cumsum([jacobian.shape[0] for jacobian in jacobians])[:-1]
    parts = zip(np.split(left, ends), smoothings, strict=True)
    return np.vstack([part if smoothing is None else smoothing.adjoint(part) for part, smoothing in parts])


def whiteness(residuals: Sequence[Array], lags: int = LAGS) -> float:
    """Returns the probability that white noise is at least as correlated as these residuals, by Ljung and Box.

    Args:
        residuals: residuals of each record, (n,), before smoothing.
        lags: largest lag of the correlations, at most a fifth of the samples.
    """
    statistic, freedom = 0.0, 0
    for r in residuals:
        n, centred = r.size, r - r.mean()
        power = float(centred @ centred)
        if power == 0.0:
            continue
        for lag in range(1, min(lags, n // 5) + 1):
            statistic += n * (n + 2.0) * (float(centred[lag:] @ centred[:-lag]) / power) ** 2 / (n - lag)
            freedom += 1
    return float(scipy.stats.chi2.sf(statistic, freedom)) if freedom else 1.0


def nrmse_fit(measured: Array, predicted: Array) -> float:
    """Returns 100 (1 - ‖y - ŷ‖ / ‖y - ȳ‖) in percent: MATLAB's NRMSE fit."""
    spread = float(np.linalg.norm(measured - measured.mean()))
    return 100.0 * (1.0 - float(np.linalg.norm(measured - predicted)) / spread) if spread else -np.inf
