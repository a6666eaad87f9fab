"""The push test of SPEAR-II: the check values, an integration by hand for both readings of RA, and Newton's law."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from spear_pin.errors import BadValue
from spear_pin.studies.push_test import (
    DEPTHS,
    RATIOS,
    WITH_MOTOR,
    WITHOUT_MOTOR,
    PassiveKnee,
    equilibrium,
    find_pushed_angle,
    gear_study,
    release,
    rest_at,
    spear_ii,
    swing,
)
from spear_pin.studies.push_test.motion import move
from tests.push_by_hand import Push

READINGS = (False, True)  # RA as the spring's zero, and as the angle at rest
ROTORS = {None: 0.0, 15.0: 0.027, 30.0: 1.2e-4 * 30**2, 66.0: 1.2e-4 * 66**2}
each_ratio = pytest.mark.parametrize("ratio", RATIOS)
each_reading = pytest.mark.parametrize("static_rest", READINGS)


def by_hand(ratio, static_rest, coulomb=0.0):
    """Table 4.1's 10 cm, typed again."""
    push = Push(47.12, 0.80, coulomb, 1.0, False, 0.0) if ratio is None else Push(coulomb=coulomb, rotor=ROTORS[ratio])
    return replace(push, zero=1.0 + push.at(1.0).gravity / push.stiffness) if static_rest else push


@pytest.fixture(scope="module")
def studies():
    """Rows by reading and ratio."""
    return {(rest, row.ratio): row for rest in READINGS for row in gear_study(static_rest=rest)}


class TestCheckValues:
    """With the spring's zero such that the leg rests at 1 rad."""

    def test_initial_angles(self):
        leg = spear_ii()
        knee = rest_at(leg, WITH_MOTOR, 1.0)
        angles = [find_pushed_angle(leg, knee, depth) for depth in DEPTHS]
        np.testing.assert_allclose(angles, [1.290, 1.416, 1.533], rtol=0, atol=6e-4)

    @pytest.mark.parametrize(
        ("ratio", "inertia", "frequency", "first"),
        [(None, 0.166, 2.42, 0.216), (15.0, 0.193, 2.27, 0.231), (30.0, None, 1.91, 0.272), (66.0, None, 1.20, 0.421)],
    )
    def test_of_each_gear(self, studies, ratio, inertia, frequency, first):
        row = studies[True, ratio]
        if inertia:
            assert float(spear_ii(ratio).effective_inertia(row.release.rest)) == pytest.approx(inertia, abs=5e-4)
        assert row.swing.frequency == pytest.approx(frequency, abs=6e-3)
        assert row.release.turns[0] == pytest.approx(first, abs=6e-4)

    def test_the_pin_pulls(self, studies):
        """About 11 N with motor, 36 N without."""
        assert studies[True, 15.0].release.force[:, 1].min() == pytest.approx(-11.0, abs=0.5)
        assert studies[True, None].release.force[:, 1].min() == pytest.approx(-36.0, abs=0.5)
        for ratio in (30.0, 66.0):
            assert studies[True, ratio].release.force[:, 1].min() > 0.0


class TestByHand:
    @each_reading
    @each_ratio
    def test_release(self, studies, ratio, static_rest):
        row, push = studies[static_rest, ratio], by_hand(ratio, static_rest)
        motion = row.release
        assert (row.rotor, row.ratio) == (pytest.approx(ROTORS[ratio], rel=1e-12, abs=0), ratio)
        assert row.knee.stiffness == push.stiffness and row.knee.damping == push.damping
        assert row.knee.zero == pytest.approx(push.zero, abs=1e-12)
        assert motion.rest == pytest.approx(push.rest(), abs=1e-11)
        assert motion.angle[0] == pytest.approx(push.pushed(0.10), abs=1e-11)
        np.testing.assert_array_equal(motion.t, np.arange(1501) / 1000)
        angle, rate, turns = push.swings(motion.angle[0], motion.t)
        np.testing.assert_allclose(motion.angle, angle, rtol=0, atol=1e-8)
        np.testing.assert_allclose(motion.rate, rate, rtol=0, atol=1e-7)
        np.testing.assert_allclose(motion.turns, [t for t, _ in turns], rtol=0, atol=1e-8)
        np.testing.assert_allclose(motion.extrema, [a for _, a in turns], rtol=0, atol=1e-8)
        np.testing.assert_allclose(motion.height, [push.at(a).height for a in angle], rtol=0, atol=1e-8)
        forces = [push.ground_force(a, v, push.acceleration(a, v, 0.0)) for a, v in zip(angle, rate, strict=True)]
        np.testing.assert_allclose(motion.force, forces, rtol=0, atol=1e-5)

    @each_reading
    @each_ratio
    def test_swing(self, studies, ratio, static_rest):
        """The equation of motion, linearized by differences."""
        swing, push = studies[static_rest, ratio].swing, by_hand(ratio, static_rest)
        rest, h = push.rest(), 1e-3
        near, far = (
            push.acceleration(rest + n * h, 0.0, 0.0) - push.acceleration(rest - n * h, 0.0, 0.0) for n in (1, 2)
        )
        undamped = np.sqrt(-(8 * near - far) / (12 * h))
        decay = push.damping / (2 * push.at(rest).inertia)
        assert swing.frequency == pytest.approx(undamped / (2 * np.pi), rel=1e-8)
        assert swing.damping_ratio == pytest.approx(decay / undamped, rel=1e-8)
        assert swing.damped_frequency == pytest.approx(np.sqrt(undamped**2 - decay**2) / (2 * np.pi), rel=1e-8)
        assert swing.rotor_share == pytest.approx(push.rotor / push.at(rest).inertia, rel=1e-10)

    @each_reading
    def test_lift_off(self, studies, static_rest):
        """Where the force of the ground crosses zero, or nowhere."""
        for ratio in RATIOS:
            push, motion = by_hand(ratio, static_rest), studies[static_rest, ratio].release

            def force(t, push=push, start=motion.angle[0]):
                angle, rate, _ = push.swings(start, [t])
                return push.ground_force(angle[0], rate[0], push.acceleration(angle[0], rate[0], 0.0))[1]

            assert (motion.lift_off is None) == (motion.force[:, 1].min() >= 0.0)
            if motion.lift_off is not None:
                expected = brentq(force, motion.lift_off - 0.01, motion.lift_off + 0.01)
                assert motion.lift_off == pytest.approx(expected, abs=1e-5)
        assert (studies[static_rest, 15.0].release.lift_off is None) == (not static_rest)
        assert studies[static_rest, None].release.lift_off is not None

    @pytest.mark.parametrize("coulomb", [0.5, 2.0])
    def test_dry_friction(self, coulomb):
        leg, push = spear_ii(), by_hand(15.0, False, coulomb)
        motion = release(leg, replace(WITH_MOTOR, coulomb=coulomb))
        angle, rate, turns = push.swings(motion.angle[0], motion.t)
        np.testing.assert_allclose(motion.angle, angle, rtol=0, atol=1e-8)
        assert motion.rest == pytest.approx(push.rest(), abs=1e-11)  # as without
        still = motion.t > turns[-1][0]
        if coulomb == 2.0:
            assert still.sum() > 300
            resting = push.ground_force(motion.angle[-1], 0.0, 0.0)
            np.testing.assert_allclose(motion.force[still], np.tile(resting, (still.sum(), 1)), rtol=0, atol=1e-10)
            assert resting[1] == pytest.approx(6.8 * 9.81)  # the slider bears no weight


class TestSwing:
    def test_order(self, studies):
        """A larger ratio is slower and later, and more of the inertia is the rotor's."""
        for rest in READINGS:
            rows = [studies[rest, ratio] for ratio in (None, 15.0, 30.0, 66.0)]
            for values in (
                [-row.swing.frequency for row in rows],
                [-row.swing.damped_frequency for row in rows],
                [row.swing.rotor_share for row in rows],
                [row.release.turns[0] for row in rows],
                [row.release.force[:, 1].min() for row in rows],
            ):
                assert (np.diff(values) > 0).all()
            assert rows[0].swing.rotor_share == 0.0
        assert studies[True, 66.0].swing.rotor_share == pytest.approx(0.523 / 0.689, abs=1e-3)

    @each_ratio
    def test_a_small_release(self, ratio):
        """Its turns are half a damped period apart, its decrement that of the damping ratio."""
        leg, knee = spear_ii(ratio), WITHOUT_MOTOR if ratio is None else WITH_MOTOR
        small, motion = swing(leg, knee), release(leg, knee, depth=1e-6, duration=2.5, rtol=1e-12)
        np.testing.assert_allclose(np.diff(motion.turns[:4]), 0.5 / small.damped_frequency, rtol=1e-4)
        swings = np.abs(np.concatenate([[motion.angle[0]], motion.extrema[:3]]) - motion.rest)
        decrement = np.pi * small.damping_ratio / np.sqrt(1 - small.damping_ratio**2)
        np.testing.assert_allclose(-np.diff(np.log(swings)), decrement, rtol=1e-4)

    def test_overdamped(self):
        leg, knee = spear_ii(), replace(WITH_MOTOR, damping=20.0)
        assert swing(leg, knee).damped_frequency == 0.0 and swing(leg, knee).damping_ratio > 1.0
        motion = release(leg, knee, duration=3.0)
        assert motion.turns.size == 0 and (np.diff(motion.angle) < 0).all() and motion.angle[-1] > motion.rest

    def test_damping_and_dry_friction_do_not_move_it(self):
        leg = spear_ii()
        same = {swing(leg, replace(WITH_MOTOR, damping=b, coulomb=c)).frequency for b, c in ((0, 0), (1, 0), (2, 3))}
        assert len(same) == 1


class TestEquilibrium:
    @pytest.mark.parametrize("stiffness", [15.0, 48.25, 400.0])
    @pytest.mark.parametrize("zero", [0.1, 0.5, 1.0])
    @pytest.mark.parametrize("unilateral", [False, True])
    def test_is_a_root(self, stiffness, zero, unilateral):
        leg, knee = spear_ii(), PassiveKnee(stiffness, zero=zero, unilateral=unilateral)
        rest = equilibrium(leg, knee)
        assert rest > zero and -stiffness * (rest - zero) == pytest.approx(Push().at(rest).gravity, abs=1e-10)
        assert move(leg, knee, rest, [0.5]).angle[0] == pytest.approx(rest, abs=1e-9)

    def test_next_to_where_it_tips_over(self):
        """A spring that only pulls, slack up to almost the straight leg: two roots close to each other."""
        knee = PassiveKnee(43.0, zero=0.00125, unilateral=True)
        rest = equilibrium(spear_ii(), knee)
        assert -43.0 * (rest - 0.00125) == pytest.approx(Push().at(rest).gravity, abs=1e-11) and rest > 0.00125

    @pytest.mark.parametrize(
        "knee",
        [
            PassiveKnee(stiffness=0.0),
            PassiveKnee(5.0),
            PassiveKnee(5.0, zero=2.5),
            PassiveKnee(zero=0.0, unilateral=True),
        ],
    )
    def test_does_not_hold(self, knee):
        """Too weak, or slack on one side of the straight leg."""
        for call in (equilibrium, release, swing, lambda leg, knee: find_pushed_angle(leg, knee, 0.05)):
            with pytest.raises(
                BadValue, match="^knee is PassiveKnee.* expected a spring that holds the leg at one angle"
            ):
                call(spear_ii(), knee)

    @pytest.mark.parametrize("rest", [0.6, 1.0, 1.4])
    @pytest.mark.parametrize("coulomb", [0.0, 2.0])
    def test_resting_at(self, rest, coulomb):
        leg, knee = spear_ii(), replace(WITH_MOTOR, coulomb=coulomb)
        found = rest_at(leg, knee, rest)
        assert equilibrium(leg, found) == pytest.approx(rest, abs=1e-12)
        assert replace(found, zero=knee.zero) == knee
        assert rest - found.zero == pytest.approx(-Push().at(rest).gravity / 48.25, abs=1e-11)
        assert rest_at(leg, knee, equilibrium(leg, knee)).zero == pytest.approx(knee.zero, abs=1e-12)

    def test_of_no_spring(self):
        with pytest.raises(BadValue, match="^stiffness is 0.0; expected a number > 0"):
            rest_at(spear_ii(), PassiveKnee(stiffness=0.0), 1.0)


class TestPushedAngle:
    @pytest.mark.parametrize("depth", [0.0, 0.001, *DEPTHS, 0.3])
    def test_height(self, depth):
        leg = spear_ii()
        rest, angle = equilibrium(leg, WITH_MOTOR), find_pushed_angle(leg, WITH_MOTOR, depth)
        fallen = 0.636 * (np.cos(rest / 2) - np.cos(angle / 2))
        assert fallen == pytest.approx(depth, abs=1e-12) and angle >= rest - 1e-12

    @pytest.mark.parametrize("depth", [-1e-6, 0.41, np.nan, np.inf, None])
    def test_refusals(self, depth):
        with pytest.raises(BadValue, match="^depth is .*at most 0.409 m$"):
            find_pushed_angle(spear_ii(), WITH_MOTOR, depth)


class TestRelease:
    def test_samples(self):
        leg = spear_ii()
        coarse, fine = (release(leg, WITH_MOTOR, duration=0.7, rate=rate) for rate in (50, 2000.0))
        assert coarse.t.size == 36 and fine.t.size == 1401 and fine.t[-1] == pytest.approx(0.7)
        np.testing.assert_allclose(coarse.angle, fine.angle[::40], rtol=0, atol=1e-9)
        np.testing.assert_array_equal(coarse.turns, fine.turns)

    def test_not_pushed(self):
        """It stays where it is, and its weight is on the ground."""
        motion = release(spear_ii(), WITH_MOTOR, depth=0.0)
        np.testing.assert_allclose(motion.angle, motion.rest, rtol=0, atol=1e-9)
        np.testing.assert_allclose(motion.force[:, 1], 6.8 * 9.81, rtol=0, atol=1e-6)
        assert motion.lift_off is None and motion.reason == "complete"

    def test_pulling_from_the_start(self):
        """A stiff spring, pressed far: at the release it pushes up, and pulls once it is stretched the other way."""
        motion = release(spear_ii(), PassiveKnee(stiffness=120.0, zero=0.8), depth=0.15)
        first = int(np.flatnonzero(motion.force[:, 1] < 0)[0])
        assert motion.t[first - 1] < motion.lift_off <= motion.t[first]

    def test_straight_leg(self):
        """A stiff spring throws the leg against its stop, where the motion ends."""
        motion = release(spear_ii(None), PassiveKnee(stiffness=150.0, zero=0.5, damping=0.1), depth=0.2)
        assert motion.reason == "limit" and motion.angle[-1] == pytest.approx(-0.2, abs=1e-9)
        still = motion.angle == motion.angle[-1]
        np.testing.assert_allclose(motion.force[still, 1], 6.8 * 9.81, rtol=0, atol=1e-6)

    @pytest.mark.parametrize("name", ["duration", "rate"])
    @pytest.mark.parametrize("value", [0.0, -1.0, np.nan, np.inf, None, 1e9])
    def test_refusals(self, name, value):
        with pytest.raises(BadValue, match=f"^{name} is "):
            release(spear_ii(), WITH_MOTOR, **{name: value})


class TestGearStudy:
    def test_without_motor_is_a_rotor_of_zero(self, studies):
        row = studies[False, None]
        by_rotor = release(spear_ii().with_rotor(0.0), WITHOUT_MOTOR)
        np.testing.assert_allclose(row.release.angle, by_rotor.angle, rtol=0, atol=1e-10)
        assert row.rotor == 0.0 and row.knee is WITHOUT_MOTOR and studies[False, 15.0].knee is WITH_MOTOR

    def test_own_numbers(self):
        engaged, disengaged = PassiveKnee(60.0, 0.5), PassiveKnee(55.0, 0.3)
        rows = gear_study([None, 20], depth=0.05, duration=0.4, engaged=engaged, disengaged=disengaged)
        assert [row.ratio for row in rows] == [None, 20] and [row.knee for row in rows] == [disengaged, engaged]
        assert rows[1].rotor == pytest.approx(1.2e-4 * 400)
        assert all(row.release.t[-1] == pytest.approx(0.4) for row in rows)
        alone = release(spear_ii(20), engaged, depth=0.05, duration=0.4)
        np.testing.assert_array_equal(rows[1].release.angle, alone.angle)

    def test_rest(self, studies):
        for ratio in RATIOS:
            assert studies[True, ratio].release.rest == pytest.approx(1.0, abs=1e-12)
            assert 1.2 < studies[False, ratio].release.rest < 1.3  # the weight's share is about 0.2 rad

    @pytest.mark.parametrize("ratio", [0.0, -15.0, np.nan, "15", True])
    def test_refusals(self, ratio):
        with pytest.raises(BadValue, match="^knee_ratio is "):
            gear_study([ratio])
