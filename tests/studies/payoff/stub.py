"""Searches that end at once: a shipped gait with another spring, what it costs by a formula."""

from dataclasses import replace
from functools import cache

import numpy as np

from spear_pin import Gait
from spear_pin.errors import NoGait
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.collocation import Solution
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.studies.design import sprung
from spear_pin.studies.payoff import Motors
from spear_pin.studies.payoff.bounding import Bounds, figures_of, request
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED, Point

DRIVES = {
    "knee": Drive(motor("assumed_600w"), Gearbox(15.0, 0.83), 48.0),
    "hip": Drive(motor("assumed_600w"), Gearbox(15.0, 0.83), 48.0),
}
MOTORS = Motors(DRIVES["knee"], DRIVES["hip"], dict.fromkeys(DRIVES, "given"))
BEST = {FIXED: 30.0, SWITCHED: 50.0}  # N·m/rad
GAINS = {FIXED: 0.1, SWITCHED: 0.3}


def cost(point):
    """Least at 2 m/s, and at the best stiffness of each kind."""
    bare = 1.0 + (point.speed - 2.0) ** 2
    if point.kind == NONE:
        return bare
    stiffness = BEST[point.kind] if point.stiffness is None else point.stiffness
    return bare * (1.0 - GAINS[point.kind] * max(0.0, 1.0 - ((stiffness - BEST[point.kind]) / 100.0) ** 2))


def drawn_by(robot, cycle, motors):
    """Electricity of a leg's motors in a cycle, in J."""
    return Sampled(robot, cycle, drives={"knee": motors.knee, "hip": motors.hip}).values()["electricity"]


class Stub:
    """Takes the place of the search for a bound.

    Args:
        fails: tells of a point and of the point that a search begins from whether there is no gait.
        costs: by the same two.
    """

    def __init__(self, fails=lambda point, start: False, costs=lambda point, start: cost(point)):
        self.fails, self.costs, self.asked = fails, costs, []

    def __call__(self, robot, motors, search):
        start = None if search.start is None else search.start.point
        self.asked.append((search.point, start, search.meshes))
        if self.fails(search.point, start):
            raise NoGait("it is so", 1.0)
        kind, stiffness = search.point.kind, search.point.stiffness
        stiffness = BEST[kind] if stiffness is None else stiffness
        found = replace(own_figures(), cost=self.costs(search.point, start), stiffness=stiffness)
        return of_leg(stiffness), found, SOLUTION


class Stubbed(Bounds):
    """Bounds whose search a stub makes."""

    def __init__(self, stub, begins=Bounds.begins, cold=(), valleys=()):
        self.search, self.begins, self.cold, self.valleys = stub, begins, cold, valleys


SOLUTION = Solution({"stiffness": np.array([112.0])}, 1.0, {"mean speed": 1e-9}, True, "Solve_Succeeded", 42)


@cache
def shipped():
    return Gait.load("long_stride")


@cache
def of_leg(stiffness):
    """The shipped gait with springs of another stiffness of a leg: the motors give what they do not."""
    gait = shipped()
    return Gait(**vars(gait) | {"system": sprung(gait.system, stiffness)})


@cache
def own_figures():
    asked = request(shipped().system.robot, Point(SWITCHED, 2.5, 56.0), MOTORS)
    return figures_of(shipped(), MOTORS, asked)


def springs_of(gait):
    return gait.system.spring.stiffness / PAIR
