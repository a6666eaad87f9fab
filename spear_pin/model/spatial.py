"""The dynamics of a robot in space, written once for arrays and for symbols.

It computes the forces that a motion needs by recursive Newton-Euler, D by composite bodies, and the motion of each toe,
for scalars of any kind that has +, -, * and a sine and cosine: numbers, NumPy arrays (a whole batch of states at once),
SymPy, CasADi, heyoka. Every number is read from the robot's `pinocchio.Model`. Vectors of a body are in its own axes.
Toes of a robot that goes round a post have the directions of `directions.Round`.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import islice
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue
from spear_pin.model.directions import Round
from spear_pin.model.mechanism import NO_FORCES, Feet, Mechanism, Terms, Toe
from spear_pin.model.path import Point
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import ANYWHERE, Parts
from spear_pin.model.scalars import dot, negate, plus, times, vanishes
from spear_pin.model.vectors import (
    UPRIGHT,
    ZERO,
    Rows,
    Vector,
    add,
    cross,
    floats_of,
    matrix_of,
    multiply,
    rotate,
    rotate_back,
    rotation,
    scale,
    subtract,
    transpose,
)


@dataclass(frozen=True)
class Body:
    """A joint of one coordinate and the rigid body that it moves, in the joint's frame.

    Attributes:
        parent: number of the body it hangs on, -1 for the world.
        turned: axes of the parent's frame in which the joint stands, rows of the matrix that takes a vector in the
            joint's axes at zero to the parent's.
        placement: position of the joint in the parent, in m.
        axis: unit vector about which it turns or along which it slides.
        turns: whether it turns.
        mass: mass, in kg.
        moment: mass times the centre of mass, in kg·m.
        inertia: about the joint, rows in kg·m².
        armature: rotor inertia reflected to the joint, in kg·m² (or kg).
    """

    parent: int
    turned: Rows
    placement: Vector
    axis: Vector
    turns: bool
    mass: float
    moment: Vector
    inertia: Rows
    armature: float

    @property
    def numbers(self) -> tuple[Any, ...]:
        """Mass, first moment, inertia (one of each two entries that are equal), rotor and placement."""
        (xx, xy, xz), (_, yy, yz), (_, _, zz) = self.inertia
        return self.mass, *self.moment, xx, xy, xz, yy, yz, zz, self.armature, *self.placement

    def with_numbers(self, left: Iterator[Any]) -> Body:
        """Returns the body with the next of some numbers, in the order of `numbers`."""
        mass, moment, (xx, xy, xz, yy, yz, zz) = next(left), tuple(islice(left, 3)), islice(left, 6)
        inertia = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
        armature, placement = next(left), tuple(islice(left, 3))
        return replace(self, mass=mass, moment=moment, inertia=inertia, armature=armature, placement=placement)


class Spatial(Mechanism):
    """The dynamics in space of a robot, for any scalars.

    Args:
        robot: a robot whose joints have one coordinate each and turn or slide, such as
            `load("q_spear_full", base="chain")`.

    Raises:
        BadValue: the robot has a joint of several coordinates, or one that neither turns nor slides.

    Example:
        >>> import math
        >>> from spear_pin import load
        >>> from spear_pin.model.spatial import Spatial
        >>> robot = load("q_spear_full", base="chain")
        >>> still = [0.0] * robot.nv
        >>> forces = Spatial(robot).forces(still, still, still, math)
        >>> round(forces[2] / robot.mass, 2)  # what holds it up, in N/kg
        9.81
    """

    def __init__(self, robot: Robot) -> None:
        if robot.nq != robot.nv or robot.nv != robot.model.njoints - 1 or robot.added is not None:
            raise BadValue("robot", robot, 'one whose joints have one coordinate each, load(..., base="chain")')
        bodies = (_body(robot, joint) for joint in range(1, robot.model.njoints))
        placements = (frame.placement for frame in robot.model.frames)
        places = ((floats_of(each.translation), matrix_of(each.rotation)) for each in placements)
        super().__init__(robot, bodies, floats_of(-robot.model.gravity.linear), places)
        self.circle = robot.directions if isinstance(robot.directions, Round) else None

    def terms(self, q: Sequence[Any], v: Sequence[Any], ops: Any, ends: Parts = ANYWHERE) -> Terms:
        """Returns the equations of motion, see `Mechanism.terms`."""
        still = [0.0] * self.nv
        joints = self._joints(q, v, ops, still, self.lift)
        feet, place = self._feet(joints, self.lift, v, ops), partial(self._place, joints)
        return Terms(self._mass_matrix(joints), self._needed(joints, still), *feet, place)

    def feet(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Feet:
        """Returns the kinematics of the toes, see `Mechanism.feet`."""
        return self._feet(self._joints(q, v, ops), ZERO, v, ops)

    def forces(
        self,
        q: Sequence[Any],
        v: Sequence[Any],
        a: Sequence[Any],
        ops: Any,
        pushes: Mapping[str, Sequence[Any]] = NO_FORCES,
        *,
        gravity: bool = True,
    ) -> list[Any]:
        """Returns the forces that a motion needs, by recursion; see `Mechanism.forces`."""
        return self._needed(self._joints(q, v, ops, a, self.lift if gravity else ZERO), a, pushes)

    def _needed(
        self, joints: Sequence[_Joint], a: Sequence[Any], pushes: Mapping[str, Sequence[Any]] = NO_FORCES
    ) -> list[Any]:
        loads = [*map(_inertial, self.bodies, joints), (ZERO, ZERO)]  # the last is that of the world
        for toe, push in pushes.items():
            i, offset = self.toes[toe]
            own = rotate_back(joints[i].turned, (push[0], push[1], push[2]))
            loads[i] = subtract(loads[i][0], own), subtract(loads[i][1], cross(offset, own))
        needed: list[Any] = [0.0] * self.nv
        for i in reversed(range(self.nv)):
            body, joint, (force, torque) = self.bodies[i], joints[i], loads[i]
            needed[i] = plus(dot(body.axis, torque if body.turns else force), times(body.armature, a[i]))
            if body.parent >= 0:
                force, torque = rotate(joint.against, force), rotate(joint.against, torque)
                above = loads[body.parent]
                loads[body.parent] = add(above[0], force), add(above[1], add(torque, cross(joint.arm, force)))
        return needed

    def _mass_matrix(self, joints: Sequence[_Joint]) -> list[list[Any]]:
        """Computes D by composite bodies, from the limbs to the trunk."""
        matrix: list[list[Any]] = [[0.0] * self.nv for _ in range(self.nv)]
        composites = [_Composite(body.mass, body.moment, body.inertia) for body in self.bodies]
        for i in reversed(range(self.nv)):
            body, composite = self.bodies[i], composites[i]
            if body.parent >= 0:
                composites[body.parent] = _hung(composites[body.parent], composite, joints[i])
            if body.turns:
                force, torque = cross(body.axis, composite.moment), rotate(composite.inertia, body.axis)
            else:
                force, torque = scale(composite.mass, body.axis), cross(composite.moment, body.axis)
            matrix[i][i] = plus(dot(body.axis, torque if body.turns else force), body.armature)
            j = i
            while (above := self.bodies[j].parent) >= 0:
                force, torque = rotate(joints[j].against, force), rotate(joints[j].against, torque)
                torque, j = add(torque, cross(joints[j].arm, force)), above
                other = self.bodies[j]
                matrix[i][j] = matrix[j][i] = dot(other.axis, torque if other.turns else force)
        return matrix

    def _feet(self, joints: Sequence[_Joint], lift: Vector, v: Sequence[Any], ops: Any) -> Feet:
        positions: dict[str, tuple[Any, ...]] = {}
        jacobians: dict[str, list[list[Any]]] = {}
        drifts: dict[str, tuple[Any, ...]] = {}
        for toe, (i, offset) in self.toes.items():
            joint = joints[i]
            positions[toe] = position = joint.at(offset)
            carried = rotate(joint.turned, add(joint.acceleration, _swung(joint, offset)))
            drifts[toe] = subtract(carried, lift)
            rows = jacobians[toe] = [[0.0] * self.nv for _ in range(3)]
            for j, column in self._columns(joints, i, position):
                for row, value in zip(rows, column, strict=True):
                    row[j] = value
            if self.circle is not None:
                jacobians[toe], drifts[toe] = self.circle.moving(position, rows, drifts[toe], v, ops)
        return Feet(positions, jacobians, drifts)

    def _point(self, joints: Sequence[_Joint], frame: str, at: Sequence[Any]) -> Point:
        i, offset = self._frame(frame)
        position = joints[i].at(add(offset, rotate(self.axes[frame], tuple(at))))
        return Point(position, dict(self._columns(joints, i, position)))

    def _columns(self, joints: Sequence[_Joint], i: int, position: Vector) -> Iterator[tuple[int, Vector]]:
        """Yields the velocity of a point of body i for each unit of the rate of each joint that carries it."""
        while i >= 0:
            body, joint = self.bodies[i], joints[i]
            axis = rotate(joint.turned, body.axis)
            yield i, cross(axis, subtract(position, joint.origin)) if body.turns else axis
            i = body.parent

    def moving_feet(self, q: Sequence[Any], v: Sequence[Any], a: Sequence[Any], ops: Any) -> dict[str, Toe]:
        """Returns the motion of the toes, without their Jacobians; see `Mechanism.moving_feet`."""
        joints, feet = self._joints(q, v, ops, a), {}
        for toe, (i, offset) in self.toes.items():
            joint = joints[i]
            velocity = add(joint.velocity, cross(joint.spin, offset))
            acceleration = add(joint.acceleration, _swung(joint, offset))
            feet[toe] = Toe(joint.at(offset), rotate(joint.turned, velocity), rotate(joint.turned, acceleration))
        return feet

    def _joints(
        self, q: Sequence[Any], v: Sequence[Any], ops: Any, a: Sequence[Any] | None = None, lift: Vector = ZERO
    ) -> list[_Joint]:
        a = [0.0] * self.nv if a is None else a
        joints = [_WORLD._replace(acceleration=lift)] * (self.nv + 1)
        for i, body in enumerate(self.bodies):
            above = joints[body.parent]
            against, arm = body.turned, body.placement
            if body.turns:
                against = multiply(body.turned, rotation(body.axis, ops.cos(q[i]), ops.sin(q[i])))
            else:
                arm = add(arm, rotate(body.turned, scale(q[i], body.axis)))
            carried = add(above.acceleration, _swung(above, arm))
            spin, turning = rotate_back(against, above.spin), rotate_back(against, above.turning)
            velocity = rotate_back(against, add(above.velocity, cross(above.spin, arm)))
            acceleration, rate = rotate_back(against, carried), scale(v[i], body.axis)
            if body.turns:
                turning = add(turning, add(scale(a[i], body.axis), cross(spin, rate)))
                spin = add(spin, rate)
            else:
                velocity = add(velocity, rate)
                coriolis = scale(2.0, cross(spin, rate))
                acceleration = add(acceleration, add(scale(a[i], body.axis), coriolis))
            turned = multiply(above.turned, against)
            origin = add(above.origin, rotate(above.turned, arm))
            joints[i] = _Joint(turned, against, arm, origin, spin, velocity, turning, acceleration)
        return joints


class _Joint(NamedTuple):
    """Motion of a body in its own axes.

    `turned` takes vectors to the world, `against` to the body that it hangs on, in whose axes `arm` is from one joint
    to the other; `origin` is in the world. `turning` and `acceleration` are those of the angular velocity, `spin`, and
    of the joint.
    """

    turned: Rows
    against: Rows
    arm: Vector
    origin: Vector
    spin: Vector
    velocity: Vector
    turning: Vector
    acceleration: Vector

    def at(self, offset: Vector) -> Vector:
        """Returns the position of a point of the body in the world."""
        return add(self.origin, rotate(self.turned, offset))


_WORLD = _Joint(UPRIGHT, UPRIGHT, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO)


class _Composite(NamedTuple):
    """Mass, first moment and inertia about a joint of all that it carries, in the axes of its body."""

    mass: Any
    moment: Vector
    inertia: Rows


def _hung(above: _Composite, load: _Composite, joint: _Joint) -> _Composite:
    """Adds to a body's composite that of a joint which hangs on it."""
    R, arm = joint.against, joint.arm
    moment, mass = rotate(R, load.moment), load.mass
    inertia = multiply(multiply(R, load.inertia), transpose(R))
    along = plus(times(2.0, dot(arm, moment)), times(mass, dot(arm, arm)))

    def entry(i: int, j: int) -> Any:
        shift = plus(plus(times(arm[i], moment[j]), times(moment[i], arm[j])), times(mass, times(arm[i], arm[j])))
        value = plus(plus(above.inertia[i][j], inertia[i][j]), negate(shift))
        return plus(value, along) if i == j else value

    rows = tuple(tuple(entry(i, j) for j in range(3)) for i in range(3))
    return _Composite(plus(above.mass, mass), add(above.moment, add(moment, scale(mass, arm))), rows)


def _inertial(body: Body, joint: _Joint) -> tuple[Vector, Vector]:
    """Returns the force, and the torque about the joint, that a body's motion needs."""
    if vanishes(body.mass):
        return ZERO, ZERO
    momentum = rotate(body.inertia, joint.spin)
    force = add(scale(body.mass, joint.acceleration), _swung(joint, body.moment))
    turning = add(rotate(body.inertia, joint.turning), cross(joint.spin, momentum))
    return force, add(cross(body.moment, joint.acceleration), turning)


def _swung(joint: _Joint, arm: Vector) -> Vector:
    """Returns the acceleration that rotation adds at an arm."""
    return add(cross(joint.turning, arm), cross(joint.spin, cross(joint.spin, arm)))


def _body(robot: Robot, joint: int) -> Body:
    model = robot.model
    row, inertia, place = int(model.joints[joint].idx_v), model.inertias[joint], model.jointPlacements[joint]
    motion = np.reshape(pin.Data(model).joints[joint].S, (6, -1))
    if motion[:3].any() == motion[3:].any():
        raise BadValue("robot", robot, f"one whose {model.names[joint]} turns or slides")
    return Body(
        parent=int(model.parents[joint]) - 1,
        turned=matrix_of(place.rotation),
        placement=floats_of(place.translation),
        axis=floats_of(motion[3:, 0] if motion[3:].any() else motion[:3, 0]),
        turns=bool(motion[3:].any()),
        mass=float(inertia.mass),
        moment=floats_of(inertia.mass * inertia.lever),
        inertia=matrix_of(inertia.matrix()[3:, 3:]),
        armature=float(model.armature[row]),
    )
