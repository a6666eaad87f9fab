"""The dynamics of a planar robot, written once for arrays and for symbols.

It computes D, C v + G, and each toe's position, Jacobian and drift, for scalars of any kind that has
+, -, * and a sine and cosine: numbers, NumPy arrays (a whole batch of states at once), SymPy, CasADi.
Every number is read from the robot's `pinocchio.Model`.

Vectors lie in the x-z plane; angles turn x towards z, so that pitch is positive nose up.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue
from spear_pin.model.directions import WORLD_ALIGNED
from spear_pin.model.mechanism import Feet, Mechanism, Terms
from spear_pin.model.path import Point
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import ANYWHERE, Parts, end_of
from spear_pin.model.scalars import dot, negate, plus, vanishes
from spear_pin.model.vectors import matrix_of, rotate

Vector = tuple[Any, Any]
ZERO: Vector = (0.0, 0.0)


@dataclass(frozen=True)
class Body:
    """A joint and the rigid body that it moves, in a frame that is parallel to the world's at q = 0.

    Attributes:
        parent: number of the body it hangs on, -1 for the world.
        placement: position of the joint in the parent, in m.
        turns: +1 or -1 for a revolute joint, by the sense of its axis; 0 for a prismatic one.
        slides: direction of a prismatic joint in its own frame.
        mass: mass, in kg.
        com: centre of mass in the joint's frame, in m.
        inertia: inertia about the centre of mass, in kg·m².
        armature: rotor inertia reflected to the joint, in kg·m² (or kg).
    """

    parent: int
    placement: tuple[float, float]
    turns: float
    slides: tuple[float, float]
    mass: float
    com: tuple[float, float]
    inertia: float
    armature: float

    @property
    def numbers(self) -> tuple[Any, ...]:
        """Mass, centre of mass, inertia, rotor and placement."""
        return self.mass, *self.com, self.inertia, self.armature, *self.placement

    def with_numbers(self, left: Iterator[Any]) -> Body:
        """Returns the body with the next of some numbers, in the order of `numbers`."""
        mass, com, inertia, armature = next(left), (next(left), next(left)), next(left), next(left)
        return replace(self, mass=mass, com=com, inertia=inertia, armature=armature, placement=(next(left), next(left)))


class Planar(Mechanism):
    """The planar dynamics of a robot, for any scalars.

    Args:
        robot: a planar robot with one coordinate a joint.

    Raises:
        BadValue: the robot is not planar, or has a joint with several coordinates.
    """

    def __init__(self, robot: Robot) -> None:
        if not robot.planar or robot.nq != robot.nv or robot.nv != robot.model.njoints - 1:
            raise BadValue("robot", robot, "a planar robot whose joints have one coordinate each")
        at_zero = pin.Data(robot.model)
        pin.computeJointJacobians(robot.model, at_zero, pin.neutral(robot.model))
        held = [(at_zero.oMi[frame.parentJoint], frame.placement) for frame in robot.model.frames]
        places = (
            (_plane(joint.rotation @ placement.translation), matrix_of(joint.rotation @ placement.rotation))
            for joint, placement in held
        )
        super().__init__(robot, _bodies(robot.model, at_zero), _plane(-robot.model.gravity.linear), places)
        self.aside: dict[str, float] = {}  # y of each frame, which stays as it is
        for frame, (joint, placement) in zip(robot.model.frames, held, strict=True):
            self.aside.setdefault(frame.name, float((joint * placement).translation[1]))

    def terms(self, q: Sequence[Any], v: Sequence[Any], ops: Any, ends: Parts = ANYWHERE) -> Terms:
        """Returns the equations of motion, see `Mechanism.terms`."""
        joints = self._joints(q, v, ops)
        mass_matrix, bias = self._dynamics(joints)
        closing = self._closing(joints, q)
        return Terms(mass_matrix, bias, *self._feet(joints, ops, ends), partial(self._place, joints), *closing)

    def feet(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Feet:
        """Returns the kinematics of the toes, see `Mechanism.feet`."""
        return self._feet(self._joints(q, v, ops), ops)

    def _dynamics(self, joints: Sequence[_Joint]) -> tuple[list[list[Any]], list[Any]]:
        """Computes mass matrix and bias by composite bodies, from the limbs to the trunk."""
        mass_matrix = [[0.0] * self.nv for _ in range(self.nv)]
        bias: list[Any] = [0.0] * self.nv
        loads = [NOTHING] * self.nv
        for i in reversed(range(self.nv)):
            body, joint = self.bodies[i], joints[i]
            load = _with_body(loads[i], body, joint, self.lift)
            bias[i] = body.turns * load.torque if body.turns else _dot(joint.axis, load.force)
            for j, value in self._couplings(i, load, joints):
                mass_matrix[i][j] = mass_matrix[j][i] = value
            mass_matrix[i][i] = mass_matrix[i][i] + body.armature
            if body.parent >= 0:
                loads[body.parent] = _hung(loads[body.parent], load, body, joint.arm)
        return mass_matrix, bias

    def _couplings(self, i: int, load: _Load, joints: Sequence[_Joint]) -> Iterator[tuple[int, Any]]:
        """Yields the mass matrix's entries that couple a joint, with its load, to itself and the joints above it."""
        axis, turns, j, inertia, lever = joints[i].axis, self.bodies[i].turns, i, load.inertia, ZERO
        while j >= 0:
            other, also = joints[j], self.bodies[j].turns
            if turns and also:
                yield j, turns * also * inertia
            elif turns:
                yield j, turns * _cross(load.moment, other.axis)
            elif also:
                yield j, also * _cross(_added(load.moment, _scaled(load.mass, lever)), axis)
            else:
                along = _dot(axis, other.axis)
                yield j, along if vanishes(along) else load.mass * along
            inertia, lever = inertia + _dot(load.moment, other.arm), _added(lever, other.arm)
            j = self.bodies[j].parent

    def _feet(self, joints: Sequence[_Joint], ops: Any, ends: Parts = ANYWHERE) -> Feet:
        positions, jacobians, drifts = {}, {}, {}
        for toe, place in self.toes.items():
            if toe in self.radii:
                found = self._rolling(joints, toe, ops, ends.get(toe))
            else:
                found = self._moving(joints, *place)
            positions[toe], jacobians[toe], drifts[toe] = found
        for toe in self.guided:
            jacobians[toe][0], drifts[toe] = [0.0] * self.nv, (0.0, drifts[toe][1])
        return Feet(positions, jacobians, drifts)

    def _rolling(
        self, joints: Sequence[_Joint], toe: str, ops: Any, ends: Sequence[Any] | None
    ) -> tuple[Vector, list[list[Any]], Vector]:
        """Returns position, Jacobian and drift of where a round foot touches, which is below its centre on its arc.

        The drift beyond the ends of its arc takes what `ends` says.
        """
        (i, offset), radius, arc = self.toes[toe], self.radii[toe], self.arcs.get(toe)
        centre, rows, drift = self._moving(joints, i, offset)
        lever: Vector = (0.0, -radius)
        if arc is not None and ends is None:
            beyond = arc.excess(joints[i].sine, joints[i].cosine, ops)
            lever = radius * ops.sin(beyond), -radius * ops.cos(beyond)
        for j in self._above(i):
            turned = _scaled(self.bodies[j].turns, (-lever[1], lever[0]))
            rows[0][j], rows[1][j] = plus(rows[0][j], turned[0]), plus(rows[1][j], turned[1])
        touching = _added(centre, lever), rows, drift
        if arc is None or ends is None:
            return touching
        points = [self._moving(joints, i, _added(offset, end_of(pitch, radius))) for pitch in (arc.start, arc.stop)]
        return _mixed([(1.0 - ends[0] - ends[1], touching), *zip(ends, points, strict=True)])

    def _above(self, i: int) -> Iterator[int]:
        """Yields a body, and those on which it hangs."""
        while i >= 0:
            yield i
            i = self.bodies[i].parent

    def _moving(self, joints: Sequence[_Joint], i: int, offset: Vector) -> tuple[Vector, list[list[Any]], Vector]:
        """Returns position, Jacobian and drift of a point of body i."""
        joint = joints[i]
        lever = _turned(offset, joint.cosine, joint.sine)
        position = _added(joint.origin, lever)
        rows: list[list[Any]] = [[0.0] * self.nv, [0.0] * self.nv]
        for j, (x, z) in self._columns(joints, i, position):
            rows[0][j], rows[1][j] = x, z
        return position, rows, _added(joint.acceleration, _scaled(-joint.spin * joint.spin, lever))

    def _closing(self, joints: Sequence[_Joint], q: Sequence[Any]) -> tuple[list[Any], list[list[Any]], list[Any]]:
        """Returns gaps, rows and drifts of the loops, in the order of `loops.Closure`."""
        gaps: list[Any] = []
        rows: list[list[Any]] = []
        drifts: list[Any] = []
        for loop in self.loops:
            if loop.ends:
                (at, here, slow), (to, there, fast) = (self._moving(joints, *self.frames[end]) for end in loop.ends)
                gaps += [b - a for a, b in zip(at, to, strict=True)]
                rows += [
                    [plus(b, negate(a)) for a, b in zip(*pair, strict=True)] for pair in zip(here, there, strict=True)
                ]
                drifts += [b - a for a, b in zip(slow, fast, strict=True)]
            else:
                weights = dict.fromkeys(self.coordinates, 0.0)
                for joint, weight in loop.joints:
                    weights[joint] += weight
                gaps.append(dot([*weights.values()], q))
                rows.append([*weights.values()])
                drifts.append(0.0)
        return gaps, rows, drifts

    def _point(self, joints: Sequence[_Joint], frame: str, at: Sequence[Any]) -> Point:
        i, offset = self._frame(frame)
        x, y, z = rotate(self.axes[frame], tuple(at))
        position = joints[i].at(_added(offset, (x, z)))
        columns = {j: (along, 0.0, up) for j, (along, up) in self._columns(joints, i, position)}
        return Point((position[0], self.aside[frame] + y, position[1]), columns)

    def _columns(self, joints: Sequence[_Joint], i: int, position: Vector) -> Iterator[tuple[int, Vector]]:
        """Yields the velocity of a point of body i for each unit of the rate of each joint that carries it."""
        for j in self._above(i):
            joint, turns = joints[j], self.bodies[j].turns
            lever = joint.origin[1] - position[1], position[0] - joint.origin[0]
            yield j, _scaled(turns, lever) if turns else joint.axis

    def _joints(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> list[_Joint]:
        joints = [_WORLD] * (self.nv + 1)
        for i, body in enumerate(self.bodies):
            above = joints[body.parent]
            arm = _turned(body.placement, above.cosine, above.sine)
            angle, spin, cosine, sine = above.angle, above.spin, above.cosine, above.sine
            if body.turns:
                angle, spin = angle + body.turns * q[i], spin + body.turns * v[i]
                cosine, sine = ops.cos(angle), ops.sin(angle)
            axis: Vector = ZERO
            acceleration = above.acceleration
            if not body.turns:
                axis = _turned(body.slides, cosine, sine)
                arm = _added(arm, _scaled(q[i], axis))
                if not vanishes(spin):
                    acceleration = _added(acceleration, _scaled(2.0 * spin * v[i], (-axis[1], axis[0])))
            if not vanishes(above.spin):
                acceleration = _added(acceleration, _scaled(-above.spin * above.spin, arm))
            joints[i] = _Joint(angle, cosine, sine, arm, _added(above.origin, arm), spin, acceleration, axis)
        return joints


@dataclass(frozen=True)
class _Joint:
    """Motion of a joint: absolute angle and rate, position, acceleration at v̇ = 0, direction of sliding.

    `arm` leads from the joint on which it hangs.
    """

    angle: Any
    cosine: Any
    sine: Any
    arm: Vector
    origin: Vector
    spin: Any
    acceleration: Vector
    axis: Vector

    def at(self, offset: Vector) -> Vector:
        """Returns the position of a point of the body."""
        return _added(self.origin, _turned(offset, self.cosine, self.sine))


class _Load(NamedTuple):
    """Load of the bodies that a joint carries.

    `moment` is the first moment of their mass about the joint, `inertia` their inertia about it. Their motion needs
    `force` and `torque` at v̇ = 0.
    """

    mass: Any
    moment: Vector
    inertia: Any
    force: Vector
    torque: Any


NOTHING = _Load(0.0, ZERO, 0.0, ZERO, 0.0)


def _with_body(load: _Load, body: Body, joint: _Joint, lift: Vector) -> _Load:
    """Adds to a joint's load the body that it moves."""
    com = _scaled(body.mass, _turned(body.com, joint.cosine, joint.sine))
    fall = _added(joint.acceleration, lift)
    pull = _added(_scaled(body.mass, fall), _scaled(-joint.spin * joint.spin, com))
    return _Load(
        load.mass + body.mass,
        _added(load.moment, com),
        load.inertia + body.inertia + body.mass * _dot(body.com, body.com),  # as long however it turns
        _added(load.force, pull),
        load.torque + _cross(com, fall),
    )


def _hung(above: _Load, load: _Load, body: Body, arm: Vector) -> _Load:
    """Adds to a joint's load the load of a joint that hangs on it at an arm."""
    length = _dot(body.placement, body.placement) if body.turns else _dot(arm, arm)
    return _Load(
        above.mass + load.mass,
        _added(above.moment, _added(load.moment, _scaled(load.mass, arm))),
        above.inertia + load.inertia + 2.0 * _dot(load.moment, arm) + load.mass * length,
        _added(above.force, load.force),
        above.torque + load.torque + _cross(arm, load.force),
    )


_WORLD = _Joint(0.0, 1.0, 0.0, ZERO, ZERO, 0.0, ZERO, ZERO)


def _bodies(model: pin.Model, at_zero: pin.Data) -> tuple[Body, ...]:
    bodies = []
    for joint in range(1, model.njoints):
        row, parent = int(model.joints[joint].idx_v), int(model.parents[joint])
        axis = np.reshape(pin.getJointJacobian(model, at_zero, joint, WORLD_ALIGNED), (6, -1))[:, row]
        place, inertia = at_zero.oMi[joint], model.inertias[joint]
        turns = -float(np.round(axis[4]))  # about -y angles turn x towards z
        bodies.append(
            Body(
                parent=parent - 1,
                placement=_plane(place.translation - at_zero.oMi[parent].translation),
                turns=turns,
                slides=ZERO if turns else _plane(axis[:3]),
                mass=float(inertia.mass),
                com=_plane(place.rotation @ inertia.lever),
                inertia=float((place.rotation @ inertia.inertia @ place.rotation.T)[1, 1]),
                armature=float(model.armature[row]),
            )
        )
    return tuple(bodies)


def _plane(vector: Any) -> tuple[float, float]:
    return float(vector[0]), float(vector[2])


def _turned(vector: Vector, cosine: Any, sine: Any) -> Vector:
    x, z = vector
    if vanishes(x):  # most limbs hang straight down
        return -sine * z, cosine * z
    if vanishes(z):
        return cosine * x, sine * x
    return cosine * x - sine * z, sine * x + cosine * z


def _added(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1]


def _scaled(factor: Any, vector: Vector) -> Vector:
    return factor * vector[0], factor * vector[1]


def _mixed(
    parts: Sequence[tuple[Any, tuple[Vector, list[list[Any]], Vector]]],
) -> tuple[Vector, list[list[Any]], Vector]:
    """Returns the weighted sum of positions, Jacobians and drifts."""
    weights = [weight for weight, _ in parts]
    positions, rows, drifts = zip(*(part for _, part in parts), strict=True)
    x, z = (dot(weights, each) for each in zip(*positions, strict=True))
    along, up = (dot(weights, each) for each in zip(*drifts, strict=True))
    jacobian = [[dot(weights, each) for each in zip(*row, strict=True)] for row in zip(*rows, strict=True)]
    return (x, z), jacobian, (along, up)


def _dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1]


def _cross(a: Vector, b: Vector) -> Any:
    return a[0] * b[1] - a[1] * b[0]
