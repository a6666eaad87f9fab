"""How well a collocated gait obeys mechanics between its nodes, by Pinocchio, which the optimisation does not use."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.footfalls.course import CollocatedGait, Stretch
from spear_pin.gaits.footfalls.limbs import legs_of
from spear_pin.model.chain import CHAIN

BASE = len(CHAIN)
FINER = 8  # parts of an interval


@dataclass(frozen=True)
class Violations:
    """Largest violations between the nodes of a collocated gait.

    Attributes:
        motion: missing force of the torso's motion, over the weight.
        turning: missing torque on the torso, over weight times leg length.
        velocity: largest difference between a joint's velocity and the rate of its angle, in rad/s.
        slip: largest distance of a foot on the ground from where it landed, in m.
        depth: largest depth of a foot in the air below the ground, in m.
        friction: largest excess of the used coefficient of friction over the allowed one.
        torque: largest excess of a motor's torque over its limit, in N·m.
    """

    motion: float
    turning: float
    velocity: float
    slip: float
    depth: float
    friction: float
    torque: float


def violations(gait: CollocatedGait, finer: int = FINER) -> Violations:
    """Returns the largest violations on a grid that is `finer` times finer than the intervals.

    In an interval forces and accelerations are parabolas through its nodes, and velocities and configurations are
    cubics, as in Hermite-Simpson collocation.
    """
    robot, limbs = gait.robot, legs_of(gait.robot)
    weight = robot.weight
    length = float(np.mean([sum(limb.lengths) for limb in limbs.values()]))
    limits = np.array([robot.limits[name].effort for name in robot.coordinates[BASE:]])
    worst = dict.fromkeys(Violations.__dataclass_fields__, 0.0)
    for stretch in gait.stretches:
        landed = {leg: robot.toe_position(stretch.q[0], limbs[leg].toe) for leg in stretch.bearing}
        for q, rate, v, a, u, forces in _between(stretch, finer):
            lacking = robot.mass_matrix(q) @ a + robot.bias(q, v)
            for leg, force in forces.items():
                toe = limbs[leg].toe
                lacking = lacking - robot.toe_jacobian(q, toe).T @ force
                off = robot.toe_position(q, toe) - landed[leg]
                _grow(worst, "slip", float(np.linalg.norm(off)))
                used = float(np.hypot(*force[:2]) / max(force[2], 1e-3 * weight))
                _grow(worst, "friction", used - gait.request.friction)
            _grow(worst, "motion", float(np.abs(lacking[:3]).max()) / weight)
            _grow(worst, "turning", float(np.abs(lacking[3:BASE]).max()) / (weight * length))
            _grow(worst, "velocity", float(np.abs(rate - v)[3:].max()))
            _grow(worst, "torque", float((np.abs(u) - limits).max()))
            for limb in (limb for name, limb in limbs.items() if name not in stretch.bearing):
                _grow(worst, "depth", -float(robot.toe_position(q, limb.toe)[2]))
    return Violations(**worst)


def _grow(worst: dict[str, float], name: str, value: float) -> None:
    worst[name] = max(worst[name], value)


def _between(stretch: Stretch, finer: int) -> Iterator[tuple[Array, Array, Array, Array, Array, dict[str, Array]]]:
    """Returns configuration, its rate, velocity, acceleration, torques and forces at parts of each interval."""
    step = stretch.duration / ((len(stretch.t) - 1) // 2)
    for k in range(0, len(stretch.t) - 2, 2):
        for part in np.arange(finer + 1) / finer:
            rate, a, u = (_parabola(each[k : k + 3], part) for each in (stretch.v, stretch.a, stretch.u))
            q, v = (
                whole[k] + step * _integral(slope[k : k + 3], part)
                for whole, slope in ((stretch.q, stretch.v), (stretch.v, stretch.a))
            )
            yield q, rate, v, a, u, {leg: _parabola(F[k : k + 3], part) for leg, F in stretch.forces.items()}


def _parabola(values: Array, s: float) -> Array:
    """Returns the parabola through values at 0, 1/2 and 1."""
    first, middle, last = values
    found: Array = first + s * (-3.0 * first + 4.0 * middle - last) + 2.0 * s * s * (first - 2.0 * middle + last)
    return found


def _integral(values: Array, s: float) -> Array:
    """Returns the integral of that parabola from 0."""
    first, middle, last = values
    square = 0.5 * s * s * (-3.0 * first + 4.0 * middle - last)
    found: Array = s * first + square + 2.0 / 3.0 * s**3 * (first - 2.0 * middle + last)
    return found
