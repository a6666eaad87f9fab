"""A collocated trot under its law: nearly an orbit of the event-exact simulation, which one is beside."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import load
from spear_pin.errors import BadValue
from spear_pin.gaits.footfalls.collocate import collocated
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.footfalls.trotted import trotted, under_law
from spear_pin.hybrid.periodic import displacement, return_map

pytestmark = pytest.mark.extra("casadi")


@pytest.fixture(scope="module")
def found():
    return collocated(
        load("q_spear_full", base="chain"), FootfallRequest(law=StanceLaw(), swing=SwingLaw()), meshes=(2,)
    )


@pytest.mark.slow
def test_half_a_stride_all_but_closes(found):
    system, state = under_law(found)
    half = return_map(system, state, 1e-9)
    assert half.cycles == 1
    moved = displacement(system, state, half.state)
    assert np.abs(moved[:18]).max() <= 2e-3 and np.abs(moved[18:24]).max() <= 0.05
    assert sum(half.durations.values()) == pytest.approx(0.5 * found.period, abs=1e-3)


@pytest.mark.slow
def test_an_orbit_is_beside_it(found):
    gait = trotted(found)
    assert gait.residual <= 1e-9 and abs(gait.multipliers[0]) == pytest.approx(3.68, abs=0.1)
    assert gait.durations["posterior_left"] == pytest.approx(1.4e-3, abs=5e-4)


@pytest.mark.slow
def test_without_a_law(found):
    with pytest.raises(BadValue, match="law"):
        trotted(replace(found, request=FootfallRequest()))


@pytest.mark.slow
def test_other_footfalls(found):
    pace = replace(found.request, footfalls=FOOTFALLS["pace"])
    bearing = ("posterior_left", "anterior_left")
    stretches = replace(found.stretches[0], bearing=bearing), found.stretches[1]
    with pytest.raises(BadValue, match="trot"):
        trotted(replace(found, request=pace, stretches=stretches))
