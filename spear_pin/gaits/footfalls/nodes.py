"""Nodes of the programme: their unknowns, with guesses and bounds, and the dynamics at the nodes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.collocation import Programme, casadi, node_name
from spear_pin.gaits.footfalls.sequence import Footfalls
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.request import Wishes
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.mechanism import Mechanism
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale
from spear_pin.model.spring import Spring

WITHIN, AWAY = 0.95, 0.01  # share of torque and rate limits, rad from angle limits; error needs it
HARDEST, STRONGEST = 2000.0, 4000.0  # m/s² or rad/s², N of a leg of Q-SPEAR
Part = str  # of a leg: "hip", "knee" or "adduction"


@dataclass(frozen=True)
class Node:
    """Unknowns at one node, and quantities that follow from them.

    Attributes:
        q: configuration.
        v: velocity.
        a: acceleration.
        F: force on each foot on the ground, two or three numbers each.
        needed: forces along the coordinates that the motion needs, including those of springs and dampers.
        toes: position, velocity and acceleration of each leg's toe.
    """

    q: Any
    v: Any
    a: Any
    F: Mapping[str, Any]
    needed: Any
    toes: Mapping[str, tuple[Any, Any, Any]]


class Free(NamedTuple):
    """A number that the search chooses.

    Attributes:
        name: its name among the unknowns.
        guess: initial value.
        lower: least value.
        upper: largest value.
        scale: scale by which it is divided internally.
    """

    name: str
    guess: float
    lower: float
    upper: float
    scale: float = 1.0


class Support(NamedTuple):
    """The law for torques of legs on the ground, in the form of `StanceLaw`.

    Attributes:
        stiffness: k of a knee.
        knee_rest: flexion from which it counts, and at which a leg lifts off.
        knee_touchdown: flexion at touchdown.
        constants: guess, least and largest value of the constants of hip, knee and adduction.
        upright: stiffness and damping of the adduction on the ground, and its ε in the air.
        by_force: whether a leg lifts off where its foot carries no force, not where its knee is back at rest.
    """

    stiffness: Any
    knee_rest: float
    knee_touchdown: Any
    constants: Mapping[Part, tuple[float, float, float]]
    upright: tuple[float, float, float] = (0.0, 0.0, 1.0)
    by_force: bool = False


@dataclass(frozen=True)
class Room:
    """What a robot and a request for it allow, in the plane or in space. Numbers are in SI units.

    Attributes:
        robot: the robot.
        request: the request for the gait.
        footfalls: which legs are on the ground, and how many intervals each phase has.
        names: names of the phases among the unknowns.
        limbs: the robot's legs, by name.
        scale: the robot's size.
        mechanism: the robot's dynamics for symbols.
        base: number of coordinates of the torso.
        configurations: least and largest q, (nv,).
        rates: largest velocities, (nv,).
        effort: limits of the motors' torques, (nv - base,), infinite where there is none.
        durations: guess, least and largest duration of each phase.
        stride: least and largest duration of a whole stride.
        push: guess of the upward force on a foot on the ground.
        posture: returns a rough configuration, by the number of a phase and the fraction of it that has passed.
        guess: returns the guess of configuration and velocity, by the same.
        height: returns the least height of the foot of a leg in the air, by the number of a phase, the leg and the
            fraction of the phase; None where the foot may be on the ground.
        landing: bounds of the leg angle at touchdown.
        falls: least speed of a landing foot.
        rises: least acceleration of a foot that lifts off.
        support: the law for legs on the ground; None: their torques are free.
        spring: spring of a knee, whose stiffness may be `Free`; None: there is none.
        passes: whether knees on the ground may be less flexed than at touchdown.
        swings: whether legs in the air follow a law, too.
        coarse: whether the mesh is so coarse that knees must be held to their angle at touchdown besides by the law.
        turn: turn to the left in a stride; None in the plane.
    """

    robot: Robot
    request: Wishes
    footfalls: Footfalls
    names: Sequence[str]
    limbs: Mapping[str, Leg]
    scale: Scale
    mechanism: Mechanism
    base: int
    configurations: tuple[Array, Array]
    rates: Array
    effort: Array
    durations: Sequence[tuple[float, float, float]]
    stride: tuple[float, float]
    push: float
    posture: Callable[[int, float], Array]
    guess: Callable[[int, float], tuple[Array, Array]]
    height: Callable[[int, str, float], float | None]
    landing: tuple[float, float]
    falls: float
    rises: float
    support: Support | None
    spring: Spring | None
    passes: bool = True
    swings: bool = True
    coarse: bool = False
    turn: float | None = None

    @cached_property
    def units(self) -> tuple[Array, Array]:
        """Units in which coordinates, and forces along them, are of order one, (nv,) each."""
        turns = np.array([body.turns for body in self.mechanism.bodies])
        return np.where(turns, 1.0, self.scale.length), np.where(turns, self.scale.torque, self.scale.force)

    @cached_property
    def motors(self) -> dict[tuple[str, Part], int]:
        """Row among the joints of each motor, by leg and part."""
        parts: tuple[Part, ...] = ("hip", "knee", "adduction")
        return {
            (leg, part): getattr(limb, part) - self.base
            for leg, limb in self.limbs.items()
            for part in parts
            if getattr(limb, part) is not None
        }

    def add(self, programme: Programme, phase: int, s: float) -> tuple[Any, Any, Any, Mapping[str, Any]]:
        """Adds unknowns q, v, a and forces at a node, where a fraction of a phase has passed, about a guess."""

        def variable(part: str, *arguments: Any) -> Any:
            return programme.variable(node_name(self.names[phase], s, part), *arguments)

        time, (unit, _), (first, second) = self.scale.time, self.units, self.guess(phase, s)
        hardest, most = HARDEST * unit / time**2, self.request.legs * STRONGEST * self.scale.force
        q = variable("q", first, *self.configurations, unit)
        v = variable("v", second, -self.rates, self.rates, 10.0 * unit / time)
        a = variable("a", 0.0 * unit, -hardest, hardest, 0.05 * hardest)
        aside = (len(self.mechanism.lift) - 1) * (1.0,)
        upward, least = [*(0.0 * part for part in aside), self.push], [*(-most * part for part in aside), 0.0]
        bearing = self.footfalls.phases[phase]
        return q, v, a, {leg: variable(f"F {leg}", upward, least, most, 100.0 * self.scale.force) for leg in bearing}


def limits(robot: Robot, base: int, what: str, without: float) -> Array:
    """Returns limits of the joints' "velocity" or "effort", (nv - base,), and `without` where there is none."""
    found = (getattr(robot.limits[name], what) for name in robot.coordinates[base:])
    return np.array([WITHIN * limit if 0.0 < limit < UNKNOWN else without for limit in found])


def within(robot: Robot, i: int, least: float, most: float) -> tuple[float, float]:
    """Returns bounds of a coordinate within the limits that the robot's file gives it."""
    lower, upper = robot.limits[robot.coordinates[i]].position
    return max(least, lower + AWAY), min(most, upper - AWAY)


class Mechanics:
    """The dynamics as functions of CasADi's symbols, for sets of feet on the ground."""

    def __init__(self, mechanism: Mechanism, limbs: Mapping[str, Leg]) -> None:
        self.mechanism, self.limbs = mechanism, limbs
        self._functions: dict[tuple[tuple[str, ...], bool], Any] = {}

    def node(self, q: Any, v: Any, a: Any, F: Mapping[str, Any]) -> Node:
        """Returns a node with these unknowns."""
        needed, *toes = self._function(tuple(F), True)(q, v, a, casadi().vertcat(*F.values()))
        return Node(q, v, a, F, needed, self._by_leg(toes))

    def struck(self, q: Any, change: Any, impulses: Mapping[str, Any]) -> Any:
        """Returns impulses along the coordinates that a velocity change needs besides those at the feet, (nv,)."""
        needed, *_ = self._function(tuple(impulses), False)(q, 0.0 * q, change, casadi().vertcat(*impulses.values()))
        return needed

    def moving(self, q: Any, v: Any) -> Mapping[str, tuple[Any, Any, Any]]:
        """Returns position, velocity and acceleration at v̇ = 0 of each leg's toe."""
        _, *toes = self._function((), False)(q, v, 0.0 * q, casadi().SX(0, 1))
        return self._by_leg(toes)

    def _by_leg(self, toes: Sequence[Any]) -> Mapping[str, tuple[Any, Any, Any]]:
        return {leg: (toes[3 * i], toes[3 * i + 1], toes[3 * i + 2]) for i, leg in enumerate(self.limbs)}

    def _function(self, bearing: tuple[str, ...], gravity: bool) -> Any:
        """Makes the function from q, v, v̇ and foot forces to needed forces and each toe's motion."""
        if (bearing, gravity) not in self._functions:
            ca, nv, size = casadi(), self.mechanism.nv, len(self.mechanism.lift)
            q, v, a = (ca.SX.sym(name, nv) for name in ("q", "v", "a"))
            F = ca.SX.sym("F", size * len(bearing))
            motion, parts = [ca.vertsplit(each) for each in (q, v, a)], ca.vertsplit(F) if bearing else []
            pushes = {self.limbs[leg].toe: tuple(parts[size * i : size * (i + 1)]) for i, leg in enumerate(bearing)}
            feet = self.mechanism.moving_feet(motion[0], motion[1], motion[2], ca)
            rows = [ca.vertcat(*self.mechanism.forces(motion[0], motion[1], motion[2], ca, pushes, gravity=gravity))]
            rows += [ca.vertcat(*part) for limb in self.limbs.values() for part in feet[limb.toe]]
            self._functions[bearing, gravity] = ca.Function("mechanics", [q, v, a, F], rows, {"cse": True})
        return self._functions[bearing, gravity]
