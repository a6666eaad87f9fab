"""Laws that a computer runs: beside an integration by hand, the work of constant torques, and the controller in C."""

import shutil
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spear_pin import Gait, HoppingLaw, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.hybrid.result import Moment
from spear_pin.hybrid.sampled import COMMANDED
from spear_pin.model.actuator import Actuator
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Gearbox
from tests.viz.controller.compiled import Compiled, hop

SAMPLE, LATENCY = 0.005, 0.007
PHASES = {
    "hop": ("flight", "stance"),
    "long_stride": ("flight_1", "anterior_stance", "flight_2", "posterior_stance"),
}


@pytest.fixture(scope="module")
def robot():
    return load("spear_ii", locked=["boom_x"])


@pytest.fixture(scope="module")
def system(robot):
    return hopping(robot)


def in_the_air(system):
    q, v = system.guess()
    return q + np.array([0.05, 0.1, 0.2]), v + np.array([1.0, 0.5, -1.0])


class TestOfFlight:
    """Torques that a sample before computed, from the state by hand up to touchdown."""

    def test_beside_an_integration_by_hand(self, robot, system):
        law, state = HoppingLaw(), in_the_air(system)
        flight = simulate(system, state, rtol=1e-11, sample_time=SAMPLE, latency=LATENCY)
        touchdown = next(event for event in flight.events if event.name == "touchdown")

        def wanted(y):
            _, hip, knee, _, hip_rate, knee_rate = y
            return np.array(
                [
                    law.hip_gain * (0.5 * law.knee_touchdown - hip) - law.hip_damping * hip_rate,
                    law.knee_gain * (law.knee_touchdown - knee) - law.knee_damping * knee_rate,
                ]
            )

        def slope(t, y, u):
            q, v = y[:3], y[3:]
            return [*v, *np.linalg.solve(robot.mass_matrix(q), np.array([0.0, *u]) - robot.bias(q, v))]

        y, t, u = np.concatenate(state), 0.0, wanted(np.concatenate(state))
        samples, k = [(LATENCY, u)], 1  # the torques on their way, the first of which act already
        while t < touchdown.time:
            due = min(k * SAMPLE, *(time for time, _ in samples)) if samples else k * SAMPLE
            until = min(due, touchdown.time)
            if until > t:
                y = solve_ivp(slope, (t, until), y, args=(u,), method="DOP853", rtol=1e-12, atol=1e-13).y[:, -1]
                t = until
            if abs(t - k * SAMPLE) < 1e-12:
                samples.append((t + LATENCY, wanted(y)))
                k += 1
            while samples and samples[0][0] <= t + 1e-12:
                u = samples.pop(0)[1]
        assert k > 20
        np.testing.assert_allclose([*touchdown.q, *touchdown.v_before], y, rtol=0, atol=1e-9)

    def test_first_torques_act_at_once(self, system):
        state = in_the_air(system)
        (_, hip, knee), (_, hip_rate, knee_rate) = state
        motion = simulate(system, state, sample_time=SAMPLE, latency=0.1)
        before = motion.t < 0.1
        assert before.sum() > 10 and np.ptp(motion.u[before], axis=0).tolist() == [0.0, 0.0]
        assert motion.u[0].tolist() == pytest.approx(
            [54.77 * (0.5 - hip) - 1.37 * hip_rate, 63.25 * (1.0 - knee) - 0.52 * knee_rate]
        )

    def test_a_moment_goes_on_with_its_torques(self, system):
        q, v = in_the_air(system)
        moment = Moment(q, v, "flight", {"speed": 0.0, COMMANDED: (1.0, -2.0)})
        motion = simulate(system, moment, sample_time=SAMPLE, latency=0.003)
        late, second = motion.t < 0.003, (motion.t > 0.0031) & (motion.t < 0.008)
        assert (motion.u[late] == [1.0, -2.0]).all() and late.sum() > 1
        assert (motion.u[second] == motion.u[second][0]).all() and motion.u[second][0, 0] != 1.0


class TestOfHops:
    def test_motors_do_the_work_of_constant_torques(self, system):
        motion = simulate(system, system.guess(), sample_time=0.004, latency=0.001)
        assert motion.reason == "complete" and abs(motion.ledger.residual[0]) < 1e-10
        moved = np.diff(motion.q[:, 1:], axis=0)
        for i, joint in enumerate(("hip", "knee")):
            work = (motion.u[:-1, i] * moved[:, i]).sum()
            assert motion.ledger[f"motor_{joint}"][0] == pytest.approx(work, abs=1e-9)

    def test_a_sample_together_with_the_square_wave(self, system):
        motion = simulate(system, system.guess(), sample_time=0.25 / 2.56)
        assert [event.name for event in motion.events].count("torque_switch") >= 1

    @pytest.mark.slow
    def test_less_time_is_nearer_to_the_continuous_law(self, system):
        ends = [simulate(system, system.guess(), sample_time=time).events[-1].v for time in (0.008, 0.001)]
        exact = simulate(system, system.guess()).events[-1].v
        far, near = (np.abs(end - exact).max() for end in ends)
        assert 0.0 < near < 0.3 * far

    @pytest.mark.slow
    def test_a_bound(self):
        gait = Gait.load("long_stride")
        stride = simulate(gait.system, gait.state, sample_time=0.001)
        assert stride.reason == "complete" and np.abs(stride.q[-1, 1:] - gait.state[0][1:]).max() < 0.1


@pytest.mark.slow
@pytest.mark.extra("casadi")
@pytest.mark.skipif(shutil.which("gcc") is None, reason="no gcc here")
@pytest.mark.parametrize("name", ["hop", "long_stride"])
def test_the_controller_in_c_sees_events_itself(tmp_path, name):
    gait = hop(cycles=8) if name == "hop" else Gait.load(name)
    controller, count, seen = Compiled(gait, tmp_path), 0, ()

    def law(t, q, v, held, p, dyn, ops):
        nonlocal count, seen
        if t == 0.0:  # the run begins
            controller.begin(0.0, q, v)
            return controller.torques(0.0, q, v)
        count += 1
        before = controller.own.phase
        _, torques = controller.step(0.001 * count, q, v)
        if controller.own.phase != before:
            seen += (gait.system.phases[controller.own.phase],)
        return torques

    system = replace(gait.system, domains=tuple(replace(domain, law=law) for domain in gait.system.domains))
    found = simulate(system, gait.state, 2, sample_time=0.001)
    assert found.cycles == 2 and seen == (2 * PHASES[name])[:-1]  # it ends at touchdown
    if name == "hop":
        own = simulate(gait.system, gait.state, 2, sample_time=0.001)
        assert np.abs(found.events[-1].v - own.events[-1].v).max() < 0.05


class TestMistakes:
    @pytest.mark.parametrize(
        ("options", "part"),
        [
            ({"sample_time": 0.0}, "sample_time is 0.0"),
            ({"sample_time": 0.001, "latency": -0.001}, "latency is -0.001"),
            ({"latency": 0.001}, "0 without a sample_time"),
        ],
    )
    def test_numbers(self, system, options, part):
        with pytest.raises(BadValue, match=part):
            simulate(system, system.guess(), **options)

    def test_hardware(self, system):
        hardware = Hardware((Actuator(motor("spear_ii_knee"), Gearbox(15.0)),) * 2)
        with pytest.raises(BadValue, match="hardware"):
            simulate(with_hardware(system, hardware), system.guess(), sample_time=0.001)
