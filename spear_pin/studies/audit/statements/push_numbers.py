"""Numbers of the push test for statements."""

from __future__ import annotations

from itertools import product

import numpy as np

from spear_pin.model.bridge import Battery, back_emf
from spear_pin.model.catalogue import motor
from spear_pin.studies.audit.printed_designs import SPEAR_II
from spear_pin.studies.audit.runs import estimated, fitted, gears, idling
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, equilibrium, find_pushed_angle, release, rest_at, spear_ii

SPEED = 20.0  # rad/s, of the example in Section 4.1.5.3


def first_turns(static_rest: bool = False) -> tuple[float, ...]:
    """Returns when the knee first turns after the release: without motor, then by rising gear ratio, in s."""
    return tuple(float(row.release.turns[0]) for row in gears(static_rest))


def frequencies(static_rest: bool = False) -> tuple[float, ...]:
    """Returns undamped frequencies of the small oscillation, in Hz."""
    return tuple(row.swing.frequency for row in gears(static_rest))


def rotor_ratios() -> tuple[float, ...]:
    """Returns reflected rotor inertias over that at 15:1."""
    rotors = [row.rotor for row in gears() if row.ratio is not None]
    return tuple(rotor / rotors[0] for rotor in rotors)


def rotor_share(ratio: float, static_rest: bool = False) -> float:
    """Returns the share of the rotor in the effective inertia at rest, by gear ratio."""
    return next(row.swing.rotor_share for row in gears(static_rest) if row.ratio == ratio)


def resting_angle() -> float:
    """Returns the knee angle at which the leg stands if RA, 1 rad, is the spring's zero, in rad."""
    return equilibrium(spear_ii(), WITH_MOTOR)


def least_forces(static_rest: bool = False) -> tuple[float, ...]:
    """Returns the least normal force on the toe after a release from each depth, with the motor and without, in N."""
    found = []
    for motor_on, depth in product((True, False), DEPTHS):
        leg, knee = spear_ii(15.0 if motor_on else None), estimated(depth, motor_on)
        if static_rest:
            knee = rest_at(leg, knee, knee.zero)
        found.append(float(release(leg, knee, depth).force[:, 1].min()))
    return tuple(found)


def energy_left(depth: float = 0.10, static_rest: bool = False) -> float:
    """Returns the energy of the spring at rest over that at the depth of a push, in m."""
    leg, knee = spear_ii(), WITH_MOTOR
    if static_rest:
        knee = rest_at(leg, knee, knee.zero)
    return ((equilibrium(leg, knee) - knee.zero) / (find_pushed_angle(leg, knee, depth) - knee.zero)) ** 2


def emf_at_the_joint(speed: float = SPEED) -> float:
    """Returns the back-EMF (4.8) of the knee motor at a speed of the joint, in V."""
    return float(back_emf(motor("spear_ii_knee").known("torque_constant"), SPEAR_II.knee_ratio, speed))


def emf_at_the_rotor(speed: float = SPEED) -> float:
    """Returns the back-EMF of the knee motor at a speed of its rotor, in V."""
    return float(back_emf(motor("spear_ii_knee").known("torque_constant"), 1.0, speed))


def no_load_speed(volts: float = 24.0) -> float:
    """Returns the speed of the knee at which the back-EMF equals the battery's voltage, in rad/s."""
    return volts / emf_at_the_joint(1.0)


def emf_over_battery(speed: float = SPEED) -> float:
    """Returns the back-EMF at a speed of the joint over the battery's voltage."""
    return emf_at_the_joint(speed) / Battery().voltage


def supply_difference() -> float:
    """Returns the largest difference of the boom's height between supply on and supply off, in m."""
    return idling()["motor, supply on"].apart


def belt_difference(static_rest: bool = False) -> float:
    """Returns the largest difference of the boom's height between belt off and motor on, in m."""
    return idling(static_rest)["belt taken off"].apart


def peak_emf(static_rest: bool = False) -> tuple[float, float]:
    """Returns the largest back-EMF in the release, and the battery's voltage, in V."""
    return idling(static_rest)["motor, supply off"].peak_emf, Battery().voltage


def power_if_shorted(added: float) -> float:
    """Returns the knee motor's largest power on its battery if its shorted phases brake only as much as it adds, in W.

    Shorted phases brake by N² K_v² / R. With such an R the battery gives a load at most V² / 4 R.

    Args:
        added: damping that the motor adds to the knee, in N·m·s/rad.
    """
    resistance = (SPEAR_II.knee_ratio * motor("spear_ii_knee").known("torque_constant")) ** 2 / added
    return Battery().voltage ** 2 / (4.0 * resistance)


def recovered() -> float:
    """Returns the errors of stiffness and damping in the six synthetic sets, root mean square, in deviations."""
    errors = []
    for depth, motor_on in product(DEPTHS, (True, False)):
        found, truth = fitted(depth, motor_on), estimated(depth, motor_on)
        errors += [
            (found[name].value - getattr(truth, name)) / found[name].deviation for name in ("stiffness", "damping")
        ]
    return float(np.sqrt(np.mean(np.square(errors))))


def fits() -> tuple[float, ...]:
    """Returns the fits of the six synthetic sets, in percent."""
    return tuple(fitted(depth, motor_on).fit for motor_on in (True, False) for depth in DEPTHS)
