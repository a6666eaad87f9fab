"""Margins to another order of events: of a hop known from elsewhere, and derivatives against gaits nearby."""

import numpy as np
import pytest

from spear_pin import simulate
from spear_pin.gaits.codesign.closing import closed, led
from spear_pin.gaits.sensitivity.heat import with_heat
from spear_pin.gaits.sensitivity.orbit import Orbit, solved
from spear_pin.hybrid.parameters import number
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox

pytestmark = pytest.mark.extra("heyoka")
VARY, KEEP, OVER = ("stance_torque",), {"flight_time": 0.2}, ("stiffness", "knee_ratio", "friction")
MOTORS = {"knee": motor("spear_ii_knee")}


@pytest.fixture(scope="module")
def begun(hop):
    return closed(Orbit(hop.system, hop.state, (*VARY, *OVER)), VARY, KEEP)


def test_the_chain_is_all_but_slack_as_the_toe_leaves(hop, begun):
    """Against the sampled trajectory: the knee at lift-off less the angle that touchdown latched."""
    run = simulate(hop.system, hop.state, 1, progress=False)
    knee = run.coordinates.index("knee")
    flight = run.named("lift_off")[0]
    left = flight.q[knee] - hop.state[0][knee]
    assert begun.margins["spring_switch"].value == pytest.approx(left, abs=1e-8)
    assert left == pytest.approx(5.46e-3, abs=1e-5)


def test_margins_of_what_begins_on_zero_are_not_zero(begun):
    """Touchdown as the toe leaves, the spring as it engages, stick as the toe begins to slide."""
    assert "touchdown" not in begun.margins
    assert all(margin.value > 1e-4 for margin in begun.margins.values())


def along(begun, found, name, j):
    dxi, dz = solved(begun, VARY, list(KEEP))
    return found.derivative @ np.concatenate([dxi, dz, np.eye(len(OVER))])[:, j]


@pytest.mark.parametrize("j", range(len(OVER)))
def test_derivatives_against_gaits_nearby(begun, j):
    name, value = OVER[j], number(begun.system, OVER[j])
    h = 2e-4 * value
    others = dict.fromkeys(OVER, 0.0)
    ends = [led(begun, VARY, KEEP, {**others, name: k * h}) for k in (1, -1, 2, -2)]

    def measured(orbit):
        return orbit.margins | with_heat(orbit.measures, orbit.system, MOTORS, orbit.names, orbit.dimension)

    values = [measured(each) for each in ends]
    for margin, found in measured(begun).items():
        a, b, c, d = (each[margin].value for each in values)
        expected = (8.0 * (a - b) - (c - d)) / 12.0
        scale = max(abs(found.value), 1e-3)
        assert h * along(begun, found, margin, j) == pytest.approx(expected, rel=1e-5, abs=1e-9 * scale)


def test_heat_and_energy_of_a_hop(hop, begun):
    found = with_heat(begun.measures, begun.system, MOTORS, begun.names, begun.dimension)
    run = simulate(hop.system, hop.state, 1, progress=False)
    drive = Drive(MOTORS["knee"], Gearbox(15.0), 24.0)
    watts = drive.joule_power(run.u[:, run.actuated.index("knee")], 1.0)
    assert found["heat_knee"].value == pytest.approx(np.trapezoid(watts, run.t), rel=2e-4)
    assert found["energy"].value == pytest.approx(found["work"].value + found["heat_knee"].value)
    assert found["energy"].value == pytest.approx(20.2142, abs=1e-4)
