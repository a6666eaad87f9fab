"""Search for the parameters of the passive knee from recorded releases, by nonlinear least squares, with error bars.

The model of a trial is the angle θ₀ until the leg is let go at t₀, and the pinned leg's motion after that, smoothed in
the same way as the data. Each trial has its own θ₀ and t₀; trials share the knee's parameters, or each has its own.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.kinds import typed
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.fitting import search, tell_apart
from spear_pin.studies.identification.doubts import doubts
from spear_pin.studies.identification.estimate import Estimate, Parameter
from spear_pin.studies.identification.first_guess import first_swing
from spear_pin.studies.identification.least_squares import LeastSquares, pose
from spear_pin.studies.identification.quantities import NUISANCES
from spear_pin.studies.identification.rounding import errors, estimate_rounding
from spear_pin.studies.identification.trials import Trial
from spear_pin.studies.identification.uncertainty import nrmse_fit, scatter, whiteness

VARY = ("stiffness", "damping", "rest_angle")  # what the source estimates
TOLERANCE = 1e-8
SMALLEST = 1e-6  # rad: residuals below are those of the integration
# ψ / r and ψ' of the losses of SciPy, of z = (r / scale)²
LOSSES: Mapping[str, tuple[Callable[[Array], Array], Callable[[Array], Array]]] = {
    "linear": (np.ones_like, np.ones_like),
    "soft_l1": (lambda z: (1 + z) ** -0.5, lambda z: (1 + z) ** -1.5),
    "huber": (lambda z: np.where(z <= 1, 1.0, 1.0 / np.sqrt(np.maximum(z, 1.0))), lambda z: (z <= 1).astype(float)),
    "cauchy": (lambda z: 1 / (1 + z), lambda z: (1 - z) / (1 + z) ** 2),
}


@typed
def identify(
    leg: PinnedLeg,
    trials: Sequence[Trial],
    vary: Sequence[str] = VARY,
    *,
    per_trial: Collection[str] = (),
    nuisances: Collection[str] = NUISANCES,
    static_rest: bool = False,
    known: Mapping[str, float] | None = None,
    unilateral: bool = False,
    bounds: Mapping[str, tuple[float, float]] | None = None,
    loss: str = "linear",
    smooth_model: bool = True,
    on_iteration: Callable[[int, float], None] | None = None,
) -> Estimate:
    """Estimates parameters of the passive knee from releases.

    Args:
        leg: the pinned leg; with its rotor, or without if the belt was off.
        trials: releases, found by `cut`, smoothed or not.
        vary: parameters to estimate, any of stiffness, damping, coulomb, rest_angle, rotor_inertia.
        per_trial: those of `vary` of which every trial has its own; the others are shared.
        nuisances: further quantities to estimate for every trial: initial_angle, release_time. If left out, they are
            taken as known: the median of the hold (or first sample), `Trial.let_go`.
        static_rest: whether the rest angle is where the leg rests, instead of the zero of the spring.
        known: by name, values of what is not varied, or where the search begins (default: no dry friction, the leg's
            rotor, the rest guessed from the data).
        unilateral: whether the spring only pulls.
        bounds: least and largest values by name, narrower than those of `QUANTITIES`.
        loss: loss of `scipy.optimize.least_squares`; another than "linear" is scaled by the spread of the residuals of
            a linear fit made first.
        smooth_model: whether the model is smoothed in the same way as the data; without it the estimates are biased, as
            those of the source may be.
        on_iteration: called with the number of evaluations and the residuals' root mean square, in rad.

    Raises:
        BadValue: there is nothing to estimate from or nothing to estimate, a trial is beyond the joint's limits, bounds
            are not valid, or the data do not tell two parameters apart at all.
        UnknownName: an unknown parameter or loss.
    """
    if loss not in LOSSES:
        raise UnknownName("loss", loss, LOSSES)
    problem = pose(
        leg, trials, vary, per_trial, nuisances, static_rest, known or {}, unilateral, bounds or {}, smooth_model
    )
    spread = 1.0
    start = _started(problem, "coulomb" not in (known or {}), on_iteration)
    solution = _solved(problem, start, "linear", spread, on_iteration)
    if loss != "linear":
        spread = max(1.5 * 1.4826 * float(np.median(np.abs(solution.fun))), 1e-9)
        solution = _solved(problem, solution.x, loss, spread, on_iteration)
    return _estimate(problem, solution, loss, spread)


def _started(problem: LeastSquares, guessed: bool, on_iteration: Callable[[int, float], None] | None) -> Array:
    """Returns the unknowns at which the search begins.

    Dry friction may stop the knee at one turn or at the next, which makes many minima. It does not stop the first
    swing, forth and back, so that swing is fitted before.
    """
    start = np.array([entry.start for entry in problem.entries])
    names = [entry.name for entry in problem.entries]
    if not (guessed and "coulomb" in names):
        return start
    halves = np.array([0.5 if name in ("coulomb", "damping") else 1.0 for name in names])
    low, high = np.array([entry.bounds for entry in problem.entries]).T
    swing = replace(problem, trials=tuple(map(first_swing, problem.trials)))
    return np.asarray(_solved(swing, np.clip(start * halves, low, high), "linear", 1.0, on_iteration).x)


def _solved(
    problem: LeastSquares, start: Array, loss: str, spread: float, on_iteration: Callable[[int, float], None] | None
) -> Any:
    low, high = np.array([entry.bounds for entry in problem.entries]).T
    return search(problem.linearized, start, (low, high), TOLERANCE, 100, on_iteration, loss=loss, f_scale=spread)


def _estimate(problem: LeastSquares, solution: Any, loss: str, spread: float) -> Estimate:
    x, trials = np.asarray(solution.x), problem.trials
    integrations = problem.tally["integrations"]
    ends = np.cumsum([trial.t.size for trial in trials])[:-1]
    settings = [problem.setting(x, j) for j in range(len(trials))]
    angles = [problem.angle(x, j) for j in range(len(trials))]
    predicted = [problem.smoothed(angle, j) for j, angle in enumerate(angles)]
    unsmoothed = [angle - raw for angle, t in zip(angles, trials, strict=True) if (raw := t.unsmoothed) is not None]
    known = len(unsmoothed) == len(trials)
    roundings = [estimate_rounding(trial.unsmoothed, angle) for trial, angle in zip(trials, angles, strict=True)]
    moving = [setting.since(trial) > 0.0 for trial, setting in zip(trials, settings, strict=True)]
    residuals, jacobian = problem.linearized(x)
    labels = [Parameter(entry.name, entry.trial, 0.0, 0.0).label for entry in problem.entries]
    tell_apart("vary", labels, jacobian)
    found = scatter(
        np.split(residuals, ends),
        np.split(jacobian, ends),
        [trial.smoothing for trial in trials],
        influence=_influence(residuals, loss, spread),
        unsmoothed=unsmoothed if known else None,
        used=[trial.used for trial in trials],
        correlated=errors(angles, moving, roundings),
    )
    deviations = np.sqrt(np.diag(found.covariance))
    estimate = Estimate(
        parameters=tuple(
            Parameter(entry.name, entry.trial, entry.origin + float(value), float(deviation), float(inflation))
            for entry, value, deviation, inflation in zip(problem.entries, x, deviations, found.inflation, strict=True)
        ),
        covariance=found.covariance,
        condition=found.condition,
        knees=tuple(setting.knee for setting in settings),
        rotors=tuple(setting.leg.rotor for setting in settings),
        trials=trials,
        predicted=tuple(predicted),
        fits=tuple(nrmse_fit(t.angle[t.used], y[t.used]) for t, y in zip(trials, predicted, strict=True)),
        noise=found.noise,
        roundings=tuple(roundings),
        whiteness=whiteness(unsmoothed) if known and found.noise > SMALLEST else None,
        warnings=(),
        converged=bool(solution.status > 0),
        integrations=integrations,
    )
    return replace(estimate, warnings=tuple(doubts(problem, solution, estimate)))


def _influence(residuals: Array, loss: str, spread: float) -> tuple[Array, Array] | None:
    """Returns ψ and ψ' of a robust loss."""
    if loss == "linear":
        return None
    weight, slope = LOSSES[loss]
    z = (residuals / spread) ** 2
    return weight(z) * residuals, slope(z)
