"""The moving average with which the source smooths its records, and its adjoint."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName

Kind = Literal["centred", "causal"]
KINDS: tuple[Kind, ...] = get_args(Kind)


@dataclass(frozen=True)
class MovingAverage:
    """The mean over a window of samples, a linear operator F; at the ends, over the part of the window that exists.

    Attributes:
        window: number of samples (default: 100, as in Section 4.1.3).
        kind: "centred", the window reaching half of it to either side and, if even, one more to the past;
            or "causal", the window ending at the sample, which delays by half of it. The source does not say.
    """

    window: int = 100
    kind: Kind = "centred"

    def __post_init__(self) -> None:
        """Checks the fields."""
        if isinstance(self.window, bool) or not isinstance(self.window, int) or not 1 <= self.window <= 10**6:
            raise BadValue("window", self.window, "a whole number of samples, from 1 to 1,000,000")
        if self.kind not in KINDS:
            raise UnknownName("kind of moving average", self.kind, KINDS)

    def __call__(self, values: ArrayLike) -> Array:
        """Returns F x, for x (n,) or each column of (n, m)."""
        x = np.asarray(values, dtype=float)
        first, after, count = self._windows(x)
        level = x.mean(axis=0)  # a running sum of large numbers would lose digits
        total = np.concatenate([np.zeros((1, *x.shape[1:])), np.cumsum(x - level, axis=0)])
        return np.asarray((total[after] - total[first]) / count + level)

    def adjoint(self, values: ArrayLike) -> Array:
        """Returns Fᵀ x, for x (n,) or each column of (n, m)."""
        x = np.asarray(values, dtype=float)
        first, after, count = self._windows(x)
        spread = np.zeros((x.shape[0] + 1, *x.shape[1:]))
        np.add.at(spread, first, x / count)
        np.subtract.at(spread, after, x / count)
        return np.asarray(np.cumsum(spread, axis=0)[:-1])

    @property
    def ahead(self) -> int:
        """Number of samples of a window that come after its own sample."""
        return self.window - 1 - self._past

    def gain(self, samples: int) -> Array:
        """Returns the diagonal of F Fᵀ, the share of white noise's variance that remains, for so many samples."""
        return np.asarray(1.0 / self._windows(np.empty(samples))[2])

    @property
    def _past(self) -> int:
        return self.window // 2 if self.kind == "centred" else self.window - 1

    def _windows(self, x: Array) -> tuple[NDArray[np.intp], NDArray[np.intp], Array]:
        """Returns the first sample of each window, the one after its last, and its number of samples."""
        i = np.arange(x.shape[0])
        first = np.maximum(i - self._past, 0)
        after = np.minimum(i - self._past + self.window, x.shape[0])
        return first, after, (after - first).astype(float).reshape(-1, *[1] * (x.ndim - 1))
