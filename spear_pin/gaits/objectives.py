"""Objectives and motor limits of the gait search, as expressions over the nodes of a transcription."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.collocation import Programme, Solution, casadi, quadrature
from spear_pin.gaits.request import Request
from spear_pin.model.motor import Drive
from spear_pin.model.scale import Scale

MOTORS = ("posterior hip", "posterior knee", "anterior hip", "anterior knee")
SMOOTH = 1.0  # W for Q-SPEAR: width of the smoothing at the sign change of a power
OF_EFFORT, OF_COST = 0.01, 10.0  # factors that bring the objectives to order ten


def ceiling(programme: Programme, request: Request, scale: Scale) -> Any:
    """Adds the unknown that bounds every torque, or every excess over an envelope, where that is minimised."""
    if request.objective == "peak":
        return programme.variable("peak torque", 200.0, 0.0, 1000.0, 100.0, unit=scale.torque)
    if request.objective == "violation":
        return programme.variable("violation", 20.0, 0.0, 1000.0, 10.0, unit=scale.torque)
    return 0.0


def limit(programme: Programme, request: Request, scale: Scale, u: Any, v: Any, top: Any) -> None:
    """Adds bounds on torques at a node, and the motors' torque-speed envelopes."""
    for i, name in enumerate(MOTORS):
        torque, rate = u[i], v[3 + i]
        knee = "knee" in name
        if request.objective == "peak":
            for side in (1.0, -1.0):
                programme.require("peak torque", top - side * torque, 0.0, scale=100.0, unit=scale.torque)
        if not knee and request.hip_torque is not None:
            at_most(programme, f"torque of the {name} motor", torque / PAIR, request.hip_torque / PAIR, scale)
        drive = request.knee_drive if knee else request.hip_drive
        if drive is not None:
            excess = top if knee and request.objective == "violation" else 0.0
            _within(programme, scale, name, drive, torque / PAIR, rate, excess)


def at_most(programme: Programme, label: str, torque: Any, most: float, scale: Scale) -> None:
    """Requires a torque within wished bounds, in N·m."""
    programme.require(label, torque, -most, most, scale=50.0 * scale.torque, wish="N·m")


def _within(programme: Programme, scale: Scale, name: str, drive: Drive, torque: Any, rate: Any, excess: Any) -> None:
    """Bounds one motor's voltage, current and speed.

    When the motor drives, its gears take power away. Above the no-load speed, where it must brake, they help. Two lines
    go through the no-load speed. The lower line is the limit on either side of it; where the motor brakes below that
    speed, this is on the safe side.
    """
    label, unit = f"envelope of the {name} motor", scale.torque
    line = replace(drive, current_limit=None).stall_torque
    for side in (1.0, -1.0):
        for slope in (1.0, drive.gearbox.efficiency**-2):
            available = slope * line * (1.0 - side * rate / drive.no_load_speed) + excess
            programme.require(label, available - side * torque, 0.0, scale=50.0, unit=unit, wish="N·m")
        if drive.current_limit is not None:
            left = drive.stall_torque + excess - side * torque
            programme.require(label, left, 0.0, scale=50.0, unit=unit, wish="N·m")
    if drive.motor.max_speed is not None:
        most = drive.motor.max_speed / drive.gearbox.ratio
        programme.require(f"speed of the {name} motor", rate, -most, most, scale=10.0 / scale.time, wish="rad/s")


def objective(
    request: Request,
    scale: Scale,
    weight: float,
    phases: Sequence[tuple[Any, Sequence[Any]]],
    distance: Any,
    top: Any,
) -> Any:
    """Returns the objective to be minimised, of order ten whatever the robot's size.

    Args:
        request: the request, which names the objective.
        scale: scale of the robot.
        weight: weight of the robot, in N.
        phases: duration and nodes, with `u` and `v`, of each phase.
        distance: length of a stride, in m.
        top: the unknown that `ceiling` made.
    """
    even = np.ones(4)
    if request.objective == "peak":
        return 0.1 * top / scale.torque + 1e-5 * _effort(phases, even, scale) / distance
    if request.objective == "violation":
        return top / scale.torque + 1e-4 * _effort(phases, even, scale) / distance
    if request.objective == "cost_of_transport":
        return OF_COST * _power(phases, lambda power: _size(power, scale)) / (weight * distance)
    if request.objective == "electrical":
        drives = {"hip": request.hip_drive, "knee": request.knee_drive}
        return OF_COST * _electrical(phases, drives, scale) / (weight * distance)
    weights = np.array([10.0, 1.0, 10.0, 1.0]) if request.objective == "hip" else even
    return OF_EFFORT * _effort(phases, weights, scale) / distance


def in_its_unit(request: Request, scale: Scale, solution: Solution) -> float:
    """Returns the objective at a solution in the unit of `OBJECTIVES`; torques are those of one motor, two a pair."""
    if request.objective == "violation":
        return float(solution.values["violation"][0])
    if request.objective == "peak":
        return float(solution.values["peak torque"][0]) / PAIR
    if request.objective in ("cost_of_transport", "electrical"):
        return solution.objective / OF_COST
    return solution.objective / OF_EFFORT * _unit_of_effort(scale) / PAIR


def _unit_of_effort(scale: Scale) -> float:
    """Returns the factor of a squared torque times a time, over a distance."""
    return scale.torque**2 * scale.time / scale.length


def _effort(phases: Sequence[tuple[Any, Sequence[Any]]], weights: Array, scale: Scale) -> Any:
    ca = casadi()
    total = sum(quadrature(time, [ca.dot(weights, node.u * node.u) for node in nodes]) for time, nodes in phases)
    return total / _unit_of_effort(scale)


def _power(phases: Sequence[tuple[Any, Sequence[Any]]], of: Any) -> Any:
    return sum(
        quadrature(duration, [casadi().sum1(of(node.u * node.v[3:])) for node in nodes]) for duration, nodes in phases
    )


def _electrical(phases: Sequence[tuple[Any, Sequence[Any]]], drives: Mapping[str, Drive | None], scale: Scale) -> Any:
    """Returns the energy that motors draw, with heat, none given back; joints without a drive count positive work."""

    def drawn(node: Any) -> Any:
        total = 0.0
        for i, name in enumerate(MOTORS):
            power, drive = node.u[i] * node.v[3 + i], drives[name.split()[1]]
            if drive is not None:
                size, efficiency = _size(power, scale), drive.gearbox.efficiency
                driving, braking = 0.5 * (1.0 + power / size), 0.5 * (1.0 - power / size)
                # of one motor per squared torque; where it brakes, its gears help
                heat = sum(way * float(drive.joule_power(1.0, rate)) for way, rate in ((driving, 1.0), (braking, -1.0)))
                power = 0.5 * (power + size) / efficiency + 0.5 * (power - size) * efficiency
                power = power + PAIR * heat * (node.u[i] / PAIR) ** 2
            total = total + 0.5 * (power + _size(power, scale))
        return total

    return sum(quadrature(duration, [drawn(node) for node in nodes]) for duration, nodes in phases)


def _size(power: Any, scale: Scale) -> Any:
    """Returns the magnitude of a power, smooth within a watt for a robot of Q-SPEAR's size."""
    return (power * power + (SMOOTH * scale.power) ** 2) ** 0.5
