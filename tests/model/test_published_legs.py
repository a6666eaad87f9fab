"""Robots that others have published: their numbers, and the laws of their springs and motors, in their own signs."""

import math

import numpy as np
import pytest
import sympy as sp

from spear_pin import load, monopod
from spear_pin.model.catalogue import motor
from spear_pin.model.linkage import SliderLinkage
from spear_pin.model.motor import Drive, Gearbox


@pytest.fixture(scope="module")
def hoppy():
    return load("hoppy_leg", locked=["boom_x"])


@pytest.fixture(scope="module")
def mups():
    return load("mups_v2")


def body(robot, joint):
    return robot.model.inertias[robot.model.getJointId(joint)]


class TestHoppy:
    """In its makers' axes: x along the boom, y forward, z up; centres of mass from the knee and from the toe."""

    TURN = np.array([[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])  # x here is their y, y is minus their x
    THIGH, SHANK = 0.096, math.hypot(0.1545, 0.052)
    # mass; centre of mass; Jxx, Jyy, Jzz, Jxy, Jxz, Jyz about it; where that is counted from, below the joint
    BODIES = {
        "hip": (
            0.656,
            (0.04825821, 0.00027269, 0.07708701),
            (0.0008211, 0.00235762, 0.0016834, -0.00002821, 0.00058518, -0.00001795),
            THIGH,
        ),
        "knee": (
            0.149,
            (0.00207136, 0.02086667, 0.14511501),
            (0.00039424, 0.00032191, 0.00010442, -0.00000379, -0.00000066, 0.00003269),
            SHANK,
        ),
    }

    @pytest.mark.parametrize("joint", BODIES)
    def test_masses_and_inertias(self, hoppy, joint):
        mass, centre, (xx, yy, zz, xy, xz, yz), below = self.BODIES[joint]
        inertia = body(hoppy, joint)
        assert inertia.mass == mass
        np.testing.assert_allclose(inertia.lever, self.TURN @ (np.array(centre) - [0, 0, below]), atol=1e-12)
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        np.testing.assert_allclose(inertia.inertia, self.TURN @ tensor @ self.TURN.T, atol=1e-15)

    def test_lengths_and_rotors(self, hoppy):
        (leg,) = hoppy.legs
        assert (leg.thigh, leg.shank, leg.side) == (self.THIGH, pytest.approx(self.SHANK), 1)
        assert (hoppy.gear_ratio("hip"), hoppy.gear_ratio("knee")) == (26.9, 28.8)
        np.testing.assert_allclose(hoppy.model.armature[1:], 7e-6 * np.array([26.9, 28.8]) ** 2)

    def test_the_slider_resists_as_the_boom_does(self, hoppy):
        tilting = 0.30208952 + 2.365 * (0.556 - 0.5019583) ** 2  # about the post, boom and counterweight
        assert body(hoppy, "boom_z").mass == pytest.approx(tilting / 0.556**2, abs=5e-6)

    @pytest.mark.parametrize(
        ("hip", "knee", "expected"),
        [  # their q3, q4, and D33, D34, D44 of their own equations, without rotors
            (1.030651122084284, -1.9283972398237168, (0.0033157845512213316, 0.0006968319913901874)),
            (0.8169464108399973, -2.4094496121951097, (0.002954009780830992, 0.0005159446061950175)),
            (1.3047382231759754, -2.030979596660352, (0.0032432658745125934, 0.0006605726530358185)),
        ],
    )
    def test_mass_matrix(self, hoppy, hip, knee, expected):
        D = hoppy.mass_matrix([0.0, hip, -knee])[1:, 1:] - np.diag(hoppy.model.armature[1:])
        D33, D34 = expected
        np.testing.assert_allclose(D, [[D33, -D34], [-D34, 0.0005068641927370313]], rtol=1e-9)

    def test_spring(self, hoppy):
        spring = hoppy.settings.springs["knee"]
        theirs = np.linspace(-2.5, 0.3, 40)  # q4
        on_q4 = 2.0 * (-0.0242 * theirs + 0.0108)
        np.testing.assert_allclose(-spring.torque(-theirs - spring.rest), on_q4, atol=1e-15)
        assert not spring.unilateral and spring.torque(1.0 - spring.rest) < 0.0  # it extends a flexed knee

    @pytest.mark.parametrize("joint", ["hip", "knee"])
    def test_motor(self, hoppy, joint):
        gears = Gearbox(hoppy.gear_ratio(joint), hoppy.settings.efficiencies[joint])
        drive, current, rate = Drive(hoppy.settings.motors[joint], gears, 12.0), 3.0, 2.0
        torque = drive.torque(current, rate)
        assert torque == pytest.approx(gears.ratio * 0.0135 * current)
        assert drive.voltage(torque, rate) == pytest.approx(1.3 * current + 0.0186 * gears.ratio * rate)
        assert hoppy.limits[joint].effort == pytest.approx(gears.ratio * 0.0135 * 12.0, rel=1e-3)
        assert hoppy.limits[joint].velocity == pytest.approx(12.0 / (gears.ratio * 0.0186), rel=1e-3)


class TestHoppyOnItsBoom:
    """Without rotors, in its makers' coordinates: the knee's angle and torque, and x and y of the toe, change."""

    SIGNS = np.diag([1.0, 1.0, 1.0, -1.0])

    @pytest.fixture(scope="class")
    @staticmethod
    def robot():
        return load("hoppy")

    # of arXiv 2010.14580's simulator at three states: q, v, the upper triangle of D row by row, C v + G, the toe
    @pytest.mark.parametrize(("q", "v", "upper", "bias", "toe"), [
        (
            (0.6100058474907604, 0.6158815794729875, 1.030651122084284, -1.9283972398237168),
            (-1.6288833255286272, 1.741497170688885, -0.5394640076333772, -1.2966493074246412),
            (0.3962741244337872, 0.01705534041568747, 0.005965971342078395, 0.0014684949350188777)
            + (0.5979628791935985, -0.013768423004501613, 7.940543172447755e-05)
            + (0.0033157845512213316, 0.0006968319913901874, 0.0005068641927370313),
            (1.6864672646275887, -4.000216816474469, 0.2060132583732881, 0.007476526009220388),
            (0.2988558736142249, 0.21237607593887753, -0.24793611956132103),
        ),
        (
            (-0.8921385952366871, -0.23326223842896354, 0.8169464108399973, -2.4094496121951097),
            (-1.9999945594970323, -1.758289966205286, -1.141394167187332, -0.3293853898340231),
            (0.5767919295437481, -0.0033018610116412146, 0.01313101984463623, 0.0017489222906175647)
            + (0.5982590591025709, -0.010280239056797272, 0.0015252558388923454)
            + (0.002954009780830992, 0.0005159446061950175, 0.0005068641927370313),
            (0.910635988315194, -6.361290529024497, 0.17462028846202832, -0.029990482987618357),
            (0.31357742742485994, -0.4605054376950293, 0.26453558782917785),
        ),
        (
            (-0.9024845785456639, 0.9983522301301428, 1.3047382231759754, -2.030979596660352),
            (0.40628092495847, 1.9241224695641779, 1.5619088387912434, -1.030983671774254),
            (0.17950524743391885, 0.024873835122950314, -0.00034533314974526124, 0.0006505156217603958)
            + (0.5973481117527368, -0.01584751481185597, -0.00031210313438301095)
            + (0.0032432658745125934, 0.0006605726530358185, 0.0005068641927370313),
            (-0.38831442642891434, -3.104298289801845, 0.13256138382839427, -0.0013112087999158856),
            (0.13540089229081556, -0.11926323269932071, -0.3505578116694101),
        ),
    ])  # fmt: skip
    def test_dynamics(self, robot, q, v, upper, bias, toe):
        q, v = self.SIGNS @ q, self.SIGNS @ v
        D = self.SIGNS @ (robot.mass_matrix(q) - np.diag(robot.model.armature)) @ self.SIGNS
        np.testing.assert_allclose(D[np.triu_indices(4)], upper, rtol=0, atol=1e-14)
        np.testing.assert_allclose(self.SIGNS @ robot.bias(q, v), bias, rtol=0, atol=1e-13)
        x, y, z = robot.toe_position(q, "toe")
        np.testing.assert_allclose([-y, x, z], toe, rtol=0, atol=1e-15)

    def test_what_it_shares_with_the_leg_alone(self, robot, hoppy):
        assert robot.settings.springs == hoppy.settings.springs and robot.settings.motors == hoppy.settings.motors
        assert robot.settings.efficiencies == hoppy.settings.efficiencies
        assert [robot.limits[joint] for joint in robot.actuated] == [hoppy.limits[joint] for joint in hoppy.actuated]
        np.testing.assert_array_equal(robot.model.armature[2:], hoppy.model.armature[1:])
        for joint in ("hip", "knee"):
            assert body(robot, joint) == body(hoppy, joint)
        (own,), (alone,) = robot.legs, hoppy.legs
        assert (own.thigh, own.side) == (alone.thigh, alone.side) and own.shank == pytest.approx(alone.shank, rel=1e-14)

    def test_it_weighs_less_than_it_resists(self, robot):
        """Boom, motors and counterweight weigh 0.23 kg at the hip, as the leg alone says of them."""
        leg = 0.656 * (0.556 + 0.04825821) + 0.149 * (0.556 + 0.00207136)
        whole = -robot.gravity(np.zeros(4))[1] / 9.81
        assert (whole - leg) / 0.556 == pytest.approx(0.23, abs=5e-4)


KS, L0, L1, L2, L3, L4, L5, L6 = 4115.0, 0.138, 0.03, 0.1, 0.22, 0.02, 0.01, 0.003


def published_torque(knee):
    """On the knee, in N·m, at its own angles, in rad: its makers' closed form, without the rounding of its corner."""
    phi = -np.asarray(knee) - math.pi / 2
    sine, cosine, c = np.sin(phi), np.cos(phi), L1 + L4
    root = np.sqrt(L2**2 - (L5 - c * cosine) ** 2)
    return KS * np.maximum(L0 - L3 + L6 + c * sine + root, 0.0) * (c * cosine - c * sine * (L5 - c * cosine) / root)


class TestMups:
    LINKAGE = SliderLinkage(KS, free_length=L0, crank=L1 + L4, rod=L2, stop=L3 - L6, offset=L5)
    LOW, HIGH = -2.6, -1.3  # how its knee turns

    def test_masses_and_inertias(self, mups):
        assert mups.mass == pytest.approx(0.691606304075024 + 2 * 0.252 + 0.680521373875353 + 0.0736455323538633)
        thigh = body(mups, "hip")
        np.testing.assert_allclose(thigh.lever, [-0.00266508662940908, 0.0, -0.0184404554474768], atol=1e-17)
        np.testing.assert_allclose(
            thigh.inertia, np.diag([0.00121567934619546, 0.0015642418763912, 0.000404763200727095]), atol=1e-17
        )
        shank, foot = 0.0613493769638906, 0.0122961553899727
        lower = body(mups, "knee")
        assert lower.mass == pytest.approx(shank + foot)
        along = shank * -0.104282712433589 + foot * (-0.21916 - 0.000893727131991484)
        assert lower.lever[2] == pytest.approx(along / (shank + foot))
        weights = 2 * (0.00013 + 0.252 * (0.3**2 + 0.08**2))
        about_y = body(mups, "pitch").inertia[1, 1] + body(mups, "pitch").mass * np.sum(body(mups, "pitch").lever ** 2)
        torso = 0.00516450436448171 + 0.691606304075024 * (3.47977543608903e-05**2 + 0.0123233505852236**2)
        assert about_y == pytest.approx(weights + torso)

    def test_lengths_and_limits(self, mups):
        (leg,) = mups.legs
        assert (leg.thigh, leg.side) == (0.22, -1) and leg.shank == pytest.approx(0.22, abs=5e-6)
        assert leg.knee_zero == pytest.approx(math.atan(0.019174 / 0.21916))
        assert mups.limits["knee"].position == (self.LOW, self.HIGH)

    def test_its_formula_is_the_energy_of_its_linkage(self):
        """The pin, the slider on its rail, and the rod between them, solved anew."""
        knee, s = sp.symbols("knee s", real=True)
        phi = -knee - sp.pi / 2
        pin = sp.Matrix([(L1 + L4) * sp.sin(phi), (L1 + L4) * sp.cos(phi)])
        rod = pin - sp.Matrix([s, L5])
        slider = max(sp.solve(rod.dot(rod) - L2**2, s), key=lambda root: root.subs(knee, -1.5))
        length = (L3 - L6) - slider
        torque = sp.lambdify(knee, -sp.diff(KS * (L0 - length) ** 2 / 2, knee))
        for angle in np.linspace(self.LOW, self.HIGH, 27):
            assert float(published_torque(angle)) == pytest.approx(torque(angle), abs=1e-10)

    def test_the_linkage_is_the_formula(self):
        knee = np.linspace(-2.8, 0.0, 200)
        np.testing.assert_allclose(self.LINKAGE.torque(-knee - math.pi / 2), published_torque(knee), atol=1e-12)

    def test_the_table_is_of_the_linkage(self, mups):
        spring, (leg,) = mups.settings.springs["knee"], mups.legs
        begin = self.LINKAGE.begin(-0.5, 0.5)
        assert spring.rest == pytest.approx(begin + math.pi / 2 + leg.knee_zero, abs=1e-12)
        there = self.LINKAGE.table(begin, [angle for angle, _ in spring.table[1:]])
        np.testing.assert_allclose(spring.table, there, atol=5.1e-5)

    def test_spring(self, mups):
        """As the hop has it, on the knee's angle in flexion, and on the knee's own with the sign of that."""
        leg = monopod(mups, "leg")
        spring, (turn,) = leg.settings.springs["knee"], leg.cut.angles["knee"]
        own = np.linspace(self.LOW, -1.2988, 500)
        flexed = turn.sign * (own - turn.zero)
        assert turn.sign == -1
        np.testing.assert_allclose(turn.sign * spring.torque(flexed - spring.rest), published_torque(own), atol=0.021)
        assert published_torque(own).max() == pytest.approx(9.7515, abs=1e-4)
        begin = spring.rest - math.pi / 2 - turn.zero
        np.testing.assert_allclose(
            spring.energy(flexed - spring.rest), self.LINKAGE.energy(begin + flexed - spring.rest), atol=0.01
        )

    def test_motor(self, mups):
        drive = Drive(mups.settings.motors["knee"], Gearbox(mups.gear_ratio("knee")), 24.0)
        assert drive.joule_power(5.0, 0.0) == pytest.approx(5.0**2 * 0.17 / 0.945**2)
        assert not mups.model.armature.any() and motor("mups_v2_joint").rotor_inertia is None


class TestCrankHopper:
    """A vertical hopper with a crank, a rod and a spring along its leg."""

    def test_masses_and_what_the_motor_feels(self):
        robot = load("crank_hopper")
        assert robot.mass == pytest.approx(1.3) and robot.gear_ratio("crank") == 6.0
        for degrees in (-21.0, 9.0):
            x = math.radians(degrees)
            slope = -0.07 * math.cos(x)
            slope += 0.07**2 * math.cos(x) * math.sin(x) / math.sqrt(0.15**2 - (0.07 * math.cos(x)) ** 2)
            found = robot.reduced([0.3, x, -0.45 - x, 0.15], [0.0, 0.0])
            assert found.T[robot.index("slide"), 1] == pytest.approx(slope, abs=1e-12)
            # the inertia at the crank, and the foot's mass by the linkage; crank and rod have a gram each
            assert found.mass_matrix[1, 1] == pytest.approx(4.73e-3 + 0.15 * slope**2, abs=1.5e-5)


class TestMinitaurLeg:
    """A five-bar leg with two motors on one axis, and a toe beyond the pin of its lower links."""

    def test_masses_and_the_toe(self):
        robot, opening = load("minitaur_leg"), 0.75
        assert robot.mass == pytest.approx((3.353 + 2 * 0.644) / 4 + 2 * (0.241 + 0.034) + 0.086 + 0.072)
        assert all(robot.limits[f"{side}_hip"].effort == 5.7 for side in ("front", "back"))
        lean = math.asin(0.101 * math.sin(opening) / 0.2)  # of the lower links, whose pin is below the axis
        q = [0.0, opening, -opening - lean, -opening, opening + lean]
        assert np.abs(robot.loop_gap(q)).max() < 1e-12
        depth = 0.101 * math.cos(opening) + 0.24 * math.cos(lean)
        np.testing.assert_allclose(robot.toe_position(q, "toe"), [-0.04 * math.sin(lean), -depth], atol=1e-12)

    def test_what_a_motor_feels(self):
        """With its knee locked a motor turns its rotor and both links as one body."""
        robot, angle = load("minitaur_leg"), 0.9
        reach = math.hypot(0.101 + 0.12 * math.cos(angle), 0.12 * math.sin(angle))  # to the lower link's centre of mass
        upper, lower = 4.2198e-5 + 0.034 * 0.045**2, 3.2637e-4 + 0.086 * reach**2
        found = robot.mass_matrix([0.0, 0.4, angle, 0.0, 0.0])[1, 1]
        assert found == pytest.approx(2.1765e-4 + upper + lower, rel=1e-12)
