"""A smooth bound on the multipliers: one function for each of the three ways out of a circle."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import SpearError
from spear_pin.gaits.sensitivity.multipliers import step_of
from spear_pin.gaits.sensitivity.orbit import Orbit, branch
from spear_pin.hybrid.periodic import eigenvalues, measure_exits

STEP = 1e-6  # relative to a parameter; one-sided steps are shorter than central ones


def borders(jacobian: Array, radius: float) -> Array:
    """Returns `measure_exits` of the circle |λ| = radius: positive inside it, zero where a multiplier leaves it, (3,).

    They are polynomials in the entries of the return map's Jacobian, and so as smooth as the Jacobian. The modulus of
    the largest multiplier has a kink where two real multipliers meet.
    """
    return measure_exits(eigenvalues(jacobian) / radius)


def slopes(orbit: Orbit, keep: Sequence[str], radius: float, on_cycle: Callable[[], object] = lambda: None) -> Array:
    """Returns derivatives of `borders` by the other parameters along the branch, by differences of exact multipliers.

    The differences are one-sided and take a cycle each: five digits are enough for a search.

    Args:
        orbit: the gait; the first of its names are solved for.
        keep: names of as many measures that they keep.
        radius: radius of the circle.
        on_cycle: called before each cycle.

    Returns:
        (3, m), zero where there are none, for the order of events is another so near.
    """
    over, chain = orbit.names[len(keep) :], branch(orbit, keep)
    here, found = borders(orbit.jacobian, radius), np.zeros((3, len(over)))
    for j, name in enumerate(over):
        h = step_of(orbit, name, STEP)
        for step in (h, -h):
            try:
                there = orbit.along(step * chain[:, j])
                on_cycle()
                if there.cycle.order == orbit.cycle.order:
                    found[:, j] = (borders(there.jacobian, radius) - here) / step
                    break
            except SpearError:
                continue
    return found
