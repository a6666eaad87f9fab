"""Doubts about an estimate, each in a sentence for its reader."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from spear_pin.studies.fitting import doubt
from spear_pin.studies.identification.estimate import Estimate
from spear_pin.studies.identification.least_squares import LeastSquares
from spear_pin.studies.identification.quantities import KNEE
from spear_pin.studies.push_test.motion import move

BY_CHANCE = 0.01  # probability below which residuals are not white
UNEXPLAINED = 2.0  # times the power of noise and rounding: residuals that have more miss something
POOR = 70.0  # percent: a model that fits worse does not describe the data


def doubts(problem: LeastSquares, solution: Any, estimate: Estimate) -> Iterator[str]:
    """Lists sentences that warn, if any.

    Args:
        problem: the least squares.
        solution: solution of SciPy.
        estimate: the estimate made from it.
    """
    values = {parameter.label: parameter.value for parameter in estimate.parameters}
    of_knee = sum(parameter.name in KNEE for parameter in estimate.parameters)  # they come first
    yield from doubt(solution, values, estimate.correlation[:of_knee, :of_knee])
    for j, (trial, fit) in enumerate(zip(estimate.trials, estimate.fits, strict=True)):
        if not fit >= POOR:
            yield f"the model does not describe {trial.label}: fit {fit:.1f} %"
        setting = problem.setting(np.asarray(solution.x), j)
        since = setting.since(trial)
        since = since[since > 0.0]
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
