"""Gaits with other numbers against those that a search finds."""

import numpy as np
import pytest

from spear_pin import find_gait
from spear_pin.errors import NoGait
from spear_pin.gaits.sensitivity.closing import close_cycle, find_changed
from spear_pin.gaits.sensitivity.orbit import Orbit, branch
from spear_pin.hybrid.parameters import number, with_numbers

pytestmark = pytest.mark.extra("heyoka")
VARY, KEEP = ("stance_torque",), {"flight_time": 0.2}
OVER = ("stiffness", "knee_ratio", "knee_touchdown")


@pytest.fixture(scope="module")
def begun(hop):
    return close_cycle(Orbit(hop.system, hop.state, (*VARY, *OVER)), KEEP)


def test_a_gait_is_one_as_it_is(hop, begun):
    assert np.abs(begun.displacement).max() < 1e-10
    assert number(begun.system, "stance_torque") == pytest.approx(hop.parameters["stance_torque"], abs=1e-8)


def test_is_the_gait_that_a_search_finds(hop, begun):
    change = {"stiffness": 2.0, "knee_ratio": 0.7, "knee_touchdown": -0.05}
    cycles = []
    there = find_changed(begun, KEEP, change, lambda: cycles.append(1))
    system = with_numbers(hop.system, {name: number(hop.system, name) + change[name] for name in OVER})
    found = find_gait(system, VARY, KEEP, guess=there.state, rtol=1e-11)
    assert number(there.system, "stance_torque") == pytest.approx(found.parameters["stance_torque"], abs=1e-8)
    assert np.concatenate(there.state) == pytest.approx(np.concatenate(found.state), abs=1e-8)
    assert 2 <= len(cycles) <= 6
    assert {name: number(there.system, name) for name in OVER} == pytest.approx(
        {name: number(system, name) for name in OVER}
    )


def test_newton_converges_quadratically(begun):
    """Residuals of the orbits on the way, the first of which derivatives predict."""
    residuals = []
    for h in (4.0, 2.0, 1.0):
        there = begun.along(branch(begun, list(KEEP)) @ [h, 0.0, 0.0], begun.names)
        residuals.append(np.abs(there.displacement).max())
    orders = np.log2(np.array(residuals[:-1]) / residuals[1:])
    assert orders == pytest.approx([2.0, 2.0], abs=0.25)


def test_says_why_there_is_none(begun):
    with pytest.raises(NoGait):
        find_changed(begun, KEEP, {"stiffness": -30.0, "knee_ratio": 0.0, "knee_touchdown": 0.0})
    with pytest.raises(NoGait, match="knee_ratio"):
        find_changed(begun, KEEP, {"stiffness": 0.0, "knee_ratio": -30.0, "knee_touchdown": 0.0})
