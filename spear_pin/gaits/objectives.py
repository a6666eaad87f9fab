"""Objectives and motor limits of the gait search, as expressions over the nodes of a transcription."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spear_pin.gaits.collocation import Programme, Solution, casadi, quadrature
from spear_pin.gaits.request import Wishes
from spear_pin.model.motor import Drive
from spear_pin.model.scale import Scale

SMOOTH = 1.0  # W for Q-SPEAR: width of the smoothing at the sign change of a power
OF_EFFORT, OF_COST = 0.01, 10.0  # factors that bring the objectives to order ten
SPARED = 10.0  # times that the hips' torques count where they are to be spared
Course = Sequence[tuple[Any, Sequence[tuple[Any, Any]]]]
"""Duration of each phase, and torques and rates of the joints at each of its nodes."""


class Costs:
    """Objective of a request, and limits of its motors.

    Args:
        programme: the programme to which they are added.
        request: the request, which names the objective.
        scale: scale of the robot.
        motors: row among the joints of each motor, by leg and part.
    """

    def __init__(
        self, programme: Programme, request: Wishes, scale: Scale, motors: Mapping[tuple[str, str], int]
    ) -> None:
        self.programme, self.request, self.scale, self.motors = programme, request, scale, motors
        self.pair = pair = request.legs
        self.drives = {"hip": request.hip_drive, "knee": request.knee_drive}
        # bounds every torque, or every excess over an envelope, where that is minimised
        self.top: Any = 0.0
        if request.objective == "peak":
            self.top = programme.variable("peak torque", 100.0 * pair, 0.0, 500.0 * pair, 100.0, unit=scale.torque)
        if request.objective == "violation":
            self.top = programme.variable("violation", 20.0, 0.0, 1000.0, 10.0, unit=scale.torque)

    def limit(self, u: Any, rates: Any) -> None:
        """Adds bounds on torques at a node, and the motors' torque-speed envelopes."""
        request, unit = self.request, self.scale.torque
        for (leg, part), row in self.motors.items():
            name, torque, rate = f"{leg} {part}", u[row], rates[row]
            if request.objective == "peak":
                for side in (1.0, -1.0):
                    self.programme.require("peak torque", self.top - side * torque, 0.0, scale=100.0, unit=unit)
            if part == "hip" and request.hip_torque is not None:
                label, most = f"torque of the {name} motor", request.hip_torque / self.pair
                at_most(self.programme, label, torque / self.pair, most, self.scale)
            if (drive := self.drives.get(part)) is not None:
                excess = self.top if part == "knee" and request.objective == "violation" else 0.0
                self._within(name, drive, torque / self.pair, rate, excess)

    def _within(self, name: str, drive: Drive, torque: Any, rate: Any, excess: Any) -> None:
        """Bounds one motor's voltage, current and speed.

        When the motor drives, its gears take power away. Above the no-load speed, where it must brake, they help. Two
        lines go through the no-load speed. The lower line is the limit on either side of it; where the motor brakes
        below that speed, this is on the safe side.
        """
        label, unit, programme = f"envelope of the {name} motor", self.scale.torque, self.programme
        line = replace(drive, current_limit=None).stall_torque
        for side in (1.0, -1.0):
            for slope in (1.0, drive.gearbox.efficiency**-2):
                available = slope * line * (1.0 - side * rate / drive.no_load_speed) + excess
                programme.require(label, available - side * torque, 0.0, scale=50.0, unit=unit, wish="N·m")
            if drive.current_limit is not None:
                left = drive.stall_torque + excess - side * torque
                programme.require(label, left, 0.0, scale=50.0, unit=unit, wish="N·m")
        if drive.motor.max_speed is not None:
            most, label = drive.motor.max_speed / drive.gearbox.ratio, f"speed of the {name} motor"
            programme.require(label, rate, -most, most, scale=10.0 / self.scale.time, wish="rad/s")

    def of(self, course: Course, weight: float, distance: Any) -> Any:
        """Returns the objective to be minimised, of order ten whatever the robot's size.

        Args:
            course: the course of torques and rates.
            weight: weight of the robot, in N.
            distance: distance travelled in the course, in m.
        """
        ca, asked, torque = casadi(), self.request.objective, self.scale.torque
        weights = np.ones(len(self.motors))
        if asked == "hip":
            weights[[row for (_, part), row in self.motors.items() if part == "hip"]] = SPARED
        if asked == "cost_of_transport":
            return OF_COST * _integral(course, lambda u, v: ca.sum1(self._size(u * v))) / (weight * distance)
        if asked == "electrical":
            return OF_COST * _integral(course, self._drawn) / (weight * distance)
        effort = _integral(course, lambda u, v: ca.dot(weights, u * u)) / (_unit_of_effort(self.scale) * distance)
        if asked in ("peak", "violation"):
            return (0.1 if asked == "peak" else 1.0) * self.top / torque + (1e-5 if asked == "peak" else 1e-4) * effort
        return OF_EFFORT * effort

    def _drawn(self, u: Any, v: Any) -> Any:
        """Returns the power that motors draw, with heat, none given back; without a drive positive power."""
        total = 0.0
        for (_, part), row in self.motors.items():
            power, drive = u[row] * v[row], self.drives.get(part)
            if drive is not None:
                size, efficiency = self._size(power), drive.gearbox.efficiency
                driving, braking = 0.5 * (1.0 + power / size), 0.5 * (1.0 - power / size)
                # of one motor per squared torque; where it brakes, its gears help
                heat = sum(way * float(drive.joule_power(1.0, rate)) for way, rate in ((driving, 1.0), (braking, -1.0)))
                power = 0.5 * (power + size) / efficiency + 0.5 * (power - size) * efficiency
                power = power + self.pair * heat * (u[row] / self.pair) ** 2
            total = total + 0.5 * (power + self._size(power))
        return total

    def _size(self, power: Any) -> Any:
        """Returns the magnitude of a power, smooth within a watt for a robot of Q-SPEAR's size."""
        return (power * power + (SMOOTH * self.scale.power) ** 2) ** 0.5


def at_most(programme: Programme, label: str, torque: Any, most: float, scale: Scale) -> None:
    """Requires a torque within wished bounds, in N·m."""
    programme.require(label, torque, -most, most, scale=50.0 * scale.torque, wish="N·m")


def in_its_unit(request: Wishes, scale: Scale, solution: Solution) -> float:
    """Returns the objective at a solution in the unit of `OBJECTIVES`; torques are those of one motor."""
    if request.objective == "violation":
        return float(solution.values["violation"][0])
    if request.objective == "peak":
        return float(solution.values["peak torque"][0]) / request.legs
    if request.objective in ("cost_of_transport", "electrical"):
        return solution.objective / OF_COST
    return solution.objective / OF_EFFORT * _unit_of_effort(scale) / request.legs


def _unit_of_effort(scale: Scale) -> float:
    """Returns the factor of a squared torque times a time, over a distance."""
    return scale.torque**2 * scale.time / scale.length


def _integral(course: Course, of: Any) -> Any:
    return sum(quadrature(duration, [of(*node) for node in nodes]) for duration, nodes in course)
