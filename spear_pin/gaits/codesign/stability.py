"""A bound on the multipliers without a kink where real ones meet: the three ways out of a circle, each smooth."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import SpearError
from spear_pin.gaits.sensitivity.multipliers import step_of
from spear_pin.gaits.sensitivity.orbit import Orbit, solved
from spear_pin.hybrid.tangent.resets import NotDifferentiable

STEP = 1e-6  # of a parameter, of one side: shorter than of two


def borders(jacobian: Array, radius: float) -> Array:
    """Functions that are positive inside the circle |λ| = radius and zero where a multiplier leaves it, (3,).

    At +radius (of radius one: a fold), Π (1 - λ/r); at -radius (a flip), Π (1 + λ/r); as a complex pair
    (Neimark-Sacker), Π over pairs of (1 - λ_i λ_j / r²). They are polynomials in the entries of the return map's
    Jacobian, and so as smooth as it is; the modulus of the largest has a kink where two real multipliers meet.
    """
    values = np.linalg.eigvals(jacobian) / radius
    i, j = np.triu_indices(len(values), 1)
    parts = 1.0 - values, 1.0 + values, 1.0 - values[i] * values[j]
    return np.array([np.prod(part).real for part in parts])


def slopes(
    orbit: Orbit, vary: Sequence[str], keep: Sequence[str], radius: float, on_cycle: Callable[[], object] = lambda: None
) -> Array:
    """Derivatives of `borders` by the other parameters along the branch, by differences of exact multipliers.

    Those are of one side, a cycle each: a search is led by five digits as well as by ten.

    Args:
        orbit: the gait; its names are those of `vary`, then those that change.
        vary: parameters that are solved for.
        keep: measures that they keep.
        radius: of the circle.
        on_cycle: called before each cycle.

    Returns:
        (3, m), zero where there are none, for the order of events is another so near.
    """
    over = orbit.names[len(vary) :]
    dxi, dz = solved(orbit, vary, keep)
    here, found = borders(orbit.jacobian, radius), np.zeros((3, len(over)))
    for j, name in enumerate(over):
        along = np.concatenate([dxi[:, j], dz[:, j], np.eye(len(over))[j]])
        change = {name: 1.0, **dict(zip(vary, dz[:, j].tolist(), strict=True))}
        h = step_of(orbit, name, STEP)
        for step in (h, -h):
            try:
                there = orbit.beside(
                    {each: step * slope for each, slope in change.items()}, orbit.start @ (step * along)
                )
                on_cycle()
                if there.cycle.order == orbit.cycle.order:
                    found[:, j] = (borders(there.jacobian, radius) - here) / step
                    break
            except (NotDifferentiable, SpearError):
                continue
    return found
