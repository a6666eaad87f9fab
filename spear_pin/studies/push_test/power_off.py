"""The power-off experiment of Section 4.1.5.3, Fig. 4.7: whether a motor without command brakes the swing.

Without a command all switches of the bridge are open. The motor is then a generator without load until its back-EMF
(4.8) exceeds the battery and two diodes. Below that, a connected power supply makes no difference. A motor with shorted
phases would brake.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from spear_pin.kinds import typed
from spear_pin.model.bridge import Battery, Bridge, State, back_emf, conduction_threshold, shorted_damping
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Motor
from spear_pin.studies.push_test.passive_knee import WITH_MOTOR, WITHOUT_MOTOR, PassiveKnee
from spear_pin.studies.push_test.releases import Release, release
from spear_pin.studies.push_test.rest import rest_at, spear_ii

CASES: dict[str, State | None] = {
    "belt taken off": None,
    "motor, supply off": "open",
    "motor, supply on": "coast",
    "motor, phases shorted": "short",
}


@dataclass(frozen=True)
class PowerOff:
    """One case of the experiment.

    Attributes:
        label: label of the case.
        release: the motion.
        peak_emf: largest back-EMF of the motor, in V; 0 without one.
        threshold: back-EMF above which current flows, in V; infinite if it never does.
        apart: largest difference of the boom's height from the case with the supply off, in m.
    """

    label: str
    release: Release
    peak_emf: float
    threshold: float
    apart: float


@typed
def add_braking(
    knee: PassiveKnee, state: State, machine: Motor, ratio: float, battery: Battery, bridge: Bridge
) -> PassiveKnee:
    """Returns the knee with the braking of a motor without command.

    Args:
        knee: torque law of the knee without the motor.
        state: state of the bridge, see `spear_pin.model.bridge.idle_current`.
        machine: needs `torque_constant` and `resistance`.
        ratio: ratio of its gearbox.
        battery: battery behind the bridge.
        bridge: bridge with its diodes.
    """
    constant, resistance = machine.known("torque_constant"), machine.known("resistance")
    if state == "open":
        return knee
    if state == "short":
        return replace(knee, braking=shorted_damping(constant, ratio, resistance))
    damping = shorted_damping(constant, ratio, resistance + battery.resistance)
    return replace(knee, braking=damping, braking_from=conduction_threshold(battery, bridge) / (constant * ratio))


@typed
def power_off(
    depth: float = 0.10,
    *,
    ratio: float = 15.0,
    machine: Motor | None = None,
    battery: Battery | None = None,
    bridge: Bridge | None = None,
    static_rest: bool = False,
    duration: float = 1.5,
) -> list[PowerOff]:
    """Simulates the release with the motor in each of the states of Fig. 4.7, and shorted.

    Args:
        depth: depth of the push, in m.
        ratio: ratio of the gearbox.
        machine: the knee motor (default: the source's, its resistance an assumption).
        battery: default 24 V.
        bridge: default diodes of 0.7 V.
        static_rest: whether RA is the angle at rest.
        duration: duration of the motions, in s.
    """
    machine, battery, bridge = machine or motor("spear_ii_knee"), battery or Battery(), bridge or Bridge()
    limits = {"open": np.inf, "coast": conduction_threshold(battery, bridge), "short": 0.0}
    motions: dict[str, Release] = {}
    for label, state in CASES.items():
        leg, knee = spear_ii(None if state is None else ratio), WITHOUT_MOTOR if state is None else WITH_MOTOR
        if static_rest:
            knee = rest_at(leg, knee, knee.zero)
        if state is not None:
            knee = add_braking(knee, state, machine, ratio, battery, bridge)
        motions[label] = release(leg, knee, depth, duration)
    reference = motions["motor, supply off"].height
    rows = []
    for label, state in CASES.items():
        motion = motions[label]
        fastest = 0.0 if state is None else float(np.abs(motion.rate).max())
        emf = float(back_emf(machine.known("torque_constant"), ratio, fastest))
        apart = float(np.abs(motion.height - reference).max())
        rows.append(PowerOff(label, motion, emf, np.inf if state is None else limits[state], apart))
    return rows
