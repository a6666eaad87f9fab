"""What an MJCF file may include, and what of one is refused."""

import os

import numpy as np
import pytest

from spear_pin import load
from spear_pin.errors import BadFile
from tests.model.mjcf_made import DOG, LEG, edited, load_quietly, one_body
from tests.model.queries import refusal


class TestFiles:
    SCENE = '<mujoco model="scene"><include file="dog.xml"/><worldbody><geom type="plane"/></worldbody></mujoco>'

    def test_scene(self, write_xml):
        write_xml(DOG)
        assert load(write_xml(self.SCENE, "scene.xml")).nv == 12

    def test_included_defaults(self, write_xml):
        write_xml('<mujocoinclude><default><joint armature="0.7"/></default></mujocoinclude>', "d.xml")
        robot = load(write_xml(edited(LEG, "<worldbody>", '<include file="d.xml"/><worldbody>')))
        np.testing.assert_array_equal(robot.model.armature, [0.7, 0.7])

    @pytest.mark.parametrize("name", ["../dog.xml", "/etc/passwd", "inside/../../dog.xml", "link.xml", ""])
    def test_nothing_is_read_elsewhere(self, write_xml, tmp_path, name):
        write_xml(DOG)
        (tmp_path / "inside").mkdir()
        os.symlink(tmp_path / "dog.xml", tmp_path / "inside/link.xml")
        path = write_xml(self.SCENE.replace("dog.xml", name), "inside/scene.xml")
        problem = refusal(BadFile, lambda: load(path)).problem
        assert "not in its folder" in problem or "directory" in problem

    @pytest.mark.parametrize("name", ["scene.xml", "a.xml"])
    def test_loops(self, write_xml, name):
        write_xml(self.SCENE.replace("dog.xml", name), "a.xml")
        path = write_xml(self.SCENE.replace("dog.xml", "a.xml"), "scene.xml")
        assert "again" in refusal(BadFile, lambda: load(path)).problem

    def test_nested_deep(self, write_xml):
        levels = "<default class='c{}'>" * 100
        for i in range(9):
            more = f'<include file="{i + 1}.xml"/>' if i < 8 else ""
            classes = levels.format(*range(100 * i, 100 * i + 100))
            write_xml(f"<mujocoinclude>{classes}{more}{'</default>' * 100}</mujocoinclude>", f"{i}.xml")
        path = write_xml('<mujoco><default><include file="0.xml"/></default></mujoco>', "scene.xml")
        assert "nested deeper" in refusal(BadFile, lambda: load(path)).problem

    def test_missing(self, write_xml):
        path = write_xml(self.SCENE.replace("<include", "\n<include"), "scene.xml")
        error = refusal(BadFile, lambda: load(path))
        assert str(error).startswith(f"{path}:2: includes 'dog.xml'") and "No such file" in error.problem

    def test_place_in_what_is_included(self, write_xml):
        dog = write_xml(edited(DOG, 'axis="1 0 0"', 'axis="0 0 0"'))
        error = refusal(BadFile, lambda: load(write_xml(self.SCENE, "scene.xml")))
        line = DOG[: DOG.index('axis="1 0 0"')].count("\n") + 1
        assert (error.path, error.line) == (str(dog), line)

    def test_included_by_what_is_included(self, write_xml):
        inner = write_xml('<mujocoinclude>\n<include file="gone.xml"/></mujocoinclude>', "inner.xml")
        path = write_xml(self.SCENE.replace("dog.xml", "inner.xml"), "scene.xml")
        error = refusal(BadFile, lambda: load(path))
        assert (error.path, error.line) == (str(inner), 2) and "'gone.xml'" in error.problem

    @pytest.mark.parametrize(
        "start", ["<!DOCTYPE mujoco>", '<!DOCTYPE mujoco [<!ENTITY a SYSTEM "file:///etc/passwd">]>']
    )
    def test_entities(self, write_xml, start):
        path = write_xml(start + LEG)
        assert "document type" in refusal(BadFile, lambda: load(path)).problem
        write_xml(self.SCENE, "scene.xml")
        write_xml(start + DOG)
        assert "document type" in refusal(BadFile, lambda: load(path.parent / "scene.xml")).problem


class TestRefused:
    @pytest.mark.parametrize(
        ("old", "new", "says"),
        [
            ('mass="1"', 'mass="-1"', "mass '-1'"),
            ('mass="1"', 'mass="heavy"', "'heavy'"),
            ('diaginertia="0.1', 'diaginertia="-0.1', "positive semidefinite"),
            ('damping="0.3"', 'type="screw"', "valid: free, ball, slide, hinge"),
            ('axis="0 1 0"', 'axis="0 nan 0"', "'nan'"),
            ("<worldbody>", '<compiler coordinate="global"/><worldbody>', "global coordinates"),
            ('<body name="shank"', '<frame/><body name="shank"', "<frame>"),
            ("<worldbody>", '<worldbody><replicate count="3"/>', "<replicate>"),
            ("worldbody>", "world>", "no <body>"),
            ("<worldbody>", "<default><default/></default><worldbody>", "no class"),
            ("<worldbody>", '<option gravity="0 0"/><worldbody>', "gravity"),
        ],
    )
    def test_fault(self, write_xml, old, new, says):
        text = LEG.replace(old, new) if old == "worldbody>" else edited(LEG, old, new)
        path = write_xml(text)
        assert says in str(refusal(BadFile, lambda: load(path)))

    def test_motor_of_a_ball(self, write_xml):
        text = edited(DOG, '<motor name="a" joint="hip_x"', '<motor name="a" joint="tail"')
        assert load_quietly(write_xml(text)).actuated == ("knee",)

    def test_too_many_bodies(self, write_xml):
        text = edited(LEG, '<body name="shank"', "<body/>" * 600 + '<body name="shank"')
        assert "500 bodies" in refusal(BadFile, lambda: load(write_xml(text))).problem


@pytest.mark.parametrize(
    ("parts", "problem"),
    [
        ({"joint": 'class="typo"'}, "there is no class 'typo'"),
        (
            {"geom": '<geom size="0.1"/><body><joint name="j"/><geom size="0.1"/></body>'},
            "joint 'j' is defined 2 times",
        ),
        ({"geom": '<geom size="0.1"/><body><joint name="universe"/><geom size="0.1"/></body>'}, "Pinocchio's name"),
    ],
)
def test_names_that_mislead_are_refused(tmp_path, parts, problem):
    with pytest.raises(BadFile, match=problem):
        load(one_body(tmp_path, **parts), motors="all")
