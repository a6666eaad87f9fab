"""Hardware between a control law and the joints: actuators, and the effects of sensors and wires.

A hybrid system without hardware has ideal motors, which give the torques that its law commands. `with_hardware` puts
an actuator on each joint. States of the hardware (currents, heat, a clock) are integrated with the motion, and continue
through its events.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import require
from spear_pin.kinds import typed
from spear_pin.model.actuator import Actuator

TONES = 24  # number of tones that make up the noise
EDGE = 2e-4  # s: time in which a command drops out and returns
HORIZON = 120.0  # s: time within which commands may drop out
STEP, FINE_STEP = 0.01, 2e-3  # s: longest steps of the integration, without and with noise or current loops
HARDWARE_TOLERANCE = 0.1  # factor on tolerances: error estimates are too small where gears turn from driving to braking
CLOCK = "clock"
ELECTRICAL = ("battery", "joule", "gearbox")  # flows of energy of an actuator


@typed
@dataclass(frozen=True)
class Sensing:
    """Noise on the angles and rates that the law reads, and lost commands; the same for the same seed.

    The noise is a sum of tones below the cut-off, so that the motion stays smooth.

    Attributes:
        angle_noise: root mean square of the noise on every joint's angle, in rad.
        rate_noise: root mean square of the noise on every joint's rate, in rad/s.
        cutoff: cut-off frequency of the noise, in Hz.
        losses: mean number of commands lost per second, in the first two minutes.
        loss_duration: time for which a lost command leaves the motors without current, in s.
        seed: seed of noise and losses.
    """

    angle_noise: float = 0.0
    rate_noise: float = 0.0
    cutoff: float = 100.0
    losses: float = 0.0
    loss_duration: float = 0.005
    seed: int = 0

    def __post_init__(self) -> None:
        """Checks the fields."""
        require("Sensing.angle_noise", self.angle_noise, lambda a: a >= 0, "a number >= 0, in rad")
        require("Sensing.rate_noise", self.rate_noise, lambda r: r >= 0, "a number >= 0, in rad/s")
        require("Sensing.cutoff", self.cutoff, lambda f: 0 < f <= 250, "a number from 0 to 250, in Hz")
        require("Sensing.losses", self.losses, lambda n: 0 <= n <= 50, "a number from 0 to 50, per second")
        require(
            "Sensing.loss_duration", self.loss_duration, lambda d: d >= FINE_STEP, f"a number >= {FINE_STEP:g}, in s"
        )

    @cached_property
    def _tones(self) -> tuple[Array, Array]:
        """Angular frequencies and phases of the tones, for up to eight joints, angles and rates: (16, TONES)."""
        rng = np.random.default_rng([self.seed, 1])
        return 2.0 * np.pi * rng.uniform(0.05, 1.0, (16, TONES)) * self.cutoff, rng.uniform(0, 2 * np.pi, (16, TONES))

    @cached_property
    def losses_begin(self) -> Array:
        """Times at which commands drop out, in s."""
        rng = np.random.default_rng([self.seed, 2])
        count = int(rng.poisson(self.losses * HORIZON)) if self.losses else 0
        return np.sort(rng.uniform(0.0, HORIZON, count))

    def noise(self, time: float, joints: int) -> tuple[list[float], list[float]]:
        """Returns the noise added to the angles and rates of so many joints at a time."""
        if not (self.angle_noise or self.rate_noise):
            return [0.0] * joints, [0.0] * joints
        frequencies, phases = self._tones
        waves = math.sqrt(2.0 / TONES) * np.sin(frequencies * time + phases).sum(axis=1)
        return (self.angle_noise * waves[:joints]).tolist(), (self.rate_noise * waves[8 : 8 + joints]).tolist()

    def arriving(self, time: float) -> float:
        """Returns the part of a command that arrives: 1, 0 while it is lost, a ramp between."""
        begins = self.losses_begin
        first, last = np.searchsorted(begins, (time - self.loss_duration, time), "right")
        arrives = 1.0
        for begin in begins[first:last].tolist():
            since = time - begin
            arrives = min(arrives, max(EDGE - since, since - self.loss_duration + EDGE, 0.0) / EDGE)
        return arrives


@dataclass(frozen=True)
class Hardware:
    """An actuator for every actuated joint, and the sensing.

    Attributes:
        actuators: the actuators, in the order of u.
        sensing: noise on what the law reads, and losses of its commands; None means neither.
    """

    actuators: tuple[Actuator, ...]
    sensing: Sensing | None = None

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the states: the clock if there is one, then the states of each actuator."""
        own = (f"{name}_{i}" for i, actuator in enumerate(self.actuators) for name in actuator.states)
        return (CLOCK, *own) if self.sensing is not None else tuple(own)

    @property
    def max_step(self) -> float:
        """Longest step of the integration, in s."""
        loops = any(actuator.bandwidth is not None for actuator in self.actuators)
        return FINE_STEP if self.sensing is not None or loops else STEP

    def states(self, x: Sequence[float]) -> tuple[float, list[dict[str, float]]]:
        """Returns the clock and each actuator's states, by name."""
        values = list(x)
        clock = values.pop(0) if self.sensing is not None else 0.0
        each = []
        for actuator in self.actuators:
            each.append({name: values.pop(0) for name in actuator.states})
        return clock, each

    def read(
        self, x: Sequence[float], joints: Sequence[int], angles: Sequence[float], rates: Sequence[float]
    ) -> tuple[Sequence[float], Sequence[float]]:
        """Returns the angles and rates as the law reads them, with noise at these joints."""
        if self.sensing is None:
            return angles, rates
        q, v = list(angles), list(rates)
        for joint, angle, rate in zip(joints, *self.sensing.noise(self.states(x)[0], len(joints)), strict=True):
            q[joint] += angle
            v[joint] += rate
        return q, v

    def stored(self, x: Sequence[float]) -> float:
        """Returns the energy of the inductances, in J."""
        return sum(a.stored(own) for a, own in zip(self.actuators, self.states(x)[1], strict=True))


class Driven(NamedTuple):
    """Response of the actuators to commanded torques at an instant.

    Attributes:
        torques: torques at the joints, in N·m.
        currents: currents, in A.
        references: commanded currents, in A.
        slopes: time derivatives of the hardware's states.
        powers: battery, joule and gearbox power of each actuator, in W.
    """

    torques: list[float]
    currents: list[float]
    references: list[float]
    slopes: list[float]
    powers: list[float]


def drive(hardware: Hardware, x: Sequence[float], commands: Sequence[float], rates: Sequence[float]) -> Driven:
    """Drives the joints, which turn at these rates, with commanded torques."""
    clock, states = hardware.states(x)
    arriving = 1.0 if hardware.sensing is None else hardware.sensing.arriving(clock)
    driven = Driven([], [], [], [1.0] if hardware.sensing is not None else [], [])
    for actuator, own, wanted, rate in zip(hardware.actuators, states, commands, rates, strict=True):
        command = arriving * wanted
        current, slopes = actuator.current(command, rate, own), actuator.slopes(command, rate, own)
        power = actuator.power(current, rate, slopes.get("current", 0.0))
        driven.torques.append(power.torque)
        driven.currents.append(current)
        driven.references.append(actuator.reference(wanted))
        driven.slopes.extend(slopes[name] for name in actuator.states)
        driven.powers.extend((power.battery, -power.joule, -power.gearbox))
    return driven


def blend_responses(shares: Sequence[float], each: Sequence[Driven]) -> Driven:
    """Averages the responses to several sets of commands, each of which acts for its share of the time."""
    parts = [
        [sum(share * x for share, x in zip(shares, values, strict=True)) for values in zip(*columns, strict=True)]
        for columns in zip(*each, strict=True)
    ]
    return Driven(*parts)
