"""Configuration and motion of a leg from its measured joints, beside its kinematics."""

import numpy as np
import pytest

from spear_pin import load
from spear_pin.errors import BadValue, UnknownName
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import Measured, find_measured

A, B = 0.07, 0.15  # m: crank and rod


def test_the_crank_tells_how_long_the_leg_is(crank):
    angles = np.linspace(-0.6, 0.2, 5)
    rod = -A * np.sin(angles) + np.sqrt(B**2 - (A * np.cos(angles)) ** 2)  # from the crank's axis to the foot
    lengths = Measured(crank, ("crank",)).lengths(angles[:, None])
    assert lengths - lengths[0] == pytest.approx(rod - rod[0], abs=1e-12)


def test_in_stance_the_toe_is_at_rest(crank):
    leg = Measured(crank, ("crank",))
    y = leg.state("stance", np.array([-0.2]), np.array([3.0]), leg.configuration(np.array([-0.2]), None))
    q, v = y[:4], y[4:]
    assert v[crank.index("crank")] == pytest.approx(3.0)
    assert np.concatenate([crank.toe_jacobian(q, "toe") @ v, crank.loop_jacobian(q) @ v]) == pytest.approx(
        0.0, abs=1e-12
    )
    assert crank.toe_position(q, "toe")[-1] == pytest.approx(0.0, abs=1e-12)


def test_in_flight_the_base_moves_as_it_is_told():
    robot = load("spear_ii", locked=["boom_x"])
    leg = Measured(robot, ("hip", "knee"))
    assert (leg.leading["stance"], leg.leading["flight"]) == ([1], [1, 2])
    y = leg.state("flight", np.array([0.5, 1.0]), np.array([1.0, -2.0]), np.zeros(3), np.array([0.7]))
    assert y[3:] == pytest.approx([0.7, 1.0, -2.0])


def test_refuses_joints_that_do_not_tell_the_motion():
    with pytest.raises(BadValue, match="positions of more joints: one of hip"):
        _ = Measured(load("spear_ii"), ("knee",)).leading


def test_the_height_of_the_base_may_be_in_the_log(crank):
    t = np.linspace(0.0, 1.0, 30)
    log = Log("by hand", t, {name: t for name in ("boom_z", "crank", "rod_rate")})
    assert find_measured(crank, log).joints == ("crank",)
    with pytest.raises(UnknownName, match=r"\['boom_z'\]; valid: crank, rod, slide"):
        find_measured(crank, Log("by hand", t, {"boom_z": t}))
