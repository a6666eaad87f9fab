"""First guess of a trial's parameters, from its first swing and its end; and the trial cut to that swing."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spear_pin.arrays import Array
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.identification.smoothing import MovingAverage
from spear_pin.studies.identification.trials import Trial

CALM = 0.03  # s, over which the angle is averaged for a first guess
TAIL = 0.2  # of a trial: its end, at rest or nearly


def guess(leg: PinnedLeg, trial: Trial, static_rest: bool) -> dict[str, float]:
    """Guesses parameters from the swing's first turn, its depth and the angle in the end.

    Damping and dry friction are each guessed as if it braked the first swing alone. The time of the release counts from
    `Trial.let_go`.
    """
    hold = trial.angle[trial.t < trial.let_go]
    initial = float(np.median(hold)) if hold.size else float(trial.angle[0])
    since = trial.t - trial.let_go
    rest = float(np.clip(trial.angle[since > (1.0 - TAIL) * since[-1]].mean(), *leg.span))
    first = (since > 0) & (since <= 1.0)
    below = (rest - float(_calm(trial)[first].min(initial=rest))) / max(abs(initial - rest), 1e-3)
    decrement = -np.log(np.clip(below, 0.05, 0.95)) / np.pi
    ratio = decrement / np.hypot(1.0, decrement)
    inertia, slope = float(leg.effective_inertia(rest)), float(leg.motion_with_slopes(rest)[5])
    undamped = np.pi / _turn(trial) / np.sqrt(1.0 - ratio**2)
    stiffness = max(inertia * undamped**2 - slope, 5.0)
    damping = float(2.0 * ratio * inertia * undamped)
    return {
        "stiffness": float(stiffness),
        "damping": damping,
        "coulomb": 0.25 * np.pi * damping * undamped * abs(initial - rest) * (1.0 + below) / 2.0,
        "rest_angle": rest if static_rest else rest + float(leg.gravity(rest)) / stiffness,
        "rotor_inertia": leg.rotor,
        "initial_angle": float(np.clip(initial, *leg.span)),
        "release_time": 0.0,
    }


def first_swing(trial: Trial) -> Trial:
    """Returns the trial until the knee stands still for the second time, or soon after."""
    last = max(int(np.searchsorted(trial.t, trial.let_go + 2.0 * _turn(trial))), 10)
    raw = None if trial.raw is None else trial.raw[:last]
    return replace(trial, t=trial.t[:last], angle=trial.angle[:last], raw=raw)


def _turn(trial: Trial) -> float:
    """Returns the rough time from the release to the first turn, in s."""
    since = trial.t - trial.let_go
    first = (since > 0) & (since <= 1.0)
    return max(float(since[first][np.argmin(_calm(trial)[first])]), 0.02) if first.any() else 0.2


def _calm(trial: Trial) -> Array:
    """Returns the angle without most of its noise, good enough to begin from."""
    return MovingAverage(max(round(CALM / float(np.median(np.diff(trial.t)))), 1))(trial.angle)
