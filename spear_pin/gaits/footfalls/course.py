"""A collocated gait: what the optimiser found at the nodes, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.model.robot import Robot


@dataclass(frozen=True)
class Swing:
    """What the law does with a leg in the air in a phase.

    Attributes:
        alpha: Bézier coefficients of leg angle and knee, of the convention, (2, 6), in rad.
        origin: of the phase variable: the mean leg angle of the legs on the ground, in rad, or the torso's x, in m.
        span: change of it from s = 0 to s = 1.
        adduction: angle to which the adduction is brought, in rad.
    """

    alpha: Array
    origin: float
    span: float
    adduction: float


@dataclass(frozen=True)
class Stretch:
    """A phase of a collocated gait. Of n intervals it has 2 n + 1 nodes, their ends and middles.

    Attributes:
        bearing: names of the legs on the ground.
        t: times of the nodes since the stride began, (nodes,), in s.
        q: configurations, (nodes, nv).
        v: velocities, (nodes, nv); at the first node just after what the phase begins with, at the last just before.
        a: accelerations, (nodes, nv).
        u: torques of the motors, in the order of the coordinates, (nodes, nv - 6), in N·m.
        needed: torques of the joints with those of the knee springs, (nodes, nv - 6), in N·m.
        forces: of the ground on the foot of each leg on it, x, y and z of the world, (nodes, 3), in N.
        evolutions: of the swing law if one was asked for, of each leg in the air.
        impulses: on the feet of the legs on the ground, of the impact that the phase begins with, (3,), in N·s; of the
            first phase where the stride closes, mirrored and turned as the gait then is.
    """

    bearing: tuple[str, ...]
    t: Array
    q: Array
    v: Array
    a: Array
    u: Array
    needed: Array
    forces: Mapping[str, Array]
    impulses: Mapping[str, Array]
    evolutions: Mapping[str, Swing]

    @property
    def duration(self) -> float:
        """In s."""
        return float(self.t[-1] - self.t[0])


@dataclass(frozen=True)
class CollocatedGait:
    """A gait as collocation found it: a start for a law, no orbit of the event-exact simulation.

    Attributes:
        robot: whose it is.
        request: what was asked.
        stretches: its phases; of mirrored footfalls those of half a stride.
        constants: of the stance law if one was asked for, of each leg: hip, knee and adduction, in N·m.
        effort_per_distance: integral of the squared torques of all motors over the distance, in N²·m·s.
        solution: the optimiser's, to start another search from.
        iterations: of all the programmes solved on the way.
        seconds: that building and solving the programmes took, of CPU.
    """

    robot: Robot
    request: FootfallRequest
    stretches: tuple[Stretch, ...]
    constants: Mapping[str, tuple[float, float, float]]
    effort_per_distance: float
    solution: Solution
    iterations: int
    seconds: tuple[float, float]

    @property
    def period(self) -> float:
        """Duration of a whole stride, in s."""
        return (2.0 if self.request.footfalls.mirrored else 1.0) * sum(each.duration for each in self.stretches)

    @property
    def cost_of_transport(self) -> float:
        """Integral of |motor power| over weight and distance."""
        spent = sum(_simpson(stretch, np.abs(stretch.u * stretch.v[:, 6:]).sum(axis=1)) for stretch in self.stretches)
        weight = self.robot.weight
        return spent / (weight * self.request.speed * sum(each.duration for each in self.stretches))


def _simpson(stretch: Stretch, values: Array) -> float:
    third = stretch.duration / (len(values) - 1) / 3.0
    return third * float(values[0] + values[-1] + 4.0 * values[1::2].sum() + 2.0 * values[2:-1:2].sum())
