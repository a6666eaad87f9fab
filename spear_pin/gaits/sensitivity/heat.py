"""Heat in windings, and energy of a cycle with ideal motors behind gears without losses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.gaits.sensitivity.measure import DualMeasure, Group, total
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.model.catalogue import size_motor
from spear_pin.model.motor import Drive, Gearbox, Motor, gear_constant
from spear_pin.model.robot import Robot
from spear_pin.model.variants import SIZE, motor_size

WORK, ENERGY, HEAT, HEATING = "work", "energy", "heat_", "heating_"


def heat(system: HybridSystem, motors: Mapping[str, Motor], names: Sequence[str], d: int) -> Group:
    """Returns the measures `heat_JOINT`, R / (N kt)² ∫ u² dt of a joint's motors, and `energy`, work plus heat, in J.

    A joint without a motor here adds only its work. Gears have the robot's ratio and lose nothing; see `electricity`
    for drives with losses in gears. The motors given are those of size 1.

    Args:
        system: the system.
        motors: motors by the names of their joints; a joint in a pair of legs has two.
        names: names of the parameters.
        d: number of coordinates ahead of the parameters.

    Raises:
        UnknownName: when a measure is found, if its joint has no motor torque.
        BadValue: when a measure is found, if a motor's resistance or torque constant is not known.
    """

    def found(of: Mapping[str, DualMeasure]) -> dict[str, DualMeasure]:
        heats = {HEAT + joint: _heat(of, system, joint, motor, names, d) for joint, motor in motors.items()}
        return {**heats, ENERGY: total([of[WORK], *heats.values()])}

    return Group(f"{HEAT}.*|{ENERGY}", found)


def _heat(
    of: Mapping[str, DualMeasure], system: HybridSystem, joint: str, motor: Motor, names: Sequence[str], d: int
) -> DualMeasure:
    factor, ((ratio, size), (of_ratio, of_size)) = find_heating(system, joint, motor), drive_of(system, joint, names, d)
    rms, period = of[f"rms_torque_{joint}"], of["period"]
    value = factor * rms.value**2 * period.value
    of_rms = 2.0 * factor * rms.value * period.value * rms.derivative
    of_rest = factor * rms.value**2 * period.derivative - value * (2.0 * of_ratio / ratio + of_size / size)
    return DualMeasure(value, of_rms + of_rest, "J")


def heatings(system: HybridSystem, motors: Mapping[str, Motor | Drive], names: Sequence[str], d: int) -> Group:
    """Returns the measures `heating_JOINT`, a motor's rms torque over its continuous torque, both behind the gears.

    A motor of which the continuous torque is not known has none. The arguments are those of `heat`.
    """

    def found(of: Mapping[str, DualMeasure]) -> dict[str, DualMeasure]:
        heatings = {}
        for joint, each in motors.items():
            one, share = (each.motor, each.gearbox.efficiency) if isinstance(each, Drive) else (each, 1.0)
            if one.nominal_torque is not None or one.nominal_current is not None:
                (ratio, size), (of_ratio, of_size) = drive_of(system, joint, names, d)
                rms, most = of[f"rms_torque_{joint}"], share * ratio * size_motor(one, float(size)).continuous_torque
                change = rms.derivative - rms.value * (of_ratio / ratio + of_size / size)
                heatings[HEATING + joint] = DualMeasure(rms.value / most, change / most, "1")
        return heatings

    return Group(f"{HEATING}.*", found)


def find_heating(system: HybridSystem, joint: str, motor: Motor) -> float:
    """Returns the heat of a joint's windings per squared torque of a motor, R / (N kt)² each, in W/(N·m)².

    Raises:
        UnknownName: the joint has no motor torque.
        BadValue: the motor's resistance or torque constant is not known.
    """
    count, gears = motors_of_joint(system, joint), Gearbox(system.robot.gear_ratio(joint))
    there = size_motor(motor, motor_size(system.robot, joint))
    return there.known("resistance") / gear_constant(there, gears) ** 2 * count


def motors_of_joint(system: HybridSystem, joint: str) -> int:
    """Returns how many motors share a joint's torque: two in a pair of legs.

    Raises:
        UnknownName: the joint has no motor torque.
    """
    if joint not in system.robot.actuated:
        raise UnknownName("joint with a motor", joint, system.robot.actuated)
    return motors_at(joint)


def drive_of(system: HybridSystem, joint: str, names: Sequence[str], d: int) -> tuple[Array, Array]:
    """Returns a joint's gear ratio and size of motor, (2,), and their derivatives by the parameters, (2, d + m)."""

    def of(robot: Robot) -> Array:
        return np.array([robot.gear_ratio(joint), motor_size(robot, joint)])

    found, change = of(system.robot), np.zeros((2, d + len(names)))
    for j, name in enumerate(names):
        if name.endswith(("_ratio", SIZE)):  # of which they are multiples
            value = number(system, name)
            change[:, d + j] = (of(with_numbers(system, {name: 2.0 * value}).robot) - found) / value
    return found, change
