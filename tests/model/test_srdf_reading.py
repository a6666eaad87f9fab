"""Postures of the SRDF that goes with a URDF: which file it is, and what is taken of it."""

import warnings

import numpy as np
import pytest

from spear_pin import RobotWarning, load
from spear_pin.model.srdf_reading import srdf_of
from tests.model.legged import quadruped

JOINT = '<joint name="{}" value="{}"/>'
STATE = '<group_state name="{}" group="all">{}</group_state>'
NO_VALUE = '<joint name="FL_bend"/>'
BOTH_WAYS = (-2.6, 2.6)  # rad: limits of knees that tell nothing


def srdf(**states):
    """An SRDF of postures, each of values by joints."""
    inside = (
        STATE.format(name, "".join(JOINT.format(*each) for each in posture.items())) for name, posture in states.items()
    )
    return f'<?xml version="1.0"?><robot name="made">{"".join(inside)}</robot>'


def knees(**sides):
    return {f"{leg}_bend": side for leg, side in sides.items()}


@pytest.fixture
def urdf(tmp_path):
    """A quadruped of which the limits do not tell where its knees point, in a folder "urdf" of its own."""
    path = tmp_path / "urdf" / "made.urdf"
    path.parent.mkdir()
    path.write_text(quadruped(knee_limits=BOTH_WAYS), encoding="utf-8")
    return path


@pytest.fixture(params=["made.srdf", "../srdf/made.srdf", "../srdf/another.srdf"])
def place(urdf, request):
    """A place of the SRDF, its folder there."""
    path = (urdf.parent / request.param).resolve()
    path.parent.mkdir(exist_ok=True)
    return path


def said(path, **options):
    """A robot, and what loading it said."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always", RobotWarning)
        robot = load(path, **options)
    return robot, [str(each.message) for each in caught]


def sides(robot):
    return {leg.name: leg.side for leg in robot.legs}


class TestPlace:
    def test_none(self, urdf):
        assert srdf_of(urdf) is None
        assert sides(load(urdf)) == dict.fromkeys(("FL", "FR", "HL", "HR"), 0)

    def test_found(self, urdf, place):
        place.write_text(srdf(), encoding="utf-8")
        assert srdf_of(urdf).resolve() == place

    def test_beside_goes_before(self, urdf):
        folder = urdf.parents[1] / "srdf"
        folder.mkdir()
        for path in (folder / "made.srdf", folder / "another.srdf"):
            path.write_text(srdf(), encoding="utf-8")
        assert srdf_of(urdf) == folder / "made.srdf"
        urdf.with_suffix(".srdf").write_text(srdf(), encoding="utf-8")
        assert srdf_of(urdf) == urdf.with_suffix(".srdf")

    def test_of_several_of_other_names_none_is_chosen(self, urdf):
        folder = urdf.parents[1] / "srdf"
        folder.mkdir()
        for name in ("one", "two"):
            (folder / f"{name}.srdf").write_text(srdf(), encoding="utf-8")
        assert srdf_of(urdf) is None


class TestPostures:
    def test_tell_where_knees_point(self, urdf, place):
        place.write_text(srdf(standing=knees(FL=-1.2, FR=-1.2, HL=1.2, HR=1.2)), encoding="utf-8")
        robot, notes = said(urdf)
        assert sides(robot) == {"FL": -1, "FR": -1, "HL": 1, "HR": 1} and notes == []

    def test_that_disagree_tell_nothing(self, urdf):
        text = srdf(one=knees(FL=-1.2, HL=1.2), other=knees(FL=1.2, HL=0.8))
        urdf.with_suffix(".srdf").write_text(text, encoding="utf-8")
        assert sides(load(urdf)) == {"FL": 0, "FR": 0, "HL": 1, "HR": 0}

    def test_do_not_go_over_limits(self, urdf):
        urdf.write_text(quadruped(knee_limits=(-0.1, 2.5)), encoding="utf-8")
        urdf.with_suffix(".srdf").write_text(srdf(odd=knees(FL=-0.5)), encoding="utf-8")
        assert sides(load(urdf))["FL"] == 1

    def test_are_configurations_of_the_model(self, urdf):
        posture = {"FL_bend": 0.7, "FL_pitch": -0.4, "base": "0 0 0.4 0 0 0 1", "gripper": 0.3}
        urdf.with_suffix(".srdf").write_text(srdf(bent=posture), encoding="utf-8")
        with pytest.warns(RobotWarning, match="no joint of one degree of freedom: 'base', 'gripper' in <group_state>"):
            robot = load(urdf)
        q = dict(zip(robot.model.names, [0.0] * robot.model.njoints, strict=True))
        found = robot.model.referenceConfigurations["bent"]
        for name in list(q)[2:]:
            joint = robot.model.joints[robot.model.getJointId(name)]
            assert found[joint.idx_q] == {"FL_bend": 0.7, "FL_pitch": -0.4}.get(name, 0.0)
        np.testing.assert_array_equal(found[:7], [0, 0, 0, 0, 0, 0, 1])  # a base is not a joint's posture

    def test_stay_with_what_is_locked_and_floats(self, urdf):
        urdf.write_text(quadruped(float_base=False, knee_limits=BOTH_WAYS), encoding="utf-8")
        urdf.with_suffix(".srdf").write_text(srdf(standing=knees(FL=-1.2, HL=1.2)), encoding="utf-8")
        robot = load(urdf, base="free", locked=["FL_swing"])
        assert robot.model.referenceConfigurations["standing"].size == robot.nq
        assert sides(robot) == {"FL": -1, "FR": 0, "HL": 1, "HR": 0}


class TestWrong:
    @pytest.mark.parametrize(
        ("text", "part"),
        [
            ("<robot><group_state>", "not well-formed XML"),
            (srdf(standing={"FL_bend": "bent"}), "'bent'"),
            (srdf(standing={"FL_bend": "nan"}), "'nan'"),
            (srdf(standing={"FL_bend": "1 2"}), "'1 2'"),
            (f"<robot>{STATE.format('standing', NO_VALUE)}</robot>", "no value"),
            ('<!DOCTYPE robot [<!ENTITY a "b">]><robot/>', "document type"),
        ],
    )
    def test_it_is_left_out_and_said(self, urdf, text, part):
        path = urdf.with_suffix(".srdf")
        path.write_text(text, encoding="utf-8")
        robot, notes = said(urdf)
        assert len(robot.model.referenceConfigurations) == 0 and sides(robot)["FL"] == 0
        assert len(notes) == 1 and notes[0].startswith("made: its SRDF is left out: ")
        assert part in notes[0] and path.name in notes[0] and "\n" not in notes[0]

    def test_nothing_is_taken_of_one_that_is_wrong_further_down(self, urdf):
        text = srdf(standing=knees(FL=1.2), odd={"FL_bend": "x"})
        urdf.with_suffix(".srdf").write_text(text, encoding="utf-8")
        assert len(said(urdf)[0].model.referenceConfigurations) == 0

    def test_a_folder_is_none(self, urdf):
        urdf.with_suffix(".srdf").mkdir()
        assert srdf_of(urdf) is None and said(urdf)[1] == []


@pytest.mark.extra("example-robot-data")
@pytest.mark.parametrize("name", ["solo12", "anymal_b_simple", "anymal_c_simple", "a1", "go2", "hyq_no_sensors"])
@pytest.mark.filterwarnings("ignore::spear_pin.RobotWarning")
def test_of_known_robots_every_knee_is_told(name):
    assert 0 not in sides(load(name, base="free", motors="all")).values()
