"""The figures of a stride, against the trajectory they are taken from."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, simulate
from spear_pin.errors import BadValue, NoGait
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.studies.bound import at_speed, mean_speed, summarize
from spear_pin.studies.bound import speed as continuation
from tests.gaits.feeding import fed, idle
from tests.slow import slow_but

GAITS = ("long_stride", "force_lift_off")
LEGS = ("posterior", "anterior")


@pytest.fixture(scope="module", params=slow_but(GAITS, "long_stride"))
def gait(request):
    return Gait.load(request.param)


@pytest.fixture(scope="module")
def strides(gait):
    return simulate(gait.system, gait.state, cycles=2)


@pytest.fixture(scope="module")
def summary(gait, strides):
    return summarize(gait, strides)


def first(strides):
    return strides.cycle == 1


def bears(strides, leg):
    return first(strides) & (strides.phase == f"{leg}_stance")


class TestMotion:
    def test_of_the_gait(self, summary, gait):
        assert summary["lift_off"] == gait.system.law.lift_off
        assert summary["residual"] == gait.residual <= 1e-8
        assert summary["stable"] is bool(abs(gait.multipliers[0]) < 1)
        assert sum(summary["durations"].values()) == pytest.approx(summary["period"], abs=1e-7)

    def test_speed(self, summary, strides, gait):
        assert summary["speed"] == pytest.approx(2.5, abs=1e-6)
        assert summary["stride"] == pytest.approx(summary["speed"] * summary["period"])
        assert summary["stride"] == pytest.approx(0.5 * (strides.q[-1, 0] - strides.q[0, 0]), abs=1e-6)
        assert mean_speed(gait) == pytest.approx(2.5, abs=1e-6)

    def test_the_legs_land_as_the_law_says(self, summary, gait):
        for leg in LEGS:
            assert summary["knee_at_touchdown"][leg] == pytest.approx(summary["knee_touchdown"], abs=1e-3)
            commanded = getattr(gait.system.law, f"{leg}_leg_touchdown")
            assert summary["leg_at_touchdown"][leg] == pytest.approx(commanded, abs=1e-3)

    def test_range_of_the_torso(self, summary, strides):
        for name, i in (("pitch", 2), ("height", 1)):
            seen = strides.q[first(strides), i]
            assert summary[name] == pytest.approx((seen.min(), seen.max()), abs=1e-5)
            assert summary[name][0] <= seen.min() and summary[name][1] >= seen.max()


class TestGround:
    def test_forces(self, summary, strides):
        for i, leg in enumerate(LEGS):
            assert summary["peak_force"][leg] == pytest.approx(strides.force[bears(strides, leg), i, 1].max(), rel=1e-3)
            left = strides.force[bears(strides, leg), i, 1][-1]
            assert summary["lift_off_force"][leg] == pytest.approx(left, abs=1e-3)
            if summary["lift_off"] == "force":
                assert abs(left) < 1e-3
        assert summary["minimum_force"] > 0

    def test_friction(self, summary, strides, gait):
        assert summary["friction_used"] <= summary["friction"]
        assert max(summary["friction_at_impact"].values()) <= summary["friction"] + 1e-9
        ratios = []
        for i, leg in enumerate(LEGS):
            force = strides.force[bears(strides, leg), i]
            loaded = force[:, 1] >= 0.02 * 0.5 * gait.system.robot.weight
            ratios.append(np.abs(force[loaded, 0]) / force[loaded, 1])
        assert summary["friction_used"] == pytest.approx(np.concatenate(ratios).max(), rel=1e-2)
        assert summary["friction_used"] >= np.concatenate(ratios).max()

    def test_impact(self, summary, strides):
        event = strides.named("anterior_touchdown")[0]
        assert summary["friction_at_impact"]["anterior"] == abs(event.impulse[1, 0]) / event.impulse[1, 1]

    def test_clearance(self, summary, strides, gait):
        swinging = bears(strides, "posterior")
        heights = [gait.system.robot.toe_position(q, "anterior_toe")[1] for q in strides.q[swinging]]
        assert summary["clearance"]["anterior"] == min(heights) > 0
        assert summary["scuff_free"] is True
        assert min(summary["flight_clearance"].values()) > 0

    def test_a_toe_in_the_ground_scuffs(self, gait, strides):
        sunken = strides.q - 0.2 * np.eye(7)[1]
        below = summarize(gait, replace(strides, q=sunken))
        assert below["scuff_free"] is False and below["clearance"]["posterior"] < 0


class TestMotors:
    def test_torques_are_those_of_one_motor(self, summary, strides):
        for column, joint in enumerate(strides.actuated):
            leg = joint.split("_")[0]
            torque = 0.5 * np.abs(strides.u[:, column])
            stance, swing = torque[bears(strides, leg)].max(), first(strides) & (strides.phase != f"{leg}_stance")
            assert summary["peak_torque_stance"][joint] == pytest.approx(stance, rel=1e-3)
            assert summary["peak_torque_swing"][joint] == pytest.approx(torque[swing].max(), rel=1e-3)
            both = summary["peak_torque_stance"][joint], summary["peak_torque_swing"][joint]
            assert summary["peak_torque"][joint] == pytest.approx(max(both), rel=1e-12)
            rate = strides.v[:, strides.coordinates.index(joint)]
            assert summary["peak_speed"][joint] == pytest.approx(np.abs(rate[first(strides)]).max(), rel=1e-3)

    def test_in_stance_the_hip_torque_is_the_law_s(self, summary, gait):
        for leg in LEGS:
            expected = 0.5 * abs(getattr(gait.system.law, f"{leg}_hip_torque"))
            assert summary["peak_torque_stance"][f"{leg}_hip"] == pytest.approx(expected)


class TestEnergy:
    def test_balance(self, summary, strides):
        assert abs(summary["energy_balance"]) < 1e-6
        flows = summary["energy_flows"]
        assert flows == {name: strides.ledger[name][0] for name in strides.ledger.flows}
        assert summary["work"] == pytest.approx(summary["impact_loss"] - summary["released"] - flows["slip"], abs=1e-6)
        assert summary["impact_loss"] > 0 >= summary["released"]
        assert summary["energy_residual"] < 1e-6

    def test_cost(self, summary, gait):
        """Driving less braking is the net work, which the ledger has integrated exactly."""
        weight = gait.system.robot.mass * 9.81 * summary["stride"]
        driving, whole = summary["cost_of_transport_positive"], summary["cost_of_transport"]
        assert weight * (2 * driving - whole) == pytest.approx(
            sum(energy for flow, energy in summary["energy_flows"].items() if flow.startswith("motor_")), rel=1e-6
        )
        assert 0 < driving < whole

    def test_effort(self, summary, strides):
        chosen = first(strides)
        t, squares = strides.t[chosen], 2.0 * ((0.5 * strides.u[chosen]) ** 2).sum(axis=1)
        whole = (np.diff(t) * 0.5 * (squares[1:] + squares[:-1])).sum()
        assert summary["effort"] == pytest.approx(whole, rel=1e-3)
        assert summary["effort_per_distance"] == pytest.approx(summary["effort"] / summary["stride"], rel=1e-12)


class TestMistakes:
    def test_a_hop(self, hop, hops):
        with pytest.raises(BadValue, match="a bounding gait"):
            summarize(hop, hops)

    def test_no_whole_stride(self, gait, strides):
        with pytest.raises(BadValue, match="at least one whole stride"):
            summarize(gait, replace(strides, cycles=0))

    def test_a_leg_that_never_lifts(self, gait, strides):
        events = tuple(event for event in strides.events if event.name != "anterior_lift_off")
        with pytest.raises(BadValue, match="both legs land and lift off"):
            summarize(gait, replace(strides, events=events))


class TestAnotherSpeed:
    @pytest.mark.slow
    def test_is_a_fixed_point_there(self):
        faster = at_speed(Gait.load("least_effort"), 2.55)
        assert mean_speed(faster) == pytest.approx(2.55, abs=1e-7)
        assert faster.residual <= 1e-9

    @pytest.mark.parametrize("kind", ["feedback", "speed_gain"])
    def test_by_small_steps_without_feedback(self, gait, monkeypatch, kind):
        """The feedback is designed anew at the end."""
        own, inputs = (*gait.state[0][1:].tolist(), *gait.state[1].tolist()), ("posterior_hip_torque",)
        if kind == "feedback":
            regulated = fed(gait.with_law(nominal=own), inputs, [[0.0, 0.1, *(0.0,) * 12]])
        else:
            regulated = gait.with_law(speed_gain=(1e-6, 1e-6), speed_nominal=(2.5, 2.5))
        asked = []

        def find(system, vary, target, **options):
            assert system.law.speed_gain == (0.0, 0.0) and feedback_of(system) is None
            asked.append(target["mean_speed"])
            return replace(gait, system=system)

        monkeypatch.setattr(continuation, "find_gait", find)
        monkeypatch.setattr(
            continuation, "add_feedback", lambda gait, inputs: gait.system.law.nominal == own and inputs
        )
        monkeypatch.setattr(continuation, "speed_regulated", lambda gait, gain: gain)
        result = at_speed(regulated, 3.1)
        assert asked == pytest.approx([2.75, 3.0, 3.1], abs=1e-4)
        assert result == (inputs if kind == "feedback" else (1e-6, 1e-6))

    def test_needs_a_cycle(self, gait):
        with pytest.raises(BadValue, match="a gait whose cycle ends"):
            mean_speed(replace(gait, system=replace(gait.system, phase_limit=0.01)))

    def test_out_of_reach(self, gait, monkeypatch):
        """The steps get smaller before it is given up."""
        asked = []

        def find(system, vary, target, **options):
            asked.append(target["mean_speed"])
            if target["mean_speed"] > 2.9:
                raise NoGait("Newton's method makes no progress", 0.1)
            return gait

        monkeypatch.setattr(continuation, "find_gait", find)
        with pytest.raises(NoGait, match=r"from 2\.50 to 2\.8[78] m/s, and none was found beyond"):
            at_speed(gait, 3.5)
        assert asked == pytest.approx([2.75, 3.0, 2.875, 3.0, 2.9375], abs=1e-6)

    def test_is_not_tried_for_ever(self, gait, monkeypatch):
        def find(system, vary, target, on_iteration, **options):
            for iteration in range(1000):
                on_iteration(iteration, 0.3)
            pytest.fail("it went on")

        monkeypatch.setattr(continuation, "find_gait", find)
        seen = []
        with pytest.raises(NoGait, match=r"none was found .*residual 0\.3"):
            at_speed(gait, 2.6, on_iteration=lambda n, norm: seen.append(n))
        assert len(seen) < 50

    def test_two_kinds_of_feedback_are_refused_at_once(self, gait, monkeypatch):
        both = idle(gait.with_law(speed_gain=(1e-6, 0.0), speed_nominal=(2.5, 2.5)))
        monkeypatch.setattr(continuation, "run", lambda *_: pytest.fail("a stride was run"))
        with pytest.raises(BadValue, match="^gait is 'one with two kinds of event feedback'; expected one kind"):
            at_speed(both, 2.6)

    def test_a_hop_has_none(self, hop):
        with pytest.raises(BadValue, match="^gait is 'hopping'; expected a bounding gait"):
            at_speed(hop, 1.0)

    @pytest.mark.parametrize("speed", [0.0, -2.5, float("nan"), float("inf"), 99.0, 1.4, 3.6])
    def test_no_speed(self, gait, monkeypatch, speed):
        monkeypatch.setattr(continuation, "find_gait", lambda *_, **__: pytest.fail("it was tried"))
        with pytest.raises(BadValue, match="speed"):
            at_speed(gait, speed)
