"""The sagittal plane of a quadruped: each pair of legs as one, with the coordinates and the signs of `load("q_spear")`.

If left and right are mirror images and move alike, with the trunk in the plane, this is exactly the robot.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.kinds import typed
from spear_pin.model.cut import AHEAD, PITCH, UP, Amount, Assembly, Cut, Limb, Source, Turn, flat, products
from spear_pin.model.legs import Leg, find_named_leg, lacking_toe, simple
from spear_pin.model.robot import Robot

ENDS = ("posterior", "anterior")
NEAR = 0.25  # largest distance of a hip from the mirror image of its partner, relative to a leg's length
UNLIKE = 0.05  # largest difference between two thighs, or shanks, of a pair, relative to the longer
PAIRS = "two pairs of different legs, in each the left and the right one"
ACROSS = np.array([1.0, -1.0, 1.0])


@typed
def sagittal(robot: Robot, pairs: Sequence[Sequence[str | Leg]] | None = None) -> Robot:
    """Returns a quadruped in the sagittal plane, with left and right legs lumped into pairs, as in Q-SPEAR.

    Its coordinates are "torso_x", "torso_z", "pitch" and hip and knee of the posterior and the anterior pair. torso_x
    and torso_z belong to the frame of the floating base, or of the root link. Pitch is positive nose up, a hip with the
    knee forward, a knee with the shank backward, and zero with the leg straight. Masses, inertias, rotors, friction and
    torques of a pair are the sums over both legs. Every other joint is held at zero, and all other bodies belong to the
    trunk. `Robot.cut`, which can be printed, tells how far left and right differ, and what is left out.

    Args:
        robot: a quadruped, with its x axis forward and z up with every joint at zero.
        pairs: the left and the right leg of each pair, by their names in `robot.legs` or from `find_legs`; by default
            those of `robot.settings`, else those whose hips mirror each other.

    Raises:
        UnknownName: there is no such leg.
        BadValue: the robot does not have two such pairs, or its legs have other joints; or the legs of a pair differ in
            length by more than a twentieth, or in having motors, or their limits have no angle in common.

    Example:
        >>> from spear_pin import load, sagittal
        >>> plane = sagittal(load("q_spear_full"))
        >>> plane.actuated
        ('posterior_hip', 'posterior_knee', 'anterior_hip', 'anterior_knee')
    """
    source = Source(robot)
    if robot.radii:
        raise BadValue("robot", robot, "one without round feet, which its plane does not keep")
    found = _pairs(source, pairs)
    origin = _origin(source)
    trunk = pin.SE3(np.eye(3), -origin).act(source.lump(source.rest(leg for pair in found for leg in pair.legs)))
    built = _assembled(f"{robot.name}_sagittal", robot, trunk, origin, found)
    angles = {
        f"{end}_{part}": tuple(limb.turns[i] for limb in pair.limbs)
        for end, pair in zip(ENDS, found, strict=True)
        for i, part in enumerate(("hip", "knee"))
    }
    built.carry(robot, angles)
    return Robot(
        built.model,
        name=built.model.name,
        toes=[f"{end}_toe" for end in ENDS],
        actuated=[name for name, turns in angles.items() if _driven(robot, turns)],
        source=f"sagittal({robot.source!r})",
        settings=robot.settings.of_cut(angles),
        cut=Cut(
            kind="sagittal",
            of=robot.name,
            source=robot.source,
            body=float(trunk.mass),
            angles=angles,
            held=_held(robot, angles),
            robot=robot,
            legs=tuple(pair.legs for pair in found),
            sides={end: pair.bends for end, pair in zip(ENDS, found, strict=True) if pair.bends},
            asymmetric=_asymmetric(robot, found, trunk, origin),
            neglected=_neglected(found, trunk),
        ),
    )


@dataclass(frozen=True)
class Pair:
    """A left and a right leg.

    Attributes:
        legs: left, then right.
        limbs: limbs of both legs.
    """

    legs: tuple[Leg, Leg]
    limbs: tuple[Limb, Limb]

    @property
    def hip(self) -> Array:
        """Position midway between the hips, (3,), in m."""
        return np.asarray(0.5 * (self.limbs[0].hip + self.limbs[1].hip))

    @property
    def bends(self) -> int:
        """+1 if the knees point forward as they flex, -1 if backward, where both legs are alike."""
        left, right = (leg.bends for leg in self.legs)
        return left if left == right else 0

    @property
    def limb(self) -> Limb:
        """Returns both limbs as one."""
        left, right = self.limbs
        thigh, shank = np.mean([left.lengths, right.lengths], axis=0)
        lengths = float(thigh), float(shank)
        return Limb(left.turns, left.thigh + right.thigh, left.shank + right.shank, lengths, self.hip)


def leg_pairs(robot: Robot) -> tuple[tuple[Leg, Leg], tuple[Leg, Leg]]:
    """Returns the left and the right leg of the posterior and of the anterior pair, as `sagittal` finds them.

    Raises:
        UnknownName: there is no such leg.
        BadValue: the robot does not have two such pairs, see `sagittal`.
    """
    posterior, anterior = _pairs(Source(robot), None)
    return posterior.legs, anterior.legs


def _pairs(source: Source, pairs: Sequence[Sequence[str | Leg]] | None) -> list[Pair]:
    if pairs is None:
        pairs = source.robot.settings.pairs or None
    return _found(source) if pairs is None else _given(source, pairs)


def _found(source: Source) -> list[Pair]:
    """Finds the pairs of legs whose hips mirror each other, posterior first.

    Raises:
        BadValue: the number of pairs is not two.
    """
    limbs = {leg: source.limb(leg) for leg in source.robot.legs}
    middle = _origin(source)[1]
    lefts = [leg for leg, limb in limbs.items() if limb.hip[1] > middle]
    pairs = []
    for left in lefts:
        image = limbs[left].hip * ACROSS + (0.0, 2.0 * middle, 0.0)
        others = {leg: float(np.linalg.norm(limb.hip - image)) for leg, limb in limbs.items() if leg not in lefts}
        right = min(others, key=lambda leg: others[leg], default=None)
        if right is not None and others[right] <= NEAR * (left.thigh + left.shank):
            pairs.append((left, right))
    matched = {leg for pair in pairs for leg in pair}
    if len(pairs) != 2 or len(matched) != 4 or len(limbs) != 4:
        names = ", ".join(leg.name for leg in limbs) or "none"
        expected = f"four legs (found: {names}), x forward and z up, whose hips mirror each other; or give pairs"
        if len(limbs) == 1:
            expected += f"; for a hop of this one leg type `--leg {names}`, in Python monopod(robot, {names!r})"
        raise BadValue("robot", source.robot, lacking_toe(source.robot) or expected)
    return _paired(source, pairs)


def _given(source: Source, pairs: Sequence[Sequence[str | Leg]]) -> list[Pair]:
    """Returns the given pairs, posterior first.

    Raises:
        BadValue: these are not two pairs of two legs.
    """
    if not all(isinstance(pair, Sequence) and not isinstance(pair, str) and len(pair) == 2 for pair in pairs):
        raise BadValue("pairs", pairs, PAIRS)
    legs = [[find_named_leg(source.model, source.robot.legs, leg) for leg in pair] for pair in pairs]
    if len(legs) != 2 or len({leg.hip for pair in legs for leg in pair}) != 4:
        raise BadValue("pairs", pairs, PAIRS)
    return _paired(source, [(left, right) for left, right in legs])


def _paired(source: Source, legs: Iterable[tuple[Leg, Leg]]) -> list[Pair]:
    pairs = [Pair(pair, (source.limb(simple(pair[0])), source.limb(simple(pair[1])))) for pair in legs]
    for left, right in (pair.legs for pair in pairs):
        for part, one, other in (("thighs", left.thigh, right.thigh), ("shanks", left.shank, right.shank)):
            if abs(one - other) > UNLIKE * max(one, other):
                expected = f"lengths, in m, that differ by {UNLIKE:.0%} at most, to be lumped into one leg"
                raise BadValue(f"{part} of {left.name} and {right.name}", (one, other), expected)
    behind, ahead = sorted(pairs, key=lambda pair: float(pair.hip[0]))
    if max(limb.hip[0] for limb in behind.limbs) >= min(limb.hip[0] for limb in ahead.limbs):
        names = [tuple(leg.name for leg in pair.legs) for pair in (behind, ahead)]
        raise BadValue("pairs", names, f"{PAIRS}, and one pair behind the other")
    return [behind, ahead]


def _origin(source: Source) -> Array:
    """Returns the origin of the floating base, or of the root link, with every joint at zero, (3,), in m."""
    floats = source.model.njoints > 1 and source.model.joints[1].nv == 6
    return np.array(source.data.oMi[1].translation if floats else np.zeros(3))


def _assembled(name: str, robot: Robot, trunk: pin.Inertia, origin: Array, pairs: Sequence[Pair]) -> Assembly:
    built = Assembly(name, robot.model.gravity)
    ahead = built.add("torso_x", AHEAD, 0, "torso_carriage_x")
    up = built.add("torso_z", UP, ahead, "torso_carriage_z")
    torso = built.add("pitch", PITCH, up, "torso", flat(trunk))
    for end, pair in zip(ENDS, pairs, strict=True):
        x, _, z = pair.hip - origin
        built.add_leg(f"{end}_", torso, pair.limb, (x, z))
    return built


def _driven(robot: Robot, turns: Sequence[Turn]) -> bool:
    """Tells whether the joints of a pair have motors.

    Raises:
        BadValue: only one of the two has a motor.
    """
    joints = [turn.joint for turn in turns]
    without = [joint for joint in joints if joint not in robot.actuated]
    if without and len(without) < len(joints):
        expected = f"motors on both joints of a pair, or on none: {', '.join(without)} has none (load(..., motors=...))"
        raise BadValue("robot.actuated", robot.actuated, expected)
    return not without


def _held(robot: Robot, angles: Mapping[str, Sequence[Turn]]) -> tuple[str, ...]:
    """Returns the joints held at zero, without the floating base, and the joints that the robot had locked."""
    moving = {turn.joint for turns in angles.values() for turn in turns}
    joints = list(zip(robot.model.names, robot.model.joints, strict=True))[1:]
    held = (str(name) for name, joint in joints if name not in moving and joint.nv != 6)
    return (*held, *robot.locked)


def _asymmetric(robot: Robot, pairs: Sequence[Pair], trunk: pin.Inertia, origin: Array) -> tuple[Amount, ...]:
    """Measures how far left and right are from each other's mirror images."""
    hips, lengths, masses, places, inertias, rotors = [], [], [], [], [], []
    for pair in pairs:
        left, right = pair.limbs
        hips.append(np.linalg.norm((left.hip - origin) - (right.hip - origin) * ACROSS))
        lengths.append(np.abs(np.subtract(left.lengths, right.lengths)).max())
        for one, other in ((left.thigh, right.thigh), (left.shank, right.shank)):
            masses.append(abs(one.mass - other.mass))
            places.append(np.linalg.norm((one.lever - (0, origin[1], 0)) - (other.lever - (0, origin[1], 0)) * ACROSS))
            inertias.append(np.abs(one.inertia - other.inertia * np.outer(ACROSS, ACROSS)).max())
        for turns in zip(left.turns, right.turns, strict=True):
            rows = [robot.index(turn.joint) for turn in turns]
            rotors.append(abs(float(np.subtract(*robot.model.armature[rows]))))
    return (
        Amount("hips by", float(max(hips)), "m"),
        Amount("lengths by", float(max(lengths)), "m"),
        Amount("masses by", float(max(masses)), "kg"),
        Amount("centres of mass by", float(max(places)), "m"),
        Amount("inertias by", float(max(inertias)), "kg·m²"),
        Amount("rotors by", max(rotors), "kg·m²"),
        Amount("the trunk's centre of mass from the middle by", abs(float(trunk.lever[1])), "m"),
    )


def _neglected(pairs: Sequence[Pair], trunk: pin.Inertia) -> tuple[Amount, ...]:
    """Returns the amounts out of the plane, or out of the plane of a leg."""
    across = max(abs(leg.across) for pair in pairs for leg in pair.legs)
    return (
        Amount("toes out of their hips' planes by", across, "m"),
        products([trunk, *(body for pair in pairs for body in (pair.limb.thigh, pair.limb.shank))]),
    )
