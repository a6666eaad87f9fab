"""Measured springs with two branches, one as they are stretched and one as they are let go."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, RobotWarning

EVEN = 0.1  # of the mean half width of a loop: by how much it may differ without a warning

Table = tuple[tuple[float, float], ...]


def joined(loading: Any, unloading: Any) -> tuple[Table, float]:
    """Returns the mean of two branches, at the stretches at which the first is given, and half the width of their loop.

    Between its points the second branch is straight. The half width is the mean along the path, so that the loop takes
    the same energy. Points at which the branches meet, such as the one of greatest stretch, are none of the mean.

    Args:
        loading: points (δ, τ) with the pull τ while the stretch δ rises, in rad and N·m, or m and N, from (0, 0) on.
        unloading: the same while it falls.

    Raises:
        BadValue: a branch does not begin with (0, 0), or its stretches do not rise; they share no stretches, or meet at
            all of them; or the spring would pull more while it is let go.

    Warns:
        RobotWarning: one branch goes further than the other, or the width of the loop differs along the way.
    """
    (stretch, up), (other, down) = _points("loading", loading), _points("unloading", unloading)
    shared = stretch <= other[-1]
    if not shared[1:].any():
        reach = f"a branch that goes to {stretch[1]:g} at least, the first stretch of loading"
        raise BadValue("unloading", unloading, reach)
    if stretch[-1] != other[-1]:
        ends = f"loading goes to a stretch of {stretch[-1]:g}, unloading to {other[-1]:g}"
        warnings.warn(
            RobotWarning(f"{ends}: points beyond {stretch[shared][-1]:g} make no part of the table"), stacklevel=3
        )
    stretch, up = stretch[shared], up[shared]
    half = 0.5 * (up - np.interp(stretch, other, down))
    apart = half != 0.0
    if not apart.any():
        raise BadValue("unloading", unloading, "a branch that is apart from that of loading somewhere")
    stretch, up, half = stretch[apart], up[apart], half[apart]
    width = float(np.trapezoid(half, stretch) / np.ptp(stretch) if len(half) > 1 else half[0])
    if width <= 0.0:
        raise BadValue("loading", loading, "pulls above those of unloading; are the two exchanged?")
    off = float(abs(half - width).max())
    if off > EVEN * width:
        span = f"{half.min():.4g} to {half.max():.4g}"
        what = f"half the width of the measured loop is {span}, and not everywhere the spring's hysteresis, {width:.4g}"
        warnings.warn(RobotWarning(f"{what}: off by up to {100.0 * off / width:.0f} %"), stacklevel=3)
    mean = zip(stretch.tolist(), (up - half).tolist(), strict=True)
    return ((0.0, 0.0), *mean), width


def _points(name: str, branch: Any) -> tuple[Array, Array]:
    try:
        points = np.array([(float(stretch), float(pull)) for stretch, pull in branch])
    except (TypeError, ValueError):
        points = np.empty((0, 2))
    if len(points) < 2 or points[0].any() or not (np.diff(points[:, 0]) > 0.0).all() or not np.isfinite(points).all():
        raise BadValue(name, branch, "points (δ, τ) with rising δ, the first of them (0, 0)")
    return points[:, 0], points[:, 1]
