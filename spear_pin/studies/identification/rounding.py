"""Addition to the error bars of an estimate by the steps in which an encoder or a converter counts.

If an angle moves by many steps from sample to sample, or trembles by more than one, its rounding errors are like white
noise. If it creeps, turns or rests, its rounding errors persist. Residuals hide them, because the fit follows them.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.studies.identification.grid import grid_step

HARMONICS = 20  # they hold 97 % of the power of an error of rounding
COARSE = 0.4  # of a step: noise above makes the errors of rounding white
JUMP = 8.0  # usual differences and steps from sample to sample: more is neither noise nor rounding


@dataclass(frozen=True)
class Rounding:
    """Rounding of the angle of a record.

    Attributes:
        step: step of the rounding, in rad; 0 if there was none, or if it is unknown.
        noise: standard deviation of the white noise before rounding, in rad.
    """

    step: float = 0.0
    noise: float = 0.0

    @property
    def variance(self) -> float:
        """Variance of the errors of noise and rounding together, in rad²."""
        return self.noise**2 + self.step**2 / 12.0

    @property
    def coarse(self) -> bool:
        """Whether the errors of rounding are correlated."""
        return self.noise < COARSE * self.step


def estimate_rounding(recorded: Array | None, predicted: Array) -> Rounding:
    """Returns the step, from the angle's values, and the noise, from the differences of successive residuals.

    An error that is not white, such as a model error, hardly changes from sample to sample; a glitch jumps.

    Args:
        recorded: angle before smoothing, (n,), in rad, if known.
        predicted: angle of the model, (n,), in rad.
    """
    if recorded is None:
        return Rounding()
    step = grid_step(recorded)
    jumps = np.abs(np.diff(predicted - recorded))
    scatter = 0.5 * float(np.mean(jumps[jumps <= JUMP * max(step, float(np.median(jumps)))] ** 2))
    return Rounding(step, float(np.sqrt(max(scatter - step**2 / 12.0, 0.0))))


def errors(
    angles: Sequence[Array], moving: Sequence[NDArray[np.bool_]], rounded: Sequence[Rounding]
) -> Iterator[Array]:
    """Yields factors L₁, L₂, … of the correlated part Σ L Lᵀ of the covariance of rounding errors.

    Over all places of the steps relative to the angle, two samples θ and θ' rounded to steps s have errors of
    covariance ½ s² B₂(frac((θ - θ') / s)), B₂ the Bernoulli polynomial, the Fourier series of which is
    s² / (2 π²) Σ cos(2πk (θ - θ') / s) / k²; independent noise of variance σ² in both takes exp(-(2πkσ / s)²) off
    each term (Sripad and Snyder, IEEE Trans. ASSP 25, 1977, 442-448; Widrow, Kollár and Liu, IEEE Trans.
    Instrum. Meas. 45, 1996, 353-361). Where within a step the hold lies, θ₀ being fitted to the very step,
    the estimate does not tell: the errors of holds are independent of those of motions.

    Args:
        angles: the model's angles, not smoothed, of each record, (n,), in rad.
        moving: of each record, whether a sample is after the release, (n,).
        rounded: rounding of each record.

    Yields:
        One harmonic after another, (N, 4), all records' samples one after the other, in rad.
    """
    sizes = [angle.size for angle in angles]
    angle, parts = np.concatenate(angles), np.column_stack([after := np.concatenate(moving), ~after])
    step, noise = (np.repeat(each, sizes) for each in np.array([[r.step, r.noise] for r in rounded]).T)
    wave = np.divide(2.0 * np.pi, step, out=np.zeros(angle.size), where=step > 0.0)
    for k in range(1, HARMONICS + 1):
        amplitude = step / (np.sqrt(2.0) * np.pi * k) * np.exp(-0.5 * (k * wave * noise) ** 2)
        if not amplitude.any():
            return
        cosine, sine = np.cos(k * wave * angle), np.sin(k * wave * angle)
        yield np.hstack([(amplitude * each)[:, None] * parts for each in (cosine, sine)])
