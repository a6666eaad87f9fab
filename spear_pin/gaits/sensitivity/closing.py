"""Gaits for changed numbers, by Newton's method with exact derivatives from a nearby gait."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.sensitivity.orbit import Orbit, branch, equations
from spear_pin.hybrid.newton import root
from spear_pin.hybrid.tangent.resets import REFUSALS

CLOSED = 1e-10  # of coordinates and of what is kept
MOST = 8  # cycles


def close_cycle(orbit: Orbit, keep: Mapping[str, float], on_cycle: Callable[[], object] = lambda: None) -> Orbit:
    """Finds the gait near an orbit that is nearly one, with its derivatives.

    Args:
        orbit: the first of its names are solved for.
        keep: as many measures, and the values that they keep.
        on_cycle: called before each cycle.

    Raises:
        NoGait: Newton's method does not converge to a gait within a few cycles.
    """
    off = np.inf

    def landing(orbit: Orbit) -> Orbit:
        """Returns the orbit with those toes sliding as it begins that slide as it ends."""
        on_cycle()
        if (orbit.slides == orbit.slide_after).all():
            return orbit
        on_cycle()
        return orbit.beside({}, orbit.cycle.y - np.concatenate(orbit.state), orbit.names, orbit.slide_after)

    def about(orbit: Orbit) -> tuple[Array, Array]:
        nonlocal off
        residual = np.array([*orbit.displacement, *(orbit.measures[name].value - keep[name] for name in keep)])
        slopes, off = equations(orbit, keep)[:, : len(residual)], float(np.abs(residual).max())
        return residual, slopes

    def ahead(orbit: Orbit, step: Array) -> Orbit:
        return landing(orbit.along(step, orbit.names))

    size = 2 * orbit.system.robot.nv + len(keep)
    try:
        found, off = root(about, ahead, landing(orbit), CLOSED, size=size, calls=MOST)
    except REFUSALS as error:
        raise NoGait(str(error), off) from error
    if not off <= CLOSED or (found.slides != found.slide_after).any():
        raise NoGait("Newton's method makes no progress", off, remedy="values to keep nearer to the gait's own")
    return found


def find_changed(
    orbit: Orbit,
    keep: Mapping[str, float],
    change: Mapping[str, float],
    on_cycle: Callable[[], object] = lambda: None,
) -> Orbit:
    """Finds the gait for changed numbers: Newton's method from the state that derivatives predict.

    Args:
        orbit: the gait's orbit; the first of its names are solved for.
        keep: as many measures, and the values that they keep.
        change: changes of the other parameters, by name.
        on_cycle: called before each cycle.

    Raises:
        NoGait: Newton's method does not converge to a gait, or a number is not valid.
    """
    by = np.array([change[name] for name in orbit.names[len(keep) :]])
    try:
        begun = orbit.along(branch(orbit, list(keep)) @ by, orbit.names)
    except SpearError as error:
        raise NoGait(str(error), np.inf) from None
    return close_cycle(begun, keep, on_cycle)
