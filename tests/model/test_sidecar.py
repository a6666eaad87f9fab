"""A TOML file that says of a robot what its URDF cannot: what each key does, what goes over it, and what is refused."""

import pickle

import numpy as np
import pytest

from spear_pin import Clutch, Gait, HoppingLaw, Spring, hopping, load, monopod, sagittal
from spear_pin.errors import BadFile, SpearError
from spear_pin.model.catalogue import motor
from spear_pin.model.legs import find_legs
from spear_pin.model.loading import ROBOTS
from spear_pin.model.origin import origin, robot_of, unsaid
from spear_pin.model.path import Joints
from spear_pin.model.settings import Settings
from spear_pin.studies.hop_of_another import scaled_hopping
from tests.model.legged import quadruped
from tests.model.queries import refusal

BLANK = {"knee_limits": (-2.5, 2.5)}
MOTORS = "hip", "knee"
FEET = [f"{leg}_foot" for leg in ("FL", "FR", "HL", "HR")]


@pytest.fixture
def made(tmp_path):
    """Writes a URDF of four legs, with a TOML file beside it or not, and returns the path of the URDF."""

    def make(toml=None, motors=True, **options):
        path = tmp_path / "dog.urdf"
        text = quadruped(float_base=False, **{**BLANK, **options})
        if not motors:
            before, *rest = text.split("<transmission")
            text = before + "".join(part.partition("</transmission>")[2] for part in rest)
        path.write_text(text, encoding="utf-8")
        if toml is not None:
            path.with_suffix(".toml").write_text(toml, encoding="utf-8")
        return path

    return make


SIDES = "\n".join(f"legs.{leg}.side = {side}" for leg, side in (("FL", -1), ("FR", -1), ("HL", 1), ("HR", 1)))
BASE = 'base = "free"\n'


class TestSays:
    def test_base(self, made):
        assert load(made(BASE)).coordinates[0] == "base_vx"
        assert load(made('base = "fixed"')).coordinates[0] == "FL_swing"

    def test_toes_and_locks(self, made):
        robot = load(made(BASE + 'toes = ["FL_foot", "HR_foot", "FL_foot"]\nlocked = ["FR_bend"]'))
        assert robot.toes == ("FL_foot", "HR_foot") and robot.locked == ("FR_bend",)
        assert [leg.name for leg in robot.legs] == ["FL", "HR"]

    @pytest.mark.parametrize("said", ['"all"', '["FL_bend", "HR_pitch"]'])
    def test_motors(self, made, said):
        robot = load(made(f"{BASE}motors = {said}", motors=False))
        assert robot.actuated == (robot.coordinates[6:] if "all" in said else ("FL_bend", "HR_pitch"))

    def test_sides(self, made):
        path = made()
        assert {leg.side for leg in load(path, base="free").legs} == {0}
        robot = load(made(BASE + SIDES))
        assert [leg.side for leg in robot.legs] == [-1, -1, 1, 1]
        assert robot.legs == tuple(
            leg for each, side in (("FL", -1), ("FR", -1), ("HL", 1), ("HR", 1))
            for leg in find_legs(robot, sides=side) if leg.name == each
        )  # fmt: skip

    def test_legs_by_their_joints(self, made):
        """They are the robot's, under the names they are given, and no other is looked for."""
        robot = load(made(BASE + """
            [legs.rear]
            hip = "HL_pitch"
            knee = "HL_bend"
            toe = "HL_foot"
            abduction = "HL_swing"
            side = 1
            [legs.front]
            hip = "FR_pitch"
            knee = "FR_bend"
            toe = "FR_foot"
            side = -1
            """))  # fmt: skip
        assert robot.toes == ("HL_foot", "FR_foot") and load(robot.source, ["FR_foot"]).legs == robot.legs[1:]
        rear, front = robot.legs
        (found,) = (leg for leg in load(made(BASE)).legs if leg.name == "HL")
        assert (rear.name, rear.thigh, rear.across, rear.abduction) == ("rear", found.thigh, found.across, "HL_swing")
        assert (front.name, front.side, front.abduction) == ("front", -1, None)
        assert monopod(robot, "front").cut.angles["knee"][0].joint == "FR_bend"

    def test_pairs(self, made):
        pairs = '\npairs = [["HR", "HL"], ["FL", "FR"]]\n'
        cut = sagittal(load(made(BASE + pairs + SIDES))).cut
        assert [[leg.name for leg in pair] for pair in cut.legs] == [["HR", "HL"], ["FL", "FR"]]
        assert dict(cut.sides) == {"posterior": 1, "anterior": -1}

    def test_motors_by_role_and_joint(self, made):
        """A joint's table goes over its role's, that over all's; the rotor is reflected by the square of the ratio."""
        robot = load(made(BASE + """
            [motors.all]
            [motors.knee]
            motor = "ec_60_flat_100w_48v"
            ratio = 9
            [motors.hip]
            ratio = 6.5
            rotor_inertia = 2e-5
            efficiency = 0.9
            [motors.HR_bend]
            ratio = 3.0
            """, motors=False))  # fmt: skip
        known = motor("ec_60_flat_100w_48v")
        for leg in ("FL", "FR", "HL", "HR"):
            last = leg == "HR"
            expected = [0.0, 6.5**2 * 2e-5, 0.0 if last else 81 * known.rotor_inertia]
            rows = [robot.index(f"{leg}_{part}") for part in ("swing", "pitch", "bend")]
            np.testing.assert_allclose(robot.model.armature[rows], expected, rtol=1e-15)
            assert [robot.gear_ratio(robot.coordinates[row]) for row in rows] == [1.0, 6.5, 3.0 if last else 9.0]
        assert robot.actuated == robot.coordinates[6:]
        assert dict(robot.settings.motors) == {f"{leg}_bend": known for leg in ("FL", "FR", "HL")}
        assert robot.settings.efficiencies["FL_pitch"] == 0.9 and robot.settings.efficiencies["FL_bend"] == 1.0

    def test_tables_give_motors_to_their_joints_only(self, made):
        assert load(made(BASE + "motors.knee.ratio = 8.0\n")).actuated == ("FL_bend", "FR_bend", "HL_bend", "HR_bend")

    def test_what_the_urdf_says_as_well(self, made):
        """Its rotors and ratios stay, and may be repeated."""
        robot = load(
            made(BASE + "motors.knee = {ratio = 8.0, rotor_inertia = 1e-4}\nmotors.hip = {efficiency = 0.8}\n")
        )
        plain = load(made(), base="free")
        assert robot.model.armature.tolist() == plain.model.armature.tolist()
        assert len(robot.actuated) == 8 and robot.gear_ratio("FL_pitch") == 7.0

    def test_springs(self, made):
        robot = load(made(BASE + """
            [springs.knee]
            stiffness = 20
            damping = 0.2
            [springs.HL_bend]
            table = [[0.0, 0.0], [0.5, 2.0]]
            rest = 0.4
            unilateral = true
            [springs.HR_bend]
            stiffness = 1.5
            """ + SIDES.replace("legs.FL", "[legs]\nFL").replace("legs.", "")))  # fmt: skip
        assert robot.settings.springs == {
            "FL_bend": Spring(20.0, 0.2),
            "FR_bend": Spring(20.0, 0.2),
            "HL_bend": Spring(0.0, 0.0, rest=0.4, table=((0.0, 0.0), (0.5, 2.0))),
            "HR_bend": Spring(1.5, 0.0),
        }
        assert monopod(robot, "HL").settings.springs == {"knee": robot.settings.springs["HL_bend"]}
        assert sagittal(robot).settings.springs == {"anterior_knee": Spring(40.0, 0.4)}  # those behind are not alike

    def test_springs_on_paths_of_each_leg(self, made):
        robot = load(made(BASE + """
            [springs.biceps]
            path = { knee = 0.02, hip = -0.004 }
            stiffness = 8000.0
            clutch = { engage = "loaded", on_force = 5.0, damper = "joint", slip = 90.0 }
            [springs.patella]
            from = { body = "thigh", at = [0.02, 0.0, -0.06] }
            to = { body = "shank", at = [0.01, 0.0, 0.03] }
            stiffness = 500.0
            rest = 0.11
            """ + SIDES.replace("legs.FL", "[legs]\nFL").replace("legs.", "")))  # fmt: skip
        springs = robot.settings.springs
        assert springs["biceps"].path == Joints({"knee": 0.02, "hip": -0.004})
        clutch = Clutch(engage="loaded", on_force=5.0, damper="joint", slip=90.0)
        assert springs["biceps"].clutch == clutch and springs["patella"].rest == 0.11
        leg = monopod(robot, "HL", locked=["boom_x"])
        assert leg.settings.springs == springs
        assert scaled_hopping(leg).springs == springs
        assert sagittal(robot).settings.springs["biceps"].stiffness == 16000.0

    def test_nothing(self, made):
        robot = load(made(""), base="free")
        assert robot.settings.springs == {} and robot.model == load(made(), base="free").model
        assert load("spear_ii").settings == Settings()


class TestArgumentsGoOver:
    SAID = BASE + 'toes = ["FL_foot", "FR_foot"]\nlocked = ["FL_swing"]\nmotors = ["FL_bend"]\n'

    def test_each(self, made):
        robot = load(made(self.SAID), ["HL_foot"], ["HR_bend"], base="fixed", motors=["HL_pitch"])
        assert (robot.toes, robot.locked, robot.actuated) == (("HL_foot",), ("HR_bend",), ("HL_pitch",))
        assert "base_vx" not in robot.coordinates and robot.options["base"] == "fixed"

    def test_none_at_all(self, made):
        robot = load(made(self.SAID), [], [])
        assert robot.toes == robot.locked == () and robot.actuated == ("FL_bend",)

    def test_legs_that_are_locked_or_left_out(self, made):
        path = made(BASE + SIDES + "\nsprings.knee.stiffness = 2.0\n")
        assert [(leg.name, leg.side) for leg in load(path, locked=["FL_bend"]).legs] == [
            ("FR", -1),
            ("HL", 1),
            ("HR", 1),
        ]
        assert [(leg.name, leg.side) for leg in load(path, ["HL_foot"]).legs] == [("HL", 1)]

    def test_options_are_what_was_said(self, made):
        assert dict(load(made(self.SAID)).options) == {}


class TestNamed:
    def said(self, tmp_path, text, name="mine.toml"):
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return path

    def test_a_urdf_from_its_folder(self, made, tmp_path):
        made()
        (tmp_path / "sub").mkdir()
        path = self.said(tmp_path / "sub", f'urdf = "../dog.urdf"\n{BASE}{SIDES}')
        robot = load(path)
        assert (robot.name, robot.source) == ("made", str(path)) and robot.legs[0].side == -1
        assert load(str(path)).model == robot.model

    def test_a_name(self, tmp_path):
        robot = load(self.said(tmp_path, 'robot = "spear_ii"\nlocked = ["boom_x"]'))
        assert robot.name == "spear_ii" and robot.model == load("spear_ii", locked=["boom_x"]).model
        assert robot.toes == ("toe",)

    def test_mjcf(self, tmp_path):
        body = '<body><joint name="a" axis="0 1 0"/><geom size="0.1" mass="1" pos="0 0 -1"/></body>'
        (tmp_path / "arm.xml").write_text(f"<mujoco><worldbody>{body}</worldbody></mujoco>", encoding="utf-8")
        robot = load(self.said(tmp_path, 'mjcf = "arm.xml"\nmotors.a = {ratio = 5.0, rotor_inertia = 1e-3}'))
        assert robot.gear_ratio("a") == 5.0 and robot.model.armature.tolist() == [0.025]

    def test_beside_a_file_it_may_name_that(self, made):
        assert load(made('urdf = "dog.urdf"\n' + BASE)).coordinates[0] == "base_vx"

    def test_its_urdf_is_exported(self, made, tmp_path):
        from spear_pin.model.srdf import to_srdf

        made()
        assert "FL" in to_srdf(load(self.said(tmp_path, f'urdf = "dog.urdf"\nmotors = "all"\n{BASE}{SIDES}')))


class TestKept:
    def test_by_copies(self, made):
        robot = load(made(BASE + SIDES + "\nsprings.knee.stiffness = 2.0\n"))
        again = pickle.loads(pickle.dumps(robot))
        assert again.settings == robot.settings and again.legs == robot.legs

    def test_a_knee_may_have_a_damper_alone(self, made):
        knee = load(made(BASE + SIDES + "\nsprings.knee.damping = 1.3\n")).settings.springs["FL_bend"]
        assert (knee.stiffness, knee.damping, knee.pulls) == (0.0, 1.3, False)

    @pytest.mark.parametrize("cut", [lambda robot: monopod(robot, "FL"), sagittal])
    def test_by_files(self, made, cut):
        robot = cut(
            load(made(BASE + SIDES + "\nsprings.knee.stiffness = 2.0\nmotors.knee.ratio = 8.0\nmotors.hip = {}"))
        )
        again = robot_of(origin(robot))
        assert unsaid(robot) == () and again.model == robot.model and again.settings == robot.settings

    def test_by_a_gait(self, made, tmp_path):
        leg = monopod(load(made(BASE + SIDES + "\nsprings.knee.stiffness = 2.0\n")), "HL", locked=["boom_x"])
        system = hopping(leg, HoppingLaw.scaled(leg), leg.settings.springs["knee"])
        gait = Gait(system, system.guess(), {}, 0.0, np.array([0.5 + 0j]), {"stance": 0.3, "flight": 0.2})
        again = Gait.load(gait.save(tmp_path / "hop.json")).system
        assert again.robot.settings == leg.settings and again.spring == Spring(2.0, 0.0)


WRONG = {
    "nothing = 1": "unknown key 'nothing'; valid: urdf, mjcf, robot, base, toes",
    "base = 'loose'": "base is 'loose'; expected 'free', 'chain' or 'fixed'",
    "base = true": "base is True",
    "toes = 'FL_foot'": "toes is 'FL_foot'; expected a list of names",
    "toes = ['FL_hoof']": "toes: unknown frame 'FL_hoof'; nearest of ",
    "locked = [1]": "locked is [1]; expected a list of names",
    "locked = ['FL_sway']": "locked: unknown joint 'FL_sway'; valid: base, FL_swing",
    "motors = 'knee'": "motors is 'knee'; expected 'all', a list of joints, or tables",
    "motors = ['FL_sway']": "motors: unknown joint 'FL_sway'; valid: FL_swing",
    "motors.elbow.ratio = 1": "motors: unknown joint 'elbow'; valid: abduction, hip, knee, all, FL_swing",
    "motors.knee = 3": "motors is {'knee': 3}; expected",
    "motors.knee.colour = 1": "unknown key 'motors.knee.colour'; valid: motors.knee.motor, motors.knee.ratio, ",
    "motors.knee.motor = 'ec_60'": "motors.knee.motor is 'ec_60'; expected one of spear_ii_knee",
    "motors.knee.ratio = '9'": "motors.knee.ratio is '9'; expected a number",
    "motors.knee.ratio = true": "motors.knee.ratio is True; expected a number",
    "motors.knee.ratio = 0": "motors.knee: Gearbox.ratio is 0; expected a number > 0",
    "motors.knee.ratio = nan": "motors.knee.ratio is nan",
    "motors.knee.ratio = 9.0": "motors.knee.ratio is 9.0; expected 8, which the robot's file has for 'FL_bend'",
    "motors.knee.rotor_inertia = 2e-4": "the rotor's inertia is 0.0002; expected 0.0001 kg·m², which the robot's",
    "motors.knee.motor = 'ec_60_flat_100w_48v'": "the rotor's inertia is 0.000121; expected 0.0001 kg·m²",
    "motors.knee.rotor_inertia = '1 g'": "motors.knee.rotor_inertia is '1 g'; expected a number, in kg·m²",
    "motors.knee.efficiency = 1.2": "motors.knee: Gearbox.efficiency is 1.2; expected a number in (0, 1]",
    "legs.FL.side = 2": "legs.FL.side is 2; expected 1 or -1",
    "legs.FL.side = 1.0": "legs.FL.side is 1.0; expected 1 or -1",
    "legs.LF.side = 1": "legs: unknown leg 'LF'; valid: FL, FR, HL, HR",
    "legs.FL = {}": "legs.FL is empty; expected side, or hip, knee, toe",
    "legs.FL.hip = 'FL_pitch'": "legs.FL has no knee; expected hip, knee, toe",
    "legs.FL = {hip = 'FL_pitch', knee = 'FL_bend', toe = 'FL_foot'}\nlegs.FR.side = 1": "legs.FR has no hip",
    "legs.FL = {hip = 'FL_sway', knee = 'FL_bend', toe = 'FL_foot'}": "legs.FL: unknown joint 'FL_sway'",
    "legs.FL = {hip = 'FR_pitch', knee = 'FL_bend', toe = 'FL_foot'}": "legs.FL: joints of FL is 'FR_pitch, FL_bend'",
    "legs.FL = {hip = 'FL_swing', knee = 'FL_bend', toe = 'FL_foot'}": "legs.FL: hip and knee of FL is 'FL_swing'",
    "legs.FL = {hip = 'FL_pitch', knee = 'FL_bend', toe = 'hoof'}": "toes: unknown frame 'hoof'",
    "toes = ['FR_foot']\n"
    "legs.FL = {hip = 'FL_pitch', knee = 'FL_bend', toe = 'FL_foot'}": "unknown toe 'FL_foot'; valid: FR_foot",
    "legs.A = {hip = 'FL_pitch', knee = 'FL_bend', toe = 'FL_foot'}\n"
    "legs.B = {hip = 'FL_pitch', knee = 'FL_bend', toe = 'FL_foot'}": "expected another hip for each leg",
    "pairs = ['FL', 'FR']": "pairs is ['FL', 'FR']; expected two pairs of legs, [[left, right], [left, right]]",
    "pairs = [['FL', 'FR'], ['HL', 'RH']]": "pairs: unknown leg 'RH'; valid: FL, FR, HL, HR",
    "pairs = [['FL', 'FR'], ['FL', 'FR']]": "['FL', 'FR']]; expected four different legs",
    "springs.hip = {stiffness = 1}": "springs: unknown knee 'hip'; valid: knee, ",
    "springs.knee = {path = {knee = 1.0}, stiffness = 1}": "springs.knee has a path; expected a name of its own",
    "springs.b = {path = 3, stiffness = 1}": "springs.b.path is 3; expected a table",
    "springs.b = {path = {knee = 0.0}, stiffness = 1}": "Joints.weights['knee'] is 0.0; expected a number other than",
    "springs.b = {from = {body = 'thigh', at = [0, 0, 0]}, stiffness = 1}": "expected path, or linkage, or sum,",
    "springs.b = {path = {knee = 1.0}}": "springs.b has no stiffness; expected a number > 0, in N/m",
    "springs.knee = {stiffness = 1, clutch = {delay = 1}}": "unknown key of clutch 'delay'; valid: on_delay,",
    "springs.knee = {stiffness = 1, clutch = {on_delay = -1}}": "Clutch.on_delay is -1; expected a number from 0",
    "springs.knee = {stiffness = 1, clutch = {engage = 'apex'}}": "Clutch.engage is 'apex'; expected 'touchdown' or",
    "springs.knee = {stiffness = 1, clutch = {slip = -1}}": "Clutch.slip is -1; expected a number >= 0",
    "springs.knee = {stiffness = 1, rest = 0.3, clutch = {}}": "None for a spring with a rest",
    "springs.knee = {}": "springs.knee has no stiffness; expected a number > 0, in N·m/rad, or a table",
    "springs.knee.stiffness = '2 N·m/rad'": "springs.knee.stiffness is '2 N·m/rad'; expected a number, in N·m/rad",
    "springs.knee.stiffness = -1": "springs.knee: Spring.stiffness is -1; expected a number from 0",
    "springs.knee = {stiffness = 1, rest = 4.0}": "springs.knee: Spring.rest is 4.0; expected within ±π rad",
    "springs.knee = {stiffness = 1, unilateral = 1}": "springs.knee.unilateral is 1; expected true or false",
    "springs.knee = {stiffness = 1, table = [[0, 0], [1, 1]]}": "springs.knee: Spring.stiffness is 1; expected 0 with",
    "springs.knee.table = [[0, 0], [1]]": "springs.knee.table is [[0, 0], [1]]; expected points [rad, N·m]",
    "springs.hip.stiffness = 1.0": "springs: unknown knee 'hip'; valid: knee, FL_bend, FR_bend, HL_bend, HR_bend",
    "springs = 3": "springs is 3; expected tables",
    "post = 3": "post is 3; expected a name",
    "post = 'mast'": "post: unknown joint 'mast'",
    "urdf = 'cat.urdf'": "names '",
    "robot = 'q_spear'": "names 'q_spear'; expected 'dog.urdf', the file next to it, or no robot",
    "robot = 'dog.urdf'": "robot is 'dog.urdf'; expected the name of a robot; a path is given by urdf or mjcf",
    "urdf = 'dog.urdf'\nmjcf = 'dog.urdf'": "mjcf is 'dog.urdf'; expected one key of urdf, mjcf, robot",
    "urdf = 3": "urdf is 3; expected a name",
    "base = ": "is not TOML: ",
    "base = 'free'\nbase = 'free'": "is not TOML: ",
    "toes = " + "[" * 9999: "is not TOML: ",
}


@pytest.mark.parametrize("text", WRONG, ids=lambda text: text[:40])
def test_refused(made, text):
    path = made(text)
    error = refusal(BadFile, lambda: load(path, base="free"))
    assert str(error).startswith(f"{path.with_suffix('.toml')}: ") and WRONG[text] in str(error)


class TestRefused:
    def test_side_that_the_limits_leave_no_room(self, made):
        path = made("legs.FL.side = -1", knee_limits=(0.0, 2.5))
        assert "legs.FL.side is -1; expected 1: 'FL_bend' turns from 0 to 2.5 rad" in str(
            refusal(BadFile, lambda: load(path, base="free"))
        )

    def test_motor_without_numbers(self, made):
        path = made("motors.knee.motor = 'ec_60_flat_150w'", motors=False)
        assert "motors.knee has no ratio, nor has the robot's file" in str(
            refusal(BadFile, lambda: load(path, base="free"))
        )
        path = made("motors.knee = {motor = 'ec_60_flat_150w', ratio = 3.0}", motors=False)
        assert "has no rotor_inertia, and that of ec_60_flat_150w is unknown" in str(
            refusal(BadFile, lambda: load(path, base="free"))
        )

    def test_negative_rotor(self, made):
        path = made("motors.knee = {ratio = 3.0, rotor_inertia = -1e-4}", motors=False)
        assert "rotor_inertia is -0.0001; expected a number >= 0" in str(
            refusal(BadFile, lambda: load(path, base="free"))
        )

    @pytest.mark.parametrize("text", ["", "base = 'free'"])
    def test_no_robot(self, tmp_path, text):
        path = tmp_path / "mine.toml"
        path.write_text(text)
        assert "names no robot; expected one key of urdf, mjcf, robot" in str(refusal(BadFile, lambda: load(path)))

    def test_robot_that_is_not_there(self, tmp_path):
        (tmp_path / "mine.toml").write_text("robot = 'q_speer'")
        with pytest.raises(SpearError, match="unknown robot 'q_speer'"):
            load(tmp_path / "mine.toml")
        (tmp_path / "mine.toml").write_text("urdf = 'none.urdf'")
        with pytest.raises(BadFile, match="none.urdf"):
            load(tmp_path / "mine.toml")

    @pytest.mark.parametrize("content", [b"\xff\xfe", b"\x00", b"a = 1" + b" " * 1_000_001])
    def test_other_content(self, tmp_path, content):
        (tmp_path / "mine.toml").write_bytes(content)
        refusal(BadFile, lambda: load(tmp_path / "mine.toml"))

    def test_missing_and_folder(self, tmp_path):
        refusal(BadFile, lambda: load(tmp_path / "none.toml"))
        (tmp_path / "folder.toml").mkdir()
        refusal(BadFile, lambda: load(tmp_path / "folder.toml"))


def test_shipped_robots_with_such_a_file_are_those_of_others():
    with_file = {name for name, shipped in ROBOTS.items() if shipped.path.with_suffix(".toml").exists()}
    said = {name for name in ROBOTS if load(name).settings.path}
    assert with_file == said == {"hoppy", "hoppy_leg", "mups_v2", "crank_hopper", "minitaur_leg"}
