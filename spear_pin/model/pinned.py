"""A leg whose toe is pinned to the ground and whose hip slides: one degree of freedom, by projection.

This is the constraint of Section 4.1.2, (4.1)-(4.4), computed from the robot. The knee's angle θ determines
the other coordinates, q = q(θ) with S = dq/dθ, and the equations of motion projected on S are

    (Sᵀ D S) θ̈ + (Sᵀ D S' + Sᵀ C(q, S) S) θ̇² + Sᵀ G = τ,

where the factor of θ̇² is half the derivative of the effective inertia Sᵀ D S. Viscous friction that the URDF
gives to a joint, such as the slider, acts as Sᵀ diag(d) S θ̇.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property
from math import acos

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot

DEGREES = (16, 32, 64, 128, 256)
TAIL = 1e-14  # bound on a series' last coefficients, relative to its largest
PLACED = 1e-13  # m or rad: a Newton step below this counts as zero


@dataclass(frozen=True)
class Series:
    """Functions of the knee's angle as Chebyshev series, evaluated together.

    Attributes:
        span: the least and the largest angle, in rad.
        coefficients: coefficients of the series, (functions, degree + 1).
    """

    span: tuple[float, float]
    coefficients: Array

    @cached_property
    def orders(self) -> Array:
        """Numbers of the polynomials."""
        return np.arange(self.coefficients.shape[1], dtype=float)

    def __call__(self, angle: ArrayLike) -> Array:
        """Returns the values of the functions, (functions,) or (functions, n); beyond the span those at its end."""
        low, high = self.span
        place = np.clip((2.0 * np.asarray(angle) - low - high) / (high - low), -1.0, 1.0)
        return np.asarray(self.coefficients @ np.cos(np.multiply.outer(self.orders, np.arccos(place))))

    def at(self, angle: float) -> Array:
        """Returns the values at one angle, in a quarter of the time; integrations call this most."""
        low, high = self.span
        place = min(max((2.0 * angle - low - high) / (high - low), -1.0), 1.0)
        return np.asarray(self.coefficients @ np.cos(acos(place) * self.orders))

    def derivative(self) -> Series:
        """Returns the derivatives with respect to the angle."""
        rows = [chebyshev.Chebyshev(row, domain=self.span).deriv().coef for row in self.coefficients]
        return Series(self.span, np.array(rows))


@dataclass(frozen=True)
class PinnedLeg:
    """The one-degree-of-freedom model of the push test.

    Attributes:
        robot: the leg, with its boom locked along the ground and its toe free.
        joint: name of the remaining coordinate, the knee's.
        span: least and largest angle, in rad, the joint's limits.
        rotor: inertia of the joint's rotor, reflected to it, in kg·m²; part of the effective inertia.
        configuration: q(θ).
        motion: Sᵀ D S, half its derivative, and Sᵀ G, in kg·m² and N·m.
        drag: Sᵀ diag(d) S, in N·m·s/rad.
        reaction: ground force, x and z, per θ̈, per θ̇², at rest and per θ̇, in N.
    """

    robot: Robot
    joint: str
    span: tuple[float, float]
    rotor: float
    configuration: Series = field(repr=False)
    motion: Series = field(repr=False)
    drag: Series = field(repr=False)
    reaction: Series = field(repr=False)

    @cached_property
    def motion_with_slopes(self) -> Series:
        """The rows of `motion`, their derivatives with respect to θ, then `drag` and its derivative."""
        rows = [part for series in (self.motion, self.drag) for part in (series, series.derivative())]
        widest = self.motion.coefficients.shape[1]
        padded = [np.pad(part.coefficients, ((0, 0), (0, widest - part.coefficients.shape[1]))) for part in rows]
        return Series(self.span, np.vstack(padded))

    def with_rotor(self, inertia: float) -> PinnedLeg:
        """Returns the leg with another reflected rotor inertia at the joint, in kg·m²; 0 is none.

        Raises:
            BadValue: the inertia is not a finite number >= 0.
        """
        require("inertia", inertia, lambda value: value >= 0, "a number >= 0, in kg·m²")
        if inertia == self.rotor:
            return self
        coefficients = self.motion.coefficients.copy()
        coefficients[0, 0] += inertia - self.rotor
        model = self.robot.model.copy()
        model.armature[self.robot.index(self.joint)] = inertia
        robot = self.robot.with_model(model)
        return replace(self, robot=robot, rotor=float(inertia), motion=Series(self.span, coefficients))

    def effective_inertia(self, angle: ArrayLike) -> Array:
        """Returns the effective inertia Sᵀ D S, in kg·m², rotors included."""
        return np.asarray(self.motion(angle)[0])

    def gravity(self, angle: ArrayLike) -> Array:
        """Returns Sᵀ G, in N·m, the knee's torque that holds the leg; negative if the weight flexes the knee."""
        return np.asarray(self.motion(angle)[2])

    def acceleration(self, angle: ArrayLike, rate: ArrayLike, torque: ArrayLike) -> Array:
        """Returns θ̈ under a torque on the joint, in rad/s²."""
        inertia, centrifugal, gravity = self.motion(angle)
        acting = torque - self.drag(angle)[0] * np.asarray(rate) - gravity
        return np.asarray((acting - centrifugal * np.square(rate)) / inertia)

    def hip_height(self, angle: ArrayLike) -> Array:
        """Returns the height of the slider, the first coordinate, in m; for SPEAR-II the hip's above the toe, (4.2)."""
        return np.asarray(self.configuration(angle)[0])

    def ground_force(self, angle: ArrayLike, rate: ArrayLike, acceleration: ArrayLike) -> Array:
        """Returns the ground's force on the toe, x and z, in N, (2,) or (2, n); the pin pulls where z is negative."""
        inertial, centrifugal, resting, dragging = self.reaction(angle).reshape(4, 2, *np.shape(angle))
        moving = inertial * np.asarray(acceleration) + centrifugal * np.square(rate)
        return np.asarray(moving + resting + dragging * np.asarray(rate))


@typed
def pin_toe(robot: Robot, joint: str = "knee", span: tuple[float, float] | None = None) -> PinnedLeg:
    """Pins the toe of a leg at the origin, below its hip, and leaves one joint free.

    Args:
        robot: a planar robot with one toe and three coordinates: first the height, then two joints.
        joint: the remaining joint, with finite limits in the URDF.
        span: its least and largest angle, in rad; None for those limits.

    Raises:
        BadValue: the robot is not such a leg, or some angle within the joint's limits cannot be reached
            with the toe below the hip.
        UnknownName: there is no such joint.
    """
    row = robot.index(joint)
    if not robot.planar or robot.nv != 3 or robot.nq != 3 or len(robot.toes) != 1 or row == 0:
        expected = 'a planar leg with one toe, a height and two joints; give locked=["boom_x"] to `load` or `monopod`'
        raise BadValue("robot", robot, expected)
    if span is None:
        span = float(robot.model.lowerPositionLimit[row]), float(robot.model.upperPositionLimit[row])
    if not (np.isfinite(span).all() and span[0] < span[1] and max(np.abs(span)) < 2 * np.pi):
        raise BadValue(f"limits of {joint}", span, "two angles, in rad; give others by span=, such as span=(-0.2, 2.5)")
    if np.abs(robot.toe_jacobian(np.zeros(3), robot.toes[0])[:, 0] - (0.0, 1.0)).max() > PLACED:
        raise BadValue("robot", robot, "a leg whose first coordinate is the height")
    half, middle = 0.5 * (span[1] - span[0]), 0.5 * (span[0] + span[1])
    for degree in DEGREES:
        coefficients = chebyshev.chebinterpolate(lambda places: _rows(robot, row, middle + half * places), degree).T  # type: ignore[type-var]
        largest = np.abs(coefficients).max(axis=1, initial=1.0)
        if (np.abs(coefficients[:, -3:]).max(axis=1) <= TAIL * largest).all():
            needed = int(np.flatnonzero((np.abs(coefficients) > TAIL * largest[:, None]).any(axis=0))[-1]) + 1
            parts = np.split(coefficients[:, :needed], (3, 6, 7))
            return PinnedLeg(robot, joint, span, float(robot.model.armature[row]), *(Series(span, p) for p in parts))
    raise BadValue(f"limits of {joint}", span, "angles at which the toe can be below the hip; give others by span=")


def _rows(robot: Robot, row: int, angles: Array) -> Array:
    """Returns the values of `PinnedLeg`'s series, one row an angle: configuration 3, motion 3, drag 1, reaction 8."""
    table = np.empty((angles.size, 15))
    for side in (angles >= 0, angles < 0):  # from the straight leg outward, each from the one before
        q = np.zeros(3)
        for i in sorted(np.flatnonzero(side), key=lambda i: abs(angles[i])):
            q = _placed(robot, row, q, float(angles[i]))
            table[i] = np.concatenate([q, *_projected(robot, row, q)])
    return table


def _placed(robot: Robot, row: int, q: Array, angle: float) -> Array:
    """Finds the configuration with the toe at the origin and the joint at an angle, by Newton's method."""
    q = q.copy()
    q[row] = angle
    for _ in range(50):
        jacobian = np.delete(robot.toe_jacobian(q, robot.toes[0]), row, axis=1)
        step = np.linalg.solve(jacobian, -robot.toe_position(q, robot.toes[0]))
        q += np.insert(step, row, 0.0)
        if np.abs(step).max() < PLACED:
            return q
    raise BadValue("robot", robot, f"a leg whose toe reaches the ground below its hip at {angle:g} rad")


def _projected(robot: Robot, row: int, q: Array) -> tuple[Array, Array]:
    """Returns the equations of motion along the joint, and on the toe, each per θ̈, per θ̇², at rest and per θ̇."""
    jacobian = robot.toe_jacobian(q, robot.toes[0])
    dependent = np.delete(jacobian, row, axis=1)
    along = np.insert(np.linalg.solve(dependent, -jacobian[:, row]), row, 1.0)  # S
    bend = np.insert(np.linalg.solve(dependent, -robot.toe_drift(q, along, robot.toes[0])), row, 0.0)  # S'
    mass_matrix, gravity = robot.mass_matrix(q), robot.gravity(q)
    centrifugal = mass_matrix @ bend + robot.bias(q, along) - gravity
    terms = np.array([mass_matrix @ along, centrifugal, gravity, robot.model.damping * along])
    forces = np.linalg.solve(dependent.T, np.delete(terms, row, axis=1).T).T
    return terms @ along, forces.ravel()
