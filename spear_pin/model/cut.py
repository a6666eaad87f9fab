"""Parts cut out of a robot to move in the sagittal plane: inertias projected onto it, motors and limits carried over.

A `Cut` describes the origin of a cut, its angles, and the amounts that it leaves out.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.model.legs import WITHOUT_LOOPS, Leg
from spear_pin.model.limits import Limits, limits_of
from spear_pin.model.tree import Tree

AHEAD, UP, PITCH, FLEX = (
    pin.JointModelPX(),
    pin.JointModelPZ(),
    pin.JointModelRevoluteUnaligned(0.0, -1.0, 0.0),
    pin.JointModelRY(),
)
"""Joints of the plane: two that slide, one that turns the nose up or a knee forward, one that flexes a knee."""
ROUNDING = 1e-8  # in SI units: amounts that differ by less are alike
STAY, NOTHING, ORIGIN = pin.SE3(np.eye(3), np.zeros(3)), pin.Inertia.Zero(), (0.0, 0.0)


class Amount(NamedTuple):
    """An amount of a quantity.

    Attributes:
        what: the quantity, in words.
        value: the largest value, without sign.
        unit: unit of the value.
    """

    what: str
    value: float
    unit: str

    def __str__(self) -> str:
        return f"{self.what} {self.value:.3g} {self.unit}"


class Turn(NamedTuple):
    """An angle of a cut, sign (q - zero), of an angle q of the robot.

    Attributes:
        joint: joint of the robot.
        sign: +1 or -1.
        zero: angle q at which the cut's angle is zero, in rad.
    """

    joint: str
    sign: int
    zero: float

    def __str__(self) -> str:
        sign = "-" if self.sign < 0 else ""
        shift = f"{-self.zero:+.4g}" if abs(self.zero) >= 5e-5 else ""
        return f"{sign}({self.joint} {shift[0]} {shift[1:]})" if shift else f"{sign}{self.joint}"


@dataclass(frozen=True)
class Cut:
    """Origin of a robot that was cut out of another, and the amounts that the cut leaves out. It prints in a few lines.

    Attributes:
        kind: "monopod" or "sagittal".
        of: name of the robot.
        source: name or path from which the robot was loaded.
        body: mass of the cut's parts that are not legs, in kg.
        angles: for each turning joint of the cut, the joints of the robot that turn with it.
        held: joints of the robot that are held at zero, including its locked joints.
        robot: the `Robot` itself.
        legs: legs of the robot that were cut out, one or a pair for each leg of the cut. `spear_pin.model.recut` needs
            only these, the kind and the body to cut again.
        sides: where known, +1 if a leg of the cut flexes its knee to positive angles, -1 if to negative ones.
        mirrored: whether the cut's x points to the robot's rear.
        asymmetric: how far left and right are from each other's mirror images.
        neglected: amounts out of the plane.
    """

    kind: str
    of: str
    source: str
    body: float
    angles: Mapping[str, tuple[Turn, ...]]
    held: tuple[str, ...]
    robot: Any = field(repr=False, compare=False)
    legs: tuple[tuple[Leg, ...], ...] = field(repr=False)
    sides: Mapping[str, int] = field(default_factory=dict)
    mirrored: bool = False
    asymmetric: tuple[Amount, ...] = ()
    neglected: tuple[Amount, ...] = ()

    def __str__(self) -> str:
        lines = [
            f"{self.kind} of {self.of}, body {self.body:.4g} kg" + (", x to the rear" if self.mirrored else ""),
            "angles: " + ", ".join(f"{name} = {' = '.join(map(str, turns))}" for name, turns in self.angles.items()),
            f"held at zero: {', '.join(self.held)}" if self.held else "",
            _differences(self.asymmetric) if self.asymmetric else "",
            f"neglected: {_listed(self.neglected)}" if self.neglected else "",
        ]
        return "\n".join(line for line in lines if line)


def _differences(amounts: Sequence[Amount]) -> str:
    there = [amount for amount in amounts if amount.value > ROUNDING]
    return f"left and right differ: {_listed(there)}" if there else "left and right mirror each other"


def _listed(amounts: Sequence[Amount]) -> str:
    return "; ".join(map(str, amounts))


@dataclass(frozen=True)
class Limb:
    """A leg of a cut, which stands for one of the robot's legs or for a pair.

    Attributes:
        turns: angles of the hip and of the knee.
        thigh: inertia of the thigh about the hip, hanging straight down.
        shank: inertia of the shank about the knee, hanging straight down.
        lengths: lengths of thigh and shank, in m.
        hip: position of the hip in the robot with every joint at zero, (3,), in m.
    """

    turns: tuple[Turn, Turn]
    thigh: pin.Inertia
    shank: pin.Inertia
    lengths: tuple[float, float]
    hip: Array


class Source:
    """A robot with every joint at zero, out of which legs are cut.

    Args:
        robot: a `Robot`.

    Raises:
        BadValue: the robot has inertia in addition to its model's, or closed loops.
    """

    def __init__(self, robot: Any) -> None:
        if robot.added is not None:
            raise BadValue("robot", robot, "one without a rotary boom, whose inertia a leg cannot take over")
        if robot.loops:
            raise BadValue("robot", robot, WITHOUT_LOOPS)
        self.robot, self.model = robot, robot.model
        self.tree = Tree(self.model)
        self.data = self.tree.data

    def below(self, joint: str) -> set[int]:
        """Returns the numbers of the joints that a joint carries, including its own."""
        return set(map(int, self.model.subtrees[self.model.getJointId(joint)]))

    def rest(self, legs: Iterable[Leg]) -> set[int]:
        """Returns the numbers of the joints that no hip of the legs carries, including 0 for the fixed parts."""
        return set(range(self.model.njoints)).difference(*(self.below(leg.hip) for leg in legs))

    def above(self, leg: Leg) -> tuple[str, ...]:
        """Returns the joints between world and hip, without a floating base, that turn or slide out of the plane."""
        chain = self.tree.chain(self.model.getJointId(leg.hip))[:-1]
        held = [joint for joint in chain if not self.tree.floats(joint) and not self.tree.slides(joint)]
        return tuple(str(self.model.names[joint]) for joint in held)

    def lump(self, joints: Iterable[int]) -> pin.Inertia:
        """Returns the joint inertia of the bodies that some joints move, in the world."""
        bodies = (self.data.oMi[joint].act(self.model.inertias[joint]) for joint in sorted(joints))
        return sum(bodies, pin.Inertia.Zero())

    def limb(self, leg: Leg, mirrored: bool = False) -> Limb:
        """Cuts out a single leg.

        Args:
            leg: leg of the robot.
            mirrored: whether x shall point to the rear.
        """
        hip, knee = (self.data.oMi[self.model.getJointId(joint)].translation for joint in (leg.hip, leg.knee))
        ahead = -1 if mirrored else 1
        thigh_at, flexed = -leg.hip_sign * leg.hip_zero, -leg.knee_sign * leg.knee_zero  # with every joint at zero
        shank = self.below(leg.knee)
        return Limb(
            turns=(
                Turn(leg.hip, ahead * leg.hip_sign, leg.hip_zero),
                Turn(leg.knee, ahead * leg.knee_sign, leg.knee_zero),
            ),
            thigh=_hung(self.lump(self.below(leg.hip) - shank), hip, thigh_at, ahead),
            shank=_hung(self.lump(shank), knee, thigh_at - flexed, ahead),
            lengths=(leg.thigh, leg.shank),
            hip=np.array(hip),
        )


def _hung(body: pin.Inertia, joint: Array, angle: float, ahead: int) -> pin.Inertia:
    """Returns a body about a joint, turned back by the angle at which it hangs; its y stays that of the world."""
    cosine, sine = math.cos(angle), math.sin(angle)
    turned = np.array([[cosine, 0.0, sine], [0.0, 1.0, 0.0], [-sine, 0.0, cosine]])
    placed = pin.SE3(turned, -turned @ (joint * (1.0, 0.0, 1.0))).act(body)
    mirror = np.diag([float(ahead), 1.0, 1.0])
    return pin.Inertia(placed.mass, mirror @ placed.lever, mirror @ placed.inertia @ mirror)


def flat(body: pin.Inertia) -> pin.Inertia:
    """Projects a body onto the plane: returns the mean of the body and its mirror image."""
    inertia = np.array(body.inertia)
    inertia[[0, 1, 1, 2], [1, 0, 2, 1]] = 0.0
    return pin.Inertia(body.mass, body.lever * (1.0, 0.0, 1.0), inertia)


def products(bodies: Iterable[pin.Inertia]) -> Amount:
    """Returns the largest product of inertia that `flat` leaves out."""
    largest = max(float(np.abs(body.inertia[1, [0, 2]]).max()) for body in bodies)
    return Amount("products of inertia with y", largest, "kg·m²")


class Assembly:
    """A planar model that is assembled joint by joint, with names as in a URDF.

    Args:
        name: name of the model.
        gravity: gravity of the robot's model.

    Raises:
        BadValue: gravity is not along z, which defines a cut's axes.
    """

    def __init__(self, name: str, gravity: Any) -> None:
        if np.abs(gravity.linear[:2]).max() > ROUNDING:
            expected = "along z: a slope is the ground's, `Ground(slope=…)`"
            raise BadValue(f"gravity of {name}", tuple(gravity.linear.tolist()), expected)
        self.model = pin.Model()
        self.model.name, self.model.gravity = name, gravity

    def add(
        self, name: str, kind: Any, parent: int, link: str, body: pin.Inertia = NOTHING, place: Sequence[float] = ORIGIN
    ) -> int:
        """Adds a joint, at x and z in its parent in m, and the link that it moves; returns the joint's number."""
        placement = pin.SE3(np.eye(3), np.array([place[0], 0.0, place[1]]))
        joint = int(self.model.addJoint(parent, kind, placement, name))
        self.model.appendBodyToJoint(joint, body, STAY)
        self.model.addJointFrame(joint)
        self.model.addBodyFrame(link, joint, STAY, -1)
        return joint

    def add_leg(self, prefix: str, parent: int, limb: Limb, place: Sequence[float] = ORIGIN) -> None:
        """Adds hip, knee and toe, with a prefix to their names."""
        thigh, shank = limb.lengths
        hip = self.add(f"{prefix}hip", PITCH, parent, f"{prefix}thigh", flat(limb.thigh), place)
        knee = self.add(f"{prefix}knee", FLEX, hip, f"{prefix}shank", flat(limb.shank), (0.0, -thigh))
        self.model.addBodyFrame(f"{prefix}toe", knee, pin.SE3(np.eye(3), np.array([0.0, 0.0, -shank])), -1)

    def carry(self, robot: Any, angles: Mapping[str, Sequence[Turn]]) -> None:
        """Takes motors, friction and limits from a robot's joints; torques and inertias of a pair are added.

        Args:
            robot: a `Robot`.
            angles: for each turning joint of the cut, the joints of the robot that turn with it.

        Raises:
            BadValue: two joints have no angle that the limits of both allow.
        """
        self.model.rotorGearRatio = np.zeros(self.model.nv)  # Pinocchio begins with 1
        limits = limits_of(robot.model)
        for name, turns in angles.items():
            ranges = [_range(limits[turn.joint], turn) for turn in turns]
            low, high = max(low for low, _ in ranges), min(high for _, high in ranges)
            if not low < high:
                joints = " and ".join(turn.joint for turn in turns)
                raise BadValue(f"limits of {joints} as {name}", ranges, "ranges, in rad, that overlap")
            row = self.model.joints[self.model.getJointId(name)].idx_v
            carried = _carried(robot.model, turns) | {"lowerPositionLimit": low, "upperPositionLimit": high}
            for attribute, value in carried.items():
                getattr(self.model, attribute)[row] = value


def _carried(model: pin.Model, turns: Sequence[Turn]) -> dict[str, float]:
    """Returns the numbers of a joint that stands for several joints of a model, by Pinocchio's names."""
    joints = [model.joints[model.getJointId(turn.joint)] for turn in turns]

    def each(attribute: str) -> list[float]:
        return [float(getattr(model, attribute)[joint.idx_v]) for joint in joints]

    speed = min(each("upperVelocityLimit"))
    numbers = {name: sum(each(name)) for name in ("armature", "damping")}
    ratios = each("rotorGearRatio")
    ratio = max(ratios, key=abs)  # of one rotor with the same inertia at the joint as all together
    shares = ((own / ratio) ** 2 if ratio else 1.0 for own in ratios)
    rotors = (share * inertia for share, inertia in zip(shares, each("rotorInertia"), strict=True))
    numbers |= {"rotorGearRatio": ratio, "rotorInertia": sum(rotors)}
    numbers |= {"lowerVelocityLimit": -speed, "upperVelocityLimit": speed}
    for name in ("Effort", "DryFriction"):
        bounds = zip(turns, each(f"lower{name}Limit"), each(f"upper{name}Limit"), strict=True)
        low, high = np.sum([sorted((turn.sign * low, turn.sign * high)) for turn, low, high in bounds], axis=0)
        numbers |= {f"lower{name}Limit": low, f"upper{name}Limit": high}
    return numbers


def _range(limits: Limits, turn: Turn) -> tuple[float, float]:
    """Returns the least and the largest angle of a cut's joint, in rad, by the limits of the robot's joint."""
    low, high = sorted(turn.sign * (end - turn.zero) for end in limits.position)
    return low, high
