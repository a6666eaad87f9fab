"""Numbers of the bounding gait that statements ask for; torques are those of one motor, posterior leg first."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.bounding_law import PAIR
from spear_pin.model.catalogue import motor
from spear_pin.studies.bound import mean_speed
from spear_pin.studies.design import Points, against
from spear_pin.studies.reference import bound, hip_drive, hips, knee_drive, knees

OWN_SPRING = 56.0  # N·m/rad, Table 5.1


def speed() -> float:
    """Mean forward speed, in m/s."""
    return mean_speed(bound())


def fixed_point_residual() -> float:
    """‖P(x) - x‖ of the bound, SI units."""
    return float(bound().residual)


def phases() -> tuple[float, ...]:
    """Durations of the phases of a stride in their order, in s."""
    return tuple(bound().durations.values())


def largest_multiplier() -> float:
    """Magnitude of the largest Floquet multiplier without event feedback."""
    return float(np.abs(bound().multipliers).max())


def knee_peaks(stiffness: float) -> tuple[float, float]:
    """Largest torque of a knee motor in stance with a spring of this stiffness, in N·m."""
    posterior, anterior = knees()[stiffness].peak
    return float(posterior), float(anterior)


def peak_reduction(stiffness: float = OWN_SPRING) -> tuple[float, float]:
    """What a spring takes off the largest torque of a knee motor in stance, in N·m."""
    bare, sprung = knees()[0.0].peak, knees()[stiffness].peak
    return float(bare[0] - sprung[0]), float(bare[1] - sprung[1])


def flight_difference(stiffness: float = OWN_SPRING) -> float:
    """Largest difference that a spring makes to a knee motor's torque while its leg is in the air, in N·m."""
    bare, sprung = knees()[0.0], knees()[stiffness]
    return float(np.abs(bare.torque - sprung.torque)[~bare.bears].max())


def peaks_by_stiffness(leg: int, stiffnesses: Sequence[float] = (0.0, 56.0, 112.0, 200.0)) -> tuple[float, ...]:
    """Largest torque of a leg's knee motor in stance by the stiffness of its spring, in N·m."""
    return tuple(float(knees()[stiffness].peak[leg]) for stiffness in stiffnesses)


def spread_in_stance(stiffness: float) -> tuple[float, float]:
    """From the least to the largest torque of a knee motor in stance, in N·m."""
    given = knees()[stiffness]
    posterior, anterior = (float(np.ptp(given.torque[given.bears[:, leg], leg])) for leg in (0, 1))
    return posterior, anterior


def hip_time_outside(ratio: float) -> float:
    """Largest share of a stride that a hip motor is outside its envelope, by gear ratio."""
    return float(against(hips(), hip_drive(ratio)).outside.max())


def hip_over_knee() -> tuple[float, float]:
    """Root mean square torque of a hip motor over that of its leg's knee motor."""
    posterior, anterior = hips().rms / knees()[OWN_SPRING].rms
    return float(posterior), float(anterior)


def knee_time_outside(power: str) -> float:
    """Largest share of a stride that a knee motor is outside its envelope, by rated power."""
    return float(against(knees()[OWN_SPRING], knee_drive(power)).outside.max())


def outside_near_events(power: str = "260 W") -> float:
    """Of the points outside a knee drive's envelope, the share within 20 ms after touchdown or before lift-off."""
    return against(knees()[OWN_SPRING], knee_drive(power)).near_events


def outside_without_preload(power: str = "260 W") -> float:
    """Of the points in stance outside a knee drive's envelope, the share that is outside without ū, too."""
    given, drive = knees()[OWN_SPRING], knee_drive(power)
    out = _outside(given, power) & given.bears
    law = bound().system.law
    preload = np.array([law.posterior_knee_torque, law.anterior_knee_torque]) / PAIR
    reduced = np.sign(given.torque) * np.maximum(np.abs(given.torque) - preload, 0.0)
    return float((np.asarray(drive.margin(reduced, given.speed)) < 0.0)[out].mean())


def rotor_ratio(larger: str = "ec_90_flat_260w", smaller: str = "ec_60_flat_100w_48v") -> float:
    """Rotor inertia of one motor of the catalogue over that of another."""
    return motor(larger).known("rotor_inertia") / motor(smaller).known("rotor_inertia")


def _outside(given: Points, power: str) -> NDArray[np.bool_]:
    return np.asarray(against(given, knee_drive(power)).margin < 0.0)
