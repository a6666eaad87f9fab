"""Sensors that are noisy, and commands that are lost."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin.hybrid.hardware import EDGE, HORIZON, Sensing
from tests.hybrid.hardware.drives import IDEAL, LOSSES, NOISE, REAL, assert_same_motion, landings


class TestSensing:
    def test_noise_of_no_amplitude_changes_nothing(self, run, clean):
        assert_same_motion(run(IDEAL, sensing=Sensing(seed=5)), clean)

    @pytest.mark.slow
    def test_the_clock_runs_on_through_events(self, run, hop):
        noisy, law = run(IDEAL, sensing=NOISE), hop.system.law
        flight = noisy.phase == "flight"
        assert (noisy.cycle[flight] == 2).any() and len(noisy.named("touchdown")) == 2
        noises = [NOISE.noise(t, 2) for t in noisy.t[flight]]
        angles, rates = (np.array([noise[i] for noise in noises]) for i in (0, 1))
        q, v = noisy.q[flight, -2:] + angles, noisy.v[flight, -2:] + rates
        targets = np.array([0.5, 1.0]) * law.knee_touchdown
        wanted = [law.hip_gain, law.knee_gain] * (targets - q) - [law.hip_damping, law.knee_damping] * v
        np.testing.assert_allclose(noisy.u[flight], wanted, atol=1e-9)
        assert np.abs(wanted - noisy.u[flight] + [law.hip_gain, law.knee_gain] * angles).max() > 0.05

    @pytest.mark.slow
    def test_the_same_seed_the_same_run(self, run):
        first, again = run(REAL, sensing=NOISE), run.__wrapped__(REAL, sensing=replace(NOISE))
        other = run(REAL, sensing=replace(NOISE, seed=1))
        np.testing.assert_array_equal(landings(first), landings(again))
        assert np.abs(landings(first) - landings(other)).max() > 1e-3

    @pytest.mark.slow
    def test_lost_commands_leave_no_current(self, run):
        lossy = run(REAL, sensing=LOSSES)
        since = [lossy.t - b for b in LOSSES.losses_begin if b < lossy.t[-1]]
        assert since
        lost = np.any([(s >= EDGE) & (s <= 0.02 - EDGE) for s in since], axis=0)
        around = np.any([(s >= 0) & (s <= 0.02) for s in since], axis=0)
        assert lost.sum() > 5 and not lossy.current[lost].any() and lossy.reference[lost].all(axis=1).any()
        np.testing.assert_array_equal(lossy.current[~around], lossy.reference[~around])

    @pytest.mark.parametrize("joints", [1, 2, 4, 8])
    def test_the_noise_has_its_amplitude_and_cutoff(self, joints):
        sensing = Sensing(angle_noise=0.3, rate_noise=2.0, cutoff=10.0, seed=2)
        times = np.linspace(0.0, 100.0, 4001)
        noises = np.array([sensing.noise(t, joints) for t in times])
        assert noises.shape == (4001, 2, joints)
        np.testing.assert_allclose(noises.std(axis=0), np.outer([0.3, 2.0], np.ones(joints)), rtol=0.05)
        alike = np.corrcoef(noises.reshape(4001, -1).T) - np.eye(2 * joints)
        assert np.abs(alike).max() < 0.15
        spectrum = np.abs(np.fft.rfft(noises[:, 0, 0] * np.hanning(4001)))
        assert spectrum[np.fft.rfftfreq(4001, 0.025) > 10.2].max() < 1e-3 * spectrum.max()

    def test_commands_ramp_out_and_in(self):
        sensing = Sensing(losses=1.0, loss_duration=0.01)
        begins = sensing.losses_begin
        assert len(begins) == pytest.approx(HORIZON, abs=4 * math.sqrt(HORIZON)) and (np.diff(begins) > 0).all()
        begin = begins[np.argmax(np.diff(begins))]
        offsets = [-EDGE, 0.0, EDGE / 2, EDGE, 0.005, 0.01 - EDGE, 0.01 - EDGE / 2, 0.01, 0.02]
        arriving = [sensing.arriving(begin + offset) for offset in offsets]
        assert arriving == pytest.approx([1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0], abs=1e-9)
        assert Sensing().arriving(1.0) == 1.0

    def test_what_is_lost_does_not_come_back_when_another_loss_begins(self):
        sensing = Sensing(losses=50.0, loss_duration=0.05)
        begins = sensing.losses_begin[:100]
        assert (np.diff(begins) < 0.04).any()
        for time in np.arange(begins[0], begins[-1], 1e-3):
            lost = ((time - begins >= EDGE) & (time - begins <= 0.05 - EDGE)).any()
            assert not lost or sensing.arriving(time) == 0.0
        fine = [sensing.arriving(t) for t in np.arange(begins[0], begins[0] + 0.5, EDGE / 8)]
        assert np.abs(np.diff(fine)).max() < 0.13
