"""Continuation from a hop to the first hop of another point, by small steps of stiffness and flight time."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

from spear_pin.errors import NoGait
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import State
from spear_pin.model.spring import Spring
from spear_pin.studies.payoff.cycles import Cycles, Task
from spear_pin.studies.payoff.grid import FIXED, Point

FOOTING = 0.05  # of the weight: what rests on the toe at least while the knee flexes
LEAP = 0.08  # of the logarithm of a flight time
STIFFER = 0.3  # of what springs, real and virtual, have together
HALVINGS = 2  # of a step that leads nowhere


@dataclass(frozen=True)
class Place:
    """A hop, or nearly one, for a point."""

    point: Point
    system: HybridSystem
    state: State

    @classmethod
    def of(cls, kind: str, gait: Gait) -> Place:
        """Returns the place of a gait with a kind of knee."""
        spring = gait.system.spring.stiffness
        return cls(Point(kind, gait.durations["flight"], spring), gait.system, gait.state)

    @property
    def whole(self) -> float:
        """Stiffness of the real and the virtual spring together, in N·m/rad."""
        return float(self.system.spring.stiffness + self.system.law.virtual_stiffness)

    def wanted(self, point: Point) -> float:
        """Returns the starting stiffness for a point, in N·m/rad: if free, this place's, or the imitated spring's."""
        return point.stiffness if point.stiffness is not None else self.system.spring.stiffness or self.whole


def begun(place: Place, point: Point) -> Place:
    """Returns the place at another point: a virtual spring replaces the part that the new spring lacks.

    The damper stays, without a spring too, because it belongs to the knee. The springs act both ways: no cycle closes
    where springs that release would do so, and the way to a hop may lead through such places.
    """
    law, spring = place.system.law, place.system.spring
    own = place.wanted(point)
    law = replace(
        law,
        virtual_stiffness=max(place.whole - own, 0.0),
        minimum_force=FOOTING * place.system.robot.weight,
        hold_extension=True,
    )
    rest = law.knee_touchdown if point.kind == FIXED else None
    real = Spring(stiffness=own, damping=spring.damping, rest=rest, unilateral=False)
    return Place(point, rebuilt(place.system, law=law, spring=real), place.state)


def let_go(system: HybridSystem) -> HybridSystem:
    """Returns the system with a spring that releases where it is slack, unless the spring is fixed."""
    return rebuilt(system, spring=replace(system.spring, unilateral=system.spring.rest is None))


def led(task: Task, place: Place, point: Point) -> Place:
    """Finds a hop for a point, by small steps of stiffness and flight time; the kind changes where there is no way.

    Raises:
        NoGait: the way ends before.
    """
    own = place.wanted(point)
    stops = [replace(point, stiffness=own)]
    if place.point.kind != point.kind:
        stops = [replace(place.point, stiffness=0.0), Point(point.kind, place.point.speed), *stops]
    for stop in stops:
        place = _towards(task, place, stop, HALVINGS)
    return begun(place, point)


def _towards(task: Task, place: Place, point: Point, halvings: int) -> Place:
    """Finds the hop for a point of the same kind, by way of a hop between where it is far, or there is none."""
    if _near(place, point):
        try:
            return _hop(task, begun(place, point))
        except NoGait:
            if not halvings:
                raise
            halvings -= 1
    return _towards(task, _towards(task, place, _between(place.point, point), halvings), point, halvings)


def _near(place: Place, point: Point) -> bool:
    longer, stiffer = point.speed / place.point.speed, (point.stiffness or 0.0) - (place.point.stiffness or 0.0)
    return abs(math.log(longer)) <= LEAP and abs(stiffer) <= STIFFER * place.whole


def _between(one: Point, other: Point) -> Point:
    stiffness = 0.5 * ((one.stiffness or 0.0) + (other.stiffness or 0.0))
    return Point(other.kind, math.sqrt(one.speed * other.speed), stiffness)


def _hop(task: Task, place: Place) -> Place:
    """Finds the nearby hop."""
    ranges = {name: ends for name, ends in task.ranges.items() if name != "stiffness"}
    task = replace(task, flight_time=place.point.speed, ranges=ranges)
    cycles = Cycles(task, place.system, place.state, chart(place.system, place.state))
    return Place(place.point, *cycles.begun(cycles.first()))
