"""The hop with a spring in series, against a closed loop written by hand and against what decouples the rotor."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spear_pin import Gait, Spring, find_gait, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.series_hopping import SeriesHoppingLaw, series_hopping
from spear_pin.hybrid.periodic import chart, return_map
from tests.hybrid.by_hand import FINEST
from tests.lagrangian import monopod

ROTOR = 0.027
GAINS = (63.25, 2.6)  # of the rotor


@pytest.fixture(scope="module")
def series_robot():
    return load("spear_ii_series", locked=["boom_x"])


@pytest.fixture(scope="module")
def gait(series_robot, hops):
    """As high as the hop with the switched spring."""
    apex = {"apex_height": float(hops.named("apex")[0].q[0])}
    return find_gait(series_hopping(series_robot, SeriesHoppingLaw(stance_torque=5.5)), ["stance_torque"], apex)


class ByHand:
    """The closed loop in absolute angles: y = (z, hip, knee, rotor, and their rates)."""

    def __init__(self, torque):
        self.torque = torque

    def hop(self, state):
        """From just after touchdown to just after the next, in the package's coordinates."""
        q, v = (np.append(part[:2], (part[2] + part[3], part[2])) for part in state)
        y = np.concatenate([q, v])
        y = self.until(lambda t, y: self.stance(y, 1.0)[0], y, [lambda t, y: 0.5 / 2.56 - t])[0]
        margins = [lambda t, y, side=side: self.stance(y, -1.0)[1] @ (side, 0.8) for side in (1.0, -1.0)]
        y, edge = self.until(lambda t, y: self.stance(y, -1.0)[0], y, margins)
        side = (1.0, -1.0)[edge]
        unloaded = [lambda t, y: self.stance(y, -1.0, side)[1][1]]
        y = self.until(lambda t, y: self.stance(y, -1.0, side)[0], y, unloaded)[0]
        y = self.until(self.flight, y, [lambda t, y: y[4]])[0]
        y = self.until(self.flight, y, [lambda t, y: y[0] - 0.318 * np.cos(y[1]) - 0.318 * np.cos(y[1] - y[2])])[0]
        D, _, J, _ = self.terms(y)
        impulse = -np.linalg.solve(J @ np.linalg.solve(D, J.T), J @ y[4:7])
        y[4:7] += np.linalg.solve(D, J.T @ impulse)
        q, v = y[:4], y[4:]
        return np.concatenate([part[[0, 1, 3]].tolist() + [part[2] - part[3]] for part in (q, v)])

    @staticmethod
    def until(acceleration, y, guards):
        """To the first fall of a guard through zero, and which guard it is."""
        for guard in guards:
            guard.terminal, guard.direction = True, -1.0
        found = solve_ivp(lambda t, y: [*y[4:], *acceleration(t, y)], (0.0, 1.0), y, events=guards, **FINEST)
        which = next(i for i, times in enumerate(found.t_events) if len(times))
        return found.y_events[which][0], which

    def terms(self, y):
        """Those of the leg without the knee's rotor."""
        D, coriolis, gravity, _, _, J, drift = monopod(("boom_z", "hip", "knee")).evaluate(*y[:3], *y[4:7])
        D = np.array(D)
        D[2, 2] -= ROTOR
        return D, np.ravel(coriolis) + np.ravel(gravity), np.array(J), np.ravel(drift)

    def torques(self, y, square):
        """Of spring and damper on the knee, and the rotor's acceleration: the motor bears the spring's."""
        spring = -48.84 * (y[2] - y[3]) - 1.3 * (y[6] - y[7])
        motor = -48.84 * (y[2] - y[3]) + GAINS[0] * (1.0 - y[3]) - GAINS[1] * y[7] + square
        return spring, (motor - spring) / ROTOR

    def stance(self, y, sign, side=None):
        """Accelerations and ground force, the toe at rest or sliding to one side."""
        D, bias, J, drift = self.terms(y)
        spring, rotor = self.torques(y, sign * self.torque)
        pushed = np.array([0.0, 0.0, spring]) - bias
        kept, force = (J, np.eye(2)) if side is None else (J[1:], np.array([[-0.8 * side], [1.0]]))
        n = len(kept)
        matrix = np.block([[D, -J.T @ force], [kept, np.zeros((n, n))]])
        solution = np.linalg.solve(matrix, np.concatenate([pushed, -drift[-n:]]))
        return [*solution[:3], rotor], force @ solution[3:]

    def flight(self, t, y):
        D, bias, _, _ = self.terms(y)
        spring, rotor = self.torques(y, 0.0)
        hip = 54.77 * (0.5 - y[1]) - 1.37 * y[5]
        return [*np.linalg.solve(D, np.array([0.0, hip, spring]) - bias), rotor]


def test_with_its_spring_held_it_is_spear_ii(robot):
    """The same masses and rotors: the mass matrix and the bias are those of the leg without the joint."""
    held = load("spear_ii_series", locked=["boom_x", "knee_spring"])
    assert held.coordinates == robot.coordinates
    rng = np.random.default_rng(0)
    for q, v in rng.uniform(-2, 2, (20, 2, 3)):
        np.testing.assert_allclose(held.mass_matrix(q), robot.mass_matrix(q), rtol=0, atol=1e-13)
        np.testing.assert_allclose(held.bias(q, v), robot.bias(q, v), rtol=0, atol=1e-12)


class TestAgainstTheClosedLoopByHand:
    @pytest.mark.parametrize("offset", [0.0, 0.01, -0.01])
    @pytest.mark.slow
    def test_one_hop(self, gait, offset):
        """On the gait and beside it."""
        begin = chart(gait.system, gait.state).state(np.full(5, offset))
        end = np.concatenate(return_map(gait.system, begin).state)
        np.testing.assert_allclose(end, ByHand(gait.parameters["stance_torque"]).hop(begin), rtol=0, atol=1e-7)

    @pytest.mark.slow
    def test_multipliers(self, gait):
        """Central differences of fourth order."""
        loop, coordinates = ByHand(gait.parameters["stance_torque"]), chart(gait.system, gait.state)

        def mapped(x):
            y = loop.hop(coordinates.state(x))
            return coordinates.coordinates((y[:4], y[4:]))

        columns = []
        for unit in 2e-3 * np.eye(5):
            near, far = (mapped(n * unit) - mapped(-n * unit) for n in (1, 2))
            columns.append((8 * near - far) / (12 * 2e-3))
        found = np.linalg.eigvals(np.transpose(columns))
        for expected in gait.multipliers[:2]:
            assert np.abs(found - expected).min() < 1e-4


class TestGait:
    @pytest.mark.slow
    def test_periodic_stable_and_as_high(self, gait, hops):
        assert gait.residual < 1e-9 and gait.stable
        run = simulate(gait.system, gait.state, 2)
        assert run.named("apex")[1].q[0] == pytest.approx(hops.named("apex")[0].q[0], abs=1e-8)
        assert np.abs(run.ledger.residual).max() < 1e-8

    def test_motor_bears_the_spring(self, gait, hops):
        """In series the motor has the spring's torque to give, in parallel it has not."""
        run = simulate(gait.system, gait.state)
        peak = np.abs(run.spring[:, 0]).max()
        assert peak > 30.0 and np.abs(run.u[:, 1]).max() > peak
        assert np.abs(hops.u[:, 1]).max() < 0.3 * peak

    def test_the_ground_does_not_strike_the_rotor(self, gait, hops):
        """The spring is between: the rotor's rate goes on, and less is lost than where the rotor is struck."""
        run = simulate(gait.system, gait.state)
        touch = run.named("touchdown")[-1]
        assert touch.v[2] == pytest.approx(touch.v_before[2], abs=1e-10)
        assert np.abs(touch.v - touch.v_before).max() > 1.0
        assert 0.0 < -run.ledger["impact"][0] < -hops.ledger["impact"][0]

    def test_stiff_spring_is_a_rigid_knee(self, series_robot, robot):
        """Dropped with its motors idle, the leg with an ever stiffer spring meets the ground like the one without."""
        q, v = np.array([0.7, 0.4, 1.0]), np.array([0.0, 1.0, -2.0])
        rigid = idle(hopping(robot), (q, v))
        errors = []
        for stiffness in (1e3, 1e4):
            spring = Spring(stiffness, 2.0 * np.sqrt(stiffness * 0.02), unilateral=False)
            touch = idle(series_hopping(series_robot, spring=spring), (np.append(q, 0.0), np.append(v, 0.0)))
            errors.append(abs(touch.q[2] + touch.q[3] - rigid.q[2]))
        assert errors[1] < 0.2 * errors[0] < 1e-3

    def test_saved_and_read(self, gait, tmp_path):
        again = Gait.load(gait.save(tmp_path / "series.json"))
        assert again.system.kind == "series_hopping" and again.system.law == gait.system.law
        np.testing.assert_array_equal(again.state[0], gait.state[0])


def idle(system, state):
    """The touchdown of a leg without motors."""
    domains = tuple(replace(domain, law=lambda *arguments: (0.0, 0.0)) for domain in system.domains)
    return simulate(replace(system, domains=domains), state).named("touchdown")[0]


class TestBadInput:
    def test_other_robot(self, robot):
        with pytest.raises(BadValue, match="^robot is .*spear_ii_series"):
            series_hopping(robot)

    @pytest.mark.parametrize("spring", [Spring(), Spring(unilateral=False, rest=0.1)])
    def test_other_spring(self, series_robot, spring):
        with pytest.raises(BadValue, match="^spring is "):
            series_hopping(series_robot, spring=spring)

    @pytest.mark.parametrize(
        ("name", "value"), [("frequency", 0.0), ("knee_gain", -1.0), ("hip_touchdown", 4.0), ("stance_torque", "8")]
    )
    def test_other_law(self, name, value):
        with pytest.raises(BadValue, match=f"^SeriesHoppingLaw.{name} is "):
            SeriesHoppingLaw(**{name: value})


@pytest.mark.slow
def test_a_flight_of_a_fifth_of_a_second_is_that_of_another_program(series_robot):
    gait = find_gait(series_hopping(series_robot), ["stance_torque"], {"flight_time": 0.2})
    assert gait.parameters["stance_torque"] == pytest.approx(5.469576, abs=1e-6)
    expected = [0.427151, -0.425620, 2.764e-5]
    assert gait.multipliers[:3].real == pytest.approx(expected, abs=1e-6) and not gait.multipliers.imag.any()
