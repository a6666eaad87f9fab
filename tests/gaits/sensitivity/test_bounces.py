"""A hop whose toe lands, lifts off and lands again, which counts as one touchdown."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import find_gait, hopping, load
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.hybrid.periodic import differentiate_return_map, return_map
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.tangent.record import Recorder

pytestmark = pytest.mark.extra("heyoka")
NEAR = np.array([0.5723, 0.4708, 0.9019]), np.array([-0.593, 2.161, 4.281])


def test_a_toe_that_bounces_begins_no_hop():
    """The flight of a bounce counts to stance; both engines say so, and where it is."""
    system = with_numbers(hopping(load("spear_ii", locked=["boom_x"])), {"stance_torque": 7.826, "stiffness": 60.0})
    gait = find_gait(system, guess=NEAR, rtol=1e-11)
    orbit = Orbit(gait.system, gait.state, ())
    arcs = [stretch.arc for stretch in orbit.cycle.stretches]
    assert [(arc.domain.name, arc.event.name) for arc in arcs if arc.again] == [("flight", "touchdown")]
    run = return_map(orbit.system, orbit.state, 1e-12)
    assert [event.name for event in run.events].count("retouch") == 1
    assert {phase: seconds.x for phase, seconds in orbit.cycle.durations.items()} == pytest.approx(run.durations)
    y, engines = np.concatenate(orbit.state), (Recorder(orbit.system), Recorder(orbit.system))
    engines[1]._fast = None
    fast, slow = (engine.lap(y) for engine in engines)
    assert fast.order == slow.order and [arc.again for arc in fast.arcs] == [arc.again for arc in slow.arcs]
    assert fast.spent == pytest.approx(dict(slow.spent), abs=1e-9)
    np.testing.assert_allclose(fast.y, slow.y, rtol=0, atol=1e-8)
    expected = differentiate_return_map(orbit.system, orbit.state, 1e-12)
    np.testing.assert_allclose(orbit.jacobian, expected, rtol=0, atol=1e-6 * np.abs(expected).max())


def test_a_flight_that_counts_as_a_bounce_closes_no_cycle():
    gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
    y = np.concatenate(gait.state)
    phase, resets = Recorder(gait.system).start
    for shortest, closes in ((0.05, True), (0.3, False)):
        recorder = Recorder(replace(gait.system, shortest_flight=shortest))
        held = latch_values({}, resets, y[:3].tolist(), y[3:].tolist(), recorder.law)
        assert (recorder._fast.lap(phase, y, held) is not None) == closes
        assert (return_map(recorder.system, gait.state).cycles == 1) == closes
