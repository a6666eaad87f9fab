"""Footfalls as data, and what is asked of them."""

import numpy as np
import pytest

from spear_pin import Spring, load
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.footfalls.limbs import find_limb_angles, hip_heights, legs_of
from spear_pin.gaits.footfalls.obstacles import remedy
from spear_pin.gaits.footfalls.plan import Plan
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS, LEGS, Footfalls
from spear_pin.model.scale import scale_in_space
from tests.gaits.similar import similar

PAIR = LEGS[:2]


@pytest.fixture(scope="module")
def robot():
    return load("q_spear_full", base="chain")


class TestFootfalls:
    def test_of_a_mirrored_trot(self):
        trot = FOOTFALLS["trot"]
        assert trot.whole[2:] == (("posterior_right", "anterior_left"), ())
        assert trot.unfolded.phases == trot.whole and not trot.unfolded.mirrored
        assert trot.finer(2).intervals == tuple(2 * n for n in trot.intervals)
        assert trot.landings("anterior_left") == [2]

    @pytest.mark.parametrize("name", FOOTFALLS)
    def test_each_leg_lands_once_a_stride(self, name):
        assert all(len(FOOTFALLS[name].landings(leg)) == 1 for leg in LEGS)

    @pytest.mark.parametrize(
        ("phases", "intervals", "named"),
        [
            ((("tail",), ()), (2, 2), "tail"),
            ((PAIR, ()), (2,), "intervals"),
            ((PAIR, ()), (2, 0), "intervals"),
            ((PAIR, PAIR), (2, 2), "neighbours differ"),
            (((), PAIR), (2, 2), "land as it begins"),
            ((PAIR, (), PAIR, ()), (2, 2, 2, 2), "to land once"),
        ],
    )
    def test_refused(self, phases, intervals, named):
        with pytest.raises(BadValue, match=named):
            Footfalls(phases, intervals)


class TestRequest:
    @pytest.mark.parametrize(
        ("values", "named"),
        [
            ({"speed": 0.0}, "speed"),
            ({"turn": 0.2}, "unfolded"),
            ({"turn": 2.0, "footfalls": FOOTFALLS["bound"]}, "turn"),
            ({"shortest": (0.5, 0.02)}, "shortest"),
            ({"tilt": 2.0}, "tilt"),
            ({"swing": SwingLaw()}, "without a law"),
            ({"spring": Spring(rest=0.5)}, "these springs are latched at touchdown"),
        ],
    )
    def test_refused(self, values, named):
        with pytest.raises(BadValue, match=named):
            FootfallRequest(**values)

    def test_a_stride_that_is_too_short_may_be_longer(self):
        asked = FootfallRequest(longest_stride=0.8)
        assert remedy(asked, "duration of the stride", 0.2) == "longest_stride=1"

    def test_law_refused(self):
        with pytest.raises(BadValue, match="knee_rest"):
            StanceLaw(knee_rest=-0.1)

    def test_scaled(self, robot):
        assert FootfallRequest.scaled(robot).speed == pytest.approx(2.0, rel=1e-9)
        with pytest.raises(UnknownName, match="sped"):
            FootfallRequest.scaled(robot, sped=1.0)

    def test_laws_scaled(self, robot):
        """Of a robot of twice the length and the same densities: m g l is 16-fold, √(l/g) √2-fold."""
        assert StanceLaw.scaled(robot) == StanceLaw() and SwingLaw.scaled(robot) == SwingLaw()
        larger = similar(robot, 2.0)
        law, swing = StanceLaw.scaled(larger), SwingLaw.scaled(larger, epsilon=0.01)
        assert law.stiffness == pytest.approx(16.0 * 200.0) and law.most == pytest.approx(16.0 * 200.0)
        assert law.adduction_damping == pytest.approx(16.0 * np.sqrt(2.0) * 10.0)
        assert law.knee_rest == StanceLaw().knee_rest
        assert swing.adduction_epsilon == pytest.approx(np.sqrt(2.0) * 0.04) and swing.epsilon == 0.01
        with pytest.raises(UnknownName, match="rest"):
            StanceLaw.scaled(robot, rest=1.0)


class TestLimbs:
    def test_by_place(self, robot):
        limbs = legs_of(robot)
        assert tuple(limbs) == LEGS
        assert all(limb.toe == f"{name}_toe" for name, limb in limbs.items())

    @pytest.mark.extra("example-robot-data")
    def test_of_another_robot(self):
        robot = load("solo12", base="chain", motors="all", toes=[f"{leg}_FOOT" for leg in ("FL", "FR", "HL", "HR")])
        limbs = legs_of(robot)
        assert {name: limb.toe[:2] for name, limb in limbs.items()} == dict(
            zip(LEGS, ("HL", "HR", "FL", "FR"), strict=True)
        )
        for limb in limbs.values():
            q = np.zeros(robot.nq)
            q[[limb.hip, limb.knee]] = find_limb_angles(limb, 0.05, 0.25)
            toe = robot.toe_position(q, limb.toe) - robot.frame_position(q, limb.above)
            np.testing.assert_allclose(toe[[0, 2]], [0.05, -0.25], atol=1e-6)

    def test_refuses_a_quaternion(self):
        with pytest.raises(BadValue, match="chain"):
            legs_of(load("q_spear_full"))


def test_rough_motion_stands_and_steps(robot):
    """Feet are on the ground while they bear, stay where they are, and are above it in the air."""
    limbs, request = legs_of(robot), FootfallRequest(footfalls=FOOTFALLS["gallop"])
    plan = Plan(limbs, hip_heights(robot), request, scale_in_space(robot), 430.0)
    for name, limb in limbs.items():
        landing, bearing = plan.contacts[name]
        places = [robot.toe_position(plan.q(landing + s * bearing, 18), limb.toe) for s in (0.01, 0.5, 0.99)]
        np.testing.assert_allclose(places, [places[0]] * 3, atol=1e-9)
        assert places[0][2] == pytest.approx(0.0, abs=1e-9)
        middle = landing + bearing + 0.5 * (plan.stride - bearing)
        assert robot.toe_position(plan.q(middle, 18), limb.toe)[2] > request.clearance
