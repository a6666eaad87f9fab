"""A quadruped's sagittal plane, against the quadruped that moves in it."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import bounding, load, monopod, sagittal
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.gait import Gait
from spear_pin.model.legs import find_legs
from tests.model.legged import quadruped
from tests.model.queries import refusal

NAMES = (
    "torso_x",
    "torso_z",
    "pitch",
    "posterior_hip",
    "posterior_knee",
    "anterior_hip",
    "anterior_knee",
)
MADE = {
    "mirrored": {},
    "hips about -y": {"hip": -1},
    "knees about -y": {"knee": -1},
    "toes ahead": {"hip": -1, "ahead": 0.04},
}
STATES = np.random.default_rng(6).uniform(-2, 2, (20, 2, 7))


def assert_same(actual, expected, atol=1e-10):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=atol)


def embedded(whole, plane, q, v):
    """The state of the whole robot that moves as its sagittal plane does.

    Returns (q, S, Ṡ v), S v being its velocity, the base's in its own axes.
    """
    sine, cosine = np.sin(q[2]), np.cos(q[2])
    full, embedding, rate = pin.neutral(whole.model), np.zeros((whole.nv, 7)), np.zeros(whole.nv)
    full[:7] = q[0], 0, q[1], 0, -np.sin(q[2] / 2), 0, np.cos(q[2] / 2)
    embedding[[0, 2], :2] = [[cosine, sine], [-sine, cosine]]
    embedding[4, 2] = -1.0
    rate[[0, 2]] = v[2] * np.array([[-sine, cosine], [-cosine, -sine]]) @ v[:2]
    for name, turns in plane.cut.angles.items():
        for turn in turns:
            joint = whole.model.joints[whole.model.getJointId(turn.joint)]
            full[joint.idx_q] = turn.sign * q[plane.index(name)] + turn.zero
            embedding[joint.idx_v, plane.index(name)] = turn.sign
    return full, embedding, rate


def assert_is_projection(whole, plane):
    """Mass matrix, bias, gravity and toes are those of the whole robot."""
    toes = {leg.hip: leg.toe for leg in find_legs(whole)}
    for q, v in STATES:
        full, embedding, rate = embedded(whole, plane, q, v)
        rates = embedding @ v
        assert_same(plane.mass_matrix(q), embedding.T @ whole.mass_matrix(full) @ embedding)
        force = whole.bias(full, rates) + whole.mass_matrix(full) @ rate
        assert_same(plane.bias(q, v), embedding.T @ force)
        assert_same(plane.gravity(q), embedding.T @ whole.gravity(full))
        assert_same(plane.kinetic_energy(q, v), whole.kinetic_energy(full, rates))
        for toe in plane.toes:
            for turn in plane.cut.angles[toe.replace("toe", "hip")]:
                own = toes[turn.joint]
                robot = whole if own in whole.toes else load_with(whole, own)
                assert_same(plane.toe_position(q, toe), robot.toe_position(full, own)[[0, 2]])
                jacobian = robot.toe_jacobian(full, own)
                assert_same(plane.toe_jacobian(q, toe), (jacobian @ embedding)[[0, 2]])
                drift = robot.toe_drift(full, rates, own) + jacobian @ rate
                assert_same(plane.toe_drift(q, v, toe), drift[[0, 2]])


def load_with(whole, toe):
    """The robot with this toe."""
    return type(whole)(whole.model, name=whole.name, toes=[toe], actuated=whole.actuated)


class TestQSpear:
    FULL, PLANE, THERE = load("q_spear_full"), sagittal(load("q_spear_full")), load("q_spear")

    def test_names(self):
        for name in ("coordinates", "toes", "actuated", "legs", "planar"):
            assert getattr(self.PLANE, name) == getattr(self.THERE, name)
        assert self.PLANE.coordinates == NAMES
        assert self.PLANE.source == "sagittal('q_spear_full')"

    def test_is_the_shipped_one(self):
        for q, v in STATES:
            assert_same(self.PLANE.mass_matrix(q), self.THERE.mass_matrix(q))
            assert_same(self.PLANE.bias(q, v), self.THERE.bias(q, v))
            assert_same(self.PLANE.gravity(q), self.THERE.gravity(q))
            for toe in self.THERE.toes:
                assert_same(self.PLANE.toe_position(q, toe), self.THERE.toe_position(q, toe))
                assert_same(self.PLANE.toe_jacobian(q, toe), self.THERE.toe_jacobian(q, toe))
                assert_same(self.PLANE.toe_drift(q, v, toe), self.THERE.toe_drift(q, v, toe))

    def test_motors_and_limits(self):
        names = ("armature", "rotorInertia", "rotorGearRatio", "lowerEffortLimit", "upperEffortLimit")
        for name in (*names, "lowerPositionLimit", "upperPositionLimit", "upperVelocityLimit"):
            assert_same(getattr(self.PLANE.model, name)[3:], getattr(self.THERE.model, name)[3:], 1e-15)

    def test_is_projection(self):
        assert_is_projection(self.FULL, self.PLANE)

    def test_bounds(self):
        gait = Gait.load("long_stride")
        system = bounding(self.PLANE, gait.system.law, gait.system.spring, gait.system.contact)
        assert system.phases == gait.system.phases

    def test_monopod_of_a_pair(self):
        """Half of it is one leg, alone."""
        pair, alone = monopod(self.PLANE, "posterior"), monopod(self.FULL, "posterior_left")
        for q, v in STATES[:, :, :4]:
            assert_same(pair.mass_matrix(q), 2 * alone.mass_matrix(q))
            assert_same(pair.bias(q, v), 2 * alone.bias(q, v))


class TestMade:
    @pytest.mark.parametrize("how", MADE)
    def test_is_projection(self, write, how):
        whole = load(write(quadruped(**MADE[how])))
        assert_is_projection(whole, sagittal(whole))

    @pytest.mark.parametrize("how", MADE)
    def test_signs(self, write, how):
        """Straight down at zero; a hip brings the toe forward, a knee backward, the pitch lifts the nose."""
        plane = sagittal(load(write(quadruped(**MADE[how]))))
        posterior, anterior = plane.legs
        for leg, x in ((posterior, -0.18), (anterior, 0.22)):
            jacobian = plane.toe_jacobian(np.zeros(7), leg.toe)
            assert_same(plane.toe_position(np.zeros(7), leg.toe), [x, -0.01 - leg.length(0.0)])
            assert_same(jacobian[0, [plane.index(leg.hip), plane.index(leg.knee)]], [leg.length(0.0), -leg.shank])
            assert_same(jacobian[1, 2], x)

    def test_sides(self, write):
        assert [leg.side for leg in sagittal(load(write(quadruped()))).legs] == [1, -1]
        plane = sagittal(load(write(quadruped(knee=-1, knee_limits=(0.2, 2.7)))))
        assert [leg.side for leg in plane.legs] == [-1, -1]
        assert_same(plane.model.upperPositionLimit[[4, 6]], [-0.2, -0.2])

    def test_sides_that_are_not_known(self, write):
        whole = load(write(quadruped(knee_limits=(-2.7, 2.7))))
        assert [leg.side for leg in sagittal(whole).legs] == [0, 0]
        legs = {leg.name: leg for leg in find_legs(whole, sides=-1)}
        named = sagittal(whole, pairs=[(legs["FL"], legs["FR"]), (legs["HL"], legs["HR"])])
        assert [leg.side for leg in named.legs] == [-1, -1]

    def test_pairs(self, write):
        plane = sagittal(load(write(quadruped())))
        assert plane.coordinates == NAMES and plane.actuated == NAMES[3:]
        assert [turn.joint for turn in plane.cut.angles["posterior_hip"]] == ["HL_pitch", "HR_pitch"]
        assert plane.cut.held == ("FL_swing", "FR_swing", "HL_swing", "HR_swing")
        assert plane.mass == pytest.approx(load(write(quadruped())).mass, rel=1e-14)

    def test_sums_of_a_pair(self, write):
        model = sagittal(load(write(quadruped()))).model
        assert_same(model.armature[3:], [2 * 49e-4, 2 * 64e-4, 2 * 49e-4, 2 * 64e-4])
        assert_same(model.damping[3:], 4 * [0.06])
        assert_same(model.upperEffortLimit[3:], [50.0, 60.0, 50.0, 60.0])
        assert_same(model.upperVelocityLimit[3:], 4 * [15.0])
        assert_same(model.rotorGearRatio[3:], [7.0, 8.0, 7.0, 8.0])

    @pytest.mark.filterwarnings("ignore:made. not taken over. friction")
    def test_dry_friction_of_a_pair(self, write):
        model = sagittal(load(write(quadruped(friction=0.2)))).model
        assert_same(model.upperDryFrictionLimit[3:], 4 * [0.4])

    def test_root_link_as_trunk(self, write):
        floating = sagittal(load(write(quadruped())))
        rooted = sagittal(load(write(quadruped(float_base=False)), base="fixed"))
        for q, v in STATES:
            assert_same(rooted.mass_matrix(q), floating.mass_matrix(q))
            assert_same(rooted.bias(q, v), floating.bias(q, v))

    def test_root_link_without_abduction(self, write):
        """Nothing of it leaves the plane, and yet it has pairs."""
        swings = [f"{name}_swing" for name in ("FL", "FR", "HL", "HR")]
        flat = load(write(quadruped(float_base=False)), base="fixed", locked=swings)
        assert flat.planar
        q, v = STATES[0]
        assert_same(sagittal(flat).bias(q, v), sagittal(load(write(quadruped()))).bias(q, v))

    def test_joints_that_turn_without_end(self, write):
        sides = {"FL": -1, "FR": -1, "HL": 1, "HR": 1}
        whole = load(write(quadruped(kind="continuous")))
        legs = {leg.name: leg for leg in find_legs(whole, sides=sides)}
        plane = sagittal(whole, [(legs["HL"], legs["HR"]), (legs["FL"], legs["FR"])])
        bounded = sagittal(load(write(quadruped())))
        for q, v in STATES:
            assert_same(plane.mass_matrix(q), bounded.mass_matrix(q))
            assert_same(plane.bias(q, v), bounded.bias(q, v))
        assert np.isinf(plane.model.upperPositionLimit[3:]).all()


class TestUnlikePairs:
    """Left and right that are not each other's image."""

    @staticmethod
    def other(write, name, old, new):
        """The quadruped with one of its legs, or a joint of one, changed."""
        text = quadruped()
        start = text.index(name)
        assert old in text[start:]
        return load(write(text[:start] + text[start:].replace(old, new, 1)))

    def test_gears(self, write):
        """The rotor that stands for both is as heavy at the joint as they are."""
        drive = '<transmission name="FR_pitch_drive">'
        text = quadruped()
        start = text.index(drive)
        whole = load(write(text[:start] + text[start:].replace("7.0", "-10.0", 2)))
        plane = sagittal(whole)
        row = plane.index("anterior_hip")
        armature = (7.0**2 + 10.0**2) * 1e-4
        assert plane.model.armature[row] == pytest.approx(armature, rel=1e-14)
        assert abs(plane.gear_ratio("anterior_hip")) == 10.0
        assert plane.model.rotorInertia[row] * 10.0**2 == pytest.approx(armature, rel=1e-14)

    def test_one_motor_of_two(self, write):
        whole = load(write(quadruped()), motors=["FL_pitch", "FR_pitch", "FL_bend", "HL_bend", "HR_bend"])
        error = refusal(BadValue, lambda: sagittal(whole))
        assert "both joints of a pair" in str(error) and "FR_bend has none" in str(error)
        without = load(write(quadruped()), motors=["FL_pitch", "FR_pitch"])
        assert sagittal(without).actuated == ("anterior_hip",)

    @pytest.mark.parametrize(("length", "fits"), [("-0.199", True), ("-0.201", False), ("-0.17", False)])
    def test_lengths(self, write, length, fits):
        """Of the thigh, 0.19 m."""
        place = '<joint name="FR_bend"'
        whole = self.other(write, place, "-0.19", length)
        if fits:
            assert sagittal(whole).cut.asymmetric[1].value == pytest.approx(0.009)
        else:
            text = str(refusal(BadValue, lambda: sagittal(whole)))
            assert "thighs of FL and FR" in text and length[1:] in text and "0.19" in text and "5%" in text

    def test_limits_that_exclude_each_other(self, write):
        whole = self.other(write, '<joint name="FR_bend"', 'lower="-2.5" upper="0.1"', 'lower="0.2" upper="2.5"')
        text = str(refusal(BadValue, lambda: sagittal(whole)))
        assert "FL_bend and FR_bend as anterior_knee" in text and "overlap" in text

    def test_limits_of_one_of_both(self, write):
        whole = self.other(write, '<joint name="FR_bend"', 'lower="-2.5" upper="0.1"', 'lower="0" upper="0"')
        assert_same(sagittal(whole).limits["anterior_knee"].position, (-2.5, 0.1))

    def test_what_was_locked_is_said(self, write):
        whole = load(write(quadruped()), locked=["FL_swing"])
        assert sagittal(whole).cut.held == ("FR_swing", "HL_swing", "HR_swing", "FL_swing")


class TestSaid:
    def test_mirror_images(self, write):
        cut = sagittal(load(write(quadruped()))).cut
        assert max(amount.value for amount in cut.asymmetric) < 1e-15
        lines = str(cut).splitlines()
        assert lines[0] == "sagittal of made, body 7.6 kg"
        assert "anterior_knee = FL_bend = FR_bend" in lines[1]
        assert lines[3] == "left and right mirror each other"
        assert lines[4].startswith("neglected: toes out of their hips' planes by 0.034 m; products of inertia")

    def test_differences(self, write):
        """They are said; in motions that are alike the sum of both is still right."""
        whole = load(write(quadruped()))
        model = whole.model.copy()
        thigh, base = model.getJointId("FL_pitch"), model.getJointId("base")
        heavier = pin.Inertia(1.1, np.array([0.004, 0.03, -0.05]), model.inertias[thigh].inertia)
        model.inertias[thigh] = heavier
        model.inertias[base] = pin.Inertia(6.0, np.array([0.02, 0.015, 0.03]), model.inertias[base].inertia)
        other = whole.with_model(model)
        plane = sagittal(other)
        assert_is_projection(other, plane)
        said = {amount.what: amount.value for amount in plane.cut.asymmetric}
        assert said["masses by"] == pytest.approx(0.2)
        assert said["centres of mass by"] == pytest.approx(0.03)
        assert said["the trunk's centre of mass from the middle by"] == pytest.approx(6.0 * 0.015 / 7.6)
        assert said["lengths by"] == said["rotors by"] == 0.0
        assert "left and right differ: masses by 0.2 kg; centres of mass by 0.03 m" in str(plane.cut)


class TestRefused:
    def test_in_the_plane_already(self):
        error = refusal(BadValue, lambda: sagittal(load("q_spear")))
        assert "found: posterior, anterior" in str(error)

    def test_two_legs(self, arm):
        assert "found: none" in str(refusal(BadValue, lambda: sagittal(arm)))

    def test_ankles(self, write):
        error = refusal(BadValue, lambda: sagittal(load(write(quadruped(ankle=True)))))
        assert "_sole" in str(error)

    @pytest.mark.parametrize(
        "pairs", [[("FL", "FR")], [("FL", "FR"), ("HL", "FL")], [("FL", "FR"), ("HL",)], [], [5, 6]]
    )
    def test_pairs(self, write, pairs):
        whole = load(write(quadruped()))
        refusal(BadValue, lambda: sagittal(whole, pairs))

    def test_unknown_leg(self, write):
        whole = load(write(quadruped()))
        refusal(UnknownName, lambda: sagittal(whole, [("FL", "FR"), ("HL", "RR")]))
