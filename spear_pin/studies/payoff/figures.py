"""Figures of a gait with its motors: what it costs, what its joints bear, how steady it is."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spear_pin.gaits.bounding_law import LEGS, PAIR
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.request import Request
from spear_pin.hybrid.simulate import simulate
from spear_pin.kinds import typed
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.robot import Robot
from spear_pin.studies.bound import summarize, weight
from spear_pin.studies.design import against, energy_drawn, points_of
from spear_pin.studies.payoff.motors import PARTS, Motors

AT = 0.02  # of a bound of the request's: a gait that near is held by it


@dataclass(frozen=True)
class Figures:
    """Figures of a gait, of one stride of its simulation. Torques are those of one motor; joints by their names.

    Attributes:
        stiffness: of a leg's spring, in N·m/rad.
        speed: mean forward speed, in m/s.
        cost: electrical cost of transport, knees and hips, nothing stored of what is given back.
        shares: of it, by part.
        mechanical: cost of transport of |motor power|.
        peak: largest torque, in N·m.
        rms: root mean square of the torque, in N·m.
        heat: rms torque over the drive's continuous torque.
        rate: largest joint speed, in rad/s.
        torque_used: peak torque over the limit in the robot's file; None where it has none.
        rate_used: the same of the joint speed.
        outside: share of the stride in which a motor is outside its torque-speed envelope.
        friction: largest share of normal force in stance that friction takes.
        durations: in s, by phase.
        multiplier: modulus of the largest Floquet multiplier.
        residual: of the fixed point.
        ledger: what the energy ledger does not close by, over what the motors draw.
        held: bounds of the request at which the gait is, in words.
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


@typed
def figures(gait: Gait, motors: Motors, request: Request) -> Figures:
    """Figures of a gait that was searched for, from the event-exact simulation of one stride.

    Args:
        gait: a bounding gait.
        motors: that drive it.
        request: what was asked, for the bounds that the gait keeps to.
    """
    robot = gait.system.robot
    trajectory = simulate(gait.system, gait.state, progress=False)
    said = summarize(gait, trajectory)
    work = weight(robot) * said["stride"]
    shares: dict[str, float] = {}
    by_joint: dict[str, dict[str, float]] = {name: {} for name in ("peak", "rms", "heat", "rate")}
    outside = 0.0
    for part in PARTS:
        given, drive = points_of(robot, trajectory, part), getattr(motors, part)
        shares[part] = energy_drawn(given, drive) / work
        use = against(given, drive)
        outside = max(outside, float(use.outside.max()))
        columns = {
            "peak": np.abs(given.torque).max(axis=0),
            "rms": given.rms,
            "heat": use.heating,
            "rate": np.abs(given.speed).max(axis=0),
        }
        for name, values in columns.items():
            by_joint[name] |= {f"{leg}_{part}": float(value) for leg, value in zip(LEGS, values, strict=True)}
    cost = sum(shares.values())
    return Figures(
        stiffness=gait.system.spring.stiffness / PAIR,
        speed=said["speed"],
        cost=cost,
        shares=shares,
        mechanical=said["cost_of_transport"],
        **by_joint,
        torque_used=_used(robot, by_joint["peak"], "effort", PAIR),
        rate_used=_used(robot, by_joint["rate"], "velocity", 1),
        outside=outside,
        friction=said["friction_used"],
        durations=dict(gait.durations),
        multiplier=float(abs(gait.multipliers[0])),
        residual=gait.residual,
        ledger=said["energy_residual"] / (cost * work),
        held=_held(gait, request, said),
    )


def _used(robot: Robot, values: Mapping[str, float], limit: str, motors: int) -> dict[str, float | None]:
    """Values over the limits of a robot's file; of a torque those of a joint's motors together."""
    limits = {joint: getattr(robot.limits[joint], limit) for joint in values}
    return {
        joint: motors * value / limits[joint] if 0.0 < limits[joint] < UNKNOWN else None
        for joint, value in values.items()
    }


def _held(gait: Gait, request: Request, said: Mapping[str, object]) -> tuple[str, ...]:
    """Bounds that the request set and that the gait is at."""
    found = []
    for leg in LEGS:
        if gait.durations[f"{leg}_stance"] <= (1.0 + AT) * request.minimum_stance:
            found.append(f"the {leg} stance is as short as it may be")
        if getattr(gait.system.law, f"{leg}_knee_torque") <= (1.0 + AT) * request.minimum_knee_torque:
            found.append(f"the {leg} knee's torque at rest is the least allowed")
    used = said["friction_used"]
    if isinstance(used, float) and used >= (1.0 - 2 * AT) * request.friction:
        found.append("friction is used up")
    return tuple(found)
