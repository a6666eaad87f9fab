"""Gaits on disk, and parameters by name."""

import json
import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, Gait, HoppingLaw, Spring, hopping, load, monopod, simulate, vary
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.gaits.gait import springs_data, springs_of
from spear_pin.hybrid.brakes import Brake, with_brakes
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import change_system, limits, parameter, with_hardware, with_numbers, with_parameters
from spear_pin.hybrid.periodic import residual
from spear_pin.model.boom import on_rotary_boom
from spear_pin.studies.hardware import Rig
from tests.slow import slow_but
from tests.walkers import example


def of_a_model(robot):
    return load(robot.model, ["toe"], motors=["hip", "knee"], base="fixed")


def heavier(robot):
    model = robot.model.copy()
    model.damping[0] = 1.0
    return robot.with_model(model)


class TestSaveAndLoad:
    @pytest.mark.parametrize("name", slow_but(["hop", "free_hop"], "hop"))
    def test_rebuilds_the_same_gait(self, tmp_path, name, request):
        gait = request.getfixturevalue(name)
        path = gait.save(tmp_path / "hop.json")
        again = Gait.load(path)
        for part in ("kind", "law", "spring", "contact", "section", "cyclic"):
            assert getattr(again.system, part) == getattr(gait.system, part)
        assert again.system.robot.coordinates == gait.system.robot.coordinates
        assert again.system.robot.toes == gait.system.robot.toes
        np.testing.assert_array_equal(again.state[0], gait.state[0])
        np.testing.assert_array_equal(again.state[1], gait.state[1])
        np.testing.assert_array_equal(again.multipliers, gait.multipliers)
        assert again.multipliers.dtype == gait.multipliers.dtype == np.complex128
        assert again.residual == gait.residual
        assert dict(again.parameters) == dict(gait.parameters)
        assert dict(again.durations) == dict(gait.durations)
        assert residual(again.system, again.state) <= 1e-9

    def test_keeps_what_is_not_the_default(self, tmp_path, robot, hop):
        law = HoppingLaw(knee_touchdown=0.9, hip_touchdown=0.41, hold_extension=True, minimum_force=5.0)
        system = hopping(robot, law, Spring(50.0, 1.1, unilateral=False), Contact(0.55))
        gait = Gait(system, hop.state, {"stiffness": 50.0}, 1e-3, np.array([0.5 + 0.25j, -2.0]), {"stance": 0.3})
        again = Gait.load(gait.save(tmp_path / "hop.json"))
        assert (again.system.law, again.system.spring, again.system.contact) == (law, system.spring, system.contact)
        assert again.parameters == {"stiffness": 50.0} and again.durations == {"stance": 0.3}

    @pytest.mark.parametrize("name", ["hop", "least_effort"])
    def test_keeps_the_limits(self, tmp_path, hop, name):
        gait = hop if name == "hop" else Gait.load(name)
        own = replace(gait, system=replace(gait.system, shortest_flight=0.01, phase_limit=3.5))
        again = Gait.load(own.save(tmp_path / "own.json")).system
        assert (again.shortest_flight, again.phase_limit) == (0.01, 3.5)
        plain = Gait.load(gait.save(tmp_path / "plain.json")).system
        assert limits(plain) == limits(gait.system)

    @pytest.mark.parametrize(
        ("change", "named"),
        [
            (lambda system: with_hardware(system, Rig().on(system.robot)), "hardware"),
            (lambda system: hopping(of_a_model(system.robot)), "a robot that was no file"),
            (lambda system: hopping(monopod(of_a_model(system.robot), "leg")), "a robot that was no file"),
            (lambda system: hopping(heavier(system.robot), system.law), "another model than its file"),
            (lambda system: with_dry_friction(system, {"boom_z": 1.0}), "dry friction of joints"),
            (lambda system: hopping(on_rotary_boom(system.robot), system.law), "a robot with added inertia"),
            (lambda system: change_system(system, lambda built: built), "a change of its own"),
            (lambda system: with_brakes(system, {"knee": Brake(50.0, ("flight",))}), "brakes"),
            (lambda system: replace(system, cyclic=("boom_z",)), "another cyclic"),
        ],
    )
    def test_refuses_what_it_cannot_keep(self, tmp_path, hop, change, named):
        with pytest.raises(BadValue, match=f"^gait.system is 'one with {named}'; expected one without"):
            replace(hop, system=change(hop.system)).save(tmp_path / "hop.json")
        assert not list(tmp_path.iterdir())

    def test_keeps_a_robot_that_was_cut_out_of_another(self, tmp_path):
        """Cut again, it moves as it did, bit for bit."""
        leg = vary(monopod(load("q_spear_full"), "posterior_left", locked=["boom_x"]), knee_ratio=14.0)
        system = hopping(leg, HoppingLaw.scaled(leg), Spring.scaled(leg))
        gait = Gait(system, system.guess(), {}, 1e-3, np.array([0.5 + 0j]), {"stance": 0.3, "flight": 0.2})
        path = gait.save(tmp_path / "hop.json")
        again = Gait.load(path)
        assert again.system.robot.model == leg.model and again.system.robot.cut == leg.cut
        one, other = (simulate(each.system, each.state) for each in (gait, again))
        np.testing.assert_array_equal(one.q, other.q)
        data = json.loads(path.read_text())
        data["robot"]["cut"]["of"]["source"] = "spear_ii"
        path.write_text(json.dumps(data))
        with pytest.raises(BadFile, match="hop.json: is not a saved gait"):
            Gait.load(path)
        assert Gait.load(again.save(tmp_path / "again.json")).system.robot.varied == {"knee_ratio": 14.0}

    def test_keeps_numbers_of_bodies(self, tmp_path, hop):
        heavy = replace(hop, system=with_numbers(hop.system, {"knee_mass": 0.7}))
        again = Gait.load(heavy.save(tmp_path / "hop.json")).system.robot
        assert again.model == heavy.system.robot.model != hop.system.robot.model and again.varied == {"knee_mass": 0.7}

    def test_keeps_that_there_is_no_spring(self):
        assert springs_of(springs_data(example().rimless_wheel())) == {}

    def test_path_may_be_text(self, tmp_path, hop):
        path = hop.save(str(tmp_path / "hop.json"))
        assert Gait.load(str(path)).residual == hop.residual

    def test_the_same_bytes_again(self, tmp_path, hop):
        first = hop.save(tmp_path / "one.json").read_bytes()
        assert hop.save(tmp_path / "two.json").read_bytes() == first
        assert Gait.load(tmp_path / "one.json").save(tmp_path / "three.json").read_bytes() == first

    def test_into_a_missing_folder(self, tmp_path, hop):
        with pytest.raises(BadFile, match="cannot be written"):
            hop.save(tmp_path / "missing" / "hop.json")


def without(*names):
    def damage(data):
        for name in names[:-1]:
            data = data[name]
        del data[names[-1]]

    return damage


def with_value(value, *names):
    def damage(data):
        for name in names[:-1]:
            data = data[name]
        data[names[-1]] = value

    return damage


DAMAGE = {
    "no format": without("format"),
    "another format": with_value("spear_pin gait 0", "format"),
    "no kind": without("kind"),
    "another kind": with_value("bounding", "kind"),
    "no robot": without("robot"),
    "an unknown robot": with_value("spear_iii", "robot", "source"),
    "a robot that is gone": with_value("/missing/robot.urdf", "robot", "source"),
    "an unknown toe": with_value(["hoof"], "robot", "toes"),
    "an unknown joint": with_value(["boom_y"], "robot", "locked"),
    "an unknown field": with_value(1.0, "law", "colour"),
    "a negative stiffness": with_value(-1.0, "spring", "stiffness"),
    "no friction": with_value(0.0, "contact", "friction"),
    "text for a number": with_value("fast", "law", "frequency"),
    "no state": without("state"),
    "a short state": with_value([0.5, 0.5], "state", "q"),
    "a state of text": with_value(["a", "b", "c"], "state", "v"),
    "a state that is not finite": with_value([math.nan, 0.0, 0.0], "state", "v"),
    "multipliers of one part": with_value([0.5], "multipliers"),
    "no residual": without("residual"),
    "a list for the robot": with_value([1, 2], "robot"),
    "a number for the law": with_value(3, "law"),
    "an unknown part": with_value(1.0, "colour"),
    "an unknown field of the robot": with_value("red", "robot", "colour"),
    "an unknown coordinate": with_value([0.0], "state", "x"),
    "a name for the toes": with_value("toe", "robot", "toes"),
    "a number for a toe": with_value([1], "robot", "toes"),
    "a number for the robot's name": with_value(1, "robot", "source"),
    "numbers for what varies": with_value([1.0], "robot", "varied"),
    "a truth value for a number": with_value(True, "law", "stance_torque"),
    "a truth value for stiffness": with_value(True, "spring", "stiffness"),
    "a number for a truth value": with_value(1, "spring", "unilateral"),
    "text for a truth value": with_value("no", "law", "hold_extension"),
    "a state of quoted numbers": with_value(["0.5", "0.5", "0.5"], "state", "q"),
    "a state of truth values": with_value([True, True, True], "state", "q"),
    "a state in a list": with_value([[0.5, 0.5, 0.5]], "state", "q"),
    "a state of infinite numbers": with_value([math.inf, 0.0, 0.0], "state", "v"),
    "a state far too large": with_value([10**400, 0.0, 0.0], "state", "v"),
    "parameters in a list": with_value([7.8], "parameters"),
    "an unknown parameter": with_value(1.0, "parameters", "colour"),
    "a parameter that is text": with_value("7.8", "parameters", "stance_torque"),
    "a residual that is text": with_value("0.0", "residual"),
    "a residual below 0": with_value(-1.0, "residual"),
    "a residual that is not finite": with_value(math.nan, "residual"),
    "no multipliers": with_value([], "multipliers"),
    "multipliers by name": with_value({"0": [0.5, 0.0]}, "multipliers"),
    "multipliers as text": with_value(["12"], "multipliers"),
    "multipliers that are not finite": with_value([[math.nan, 0.0]], "multipliers"),
    "multipliers of three parts": with_value([[0.5, 0.0, 0.0]], "multipliers"),
    "durations in a list": with_value([0.3, 0.2], "durations"),
    "a duration below 0": with_value(-0.1, "durations", "stance"),
    "a duration that is text": with_value("0.3", "durations", "stance"),
    "an unknown limit": with_value(1.0, "limits", "colour"),
    "limits in a list": with_value([5.0], "limits"),
    "a limit that is text": with_value("5.0", "limits", "phase_limit"),
    "a limit below 0": with_value(-0.1, "limits", "shortest_flight"),
    "a duration of no phase": with_value(0.1, "durations", "swing"),
}


class TestDamagedFiles:
    @pytest.mark.parametrize("damage", DAMAGE)
    def test_refused(self, tmp_path, hop, damage):
        path = hop.save(tmp_path / "hop.json")
        data = json.loads(path.read_text())
        DAMAGE[damage](data)
        path.write_text(json.dumps(data))
        with pytest.raises(BadFile, match=r"hop\.json") as error:
            Gait.load(path)
        assert "\n" not in str(error.value)

    @pytest.mark.parametrize(
        "content",
        [b"", b"{", b"[]", b"3", b'"hop"', b"null", b"[" * 99999, b'{"a":' * 99999, b"\xff\xfe\x00", b"PK\x03\x04"],
    )
    def test_other_content(self, tmp_path, content):
        path = tmp_path / "hop.json"
        path.write_bytes(content)
        with pytest.raises(BadFile, match=r"hop\.json"):
            Gait.load(path)

    def test_a_field_twice(self, tmp_path, hop):
        path = hop.save(tmp_path / "hop.json")
        path.write_text(path.read_text().replace('"residual"', '"kind": "hopping",\n "residual"'))
        with pytest.raises(BadFile, match="the key 'kind' is there twice"):
            Gait.load(path)

    @pytest.mark.parametrize(
        ("damage", "part"),
        [
            ("a state that is not finite", "NaN is no finite number"),
            ("a state of quoted numbers", r"state\.q is \['0.5', '0.5', '0.5'\]; expected 3 numbers"),
            ("a short state", r"state\.q is \[0.5, 0.5\]; expected 3 numbers"),
            ("no residual", "there is no field 'residual'"),
            ("an unknown part", "there is an unknown field 'colour'"),
            ("a duration of no phase", "there is an unknown phase 'swing'"),
            ("an unknown parameter", "unknown parameter 'colour'"),
            ("an unknown limit", "there is an unknown limit 'colour'"),
            ("a limit below 0", r"limits is .*; expected >= 0"),
        ],
    )
    def test_says_what_is_wrong(self, tmp_path, hop, damage, part):
        path = hop.save(tmp_path / "hop.json")
        data = json.loads(path.read_text())
        DAMAGE[damage](data)
        path.write_text(json.dumps(data))
        with pytest.raises(BadFile, match=part):
            Gait.load(path)

    def test_what_is_too_long_is_cut_short(self, tmp_path, hop):
        path = hop.save(tmp_path / "hop.json")
        path.write_text(json.dumps(json.loads(path.read_text()) | {"parameters": {"a": "b" * 10**6}}))
        with pytest.raises(BadFile) as error:
            Gait.load(path)
        assert len(str(error.value)) < 500

    def test_from_before_a_field(self, tmp_path, hop):
        """What a field that the file lacks was before there was such a field is its default."""
        path = hop.save(tmp_path / "hop.json")
        data = json.loads(path.read_text())
        del data["law"]["virtual_stiffness"], data["spring"]["rest"], data["robot"]["varied"], data["limits"]
        path.write_text(json.dumps(data))
        system = Gait.load(path).system
        assert system.law == hop.system.law and limits(system) == limits(hop.system)

    def test_cut_anywhere(self, tmp_path, hop):
        path = hop.save(tmp_path / "hop.json")
        whole = path.read_text()
        for length in range(0, len(whole) - 2, 37):
            path.write_text(whole[:length])
            with pytest.raises(BadFile):
                Gait.load(path)

    def test_missing(self, tmp_path):
        with pytest.raises(BadFile, match="cannot be read"):
            Gait.load(tmp_path / "missing.json")

    def test_a_folder(self, tmp_path):
        with pytest.raises(BadFile, match="cannot be read"):
            Gait.load(tmp_path)


class TestProperties:
    def test_period(self, hop):
        assert hop.period == pytest.approx(hop.durations["stance"] + hop.durations["flight"], rel=1e-15)

    @pytest.mark.parametrize(("multiplier", "stable"), [(0.9, True), (-0.9, True), (0.6 + 0.7j, True), (-1.1, False)])
    def test_stable(self, hop, multiplier, stable):
        gait = Gait(hop.system, hop.state, {}, 0.0, np.array([multiplier, 0.1]), {})
        assert gait.stable is stable


class TestParameters:
    @pytest.mark.parametrize(
        ("name", "part"),
        [("stance_torque", "law"), ("stiffness", "spring"), ("damping", "spring"), ("friction", "contact")],
    )
    def test_by_the_name_of_a_field(self, robot, name, part):
        system = hopping(robot)
        changed = with_parameters(system, {name: 1.25})
        assert parameter(changed, name) == getattr(getattr(changed, part), name) == 1.25
        assert parameter(system, name) != 1.25
        others = {"law", "spring", "contact"} - {part}
        assert all(getattr(changed, other) == getattr(system, other) for other in others)

    def test_several_at_once(self, robot):
        changed = with_parameters(hopping(robot), {"stance_torque": 5.0, "stiffness": 6.0, "friction": 0.7})
        assert (changed.law.stance_torque, changed.spring.stiffness, changed.contact.friction) == (5.0, 6.0, 0.7)

    def test_the_changed_system_moves_otherwise(self, robot, hop):
        softer = with_parameters(hop.system, {"stiffness": 40.0})
        assert residual(softer, hop.state) > 1e-3

    @pytest.mark.parametrize("name", ["colour", "unilateral", "hold_extension"])
    def test_unknown(self, robot, name):
        with pytest.raises(UnknownName, match=f"unknown parameter '{name}'; nearest of .*: "):
            parameter(hopping(robot), name)
        with pytest.raises(UnknownName):
            with_parameters(hopping(robot), {name: 1.0})

    def test_one_that_has_no_number(self, robot):
        with pytest.raises(BadValue, match="^hip_touchdown is None"):
            parameter(hopping(robot), "hip_touchdown")

    def test_a_value_that_is_not_valid(self, robot):
        with pytest.raises(BadValue, match=r"^Spring\.stiffness"):
            with_parameters(hopping(robot), {"stiffness": -1.0})


@pytest.mark.parametrize("limit", [float("inf"), -1.0])
def test_a_limit_that_a_file_cannot_keep_is_refused(hop, tmp_path, limit):
    with pytest.raises(BadValue, match="phase_limit"):
        replace(hop, system=replace(hop.system, phase_limit=limit)).save(tmp_path / "gait.json")
    assert not list(tmp_path.iterdir())
