"""A collocated gait: the optimiser's solution at the nodes, as numbers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from spear_pin.arrays import Array
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.virtual_constraints import Evolution
from spear_pin.model.robot import Robot


@dataclass(frozen=True)
class Stretch:
    """A phase of a collocated gait. A phase with n intervals has 2 n + 1 nodes, at their ends and middles.

    Attributes:
        bearing: names of the legs on the ground.
        t: times of the nodes since the stride began, (nodes,), in s.
        q: configurations, (nodes, nv).
        v: velocities, (nodes, nv); at the first node just after the events at the phase's beginning, at the last node
            just before the next events.
        a: accelerations, (nodes, nv).
        u: torques of the motors, in the order of the coordinates, (nodes, nv - 6), in N·m.
        needed: torques of the joints including those of the knee springs, (nodes, nv - 6), in N·m.
        forces: forces of the ground on the foot of each leg on the ground, x, y and z of the world, (nodes, 3), in N.
        evolutions: desired evolution of leg angle and knee of each leg in the air, if the request has a law for it.
        impulses: impulses on the feet of the legs on the ground, of the impact at the phase's beginning, (3,), in N·s;
            those of the first phase act where the stride closes, mirrored and turned as the gait then is.
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
    evolutions: Mapping[str, Evolution]

    @property
    def duration(self) -> float:
        """Duration in s."""
        return float(self.t[-1] - self.t[0])


@dataclass(frozen=True)
class CollocatedGait:
    """A gait found by collocation: a start for a law, not an orbit of the event-exact simulation.

    Attributes:
        robot: robot of the gait.
        request: request that the gait meets.
        stretches: phases of the gait; with mirrored footfalls those of half a stride.
        constants: constants of the stance law for each leg, if the request has one: hip, knee and adduction, in N·m.
        aims: angle at which the adduction of each leg lands, if the request has a law in the air, in rad.
        effort_per_distance: integral of the squared torques of all motors over the distance, in N²·m·s.
        solution: solution of the optimiser, to start another search from.
        iterations: number of iterations of all the solves.
        seconds: CPU time in s for building and solving the programmes.
    """

    robot: Robot
    request: FootfallRequest
    stretches: tuple[Stretch, ...]
    constants: Mapping[str, tuple[float, float, float]]
    aims: Mapping[str, float]
    effort_per_distance: float
    solution: Solution
    iterations: int
    seconds: tuple[float, float]

    @property
    def period(self) -> float:
        """Duration of a whole stride, in s."""
        return (2.0 if self.request.footfalls.mirrored else 1.0) * sum(each.duration for each in self.stretches)
