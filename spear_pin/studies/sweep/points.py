"""Points of a sweep: a grid, or a sample that fills a box evenly."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import scipy
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.kinds import typed


@typed
def grid(axes: Mapping[str, ArrayLike]) -> dict[str, Array]:
    """Returns every combination of values; the last name runs fastest.

    Args:
        axes: values by the names of parameters.
    """
    values = {name: np.atleast_1d(np.asarray(axis, dtype=float)) for name, axis in axes.items()}
    mesh = np.meshgrid(*values.values(), indexing="ij")
    return {name: each.ravel() for name, each in zip(values, mesh, strict=True)}


@typed
def sample(ranges: Mapping[str, tuple[float, float]], n: int, method: str = "sobol", seed: int = 0) -> dict[str, Array]:
    """Returns points that fill a box evenly.

    Args:
        ranges: least and largest values by the names of parameters.
        n: number of points; for a Sobol sequence best a power of two.
        method: "sobol" or "latin", a Latin hypercube.
        seed: seed of the scrambling.

    Raises:
        UnknownName: there is no such method.
        BadValue: a range is empty, n is not positive, or the seed is negative.
    """
    methods: dict[str, Callable[..., Any]] = {"sobol": scipy.stats.qmc.Sobol, "latin": scipy.stats.qmc.LatinHypercube}
    if method not in methods:
        raise UnknownName("method", method, methods)
    if n < 1:
        raise BadValue("n", n, "at least 1")
    require("seed", seed, lambda number: number >= 0 and number % 1 == 0, "a whole number >= 0")
    for name, bounds in ranges.items():
        if len(bounds) != 2 or not bounds[0] < bounds[1] or not np.isfinite(bounds).all():
            raise BadValue(name, bounds, "two finite numbers, the first the smaller")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that n is no power of two
        unit = methods[method](len(ranges), rng=seed).random(n)
    return {name: low + (high - low) * unit[:, i] for i, (name, (low, high)) in enumerate(ranges.items())}
