"""The example that adds a robot: its gait is periodic, stable, symmetric, and what the springs do is in it."""

import numpy as np
import pytest

from spear_pin import Gait, find_gait, simulate
from spear_pin.errors import BadFile
from tests import biped

pytestmark = pytest.mark.slow  # the gait is searched for

MIRRORED = [0, 1, 2, 5, 6, 3, 4]  # left for right
STEP = ["thrust", "{0}_lift_off", "apex", "{1}_touchdown"]


@pytest.fixture(scope="module")
def gait():
    return find_gait(biped.system(), guess=biped.NEAR)


@pytest.fixture(scope="module")
def strides(gait):
    return simulate(gait.system, gait.state, cycles=2, rtol=1e-10)


def test_it_runs_at_a_metre_a_second_and_is_stable(gait, strides):
    assert gait.residual < 1e-9
    assert gait.stable and gait.system.measures
    distance = strides.q[-1, 0] - strides.q[0, 0]
    assert distance / strides.t[-1] == pytest.approx(1.0, abs=1e-4)


def test_every_stride_is_the_first(gait, strides):
    for event in strides.named("left_touchdown"):
        np.testing.assert_allclose(event.q[1:], gait.state[0][1:], rtol=0, atol=1e-9)
        np.testing.assert_allclose(event.v, gait.state[1], rtol=0, atol=1e-8)


def test_events_come_in_order(strides):
    named = [event.name for event in strides.events if event.name not in ("spring_switch", "slip", "stick")]
    stride = [name.format("left", "right") for name in STEP] + [name.format("right", "left") for name in STEP]
    assert named == 2 * stride
    assert list(dict.fromkeys(strides.phase)) == ["left_stance", "left_flight", "right_stance", "right_flight"]


def test_the_right_step_mirrors_the_left_one(gait, strides):
    right = strides.named("right_touchdown")[0]
    np.testing.assert_allclose(right.q[1:][[i - 1 for i in MIRRORED[1:]]], gait.state[0][1:], rtol=0, atol=1e-8)
    np.testing.assert_allclose(right.v[MIRRORED], gait.state[1], rtol=0, atol=1e-7)
    assert gait.durations["left_flight"] == pytest.approx(gait.durations["right_flight"], abs=1e-8)


def test_the_ledger_closes(strides):
    assert np.abs(strides.ledger.residual).max() < 1e-8
    for flow in ("damping", "impact"):
        assert strides.ledger[flow].max() < -1.0
    assert strides.ledger.change == pytest.approx(0.0, abs=1e-7)  # periodic, on level ground


@pytest.mark.parametrize(("side", "other"), [("left", "right"), ("right", "left")])
def test_a_spring_pulls_in_the_stance_of_its_leg_beyond_the_latched_angle(strides, side, other):
    column = strides.spring_joints.index(f"{side}_knee")
    knee = strides.q[:, strides.coordinates.index(f"{side}_knee")]
    bears = strides.phase == f"{side}_stance"
    assert np.array_equal(strides.engaged[:, column], bears)
    latched = knee[bears][0]
    expected = np.where(bears, -48.84 * np.maximum(knee - latched, 0.0), 0.0)
    np.testing.assert_allclose(strides.spring[:, column], expected, rtol=0, atol=1e-6)
    assert expected.min() < -15.0
    assert strides.force[bears, strides.toes.index(f"{other}_toe")].max() == 0.0


def test_the_torso_bears_the_pitch_law_and_nothing_else(gait, strides):
    law, hips = gait.system.law, strides.u[:, 0] + strides.u[:, 2]
    bears = np.char.find(strides.phase, "stance") >= 0
    expected = law.pitch_gain * strides.q[:, 2] + law.pitch_damping * strides.v[:, 2]
    np.testing.assert_allclose(hips, np.where(bears, expected, 0.0), rtol=0, atol=1e-12)


@pytest.mark.slow
def test_multipliers_are_those_of_two_mirrored_steps(gait):
    """By central differences of half a stride in coordinates of one's own: its multipliers, squared."""
    robot = gait.system.robot
    chosen = [*range(2, 7)]  # pitch and joints, and their rates; the toe on the ground gives the rest

    def state(reduced):
        q, v = np.zeros(7), np.zeros(7)
        q[chosen], v[chosen] = reduced[:5], reduced[5:]
        q[1] = -robot.toe_position(q, "left_toe")[1]
        v[:2] = -(robot.toe_jacobian(q, "left_toe") @ v)  # of torso_x and torso_z it is the identity
        return q, v

    def step(reduced):
        event = simulate(gait.system, state(reduced), rtol=1e-9).named("right_touchdown")[0]
        return np.concatenate([event.q[MIRRORED][chosen], event.v[MIRRORED][chosen]])

    start = np.concatenate([part[chosen] for part in gait.state])
    np.testing.assert_allclose(step(start), start, rtol=0, atol=1e-7)
    nudges = 1e-4 * np.eye(len(start))
    jacobian = np.array([(step(start + nudge) - step(start - nudge)) / 2e-4 for nudge in nudges]).T
    expected = np.sort(np.abs(np.linalg.eigvals(jacobian)) ** 2)[::-1]
    np.testing.assert_allclose(np.abs(gait.multipliers), expected, rtol=0, atol=1e-4)


@pytest.mark.parametrize("push", [-0.6, 0.6])
def test_it_recovers_from_a_push(gait, push):
    """Of the whole robot, in m/s forward, in the flight that ends at the section."""
    apex = simulate(gait.system, gait.state).named("apex")[1]
    v = apex.v.copy()
    v[0] += push
    errors = [
        np.abs(event.v - gait.state[1]).max()
        for event in simulate(gait.system, (apex.q, v), cycles=6, rtol=1e-7).named("left_touchdown")
    ]
    assert len(errors) == 7 and errors[0] > 0.1
    assert errors[-1] < 1e-3 * errors[0]


@pytest.mark.parametrize("rtol", [1e-5, 1e-6])
def test_a_toe_that_lifts_is_no_fall(gait, rtol):
    """What coarse integration leaves of the constraint is no height to fall from."""
    assert simulate(gait.system, gait.state, rtol=rtol).reason == "complete"


def test_a_file_needs_the_automaton_to_be_read(gait, tmp_path):
    path = gait.save(tmp_path / "biped.json")
    with pytest.raises(BadFile, match="kind is 'running'.*like=SYSTEM"):
        Gait.load(path)
    again = Gait.load(path, like=biped.system())
    assert again.system.law == gait.system.law
    assert all(np.array_equal(new, old) for new, old in zip(again.state, gait.state, strict=True))
