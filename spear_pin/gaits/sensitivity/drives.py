"""Motors and drives of joints, whose gears and sizes may vary: heat in windings, continuous torques."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.dual import Dual
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.model.catalogue import size_motor
from spear_pin.model.motor import Drive, Motor
from spear_pin.model.robot import Robot
from spear_pin.model.variants import SIZE, motor_size


class Behind(NamedTuple):
    """A drive behind a joint.

    Attributes:
        drive: the drive of each motor.
        motors: number of motors that share the joint's torque.
        constant: N kt with the robot's ratio, in N·m/A.
        resistance: resistance of a motor of the robot's size, in Ω.
    """

    drive: Drive
    motors: int
    constant: Dual
    resistance: Dual


@dataclass(frozen=True)
class DrivenJoints:
    """Motors and drives of joints; gears have the robot's ratio, and motors that are given are those of size 1.

    Gears of a `Motor` lose nothing, those of a `Drive` have its efficiency.

    Attributes:
        system: the system.
        motors: motors or drives by the names of their joints; a joint in a pair of legs has two.
        names: names of the parameters.
        d: number of coordinates ahead of the parameters.
    """

    system: HybridSystem
    motors: Mapping[str, Motor | Drive]
    names: Sequence[str]
    d: int

    def heat(self, joint: str) -> Dual | None:
        """Returns the heat of a joint's windings per squared torque of a motor, R / (N kt)² each, in W/(N·m)².

        It is None for a drive.

        Raises:
            BadValue: the motor's resistance or torque constant is not known.
        """
        motor = self.motors.get(joint)
        if not isinstance(motor, Motor):
            return None
        constant, resistance = self._electric(joint, motor)
        heating: Dual = motors_at(joint) * resistance / (constant * constant)
        return heating

    def continuous(self, joint: str) -> Dual | None:
        """Returns a motor's continuous torque behind its gears, in N·m; None where it is not known."""
        each = self.motors.get(joint)
        motor, share = (each.motor, each.gearbox.efficiency) if isinstance(each, Drive) else (each, 1.0)
        if motor is None or motor.nominal_torque is None and motor.nominal_current is None:
            return None
        ratio, size = self.gears(joint)
        torque: Dual = share * size_motor(motor, float(size.x)).continuous_torque / size.x * (ratio * size)
        return torque

    def behind(self, joint: str) -> Behind | None:
        """Returns the drive behind a joint; None where there is none.

        Raises:
            BadValue: the motor's resistance or torque constant is not known.
        """
        drive = self.motors.get(joint)
        if not isinstance(drive, Drive):
            return None
        return Behind(drive, motors_at(joint), *self._electric(joint, drive.motor))

    def _electric(self, joint: str, motor: Motor) -> tuple[Dual, Dual]:
        """Returns N kt, in N·m/A, and the resistance, in Ω, of a motor behind a joint."""
        kt, (ratio, size) = motor.known("torque_constant"), self.gears(joint)
        return ratio * kt, size_motor(motor, float(size.x)).known("resistance") * size.x / size

    def gears(self, joint: str) -> tuple[Dual, Dual]:
        """Returns a joint's gear ratio and size of motor, with derivatives by the parameters."""

        def of(robot: Robot) -> Array:
            return np.array([robot.gear_ratio(joint), motor_size(robot, joint)])

        found, change = of(self.system.robot), np.zeros((2, self.d + len(self.names)))
        for j, name in enumerate(self.names):
            if name.endswith(("_ratio", SIZE)):  # of which they are multiples
                value = number(self.system, name)
                there = of(with_numbers(self.system, {name: 2.0 * value}).robot)
                change[:, self.d + j] = (there - found) / value
        return Dual(found[0], change[0]), Dual(found[1], change[1])


def check_gears(system: HybridSystem, motors: Mapping[str, Motor | Drive]) -> None:
    """Refuses drives with gears other than the robot's.

    Raises:
        BadValue: a ratio differs from the robot's.
        UnknownName: a joint has no motor torque.
    """
    for joint, each in motors.items():
        if isinstance(each, Drive) and not math.isclose(each.gearbox.ratio, system.robot.gear_ratio(joint)):
            expected = (
                f"{system.robot.gear_ratio(joint):g}, as the robot has; change it there: vary(robot, {joint}_ratio=...)"
            )
            raise BadValue(f"ratio of the drive of {joint}", each.gearbox.ratio, expected)
        if joint not in system.robot.actuated:
            raise UnknownName("joint with a motor", joint, system.robot.actuated)
