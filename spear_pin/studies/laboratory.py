"""A synthetic laboratory: records of push tests as an instrument would write them. Nothing here is measured.

The source's records are not public. These follow its protocol (push slowly, hold for 3 s, let go, wait, again) with a
known truth, so that an identification can be tested. Every file says that it is synthetic, and how it was made.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import require
from spear_pin.files import atomic
from spear_pin.kinds import typed
from spear_pin.model.pinned import PinnedLeg
from spear_pin.studies.identification.records import Calibration
from spear_pin.studies.identification.trials import Trial
from spear_pin.studies.push_test import RATE, PassiveKnee, equilibrium, find_pushed_angle
from spear_pin.studies.push_test.motion import move
from spear_pin.studies.tables.readings import SYNTHETIC

HOLD, SWING, PUSH = 3.0, 3.0, 1.5  # s; hold and wait as in Section 4.1.3, the push an assumption
LONGEST = 10_000_000  # samples


@typed
@dataclass(frozen=True)
class Instrument:
    """A knee potentiometer and its converter: every number is an assumption.

    Attributes:
        calibration: calibration of the potentiometer (default: 5 V over 270°, 0.4 V at the straight leg).
        noise: standard deviation of the voltage, white, in V.
        quantum: step of the converter, in V; 0 is none (default: 12 bits of 5 V).
        drift: drift of the voltage, in V/s.
    """

    calibration: Calibration = Calibration(volts_per_rad=1.06, offset=0.4)
    noise: float = 0.005
    quantum: float = 5.0 / 4096
    drift: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("Instrument.noise", self.noise, lambda v: v >= 0, "a number >= 0, in V")
        require("Instrument.quantum", self.quantum, lambda v: v >= 0, "a number >= 0, in V")
        require("Instrument.drift", self.drift, lambda v: abs(v) < np.inf, "a finite number, in V/s")

    def voltage(self, t: Array, angle: Array, rng: np.random.Generator) -> Array:
        """Returns the recorded voltage for an angle, in V."""
        exact = self.calibration.volts_per_rad * angle + self.calibration.offset
        read = exact + self.drift * t + self.noise * rng.normal(size=t.size)
        return np.asarray(self.quantum * np.round(read / self.quantum) if self.quantum else read)


@dataclass(frozen=True)
class SyntheticRecord:
    """A record with the truth that it was made from.

    Attributes:
        t: times, (n,), in s.
        voltage: voltages, (n,), in V.
        angle: true angles, (n,), in rad.
        let_go: true times of the releases, in s.
        made_from: the truth in words, for the head of the file.
    """

    t: Array
    voltage: Array
    angle: Array
    let_go: Array
    made_from: tuple[str, ...]


@typed
def synthesize(
    leg: PinnedLeg,
    knee: PassiveKnee,
    depth: float = 0.10,
    *,
    repeats: int = 5,
    instrument: Instrument | None = None,
    rate: float = RATE,
    seed: int = 0,
) -> SyntheticRecord:
    """Simulates push, hold, release and wait, several times over, as in Section 4.1.3.

    Args:
        leg: the pinned leg, with its rotor or without.
        knee: true knee.
        depth: depth of the pushes, in m.
        repeats: number of releases.
        instrument: instrument that reads the knee (default: an assumed one).
        rate: samples a second.
        seed: seed of the noise, and of the moments of release.

    Raises:
        BadValue: a number is out of range, or the leg does not rest or cannot be pushed so far.
    """
    instrument = instrument or Instrument()
    cycle = PUSH + HOLD + SWING
    require("rate", rate, lambda r: 50 <= r <= LONGEST / (1 + cycle), "samples a second, from 50")
    most = int((LONGEST / rate - 1) / cycle)
    require("repeats", repeats, lambda n: 1 <= n <= most and n % 1 == 0, f"a whole number >= 1, at most {most}")
    require("seed", seed, lambda n: n >= 0 and n % 1 == 0, "a whole number >= 0")
    rng = np.random.default_rng(int(seed))
    pushed, level = find_pushed_angle(leg, knee, depth), equilibrium(leg, knee)
    t = np.arange(round((1.0 + cycle * int(repeats)) * rate)) / rate
    angle = np.full(t.size, level)
    let_go = 1.0 + cycle * np.arange(int(repeats)) + PUSH + HOLD + rng.uniform(0, 1, int(repeats)) / rate
    for moment in let_go:
        first, begin, end = np.searchsorted(t, moment + np.array([-HOLD - PUSH, 0.0, SWING + 2 / rate]), side="right")
        here, after = slice(first, begin), slice(begin, end)
        pushing = np.clip((t[here] - (moment - HOLD - PUSH)) / PUSH, 0.0, 1.0)
        angle[here] = level + (pushed - level) * (3 - 2 * pushing) * pushing**2
        motion = move(leg, knee, pushed, t[after] - moment)
        angle[after], level = motion.angle, float(motion.angle[-1])
    made_from = (
        f"{SYNTHETIC} record of a push test, computed and not measured",
        f"truth: k {knee.stiffness:g} N·m/rad, b {knee.damping:g} N·m·s/rad, dry friction {knee.coulomb:g} N·m,"
        f" spring's zero {knee.zero:.6g} rad, reflected rotor {leg.rotor:g} kg·m², pushed by {depth:g} m",
        f"calibration: {instrument.calibration.volts_per_rad:g} V/rad, {instrument.calibration.offset:g} V at zero",
        f"instrument (assumed): noise {instrument.noise:g} V, step {instrument.quantum:.4g} V,"
        f" drift {instrument.drift:g} V/s; seed {seed}",
    )
    return SyntheticRecord(t, instrument.voltage(t, angle, rng), angle, let_go, made_from)


@typed
def synthetic_trial(
    leg: PinnedLeg,
    knee: PassiveKnee,
    depth: float,
    noise: float,
    rng: np.random.Generator,
    hold: float = 0.5,
    duration: float = 1.5,
    rate: float = RATE,
) -> Trial:
    """Simulates one release with white noise on the angle, in rad, let go at time zero."""
    t = np.arange(-round(hold * rate), round(duration * rate) + 1) / rate
    initial = find_pushed_angle(leg, knee, depth)
    angle = np.full(t.size, initial)
    angle[t >= 0] = move(leg, knee, initial, t[t >= 0]).angle
    return Trial(t, angle + noise * rng.normal(size=t.size), 0.0, synthetic=True)


@typed
def write_csv(record: SyntheticRecord, path: str | Path) -> Path:
    """Writes a record as a CSV file with the columns time_s and knee_V, whole or not at all.

    Raises:
        BadFile: the file cannot be written.
    """
    with atomic(path) as temporary:
        header = "\n".join([*(f"# {line}" for line in record.made_from), "time_s,knee_V"])
        columns = np.column_stack([record.t, record.voltage])
        np.savetxt(
            temporary, columns, fmt=("%.6f", "%.7g"), delimiter=",", header=header, comments="", encoding="utf-8"
        )
    return Path(path)
