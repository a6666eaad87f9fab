"""Derivatives of cycles and gaits of a bound, a biped and hops, one with a bounce, against differences."""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, find_gait, hopping, load
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.gaits.sensitivity.sensitivity import sensitivity
from spear_pin.hybrid.parameters import with_numbers
from tests import biped
from tests.gaits.sensitivity import oracle

pytestmark = [pytest.mark.slow, pytest.mark.extra("heyoka")]
BOUNDS = ("long_stride", "least_effort", "force_lift_off")
OF_BOUND = (
    *("posterior_hip_torque", "anterior_hip_torque", "posterior_leg_touchdown", "knee_touchdown", "knee_rest"),
    *("stiffness", "friction", "torso_mass", "torso_inertia", "knee_ratio", "hip_distance", "hip_rotor"),
)
OF_BIPED = (
    *("thrust", "set_back", "stiffness", "friction", "knee_ratio", "pitch_mass"),
    *("pitch_gain", "hip_gain", "knee_touchdown", "torque_limit", "left_hip_to_left_knee"),
)
OF_HOP = (
    *("stance_torque", "stiffness", "damping", "knee_touchdown", "frequency", "friction", "hip_gain", "hip_damping"),
    *("knee_gain", "knee_damping", "knee_ratio", "hip_ratio", "knee_rotor", "knee_mass", "hip_mass", "hip_com_z"),
    *("knee_inertia", "hip_to_knee", "knee_to_toe", "boom_z_mass"),
)
OF_EACH_KIND = ("stance_torque", "stiffness", "knee_touchdown", "friction", "hip_damping", "knee_ratio", "knee_mass")
OF_EACH_KIND += ("hip_to_knee",)
BOUNCING = "hop that bounces"
HOPS = {"hop": {"stance_torque": 7.826}, "other hop": {"stance_torque": 6.5}}  # N·m
HOPS[BOUNCING] = {"stance_torque": 7.826, "stiffness": 60.0}  # N·m, N·m/rad
NEAR = np.array([0.5723, 0.4708, 0.9019]), np.array([-0.593, 2.161, 4.281])  # the hop that bounces
UNTOLD = ("spring_switch",)  # a knee's spring grows slack where its toe is lifted off: the torque does not jump
WORST = {True: 1e-8, False: 1e-6}  # of a row's scale: what is allowed, of hops and of others
ENOUGH = 1e-2  # of that: closer differences are not looked for


@cache
def gait_of(name):
    """A gait, and the parameters by which it is differentiated."""
    if name in BOUNDS:
        gait, over = Gait.load(name), OF_BOUND
    elif name == "biped":
        gait, over = find_gait(biped.system(), guess=biped.NEAR, rtol=1e-11), OF_BIPED
    else:
        system = hopping(load("spear_ii", locked=["boom_x"]))
        guess, over = NEAR if name == BOUNCING else None, OF_HOP
        gait = find_gait(with_numbers(system, HOPS[name]), guess=guess, rtol=1e-11)
    there = oracle.again(Orbit(gait.system, gait.state, over), over[0], 0.0)
    return Orbit(there.system, there.state, over)


@pytest.mark.parametrize("name", ["long_stride", "least_effort", "force_lift_off", "biped", *HOPS])
def test_cycles(name):
    orbit, worst = gait_of(name), WORST[name in HOPS]
    chosen = [
        *range(0, orbit.dimension, 1 if orbit.dimension < 4 else 3),
        *range(orbit.dimension, orbit.columns.shape[1]),
    ]
    found = oracle.compared(orbit, ENOUGH * worst, UNTOLD, chosen)
    assert sorted(found) == chosen  # none is left out
    for j, (errors, _) in found.items():
        assert errors.max() < worst, (j, np.argmax(errors))


@pytest.mark.parametrize(
    ("name", "over"),
    [
        ("long_stride", ("posterior_hip_torque", "torso_mass")),
        ("least_effort", ("anterior_hip_torque", "stiffness")),
        ("force_lift_off", ("posterior_hip_torque", "hip_distance")),
        ("biped", ("thrust", "knee_ratio", "pitch_mass")),
        ("hop", OF_EACH_KIND),
        ("hop", tuple(name for name in OF_HOP if name not in OF_EACH_KIND)),
        ("other hop", OF_HOP),
        (BOUNCING, ("stance_torque", "stiffness", "friction", "knee_mass")),
    ],
)
def test_gaits_found_again(name, over):
    orbit, worst = gait_of(name), WORST[name in HOPS]
    table = sensitivity(orbit.system, orbit.state, over)
    found = oracle.compared_gaits(orbit, table, ENOUGH * worst, UNTOLD)
    assert sorted(found) == sorted(over)
    for errors, of_multipliers, _ in found.values():
        assert errors.max() < worst
        assert of_multipliers.max() < worst
