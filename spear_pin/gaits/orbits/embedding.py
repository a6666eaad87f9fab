"""Planar gaits put into space, where the motion is the same and the robot can also fall sideways."""

from __future__ import annotations

import warnings
from dataclasses import replace

import numpy as np

from spear_pin.errors import BadValue, RobotWarning
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.spatial.bounding import SECTION, bounding_in_space
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import move_in_space, pairs_of, place_in_space
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import find_replaced
from spear_pin.hybrid.periodic import multipliers, residual, return_map
from spear_pin.hybrid.result import State
from spear_pin.hybrid.section import section
from spear_pin.kinds import typed
from spear_pin.model.loading import load
from spear_pin.model.origin import origin, robot_of, unsaid
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

PLANAR, SPATIAL = "q_spear", "q_spear_full"
EXACT = 1e-9  # residual of what is symmetric as it is


@typed
def in_space(gait: Gait, law: SpatialLaw | None = None, *, robot: Robot | None = None, rtol: float = 1e-10) -> Gait:
    """Puts a planar bounding gait into space: finds its residual and multipliers, with those of a sideways fall.

    If left and right of the robot are not quite mirror images, the planar gait is only close to a gait in space.
    Newton's method then finds the gait, with the numbers of the law unchanged. The function takes some seconds, and
    longer with Newton's method.

    Args:
        gait: a gait of Q-SPEAR in the plane, or of a quadruped that `sagittal` cut, without feedback.
        law: a law with other numbers for adduction, whose `plane` is the gait's law; by default `SpatialLaw.scaled`.
        robot: a quadruped on a chain; by default the robot that was cut, or `load("q_spear_full", base="chain")`.
        rtol: relative tolerance of the integrator.

    Raises:
        BadValue: the gait's robot is another, the gait has event feedback, hardware or changes, or the law's `plane` is
            not the gait's.
        NoGait: a perturbed stride does not close, or Newton's method does not end in a gait.

    Example:
        >>> from spear_pin import Gait, SpatialLaw
        >>> from spear_pin.gaits.orbits.embedding import embed
        >>> planar = Gait.load("long_stride")
        >>> system, (q, v) = embed(planar, SpatialLaw(planar.system.law))
        >>> system.robot.coordinates[:6]
        ('torso_x', 'torso_y', 'torso_z', 'yaw', 'pitch', 'roll')
    """
    system, state = embed(gait, law, robot)
    off = residual(system, state, rtol)
    if off > max(EXACT, 10.0 * rtol):
        return gait_beside(system, state, (), {}, rtol)
    cycle = return_map(system, state, rtol)
    durations = {phase: seconds for phase, seconds in cycle.durations.items() if seconds > 0.0}
    return Gait(system, state, {}, off, multipliers(system, state, rtol), durations)


def embed(gait: Gait, law: SpatialLaw | None = None, robot: Robot | None = None) -> tuple[HybridSystem, State]:
    """Returns the system in space for a planar gait, and its section state there; see `in_space` for the arguments."""
    plane = gait.system
    if plane.kind != "bounding":
        raise BadValue("gait", gait, "a planar bounding gait")
    if plane.changes or find_replaced(plane):
        raise BadValue(
            "gait", gait, "one without event feedback, hardware, dry friction or other changes: without_feedback(gait)"
        )
    robot = robot or whole(plane.robot)
    law = law or SpatialLaw.scaled(plane.law, robot)
    if law.plane != plane.law:
        raise BadValue("SpatialLaw.plane", law.plane, "the law of the gait, gait.system.law")
    springs = {name: of_a_leg(spring) for name, spring in plane.springs.items()}
    system = bounding_in_space(robot, law, springs, plane.contact)
    touchdown = return_map(plane, gait.state, 1e-12).event(SECTION)
    pairs = pairs_of(robot)
    q, v = place_in_space(robot, pairs, touchdown.q), move_in_space(robot, pairs, touchdown.v_before)
    q[0] = 0.0
    (q,), (v,) = section(system).placed(q[None], v[None], np.zeros(0, bool))
    return system, (q, v)


def whole(plane: Robot) -> Robot:
    """Returns the quadruped on a chain whose sagittal plane a robot is.

    Raises:
        BadValue: the robot is not Q-SPEAR as it ships, and was not cut from a robot that a file describes.
    """
    if plane.cut is None:
        if plane.source != PLANAR or plane.varied:
            raise BadValue(
                "robot",
                plane,
                f"{PLANAR!r} as it ships, or a robot of sagittal(...); for another give the robot in space, robot=...",
            )
        return load(SPATIAL, base="chain")
    if plane.cut.kind != "sagittal" or plane.varied or unsaid(plane.cut.robot):
        why = ", ".join([*unsaid(plane.cut.robot), *(["a cut that was varied"] if plane.varied else [])]) or "one leg"
        raise BadValue(
            "robot",
            plane,
            f"a robot that sagittal(...) cut from a file's (this is {why}); or give the one in space, robot=...",
        )
    said = origin(plane.cut.robot)
    toes = [leg.toe for pair in plane.cut.legs for leg in pair]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)  # which it told as it was loaded
        return robot_of({**said, "toes": toes, "options": {**said.get("options", {}), "base": "chain"}})


def of_a_leg(spring: Spring) -> Spring:
    """Returns the spring of one leg, given the spring of a pair of legs."""
    halved = {name: getattr(spring, name) / 2.0 for name in spring.units}
    return replace(spring, **halved, table=tuple((angle, torque / 2.0) for angle, torque in spring.table))
