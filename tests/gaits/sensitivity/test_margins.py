"""Margins to another order of events: of a hop known from elsewhere, and derivatives against gaits nearby."""

import numpy as np
import pytest

from spear_pin import simulate
from spear_pin.gaits.codesign.closing import closed, led
from spear_pin.gaits.sensitivity.orbit import Orbit, solved
from spear_pin.hybrid.parameters import number

pytestmark = pytest.mark.extra("heyoka")
VARY, KEEP, OVER = ("stance_torque",), {"flight_time": 0.2}, ("stiffness", "knee_ratio", "friction")


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

    for margin, found in begun.margins.items():
        a, b, c, d = (each.margins[margin].value for each in ends)
        expected = (8.0 * (a - b) - (c - d)) / 12.0
        scale = max(abs(found.value), 1e-3)
        assert h * along(begun, found, margin, j) == pytest.approx(expected, rel=1e-5, abs=1e-9 * scale)
