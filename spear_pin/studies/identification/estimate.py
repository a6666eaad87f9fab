"""Parameters of the passive knee from recorded releases, by nonlinear least squares, with error bars.

The model of a trial is the angle θ₀ until the leg is let go at t₀, and the pinned leg's motion from there on,
smoothed as the data were. Each trial has its own θ₀ and t₀; the knee's parameters are shared, or each trial's.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from typing import Any

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.errors import UnknownName
from spear_pin.kinds import typed
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.identification.first_guess import first_swing
from spear_pin.studies.identification.least_squares import LeastSquares, pose
from spear_pin.studies.identification.quantities import KNEE, NUISANCES, QUANTITIES
from spear_pin.studies.identification.rounding import Rounding, errors, rounding
from spear_pin.studies.identification.trials import Trial
from spear_pin.studies.identification.uncertainty import nrmse_fit, scatter, whiteness
from spear_pin.studies.push_test import PassiveKnee
from spear_pin.studies.push_test.motion import move

Array = NDArray[np.float64]

VARY = ("stiffness", "damping", "rest_angle")  # what the source estimates
ALIKE = 0.98  # correlation of two estimates that cannot be told apart
BY_CHANCE = 0.01  # probability below which residuals are not white
UNEXPLAINED = 2.0  # times the power of noise and rounding: residuals that have more miss something
POOR = 70.0  # percent: a model that fits worse does not describe the data
TOLERANCE = 1e-8
SMALLEST = 1e-6  # rad: residuals below are those of the integration
# ψ / r and ψ' of the losses of SciPy, of z = (r / scale)²
LOSSES: Mapping[str, tuple[Callable[[Array], Array], Callable[[Array], Array]]] = {
    "linear": (np.ones_like, np.ones_like),
    "soft_l1": (lambda z: (1 + z) ** -0.5, lambda z: (1 + z) ** -1.5),
    "huber": (lambda z: np.where(z <= 1, 1.0, 1.0 / np.sqrt(np.maximum(z, 1.0))), lambda z: (z <= 1).astype(float)),
    "cauchy": (lambda z: 1 / (1 + z), lambda z: (1 - z) / (1 + z) ** 2),
}


@dataclass(frozen=True)
class Parameter:
    """An estimated parameter.

    Attributes:
        name: of `QUANTITIES`.
        trial: number of the trial that it belongs to; None if all share it.
        value: in the quantity's unit.
        deviation: its standard deviation; infinite where the data do not tell.
        inflation: of the deviation, by the correlation of errors of rounding.
    """

    name: str
    trial: int | None
    value: float
    deviation: float
    inflation: float = 1.0

    @property
    def unit(self) -> str:
        """Of the value."""
        return QUANTITIES[self.name].unit

    @property
    def label(self) -> str:
        """The name, with the number of the trial counted from 1."""
        return self.name if self.trial is None else f"{self.name} of release {self.trial + 1}"


@dataclass(frozen=True)
class Estimate:
    """Estimated parameters, and how far to trust them.

    Attributes:
        parameters: those of the knee first.
        covariance: of all of them, in their order.
        condition: of the residuals' Jacobian with columns of length one.
        knees: what acts on the knee, for each trial.
        rotors: reflected rotor inertia, for each trial, in kg·m².
        trials: as they were fitted.
        predicted: the model's angle for each trial, smoothed as the data were, in rad.
        fits: 100 (1 - ‖y - ŷ‖ / ‖y - ȳ‖) for each trial, MATLAB's NRMSE fit, in percent.
        noise: standard deviation of the angle's errors before smoothing, rounding among them, in rad; for a
            robust loss that which least squares would need for the same error bars.
        roundings: how each trial's angle was rounded, as far as its values before smoothing tell.
        whiteness: probability that white noise has residuals as correlated as these, before smoothing
            (Ljung and Box); None where the angle before smoothing is not known, or there is no noise.
        warnings: what a reader has to know.
        converged: whether the solver met its tolerances.
        integrations: of a release: a motion counts one, one with sensitivities as many as it has.
    """

    parameters: tuple[Parameter, ...]
    covariance: Array
    condition: float
    knees: tuple[PassiveKnee, ...]
    rotors: tuple[float, ...]
    trials: tuple[Trial, ...]
    predicted: tuple[Array, ...]
    fits: tuple[float, ...]
    noise: float
    roundings: tuple[Rounding, ...]
    whiteness: float | None
    warnings: tuple[str, ...]
    converged: bool
    integrations: int

    def __getitem__(self, name: str) -> Parameter:
        """The shared parameter of a name, or the only one.

        Raises:
            UnknownName: it was not estimated, or each trial has its own.
        """
        found = [p for p in self.parameters if p.name == name]
        if len(found) != 1:
            raise UnknownName("shared parameter", name, [p.name for p in self.parameters if p.trial is None])
        return found[0]

    @property
    def fit(self) -> float:
        """NRMSE fit over all trials together, each about its own mean, in percent."""
        missed = sum(float(((t.angle - y) ** 2).sum()) for t, y in zip(self.trials, self.predicted, strict=True))
        spread = sum(float(((t.angle - t.angle.mean()) ** 2).sum()) for t in self.trials)
        return 100.0 * (1.0 - float(np.sqrt(missed / spread)))

    @property
    def inflation(self) -> float:
        """The largest of the knee's parameters."""
        return max(p.inflation for p in self.parameters if p.name in KNEE)

    @property
    def correlation(self) -> Array:
        """Correlation matrix of the parameters, in their order."""
        deviation = np.sqrt(np.diag(self.covariance))
        with np.errstate(invalid="ignore"):  # infinite, or without any noise
            return np.asarray(self.covariance / np.outer(deviation, deviation))


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
    """Estimate parameters of the passive knee from releases.

    Args:
        leg: the pinned leg; with its rotor, or without if the belt was off.
        trials: releases, as `cut` finds them, smoothed or not.
        vary: stiffness, damping, coulomb, rest_angle, rotor_inertia: any of them.
        per_trial: those of `vary` of which every trial has its own; the others are shared.
        nuisances: what else is estimated, for every trial: initial_angle, release_time. What is left out is
            taken as known: the median of the hold (or first sample), `Trial.let_go`.
        static_rest: whether the rest angle is where the leg rests, instead of the zero of the spring.
        known: by name, what is not varied, or where the search begins (default: no dry friction, the leg's rotor,
            the rest guessed from the data).
        unilateral: whether the spring only pulls.
        bounds: least and largest values by name, narrower than those of `QUANTITIES`.
        loss: of `scipy.optimize.least_squares`; one other than "linear" is scaled by the spread of the residuals of
            a linear fit made first.
        smooth_model: whether the model is smoothed as the data were; without it the estimates are biased, as
            those of the source may be.
        on_iteration: called with the number of evaluations and the residuals' root mean square, in rad.

    Raises:
        BadValue: nothing to estimate from or nothing to estimate, a trial beyond the joint's limits, bad bounds.
        UnknownName: an unknown parameter or loss.
    """
    if loss not in LOSSES:
        raise UnknownName("loss", loss, LOSSES)
    problem = pose(
        leg,
        tuple(trials),
        tuple(vary),
        per_trial=tuple(per_trial),
        nuisances=tuple(nuisances),
        static_rest=static_rest,
        known=known or {},
        unilateral=unilateral,
        bounds=bounds or {},
        smooth_model=smooth_model,
    )
    spread = 1.0
    start = _started(problem, "coulomb" not in (known or {}), on_iteration)
    solution = _solved(problem, start, "linear", spread, on_iteration)
    if loss != "linear":
        spread = max(1.5 * 1.4826 * float(np.median(np.abs(solution.fun))), 1e-9)
        solution = _solved(problem, solution.x, loss, spread, on_iteration)
    return _estimate(problem, solution, loss, spread)


def _started(problem: LeastSquares, guessed: bool, on_iteration: Callable[[int, float], None] | None) -> Array:
    """Where to begin.

    Whether dry friction stops the knee at one turn or at the next makes many minima; the first swing, forth and
    back, is fitted before, which it does not stop.
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
    evaluations = 0
    at, slopes = np.empty(0), np.empty(0)  # one integration gives both, and SciPy asks for them in turn

    def residuals(x: Array) -> Array:
        nonlocal evaluations, at, slopes
        evaluations += 1
        values, slopes = problem.linearized(x)
        at = x.copy()
        if on_iteration is not None:
            on_iteration(evaluations, float(np.sqrt(np.mean(values**2))))
        return values

    def jacobian(x: Array) -> Array:
        return slopes if np.array_equal(x, at) else problem.linearized(x)[1]

    bounds = np.array([entry.bounds for entry in problem.entries]).T
    tolerances = {"ftol": TOLERANCE, "xtol": TOLERANCE, "gtol": TOLERANCE}
    return scipy.optimize.least_squares(
        residuals, start, jacobian, bounds, x_scale="jac", loss=loss, f_scale=spread, max_nfev=100, **tolerances
    )


def _estimate(problem: LeastSquares, solution: Any, loss: str, spread: float) -> Estimate:
    x, trials = np.asarray(solution.x), problem.trials
    integrations = problem.tally["integrations"]
    ends = np.cumsum([trial.t.size for trial in trials])[:-1]
    predicted = [problem.predicted(x, j) for j in range(len(trials))]
    residuals = [trial.used * (y - trial.angle) for y, trial in zip(predicted, trials, strict=True)]
    settings = [problem.setting(x, j) for j in range(len(trials))]
    angles = [problem.angle(x, j) for j in range(len(trials))]
    unsmoothed = [angle - raw for angle, t in zip(angles, trials, strict=True) if (raw := t.unsmoothed) is not None]
    known = len(unsmoothed) == len(trials)
    roundings = [rounding(trial.unsmoothed, angle) for trial, angle in zip(trials, angles, strict=True)]
    moving = [trial.t > setting.let_go for trial, setting in zip(trials, settings, strict=True)]
    found = scatter(
        residuals,
        np.split(problem.linearized(x)[1], ends),
        [trial.smoothing for trial in trials],
        influence=_influence(np.concatenate(residuals), loss, spread),
        unsmoothed=unsmoothed if known else None,
        used=[trial.used for trial in trials],
        correlated=errors(angles, moving, roundings),
    )
    deviations = np.sqrt(np.diag(found.covariance))
    estimate = Estimate(
        parameters=tuple(
            Parameter(entry.name, entry.trial, float(value), float(deviation), float(inflation))
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
    return replace(estimate, warnings=tuple(_warnings(problem, solution, estimate)))


def _influence(residuals: Array, loss: str, spread: float) -> tuple[Array, Array] | None:
    """ψ and ψ' of a robust loss."""
    if loss == "linear":
        return None
    weight, slope = LOSSES[loss]
    z = (residuals / spread) ** 2
    return weight(z) * residuals, slope(z)


def _warnings(problem: LeastSquares, solution: Any, estimate: Estimate) -> Iterator[str]:
    if not estimate.converged:
        yield f"the search did not converge in {solution.nfev} evaluations"
    for parameter, side in zip(estimate.parameters, solution.active_mask, strict=True):
        if side:
            value = round(parameter.value, 6)
            yield f"{parameter.label} is at its bound, {value:g}: its standard deviation means nothing"
    if not np.isfinite(estimate.condition):
        yield "the data do not tell these parameters apart at all: vary fewer"
    else:
        correlation = estimate.correlation
        knees = [(i, parameter) for i, parameter in enumerate(estimate.parameters) if parameter.name in KNEE]
        for (i, one), (j, other) in combinations(knees, 2):
            if abs(correlation[i, j]) > ALIKE:
                pair = f"{one.label} and {other.label} are hardly told apart (correlation {correlation[i, j]:.4f})"
                larger = (1.0 - correlation[i, j] ** 2) ** -0.5
                yield f"{pair}: with one of them held, the deviation of the other would be {larger:.0f} times less"
    for j, (trial, fit) in enumerate(zip(estimate.trials, estimate.fits, strict=True)):
        if not fit >= POOR:
            yield f"the model does not describe {trial.label}: fit {fit:.1f} %"
        setting = problem.setting(np.asarray(solution.x), j)
        since = trial.t[trial.t > setting.let_go] - setting.let_go
        motion = move(setting.leg, setting.knee, setting.initial_angle, since)
        if motion.reason != "complete":
            yield f"the model of {trial.label} ends early: {motion.reason}"
        force = setting.leg.ground_force(motion.angle, motion.rate, motion.acceleration)[1]
        if force.min() < 0.0:
            pull = f"{force.min():.1f} N after {since[int(np.argmin(force))]:.3f} s"
            yield f"in {trial.label} the pinned toe pulls on the ground, {pull}: it would lift off"
    if estimate.whiteness is not None and estimate.whiteness < BY_CHANCE:
        coarsest = max(estimate.roundings, key=lambda each: each.step)
        if coarsest.coarse and estimate.noise**2 < UNEXPLAINED * coarsest.variance:
            yield (
                f"the residuals are not white: the angle was rounded to steps of {1e3 * coarsest.step:.3g} mrad, more"
                f" than its noise; the standard deviations take that in, up to {estimate.inflation:.1f} times larger"
            )
        else:
            yield (
                f"the residuals are not white (p = {estimate.whiteness:.1g}): the model misses something, and the"
                " standard deviations are too small"
            )
    if not problem.smooth_model and any(trial.smoothing for trial in estimate.trials):
        yield "the data were smoothed and the model was not: the estimates are biased"
