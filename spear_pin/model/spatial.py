"""The dynamics of a robot in space, written once for arrays and for symbols.

It computes the forces that a motion needs by recursive Newton-Euler, D by composite bodies, and the motion of each toe,
for scalars of any kind that has +, -, * and a sine and cosine: numbers, NumPy arrays (a whole batch of states at once),
SymPy, CasADi, heyoka. Every number is read from the robot's `pinocchio.Model`. Vectors of a body are in its own axes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.robot import Robot
from spear_pin.model.scalars import dot, negated, plus, times, vanishes
from spear_pin.model.terms import Feet, Terms

Vector = tuple[Any, Any, Any]
Rows = tuple[Vector, Vector, Vector]
ZERO: Vector = (0.0, 0.0, 0.0)
UPRIGHT: Rows = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))
NO_FORCES: Mapping[str, Vector] = {}


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


class Toe(NamedTuple):
    """Motion of a toe in the world, x, y and z.

    Attributes:
        position: position, in m.
        velocity: J v, in m/s.
        acceleration: J v̇ + J̇ v, in m/s².
    """

    position: Vector
    velocity: Vector
    acceleration: Vector


class Spatial:
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
        self.coordinates, self.nv = robot.coordinates, robot.nv
        self.bodies = tuple(_body(robot, joint) for joint in range(1, robot.model.njoints))
        self.lift = _vector(-robot.model.gravity.linear)  # of the ground, which does what gravity does
        self.frames: dict[str, tuple[int, Vector]] = {}
        for frame in robot.model.frames:  # of several of a name the first, as Pinocchio finds it
            self.frames.setdefault(frame.name, (int(frame.parentJoint) - 1, _vector(frame.placement.translation)))
        self.toes = {toe: self.frames[toe] for toe in robot.toes}

    @property
    def numbers(self) -> tuple[Any, ...]:
        """Mass, first moment, inertia, rotor and placement of each body, then the places of toes."""
        of_bodies = (number for body in self.bodies for number in _numbers(body))
        return *of_bodies, *(number for _, offset in self.toes.values() for number in offset)

    def with_numbers(self, numbers: Sequence[Any]) -> Spatial:
        """Returns this mechanism with other numbers, in the order of `numbers`; they may be symbols."""
        left, other = iter(numbers), copy(self)
        other.bodies = tuple(_with_numbers(body, left) for body in self.bodies)
        other.toes = {toe: (i, _next(left)) for toe, (i, _) in self.toes.items()}
        other.frames = {**self.frames, **other.toes}
        return other

    @property
    def shape(self) -> Any:
        """All of it but its numbers, and which of these are zero."""
        other = self.with_numbers([float(number != 0.0) for number in self.numbers])
        return other.bodies, tuple(other.toes.items()), tuple(sorted(other.frames.items())), self.lift

    def terms(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Terms:
        """Returns the equations of motion at (q, v).

        Args:
            q: nv scalars.
            v: nv scalars.
            ops: has `sin` and `cos` for them.
        """
        still = [0.0] * self.nv
        joints = self._joints(q, v, still, ops, self.lift)
        return Terms(self._mass_matrix(joints), self._needed(joints, still), *self._feet(joints, self.lift))

    def feet(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Feet:
        """Returns the kinematics of the toes alone.

        Args:
            q: nv scalars.
            v: nv scalars.
            ops: has `sin` and `cos` for them.
        """
        return self._feet(self._joints(q, v, [0.0] * self.nv, ops, ZERO), ZERO)

    def position(self, frame: str, q: Sequence[Any], ops: Any) -> Vector:
        """Returns the position of any frame of the robot's model, in m.

        Raises:
            UnknownName: there is no such frame.
        """
        if frame not in self.frames:
            raise UnknownName("frame", frame, self.frames)
        i, offset = self.frames[frame]
        still = [0.0] * self.nv
        joint = self._joints(q, still, still, ops, ZERO)[i] if i >= 0 else _WORLD
        return _plus(joint.origin, _to_world(joint.turned, offset))

    def forces(
        self,
        q: Sequence[Any],
        v: Sequence[Any],
        a: Sequence[Any],
        ops: Any,
        pushes: Mapping[str, Vector] = NO_FORCES,
        *,
        gravity: bool = True,
    ) -> list[Any]:
        """Returns the forces along the coordinates that a motion needs, (nv,): D v̇ + C v + G - Σ Jᵀ F.

        Without gravity and at v = 0 these are the impulses that a change `a` of the velocity needs; `pushes` then are
        impulses at the toes.

        Args:
            q: nv scalars.
            v: nv scalars.
            a: v̇, nv scalars.
            ops: has `sin` and `cos` for them.
            pushes: forces of the ground on toes by name, in the world, in N.
            gravity: whether gravity acts.
        """
        return self._needed(self._joints(q, v, a, ops, self.lift if gravity else ZERO), a, pushes)

    def _needed(
        self, joints: Sequence[_Joint], a: Sequence[Any], pushes: Mapping[str, Vector] = NO_FORCES
    ) -> list[Any]:
        loads: list[tuple[Vector, Vector]] = [_inertial(*each) for each in zip(self.bodies, joints, strict=True)]
        for toe, push in pushes.items():
            i, offset = self.toes[toe]
            own = _to_own(joints[i].turned, push)
            loads[i] = _minus(loads[i][0], own), _minus(loads[i][1], _cross(offset, own))
        needed: list[Any] = [0.0] * self.nv
        for i in reversed(range(self.nv)):
            body, joint, (force, torque) = self.bodies[i], joints[i], loads[i]
            needed[i] = plus(dot(body.axis, torque if body.turns else force), times(body.armature, a[i]))
            if body.parent >= 0:
                force, torque = _to_world(joint.against, force), _to_world(joint.against, torque)
                above = loads[body.parent]
                loads[body.parent] = _plus(above[0], force), _plus(above[1], _plus(torque, _cross(joint.arm, force)))
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
                force, torque = _cross(body.axis, composite.moment), _to_world(composite.inertia, body.axis)
            else:
                force, torque = _scaled(composite.mass, body.axis), _cross(composite.moment, body.axis)
            matrix[i][i] = plus(dot(body.axis, torque if body.turns else force), body.armature)
            j = i
            while (above := self.bodies[j].parent) >= 0:
                force, torque = _to_world(joints[j].against, force), _to_world(joints[j].against, torque)
                torque, j = _plus(torque, _cross(joints[j].arm, force)), above
                other = self.bodies[j]
                matrix[i][j] = matrix[j][i] = dot(other.axis, torque if other.turns else force)
        return matrix

    def _feet(self, joints: Sequence[_Joint], lift: Vector) -> Feet:
        positions: dict[str, tuple[Any, ...]] = {}
        jacobians: dict[str, list[list[Any]]] = {}
        drifts: dict[str, tuple[Any, ...]] = {}
        for toe, (i, offset) in self.toes.items():
            joint = joints[i] if i >= 0 else _WORLD
            positions[toe] = position = _plus(joint.origin, _to_world(joint.turned, offset))
            carried = _to_world(joint.turned, _plus(joint.acceleration, _swung(joint, offset)))
            drifts[toe] = _minus(carried, lift) if i >= 0 else ZERO
            rows = jacobians[toe] = [[0.0] * self.nv for _ in range(3)]
            while i >= 0:
                body, joint = self.bodies[i], joints[i]
                axis = _to_world(joint.turned, body.axis)
                column = _cross(axis, _minus(position, joint.origin)) if body.turns else axis
                for row, value in zip(rows, column, strict=True):
                    row[i] = value
                i = body.parent
        return Feet(positions, jacobians, drifts)

    def moving_feet(self, q: Sequence[Any], v: Sequence[Any], a: Sequence[Any], ops: Any) -> dict[str, Toe]:
        """Returns the motion of the toes.

        Args:
            q: nv scalars.
            v: nv scalars.
            a: v̇, nv scalars.
            ops: has `sin` and `cos` for them.
        """
        joints, feet = self._joints(q, v, a, ops, ZERO), {}
        for toe, (i, offset) in self.toes.items():
            joint = joints[i]
            velocity = _plus(joint.velocity, _cross(joint.spin, offset))
            acceleration = _plus(joint.acceleration, _swung(joint, offset))
            feet[toe] = Toe(
                _plus(joint.origin, _to_world(joint.turned, offset)),
                _to_world(joint.turned, velocity),
                _to_world(joint.turned, acceleration),
            )
        return feet

    def _joints(self, q: Sequence[Any], v: Sequence[Any], a: Sequence[Any], ops: Any, lift: Vector) -> list[_Joint]:
        joints: list[_Joint] = []
        world = _WORLD._replace(acceleration=lift)
        for i, body in enumerate(self.bodies):
            above = joints[body.parent] if body.parent >= 0 else world
            against, arm = body.turned, body.placement
            if body.turns:
                against = _product(body.turned, _rotation(body.axis, ops.cos(q[i]), ops.sin(q[i])))
            else:
                arm = _plus(arm, _to_world(body.turned, _scaled(q[i], body.axis)))
            carried = _plus(above.acceleration, _swung(above, arm))
            spin, turning = _to_own(against, above.spin), _to_own(against, above.turning)
            velocity = _to_own(against, _plus(above.velocity, _cross(above.spin, arm)))
            acceleration, rate = _to_own(against, carried), _scaled(v[i], body.axis)
            if body.turns:
                turning = _plus(turning, _plus(_scaled(a[i], body.axis), _cross(spin, rate)))
                spin = _plus(spin, rate)
            else:
                velocity = _plus(velocity, rate)
                coriolis = _scaled(2.0, _cross(spin, rate))
                acceleration = _plus(acceleration, _plus(_scaled(a[i], body.axis), coriolis))
            turned = _product(above.turned, against)
            origin = _plus(above.origin, _to_world(above.turned, arm))
            joints.append(_Joint(turned, against, arm, origin, spin, velocity, turning, acceleration))
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


_WORLD = _Joint(UPRIGHT, UPRIGHT, ZERO, ZERO, ZERO, ZERO, ZERO, ZERO)


class _Composite(NamedTuple):
    """Mass, first moment and inertia about a joint of all that it carries, in the axes of its body."""

    mass: Any
    moment: Vector
    inertia: Rows


def _hung(above: _Composite, load: _Composite, joint: _Joint) -> _Composite:
    """Adds to a body's composite that of a joint which hangs on it."""
    R, arm = joint.against, joint.arm
    moment, mass = _to_world(R, load.moment), load.mass
    inertia = _product(_product(R, load.inertia), _transposed(R))
    along = plus(times(2.0, dot(arm, moment)), times(mass, dot(arm, arm)))

    def entry(i: int, j: int) -> Any:
        shift = plus(plus(times(arm[i], moment[j]), times(moment[i], arm[j])), times(mass, times(arm[i], arm[j])))
        value = plus(plus(above.inertia[i][j], inertia[i][j]), negated(shift))
        return plus(value, along) if i == j else value

    first, second, third = (_vector_of(entry(i, j) for j in range(3)) for i in range(3))
    return _Composite(
        plus(above.mass, mass), _plus(above.moment, _plus(moment, _scaled(mass, arm))), (first, second, third)
    )


def _numbers(body: Body) -> tuple[Any, ...]:
    """Returns the numbers of a body, of its inertia one of each two that are equal."""
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = body.inertia
    return body.mass, *body.moment, xx, xy, xz, yy, yz, zz, body.armature, *body.placement


def _with_numbers(body: Body, left: Iterator[Any]) -> Body:
    """Returns a body with the next of some numbers, in the order of `_numbers`."""
    mass, moment = next(left), _next(left)
    xx, xy, xz, yy, yz, zz, armature = (next(left) for _ in range(7))
    inertia = (xx, xy, xz), (xy, yy, yz), (xz, yz, zz)
    return replace(body, mass=mass, moment=moment, inertia=inertia, armature=armature, placement=_next(left))


def _next(numbers: Iterator[Any]) -> Vector:
    return next(numbers), next(numbers), next(numbers)


def _inertial(body: Body, joint: _Joint) -> tuple[Vector, Vector]:
    """Returns the force, and the torque about the joint, that a body's motion needs."""
    if vanishes(body.mass):
        return ZERO, ZERO
    momentum = _to_world(body.inertia, joint.spin)
    force = _plus(_scaled(body.mass, joint.acceleration), _swung(joint, body.moment))
    turning = _plus(_to_world(body.inertia, joint.turning), _cross(joint.spin, momentum))
    return force, _plus(_cross(body.moment, joint.acceleration), turning)


def _swung(joint: _Joint, arm: Vector) -> Vector:
    """Returns the acceleration that rotation adds at an arm."""
    return _plus(_cross(joint.turning, arm), _cross(joint.spin, _cross(joint.spin, arm)))


def _body(robot: Robot, joint: int) -> Body:
    model = robot.model
    row, inertia, place = int(model.joints[joint].idx_v), model.inertias[joint], model.jointPlacements[joint]
    motion = np.reshape(pin.Data(model).joints[joint].S, (6, -1))
    if motion[:3].any() == motion[3:].any():
        raise BadValue("robot", robot, f"one whose {model.names[joint]} turns or slides")
    lever = inertia.lever
    about = inertia.inertia + inertia.mass * (lever @ lever * np.eye(3) - np.outer(lever, lever))
    return Body(
        parent=int(model.parents[joint]) - 1,
        turned=_rows(place.rotation),
        placement=_vector(place.translation),
        axis=_vector(motion[3:, 0] if motion[3:].any() else motion[:3, 0]),
        turns=bool(motion[3:].any()),
        mass=float(inertia.mass),
        moment=_vector(inertia.mass * lever),
        inertia=_rows(about),
        armature=float(model.armature[row]),
    )


def _rotation(axis: Vector, cosine: Any, sine: Any) -> Rows:
    """Returns the matrix of a rotation about a unit vector of numbers."""
    x, y, z = axis
    skew = (0.0, -z, y), (z, 0.0, -x), (-y, x, 0.0)

    def entry(i: int, j: int) -> Any:
        along = axis[i] * axis[j]
        if i == j:
            return 1.0 if along == 1.0 else along + (1.0 - along) * cosine
        return plus(times(along, 1.0 - cosine), times(skew[i][j], sine))

    first, second, third = (_vector_of(entry(i, j) for j in range(3)) for i in range(3))
    return first, second, third


def _plus(a: Vector, b: Vector) -> Vector:
    return plus(a[0], b[0]), plus(a[1], b[1]), plus(a[2], b[2])


def _minus(a: Vector, b: Vector) -> Vector:
    return _plus(a, _scaled(-1.0, b))


def _scaled(factor: Any, vector: Vector) -> Vector:
    return times(factor, vector[0]), times(factor, vector[1]), times(factor, vector[2])


def _cross(a: Vector, b: Vector) -> Vector:
    first, second, third = (plus(times(a[i], b[j]), negated(times(a[j], b[i]))) for i, j in ((1, 2), (2, 0), (0, 1)))
    return first, second, third


def _to_world(rows: Rows, vector: Vector) -> Vector:
    return dot(rows[0], vector), dot(rows[1], vector), dot(rows[2], vector)


def _to_own(rows: Rows, vector: Vector) -> Vector:
    return _to_world(_transposed(rows), vector)


def _product(a: Rows, b: Rows) -> Rows:
    columns = _transposed(b)
    first, second, third = (_to_world(columns, row) for row in a)
    return first, second, third


def _transposed(rows: Rows) -> Rows:
    first, second, third = (_vector_of(column) for column in zip(*rows, strict=True))
    return first, second, third


def _vector_of(values: Any) -> Vector:
    x, y, z = values
    return x, y, z


def _vector(values: Any) -> Vector:
    return _vector_of(float(value) for value in values)


def _rows(matrix: Any) -> Rows:
    first, second, third = (_vector(row) for row in matrix)
    return first, second, third
