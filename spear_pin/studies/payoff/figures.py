"""Figures of a gait with its motors: its cost, the load on its joints, its stability."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.robot import Robot
from spear_pin.studies.design import against, joints_of, motors_of, points_of
from spear_pin.studies.payoff.motors import PARTS, Motors

KINDS = {"peak": "peak_torque", "rms": "rms_torque", "heat": "heating", "rate": "peak_speed"}  # of measures of joints


@dataclass(frozen=True)
class Figures:
    """Figures of a gait, of one cycle of its simulation, as of the catalogue of measures; joints by their names.

    Attributes:
        stiffness: stiffness of a leg's spring, in N·m/rad, or N/m along a path whose length is in m.
        speed: mean forward speed, in m/s; for a hop in place its flight time, in s.
        cost: electricity that knees and hips draw over the work to which the cost refers, with no storage of returned
            energy; for a bound the cost of transport.
        shares: share of the cost, by part.
        mechanical: the same for |motor power|.
        peak: `peak_torque_JOINT`, in N·m.
        rms: `rms_torque_JOINT`, in N·m.
        heat: `heating_JOINT`.
        rate: `peak_speed_JOINT`, in rad/s.
        torque_used: peak torque over the limit in the robot's file; None where it has none.
        rate_used: the same for the joint speed.
        outside: share of the cycle in which a motor is outside its torque-speed envelope.
        friction: `friction_used`.
        durations: in s, by phase.
        multiplier: modulus of the largest Floquet multiplier.
        residual: residual of the fixed point.
        ledger: gap of the energy ledger over the energy that the motors draw.
        held: bounds of the search that are active at the gait, in words.
        starts: number of starts of the search that ended at this cost.
        chosen: numbers of the robot, law or spring that a study also let the search choose, by name.
    """

    stiffness: float
    speed: float
    cost: float
    shares: Mapping[str, float]
    mechanical: float
    peak: Mapping[str, float]
    rms: Mapping[str, float]
    heat: Mapping[str, float]
    rate: Mapping[str, float]
    torque_used: Mapping[str, float | None]
    rate_used: Mapping[str, float | None]
    outside: float
    friction: float
    durations: Mapping[str, float]
    multiplier: float
    residual: float
    ledger: float
    held: tuple[str, ...]
    starts: int = 1
    chosen: Mapping[str, float] = field(default_factory=dict)


@typed
def figures(
    gait: Gait,
    motors: Motors,
    trajectory: Trajectory,
    *,
    work: float,
    speed: float,
    held: tuple[str, ...] = (),
    starts: int = 1,
) -> Figures:
    """Returns figures of a gait from the event-exact simulation of one cycle.

    Args:
        gait: the gait.
        motors: motors that drive it.
        trajectory: trajectory of one cycle.
        work: work to which the cost refers, in J.
        speed: mean forward speed, in m/s; for a hop in place its flight time, in s.
        held: bounds of the search that are active at the gait, in words.
        starts: number of starts of the search that ended at this cost.
    """
    robot = gait.system.robot
    joints = {part: joints_of(robot, part) for part in PARTS}
    drives = {joint: getattr(motors, part) for part in PARTS for joint in joints[part]}
    sampled = Sampled(robot, trajectory, drives=drives)
    taken = sampled.of("electricity")
    shares = {part: sum(taken[joint] for joint in joints[part]) / work for part in PARTS}
    by_joint = {name: {joint: sampled.of(kind)[joint] for joint in drives} for name, kind in KINDS.items()}
    cost = sum(shares.values())
    return Figures(
        stiffness=gait.system.spring.stiffness / motors_of(robot),
        speed=speed,
        cost=cost,
        shares=shares,
        mechanical=sampled.largest("absolute_work") / work,
        **by_joint,
        torque_used=_used(robot, by_joint["peak"], "effort", motors_of(robot)),
        rate_used=_used(robot, by_joint["rate"], "velocity", 1),
        outside=max(
            float(against(points_of(robot, trajectory, part), getattr(motors, part)).outside.max()) for part in PARTS
        ),
        friction=sampled.largest("friction_used"),
        durations=dict(gait.durations),
        multiplier=float(abs(gait.multipliers[0])),
        residual=gait.residual,
        ledger=float(np.abs(trajectory.ledger.residual).max()) / (cost * work),
        held=held,
        starts=starts,
    )


def most(values: Mapping[str, float], part: str) -> float:
    """Returns the largest of the values of knees or hips."""
    return max(value for joint, value in values.items() if joint.endswith(part))


def _used(robot: Robot, values: Mapping[str, float], limit: str, motors: int) -> dict[str, float | None]:
    """Returns values over the limits of a robot's file; a torque is that of a joint's motors together."""
    limits = {joint: getattr(robot.limits[joint], limit) for joint in values}
    return {
        joint: motors * value / limits[joint] if 0.0 < limits[joint] < UNKNOWN else None
        for joint, value in values.items()
    }
