"""Gaits for changed numbers, by Newton's method with exact derivatives from a nearby gait."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.sensitivity.orbit import Orbit, solved
from spear_pin.hybrid.tangent.resets import REFUSALS

CLOSED = 1e-10  # of coordinates and of what is kept
MOST = 8  # cycles
SLOWEST = 0.5  # factor by which the residual has to fall


def closed(
    orbit: Orbit, vary: Sequence[str], keep: Mapping[str, float], on_cycle: Callable[[], object] = lambda: None
) -> Orbit:
    """Finds the gait near an orbit that is nearly one, with its derivatives.

    Args:
        orbit: its names begin with those of `vary`.
        vary: names of parameters that are solved for.
        keep: as many measures, and the values that they keep.
        on_cycle: called before each cycle.

    Raises:
        NoGait: Newton's method does not converge to a gait within a few cycles.
    """
    before = np.inf
    for _ in range(MOST):
        on_cycle()
        try:
            if (orbit.slides != orbit.slide_after).any():  # toes land otherwise
                after = orbit.cycle.y - np.concatenate(orbit.state)
                orbit = orbit.beside({}, after, orbit.names, orbit.slide_after)
                continue
            residual = np.concatenate([orbit.displacement, [orbit.measures[name].value - keep[name] for name in keep]])
            size = float(np.abs(residual).max())
            if size <= CLOSED:
                return orbit
            if not size < SLOWEST * before:
                break
            d, k = orbit.dimension, len(vary)
            rows = orbit.columns[:, : d + k] - np.eye(d, d + k)
            kept = [orbit.measures[name].derivative[: d + k] for name in keep]
            step = np.linalg.solve(np.vstack([rows, *kept]), -residual)
            change = dict(zip(vary, step[d:].tolist(), strict=True))
            orbit = orbit.beside(change, orbit.start[:, : d + k] @ step, orbit.names)
        except REFUSALS as error:
            raise NoGait(str(error), before) from error
        before = size
    raise NoGait("Newton's method makes no progress", before, remedy="values to keep nearer to the gait's own")


def led(
    orbit: Orbit,
    vary: Sequence[str],
    keep: Mapping[str, float],
    change: Mapping[str, float],
    on_cycle: Callable[[], object] = lambda: None,
) -> Orbit:
    """Finds the gait for changed numbers: Newton's method from the state that derivatives predict.

    Args:
        orbit: the gait's orbit; its names are those of `vary`, then those that may change.
        vary: names of parameters that are solved for.
        keep: as many measures, and the values that they keep.
        change: changes of parameters, by name.
        on_cycle: called before each cycle.

    Raises:
        NoGait: Newton's method does not converge to a gait, or a number is not valid.
    """
    dxi, dz = solved(orbit, vary, list(keep))
    by = np.array([change[name] for name in orbit.names[len(vary) :]])
    step = np.concatenate([dxi @ by, dz @ by, by])
    numbers = dict(zip(orbit.names, step[orbit.dimension :].tolist(), strict=True))
    try:
        begun = orbit.beside(numbers, orbit.start @ step, orbit.names)
    except SpearError as error:
        raise NoGait(str(error), np.inf) from None
    return closed(begun, vary, keep, on_cycle)
