"""The torques of the hop: the control law in flight and in stance, the knee spring that latches and lets go."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import HoppingLaw, Spring, hopping, simulate
from spear_pin.hybrid.domain import Mount
from tests.hybrid.motions import SPRING_DAMPING, STIFFNESS, balance, stances, terms_of

# source: the controller's gains
HIP_GAIN, HIP_DAMPING, KNEE_GAIN, KNEE_DAMPING = 54.77, 1.37, 63.25, 0.52
FREQUENCY = 2.56


class TestTorques:
    """The control law and the spring, written out by hand."""

    def test_flight(self, hops):
        flight = hops.phase == "flight"
        hip, knee = hops.q[flight, 1], hops.q[flight, 2]
        hip_rate, knee_rate = hops.v[flight, 1], hops.v[flight, 2]
        expected = np.column_stack(
            [
                HIP_GAIN * (0.5 - hip) - HIP_DAMPING * hip_rate,
                KNEE_GAIN * (1.0 - knee) - KNEE_DAMPING * knee_rate,
            ]
        )
        np.testing.assert_allclose(hops.u[flight], expected, rtol=0, atol=1e-10)
        np.testing.assert_array_equal(hops.tau[flight], hops.u[flight])

    def test_stance(self, hop, hops):
        torque = hop.system.law.stance_torque
        assert len(stances(hops)) == 11
        for part in stances(hops):
            since = hops.t[part] - hops.t[part][0]
            clear = np.abs(since - 0.5 / FREQUENCY) > 1e-9
            wave = torque * np.sign(np.sin(2 * np.pi * FREQUENCY * since))
            wave[0] = torque
            motor, knee, rate = hops.u[part], hops.q[part, 2], hops.v[part, 2]
            np.testing.assert_allclose(motor[clear, 1], wave[clear], rtol=1e-14)
            np.testing.assert_array_equal(motor[:, 0], 0.0)
            spring = -STIFFNESS * np.maximum(0.0, knee - knee[0])
            np.testing.assert_allclose(hops.spring[part, 0], spring, rtol=0, atol=1e-10)
            np.testing.assert_allclose(hops.tau[part, 1], motor[:, 1] + spring - SPRING_DAMPING * rate, atol=1e-10)
            np.testing.assert_array_equal(hops.tau[part, 0], 0.0)

    def test_the_square_wave_flips_at_half_its_period(self, hop, hops):
        begins = [hops.t[part][0] for part in stances(hops)]
        flips = [event.time for event in hops.named("torque_switch")]
        np.testing.assert_allclose(np.subtract(flips, begins), 0.5 / FREQUENCY, rtol=0, atol=1e-14)
        for flip in flips:
            before, after = np.flatnonzero(hops.t == flip)
            assert hops.u[before, 1] == -hops.u[after, 1] == hop.system.law.stance_torque

    def test_the_square_wave_goes_on_for_as_long_as_the_stance(self, robot):
        system = hopping(robot, HoppingLaw(stance_torque=0.5))
        standing = simulate(system, system.guess())
        assert standing.reason == "no_event"
        np.testing.assert_allclose(
            [event.time for event in standing.named("torque_switch")], np.arange(1, 26) / (2 * FREQUENCY), rtol=1e-14
        )
        since, knee = standing.t, standing.u[:, 1]
        phase = (2 * FREQUENCY * since) % 1.0
        clear = (phase > 1e-6) & (phase < 1 - 1e-6)
        np.testing.assert_array_equal(knee[clear], 0.5 * np.sign(np.sin(2 * np.pi * FREQUENCY * since[clear])))


class TestSpring:
    def test_pulls_back_from_stretch_while_it_is_taut(self):
        mount = Mount("knee", Spring(stiffness=20.0), rest="rest", taut="taut")
        held, slack = {"taut": 1.0}, {"taut": 0.0}
        assert mount.pull(mount.spring, 0.3, held, np) == pytest.approx(-20.0 * 0.3)
        assert mount.energy(1.2, 0.9, held) == pytest.approx(0.5 * 20.0 * 0.3**2)
        assert mount.pull(mount.spring, 0.3, slack, np) == mount.energy(1.2, 0.9, slack) == 0.0
        assert replace(mount, taut=None).pull(mount.spring, -0.3, {}, np) == pytest.approx(20.0 * 0.3)

    def test_latches_the_knee_at_touchdown(self, hops):
        touchdowns = hops.named("touchdown")[:-1]
        assert len(touchdowns) == 10
        for touchdown, part in zip(touchdowns, stances(hops)[1:], strict=True):
            assert hops.q[part, 2][0] == touchdown.q[2]
            assert hops.spring[part, 0][0] == 0.0
            compression = hops.q[part, 2] - touchdown.q[2]
            np.testing.assert_allclose(hops.spring[part, 0], -STIFFNESS * np.maximum(compression, 0), atol=1e-10)

    def test_latches_another_angle_when_it_lands_at_another(self, hop, hops):
        q, v = (part.copy() for part in (hops.named("apex")[0].q, hops.named("apex")[0].v))
        v[2] += 1.0
        disturbed = simulate(hop.system, (q, v), cycles=3)
        angles = [event.q[2] for event in disturbed.named("touchdown")]
        assert np.ptp(angles) > 1e-3
        for angle, part in zip(angles[:-1], stances(disturbed), strict=True):
            compression = np.maximum(disturbed.q[part, 2] - angle, 0)
            np.testing.assert_allclose(disturbed.spring[part, 0], -STIFFNESS * compression, atol=1e-10)

    def test_releases_what_it_stores_at_lift_off(self, hops):
        lift_offs = hops.named("lift_off")
        assert len(lift_offs) == 11
        for lift_off, part in zip(lift_offs, stances(hops), strict=True):
            compression = lift_off.q[2] - hops.q[part, 2][0]
            assert compression > 1e-3
            assert lift_off.work["released"] == pytest.approx(-0.5 * STIFFNESS * compression**2, rel=1e-12)
        released = [event.work["released"] for event in lift_offs]
        np.testing.assert_allclose(hops.ledger["released"], released, rtol=1e-12)

    @pytest.mark.parametrize("unilateral", [True, False])
    def test_beyond_the_latched_angle(self, robot, hop, unilateral):
        """Standing up from the latched angle and sinking back through it."""
        law = HoppingLaw(stance_torque=0.0)
        system = hopping(robot, law, Spring(stiffness=20.0, damping=0.3, unilateral=unilateral))
        q, v = hop.state
        trajectory = simulate(system, (q, -0.3 * v))
        knee = trajectory.q[:, 2] - q[2]
        assert knee.min() < -0.02 and knee.max() > 0.02
        expected = -20.0 * (np.maximum(knee, 0.0) if unilateral else knee)
        np.testing.assert_allclose(trajectory.spring[:, 0], expected, rtol=0, atol=1e-9)
        total = trajectory.spring[:, 0] - 0.3 * trajectory.v[:, 2]
        np.testing.assert_allclose(trajectory.tau[:, 1] - trajectory.u[:, 1], total, rtol=0, atol=1e-9)
        switches = [event for event in trajectory.named("spring_switch") if event.time > 0.0]
        assert bool(switches) == unilateral
        for switch in switches:
            assert switch.q[2] == pytest.approx(q[2], abs=1e-10)
        assert balance(trajectory, terms_of(trajectory)).max() < 1e-8
