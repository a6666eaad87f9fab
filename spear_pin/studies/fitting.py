"""Least squares of measurements: the search, what they do not tell apart, and what to keep in mind of the values."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations, count
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue

SINGULAR = 1e-5  # of the largest singular value, with columns of length one: what measurements do not tell at all
SAME = 1e-12  # of the largest singular value: what is a combination of others but for rounding
ALIKE = 0.98  # correlation of two values that are hardly told apart


def search(
    linearized: Callable[[Array], tuple[Array, Array]],
    start: Array,
    bounds: tuple[Array, Array],
    tolerance: float,
    evaluations: int,
    tell: Callable[[int, float], None] | None = None,
    **options: Any,
) -> Any:
    """Returns SciPy's solution of least squares, from some values on.

    Args:
        linearized: returns residuals, (N,), and their Jacobian, (N, m); SciPy asks for them in turn.
        start: the values, (m,).
        bounds: least and largest values, (m,) each.
        tolerance: of cost, values and gradient.
        evaluations: how many there may be.
        tell: called with the number of evaluations and the residuals' root mean square.
        options: further ones of `scipy.optimize.least_squares`.
    """
    from scipy.optimize import least_squares  # takes long to import

    last, calls = dict[bytes, tuple[Array, Array]](), count(1)

    def at(x: Array) -> tuple[Array, Array]:
        key = x.tobytes()
        if key not in last:
            last.clear()
            last[key] = linearized(x)
            if tell is not None:
                tell(next(calls), float(np.sqrt(np.mean(last[key][0] ** 2))))
        return last[key]

    tolerances = {"ftol": tolerance, "xtol": tolerance, "gtol": tolerance}
    options |= {"x_scale": "jac", "max_nfev": evaluations, **tolerances}
    return least_squares(lambda x: at(x)[0], start, lambda x: at(x)[1], bounds, **options)


def tell_apart(argument: str, names: Sequence[str], jacobian: Array) -> tuple[Array, Array]:
    """Returns what the other unknowns do not explain of the derivatives by some, with length one, and the lengths.

    Args:
        argument: the argument that names the values.
        names: their names, (k,).
        jacobian: derivatives of the residuals by them, then by other unknowns, (N, k + others).

    Raises:
        BadValue: some values cannot be told apart at all.
    """
    own, others = np.split(jacobian, [len(names)], axis=1)
    basis, sizes, _ = np.linalg.svd(others, full_matrices=False)
    basis = basis[:, sizes > SAME * max(sizes, default=0.0)]
    seen = own - basis @ (basis.T @ own)
    lengths = np.linalg.norm(seen, axis=0)
    mute = lengths <= SINGULAR * np.linalg.norm(own, axis=0)  # but for rounding
    scaled = seen / np.where(mute, 1.0, lengths)
    _, sizes, rows = np.linalg.svd(scaled, full_matrices=False)
    if mute.any() or len(sizes) < len(names) or sizes[-1] < SINGULAR * sizes[0]:
        shares = mute if mute.any() else np.abs(rows[-1]) > 0.2
        told = " and ".join(name for name, share in zip(names, shares, strict=True) if share)
        said = f"say nothing of {told}" if mute.any() else f"do not tell {told} apart"
        expected = f"fewer of them: the data {said}; hold one that was measured otherwise, such as a mass by weight"
        raise BadValue(argument, list(names), expected)
    return scaled, lengths


def doubt(solution: Any, values: Mapping[str, float], correlation: Array) -> Iterator[str]:
    """Lists sentences that warn of a solution, if any.

    Args:
        solution: solution of SciPy.
        values: the values by name, in the order of its unknowns.
        correlation: correlations of the first of them, (k, k).
    """
    names = [*values]
    if not solution.success:
        yield f"the search did not converge in {solution.nfev} evaluations"
    for (name, value), side in zip(values.items(), solution.active_mask, strict=False):
        if side:
            yield f"{name} is at its bound, {value:g}: its deviation means nothing"
    for i, j in combinations(range(len(correlation)), 2):
        if abs(alike := float(correlation[i, j])) > ALIKE:
            larger = (1.0 - min(alike**2, 1.0 - 1e-12)) ** -0.5
            pair = f"{names[i]} and {names[j]} are hardly told apart (correlation {alike:.4f})"
            yield f"{pair}: with one held, the other's deviation would be {larger:.0f} times less"
