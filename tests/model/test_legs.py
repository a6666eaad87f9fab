"""Legs that are found in a robot."""

import math
import pickle

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import Leg, Robot, load
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.bounding_law import legs_of
from spear_pin.model.legs import find_legs, leg_name
from tests.model.legged import joint, limb, link, quadruped, robot, slider
from tests.model.queries import refusal

FOUR = ("posterior_left", "posterior_right", "anterior_left", "anterior_right")
SHIPPED = {
    "spear_ii": {"leg": ("hip", "knee", "toe", None, 1)},
    "q_spear": {
        name: (f"{name}_hip", f"{name}_knee", f"{name}_toe", None, side)
        for name, side in (("posterior", 1), ("anterior", -1))
    },
    "q_spear_full": {
        name: (f"{name}_hip", f"{name}_knee", f"{name}_toe", f"{name}_adduction", 1 if "posterior" in name else -1)
        for name in FOUR
    },
    "biped": {name: (f"{name}_hip", f"{name}_knee", f"{name}_toe", None, 1) for name in ("left", "right")},
}


class TestShipped:
    @pytest.mark.parametrize("name", SHIPPED)
    def test_names_and_sides(self, name):
        found = {leg.name: (leg.hip, leg.knee, leg.toe, leg.abduction, leg.side) for leg in load(name).legs}
        assert found == SHIPPED[name]
        assert list(found) == list(SHIPPED[name])

    @pytest.mark.parametrize("name", SHIPPED)
    def test_angles_are_the_convention(self, name):
        for leg in load(name).legs:
            assert (leg.hip_sign, leg.knee_sign, leg.hip_zero, leg.knee_zero, leg.others) == (1, 1, 0.0, 0.0, ())
            assert leg.bends == leg.side and leg.across == 0.0
            assert (leg.thigh, leg.shank) == pytest.approx((0.318, 0.318), abs=1e-15)
            assert leg.lean(0.7) == pytest.approx(0.35, abs=1e-15)

    def test_those_of_the_bounding_law(self):
        full = load("q_spear")
        for leg, of_law in zip(full.legs, legs_of(full), strict=True):
            assert (leg.name, leg.toe, leg.knee) == (of_law.name, of_law.toe, of_law.joint)
            assert leg.side == of_law.side and full.index(leg.hip) == of_law.hip

    def test_locked(self):
        assert load("spear_ii", locked=["boom_x"]).legs == load("spear_ii").legs

    def test_survives_pickling(self):
        full = load("q_spear_full")
        assert pickle.loads(pickle.dumps(full)).legs == full.legs

    def test_joint_below_the_knee(self):
        (leg,) = load("spear_ii_series").legs
        assert leg.others == ("knee_spring",)


class TestFound:
    @pytest.mark.parametrize("float_base", [True, False])
    def test_quadruped(self, write, float_base):
        legs = load(write(quadruped(float_base)), base="free").legs
        assert [leg.name for leg in legs] == ["FL", "FR", "HL", "HR"]
        assert [leg.toe for leg in legs] == ["FL_foot", "FR_foot", "HL_foot", "HR_foot"]
        assert [(leg.hip, leg.knee, leg.abduction) for leg in legs] == [
            (f"{name}_pitch", f"{name}_bend", f"{name}_swing") for name in ("FL", "FR", "HL", "HR")
        ]
        assert [leg.side for leg in legs] == [leg.bends for leg in legs] == [-1, -1, 1, 1]
        assert legs[0].across == pytest.approx(0.034) and legs[1].across == pytest.approx(-0.034)

    def test_toes_given(self, write):
        legs = load(write(quadruped()), toes=["HR_foot", "FL_foot"]).legs
        assert [leg.name for leg in legs] == ["HR", "FL"]
        assert find_legs(load(write(quadruped())), toes=["HL_foot", "HL_shank"])[0].toe == "HL_foot"
        assert len(load(write(quadruped()), toes=["HL_foot", "HL_shank", "FL_foot"]).legs) == 2

    @pytest.mark.parametrize("hip", [1, -1])
    @pytest.mark.parametrize("knee", [1, -1])
    def test_senses_of_axes(self, write, hip, knee):
        arm = load(write(quadruped(hip=hip, knee=knee, ahead=0.03)))
        for leg in arm.legs:
            q = pin.neutral(arm.model)
            q[arm.index(leg.hip) + 1], q[arm.index(leg.knee) + 1] = leg.hip_zero, leg.knee_zero
            hip_at, toe = arm.frame_position(q, leg.hip), arm.frame_position(q, leg.toe)
            np.testing.assert_allclose((toe - hip_at)[[0, 2]], [0.0, -leg.length(0.0)], atol=1e-15)
            assert leg.length(0.0) == pytest.approx(leg.thigh + leg.shank)
            flexed = 0.8
            q[arm.index(leg.hip) + 1] += leg.hip_sign * leg.lean(flexed)
            q[arm.index(leg.knee) + 1] += leg.knee_sign * flexed
            toe, knee_at = arm.frame_position(q, leg.toe), arm.frame_position(q, leg.knee)
            np.testing.assert_allclose((toe - hip_at)[[0, 2]], [0.0, -leg.length(flexed)], atol=1e-15)
            assert knee_at[0] > hip_at[0]  # forward

    def test_arms_are_no_legs(self, write):
        arm = [
            link("upper", 1.0, (0, 0, -0.1), (0.01, 0.01, 0.01, 0, 0, 0)),
            link("fore", 1.0, (0, 0, -0.1), (0.01, 0.01, 0.01, 0, 0, 0)),
            joint("shoulder", "revolute", "trunk", "upper", (0, 0.2, 0.4), (0, 1, 0)),
            joint("elbow", "revolute", "upper", "fore", (0, 0, -0.2), (0, 1, 0)),
        ]
        assert len(load(write(quadruped(extra=arm))).legs) == 4

    def test_ankle_is_said(self, write):
        legs = load(write(quadruped(ankle=True))).legs
        assert [leg.others for leg in legs] == [(f"{name}_sole",) for name in ("FL", "FR", "HL", "HR")]

    @pytest.mark.parametrize("kind", ["prismatic", "floating"])
    def test_joint_above_the_hip_is_said(self, write, kind):
        """Whatever it is, but for the abduction; rails are the trunk's."""
        text = quadruped().replace('"trunk"/><child link="FL_bracket"', '"trunk"/><child link="FL_slide"')
        above = [link("FL_slide"), joint("FL_lift", kind, "FL_slide", "FL_bracket", axis=(0, 0, 1))]
        made = load(write(text.replace("</robot>", f"{''.join(above)}</robot>")), base="fixed")
        assert {leg.name: leg.others for leg in made.legs} == {"FL": ("FL_lift",), "FR": (), "HL": (), "HR": ()}

    def test_rails_are_the_trunks(self, write):
        (leg,) = load(write(slider())).legs
        assert leg.others == ()

    @pytest.mark.parametrize("axis", ["1 0 0", "0 1 0"])
    def test_third_slide_is_none_of_them(self, write, axis):
        text = slider().replace('parent link="trunk"', 'parent link="beam"')
        third = joint("reach", "prismatic", "trunk", "beam").replace('axis xyz="0 0 1"', f'axis xyz="{axis}"')
        (leg,) = load(write(text.replace("</robot>", f"{link('beam')}{third}</robot>"))).legs
        assert leg.others == ("reach",)

    def test_robot_without_legs(self, write, arm):
        assert arm.legs == ()

    def test_name(self):
        names = {"anterior_toe": "anterior", "FL_FOOT": "FL", "toe": "leg", "foot": "leg", "toeFL": "FL", "tip": "tip"}
        assert {toe: leg_name(toe) for toe in names} == names

    def test_of_one_name(self, write):
        text = quadruped().replace("FL_foot", "left_toe").replace("HL_foot", "left_foot")
        assert [leg.name for leg in load(write(text)).legs] == ["left_toe", "FR", "left_foot", "HR"]

    def test_limbs_without_a_frame_at_their_ends(self, write):
        """As of a model that was built joint by joint."""
        model = load(write(quadruped())).model.copy()
        bare = pin.Model()
        for i in range(1, model.njoints):
            bare.addJoint(int(model.parents[i]), model.joints[i], model.jointPlacements[i], model.names[i])
        assert Robot(bare, name="bare", toes=(), actuated=()).legs == ()

    def test_unequal_lengths(self):
        uneven = Leg("leg", "hip", "knee", "toe", None, 1, 0.3, 0.2, 1, 1, 0.0, 0.0, 0.0)
        assert uneven.lean(math.pi / 2) == pytest.approx(math.atan2(0.2, 0.3))
        assert uneven.length(math.pi) == pytest.approx(0.1)


class TestSide:
    def test_limits(self, write):
        made = load(write(quadruped(knee_limits=(-2.7, -0.9))))
        assert [leg.side for leg in made.legs] == [-1, -1, -1, -1]
        made = load(write(quadruped(knee=-1, knee_limits=(-2.7, -0.9))))
        assert [(leg.side, leg.bends) for leg in made.legs] == 4 * [(-1, 1)]

    def test_open(self, write):
        made = load(write(quadruped(knee_limits=(-2.7, 2.7))))
        assert [leg.side for leg in made.legs] == [0, 0, 0, 0]

    def test_named(self, write):
        made = load(write(quadruped(knee_limits=(-2.7, 2.7))))
        assert [leg.side for leg in find_legs(made, sides=-1)] == [-1, -1, -1, -1]
        assert [leg.side for leg in find_legs(made, sides={"FL": 1, "HR": -1})] == [1, 0, 0, -1]

    def test_bent_at_zero(self, write):
        made = load(write(quadruped(knee_limits=(-2.7, 2.7), ahead=-0.1)))
        assert [leg.side for leg in made.legs] == [1, 1, 1, 1]

    def test_posture(self, write):
        made = load(write(quadruped(knee_limits=(-2.7, 2.7))))
        q = pin.neutral(made.model)
        for leg, angle in zip(made.legs, (-1.0, -1.0, 1.0, 0.05), strict=True):
            q[made.index(leg.knee) + 1] = angle
        model = made.model.copy()
        model.referenceConfigurations["standing"] = q
        assert [leg.side for leg in made.with_model(model).legs] == [-1, -1, 1, 0]

    def test_postures_that_disagree(self, write):
        made = load(write(quadruped(knee_limits=(-2.7, 2.7))))
        model = made.model.copy()
        for name, angle in (("sitting", 1.0), ("lying", -1.0)):
            q = pin.neutral(model)
            q[7:] = angle
            model.referenceConfigurations[name] = q
        assert [leg.side for leg in made.with_model(model).legs] == [0, 0, 0, 0]

    def test_limits_that_leave_no_room_tell_nothing(self, write):
        """As 0 and 0, which files say of what is not limited; by them the knee, bent at zero by 0.14, would flex."""
        made = load(write(quadruped(knee_limits=(0, 0), ahead=0.03)))
        assert [leg.side for leg in made.legs] == [-1, -1, -1, -1]  # the posture's answer
        made = load(write(quadruped(knee_limits=(0, 0), ahead=0.01)))
        assert [leg.side for leg in made.legs] == [0, 0, 0, 0]


class TestRefused:
    def test_toe_that_is_no_legs(self):
        error = refusal(BadValue, lambda: find_legs(load("q_spear"), toes=["torso"]))
        assert "torso" in str(error)

    def test_toe_at_the_knee(self, write):
        refusal(BadValue, lambda: find_legs(load(write(quadruped())), toes=["HL_shank"]))

    def test_unknown_toe(self):
        assert "anterior_toe" in refusal(UnknownName, lambda: find_legs(load("q_spear"), toes=["foot"])).valid

    def test_unknown_leg(self):
        refusal(UnknownName, lambda: find_legs(load("q_spear"), sides={"front": 1}))

    @pytest.mark.parametrize("side", [0, 2, "left", True, 1j, None])
    def test_side(self, side):
        refusal(BadValue, lambda: find_legs(load("q_spear"), sides={"anterior": side}))

    def test_not_a_robot(self):
        refusal(BadValue, lambda: find_legs("q_spear"))


def test_axes_out_of_the_plane(write):
    """A limb whose axes are turned about z has no joints in the sagittal plane."""
    made = robot(link("trunk", 1.0, (0, 0, 0), (1, 1, 1, 0, 0, 0)), *limb("one", (0, 0, 0)))
    turned = made.replace('<axis xyz="0 1 0"/>', '<axis xyz="1 0 0"/>')
    assert [len(load(write(each), base="fixed").legs) for each in (made, turned)] == [1, 0]
