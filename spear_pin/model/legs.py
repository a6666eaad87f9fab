"""Finds legs in a robot's kinematic tree: a hip and a knee that turn in the sagittal plane, and a toe.

The convention defines angles independently of the axes and zeros of the robot's own joints. The hip's angle is that
between the line from hip to knee and straight down, positive with the knee forward. The knee's angle is zero if hip,
knee and toe are in line, and positive with the shank turned backward. As in `load("spear_ii")`, x is forward and z up.
"""

from __future__ import annotations

import math
import re
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from numbers import Real
from types import MappingProxyType
from typing import Any, Protocol, runtime_checkable

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.kinds import typed
from spear_pin.model.frames import frame_id, joint_id
from spear_pin.model.limits import limits_of
from spear_pin.model.loops import Loop
from spear_pin.model.tree import SHORTEST, Tree

Sides = Mapping[str, int] | int
ONE_WAY = 2.0  # a knee flexes to the side where its limits leave this many times the room of the other side
BENT = 0.1  # rad: a knee that is bent by less in a posture does not reveal its side
SIDES: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {
        "q_spear": {"posterior": 1, "anterior": -1},
        "q_spear_full": {"posterior_left": 1, "posterior_right": 1, "anterior_left": -1, "anterior_right": -1},
    }
)
"""Sides of knees whose limits leave both open, by the robot's source."""


WITHOUT_LOOPS = "a robot without closed loops: legs here are chains of a hip and a knee"


@runtime_checkable
class LeggedRobot(Protocol):
    """A robot in which legs are found: a `Robot`."""

    model: pin.Model
    toes: tuple[str, ...]
    source: str
    loops: tuple[Loop, ...]


@dataclass(frozen=True)
class Leg:
    """A leg: names of its joints and its toe, and the numbers that convert their angles to the convention.

    Attributes:
        name: name of the leg, such as "posterior" for the toe "posterior_toe".
        hip: joint that turns the thigh in the sagittal plane.
        knee: joint that turns the shank in the sagittal plane.
        toe: frame at the leg's end.
        abduction: joint above the hip that swings the leg out of the plane; None if there is none.
        side: +1 if the knee's own angle grows as it flexes, -1 if it falls; 0 if neither limits nor a posture reveal
            it, so that it must be given (see `find_legs`).
        thigh: length from hip to knee in the plane, in m.
        shank: length from knee to toe in the plane, in m.
        hip_sign: +1 or -1 by the sense of the hip's axis: its angle in the convention is hip_sign (q - hip_zero).
        knee_sign: +1 or -1 by the sense of the knee's axis: its angle in the convention is knee_sign (q - knee_zero).
        hip_zero: the hip's own angle with the thigh straight down, in rad.
        knee_zero: the knee's own angle with the leg straight, in rad.
        across: distance from hip to toe out of the plane with every joint at zero, in m, to the left.
        others: other moving joints of the leg, such as an ankle, or a slide above the hip; rails on which the trunk of
            a robot with one leg slides do not belong to the leg.

    Raises:
        BadValue: a sign is neither +1 nor -1, or a length is not positive.

    Example:
        >>> from spear_pin import load
        >>> leg = load("q_spear_full").legs[0]
        >>> leg.name, leg.knee, round(leg.lean(1.0), 3)  # the hip's angle with the toe below it, in rad
        ('posterior_left', 'posterior_left_knee', 0.5)
    """

    name: str
    hip: str
    knee: str
    toe: str
    abduction: str | None
    side: int
    thigh: float
    shank: float
    hip_sign: int
    knee_sign: int
    hip_zero: float
    knee_zero: float
    across: float
    others: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        of = f"of leg {self.name!r}"
        for name, sign in (("hip_sign", self.hip_sign), ("knee_sign", self.knee_sign), ("side", self.side)):
            if sign not in (-1, 1) and (name, sign) != ("side", 0):
                raise BadValue(f"{name} {of}", sign, "-1 or 1" if name != "side" else "-1, 0 or 1")
        for name, length in (("thigh", self.thigh), ("shank", self.shank)):
            require(f"{name} {of}", length, lambda length: length > 0, "a number > 0, in m")

    @property
    def bends(self) -> int:
        """+1 if the knee points forward as it flexes, -1 if backward, 0 if the `side` is not known."""
        return self.side * self.knee_sign

    def length(self, knee: float) -> float:
        """Returns the distance from hip to toe in the plane, in m, at a knee angle in the convention, in rad."""
        return math.hypot(self.shank * math.sin(knee), self.thigh + self.shank * math.cos(knee))

    def lean(self, knee: float) -> float:
        """Returns the hip's angle with the toe straight below it, in rad, at a knee angle, both in the convention.

        It is half of the knee's angle if thigh and shank have equal lengths. The angle of the line from hip to toe is
        the hip's angle minus this.
        """
        return float(lean(self.thigh, self.shank, knee, math)[0])


def lean(thigh: Any, shank: Any, knee: Any, ops: Any) -> tuple[Any, Any, Any]:
    """Returns the hip's angle with the toe straight below it, and its first two derivatives by the knee's angle.

    Args:
        thigh: length of the thigh, in m.
        shank: length of the shank, in m.
        knee: angle of the knee in the convention, in rad.
        ops: has sin, cos and atan2 for this kind of scalar: `math`, NumPy, a module of symbols.
    """
    sine, cosine = ops.sin(knee), ops.cos(knee)
    along = thigh * shank * cosine
    square, slope = thigh * thigh + shank * shank + 2.0 * along, shank * shank + along  # of hip to toe; times that
    curvature = thigh * shank * (shank * shank - thigh * thigh) * sine / (square * square)
    return ops.atan2(shank * sine, thigh + shank * cosine), slope / square, curvature


@typed
def find_legs(robot: LeggedRobot, toes: Iterable[str] | None = None, sides: Sides | None = None) -> tuple[Leg, ...]:
    """Returns the legs of a robot: limbs with two parallel joints in the sagittal plane, each with a toe at its end.

    The robot's own toes select them. In a robot without toes it finds the ends of the limbs, except for those that end
    above the others (arms). Joints that several limbs share, and those of a floating base, belong to no leg.
    A knee flexes to the side to which its limits leave it at least twice the room. Else it is the side to which it is
    bent with every joint at zero, or in the postures of `model.referenceConfigurations`, if these agree.

    Args:
        robot: a `Robot`, with its x axis forward and z up with every joint at zero.
        toes: frame names of the toes, one for each leg; None for the robot's toes.
        sides: +1 or -1 for each leg by its name, or for all legs (see `Leg.side`), instead of finding the side.

    Raises:
        UnknownName: there is no such frame, or no such leg.
        BadValue: the robot has closed loops, the limb of a given toe is no leg, or a side is neither +1 nor -1.
    """
    if robot.loops:
        raise BadValue("robot", robot, WITHOUT_LOOPS)
    model, tree = robot.model, Tree(robot.model)
    ends = tuple(toes) if toes is not None else robot.toes or tree.ends()
    tips: dict[int, str] = {}
    for toe in ends:  # the first of several at one foot
        tips.setdefault(int(model.frames[frame_id(model, toe)].parentJoint), toe)
    legs = []
    for tip, toe in tips.items():
        own = [joint for joint in tree.chain(tip) if _alone(joint, set(tips), model)]
        hip_and_knee = [joint for joint in own if tree.pitches(joint)][:2]
        leg = None
        if len(hip_and_knee) == 2:
            hip, knee = hip_and_knee
            leg = leg_along(tree, toe, own, hip, knee, tree.rails(own) if len(tips) == 1 else ())
        if leg is not None:
            legs.append(leg)
        elif toes is not None:
            raise BadValue("toes", toe, "frames, each below a knee and a hip that turn about the y axis")
    legs = _told_apart(legs)
    named = _named(legs, sides)
    shipped = SIDES.get(robot.source, {})
    found = {leg.name: named.get(leg.name) or side_of(tree, leg) or shipped.get(leg.name, 0) for leg in legs}
    return tuple(replace(leg, side=found[leg.name]) for leg in legs)


def lacking_legs(robot: LeggedRobot) -> str:
    """Describes what a robot without legs would need to have some, in words that follow "expected"."""
    if robot.loops:
        return WITHOUT_LOOPS
    usual = "a robot, x forward and z up, with a leg: a hip and a knee about the y axis, and a toe"
    return lacking_toe(robot) or usual


def lacking_toe(robot: LeggedRobot) -> str | None:
    """Describes a limb that has no frame at its end, in words that follow "expected"; None if there is none."""
    endless = [] if robot.toes else Tree(robot.model).endless()
    if not endless:
        return None
    remedy = "name a toe, such as a link on a fixed joint where the limb meets the ground"
    return f"a robot with toes: the limb below {endless[0]!r} ends without a frame: {remedy}"


def _told_apart(legs: Sequence[Leg]) -> list[Leg]:
    """Returns the legs, with the names of their toes where two would have the same name."""
    names = [leg.name for leg in legs]
    return [leg if names.count(leg.name) == 1 else replace(leg, name=leg.toe) for leg in legs]


def _named(legs: Sequence[Leg], sides: Sides | None) -> Mapping[str, int]:
    """Returns the given sides of legs by name."""
    names = [leg.name for leg in legs]
    named = sides if isinstance(sides, Mapping) else {} if sides is None else dict.fromkeys(names, sides)
    for name, side in named.items():
        if name not in names:
            raise UnknownName("leg", name, names)
        if isinstance(side, bool) or not isinstance(side, Real) or side not in (-1, 1):
            raise BadValue("sides", side, "+1 or -1, for each leg or for all")
    return {name: int(side) for name, side in named.items()}


def leg_name(toe: str) -> str:
    """Returns the name of a leg from its toe: "anterior" for "anterior_toe", "FL" for "FL_FOOT", "leg" for "toe"."""
    return re.sub(r"(?i)toe|foot", "", toe).strip("_-. ") or "leg"


def find_named_leg(model: pin.Model, legs: Sequence[Leg], leg: str | Leg) -> Leg:
    """Returns the leg with a name; a leg is returned as it is.

    Args:
        model: model of the robot.
        legs: legs of the robot.
        leg: the name of one of them, or a leg with joints of the robot.

    Raises:
        UnknownName: there is no such leg, or its joints or toe do not exist; the text lists the valid ones.
    """
    if isinstance(leg, Leg):
        for joint in (leg.hip, leg.knee):
            joint_id(model, joint, f"joint of leg {leg.name!r}")
        frame_id(model, leg.toe)
        return leg
    for each in legs:
        if each.name == leg:
            return each
    raise UnknownName("leg", leg, [each.name for each in legs])


def simple(leg: Leg) -> Leg:
    """Returns the leg if it has no moving joints besides hip, knee and abduction.

    Raises:
        BadValue: the leg has other joints, such as ankles.
    """
    if leg.others:
        expected = f"a leg of hip and knee only; lock {', '.join(leg.others)} by `locked`, of load or a TOML file"
        raise BadValue("leg", leg.name, expected)
    return leg


def in_convention(leg: Leg) -> Leg:
    """Returns the leg if its joints' own angles are those of the convention.

    Raises:
        BadValue: an axis or a zero differs.
    """
    if (leg.hip_sign, leg.knee_sign, leg.hip_zero, leg.knee_zero) != (1, 1, 0.0, 0.0):
        expected = "hip and knee with SPEAR-II's signs and zeros, as monopod(...) and sagittal(...) make them"
        raise BadValue("leg", leg.name, expected)
    return leg


def check_side(leg: Leg) -> Leg:
    """Returns the leg if it is known to which side its knee flexes.

    Raises:
        BadValue: the side is not known.
    """
    if not leg.side:
        expected = "a leg whose limits or postures show where its knee flexes; or give find_legs(robot, sides=...)"
        raise BadValue("leg", leg.name, expected)
    return leg


def leg_along(tree: Tree, toe: str, own: Sequence[int], hip: int, knee: int, rails: Collection[int] = ()) -> Leg | None:
    """Returns the leg that ends in a toe, without its side; None if its thigh or shank has no length.

    Args:
        tree: tree of the robot.
        toe: name of the toe's frame.
        own: joints of the leg, from the trunk on.
        hip: joint that turns the thigh in the sagittal plane.
        knee: joint that turns the shank in the sagittal plane.
        rails: joints among `own` on which the trunk slides.
    """
    model, data = tree.model, tree.data
    tip = data.oMf[frame_id(model, toe)].translation
    thigh, shank = (
        end - data.oMi[joint].translation for joint, end in ((hip, data.oMi[knee].translation), (knee, tip))
    )
    lengths = math.hypot(thigh[0], thigh[2]), math.hypot(shank[0], shank[2])
    if min(lengths) < SHORTEST:
        return None
    turned = math.atan2(thigh[0], -thigh[2])
    flexed = math.remainder(turned - math.atan2(shank[0], -shank[2]), math.tau)
    hip_sign, knee_sign = -int(np.sign(tree.axis(hip)[1])), int(np.sign(tree.axis(knee)[1]))
    above = [joint for joint in own[: own.index(hip)] if joint not in rails and not tree.floats(joint)]
    abduction = next((joint for joint in reversed(above) if tree.axis(joint).any()), None)
    others = [joint for joint in (*above, *own[own.index(hip) + 1 :]) if joint not in (abduction, knee)]
    return Leg(
        name=leg_name(toe),
        hip=str(model.names[hip]),
        knee=str(model.names[knee]),
        toe=toe,
        abduction=None if abduction is None else str(model.names[abduction]),
        side=0,
        thigh=lengths[0],
        shank=lengths[1],
        hip_sign=hip_sign,
        knee_sign=knee_sign,
        hip_zero=0.0 - hip_sign * turned,
        knee_zero=0.0 - knee_sign * flexed,
        across=float(tip[1] - data.oMi[hip].translation[1]),
        others=tuple(str(model.names[joint]) for joint in others),
    )


def side_of(tree: Tree, leg: Leg) -> int:
    """Returns the side to which a knee flexes, by its limits or by postures; 0 if they do not reveal it."""
    model = tree.model
    joint = model.joints[model.getJointId(leg.knee)]
    lower, upper = limits_of(model)[leg.knee].position
    down, up = leg.knee_zero - max(lower, -math.tau), min(upper, math.tau) - leg.knee_zero
    if up > ONE_WAY * max(down, 0.0) or down > ONE_WAY * max(up, 0.0):
        return 1 if up > down else -1
    postures = [pin.neutral(model), *(each.data() for each in model.referenceConfigurations)]
    bent = [math.remainder(_angle(joint, q) - leg.knee_zero, math.tau) for q in postures if q.size == model.nq]
    sides = {int(math.copysign(1, flexion)) for flexion in bent if abs(flexion) > BENT}
    return sides.pop() if len(sides) == 1 else 0


def _alone(joint: int, tips: set[int], model: pin.Model) -> bool:
    """Tells whether a joint carries only one of the tips."""
    return len(tips.intersection(map(int, model.subtrees[joint]))) == 1


def _angle(joint: Any, q: Array) -> float:
    """Returns a joint's angle in a configuration, in rad."""
    part = q[joint.idx_q : joint.idx_q + joint.nq]
    return float(part[0]) if joint.nq == 1 else math.atan2(part[1], part[0])
