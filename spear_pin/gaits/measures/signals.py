"""What a cycle shows of its joints and toes, by derivatives or by samples; each measure is written once on it."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from functools import cached_property
from types import MappingProxyType
from typing import Any

from spear_pin.hybrid.column_names import motors_at
from spear_pin.model.motor import Drive
from spear_pin.model.robot import Robot

LEAST_STRIDE = 1e-3  # m: a shorter stride transports nothing
NOTHING: Mapping[str, Any] = MappingProxyType({})
PRESSED = 0.02  # share of a toe's even share of the weight above which friction counts


def transport(energy: Any, weight: Any, distance: Any) -> Any:
    """Returns the cost of transport: an energy over the weight and the distance covered."""
    return energy / (weight * distance)


class Signals(ABC):
    """Signals of a cycle, their integrals and peaks. Numbers are floats, or dual numbers.

    Signals have `*`, by a number or, signals of joints, by each other; those of toes are not known all the time.

    Attributes:
        robot: the robot that moves.
        section: name of the event at which the cycle closes.
        drives: drive of one motor of joints, as far as they are given.
    """

    robot: Robot
    section: str = ""
    drives: Mapping[str, Drive] = NOTHING

    @property
    @abstractmethod
    def durations(self) -> Mapping[str, Any]:
        """Duration of each phase, in s."""

    @property
    @abstractmethod
    def period(self) -> Any:
        """Duration of the cycle, in s."""

    @property
    @abstractmethod
    def stride(self) -> Any:
        """Distance covered, in m, negative backward; None for a robot that stays where it is."""

    @property
    @abstractmethod
    def weight(self) -> Any:
        """The robot's weight, in N."""

    @property
    @abstractmethod
    def torques(self) -> Mapping[str, Any]:
        """Signal of the torque of one motor of each joint, in N·m."""

    @property
    @abstractmethod
    def speeds(self) -> Mapping[str, Any]:
        """Signal of the speed of each joint with motors, in rad/s."""

    @property
    @abstractmethod
    def angles(self) -> Mapping[str, Any]:
        """Signal of the angle of each joint with motors, in rad."""

    @property
    @abstractmethod
    def forces(self) -> Mapping[str, tuple[Any, Any]]:
        """Signals of the force on each toe along the ground, and normal to it, in N."""

    # what some kinds of cycles do not tell

    @property
    def turn(self) -> Any:
        """Change of the heading, to the left, in rad."""
        return None

    @property
    def heights(self) -> Mapping[str, Any]:
        """Signal of each toe's height while it is in the air, in m."""
        return NOTHING

    @property
    def observed(self) -> Mapping[str, Any]:
        """Height of the base at events that change nothing, in m."""
        return NOTHING

    @property
    def closing(self) -> Mapping[str, tuple[Any, Any]]:
        """Angle and speed of each joint just before the cycle closes, in rad and rad/s."""
        return NOTHING

    @property
    def released(self) -> Mapping[str, Any]:
        """Least deflection of each spring as it releases, in rad or m."""
        return NOTHING

    def electricity(self, joint: str) -> Any:
        """Returns what all motors of a joint take from their supply, and what they give back, in J; None if unknown."""
        return None

    def reserve(self, joint: str) -> Any:
        """Returns the least torque that a motor has in reserve, at the joint, in N·m; None if unknown."""
        return None

    def heating(self, joint: str) -> Any:
        """Returns the heat of a joint's windings per squared torque of a motor, in W/(N·m)²; None if unknown."""
        return None

    def continuous(self, joint: str) -> Any:
        """Returns the continuous torque of a motor behind its gears, in N·m; None if unknown."""
        return self.drives[joint].continuous_torque if joint in self.drives else None

    # integrals and peaks

    @abstractmethod
    def integral(self, signal: Any) -> Any:
        """Returns ∫ of a signal over the cycle."""

    @abstractmethod
    def positive(self, signal: Any) -> Any:
        """Returns ∫ of the positive part of a signal over the cycle."""

    @abstractmethod
    def peak(self, signal: Any) -> Any:
        """Returns the largest value of a signal."""

    @abstractmethod
    def amount(self, signal: Any) -> Any:
        """Returns the largest modulus of a signal."""

    @abstractmethod
    def ratio(self, above: Any, below: Any, least: Any) -> Any:
        """Returns the largest |above / below| where the signal below is at least `least`; 0 if it never is."""

    # what follows

    @cached_property
    def squares(self) -> dict[str, Any]:
        """∫ u² dt of one motor of each joint, in N²·m²·s."""
        return {joint: self.integral(torque * torque) for joint, torque in self.torques.items()}

    @cached_property
    def net_work(self) -> Any:
        """Work of all motors, in J."""
        return sum(self.integral(power) for power in self.powers.values())

    @cached_property
    def positive_work(self) -> Any:
        """Work of all motors where they drive, in J."""
        return sum(self.positive(power) for power in self.powers.values())

    @cached_property
    def powers(self) -> dict[str, Any]:
        """Mechanical power of all motors of each joint, in W."""
        return {joint: torque * self.speeds[joint] * float(motors_at(joint)) for joint, torque in self.torques.items()}

    @property
    def pressed(self) -> Any:
        """Normal force above which a toe is loaded enough for friction to count, in N."""
        return self.weight * (PRESSED / len(self.robot.toes))

    @property
    def distance(self) -> Any:
        """Distance covered, forward or back, in m; None where it is too short for measures per distance."""
        stride = self.stride
        return None if stride is None or abs(stride) <= LEAST_STRIDE else abs(stride)
