"""The robot: mass matrix, bias, toe Jacobians and drift, by Pinocchio's CRBA and RNEA."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from types import MappingProxyType
from typing import Any

import numpy as np
import pinocchio as pin
import scipy
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, list_names
from spear_pin.model.coordinates import CONFIGURATION, VELOCITY, is_planar, parts_of, vector_of
from spear_pin.model.cut import Cut
from spear_pin.model.directions import WORLD_ALIGNED, Axes, Directions, Round
from spear_pin.model.feet import feet_of
from spear_pin.model.frames import frame_id
from spear_pin.model.legs import Leg, find_legs
from spear_pin.model.limits import Limits, limits_of
from spear_pin.model.loops import TOGGLE, Closure, Loop, Reduced
from spear_pin.model.named_legs import leg_of
from spear_pin.model.round_feet import round_feet
from spear_pin.model.settings import NONE_GIVEN, Settings
from spear_pin.printable import printable
from spear_pin.showing import Shown

UNCHANGED: Mapping[str, Any] = MappingProxyType({})
Added = Callable[[Array], tuple[int, float, float]]
"""Inertia μ(q) on one coordinate that no body of the model has: its row, μ, and dμ/dq along that coordinate."""
UNIT = 1e-4  # largest difference from 1 of the length of a quaternion in q
GUIDED, STILL = 8, 1e-9  # configurations at which a toe is seen to move along the ground, or not, and how little


class Robot(Shown):
    """A robot read from a URDF: D(q) v̇ + C(q, v) v + G(q) = B u + Σ Jᵀ F, (3.16).

    Build one with `spear_pin.load`. Queries take float64 arrays in SI units and radians, and return such
    arrays as copies. Rotor inertias enter D through `model.armature`, as N² J.
    A robot holds scratch memory of Pinocchio's, so give each thread its own.

    Attributes:
        name: name of the robot.
        model: the `pinocchio.Model`, its armature set. Do not change it; `with_model` makes a robot with another.
        coordinates: nv names, in the order of v. Those of a floating joint are the velocity and the
            angular velocity of its link in the link's own frame.
        configuration: nq names, in the order of q; a floating joint has its position and its quaternion.
        toes: frame names of the points that touch the ground.
        actuated: names of the joints that have a motor, in the order of u.
        locked: names of the joints that are held at zero.
        planar: whether everything moves in the x-z plane; positions are then two-dimensional.
        post: position, x and y in m, of the post about which it goes, if its settings give one.
        directions: directions in which the ground acts on its toes: x and z in the plane, x, y and z in space; round a
            post along a circle about it and vertically.
        dimension: number of these directions, 2 or 3.
        radii: radius of each round foot, in m, by its toe, the centre.
        feet: of each toe, all toes of its body, in their order, as heel and toe.
        arcs: arcs of round feet that have ends, by their toes.
        loops: closed loops, if its settings give any; `model` is the tree without them.
        closure: the constraints that close the loops, None without loops.
        reach: what a law calls hip and knee on a leg with loops, if its settings say so.
        source: registered name or path from which the robot was loaded.
        options: arguments of `load` that were given, by name: base, motors, repair.
        varied: numbers that differ from the source, by name (see `spear_pin.model.variants`).
        base: the model before numbers of bodies were changed, which is `model` if none were.
        added: inertia in addition to the model's, if there is any (see `spear_pin.model.boom`).
        cut: the robot out of which it was cut, if any (see `spear_pin.model.cut`).
        settings: settings from the TOML file in its folder (see `spear_pin.model.settings`).

    Example:
        >>> from spear_pin import load
        >>> robot = load("spear_ii", locked=["boom_x"])
        >>> robot.coordinates, robot.units
        (('boom_z', 'hip', 'knee'), ('m', 'rad', 'rad'))
        >>> robot.mass_matrix([0.55, 0.5, 1.0]).shape
        (3, 3)
    """

    def __init__(
        self,
        model: pin.Model,
        *,
        name: str,
        toes: Iterable[str],
        actuated: Sequence[str],
        locked: Sequence[str] = (),
        source: str = "",
        options: Mapping[str, Any] = UNCHANGED,
        varied: Mapping[str, float] = UNCHANGED,
        base: pin.Model | None = None,
        added: Added | None = None,
        cut: Cut | None = None,
        settings: Settings = NONE_GIVEN,
    ) -> None:
        self.added, self.cut, self.settings = added, cut, settings
        self.name, self.model, self.source = name, model, source or name
        self.base = model if base is None else base
        self.options: Mapping[str, Any] = MappingProxyType(dict(options))
        self.varied: Mapping[str, float] = MappingProxyType(dict(varied))
        self.toes, self.actuated, self.locked = tuple(toes), tuple(actuated), tuple(locked)
        self.nq, self.nv, self.nu = int(model.nq), int(model.nv), len(self.actuated)
        joints = list(zip(model.names, model.joints, strict=True))[1:]
        self.coordinates = tuple(each for name, joint in joints for each in parts_of(name, joint.nv, VELOCITY))
        self.configuration = tuple(each for name, joint in joints for each in parts_of(name, joint.nq, CONFIGURATION))
        self._data = pin.Data(model)
        self._toe_ids = {toe: frame_id(model, toe) for toe in self.toes}
        self.post = post = settings.post
        self.planar = post is None and is_planar(model, self._data)
        self._rows = np.array([0, 2]) if self.planar else np.array([0, 1, 2])
        self.loops: tuple[Loop, ...] = settings.loops
        self.reach = settings.reach
        flat = self.planar and self.nq == self.nv  # no joint has a cosine and a sine
        self.closure = Closure(model, self.coordinates, self.loops) if self.loops and flat else None
        radii, ends = settings.radii, settings.arcs
        self.radii = {toe: radii[toe] for toe in self.toes if toe in radii}
        feet = round_feet(model, self._toe_ids, self.radii, ends)
        self.arcs = {toe: foot.arc for toe, foot in feet.items() if foot.arc is not None}
        of_frames = {self._toe_ids[toe]: foot for toe, foot in feet.items()}
        self.feet = feet_of(model, self._toe_ids)
        self.directions: Directions = Axes(len(self._rows), of_frames) if post is None else Round(post)
        self.dimension = self.directions.dimension

    def __repr__(self) -> str:
        rest = f", locked={list(self.locked)}" if self.locked else ""
        rest += f", varied={dict(self.varied)}" if self.varied else ""
        sizes = f"nq={self.nq}, nv={self.nv}, nu={self.nu}"
        return f"Robot({printable(repr(self.name))}, {sizes}, toes={list(self.toes)}{rest})"

    def __reduce__(self) -> tuple[object, ...]:
        return _rebuild, (self.model, self._arguments() | {"base": None if self.base is self.model else self.base})

    def _arguments(self) -> dict[str, Any]:
        """Returns the arguments that made it, except for the model."""
        names = ("name", "toes", "actuated", "locked", "source", "added", "cut", "settings")
        plain = {"options": dict(self.options), "varied": dict(self.varied)}  # which can be pickled
        return {name: getattr(self, name) for name in names} | plain

    def with_model(self, model: pin.Model, **others: Any) -> Robot:
        """Returns the robot with another model of the same frames.

        Args:
            model: the model, with its new numbers.
            **others: attributes that are not those of this robot: varied, added, base. Without `base` it is `model`.
        """
        return Robot(model, **self._arguments() | others)

    @cached_property
    def arm(self) -> float | None:
        """Distance from its post to the plane in which its leg moves, with the boom level, in m.

        It is None for a robot that does not go round a post.
        """
        if self.post is None or not self.legs or self.model.joints[1].shortname() != "JointModelRZ":
            return None
        _, y, _ = self.frame_position(np.zeros(self.nq), self.legs[0].hip)
        return abs(float(y) - self.post[1])

    @cached_property
    def legs(self) -> tuple[Leg, ...]:
        """The legs that end in its toes, in their order; without toes, the legs that `find_legs` finds.

        A robot with closed loops has none. If its settings give legs joint by joint, it has these.
        """
        if self.loops:  # a leg is a chain of hip and knee
            return ()
        joints, given = set(self.model.names), self.settings.legs
        if legs := [each for each in given if each.toe in self.toes and {each.hip, each.knee} <= joints]:
            there = [each if each.abduction in joints else each._replace(abduction=None) for each in legs]
            return tuple(leg_of(self.model, each) for each in there)
        sides = (self.cut or self.settings).sides
        return tuple(replace(leg, side=sides.get(leg.name, leg.side)) for leg in find_legs(self))

    @cached_property
    def units(self) -> tuple[str, ...]:
        """Unit of each coordinate, "m" or "rad", (nv,)."""
        axes = (np.reshape(joint.S, (6, -1)) for joint in self._data.joints[1:])
        return tuple("m" if column[:3].any() else "rad" for each in axes for column in each.T)

    @property
    def mass(self) -> float:
        """Total mass, in kg, including the parts that are locked to the world."""
        return float(sum(inertia.mass for inertia in self.model.inertias))

    @property
    def weight(self) -> float:
        """Weight of the whole robot, in N, for any direction of gravity."""
        return self.mass * float(np.linalg.norm(self.model.gravity.linear))

    @property
    def actuation_matrix(self) -> Array:
        """B of (3.16), (nv, nu): the motor of column j acts on the coordinate of row i."""
        matrix = np.zeros((self.nv, self.nu))
        for column, joint in enumerate(self.actuated):
            matrix[self.index(joint), column] = 1.0
        return matrix

    @property
    def limits(self) -> dict[str, Limits]:
        """Limits of position, velocity and effort in the file, by the name of each joint of one degree of freedom."""
        return limits_of(self.model)

    def gear_ratio(self, joint: str) -> float:
        """Returns N, the turns of a joint's rotor per turn of the joint.

        Raises:
            UnknownName: there is no such joint, or it has no motor.
        """
        if joint not in self.actuated:
            raise UnknownName("joint with a motor", joint, self.actuated)
        return float(self.model.rotorGearRatio[self.index(joint)])

    def index(self, coordinate: str) -> int:
        """Returns the row of a coordinate in v.

        Raises:
            UnknownName: there is no such coordinate.
        """
        if coordinate not in self.coordinates:
            raise UnknownName("joint", coordinate, self.coordinates)
        return self.coordinates.index(coordinate)

    def toe_id(self, toe: str) -> int:
        """Returns the index of a toe's frame in `model.frames`.

        Raises:
            UnknownName: there is no such toe.
        """
        if toe not in self.toes:
            raise UnknownName("toe", toe, self.toes)
        return self._toe_ids[toe]

    def mass_matrix(self, q: ArrayLike) -> Array:
        """Returns D(q), (nv, nv), symmetric positive definite, by CRBA; reflected rotors are included.

        Raises:
            BadValue: q has the wrong length, or numbers that are not finite or far too large (as in every query).
        """
        configuration = self._q(q)
        matrix = np.array(pin.crba(self.model, self._data, configuration))
        if self.added is not None:
            row, inertia, _ = self.added(configuration)
            matrix[row, row] += inertia
        return matrix

    def coriolis_matrix(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Returns C(q, v), (nv, nv), of (3.16), with Ḋ - 2C skew-symmetric."""
        configuration, rates = self._q(q), self._v(v)
        matrix = np.array(pin.computeCoriolisMatrix(self.model, self._data, configuration, rates))
        if self.added is not None:
            row, _, slope = self.added(configuration)
            matrix[row, row] += 0.5 * slope * rates[row]
        return matrix

    def gravity(self, q: ArrayLike) -> Array:
        """Returns G(q), (nv,), of (3.16), in N or N·m."""
        return np.array(pin.computeGeneralizedGravity(self.model, self._data, self._q(q)))

    def bias(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Returns C(q, v) v + G(q), (nv,), by RNEA, in N or N·m."""
        configuration, rates = self._q(q), self._v(v)
        vector = np.array(pin.nonLinearEffects(self.model, self._data, configuration, rates))
        if self.added is not None:
            row, _, slope = self.added(configuration)
            vector[row] += 0.5 * slope * rates[row] ** 2
        return vector

    def kinetic_energy(self, q: ArrayLike, v: ArrayLike) -> float:
        """Returns ½ vᵀ D v, in J, rotors included (Pinocchio's own energy leaves them out for some joints)."""
        rates = self._v(v)
        return float(0.5 * rates @ self.mass_matrix(q) @ rates)

    def potential_energy(self, q: ArrayLike) -> float:
        """Returns the energy of gravity, in J, which is zero if every centre of mass is level with the origin."""
        fixed = self.model.inertias[0]  # the parts locked to the world, which Pinocchio leaves out
        held = float(-fixed.mass * self.model.gravity.linear @ fixed.lever)
        return float(pin.computePotentialEnergy(self.model, self._data, self._q(q)) + held)

    def frame_position(self, q: ArrayLike, frame: str) -> Array:
        """Returns the position of any frame of the URDF in the world, in m: (2,) x, z for planar robots, else (3,).

        Raises:
            UnknownName: there is no such frame.
        """
        index = frame_id(self.model, frame)
        pin.forwardKinematics(self.model, self._data, self._q(q))
        return np.array(pin.updateFramePlacement(self.model, self._data, index).translation[self._rows])

    def toe_position(self, q: ArrayLike, toe: str) -> Array:
        """Returns the position of a toe in the world, in m: (2,) x, z for planar robots, else (3,).

        Of a round foot it is the position of its lowest point.
        """
        index = self.toe_id(toe)
        pin.forwardKinematics(self.model, self._data, self._q(q))
        return np.array(self.directions.place(self.model, self._data, index)[self._rows])

    def toe_jacobian(self, q: ArrayLike, toe: str) -> Array:
        """Returns J(q) of (3.16), (2, nv) or (3, nv); the toe's velocity along the contact's `directions` is J v."""
        index = self.toe_id(toe)
        jacobian = pin.computeFrameJacobian(self.model, self._data, self._q(q), index, WORLD_ALIGNED)
        rows = jacobian.reshape(6, self.nv)  # of one joint it is a vector
        return np.array(self.directions.along(self.model, self._data, index, rows))

    def toe_drift(self, q: ArrayLike, v: ArrayLike, toe: str) -> Array:
        """Returns J̇ v of (3.17)-(3.18), in m/s², which is the toe's acceleration at v̇ = 0."""
        index = self.toe_id(toe)
        pin.forwardKinematics(self.model, self._data, self._q(q), self._v(v), np.zeros(self.nv))
        acceleration = pin.getFrameClassicalAcceleration(self.model, self._data, index, WORLD_ALIGNED)
        return np.array(self.directions.accelerated(self.model, self._data, index, acceleration.vector))

    @cached_property
    def guided(self) -> tuple[str, ...]:
        """Toes that move up and down only, in the plane, as one on a slider below a robot on a slider."""
        if not self.planar:
            return ()
        rng, neutral = np.random.default_rng(0), pin.neutral(self.model)
        some = [pin.integrate(self.model, neutral, rng.uniform(-1.0, 1.0, self.nv)) for _ in range(GUIDED)]
        free = [np.eye(self.nv)] * len(some)
        if self.closure is not None:
            dependent = [i for i, name in enumerate(self.coordinates) if name not in self.independent]
            some = self.closure.assembled(some, dependent)
            free = [scipy.linalg.null_space(self.loop_jacobian(q)) for q in some]
        found = []
        for toe in self.toes:
            along = [np.abs(self.toe_jacobian(q, toe)[0] @ moves).max() for q, moves in zip(some, free, strict=True)]
            if max(along, default=1.0) < STILL:
                found.append(toe)
        return tuple(found)

    @cached_property
    def independent(self) -> tuple[str, ...]:
        """Names of coordinates that determine all others; those that the loops do not tie are among them.

        Of the tied ones these are the ones that the file names, else those that have a motor by the file.
        """
        if self.closure is None:
            return self.coordinates
        own = self.settings.independent
        return tuple(name for name in self.coordinates if name not in self.closure.tied or name in own)

    def closed(self, q: ArrayLike) -> Array:
        """Closes the loops, and returns the configuration, (nv,); the independent coordinates stay as they are.

        Raises:
            BadValue: Newton's method finds no such configuration from this one.
        """
        near = self._q(q)
        if self.closure is None:
            return near
        free = [i for i, name in enumerate(self.coordinates) if name not in self.independent]
        found = self.closure.closed(near, free)
        if not np.isfinite(found).all():
            raise BadValue(
                "q", q, f"a configuration near one that closes {list_names([loop.name for loop in self.loops])}"
            )
        return found

    def loop_gap(self, q: ArrayLike) -> Array:
        """Returns φ(q), (m,), in m or rad: how far the loops are from closed; empty without loops."""
        return np.zeros(0) if self.closure is None else self.closure.at(self._q(q))[0]

    def loop_jacobian(self, q: ArrayLike) -> Array:
        """Returns A(q) = ∂φ/∂q, (m, nv)."""
        return np.zeros((0, self.nv)) if self.closure is None else self.closure.at(self._q(q))[1]

    def loop_drift(self, q: ArrayLike, v: ArrayLike) -> Array:
        """Returns Ȧ v, (m,), in m/s² or rad/s², the acceleration at which the ends of loops part at v̇ = 0."""
        if self.closure is None:
            return np.zeros(0)
        pin.forwardKinematics(self.model, self._data, self._q(q), self._v(v), np.zeros(self.nv))
        return self.closure.drift(self._data)

    def reduced(self, q: ArrayLike, rates: ArrayLike) -> Reduced:
        """Returns the equations of motion in the independent coordinates, with closed loops.

        With A = (A_i, A_d) it is T = (1, -A_d⁻¹ A_i) and c = (0, -A_d⁻¹ γ).

        Args:
            q: a configuration that closes the loops, or is near one with the same independent coordinates, (nv,).
            rates: rates of the independent coordinates, (n,).

        Raises:
            BadValue: the loops cannot be closed there, or they are at a toggle, where A_d is singular.
        """
        whole, names = self.closed(q), self.independent
        v_i = vector_of("rates", rates, len(names), names)
        free = np.array([name in names for name in self.coordinates])
        T, c = np.zeros((self.nv, len(names))), np.zeros(self.nv)
        T[free] = np.eye(len(names))
        if not free.all():
            A = self.loop_jacobian(whole)
            dependent = A[:, ~free]
            if np.linalg.cond(dependent) > TOGGLE:
                raise BadValue("q", q, "a configuration that is not a toggle of the loops")
            T[~free] = -np.linalg.solve(dependent, A[:, free])
            c[~free] = -np.linalg.solve(dependent, self.loop_drift(whole, T @ v_i))
        D, v = self.mass_matrix(whole), T @ v_i
        return Reduced(whole, v, T, c, T.T @ D @ T, T.T @ (self.bias(whole, v) + D @ c))

    def _q(self, q: ArrayLike) -> Array:
        vector = vector_of("q", q, self.nq, self.configuration)
        if self.nq != self.nv and not pin.isNormalized(self.model, vector, UNIT):
            raise BadValue("q", q, "a quaternion, or a cosine and a sine, of length 1")
        return vector

    def _v(self, v: ArrayLike) -> Array:
        return vector_of("v", v, self.nv, self.coordinates)


def _rebuild(model: pin.Model, arguments: Mapping[str, Any]) -> Robot:
    return Robot(model, **arguments)
