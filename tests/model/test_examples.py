"""Robots of example-robot-data by their names: found where it is installed, told where not."""

import warnings

import pytest

from spear_pin import RobotWarning, load
from spear_pin.errors import UnknownName
from spear_pin.model import examples
from spear_pin.viz.playback.looks import read_looks
from tests.cli.calls import printed, run
from tests.model.planar_arm import ARM
from tests.model.queries import refusal

PARTS = ("arm_description/urdf/arm.urdf", "leg_b_description/urdf/leg.urdf", "leg_c_data/robots/leg.urdf")


class Installed:
    """A package with three robots, of which two files are called the same."""

    version = "9.9"

    def __init__(self, folder):
        self.folder = folder

    def locate_file(self, name):
        return self.folder / name


@pytest.fixture
def installed(tmp_path, monkeypatch):
    for part in PARTS:
        path = tmp_path / examples.FOLDER / part
        path.parent.mkdir(parents=True)
        path.write_text(ARM)
    monkeypatch.setattr(examples, "distribution", lambda name: Installed(tmp_path))
    examples.example_robots.cache_clear()
    yield tmp_path / examples.FOLDER
    examples.example_robots.cache_clear()


@pytest.fixture
def missing(monkeypatch):
    def none(name):
        raise examples.PackageNotFoundError(name)

    monkeypatch.setattr(examples, "distribution", none)
    examples.example_robots.cache_clear()
    yield
    examples.example_robots.cache_clear()


def test_names(installed):
    paths = {"arm": installed / PARTS[0], "leg_b": installed / PARTS[1], "leg_c": installed / PARTS[2]}
    assert examples.example_robots() == paths


def test_load(installed):
    robot = load("arm", toes=["lower"])
    assert (robot.name, robot.source, robot.nv, robot.toes) == ("arm", "arm", 2, ("lower",))
    assert load("leg_c").name == "leg_c"


def test_its_shapes_are_drawn(installed):
    path = installed / PARTS[0]
    box = '<link name="base"><visual><geometry><box size="1 1 1"/></geometry></visual></link>'
    path.write_text(ARM.replace('<link name="base"/>', box))
    assert [shape.kind for shape in read_looks(load("arm")).shapes].count("box") == 1


def test_a_shipped_robot_goes_before(installed):
    (installed / "spear_description/urdf").mkdir(parents=True)
    (installed / "spear_description/urdf/spear_ii.urdf").write_text(ARM)
    examples.example_robots.cache_clear()
    assert load("spear_ii").nv == 4


def test_unknown_name_lists_them(installed):
    assert {"arm", "leg_b", "leg_c"} < set(refusal(UnknownName, lambda: load("solo12")).valid)


def test_a_name_may_end_before_an_underscore_where_that_leaves_one(installed):
    for part in ("dog_b_simple_description/urdf/dog_b_simple.urdf", "dog_c_description/urdf/dog_c.urdf"):
        (installed / part).parent.mkdir(parents=True)
        (installed / part).write_text(ARM)
    examples.example_robots.cache_clear()
    robot = load("dog_b")
    assert (robot.name, robot.source) == ("dog_b_simple", "dog_b_simple")
    assert refusal(UnknownName, lambda: load("dog")).valid == ("dog_b_simple", "dog_c")
    for name in ("dog_b_", "dog_b_s", "do", "", "spear"):
        assert "arm" in refusal(UnknownName, lambda name=name: load(name)).valid


def test_outline(installed):
    assert examples.outline(installed / PARTS[0]) == (3, 2, 3.0)


def test_they_are_listed(installed, capsys):
    rows = {row["name"]: row for row in printed(capsys, "robots")["robots"]}
    assert rows["leg_b"]["degrees_of_freedom"] == 2 and rows["leg_b"]["mass"] == 3.0
    assert rows["leg_b"]["source"] == "example-robot-data 9.9"
    status, out, err = run(capsys, "robots")
    assert status == 0 and err == "" and "leg_c" in out


def test_the_extra_is_named_where_it_is_missing(missing):
    assert "with the extra 'robots' one of example-robot-data" in str(refusal(UnknownName, lambda: load("solo12")))


@pytest.mark.extra("example-robot-data")
class TestInstalled:
    @pytest.mark.parametrize(
        ("name", "feet", "notes"),
        [
            ("solo12", "{}_FOOT", ["not taken over: <contact> in <link> of 'base_link'"]),
            ("a1", "{}_foot", []),
            ("go1", "{}_foot", ["link 'base' has an inertia", "not taken over: friction in <dynamics>"]),
        ],
    )
    def test_quadruped(self, name, feet, notes):
        toes = [feet.format(leg) for leg in ("FL", "FR")]
        with warnings.catch_warnings(record=True) as caught:
            warnings.simplefilter("always", RobotWarning)
            robot = load(name, toes=toes, base="free", motors="all")
        assert len(caught) == len(notes)
        assert all(note in str(each.message) for note, each in zip(notes, caught, strict=True))
        assert (robot.name, robot.nv, robot.nu, robot.toes) == (name, 18, 12, tuple(toes))

    def test_an_outline_is_that_of_the_robot(self):
        robot = load("solo12", base="fixed", motors="all")
        found = examples.outline(examples.example_robots()["solo12"])
        assert found.degrees_of_freedom == robot.nv and found.mass == pytest.approx(robot.mass)
