"""Symmetries of motion in space on level ground: translation, rotation, and reflection of left and right."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.result import State
from spear_pin.model.chain import CHAIN
from spear_pin.model.robot import Robot
from spear_pin.model.sagittal import ACROSS, NEAR
from spear_pin.model.tree import Tree

X, Y, Z, YAW, PITCH, ROLL = range(len(CHAIN))
ODD = (Y, YAW, ROLL)
"""Coordinates of the base that change sign in the mirror."""
ALIKE = 1e-6  # rad: largest difference between the zeros of corresponding joints


def turn_state(q: Array, v: Array, yaw: float, place: Sequence[float] = (0.0, 0.0)) -> State:
    """Turns a state about z by an angle, in rad, and then moves it by a vector (x, y), in m."""
    q, v = np.array(q, dtype=float), np.array(v, dtype=float)
    c, s = math.cos(yaw), math.sin(yaw)
    turn = np.array([[c, -s], [s, c]])
    q[:2], v[:2] = turn @ q[:2] + place, turn @ v[:2]
    q[YAW] += yaw
    return q, v


def head_state(q: Array, v: Array) -> State:
    """Moves and turns a state so that x = y = yaw = 0."""
    q, v = turn_state(q, v, -float(q[YAW]))
    q[:2] = 0.0
    return q, v


@dataclass(frozen=True)
class Mirror:
    """Reflection at the x-z plane, which exchanges left and right.

    Attributes:
        of: index of the coordinate that each coordinate becomes, (nv,).
        signs: sign with which it does so, (nv,).
    """

    of: tuple[int, ...]
    signs: tuple[float, ...]

    def __call__(self, vector: Array) -> Array:
        """Reflects a configuration, a velocity or a force over the coordinates, (..., nv)."""
        seen = np.empty_like(vector)
        seen[..., list(self.of)] = vector * self.signs
        return seen

    def parts(self, coordinates: Sequence[int]) -> tuple[Array, Array]:
        """Returns orthonormal bases, (nv, k) each, of the symmetric and antisymmetric parts of some coordinates."""
        nv, parts = len(self.of), ([], [])  # type: tuple[int, tuple[list[Array], list[Array]]]
        for i in coordinates:
            unit = np.eye(nv)[i]
            if self.of[i] == i:
                parts[self.signs[i] < 0.0].append(unit)
            elif i < self.of[i]:
                for part, sign in zip(parts, (1.0, -1.0), strict=True):
                    part.append((unit + sign * self(unit)) / math.sqrt(2.0))
        even, odd = (np.array(part).reshape(-1, nv).T for part in parts)
        return even, odd


def asymmetry(robot: Robot, state: State) -> float:
    """Returns the largest difference between a state and its mirror image, in SI units."""
    mirror = mirror_of(robot)
    return max(float(np.abs(mirror(part) - part).max()) for part in head_state(*state))


def measure_asymmetry(robot: Robot) -> float:
    """Measures how far a robot on a chain is from its mirror image.

    Returns the largest difference of its masses, of D_ij over √(D_ii D_jj), and of its feet's positions, in m, in a
    posture.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.hybrid.symmetry import measure_asymmetry
        >>> measure_asymmetry(load("q_spear_full", base="chain")) < 1e-12
        True
    """
    mirror, q = mirror_of(robot), np.sin(np.arange(1.0, robot.nv + 1.0)) / 2.0
    own, image = robot.mass_matrix(q), robot.mass_matrix(mirror(q))
    size = np.sqrt(np.diag(own))
    masses = np.abs(mirror(mirror(image).T) - own) / np.outer(size, size)
    feet = {robot.index(leg.hip): leg.toe for leg in robot.legs}
    here, there = ({hip: robot.frame_position(at, toe) for hip, toe in feet.items()} for at in (q, mirror(q)))
    off = [there[mirror.of[hip]] * ACROSS - here[hip] for hip in feet]
    return max(float(masses.max()), float(np.abs(off).max()))


def even_out(robot: Robot) -> Robot:
    """Returns a robot whose bodies average their inertia with that of their partner's mirror image.

    Its left and right are alike if the joints and feet of the given robot, which is left unchanged, are.

    Args:
        robot: a robot on a chain.

    Raises:
        BadValue: the robot has no mirror, see `mirror_of`.

    Example:
        >>> from spear_pin import load
        >>> from spear_pin.hybrid.symmetry import even_out
        >>> robot = load("q_spear_full", base="chain")
        >>> abs(even_out(robot).mass - robot.mass) < 1e-12
        True
    """
    mirror, model, across = mirror_of(robot), robot.model.copy(), np.diag(ACROSS)
    data = model.createData()
    pin.forwardKinematics(model, data, np.zeros(robot.nq))
    joints = {model.joints[i].idx_v: i for i in range(1, model.njoints)}
    bodies = {i: data.oMi[i].act(robot.model.inertias[i]) for i in joints.values()}  # about the origin of the world
    for row, i in joints.items():
        own, partner = bodies[i], bodies[joints[mirror.of[row]]]
        if own.mass + partner.mass == 0.0:
            continue  # a link of the chain
        image = pin.Inertia(partner.mass, across @ partner.lever, across @ partner.inertia @ across)
        both = data.oMi[i].actInv(own + image)
        model.inertias[i] = pin.Inertia(0.5 * both.mass, both.lever, 0.5 * both.inertia)
    return robot.with_model(model)


def partner(robot: Robot, name: str) -> tuple[str, float]:
    """Returns the joint, toe or spring of a robot on a chain that another one mirrors, and a joint's sign."""
    mirror = mirror_of(robot)
    if name in robot.coordinates:
        i = robot.index(name)
        return robot.coordinates[mirror.of[i]], mirror.signs[i]
    legs = {robot.index(leg.hip): leg for leg in robot.legs}
    hip, own = next((i, leg) for i, leg in legs.items() if name == leg.toe or name.startswith(f"{leg.name}_"))
    other = legs[mirror.of[hip]]
    return other.toe if name == own.toe else f"{other.name}_{name.removeprefix(f'{own.name}_')}", 1.0


def mirror_of(robot: Robot) -> Mirror:
    """Returns the mirror of a robot on a chain.

    Each joint turns as the mirror image of its partner on the other side does, whatever the sense of their axes. If the
    axes are alike, adductions, which turn about the forward direction, change sign; hips and knees do not. A robot that
    is not exactly symmetric gets the mirror of a symmetric robot.

    Raises:
        BadValue: the base is no chain, a leg has no partner on the other side, or its joints have another zero than
            the partner's.
    """
    if robot.coordinates[: len(CHAIN)] != CHAIN:
        raise BadValue("robot", robot, 'one on a chain, load(..., base="chain")')
    of, signs = list(range(robot.nv)), [-1.0 if i in ODD else 1.0 for i in range(robot.nv)]
    upright, tree = np.zeros(robot.nq), Tree(robot.model)
    hips = {leg.name: robot.frame_position(upright, leg.hip) for leg in robot.legs}
    for leg in robot.legs:
        place = hips[leg.name] * ACROSS
        partner = min(robot.legs, key=lambda each: float(np.abs(hips[each.name] - place).max()))
        if np.linalg.norm(hips[partner.name] - place) > NEAR * (leg.thigh + leg.shank):
            raise BadValue("robot", robot, f"one in which {leg.name!r} has a partner on the other side")
        joints = (leg.abduction, partner.abduction), (leg.hip, partner.hip), (leg.knee, partner.knee)
        for own, other in joints:
            if own is not None and other is not None:
                axes = [tree.axis(robot.model.getJointId(joint)) for joint in (own, other)]
                of[robot.index(own)] = robot.index(other)
                signs[robot.index(own)] = -float(np.sign(axes[1] @ (axes[0] * ACROSS)))
        zeros = (leg.hip, leg.hip_zero, partner.hip_zero), (leg.knee, leg.knee_zero, partner.knee_zero)
        for joint, zero, its in zeros:
            if abs(its - signs[robot.index(joint)] * zero) > ALIKE:
                raise BadValue(
                    f"zero of {joint}",
                    zero,
                    f"{signs[robot.index(joint)] * its:g}, in rad, the mirror image of its partner's zero",
                )
    return Mirror(tuple(of), tuple(signs))
