"""The dynamics of a planar robot, written once for arrays and for symbols.

D, C v + G, and each toe's position, Jacobian and drift, from scalars of any kind that has +, -, *
and a sine and cosine: numbers, NumPy arrays (a whole batch of states at once), SymPy, CasADi. Every
number is read from the robot's `pinocchio.Model`.

Vectors lie in the x-z plane; angles turn x towards z, so that pitch is positive nose up.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.errors import BadValue
from spear_pin.model.robot import WORLD_ALIGNED, Robot

Vector = tuple[Any, Any]
ZERO: Vector = (0.0, 0.0)


@dataclass(frozen=True)
class Body:
    """A joint and the rigid body that it moves, in a frame that is parallel to the world's at q = 0.

    Attributes:
        parent: number of the body it hangs on, -1 for the world.
        placement: of the joint in the parent, in m.
        turns: +1 or -1 for a revolute joint, by the sense of its axis; 0 for a prismatic one.
        slides: direction of a prismatic joint in its own frame.
        mass: in kg.
        com: centre of mass in the joint's frame, in m.
        inertia: about the centre of mass, in kg·m².
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


@dataclass(frozen=True)
class Terms:
    """The equations of motion at a state: D v̇ + bias = B u + Σ Jᵀ F, (3.16).

    Attributes:
        mass_matrix: D, nv rows of nv.
        bias: C v + G, nv.
        positions: x and z of each toe.
        jacobians: J of each toe, two rows of nv.
        drifts: J̇ v of each toe.
    """

    mass_matrix: list[list[Any]]
    bias: list[Any]
    positions: dict[str, Vector]
    jacobians: dict[str, list[list[Any]]]
    drifts: dict[str, Vector]


class Planar:
    """The planar dynamics of a robot, for any scalars.

    Args:
        robot: a planar robot with one coordinate a joint.

    Raises:
        BadValue: the robot is not planar, or has a joint with several coordinates.
    """

    def __init__(self, robot: Robot) -> None:
        if not robot.planar or robot.nq != robot.nv or robot.nv != robot.model.njoints - 1:
            raise BadValue("robot", robot, "a planar robot whose joints have one coordinate each")
        self.coordinates, self.nv = robot.coordinates, robot.nv
        at_zero = pin.Data(robot.model)
        pin.computeJointJacobians(robot.model, at_zero, pin.neutral(robot.model))
        self.bodies = _bodies(robot.model, at_zero)
        self.gravity = float(-robot.model.gravity.linear[2])
        self.frames: dict[str, tuple[int, tuple[float, float]]] = {}
        for frame in robot.model.frames:
            turn = at_zero.oMi[frame.parentJoint].rotation
            place = int(frame.parentJoint) - 1, _plane(turn @ frame.placement.translation)
            self.frames.setdefault(frame.name, place)  # of several of a name the first, as Pinocchio finds it
        self.toes = {toe: self.frames[toe] for toe in robot.toes}

    def with_bodies(self, bodies: Sequence[Body]) -> Planar:
        """This mechanism with other bodies, whose numbers may be symbols."""
        other = copy(self)
        other.bodies = tuple(bodies)
        return other

    def terms(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Terms:
        """The equations of motion at (q, v).

        Args:
            q: nv scalars.
            v: nv scalars.
            ops: has `sin` and `cos` for them.
        """
        joints = self._joints(q, v, ops)
        mass_matrix = [[0.0] * self.nv for _ in range(self.nv)]
        bias: list[Any] = [0.0] * self.nv
        # of what each joint carries: mass, moment of mass about the joint, inertia about it, and the
        # force and torque there that the motion at v̇ = 0 needs
        carried: list[list[Any]] = [[0.0, ZERO, 0.0, ZERO, 0.0] for _ in self.bodies]
        for i in reversed(range(self.nv)):
            body, joint = self.bodies[i], joints[i]
            mass, moment, inertia, force, torque = carried[i]
            com = _scaled(body.mass, _turned(body.com, joint.cosine, joint.sine))
            fall = joint.acceleration[0], joint.acceleration[1] + self.gravity
            pull = _added(_scaled(body.mass, fall), _scaled(-joint.spin * joint.spin, com))
            mass = mass + body.mass
            moment = _added(moment, com)
            inertia = inertia + body.inertia + body.mass * _dot(body.com, body.com)  # as long however it turns
            force, torque = _added(force, pull), torque + _cross(com, fall)
            bias[i] = body.turns * torque if body.turns else _dot(joint.axis, force)
            j, further, lever = i, inertia, ZERO
            while j >= 0:
                other, turns = joints[j], self.bodies[j].turns
                if body.turns and turns:
                    value = body.turns * turns * further
                elif body.turns:
                    value = body.turns * _cross(moment, other.axis)
                elif turns:
                    value = turns * _cross(_added(moment, _scaled(mass, lever)), joint.axis)
                else:
                    along = _dot(joint.axis, other.axis)
                    value = along if _vanishes(along) else mass * along
                mass_matrix[i][j] = mass_matrix[j][i] = value
                further, lever = further + _dot(moment, other.arm), _added(lever, other.arm)
                j = self.bodies[j].parent
            mass_matrix[i][i] = mass_matrix[i][i] + body.armature
            if body.parent >= 0:
                arm, above = joint.arm, carried[body.parent]
                length = _dot(body.placement, body.placement) if body.turns else _dot(arm, arm)
                above[0] = above[0] + mass
                above[1] = _added(above[1], _added(moment, _scaled(mass, arm)))
                above[2] = above[2] + inertia + 2.0 * _dot(moment, arm) + mass * length
                above[3] = _added(above[3], force)
                above[4] = above[4] + torque + _cross(arm, force)
        positions, jacobians, drifts = {}, {}, {}
        for toe, (i, offset) in self.toes.items():
            joint = joints[i] if i >= 0 else _WORLD
            lever = _turned(offset, joint.cosine, joint.sine)
            positions[toe] = position = _added(joint.origin, lever)
            drifts[toe] = _added(joint.acceleration, _scaled(-joint.spin * joint.spin, lever))
            jacobians[toe] = [[0.0] * self.nv, [0.0] * self.nv]
            while i >= 0:
                column: Vector = joints[i].axis
                if self.bodies[i].turns:
                    from_joint = (position[0] - joints[i].origin[0], position[1] - joints[i].origin[1])
                    column = _scaled(self.bodies[i].turns, (-from_joint[1], from_joint[0]))
                jacobians[toe][0][i], jacobians[toe][1][i] = column
                i = self.bodies[i].parent
        return Terms(mass_matrix, bias, positions, jacobians, drifts)

    def position(self, frame: str, q: Sequence[Any], ops: Any) -> Vector:
        """Position of any frame of the robot's model, x and z, in m."""
        i, offset = self.frames[frame]
        joint = self._joints(q, [0.0] * self.nv, ops)[i] if i >= 0 else _WORLD
        return _added(joint.origin, _turned(offset, joint.cosine, joint.sine))

    def _joints(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> list[_Joint]:
        joints: list[_Joint] = []
        for i, body in enumerate(self.bodies):
            above = joints[body.parent] if body.parent >= 0 else _WORLD
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
                if not _vanishes(spin):
                    acceleration = _added(acceleration, _scaled(2.0 * spin * v[i], (-axis[1], axis[0])))
            if not _vanishes(above.spin):
                acceleration = _added(acceleration, _scaled(-above.spin * above.spin, arm))
            joints.append(_Joint(angle, cosine, sine, arm, _added(above.origin, arm), spin, acceleration, axis))
        return joints


@dataclass(frozen=True)
class _Joint:
    """Where a joint is: absolute angle and rate, position, acceleration at v̇ = 0, direction of sliding.

    `arm` is from the joint it hangs on.
    """

    angle: Any
    cosine: Any
    sine: Any
    arm: Vector
    origin: Vector
    spin: Any
    acceleration: Vector
    axis: Vector


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


def _vanishes(value: Any) -> bool:
    return isinstance(value, float) and value == 0.0


def _turned(vector: Vector, cosine: Any, sine: Any) -> Vector:
    x, z = vector
    if x == 0.0:  # most limbs hang straight down
        return -sine * z, cosine * z
    if z == 0.0:
        return cosine * x, sine * x
    return cosine * x - sine * z, sine * x + cosine * z


def _added(a: Vector, b: Vector) -> Vector:
    return a[0] + b[0], a[1] + b[1]


def _scaled(factor: Any, vector: Vector) -> Vector:
    return factor * vector[0], factor * vector[1]


def _dot(a: Vector, b: Vector) -> Any:
    return a[0] * b[0] + a[1] * b[1]


def _cross(a: Vector, b: Vector) -> Any:
    return a[0] * b[1] - a[1] * b[0]
