"""The gaits that are kept for tests, each with the search that finds it."""

import math

import numpy as np

from spear_pin import Gait, SpatialLaw, in_space, load, sagittal
from spear_pin.gaits import library
from spear_pin.gaits.feedback import add_feedback
from spear_pin.gaits.footfalls.beside import trot_beside
from spear_pin.gaits.footfalls.collocate import collocate
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.gaits.orbits.galloping import find_gallop
from spear_pin.gaits.orbits.steering import find_steered
from spear_pin.gaits.orbits.turning import find_turn
from spear_pin.gaits.spatial.law import ACROSS, INPUTS
from spear_pin.hybrid.periodic import multipliers, residual, return_map
from spear_pin.model.scale import scale_in_space
from spear_pin.studies.bound import bound_of
from tests.solve.kept import shipped, solved

ROBOTS = ("example-robot-data", "casadi")
BY_PARTS = 0.06  # between multipliers of along and lateral motion, found apart, and those of both together

for name in library.IN_SPACE:
    shipped(name, columns=0 if name.startswith("turn_") and name != "turn_9" else 1)


def _embedded(plane: Gait, law: SpatialLaw | None = None) -> Gait:
    """The gait in space, its multipliers not looked at."""
    return Gait(*embed(plane, law), {}, 1e-11, np.array([np.nan + 0j]), {})


@solved("long_stride")
def long_stride_in_space() -> Gait:
    return in_space(Gait.load("long_stride"))


@solved("long_stride_in_space", close=BY_PARTS)
def long_stride_upright() -> Gait:
    return add_feedback(long_stride_in_space())


@solved("long_stride_in_space", close=None)
def long_stride_steady() -> Gait:
    return add_feedback(long_stride_in_space(), ACROSS, heading=30.0)


@solved("least_effort", close=BY_PARTS)
def least_effort_upright() -> Gait:
    return add_feedback(in_space(Gait.load("least_effort")))


@solved("long_stride_3.50", close=BY_PARTS)
def fastest_upright() -> Gait:
    return add_feedback(in_space(Gait.load("long_stride_3.50")))


@solved("long_stride")
def turn_3() -> Gait:
    """As `spear turn --angle 3` finds it, with the adductions free in stance."""
    plane = Gait.load("long_stride")
    law = SpatialLaw(plane.system.law, adduction_stiffness=0.0, adduction_damping=0.0)
    return find_turn(_embedded(plane, law), math.radians(3.0))


@solved("turn_4", columns=0)
def turn_sharper() -> Gait:
    begun = Gait.load("turn_4")
    system, state = find_steered(begun.system, begun.state, math.radians(4.2), library.TURNS["turn_4"][1], 1e-9)
    durations = {name: seconds for name, seconds in return_map(system, state).durations.items() if seconds > 0.0}
    return Gait(system, state, {}, residual(system, state), multipliers(system, state), durations)


@solved("long_stride_3.00", columns=0)
def gallop_begun() -> Gait:
    """Half a millisecond on the way from a bound to a gallop."""
    return find_gallop(_embedded(Gait.load("long_stride_3.00")), (0.0005, 0.0005))


@solved("trot")
def trot_steady() -> Gait:
    return add_feedback(Gait.load("trot"))


@solved("pace", close=None)  # two feet land all but at once: on either side the map has other derivatives
def pace_steady() -> Gait:
    return add_feedback(Gait.load("pace"))


@solved("pronk", close=BY_PARTS)
def pronk_steady() -> Gait:
    return add_feedback(Gait.load("pronk"), INPUTS)


@solved("gallop")
def gallop_steady() -> Gait:
    return add_feedback(Gait.load("gallop"))


@solved(extras=ROBOTS)
def solo12_bound() -> Gait:
    return in_space(bound_of(sagittal(load("solo12", base="free", motors="all"))))


@solved("solo12_bound", extras=ROBOTS)
def solo12_bound_upright() -> Gait:
    return add_feedback(solo12_bound())


@solved(extras=ROBOTS)
def anymal_b_bound() -> Gait:
    return in_space(bound_of(sagittal(load("anymal_b", base="free", motors="all"))))


@solved("anymal_b_bound", extras=ROBOTS)
def anymal_b_bound_upright() -> Gait:
    return add_feedback(anymal_b_bound())


@solved(extras=ROBOTS)
def solo12_trot() -> Gait:
    solo = load("solo12", base="chain", motors="all", toes=[f"{leg}_FOOT" for leg in ("FL", "FR", "HL", "HR")])
    footfalls, law, swing = FOOTFALLS["trot"].finer(2), StanceLaw.scaled(solo), SwingLaw.scaled(solo)
    asked = FootfallRequest.scaled(solo, footfalls=footfalls, law=law, swing=swing)
    return trot_beside(collocate(solo, asked), apart=(0.004,))


@solved("solo12_trot", extras=ROBOTS)
def solo12_trot_steady() -> Gait:
    return add_feedback(solo12_trot())


@solved(extras=ROBOTS)
def anymal_b_trot() -> Gait:
    anymal = load("anymal_b", base="chain", motors="all", toes=[f"{leg}_FOOT" for leg in ("LH", "RH", "LF", "RF")])
    law, swing = StanceLaw.scaled(anymal, knee_rest=math.radians(55.0)), SwingLaw.scaled(anymal)
    speed, footfalls = scale_in_space(anymal).speed, FOOTFALLS["trot"].finer(2)
    asked = FootfallRequest.scaled(anymal, footfalls=footfalls, law=law, swing=swing, speed=speed)
    return add_feedback(trot_beside(collocate(anymal, asked)))
