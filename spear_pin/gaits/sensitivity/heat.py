"""Heat of windings and energy of a cycle with motors that are ideal behind gears without losses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import UnknownName
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.sensitivity.measures import Measure
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.column_names import of_a_pair
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.model.motor import Gearbox, Motor, geared_constant

Array = NDArray[np.float64]
WORK, ENERGY, HEAT = "work", "energy", "heat_"


def with_heat(
    found: Mapping[str, Measure], system: HybridSystem, motors: Mapping[str, Motor], names: Sequence[str], d: int
) -> dict[str, Measure]:
    """Measures with `heat_JOINT` of each motor, R / (N kt)² ∫ u² dt, and `energy`, the work and all heat, in J.

    Of joints without a motor here only the work counts. Gears have the robot's ratio and lose nothing: what they lose
    takes a side at rest, and needs hardware.

    Args:
        found: measures, with derivatives by d coordinates and by the parameters.
        system: the system.
        motors: of joints, by their names; a pair's joint has two.
        names: of the parameters.
        d: coordinates ahead of them.

    Raises:
        UnknownName: a joint has no motor torque.
        BadValue: a motor's resistance or torque constant is not known.
    """
    heats = dict[str, Measure]()
    for joint, motor in motors.items():
        factor, (ratio, change) = heating(system, joint, motor), _ratio(system, joint, names, d)
        rms, period = found[f"rms_torque_{joint}"], found["period"]
        heat = factor * rms.value**2 * period.value
        of_rms = 2.0 * factor * rms.value * period.value * rms.derivative
        of_rest = factor * rms.value**2 * period.derivative - 2.0 * heat / ratio * change
        heats[HEAT + joint] = Measure(heat, of_rms + of_rest, "J")
    every = [found[WORK], *heats.values()]
    total = Measure(sum(each.value for each in every), np.sum([each.derivative for each in every], axis=0), "J")
    return {**found, **heats, ENERGY: total}


def heating(system: HybridSystem, joint: str, motor: Motor) -> float:
    """Heat of a joint's windings for its torque's square, R / (N kt)², in W/(N·m)²; two motors halve a pair's.

    Raises:
        UnknownName: the joint has no motor torque.
        BadValue: the motor's resistance or torque constant is not known.
    """
    robot = system.robot
    if joint not in robot.actuated:
        raise UnknownName("joint with a motor", joint, robot.actuated)
    count = PAIR if of_a_pair(f"u_{joint}") else 1
    return motor.known("resistance") / geared_constant(motor, Gearbox(robot.gear_ratio(joint))) ** 2 / count


def _ratio(system: HybridSystem, joint: str, names: Sequence[str], d: int) -> tuple[float, Array]:
    """A joint's gear ratio, and its derivative by the parameters: it is one of them or depends on none."""
    ratio, change = system.robot.gear_ratio(joint), np.zeros(d + len(names))
    for j, name in enumerate(names):
        if name.endswith("_ratio"):
            value = number(system, name)
            other = with_numbers(system, {name: 2.0 * value}).robot.gear_ratio(joint)
            change[d + j] = (other - ratio) / value
    return ratio, change
