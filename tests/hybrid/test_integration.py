"""Motion in one domain against an integrator of another method, and how it ends."""

from types import SimpleNamespace

import numpy as np
import pytest
import scipy

from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.flow_names import flow_names
from spear_pin.hybrid.hardware import HARDWARE_TOLERANCE
from spear_pin.hybrid.integration import DUE, Accuracy, accuracy, integrate_motion
from spear_pin.hybrid.modes import choose, starting_phase
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run

FINE = Accuracy(1e-12, 1e-14, 0.05)


@pytest.fixture(scope="module")
def begun(hop):
    """The flow behind the section of a hop, and the state."""
    phase, held = starting_phase(hop.system, hop.state)
    y = np.concatenate([*hop.state, np.zeros(len(flow_names(hop.system)))])
    return choose(hop.system, phase, held, 0.0, y), y


def test_by_another_method(begun):
    flow, y = begun
    motion = integrate_motion(flow, Watch(flow, 0.0, y), 0.0, y, 0.02, FINE, keep=True, most=1_000_000)
    assert (motion.why, motion.event, motion.t) == (DUE, None, 0.02)
    expected = scipy.integrate.solve_ivp(flow, (0.0, 0.02), y, method="Radau", rtol=1e-11, atol=1e-13)
    np.testing.assert_allclose(motion.y[:6], expected.y[:6, -1], rtol=0, atol=1e-8)
    assert [piece.begin for piece in motion.pieces[1:]] == [piece.end for piece in motion.pieces[:-1]]
    np.testing.assert_allclose(motion.pieces[-1].state(np.array([0.02]))[:, 0], motion.y, rtol=0, atol=1e-12)


def test_ends_on_a_guard(hop):
    """The flight ends as the toe comes down, whose height is zero then and was above before."""
    flight = run(hop.system, hop.state, 1, Options(1e-10, keep=True)).segments[-1]
    t, robot = flight.pieces[0].begin, hop.system.robot
    y = flight.pieces[0].state(np.array([t]))[:, 0]
    flow = choose(hop.system, "flight", flight.held, t, y)
    motion = integrate_motion(flow, Watch(flow, t, y), t, y, 1.0, FINE, keep=True, most=1_000_000)
    assert motion.why == "" and motion.event in flow.domain.guards and motion.event.name == "touchdown"
    assert robot.toe_position(motion.y[:3], "toe")[-1] == pytest.approx(0.0, abs=1e-12)
    times = np.linspace(motion.pieces[0].begin, motion.pieces[0].end, 5)[1:]
    heights = [robot.toe_position(state[:3], "toe")[-1] for state in motion.pieces[0].state(times).T]
    assert min(heights) > 0.0
    (apex,) = motion.observed
    assert apex[0] == "apex" and t < apex[1] < motion.t
    assert robot.toe_position(apex[2][:3], "toe")[-1] > 0.0
    assert motion.t == pytest.approx(hop.durations["flight"], abs=1e-8)


def test_too_many_evaluations(begun):
    flow, y = begun
    most = flow.evaluations + 30
    motion = integrate_motion(flow, Watch(flow, 0.0, y), 0.0, y, 1.0, FINE, keep=False, most=most)
    assert motion.why == "evaluation_cap" and motion.event is None and most < flow.evaluations < most + 30


def test_accuracy():
    assert accuracy(Options(1e-8), None) == (1e-8, 1e-10, 0.05)
    assert accuracy(Options(1e-8, atol=1e-6), None).atol == 1e-6


def test_hardware_asks_for_more():
    share = HARDWARE_TOLERANCE
    for step in (1e-3, 1.0):
        found = accuracy(Options(1e-8), SimpleNamespace(max_step=step))
        assert found == (share * 1e-8, share * 1e-10, min(step, 0.05))
