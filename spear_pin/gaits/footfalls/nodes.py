"""Nodes of the programme in space: their unknowns, the bounds on these, and the dynamics at the nodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.bounding_nodes import AWAY, WITHIN
from spear_pin.gaits.collocation import Programme, casadi, node_name
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.spatial.legs import Leg
from spear_pin.model.chain import CHAIN
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale
from spear_pin.model.spatial import Spatial

BASE = len(CHAIN)
FARTHEST, LOWEST, HIGHEST = 3.0, -0.3, 0.9  # m of Q-SPEAR: along, aside; of the torso above the ground
TURNED, STEEPEST = 1.5, 1.9  # rad: yaw; a hip from straight down
STRAIGHT, FLEXED = 0.15, 2.4  # rad: flexion of a knee
FASTEST = (10.0, 20.0)  # m/s and rad/s of Q-SPEAR
HARDEST, STRONGEST = 2000.0, 4000.0  # m/s² or rad/s², N of Q-SPEAR


@dataclass(frozen=True)
class Node:
    """Unknowns at one node, and quantities that follow from them.

    Attributes:
        q: configuration.
        v: velocity.
        a: acceleration.
        F: force on each foot on the ground, three numbers each.
        needed: forces along the coordinates that the motion needs, including those of springs and dampers.
        toes: position, velocity and acceleration of each leg's toe.
    """

    q: Any
    v: Any
    a: Any
    F: Mapping[str, Any]
    needed: Any
    toes: Mapping[str, tuple[Any, Any, Any]]


@dataclass(frozen=True)
class Room:
    """Bounds that a robot and a request put on the unknowns of a node.

    Attributes:
        robot: a quadruped on a chain.
        limbs: its legs, by name.
        request: the request for the gait.
        scale: the robot's size.
    """

    robot: Robot
    limbs: Mapping[str, Leg]
    request: FootfallRequest
    scale: Scale

    @cached_property
    def units(self) -> tuple[Array, Array]:
        """Units in which coordinates, and forces along them, are of order one, (nv,) each."""
        joints = self.robot.nv - 3
        q, force = (
            np.array([*3 * (first,), *joints * (second,)])
            for first, second in ((self.scale.length, 1.0), (self.scale.force, self.scale.torque))
        )
        return q, force

    @cached_property
    def configurations(self) -> tuple[Array, Array]:
        """Least and largest q, (nv,), in SI units."""
        length, tilt = self.scale.length, self.request.tilt
        most = np.array([FARTHEST * length, FARTHEST * length, HIGHEST * length, TURNED, tilt, tilt])
        least = np.array([-FARTHEST * length, -FARTHEST * length, LOWEST * length, -TURNED, -tilt, -tilt])
        least, most = (np.concatenate([part, np.zeros(self.robot.nv - BASE)]) for part in (least, most))
        for limb in self.limbs.values():
            knee = sorted(limb.zeros[2] + limb.side * angle for angle in (STRAIGHT, FLEXED))
            hip = limb.zeros[1] - STEEPEST, limb.zeros[1] + STEEPEST
            for i, (low, high) in zip(
                limb.rows, ((-self.request.adduction, self.request.adduction), hip, knee), strict=True
            ):
                lower, upper = self.robot.limits[self.robot.coordinates[i]].position
                least[i], most[i] = max(low, lower + AWAY), min(high, upper - AWAY)
        return least, most

    def joints(self, what: str, without: float) -> Array:
        """Returns limits of the joints' "velocity" or "effort", (nv - 6,), and `without` where there is none."""
        limits = (getattr(self.robot.limits[name], what) for name in self.robot.coordinates[BASE:])
        return np.array([WITHIN * limit if 0.0 < limit < UNKNOWN else without for limit in limits])

    @cached_property
    def rates(self) -> Array:
        """Largest velocities, (nv,)."""
        straight, turning = FASTEST[0] * self.scale.speed, FASTEST[1] / self.scale.time
        return np.array([*3 * (straight,), *3 * (turning,), *self.joints("velocity", 1.5 * turning)])

    def add(
        self,
        programme: Programme,
        phase: str,
        fraction: float,
        guess: tuple[Array, Array],
        bearing: Sequence[str],
        push: float,
    ) -> tuple[Any, Any, Any, Mapping[str, Any]]:
        """Adds unknowns q, v, a and forces at a node, about a guess.

        Args:
            programme: the programme to which they are added.
            phase: name of the phase.
            fraction: fraction of the phase that has passed.
            guess: guess of configuration and velocity.
            bearing: legs on the ground.
            push: guess of the upward force on each.
        """

        def variable(part: str, *arguments: Any) -> Any:
            return programme.variable(node_name(phase, fraction, part), *arguments)

        time, (unit, _) = self.scale.time, self.units
        q = variable("q", guess[0], *self.configurations, unit)
        v = variable("v", guess[1], -self.rates, self.rates, 10.0 * unit / time)
        a = variable("a", 0.0 * unit, -HARDEST * unit / time**2, HARDEST * unit / time**2, 100.0 * unit / time**2)
        most = STRONGEST * self.scale.force
        F = {
            leg: variable(f"F {leg}", [0.0, 0.0, push], [-most, -most, 0.0], most, 100.0 * self.scale.force)
            for leg in bearing
        }
        return q, v, a, F


class Mechanics:
    """The dynamics as functions of CasADi's symbols, for sets of feet on the ground."""

    def __init__(self, robot: Robot, limbs: Mapping[str, Leg]) -> None:
        self.spatial, self.limbs = Spatial(robot), limbs
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
            ca, nv = casadi(), self.spatial.nv
            q, v, a = (ca.SX.sym(name, nv) for name in ("q", "v", "a"))
            F = ca.SX.sym("F", 3 * len(bearing))
            motion, parts = [ca.vertsplit(each) for each in (q, v, a)], ca.vertsplit(F) if bearing else []
            pushes = {self.limbs[leg].toe: tuple(parts[3 * i : 3 * i + 3]) for i, leg in enumerate(bearing)}
            feet = self.spatial.moving_feet(motion[0], motion[1], motion[2], ca)
            rows = [ca.vertcat(*self.spatial.forces(motion[0], motion[1], motion[2], ca, pushes, gravity=gravity))]
            rows += [ca.vertcat(*part) for limb in self.limbs.values() for part in feet[limb.toe]]
            self._functions[bearing, gravity] = ca.Function("mechanics", [q, v, a, F], rows, {"cse": True})
        return self._functions[bearing, gravity]
