"""Numbers of the push test that statements ask for."""

from __future__ import annotations

from itertools import product

import numpy as np

from spear_pin.model.bridge import Battery, back_emf
from spear_pin.model.catalogue import motor
from spear_pin.studies.audit.printed_designs import SPEAR_II
from spear_pin.studies.audit.runs import estimated, fitted, gears, idling
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, equilibrium, pushed_angle, release, resting_at, spear_ii

SPEED = 20.0  # rad/s, of the example in Section 4.1.5.3
RATED = motor("spear_ii_knee").known("rated_power")  # W, Section 2.4.1


def first_turns(static_rest: bool = False) -> tuple[float, ...]:
    """When the knee first turns after the release: without motor, then by rising gear ratio, in s."""
    return tuple(float(row.release.turns[0]) for row in gears(static_rest))


def frequencies(static_rest: bool = False) -> tuple[float, ...]:
    """Of the small oscillation, undamped, in Hz."""
    return tuple(row.swing.frequency for row in gears(static_rest))


def rotor_ratios() -> tuple[float, ...]:
    """Reflected rotor inertias over that at 15:1."""
    rotors = [row.rotor for row in gears() if row.ratio is not None]
    return tuple(rotor / rotors[0] for rotor in rotors)


def rotor_share(ratio: float, static_rest: bool = False) -> float:
    """Share of the rotor in the effective inertia at rest, by gear ratio."""
    return next(row.swing.rotor_share for row in gears(static_rest) if row.ratio == ratio)


def resting_angle() -> float:
    """Knee angle at which the leg stands if RA, 1 rad, is the spring's zero, in rad."""
    return equilibrium(spear_ii(), WITH_MOTOR)


def least_forces(static_rest: bool = False) -> tuple[float, ...]:
    """Least normal force on the toe after a release from each depth, with the motor and then without, in N."""
    found = []
    for motor_on, depth in product((True, False), DEPTHS):
        leg, knee = spear_ii(15.0 if motor_on else None), estimated(depth, motor_on)
        if static_rest:
            knee = resting_at(leg, knee, knee.zero)
        found.append(float(release(leg, knee, depth).force[:, 1].min()))
    return tuple(found)


def energy_left(depth: float = 0.10, static_rest: bool = False) -> float:
    """Energy of the spring at rest over that at the depth of a push, in m."""
    leg, knee = spear_ii(), WITH_MOTOR
    if static_rest:
        knee = resting_at(leg, knee, knee.zero)
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


def emf_over_battery(speed: float = SPEED) -> float:
    """Back-EMF at a speed of the joint over the battery's voltage."""
    return emf_at_the_joint(speed) / Battery().voltage


def supply_difference() -> float:
    """Largest difference of the boom's height with the supply on from that with it off, in m."""
    return idling()["motor, supply on"].apart


def belt_difference(static_rest: bool = False) -> float:
    """Largest difference of the boom's height with the belt off from that with the motor, in m."""
    return idling(static_rest)["belt taken off"].apart


def peak_emf(static_rest: bool = False) -> tuple[float, float]:
    """Largest back-EMF in the release, and the battery's voltage, in V."""
    return idling(static_rest)["motor, supply off"].peak_emf, Battery().voltage


def power_if_shorted(added: float) -> float:
    """Most that the knee motor could give on its battery if its shorted phases braked no more than it adds, in W.

    Shorted, they brake by N² K_v² / R; with such an R the battery drives no more than V² / 4 R into a load.

    Args:
        added: damping of the knee that the motor adds, in N·m·s/rad.
    """
    resistance = (SPEAR_II.knee_ratio * motor("spear_ii_knee").known("torque_constant")) ** 2 / added
    return Battery().voltage ** 2 / (4.0 * resistance)


def recovered() -> float:
    """Errors of stiffness and damping in the six synthetic sets, root mean square, in deviations."""
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
