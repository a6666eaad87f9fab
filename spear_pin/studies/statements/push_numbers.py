"""Numbers of the push test that statements ask for."""

from __future__ import annotations

from itertools import product

import numpy as np

from spear_pin.model.bridge import Battery, Bridge, back_emf, conduction_threshold, shorted_damping
from spear_pin.model.catalogue import motor
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, equilibrium, pushed_angle, release, spear_ii
from spear_pin.studies.reference import estimated, fitted, gears, idling
from spear_pin.studies.source_design import SPEAR_II

SPEED = 20.0  # rad/s, of the example in Section 4.1.5.3


def first_turns() -> tuple[float, ...]:
    """When the knee first turns after the release: without motor, then by rising gear ratio, in s."""
    return tuple(float(row.release.turns[0]) for row in gears())


def frequencies() -> tuple[float, ...]:
    """Of the small oscillation, undamped, in Hz."""
    return tuple(row.swing.frequency for row in gears())


def rotor_ratios() -> tuple[float, ...]:
    """Reflected rotor inertias over that at 15:1."""
    rotors = [row.rotor for row in gears() if row.ratio is not None]
    return tuple(rotor / rotors[0] for rotor in rotors)


def rotor_share(ratio: float) -> float:
    """Share of the rotor in the effective inertia at rest, by gear ratio."""
    return next(row.swing.rotor_share for row in gears() if row.ratio == ratio)


def resting_angle() -> float:
    """Where the leg stands if RA, 1 rad, is the spring's zero, in rad."""
    return equilibrium(spear_ii(), WITH_MOTOR)


def least_forces() -> tuple[float, ...]:
    """Least normal force on the toe after a release from each depth, with the motor and then without, in N."""
    return tuple(
        float(release(spear_ii(15.0 if motor_on else None), estimated(depth, motor_on), depth).force[:, 1].min())
        for motor_on in (True, False)
        for depth in DEPTHS
    )


def energy_left(depth: float = 0.10) -> float:
    """Energy of the spring at rest over that at the depth of a push, in m."""
    leg, knee = spear_ii(), WITH_MOTOR
    return ((equilibrium(leg, knee) - knee.zero) / (pushed_angle(leg, knee, depth) - knee.zero)) ** 2


def emf_at_the_joint(speed: float = SPEED) -> float:
    """Back-EMF (4.8) of the knee motor at a speed of the joint, in V."""
    return float(back_emf(motor("spear_ii_knee").known("torque_constant"), SPEAR_II.knee_ratio, speed))


def emf_at_the_rotor(speed: float = SPEED) -> float:
    """Back-EMF of the knee motor at a speed of its rotor, in V."""
    return float(back_emf(motor("spear_ii_knee").known("torque_constant"), 1.0, speed))


def no_load_speed(volts: float = 24.0) -> float:
    """Speed of the knee at which the back-EMF equals the battery, in rad/s."""
    return volts / emf_at_the_joint(1.0)


def emf_over_threshold(speed: float = SPEED) -> float:
    """Back-EMF at a speed of the joint over that from which the open bridge's diodes conduct."""
    return emf_at_the_joint(speed) / conduction_threshold(Battery(), Bridge())


def supply_difference() -> float:
    """Largest difference of the boom's height with the supply on from that with it off, in m."""
    return idling()["motor, supply on"].apart


def belt_difference() -> float:
    """Largest difference of the boom's height with the belt off from that with the motor, in m."""
    return idling()["belt taken off"].apart


def peak_emf() -> tuple[float, float]:
    """Largest back-EMF in the release, and from where on current would flow, in V."""
    case = idling()["motor, supply on"]
    return case.peak_emf, case.threshold


def shorted_over_measured(measured: float) -> float:
    """Damping by a shorted knee motor over what the motor was found to add, in N·m·s/rad."""
    machine = motor("spear_ii_knee")
    short = shorted_damping(machine.known("torque_constant"), SPEAR_II.knee_ratio, machine.known("resistance"))
    return short / measured


def recovered() -> float:
    """How far stiffness and damping are from the truth in the six synthetic sets, root mean square, in deviations."""
    errors = []
    for depth, motor_on in product(DEPTHS, (True, False)):
        found, truth = fitted(depth, motor_on), estimated(depth, motor_on)
        errors += [
            (found[name].value - getattr(truth, name)) / found[name].deviation for name in ("stiffness", "damping")
        ]
    return float(np.sqrt(np.mean(np.square(errors))))


def fits() -> tuple[float, ...]:
    """Fits of the six synthetic sets, in percent."""
    return tuple(fitted(depth, motor_on).fit for motor_on in (True, False) for depth in DEPTHS)
