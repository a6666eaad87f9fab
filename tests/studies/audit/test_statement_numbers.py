"""Numbers of the reference runs that statements ask for, against what the documentation has of the same gaits."""

import numpy as np
import pytest

from spear_pin.studies.audit import runs
from spear_pin.studies.audit.statements import bound_numbers as bound
from spear_pin.studies.audit.statements import hop_numbers as hop
from spear_pin.studies.audit.statements import push_numbers as push


class TestBound:
    def test_gait(self):
        assert bound.speed() == pytest.approx(2.5, abs=1e-6)
        assert len(bound.phases()) == 4 and sum(bound.phases()) == pytest.approx(0.35, abs=1e-3)
        assert bound.largest_multiplier() == pytest.approx(1.067, abs=1e-3)

    @pytest.mark.slow
    def test_springs(self):
        assert bound.peak_reduction() == pytest.approx((75.5 - 58.6, 82.6 - 68.3), abs=0.1)
        assert bound.hip_difference() < 1e-6
        assert bound.knee_peaks(112.0) == pytest.approx((41.6, 54.1), abs=0.05)
        assert bound.peaks_by_stiffness(0) == pytest.approx((75.5, 58.6, 41.6, 15.0), abs=0.05)
        assert bound.flight_difference() < 1e-6

    @pytest.mark.slow
    def test_flat_at_the_virtual_stiffness_and_reversed_beyond(self):
        assert max(bound.spread_in_stance(200.0)) < 1e-9 < min(bound.spread_in_stance(56.0))
        assert bound.peaks_by_stiffness(0, (300.0, 400.0)) == pytest.approx((15.2, 45.5), abs=0.1)

    def test_hips(self):
        assert bound.hip_time_outside(60.0) == pytest.approx(0.1597, abs=1e-4)
        assert bound.hip_over_knee() == pytest.approx((31.2 / 21.7, 7.9 / 26.3), rel=0.01)

    @pytest.mark.slow
    def test_zero_dynamics(self):
        assert bound.fixed_point_residual("force_lift_off") < 1e-8
        assert bound.largest_output("least_effort") < 1e-8

    def test_preload(self):
        with_it, with_less = bound.friction_by_preload()
        assert with_it == pytest.approx(0.486, abs=1e-3) and with_it < with_less < 0.6
        assert bound.preloads()[::2] == pytest.approx((15.0, 5.0), abs=1e-3)

    def test_knee_motors(self):
        outside = [bound.knee_time_outside(power) for power in ("100 W", "260 W", "600 W")]
        assert outside == pytest.approx([0.1396, 0.0695, 0.0621], abs=1e-4)
        assert bound.outside_near_events() == pytest.approx((0.90, 0.61), abs=5e-3)  # least_effort has none outside
        assert 0.0 < bound.outside_without_preload() < 1.0


class TestHop:
    @pytest.mark.slow
    def test_gait(self):
        assert hop.flight_time() == pytest.approx(0.2, abs=1e-9)
        assert hop.largest_multiplier() == pytest.approx(-hop.leading_multiplier())
        assert hop.leading_multiplier() == pytest.approx(-0.4062, abs=1e-4)
        assert hop.stance_in_periods() == pytest.approx(0.3643 * 2.56, abs=1e-3)
        assert hop.fixed_point_residual() < 1e-9

    def test_a_wrong_frequency(self):
        slow, own, fast = hop.work_against()
        assert own < 0.1 < 1.0 < min(slow, fast)

    def test_motion(self):
        assert hop.knee_rate_at_touchdown() == pytest.approx(1.0892, abs=1e-3)
        assert hop.peak_knee_rate() == pytest.approx(7.16, abs=5e-3)
        assert hop.push_share_of_spring() == pytest.approx(0.698, abs=1e-3)
        assert hop.squared_gains() == pytest.approx((3000.0, 4000.0), rel=2e-4)


class TestPush:
    def test_gears(self):
        turns = push.first_turns()
        assert len(turns) == 4 and list(turns) == sorted(turns)
        assert push.rotor_share(66.0) > push.rotor_share(30.0) > push.rotor_share(15.0) > 0.0

    def test_rest(self):
        assert push.resting_angle() == pytest.approx(1.242, abs=1e-3)
        assert 0.0 < push.energy_left() < push.energy_left(0.05) < 1.0
        *others, without_motor = push.least_forces()
        assert len(others) == 5 and min(others) > 0.0 > without_motor

    def test_motor(self):
        assert push.supply_difference() == 0.0 < push.belt_difference()
        low, high = push.peak_emf()
        assert low < 10.0 and high == 24.0


@pytest.mark.slow
def test_runs_are_made_once():
    assert runs.hop() is runs.hop() and runs.knees() is runs.knees()
    assert np.isfinite(runs.bound_costs().of_transport["electrical_0"])
