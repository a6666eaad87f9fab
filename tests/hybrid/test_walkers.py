"""Textbook walkers: published fixed points and multipliers, closed forms, and other integrations by SciPy."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from spear_pin import continue_gait, find_gait, simulate
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import displacement, multipliers, return_map
from tests.walkers import HOPPERS, LONG, SHORT, example, forward_differences, hopper

FINE = {"method": "DOP853", "rtol": 1e-13, "atol": 1e-14}


def crossing(value, direction):
    """An event of SciPy."""

    def event(t, y):
        return value(y)

    event.terminal, event.direction = True, direction
    return event


def until(slope, y, value, direction, skip=0.0):
    """The state where a value crosses zero, by SciPy; crossings before a time do not count."""
    if skip:
        y = solve_ivp(slope, (0.0, skip), y, **FINE).y[:, -1]
    return solve_ivp(slope, (0.0, 20.0), y, events=crossing(value, direction), **FINE).y[:, -1]


def central(step, state, h=1e-5):
    return np.column_stack([(step(state + h * e) - step(state - h * e)) / (2 * h) for e in np.eye(len(state))])


def walk(state, incline=0.009):
    """A step of the simplest walker in the form of the paper, from the stance leg's angle and rate."""

    def slope(t, y):
        theta, phi, rate, swing = y
        lean = theta - incline
        return [rate, swing, math.sin(lean), math.sin(lean) + math.sin(phi) * (rate**2 - math.cos(lean))]

    theta, rate = state
    y = [theta, 2 * theta, rate, (1 - math.cos(2 * theta)) * rate]
    y = until(slope, y, lambda y: y[1] - 2 * y[0], -1, skip=0.5)
    y = until(slope, y, lambda y: y[1] - 2 * y[0], 1, skip=0.3)
    return np.array([-y[0], math.cos(2 * y[0]) * y[2]])


@pytest.fixture(scope="module", params=[LONG, pytest.param(SHORT, marks=pytest.mark.slow)], ids=["long", "short"])
def found(request):
    """A gait of the walker, its published state and multipliers."""
    state, published = request.param
    return find_gait(example().simplest_walker(state)), np.array(state), published


class TestSimplestWalker:
    def test_gaits_are_the_published_ones(self, found):
        gait, (angle, rate), published = found
        (q, v) = gait.state
        np.testing.assert_allclose([q[0], v[0]], [angle, rate], rtol=0, atol=1e-9)
        np.testing.assert_allclose([q[1], v[1]], [2 * angle, (1 - math.cos(2 * angle)) * rate], rtol=0, atol=1e-9)
        assert gait.stable == (abs(published[0]) < 1)

    def test_multipliers_are_those_of_another_integration(self, found):
        gait, state, _ = found
        expected = np.linalg.eigvals(central(walk, state))
        np.testing.assert_allclose(np.sort_complex(gait.multipliers[:2]), np.sort_complex(expected), atol=5e-6)
        assert np.abs(gait.multipliers[2:]).max() < 1e-9, "heelstrike leaves a state of two numbers"

    def test_published_multipliers_are_forward_differences(self, found):
        """By steps of 1e-5, and so they differ from the exact ones by 1e-3 to 4e-3."""
        gait, state, published = found
        differences = forward_differences(gait.system, state)
        digits = 1e-6 if np.iscomplex(published[0]) else 6e-4
        np.testing.assert_allclose(np.sort_complex(differences), np.sort_complex(published), rtol=0, atol=digits)
        assert 5e-4 < abs(gait.multipliers[0] - published[0]) < 5e-3

    @pytest.mark.extra("heyoka")
    @pytest.mark.slow
    def test_its_branch_is_stable_up_to_a_slope_of_15_mrad(self):
        """As published, where the period doubles; steps grow with the cube root of the slope."""
        walker = find_gait(example().simplest_walker())
        branch = continue_gait(walker, "incline", (1e-4, 0.02))
        (flip,) = branch.flips
        assert not branch.folds and not branch.neimark_sacker
        np.testing.assert_array_equal(branch.stable, branch.values < flip.parameter)
        at = np.array([branch.q[flip.index, 0], branch.v[flip.index, 0]])
        multipliers = np.linalg.eigvals(central(lambda state: walk(state, flip.parameter), at))
        assert np.abs(multipliers + 1.0).min() < 1e-5 and abs(flip.parameter - 0.015) < 5e-4
        steps, slopes = np.abs(branch.q[:, 0]), branch.values
        slowest = slopes.argsort()[:2]
        growth = np.diff(np.log(steps[slowest])) / np.diff(np.log(slopes[slowest]))
        assert growth == pytest.approx(1 / 3, abs=2e-3)

    @pytest.mark.extra("heyoka")
    def test_lanes_walk_as_the_reference_engine_does(self):
        system = example().simplest_walker()
        q, v = system.guess()
        factors = np.linspace(0.999, 1.001, 20)[:, None]
        lanes = simulate_many(system, q * factors, v * factors, cycles=2)
        assert set(lanes.reason) == {"complete"} and not lanes.repeated.any()
        for i in (0, 13):
            last = simulate(system, (q * factors[i], v * factors[i]), cycles=2).events[-1]
            np.testing.assert_allclose(np.concatenate([lanes.q[i], lanes.v[i]]), [*last.q, *last.v], atol=1e-9)

    def test_its_ledger_closes_with_the_work_of_heelstrikes(self):
        system = example().simplest_walker()
        walked = simulate(system, system.guess(), cycles=3)
        strikes = walked.named("strike")
        loss = [0.5 * (event.v @ event.v - event.v_before @ event.v_before) for event in strikes]
        np.testing.assert_allclose(walked.ledger["impact"], loss, atol=1e-15)
        assert np.abs(walked.ledger.residual).max() < 1e-10


@pytest.fixture(scope="module")
def gait():
    return find_gait(example().rimless_wheel())


class TestRimlessWheel:
    INCLINE, HALF = 0.08, math.pi / 8

    def test_rolls_as_in_closed_form(self, gait):
        """The rate after a strike is cot 2α √(4 sin α sin γ), each strike keeps cos 2α of the rate."""
        kept = math.cos(2 * self.HALF)
        rate = kept * math.sqrt(4 * math.sin(self.HALF) * math.sin(self.INCLINE) / (1 - kept**2))
        assert gait.state[0][0] == pytest.approx(self.INCLINE - self.HALF, abs=1e-12)
        assert gait.state[1][0] == pytest.approx(rate, abs=1e-10)
        np.testing.assert_allclose(gait.multipliers, [kept**2, 0.0], atol=1e-10)
        begin, end = self.INCLINE - self.HALF, self.INCLINE + self.HALF
        period = quad(
            lambda angle: (rate**2 + 2 * (math.cos(begin) - math.cos(angle))) ** -0.5, begin, end, epsabs=1e-13
        )
        assert gait.period == pytest.approx(period[0], abs=1e-9)

    def test_derivatives_pass_through_its_jump(self, gait):
        """Of cos² 2α, and of the rate before a strike, which is √(4 sin α sin γ) / sin 2α."""
        table = gait.sensitivity(["half", "incline"])
        sines = math.sin(self.HALF), math.sin(self.INCLINE)
        rate = math.sqrt(4 * sines[0] * sines[1]) / math.sin(2 * self.HALF)
        by_half = rate * (0.5 / math.tan(self.HALF) - 2 / math.tan(2 * self.HALF))
        by_incline = rate * 0.5 / math.tan(self.INCLINE)
        np.testing.assert_allclose(table.derivatives["multiplier_1"], [-2 * math.sin(4 * self.HALF), 0.0], atol=1e-8)
        np.testing.assert_allclose(table.derivatives["angle_rate_at_strike"], [by_half, by_incline], atol=1e-9)

    def test_too_slow_it_falls_back_and_strikes_never(self):
        system = example().rimless_wheel()
        q, _ = system.guess()
        rolled = simulate(replace(system, phase_limit=20.0), (q, np.array([0.1])), cycles=1)
        assert rolled.reason == "no_event" and not rolled.events


def bounce(law):
    """A step of the runner from apex to apex, by the height alone, in polar coordinates during stance."""
    energy = 0.5 * law.speed**2 + law.gravity * law.height

    def slope(t, y):
        length, angle, extending, turning = y  # angle from vertical
        push = law.stiffness / law.mass * (law.length - length)
        return [
            extending,
            turning,
            length * turning**2 + push - law.gravity * math.cos(angle),
            (law.gravity * math.sin(angle) - 2 * extending * turning) / length,
        ]

    def step(height):
        z = law.length * math.sin(law.attack)
        vx, vz = math.sqrt(2 * (energy - law.gravity * height[0])), -math.sqrt(2 * law.gravity * (height[0] - z))
        a = law.attack - math.pi / 2
        along, across = np.array([math.sin(a), math.cos(a)]), np.array([math.cos(a), -math.sin(a)])
        y = [law.length, a, along @ [vx, vz], across @ [vx, vz] / law.length]
        _, a, extending, turning = until(slope, y, lambda y: y[0] - law.length, 1, skip=0.01)
        vz = extending * math.cos(a) - law.length * turning * math.sin(a)
        return np.array([law.length * math.cos(a) + vz**2 / (2 * law.gravity)])

    return step


class TestRunner:
    @pytest.mark.parametrize("name", HOPPERS)
    def test_gaits_of_another_program_are_fixed_points(self, name):
        system = hopper(name)
        after = return_map(system, system.guess()).state
        np.testing.assert_allclose(displacement(system, system.guess(), after), 0.0, atol=1e-11)
        height = np.array([system.law.height])
        np.testing.assert_allclose(bounce(system.law)(height), height, rtol=0, atol=1e-11)
        expected = float(central(bounce(system.law), height)[0, 0])
        np.testing.assert_allclose(multipliers(system, system.guess()), [expected, 1.0, 0.0], atol=1e-6)
        assert expected > 1, "as that program says"

    def test_a_human_runs_stably_at_68_degrees(self):
        """With 80 kg, 20 kN/m and 5 m/s at 1 m, as in another integration: no digits of this are published."""
        system = example().runner()
        ran = simulate(system, system.guess(), cycles=25)
        last, step = ran.named("apex")[-1], bounce(system.law)
        height = np.array([system.law.height])
        for _ in range(25):
            height = step(height)
        assert last.q[1] == pytest.approx(height[0], abs=1e-9)
        energy = 0.5 * last.v[0] ** 2 + 9.81 * last.q[1]
        assert energy == pytest.approx(12.5 + 9.81, abs=1e-9)
        found = find_gait(system, guess=(last.q, last.v)).multipliers
        np.testing.assert_allclose(found, [1.0, central(step, height)[0, 0], 0.0], atol=1e-6)
        assert abs(found[1]) < 0.2

    def test_a_vertical_hop_lasts_as_in_closed_form(self):
        """In stance it swings about the length where the spring bears its weight."""
        law = example().Human(attack=math.pi / 2, speed=0.0, height=1.1)
        hop = return_map(example().runner(law), example().runner(law).guess())
        fall, omega = math.sqrt(2 * 0.1 / 9.81), math.sqrt(20e3 / 80.0)
        stance = 2 / omega * (math.pi - math.atan(9.81 * fall * omega / 9.81))
        expected = {"sink": fall, "stance": stance, "rise": fall}
        assert hop.durations == pytest.approx(expected, abs=1e-9)

    def test_other_numbers_make_another_runner(self):
        steeper = with_parameters(example().runner(), {"attack": math.radians(70.0)})
        assert steeper.law.attack == math.radians(70.0) and steeper.guess()[1][0] == 5.0
