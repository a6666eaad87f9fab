"""Gaits of the plane put into space, where they are orbits of the same motion with more ways to leave it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.spatial.bounding import SECTION, bounding_in_space
from spear_pin.gaits.spatial.law import SpatialLaw
from spear_pin.gaits.spatial.legs import pairs_of, placed
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import replaced
from spear_pin.hybrid.periodic import multipliers, residual, return_map
from spear_pin.hybrid.result import State
from spear_pin.kinds import typed
from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

Array = NDArray[np.float64]
PLANAR, SPATIAL = "q_spear", "q_spear_full"


@typed
def in_space(gait: Gait, law: SpatialLaw | None = None, *, robot: Robot | None = None, rtol: float = 1e-10) -> Gait:
    """A bounding gait of the plane as one in space: its residual, and multipliers, those of a fall sideways among them.

    Each stride of the some sixty that the multipliers take is about as long as one of the plane: it takes a minute.

    Args:
        gait: of Q-SPEAR in the plane, without feedback.
        law: with other numbers for adduction, its `plane` that of the gait; by default `SpatialLaw(plane)`.
        robot: a quadruped on a chain; by default `load("q_spear_full", base="chain")`.
        rtol: relative tolerance of the integrator.

    Raises:
        BadValue: the gait is not of such a robot, has event feedback, hardware or changes; or the law is
            another gait's.
        NoGait: a perturbed stride does not close.

    Example:
        >>> from spear_pin import Gait, SpatialLaw
        >>> from spear_pin.gaits.orbits.embedding import embedded
        >>> planar = Gait.load("long_stride")
        >>> system, (q, v) = embedded(planar, SpatialLaw(planar.system.law))
        >>> system.robot.coordinates[:6]
        ('torso_x', 'torso_y', 'torso_z', 'yaw', 'pitch', 'roll')
    """
    system, state = embedded(gait, law or SpatialLaw(gait.system.law), robot)
    cycle = return_map(system, state, rtol)
    durations = {phase: seconds for phase, seconds in cycle.durations.items() if seconds > 0.0}
    return Gait(system, state, {}, residual(system, state, rtol), multipliers(system, state, rtol), durations)


def embedded(gait: Gait, law: SpatialLaw, robot: Robot | None = None) -> tuple[HybridSystem, State]:
    """The system in space of a gait of the plane, and its state on the section there; arguments as of `in_space`."""
    plane = gait.system
    if plane.kind != "bounding" or (robot is None and (plane.robot.source != PLANAR or plane.robot.varied)):
        raise BadValue("gait", gait, f"a bounding gait of {PLANAR!r} as it ships, or give the robot in space")
    if plane.changes or replaced(plane):
        raise BadValue("gait", gait, "one without hardware, dry friction or other changes: space has none yet")
    if law.plane != plane.law:
        raise BadValue("SpatialLaw.plane", law.plane, "the gait's own")
    robot = robot or load(SPATIAL, base="chain")
    system = bounding_in_space(robot, law, of_a_leg(plane.spring), plane.contact)
    touchdown = return_map(plane, gait.state, 1e-12).event(SECTION)
    pairs = pairs_of(robot)
    q, v = placed(robot, pairs, touchdown.q), placed(robot, pairs, touchdown.v_before)
    q[0] = 0.0
    q[2] -= min(system.ground.foot(robot, q, toe)[0] for toe in system.section_toes)
    return system, (q, v)


def of_a_leg(spring: Spring) -> Spring:
    """The spring of one leg, of that of a pair."""
    halved = {name: getattr(spring, name) / 2.0 for name in ("stiffness", "damping", "hardening", "preload")}
    return replace(spring, **halved, table=tuple((angle, torque / 2.0) for angle, torque in spring.table))
