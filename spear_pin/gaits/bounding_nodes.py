"""Nodes of the bounding programme: their unknowns, with guesses and bounds, at the robot's scale."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.bounding_law import BoundingLaw, Leg, legs_of
from spear_pin.gaits.collocation import Programme, node_name
from spear_pin.gaits.request import FARTHEST, FASTEST, HIGHEST, Request
from spear_pin.model.legs import lean
from spear_pin.model.limits import UNKNOWN
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale, scale_of

WITHIN, AWAY = 0.95, 0.01  # share of torque and rate limits, rad from angle limits; error needs it
KNEE_REST, HEIGHT = BoundingLaw.knee_rest, 0.57  # rad, m: of Q-SPEAR's knees, and of the hips they hold up


@dataclass
class Node:
    """Unknowns at one node: q, v, v̇, all four motor torques, the ground force."""

    q: Any
    v: Any
    a: Any
    u: Any = None
    F: Any = None


class Units(NamedTuple):
    """Units in which configurations and so on are of order one, (7,) each; Q-SPEAR's are SI units."""

    q: Array
    v: Array
    a: Array
    force: Array

    @classmethod
    def of(cls, scale: Scale) -> Units:
        """Returns the units for a robot of a given size."""
        q = np.array([scale.length, scale.length, *5 * (1.0,)])
        force = np.array([scale.force, scale.force, *5 * (scale.torque,)])
        return cls(q, q / scale.time, q / scale.time**2, force)


@dataclass(frozen=True)
class Room:
    """Bounds that a robot and a request put on the unknowns of a node.

    Attributes:
        robot: the robot in the plane.
        request: the request for the gait.
    """

    robot: Robot
    request: Request

    @cached_property
    def scale(self) -> Scale:
        """The robot's size."""
        return scale_of(self.robot)

    @cached_property
    def units(self) -> Units:
        """Units of the robot's coordinates and forces."""
        return Units.of(self.scale)

    @cached_property
    def legs(self) -> tuple[Leg, Leg]:
        """The posterior and the anterior leg."""
        return legs_of(self.robot)

    @cached_property
    def hips(self) -> float:
        """Mean height of the hips above the torso's frame, in m."""
        level = np.zeros(self.robot.nq)
        return float(np.mean([self.robot.frame_position(level, f"{leg.name}_hip")[1] for leg in self.legs]))

    @cached_property
    def configurations(self) -> tuple[Array, Array]:
        """Least and largest q, in its units."""
        shift = self.hips / self.scale.length
        lower, upper = np.array([-1.0, 0.3 - shift, -0.8]), np.array([FARTHEST, HIGHEST - shift, 0.8])
        for leg in self.legs:
            knee = sorted((-0.3 * leg.side, 2.5 * leg.side))
            least, most = (np.array([hip, bound]) for hip, bound in zip((-1.9, 1.9), knee, strict=True))
            if self.request.within_limits:
                ranges = [self.robot.limits[self.robot.coordinates[i]].position for i in (leg.hip, leg.knee)]
                low, high = np.transpose(ranges)
                least, most = np.maximum(least, low + AWAY), np.minimum(most, high - AWAY)
            lower, upper = np.append(lower, least), np.append(upper, most)
        return lower, upper

    def joints(self, what: str) -> Array:
        """Returns limits of joints' "velocity" or "effort", (7,), infinite where there is none or it does not count."""
        if not self.request.within_limits:
            return np.full(self.robot.nv, np.inf)
        limits = [
            getattr(self.robot.limits[name], what) if name in self.robot.actuated else np.inf
            for name in self.robot.coordinates
        ]
        return np.array([WITHIN * limit if 0.0 < limit < UNKNOWN else np.inf for limit in limits])

    def posture(self, phase: str, x: float, s: float) -> Array:
        """Returns a rough guess of the configuration: level torso, sweeping legs, flexed swing knees.

        Args:
            phase: name of the phase.
            x: x of the torso, in m.
            s: fraction of the phase that has passed.
        """
        rest = self.request.knee_rest
        bearing, bears, swings = 0.22 - 0.44 * s, rest + 0.2 * math.sin(math.pi * s), rest + 0.6
        trails, comes, bends, straightens = -0.22 + 0.1 * s, 0.1 + 0.12 * s, rest + 0.3 * s, rest + 0.6 * (1.0 - s)
        angles, knees = {
            "posterior_stance": ((bearing, -0.2 + 0.25 * s), (bears, swings)),
            "flight_1": ((trails, comes), (bends, straightens)),
            "anterior_stance": ((-0.1 + 0.2 * s, bearing), (swings, bears)),
            "flight_2": ((comes, trails), (straightens, bends)),
        }[phase]
        held, straight = (float(np.mean([_reach(leg, knee) for leg in self.legs])) for knee in (rest, KNEE_REST))
        q = [x, HEIGHT * self.scale.length * held / straight - self.hips, 0.0]
        for leg, angle, knee in zip(self.legs, angles, knees, strict=True):
            flexed = leg.side * knee
            q += [angle + float(lean(*leg.lengths, flexed, math)[0]), flexed]
        return np.array(q)

    def node(self, programme: Programme, phase: str, s: float, posture: Array, rng: np.random.Generator) -> Node:
        """Adds unknowns at a node, about a guess.

        Args:
            programme: the programme to which they are added.
            phase: name of the phase; a phase with "stance" in its name has a ground force and torques of its swing leg.
            s: fraction of the phase that has passed.
            posture: the guess, (7,).
            rng: random numbers that perturb the guess.
        """
        scale, units, stance = self.scale, self.units, "stance" in phase

        def variable(part: str, *arguments: Any, unit: Any) -> Any:
            return programme.variable(node_name(phase, s, part), *arguments, unit=unit)

        lower, upper = self.configurations
        rates = np.array([self.request.speed / scale.speed, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
        fastest = np.minimum(FASTEST, self.joints("velocity") / units.v)
        first = np.clip(posture / units.q + 0.03 * rng.normal(size=7), lower, upper)
        q = variable("q", first, lower, upper, unit=units.q)
        v = variable("v", rates + 0.1 * rng.normal(size=7), -fastest, fastest, 10.0, unit=units.v)
        a = variable("a", np.zeros(7), -1500.0, 1500.0, 100.0, unit=units.a)
        u = variable("u", np.zeros(2 if stance else 4), -600.0, 600.0, 100.0, unit=scale.torque)
        F = None
        if stance:
            F = variable("F", [0.0, 430.0], [-3000.0, -1.0], [3000.0, 6000.0], 100.0, unit=scale.force)
        return Node(q, v, a, u, F)


def _reach(leg: Leg, knee: float) -> float:
    """Returns the distance from hip to toe, in m."""
    thigh, shank = leg.lengths
    return math.hypot(shank * math.sin(knee), thigh + shank * math.cos(knee))
