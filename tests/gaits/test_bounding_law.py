"""The bounding law: what the motors give beside the springs, and the parameters and robots that it refuses."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Spring, bounding, load, sagittal, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import legs_of
from spear_pin.gaits.virtual_constraints import dot, jet, value
from spear_pin.model.loading import ROBOTS
from tests.gaits.bounding_gaits import LEGS, NAMES, each_gait, gait, trajectory
from tests.slow import slow_but


def springs(name, stiffness):
    """The same gait with other springs in the knees, without damping."""
    system = gait(name).system
    return system.build(system.robot, system.law, Spring(stiffness=stiffness, damping=0.0), system.contact)


@each_gait
class TestVirtualSpring:
    """The motor gives what the physical spring does not, so the motion does not depend on that spring."""

    @pytest.mark.parametrize("share", slow_but([0.0, 0.5, 1.0], 0.5))
    def test_motion_is_the_same(self, name, share):
        here = trajectory(name)
        there = simulate(springs(name, share * gait(name).system.law.virtual_stiffness), gait(name).state, 1, 1e-11)
        kinds = ("touchdown", "lift_off")
        for one, other in zip(
            [event for event in here.events if event.name.endswith(kinds)],
            [event for event in there.events if event.name.endswith(kinds)],
            strict=True,
        ):
            assert one.name == other.name and one.time == pytest.approx(other.time, abs=1e-8)
            np.testing.assert_allclose(one.q, other.q, rtol=0, atol=1e-7)
            np.testing.assert_allclose(one.v, other.v, rtol=0, atol=1e-6)
            np.testing.assert_allclose(one.impulse, other.impulse, rtol=0, atol=1e-6)
        for leg, (i, _, _, _) in LEGS.items():
            extremes = [(motion.tau[motion.phase == f"{leg}_stance", 2 * i + 1][[0, -1]]) for motion in (here, there)]
            np.testing.assert_allclose(*extremes, rtol=0, atol=1e-5)

    @pytest.mark.slow
    def test_motor_torque_is_flat_if_it_is_all_physical(self, name):
        law = gait(name).system.law
        motion = simulate(springs(name, law.virtual_stiffness), gait(name).state, 1, 1e-11)
        rest = {"posterior": gait(name).state[0][4], "anterior": motion.named("anterior_touchdown")[0].q[6]}
        bound = law.virtual_stiffness * abs(law.knee_touchdown - law.knee_rest)
        for leg, (i, _, knee, side) in LEGS.items():
            stance = motion.phase == f"{leg}_stance"
            torque, compressed = motion.u[stance, 2 * i + 1], side * (motion.q[stance, knee] - rest[leg]) >= 0.0
            assert compressed.sum() > 10
            assert np.ptp(torque[compressed]) < 1e-6
            if law.lift_off == "knee":
                assert np.ptp(torque) <= bound + 1e-5
            total = motion.tau[stance, 2 * i + 1]
            assert np.ptp(total) > 1.0  # which is the spring's

    def test_without_a_spring_the_motor_gives_all(self, name):
        motion = simulate(springs(name, 0.0), gait(name).state, 1, 1e-9)
        np.testing.assert_array_equal(motion.u, motion.tau)
        assert (motion.spring == 0.0).all()


class TestLaw:
    @pytest.mark.parametrize(
        ("field", "value"),
        [
            ("virtual_stiffness", -1.0),
            ("epsilon", 0.0),
            ("epsilon", -0.01),
            ("knee_rest", 0.0),
            ("knee_rest", math.pi),
            ("knee_touchdown", -0.7),
            ("posterior_stance_span", 0.3),
            ("anterior_stance_span", 0.0),
            ("flight_1_span", 0.0),
            ("flight_2_span", -0.1),
            ("posterior_hip_torque", math.nan),
            ("anterior_knee_torque", math.inf),
            ("posterior_leg_touchdown", None),
            ("lift_off", "hand"),
            ("lift_off", ""),
            ("lift_off", 3),
        ],
    )
    def test_bad_value(self, field, value):
        with pytest.raises(BadValue) as caught:
            replace(gait(NAMES[0]).system.law, **{field: value})
        assert caught.value.name == f"BoundingLaw.{field}"

    @pytest.mark.parametrize("source", ["spear_ii", "q_spear_full"])
    def test_other_robots(self, source):
        with pytest.raises(BadValue, match="^robot is "):
            bounding(load(source), gait(NAMES[0]).system.law)

    @pytest.mark.parametrize("options", [{"locked": ["pitch"]}, {"toes": ["anterior_toe", "posterior_toe"]}])
    def test_other_models_of_the_robot(self, options):
        with pytest.raises(BadValue, match="^robot is "):
            bounding(load("q_spear", **options), gait(NAMES[0]).system.law)

    def test_no_guess_without_a_nominal_state(self):
        law = replace(gait(NAMES[0]).system.law, nominal=())
        with pytest.raises(BadValue, match="BoundingLaw.nominal"):
            bounding(load("q_spear"), law).guess()


class TestOtherLegs:
    def edited(self, tmp_path, joint, old, new):
        head, mark, tail = ROBOTS["q_spear"].path.read_text(encoding="utf-8").partition(f'<joint name="{joint}"')
        path = tmp_path / "other.urdf"
        path.write_text(head + mark + re.sub(old, new, tail, count=1), encoding="utf-8")
        return load(path, toes=["posterior_toe", "anterior_toe"])

    def test_as_they_are(self, tmp_path):
        for robot in (self.edited(tmp_path, "pitch", "", ""), sagittal(load("q_spear_full"))):
            assert [leg.side for leg in legs_of(robot)] == [1, -1]

    def test_a_knee_that_bends_the_other_way(self, tmp_path):
        robot = self.edited(tmp_path, "anterior_knee", 'lower="[^"]*" upper="[^"]*"', 'lower="0" upper="2.5"')
        assert [leg.side for leg in legs_of(robot)] == [1, 1]

    @pytest.mark.parametrize("shank", [0.25, 0.318, 0.4])
    def test_the_leg_angle_is_that_of_the_line_from_hip_to_toe(self, tmp_path, shank):
        robot = self.edited(tmp_path, "posterior_toe_tip", "-0.318", str(-shank))
        leg = legs_of(robot)[0]
        rng = np.random.default_rng(0)
        for _ in range(20):
            q, v, a = rng.uniform(-1.2, 1.2, 7), rng.normal(size=7), rng.normal(size=7)

            def angle(t, q=q, v=v, a=a):
                now = q + t * v + 0.5 * t * t * a
                x, z = robot.toe_position(now, "posterior_toe") - robot.frame_position(now, "posterior_hip")
                return math.atan2(x, -z)

            assert value(leg.angle, q) == pytest.approx(angle(0.0), abs=1e-12)
            h = 1e-4
            rate = (angle(h) - angle(-h)) / (2 * h)
            second = (angle(h) - 2 * angle(0.0) + angle(-h)) / h**2
            found = jet(leg.angle, q, v)
            assert (found.rate, dot(found.row, v)) == pytest.approx((rate, rate), abs=1e-6)
            assert dot(found.row, a) + found.drift == pytest.approx(second, abs=1e-5)

    def test_a_joint_that_is_turned_another_way(self, tmp_path):
        robot = self.edited(tmp_path, "posterior_hip", 'axis xyz="[^"]*"', 'axis xyz="0 1 0"')
        with pytest.raises(BadValue, match="leg is 'posterior'; expected hip and knee with SPEAR-II's signs"):
            legs_of(robot)
