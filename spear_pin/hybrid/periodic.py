"""Periodic orbits: the return map on the section, Newton's method, Floquet multipliers."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import NoGait
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.record import Options, Run, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.section import chart as chart
from spear_pin.hybrid.translation import translations, without

Array = NDArray[np.float64]
PATIENCE = 7  # iterations in which the residual has to be halved
STEP = 1e-5  # of differences: errors of order STEP, of order STEP² where they are central, and rtol / STEP
EVALUATIONS = 60_000  # right-hand sides of one cycle; a gait's takes some thousands, even near an rtol of 1e-13


def return_map(system: HybridSystem, state: State, rtol: float = 1e-10) -> Run:
    """One cycle from a state on the section, P of (4.11); a result with a reason if it does not return."""
    return run(system, state, 1, Options(rtol=rtol, max_evaluations=EVALUATIONS))


def displacement(system: HybridSystem, before: State, after: State) -> Array:
    """P(x) - x over (q, v), without translation along the ground."""
    return np.concatenate([without(translations(system), after[0] - before[0]), after[1] - before[1]])


def residual(system: HybridSystem, state: State, rtol: float = 1e-10) -> float:
    """‖P(x) - x‖∞ of (4.12), in m, rad, m/s, rad/s; infinite if the cycle does not close."""
    result = return_map(system, state, rtol)
    return float(np.abs(displacement(system, state, result.state)).max()) if result.cycles else np.inf


def differentiate(
    function: Callable[[Array], Array | None], x: Array, step: Array, value: Array | None = None
) -> Array | None:
    """Jacobian by differences: forward from a `value` that is known at x, else central; None where there is none."""
    columns = []
    for i, h in enumerate(step):
        offset = np.zeros_like(x)
        offset[i] = h
        ahead, behind = function(x + offset), function(x - offset) if value is None else value
        if ahead is None or behind is None:
            return None
        columns.append((ahead - behind) / (2.0 * h) if value is None else (ahead - behind) / h)
    return np.array(columns).T


def newton(
    function: Callable[[Array], Array | None],
    x: Array,
    step: Array,
    tolerance: float,
    iterations: int = 15,
    on_iteration: Callable[[int, float], object] = lambda n, norm: None,
) -> tuple[Array, float]:
    """Damped Newton's method with forward differences, for a function that may have no value somewhere.

    Args:
        function: the residual, or None where it is undefined.
        x: start.
        step: difference step for each unknown.
        tolerance: on the residual's largest component.
        iterations: at most so many.
        on_iteration: called with the iteration and the residual.

    Returns:
        the root and its residual.

    Raises:
        NoGait: it does not converge; the text says why.
    """
    value = function(x)
    if value is None:
        raise NoGait("the cycle does not close at the starting point", np.inf)
    norm = float(np.abs(value).max())
    norms: list[float] = []
    for n in range(iterations + 1):
        on_iteration(n, norm)
        norms.append(norm)
        if norm <= tolerance:
            return x, norm
        if n == iterations or (n >= PATIENCE and norm > 0.5 * norms[n - PATIENCE]):
            break
        jacobian = differentiate(function, x, step, value)
        if jacobian is None:
            raise NoGait("the cycle does not close near an iterate", norm)
        direction = np.linalg.lstsq(jacobian, -value, rcond=None)[0]
        for damping in 0.5 ** np.arange(6):
            trial = function(x + damping * direction)
            if trial is not None and float(np.abs(trial).max()) < (1.0 - 0.1 * damping) * norm:
                x, value, norm = x + damping * direction, trial, float(np.abs(trial).max())
                break
        else:
            if norm <= 10.0 * tolerance:
                return x, norm  # as close as the integration's noise allows
            raise NoGait("Newton's method makes no progress", norm)
    raise NoGait(f"Newton's method did not converge in {n} iterations", norm)


def multipliers(system: HybridSystem, state: State, rtol: float = 1e-10, step: float = STEP) -> NDArray[np.complex128]:
    """Floquet multipliers of a periodic orbit, by decreasing modulus.

    Eigenvalues of the return map's Jacobian in the section's chart, by central differences.

    Raises:
        NoGait: a perturbed cycle does not close.
    """
    local = chart(system, state)

    def mapped(xi: Array) -> Array | None:
        result = return_map(system, local.state(xi), rtol)
        return local.coordinates(result.state) if result.cycles else None

    jacobian = differentiate(mapped, np.zeros(local.dimension), np.full(local.dimension, step))
    if jacobian is None:
        raise NoGait("a perturbed cycle does not close", residual(system, state, rtol))
    return eigenvalues(jacobian)


def eigenvalues(matrix: Array) -> NDArray[np.complex128]:
    """Eigenvalues by decreasing modulus; of a pair, the one above the real axis first, however rounding falls."""
    values = np.linalg.eigvals(matrix).astype(np.complex128)
    return np.array(sorted(values.tolist(), key=lambda value: (-round(abs(value), 9), -value.imag)))
