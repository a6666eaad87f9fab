"""Least squares of an identification: entries of the unknown vector, residuals and their Jacobian."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.identification.first_guess import guess
from spear_pin.studies.identification.quantities import KNEE, NUISANCES, QUANTITIES
from spear_pin.studies.identification.trials import Trial
from spear_pin.studies.push_test import PassiveKnee, rest_at
from spear_pin.studies.push_test.motion import move

RTOL = 1e-8
ONSET = 0.1  # s, by which the time of a release may be corrected
STRAY = 0.01  # of the samples: outliers, for a robust loss to deal with


@dataclass(frozen=True)
class Entry:
    """One unknown.

    Attributes:
        name: a name of `QUANTITIES`.
        trial: number of the trial to which it belongs; None if all trials share it.
        start: start of the search, from the origin.
        bounds: least and largest value, from the origin.
        origin: value from which the unknown counts: a time counts from about when the leg is let go, whatever its
            clock.
    """

    name: str
    trial: int | None
    start: float
    bounds: tuple[float, float]
    origin: float = 0.0


@dataclass(frozen=True)
class Setting:
    """Inputs of the model for one trial.

    Attributes:
        leg: the leg with its rotor.
        knee: torque law of the knee.
        initial_angle: initial angle, in rad.
        delay: delay of the release, after `Trial.let_go`, in s.
        rest_angle: rest angle in its reading, in rad.
    """

    leg: PinnedLeg
    knee: PassiveKnee
    initial_angle: float
    delay: float
    rest_angle: float

    def since(self, trial: Trial) -> Array:
        """Returns times of a trial's samples since the release, (n,), in s."""
        return (trial.t - trial.let_go) - self.delay


@dataclass(frozen=True)
class LeastSquares:
    """Residuals of all trials as a function of the unknowns.

    Attributes:
        leg: the pinned leg.
        trials: the data.
        known: the value of every quantity that is not unknown, for each trial.
        entries: the unknowns.
        static_rest: whether the rest angle is where the leg rests.
        unilateral: whether the spring only pulls.
        smooth_model: whether the model is smoothed as the data were.
        tally: number of integrations of a release so far, under "integrations".
    """

    leg: PinnedLeg
    trials: tuple[Trial, ...]
    known: tuple[Mapping[str, float], ...]
    entries: tuple[Entry, ...]
    static_rest: bool
    unilateral: bool
    smooth_model: bool
    tally: Counter[str] = field(default_factory=Counter, compare=False)

    def setting(self, x: Array, j: int) -> Setting:
        """Returns the model's numbers for trial j."""
        value = dict(self.known[j])
        value |= {e.name: float(v) for e, v in zip(self.entries, x, strict=True) if e.trial in (None, j)}
        rest = value["rest_angle"]
        knee = PassiveKnee(value["stiffness"], value["damping"], value["coulomb"], rest, self.unilateral)
        knee = rest_at(self.leg, knee, rest) if self.static_rest else knee
        leg = self.leg.with_rotor(value["rotor_inertia"])
        return Setting(leg, knee, value["initial_angle"], value["release_time"], rest)

    def angle(self, x: Array, j: int) -> Array:
        """Returns the model's angle for trial j, not smoothed, (n,), in rad."""
        return self._modelled(self.setting(x, j), self.trials[j], ())[0]

    def smoothed(self, values: Array, j: int) -> Array:
        """Returns what the model gives for trial j as it is compared with the data, (n,) or (n, m)."""
        smoothing = self.trials[j].smoothing if self.smooth_model else None
        return values if smoothing is None else smoothing(values)

    def linearized(self, x: Array) -> tuple[Array, Array]:
        """Returns model minus data, (N,), in rad, and derivatives, (N, unknowns); 0 where they are not compared.

        The trials follow one another.
        """
        residuals, blocks = [], []
        for j, trial in enumerate(self.trials):
            block = np.zeros((trial.t.size, len(self.entries)))
            mine = [i for i, entry in enumerate(self.entries) if entry.trial in (None, j)]
            angle, block[:, mine] = self._with_slopes(self.setting(x, j), trial, [self.entries[i].name for i in mine])
            residuals.append(trial.used * (self.smoothed(angle, j) - trial.angle))
            blocks.append(trial.used[:, None] * self.smoothed(block, j))
        return np.concatenate(residuals), np.vstack(blocks)

    def _with_slopes(self, setting: Setting, trial: Trial, names: Sequence[str]) -> tuple[Array, Array]:
        wrt = {QUANTITIES[name].derivative for name in names} - {None}
        if self.static_rest and "stiffness" in wrt:
            wrt |= {"zero"}
        order = sorted(str(name) for name in wrt)
        angle, rate, sensitivity = self._modelled(setting, trial, order)
        slopes = {name: sensitivity[:, i] for i, name in enumerate(order)}
        if self.static_rest:
            rest, stiffness = setting.rest_angle, setting.knee.stiffness
            if "stiffness" in slopes:
                slopes["stiffness"] = (
                    slopes["stiffness"] - slopes["zero"] * float(setting.leg.gravity(rest)) / stiffness**2
                )
            if "zero" in slopes:
                slopes["zero"] = slopes["zero"] * (1.0 + float(setting.leg.motion_with_slopes(rest)[5]) / stiffness)
        derivatives = [QUANTITIES[name].derivative for name in names]
        return angle, np.column_stack([-rate if name is None else slopes[name] for name in derivatives])

    def _modelled(self, setting: Setting, trial: Trial, wrt: Sequence[str]) -> tuple[Array, Array, Array]:
        """Returns angle, rate and sensitivities: the hold, then the motion."""
        since = setting.since(trial)
        moving = since > 0.0
        angle, rate = np.full(since.size, setting.initial_angle), np.zeros(since.size)
        sensitivity = np.tile([float(name == "initial_angle") for name in wrt], (since.size, 1))
        if moving.any():
            motion = move(setting.leg, setting.knee, setting.initial_angle, since[moving], wrt, RTOL)
            angle[moving], rate[moving], sensitivity[moving] = motion.angle, motion.rate, motion.sensitivity
            self.tally["integrations"] += max(len(wrt), 1)
        return angle, rate, sensitivity


def pose(
    leg: PinnedLeg,
    trials: Sequence[Trial],
    vary: Sequence[str],
    per_trial: Collection[str],
    nuisances: Collection[str],
    static_rest: bool,
    known: Mapping[str, float],
    unilateral: bool,
    bounds: Mapping[str, tuple[float, float]],
    smooth_model: bool,
) -> LeastSquares:
    """Sets the least squares up; see `identify` for the arguments and what is refused."""
    for kind, names, valid in (
        ("parameter", vary, KNEE),
        ("parameter of each trial", per_trial, vary),
        ("nuisance", nuisances, NUISANCES),
        ("known parameter", known, KNEE),
        ("bounded parameter", bounds, (*vary, *nuisances)),
    ):
        for name in names:
            if name not in valid:
                raise UnknownName(kind, name, valid)
    if not vary or len(set(vary)) < len(vary):
        raise BadValue("vary", list(vary), f"one or more of {', '.join(KNEE)}, each once")
    if not trials:
        raise BadValue("trials", list(trials), "one release or more")
    for name, value in known.items():
        least, largest = QUANTITIES[name].bounds
        require(f"known {name}", value, lambda v: least <= v <= largest, f"within {least:g} … {largest:g}")  # noqa: B023
    for trial in trials:
        _check_calibration(leg, trial)
    guesses = [guess(leg, trial, static_rest) for trial in trials]
    shared = {name: float(np.median([each[name] for each in guesses])) for name in KNEE}
    if "coulomb" not in vary:
        shared["coulomb"] = 0.0
    shared |= known
    values = tuple(each | shared for each in guesses)
    entries = []
    for name in vary:
        limits = _bounds(leg, name, bounds, static_rest)
        owners = range(len(trials)) if name in per_trial else (None,)
        entries += [Entry(name, owner, float(np.clip(shared[name], *limits)), limits) for owner in owners]
    for j, trial in enumerate(trials):
        for name in (name for name in NUISANCES if name in nuisances):
            limits, origin = _bounds(leg, name, bounds, static_rest), 0.0
            if name == "release_time":
                limits, origin = _onset(trial, limits, bounds.get(name)), trial.let_go
            entries.append(Entry(name, j, float(np.clip(values[j][name], *limits)), limits, origin))
    return LeastSquares(leg, tuple(trials), values, tuple(entries), static_rest, unilateral, smooth_model)


def _check_calibration(leg: PinnedLeg, trial: Trial) -> None:
    low, high = leg.span
    for extreme in map(float, np.quantile(trial.angle, (STRAY, 1.0 - STRAY))):
        if not low <= extreme <= high:
            expected = f"within the joint's limits, {low:g} … {high:g} rad; is the calibration right?"
            raise BadValue(f"the knee's angle in {trial.label}", extreme, expected)


def _onset(trial: Trial, bounds: tuple[float, float], given: object) -> tuple[float, float]:
    """Returns bounds of a release's delay, from those of its time."""
    low, high = max(trial.let_go - ONSET, trial.t[0]), min(trial.let_go + ONSET, trial.t[-2])
    limits = max(bounds[0], low) - trial.let_go, min(bounds[1], high) - trial.let_go
    if not limits[0] < limits[1]:
        expected = f"bounds that overlap {low:g} … {high:g} s, for {trial.label}"
        raise BadValue("bounds of release_time", given, expected)
    return limits


def _bounds(
    leg: PinnedLeg, name: str, bounds: Mapping[str, tuple[float, float]], static_rest: bool
) -> tuple[float, float]:
    """Returns bounds of a quantity: its own, the leg's and the user's."""
    low, high = QUANTITIES[name].bounds
    if name == "initial_angle" or (name == "rest_angle" and static_rest):
        low, high = leg.span
    try:
        least, largest = map(float, bounds.get(name, (-np.inf, np.inf)))
    except (TypeError, ValueError):
        least, largest = np.nan, np.nan
    low, high = max(low, least), min(high, largest)
    if not (least < largest and low < high):
        raise BadValue(
            f"bounds of {name}",
            bounds.get(name),
            f"two numbers, the first less than the other, within {QUANTITIES[name].bounds}",
        )
    return low, high
