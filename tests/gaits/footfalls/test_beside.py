"""From a collocated pronk to the event-exact one."""

import warnings

import numpy as np
import pytest

from spear_pin import load
from spear_pin.errors import BadValue
from spear_pin.gaits.footfalls.beside import law_of_pronk, pronk_beside
from spear_pin.gaits.footfalls.collocate import collocate
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS
from spear_pin.gaits.spatial.pronking import pronking
from spear_pin.hybrid.periodic import chart, displacement, residual, return_map
from spear_pin.hybrid.symmetry import head_state

pytestmark = [pytest.mark.slow, pytest.mark.extra("casadi")]


@pytest.fixture(scope="module")
def lawful():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of CasADi's wrappers as they are imported
        import casadi  # noqa: F401
    asked = FootfallRequest(footfalls=FOOTFALLS["pronk"], law=StanceLaw(), swing=SwingLaw())
    return collocate(load("q_spear_full", base="chain"), asked)


def test_a_stride_of_the_event_exact_simulation_leads_nearly_back(lawful):
    last = lawful.stretches[-1]
    system = pronking(lawful.robot, law_of_pronk(lawful), lawful.request.spring)
    start = chart(system, head_state(last.q[-1], last.v[-1])).state(np.zeros(32))
    run = return_map(system, start, 1e-8)
    assert run.durations["all_stance"] == pytest.approx(lawful.stretches[0].duration, abs=1e-3)
    assert run.durations["flight_1"] == pytest.approx(lawful.stretches[1].duration, abs=1e-3)
    missed = np.abs(displacement(system, start, run.state))
    assert missed[:18].max() < 0.02 and missed[18:24].max() < 0.05  # knees begin to flex a little faster


def test_the_orbit_beside_it(lawful):
    gait = pronk_beside(lawful, apart=(0.004,))
    assert gait.residual <= 1e-9 and residual(gait.system, gait.state) <= 1e-9
    assert gait.system.measures["mean_speed"](return_map(gait.system, gait.state)) == pytest.approx(2.0, abs=1e-6)


def test_refused(lawful):
    with pytest.raises(BadValue, match="apart"):
        pronk_beside(lawful, apart=())


def test_asks_for_a_pronk():
    gait = collocate(load("q_spear_full", base="chain"), FootfallRequest())
    with pytest.raises(BadValue, match="pronk"):
        law_of_pronk(gait)
