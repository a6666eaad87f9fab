"""The grid on which nearly all of a record's samples lie, where an encoder, a converter or decimal digits made one.

The spectrum of the values that occur, Σ √n exp(2πi f θ) over values θ with n samples each, is high at one over the step
of a grid. From the coarsest such step on, the function counts the samples that lie elsewhere.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array

Whole = NDArray[np.int64]

FINEST = 1e-5  # rad: steps below are those of floating-point numbers, or of nothing
OFF = 0.01  # of the samples, one at least, may lie off the grid; and as many far out
NEAR = 0.25  # of a step that a value may be off: counts may have been written down in few digits
MOST = 100_000  # steps between the least and the largest value
PAIRS = 4  # neighbours that a grid may be expected to show; on a finer one anything lies
TALL = 0.4  # of what the spectrum can be at most


def grid_step(angle: Array) -> float:
    """Returns the step of the coarsest grid with one value for each of its points, in rad; 0 if there is none.

    Args:
        angle: recorded angles, (n,), in rad.
    """
    place, samples = _values(angle)
    if place.size < 2:
        return 0.0
    allowed = max(1.0, OFF * angle.size)
    for frequency in _peaks(place, samples):
        step, elsewhere = _counted(place, samples, float(frequency))
        if elsewhere <= allowed:
            return step
    return 0.0


def _values(angle: Array) -> tuple[Array, Whole]:
    """Returns values that occur, increasing from 0, and how often; without the outermost samples."""
    outer = max(1, round(0.5 * OFF * angle.size))
    ordered = np.sort(angle)[outer:-outer]
    first = np.flatnonzero(np.diff(ordered, prepend=-np.inf) > FINEST)
    return ordered[first] - ordered[:1], np.diff(first, append=ordered.size)


def _peaks(place: Array, samples: Whole) -> Array:
    """Returns frequencies at which the spectrum is high, increasing, in 1/rad."""
    span = place[-1]
    most = min(span / FINEST, MOST, max(place.size, place.size**2 / PAIRS))
    width, bins = span / (3.0 * most), 2 ** int(np.ceil(np.log2(12.0 * most)))
    spectrum = np.abs(np.fft.rfft(np.bincount(np.rint(place / width).astype(int), np.sqrt(samples), bins)))
    here, frequency = spectrum[1:-1], np.arange(1, spectrum.size - 1) / (bins * width)
    tall = (here >= TALL * spectrum[0]) & (here >= spectrum[:-2]) & (here >= spectrum[2:])
    return np.asarray(frequency[tall & (frequency * span <= 1.05 * most)])


def _counted(place: Array, samples: Whole, frequency: float) -> tuple[float, int]:
    """Returns the step near one over a frequency, and how many samples lie off the grid or off its point's value."""
    turns = frequency * place
    index = np.rint(turns - np.angle(np.exp(2j * np.pi * turns).sum()) / (2.0 * np.pi))
    share = samples / samples.sum()  # values off the grid have few samples
    centred = index - share @ index
    if not centred.any():
        return 0.0, int(samples.sum())
    step = float((share * centred) @ place / ((share * centred) @ centred))
    near = np.abs(place - share @ place - step * centred) <= NEAR * step
    points = np.flatnonzero(np.diff(index[near], prepend=-np.inf))
    on = np.maximum.reduceat(samples[near], points).sum() if points.size else 0
    return step, int(samples.sum() - on)
