"""From a long record of the knee's angle to trials: a hold, the release, the swing after it."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadFile, BadValue, require
from spear_pin.kinds import typed
from spear_pin.studies.identification.records import Record
from spear_pin.studies.identification.smoothing import MovingAverage

STEADY = 0.1  # s, over which the angle is averaged to find falls, and to see whether it is held
APART = 1.0  # s, between releases at least
STEEP = 0.3  # of the steepest fall in the record: what a release has at least
DROP = 0.03  # rad: a release moves the knee by more
LOOK_BACK = 10.0  # s before a release that are looked at
HELD = (0.6, 0.3)  # s before the steepest fall, between which the knee is held
ENDS = 0.5  # s after the steepest fall, within which the first swing ends
STILL = 0.05  # of the first swing, by which the angle may wander while it is held
HOLD = 0.05  # s of hold, at least
FEWEST = 10  # samples
SWING = 0.1  # s of motion, at least
SWINGS = 3.0  # s after a release, within which later falls are its own
PUSH = 0.5  # s before the next hold that the hand takes to push, at least


@dataclass(frozen=True)
class Trial:
    """One release as recorded.

    Attributes:
        t: times, (n,), in s, increasing.
        angle: angle of the knee to be fitted, (n,), in rad.
        let_go: time at which the leg was let go, as far as known, in s on the same clock.
        label: label for people.
        smoothing: smoothing of the angle, if any.
        raw: angle before smoothing, if known.
        synthetic: whether the record says that it is.
    """

    t: Array
    angle: Array
    let_go: float
    label: str = "release"
    smoothing: MovingAverage | None = None
    raw: Array | None = None
    synthetic: bool = False

    def __post_init__(self) -> None:
        """Checks that the release lies within the samples."""
        if self.t.ndim != 1 or self.angle.shape != self.t.shape or self.t.size < FEWEST:
            raise BadValue("trial", self.t.shape, "as many angles as times, at least ten")
        if not (np.isfinite(self.t).all() and np.isfinite(self.angle).all() and (np.diff(self.t) > 0).all()):
            raise BadValue("trial", self.label, "finite angles at increasing times")
        inside = self.t[0] <= self.let_go < self.t[-1]
        require("let_go", self.let_go, lambda _: inside, f"a time within {self.t[0]:g} … {self.t[-1]:g} s")

    @property
    def used(self) -> NDArray[np.bool_]:
        """Samples to compare with a model, (n,): not those whose smoothing used samples that were cut off later."""
        beyond = 0 if self.smoothing is None or self.raw is not None else self.smoothing.ahead
        return np.arange(self.t.size) < self.t.size - beyond

    @property
    def unsmoothed(self) -> Array | None:
        """Angle before any smoothing, if known."""
        return self.angle if self.smoothing is None else self.raw


@typed
def smooth_trial(trial: Trial, smoothing: MovingAverage | None) -> Trial:
    """Returns the trial with its angle smoothed; None leaves it as it is.

    Raises:
        BadValue: the trial is smoothed already.
    """
    if smoothing is None:
        return trial
    if trial.smoothing is not None:
        raise BadValue("smoothing", smoothing, f"None: {trial.label} has been smoothed already")
    if smoothing.window > trial.t.size:
        raise BadValue("window", smoothing.window, f"at most the {trial.t.size} samples of {trial.label}")
    return replace(trial, angle=smoothing(trial.angle), smoothing=smoothing, raw=trial.angle)


@typed
def cut_releases(record: Record, before: float = 0.5, after: float = 1.5) -> tuple[list[Trial], list[str]]:
    """Finds the releases in a record: a hold, after which the knee extends swiftly.

    Args:
        record: record of one release or of many.
        before: time of the hold to keep, in s; less where the hold was shorter.
        after: time of the motion to keep, in s; less where the record ends or the next push begins.

    Returns:
        The trials in order of time, and what was left out or shortened, and why.

    Raises:
        BadFile: there is no release in the record.
    """
    require("before", before, lambda s: HOLD <= s <= 60, f"a number of seconds from {HOLD:g} to 60")
    require("after", after, lambda s: 0.1 <= s <= 60, "a number of seconds from 0.1 to 60")
    width = max(round(STEADY / record.step), 1)
    steady = MovingAverage(width)(record.angle)
    # half a window to either side: the mean before minus the mean after
    fall = np.zeros_like(steady)
    half = width // 2 + 1
    fall[half:-half] = steady[: -2 * half] - steady[2 * half :]
    peaks, _ = scipy.signal.find_peaks(
        fall, height=max(STEEP * fall.max(), DROP / 2), distance=max(round(APART / record.step), 1)
    )
    found: list[tuple[int, float]] = []
    remarks: list[str] = []
    for peak in peaks:
        onset = _onset(record, steady, int(peak))
        if isinstance(onset, str):
            if found and record.t[peak] < found[-1][1] + SWINGS:
                continue  # of the same release
            remarks.append(f"{record.source}: the fall at {record.t[peak]:.2f} s is no release: {onset}")
        else:
            found.append(onset)
    if not found:
        raise BadFile(record.source, remarks[0].partition(": ")[2] if remarks else "there is no release in it")
    trials = []
    for i, (held, let_go) in enumerate(found):
        start = max(record.t[held], let_go - before)
        end = let_go + after
        if i + 1 < len(found):
            end = min(end, float(record.t[found[i + 1][0]]) - PUSH)
        first = min(int(np.searchsorted(record.t, start)), int(np.searchsorted(record.t, let_go, "right")) - 1)
        rows = slice(first, int(np.searchsorted(record.t, end, "right")))
        if end < let_go + SWING or rows.stop - rows.start < FEWEST:
            remarks.append(
                f"{record.source}: release {i + 1} is left out: the knee is caught at once, or the record ends"
            )
            continue
        kept = float(record.t[rows][-1]) - let_go
        if kept < 0.95 * after:
            remarks.append(f"{record.source}: release {i + 1} is followed for {kept:.2f} s, not for {after:g} s")
        trials.append(Trial(record.t[rows], record.angle[rows], let_go, f"release {i + 1}", synthetic=record.synthetic))
    if not trials:
        raise BadFile(record.source, remarks[-1].partition(": ")[2])
    return trials, remarks


def _onset(record: Record, steady: Array, peak: int) -> tuple[int, float] | str:
    """Returns where the hold before a steep fall begins, and when it ended; or why it is not a release.

    It fits the hold and a quarter of a cosine, down to the steepest point, to the angle.
    """
    origin = int(np.searchsorted(record.t, record.t[peak] - LOOK_BACK))
    t, measured = record.t[origin : peak + 1], record.angle[origin : peak + 1]
    before = (t >= t[-1] - HELD[0]) & (t <= t[-1] - HELD[1])
    if before.sum() < 3:
        return "the record begins with it"
    level = float(np.median(measured[before]))
    depth = level - float(steady[peak : int(np.searchsorted(record.t, t[-1] + ENDS)) + 1].min())
    if depth < DROP:
        return f"the knee moves by {max(depth, 0):.3f} rad only (does the voltage rise as it flexes?)"
    if np.ptp(steady[origin : peak + 1][before]) > 2 * STILL * depth:
        return "the knee was not held still before it"
    late = t > t[-1] - HELD[1]
    fallen, left = level - measured[late], t[-1] - t[late]

    def missed(time: float) -> float:
        shape = 1.0 - np.cos(0.5 * np.pi * np.clip(1.0 - left / time, 0.0, None))
        return -(max(float(shape @ fallen), 0.0) ** 2) / float(shape @ shape)

    times = np.linspace(0.0, HELD[1], 31)[1:]
    best = int(np.argmin([missed(time) for time in times]))
    around = times[max(best - 1, 0)], times[min(best + 1, times.size - 1)]
    let_go = float(
        t[-1] - scipy.optimize.minimize_scalar(missed, bounds=around, method="bounded", options={"xatol": 1e-5}).x
    )
    if (t > let_go).sum() < 4:
        return "it is too coarsely sampled"
    if not t[0] + HOLD <= let_go < t[-1]:
        return "its beginning cannot be made out"
    wandering = np.abs(level - steady[origin : peak + 1]) > STILL * depth
    moving = np.flatnonzero(wandering & (t < let_go - STEADY))
    held = int(moving[-1]) + 1 if moving.size else 0
    if let_go - t[held] < HOLD:
        return "the knee was not held still before it"
    return origin + held, let_go
