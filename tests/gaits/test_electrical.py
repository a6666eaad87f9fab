"""The optimiser's smooth electrical cost is that of the simulation's samples."""

import pytest

from spear_pin import load
from spear_pin.gaits.optimize import search
from spear_pin.gaits.request import Request
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.studies.payoff.bounding import figures_of
from spear_pin.studies.payoff.motors import Motors

pytestmark = [pytest.mark.slow, pytest.mark.extra("casadi")]
LOSSY = Drive(motor("assumed_600w"), Gearbox(15.0, 0.7), 48.0)  # braking, half of the heat of driving


@pytest.mark.filterwarnings("ignore::DeprecationWarning")
def test_least_cost_is_the_cost_that_is_found():
    wanted = Request.scaled(load("q_spear"), objective="electrical", knee_drive=LOSSY, hip_drive=LOSSY, stiffness=112.0)
    gait, solution = search(load("q_spear"), wanted)
    found = figures_of(gait, Motors(LOSSY, LOSSY, dict.fromkeys(("knee", "hip"), "given")), wanted)
    assert solution.objective / 10.0 == pytest.approx(found.cost, rel=0.01)
