"""Measured springs with two branches, one as they are stretched and one as they are let go."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, RobotWarning

EVEN = 0.1  # of the hysteresis: by how much the half width of a loop may be above and below without a warning

Table = tuple[tuple[float, float], ...]


def join_branches(loading: Any, unloading: Any) -> tuple[Table, float]:
    """Returns the mean of two branches at the stretches of loading, and half the width of a loop of the same energy.

    Between their points branches are straight. The loop of a spring with hysteresis h over the stretch δ takes 2 h δ.

    Args:
        loading: points (δ, τ) with the pull τ while the stretch δ rises, in rad and N·m, or m and N, from (0, 0) on.
        unloading: the same while it falls.

    Raises:
        BadValue: a branch does not begin with (0, 0), or its stretches do not rise; they are the same; or the spring
            would pull more while it is let go.

    Warns:
        RobotWarning: one branch goes further than the other, or the width of the loop differs along the way.
    """
    (stretch, up), (other, down) = _points("loading", loading), _points("unloading", unloading)
    end = min(stretch[-1], other[-1])
    if stretch[-1] != other[-1]:
        ends = f"loading goes to a stretch of {stretch[-1]:g}, unloading to {other[-1]:g}"
        warnings.warn(RobotWarning(f"{ends}: what is beyond {end:g} makes no part of the table"), stacklevel=3)
    every = np.union1d(stretch, other)
    every = every[every <= end]
    half = 0.5 * (np.interp(every, stretch, up) - np.interp(every, other, down))
    width = float(np.trapezoid(half, every) / end)
    if not half.any():
        raise BadValue("unloading", unloading, "a branch that is apart from that of loading somewhere")
    if width <= 0.0:
        raise BadValue("loading", loading, "pulls above those of unloading; are the two exchanged?")
    inside = half[1:-1] if len(half) > 2 else half[1:]  # a loop closes at its ends
    least, most = float(inside.min()), float(inside.max())
    if most - least > 2.0 * EVEN * width:
        what = f"half the width of the measured loop is {least:.4g} to {most:.4g}, inside its ends"
        warnings.warn(RobotWarning(f"{what}; the spring's hysteresis is {width:.4g} everywhere"), stacklevel=3)
    kept = np.union1d(stretch[stretch <= end], end)
    mean = 0.5 * (np.interp(kept, stretch, up) + np.interp(kept, other, down))
    return tuple(zip(kept.tolist(), mean.tolist(), strict=True)), width


def _points(name: str, branch: Any) -> tuple[Array, Array]:
    try:
        points = np.array([(float(stretch), float(pull)) for stretch, pull in branch])
    except (TypeError, ValueError):
        points = np.empty((0, 2))
    if len(points) < 2 or points[0].any() or not (np.diff(points[:, 0]) > 0.0).all() or not np.isfinite(points).all():
        raise BadValue(name, branch, "points (δ, τ) with rising δ, the first of them (0, 0)")
    return points[:, 0], points[:, 1]
