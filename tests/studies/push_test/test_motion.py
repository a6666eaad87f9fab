"""The release in time: against an integration by hand, the balance of energy, and finite differences."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from spear_pin import simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import Moment
from spear_pin.studies.push_test import WITH_MOTOR, PassiveKnee, simulate_release, spear_ii
from spear_pin.studies.push_test.motion import PARAMETERS, make_released, move
from tests.lagrangian import monopod
from tests.push_by_hand import Push
from tests.slow import slow_but
from tests.studies.push_test.release import LEG, START, TIMES

KNEES = {
    "viscous": {},
    "dry": {"damping": 0.4, "coulomb": 1.1},
    "only pulling": {"unilateral": True, "zero": 1.1},
    "only pulling, dry": {"unilateral": True, "zero": 1.1, "damping": 0.4, "coulomb": 1.1},
    "overdamped": {"damping": 14.0},
    "without losses": {"damping": 0.0},
}
few = settings(max_examples=20, derandomize=True, deadline=None)
each_knee = pytest.mark.parametrize("name", KNEES)


def energy(leg, knee, angle, rate):
    """Kinetic, of gravity and of the spring."""
    push = Push(knee.stiffness, knee.damping, knee.coulomb, knee.zero, knee.unilateral, leg.rotor)
    return np.array([push.energy(*state) for state in zip(angle, rate, strict=True)])


def losses(knee, motion):
    """Power of the damper and of dry friction, (n, 2)."""
    return np.column_stack([knee.damping * motion.rate**2, knee.coulomb * np.abs(motion.rate)])


class TestByHand:
    @each_knee
    def test_motion(self, name):
        knee, push = PassiveKnee(**KNEES[name]), Push(**KNEES[name])
        angle, rate, turns = push.swings(START, TIMES)
        motion = move(LEG, knee, START, TIMES)
        assert motion.reason == "complete"
        assert not knee.unilateral or motion.angle.min() < knee.zero
        np.testing.assert_allclose(motion.angle, angle, rtol=0, atol=2e-9)
        np.testing.assert_allclose(motion.rate, rate, rtol=0, atol=3e-8)
        assert len(motion.turns) == len(turns)
        np.testing.assert_allclose(motion.turns, [t for t, _ in turns], rtol=0, atol=1e-9)
        np.testing.assert_allclose(motion.extrema, [a for _, a in turns], rtol=0, atol=2e-9)
        moving = np.abs(motion.rate) > 1e-6
        expected = [push.acceleration(a, r, np.sign(r)) for a, r in zip(angle[moving], rate[moving], strict=True)]
        np.testing.assert_allclose(motion.acceleration[moving], expected, rtol=0, atol=1e-6)

    @pytest.mark.parametrize("coulomb", [0.0, 0.7, 3.0])
    @pytest.mark.parametrize("unilateral", [False, True])
    def test_turns_by_energy_alone(self, coulomb, unilateral):
        """Without viscous damping, each turn is a root, and its time an integral."""
        values = {"damping": 0.0, "coulomb": coulomb, "unilateral": unilateral, "zero": 0.9}
        turns = np.array(Push(**values).turns_by_energy(1.6, 6))
        motion = move(LEG, PassiveKnee(**values), 1.6, [turns[-1, 0] + 0.01], rtol=1e-12)
        np.testing.assert_allclose(motion.turns, turns[:, 0], rtol=0, atol=1e-10)
        np.testing.assert_allclose(motion.extrema, turns[:, 1], rtol=0, atol=2e-11)

    def test_from_where_the_spring_is_slack(self):
        values = {"unilateral": True, "zero": 1.1, "coulomb": 0.5}
        angle, _, _ = Push(**values).swings(0.9, TIMES)
        np.testing.assert_allclose(move(LEG, PassiveKnee(**values), 0.9, TIMES).angle, angle, rtol=0, atol=2e-9)

    @pytest.mark.parametrize("rotor", [0.0, 0.52272])
    def test_other_rotors(self, rotor):
        angle, _, _ = Push(rotor=rotor, coulomb=0.5).swings(START, TIMES)
        motion = move(LEG.with_rotor(rotor), PassiveKnee(coulomb=0.5), START, TIMES)
        np.testing.assert_allclose(motion.angle, angle, rtol=0, atol=2e-9)

    def test_all_coordinates_integrated(self):
        """Height, hip and knee with the pin's force, no projection: the toe stays, and the knee moves alike."""
        lagrangian, knee = monopod(("boom_z", "hip", "knee")), PassiveKnee()

        def flow(t, y):
            D, coriolis, gravity, _, _, J, drift = (np.array(part) for part in lagrangian.evaluate(*y))
            torque = [0.0, 0.0, -knee.stiffness * (y[2] - knee.zero) - knee.damping * y[5]]
            matrix = np.block([[D, -J.T], [J, np.zeros((2, 2))]])
            right = np.concatenate([torque - coriolis.ravel() - gravity.ravel(), -drift.ravel()])
            return [*y[3:], *np.linalg.solve(matrix, right)[:3]]

        start = [0.636 * np.cos(START / 2), START / 2, START, 0.0, 0.0, 0.0]
        times = TIMES[:81]
        y = solve_ivp(flow, (0.0, times[-1]), start, "DOP853", times, rtol=1e-11, atol=1e-12).y
        motion = move(LEG, knee, START, times)
        np.testing.assert_allclose(motion.angle, y[2], rtol=0, atol=1e-8)
        np.testing.assert_allclose(LEG.configuration(motion.angle), y[:3], rtol=0, atol=1e-8)

    @each_knee
    def test_error_falls_with_the_tolerance(self, name):
        knee = PassiveKnee(**KNEES[name])
        best = move(LEG, knee, START, TIMES, rtol=1e-13).angle
        for rtol in (1e-6, 1e-8, 1e-10):
            np.testing.assert_allclose(move(LEG, knee, START, TIMES, rtol=rtol).angle, best, rtol=0, atol=10 * rtol)


class TestEnergy:
    @each_knee
    def test_falls_by_what_damper_and_friction_take(self, name):
        """By Gauss and Legendre's rule between one turn and the next."""
        knee = PassiveKnee(**KNEES[name])
        turns = move(LEG, knee, START, TIMES).turns
        nodes, weights = np.polynomial.legendre.leggauss(40)
        edges = np.concatenate([[0.0], turns])
        if knee.unilateral:  # the spring's slack begins and ends in between: a finer mesh
            edges = np.unique(np.concatenate([edges, np.linspace(0.0, edges[-1], 200)]))
        if edges.size == 1:
            edges = np.linspace(0.0, 1.0, 4)
        half = 0.5 * np.diff(edges)[:, None]
        times = np.unique(np.concatenate([(edges[:-1, None] + half * (1 + nodes)).ravel(), edges]))
        motion = move(LEG, knee, START, times, rtol=1e-12)
        inner = ~np.isin(times, edges)
        taken = losses(knee, motion)[inner].sum(axis=1).reshape(-1, 40) @ weights * half.ravel()
        stored = energy(LEG, knee, motion.angle[~inner], motion.rate[~inner])
        np.testing.assert_allclose(-np.diff(stored), taken, rtol=0, atol=1e-8)

    @pytest.mark.slow
    @few
    @given(
        start=st.floats(0.0, 2.6),
        stiffness=st.floats(15.0, 120.0),
        damping=st.floats(0.0, 5.0),
        coulomb=st.sampled_from([0.0, 0.01, 1.0, 6.0]),
        unilateral=st.booleans(),
        rotor=st.floats(0.0, 0.6),
    )
    def test_never_grows(self, start, stiffness, damping, coulomb, unilateral, rotor):
        knee = PassiveKnee(stiffness, damping, coulomb, 1.0, unilateral)
        leg = LEG.with_rotor(rotor)
        motion = move(leg, knee, start, TIMES[::4], rtol=1e-11)
        assert motion.reason in ("complete", "limit")
        free = (motion.acceleration != 0.0) | (motion.rate != 0.0)
        stored = energy(leg, knee, motion.angle[free], motion.rate[free])
        assert (np.diff(stored) < 1e-7).all()  # of some 50 J
        assert (np.diff(motion.turns) > 0).all()


class TestSystem:
    """The release as a hybrid system, run by the engine that runs all others."""

    KNEE = PassiveKnee(unilateral=True, zero=1.1, damping=0.1, coulomb=2.5, braking=0.2, braking_from=2.0)

    @staticmethod
    def simulated(system):
        q = LEG.configuration(START)
        return simulate(system, Moment(q, np.zeros(3), "pushed", {}), rtol=1e-10, progress=False)

    def test_is_what_moves(self):
        """The robot's coordinates and its toe's force, against the projection on the knee's angle."""
        trajectory = self.simulated(make_released(LEG, self.KNEE, TIMES[-1]))
        assert trajectory.reason == "stuck"
        names = {event.name for event in trajectory.events}
        assert {"release", "spring_switch", "brake_switch", "turn", "rest:knee", "rest"} == names
        within = trajectory.domain != "pushed"
        angle, rate, acceleration = (part[within, 2] for part in (trajectory.q, trajectory.v, trajectory.a))
        np.testing.assert_allclose(trajectory.q[within], LEG.configuration(angle).T, rtol=0, atol=1e-9)
        force = LEG.ground_force(angle, rate, acceleration).T
        np.testing.assert_allclose(trajectory.force[within, 0], force, rtol=0, atol=1e-6)
        times = np.unique(trajectory.t[within])
        motion = move(LEG, self.KNEE, START, times)
        here = np.searchsorted(times, trajectory.t[within])
        np.testing.assert_allclose(angle, motion.angle[here], rtol=0, atol=1e-9)
        np.testing.assert_allclose(rate, motion.rate[here], rtol=0, atol=1e-8)

    def test_motor_brakes_from_its_threshold(self):
        events = self.simulated(make_released(LEG, self.KNEE, TIMES[-1])).named("brake_switch")
        assert len(events) > 1
        np.testing.assert_allclose([abs(event.v[2]) for event in events], 2.0, rtol=0, atol=1e-7)

    def test_with_other_numbers(self):
        """As with any system, by their names."""
        values = {"stiffness": 60.0, "damping": 0.7, "coulomb": 0.3, "zero": 1.2, "braking": 0.3}
        ends = [
            self.simulated(system).q[-1]
            for system in (
                with_parameters(make_released(LEG, self.KNEE, 0.5), values),
                make_released(LEG, replace(self.KNEE, **values), 0.5),
                make_released(LEG, self.KNEE, 0.5),
            )
        ]
        np.testing.assert_array_equal(ends[0], ends[1])
        assert abs(ends[0][2] - ends[2][2]) > 1e-3

    def test_each_turn_counts_once(self):
        """A coarse integration may come to rest a moment later than it seemed."""
        knee = PassiveKnee(60.912, 2.7545, 1.8767, 0.70047, braking=1.5271, braking_from=3.0)
        for rtol in (1e-4, 1e-6, 1e-8, 1e-10):
            assert len(move(LEG, knee, 2.0436, TIMES, rtol=rtol).turns) == 2


class TestSensitivities:
    """Against five-point differences of motions at a finer tolerance."""

    STEPS = {"stiffness": 0.05, "damping": 2e-3, "coulomb": 2e-3, "zero": 5e-4, "rotor": 1e-4, "initial_angle": 5e-4}
    TIMES = np.linspace(0.013, 1.0, 40)

    def value(self, knee, name, offset):
        """θ with one parameter moved."""
        leg, start = LEG, START
        if name == "rotor":
            leg = LEG.with_rotor(LEG.rotor + offset)
        elif name == "initial_angle":
            start += offset
        else:
            knee = replace(knee, **{name: getattr(knee, name) + offset})
        return move(leg, knee, start, self.TIMES, rtol=1e-13).angle

    @pytest.mark.slow
    @pytest.mark.parametrize("name", [name for name in KNEES if name != "without losses"])
    def test_by_differences(self, name):
        knee = PassiveKnee(**KNEES[name])
        asked = [p for p in PARAMETERS if p != "coulomb" or knee.coulomb]
        motion = move(LEG, knee, START, self.TIMES, wrt=asked, rtol=1e-12)
        for column, parameter in zip(motion.sensitivity.T, asked, strict=True):
            h = self.STEPS[parameter]
            near, far = (self.value(knee, parameter, n * h) - self.value(knee, parameter, -n * h) for n in (1, 2))
            expected = (8 * near - far) / (12 * h)
            np.testing.assert_allclose(column, expected, rtol=0, atol=2e-7 * np.abs(expected).max(), err_msg=parameter)

    def test_dry_friction_from_none(self):
        """There is friction on one side of zero only."""
        knee, h = PassiveKnee(), 1e-3
        column = move(LEG, knee, START, self.TIMES, wrt=["coulomb"], rtol=1e-12).sensitivity[:, 0]
        values = [self.value(knee, "coulomb", n * h) for n in range(5)]
        expected = np.array([-25, 48, -36, 16, -3]) @ values / (12 * h)
        np.testing.assert_allclose(column, expected, rtol=0, atol=1e-6 * np.abs(expected).max())

    @pytest.mark.slow
    def test_where_the_knee_is_held(self):
        """It stays where it came to rest, and so does the derivative."""
        knee = PassiveKnee(damping=0.4, coulomb=3.0)
        asked = list(PARAMETERS)
        motion = move(LEG, knee, START, TIMES, wrt=asked, rtol=1e-12)
        held = motion.turns[-1] < TIMES
        assert held.sum() > 30
        for column, parameter in zip(motion.sensitivity[held].T, asked, strict=True):
            assert (column == column[0]).all()
            h = self.STEPS[parameter]
            near, far = ((self.value(knee, parameter, n * h) - self.value(knee, parameter, -n * h))[-1] for n in (1, 2))
            assert column[0] == pytest.approx((8 * near - far) / (12 * h), rel=1e-6, abs=1e-7)

    def test_order_and_motion(self):
        """The columns are as asked for; the motion is the same."""
        knee, some = PassiveKnee(**KNEES["dry"]), ["zero", "initial_angle", "stiffness"]
        motion, plain = move(LEG, knee, START, TIMES, wrt=some), move(LEG, knee, START, TIMES)
        assert motion.sensitivity.shape == (TIMES.size, 3) and plain.sensitivity.shape == (TIMES.size, 0)
        np.testing.assert_allclose(motion.angle, plain.angle, rtol=0, atol=1e-8)
        for i, name in enumerate(some):
            alone = move(LEG, knee, START, TIMES, wrt=[name]).sensitivity[:, 0]
            np.testing.assert_allclose(motion.sensitivity[:, i], alone, rtol=0, atol=1e-7 * np.abs(alone).max())
        np.testing.assert_array_equal(motion.sensitivity[0], [0.0, 1.0, 0.0])


class TestDryFriction:
    def test_decrement(self):
        """With a very stiff spring the knee is a mass and a spring: each half swing loses 2 τ_c / k."""
        stiffness, coulomb, zero = 1e6, 50.0, 1.3
        knee = PassiveKnee(stiffness, 0.0, coulomb, zero)
        motion = move(LEG, knee, zero + 6.3e-4, [0.06], rtol=1e-12)
        centre = zero - float(LEG.gravity(zero)) / stiffness  # both ways about where the weight is borne
        swings = np.abs(np.concatenate([[zero + 6.3e-4], motion.extrema]) - centre)
        np.testing.assert_allclose(-np.diff(swings), 2 * coulomb / stiffness, rtol=1e-3)
        assert swings[-1] <= coulomb / stiffness < swings[-2] and len(motion.turns) == 6
        half = np.pi * np.sqrt(float(LEG.effective_inertia(zero)) / stiffness)
        np.testing.assert_allclose(np.diff(motion.turns), half, rtol=1e-3)

    @pytest.mark.parametrize("coulomb", slow_but([0.1, 0.5, 1.5, 4.0], 1.5, 4.0))
    @pytest.mark.parametrize("damping", [0.0, 1.03])
    def test_comes_to_rest_within_the_dead_band(self, coulomb, damping):
        knee = PassiveKnee(damping=damping, coulomb=coulomb)
        motion = move(LEG, knee, START, np.linspace(0, 60, 200), rtol=1e-9)
        torque = float(knee.spring_torque(motion.angle[-1]) - LEG.gravity(motion.angle[-1]))
        assert motion.reason == "complete" and motion.turns[-1] < 59
        assert abs(torque) <= coulomb
        assert motion.angle[-1] == pytest.approx(motion.extrema[-1], abs=1e-14)
        before = np.array([knee.spring_torque(a) - LEG.gravity(a) for a in motion.extrema[:-1]])
        assert (np.abs(before) > coulomb).all()
        still = motion.turns[-1] < np.linspace(0, 60, 200)
        assert not motion.rate[still].any() and not motion.acceleration[still].any()

    @pytest.mark.parametrize(("factor", "held"), [(1.01, True), (0.99, False)])
    @pytest.mark.parametrize("start", [0.9, 1.7])
    def test_at_the_start(self, start, factor, held):
        """It is let go where friction can, or just cannot, hold it."""
        net = abs(float(PassiveKnee().spring_torque(start) - LEG.gravity(start)))
        motion = move(LEG, PassiveKnee(coulomb=factor * net), start, TIMES, wrt=["initial_angle", "zero"])
        assert motion.reason == "complete"
        assert (motion.angle[0], motion.rate[0]) == (start, 0.0)
        if held:
            assert (motion.angle == start).all() and not motion.rate.any() and not motion.acceleration.any()
            assert motion.turns.size == 0
            np.testing.assert_array_equal(motion.sensitivity, np.tile([1.0, 0.0], (TIMES.size, 1)))
        else:
            assert abs(motion.angle[-1] - start) > 1e-3
            assert (motion.angle[-1] - start) * (1.24 - start) > 0

    def test_none_is_the_limit_of_little(self):
        little, none = (move(LEG, PassiveKnee(coulomb=c), START, TIMES).angle for c in (1e-7, 0.0))
        np.testing.assert_allclose(little, none, rtol=0, atol=1e-7)


class TestTrajectory:
    @pytest.mark.parametrize("knee", [WITH_MOTOR, replace(WITH_MOTOR, coulomb=0.5, unilateral=True)], ids=["", "dry"])
    def test_is_the_motion(self, knee):
        leg = spear_ii()
        motion = simulate_release(leg, knee, 1.7, 1.0)
        swinging = np.r_[True, np.diff(motion.t) > 0]
        wanted = move(leg, knee, 1.7, motion.t[swinging])
        np.testing.assert_allclose(motion.q[swinging, 2], wanted.angle, rtol=0, atol=1e-8)
        np.testing.assert_allclose(motion.v[swinging, 2], wanted.rate, rtol=0, atol=1e-7)
        force = leg.ground_force(motion.q[:, 2], motion.v[:, 2], motion.a[:, 2]).T
        np.testing.assert_allclose(motion.force[:, 0], force, rtol=0, atol=1e-6)
        assert motion.reason == "complete" and motion.ledger.residual.shape == (0,)

    @pytest.mark.parametrize("duration", [0.0, -1.0, np.nan, 1e9])
    def test_refuses_durations(self, duration):
        with pytest.raises(BadValue, match="duration"):
            simulate_release(spear_ii(), WITH_MOTOR, 1.7, duration)

    def test_refuses_angles(self):
        with pytest.raises(BadValue, match="initial_angle"):
            simulate_release(spear_ii(), WITH_MOTOR, 9.0)
