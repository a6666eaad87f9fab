"""Payoff studies of hops with a spring along a path: beside the knee's spring, by hand, and beside a search alone."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Spring, find_gait, hopping, load, simulate
from spear_pin.errors import SpearError
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.parameters import rebuilt as of_law
from spear_pin.model.path import Joints
from spear_pin.studies.payoff import Search, hop_search
from spear_pin.studies.payoff import hopping as hopping_study
from spear_pin.studies.payoff.grid import FIXED, KINDS, NONE, SWITCHED, Point
from spear_pin.studies.payoff.hop_search import TAUT, Best, descend, lead_hop, problem
from spear_pin.studies.payoff.hopping import HOPS, Hops, along_of, figures_of, hops, task_of, words_for
from spear_pin.studies.payoff.knee import levers, release_springs, tie_springs, with_knee, with_values
from spear_pin.studies.payoff.searches import rebuilt, write_gait
from tests.studies.payoff.stub import drawn_by

CABLE = Joints({"knee": 0.03, "hip": 0.006})  # m


def along(path, **over):
    """Hops with a cable along a path, of which some numbers are chosen."""
    return Hops({f"cable.{name}": ends for name, ends in over.items()}, ("cable", path))


class TestSystem:
    def test_its_size_is_that_of_a_knee_spring_behind_its_levers(self, robot):
        assert levers(along(CABLE).system(robot)) == pytest.approx([0.006, 0.03])
        assert along(CABLE).stiffness(robot) == pytest.approx(48.84 / (0.006**2 + 0.03**2))
        assert along(Joints({"knee": 1.0})).stiffness(robot) == HOPS.stiffness(robot) == pytest.approx(48.84)

    def test_it_is_called_by_its_name_and_unit(self, robot):
        for path, unit in ((CABLE, "N/m"), (Joints({"hip": 1.0}), "N·m/rad")):
            words = words_for(along(path), robot)
            assert (words.place, words.unit) == ("along cable", unit)
            assert words.of(Point(FIXED, 0.2, 5.0)) == f"a fixed spring of 5 {unit} 0.2 s in the air"

    def test_a_virtual_spring_gives_what_it_lacks_at_the_knee(self, robot):
        system = with_knee(along(CABLE).system(robot), SWITCHED, 2e4)
        assert system.law.virtual_stiffness == pytest.approx(48.84 - 2e4 * 0.03**2)
        assert system.spring == Spring(2e4, damping=0.0, unilateral=False, path=CABLE)
        assert system.springs["knee"] == Spring(0.0, damping=1.3, unilateral=False)
        assert all(spring.unilateral for spring in release_springs(system).springs.values())

    def test_a_fixed_one_rests_at_its_length_where_the_leg_lands(self, robot):
        fixed = with_knee(along(CABLE).system(robot), FIXED, 2e4)
        moved = with_values(fixed, {"knee_touchdown": 0.8, "hip_touchdown": 0.3, "stiffness": 3e4})
        assert moved.spring.rest == pytest.approx(0.03 * 0.8 + 0.006 * 0.3) and moved.spring.stiffness == 3e4
        assert moved.springs["knee"].rest == pytest.approx(0.8)

    def test_a_descent_keeps_cable_and_knee_taut(self, robot, motors):
        found = along(CABLE)
        task = task_of(robot, motors, "electricity", Search(Point(SWITCHED, 0.2, None), None, found.meshes))
        at_least = problem(task, found.system(robot)).at_least
        assert at_least["deflection_knee"] == TAUT
        assert at_least["deflection_cable"] == pytest.approx(TAUT * np.hypot(0.03, 0.006))

    def test_a_limit_along_it_that_is_missed_is_told_in_m(self, robot):
        design = SimpleNamespace(bounds={"deflection_cable at least": (1e-5, 2e-4)})
        told = hop_search._missed(design, along(CABLE).system(robot))
        assert told == "deflection cable is 1e-05 instead of at least 0.0002 m"


@pytest.mark.parametrize("kind", [SWITCHED, FIXED, NONE])
def test_along_the_knee_alone_it_is_the_knee_s(hop, motors, kind):
    """Both engines' cycles, the electricity and what a store keeps."""
    robot, own = hop.system.robot, 0.0 if kind == NONE else 30.0
    found = []
    for gaits in (HOPS, along(Joints({"knee": 1.0}))):
        system = with_knee(gaits.system(robot), kind, own)
        law = replace(hop.system.law, virtual_stiffness=48.84 - own, hip_touchdown=0.5)
        springs = {name: replace(spring, rest=spring.rest and 1.0) for name, spring in system.springs.items()}
        system = hopping(robot, law, springs)
        gait = replace(hop, system=system)
        again = rebuilt("hopping", robot, write_gait(gait)).system
        assert again.springs == system.springs
        found.append((simulate(again, hop.state).q[-1], figures_of(gait, motors)))
    (one, knee), (other, cable) = found
    np.testing.assert_allclose(other, one, rtol=0.0, atol=1e-9)
    assert cable.stiffness == own and cable.cost == pytest.approx(knee.cost, rel=1e-9)


class TestChosenNumbers:
    OVER = {"hip": (-0.01, 0.02)}

    def test_are_those_of_a_knee_with_a_spring(self, robot, motors, monkeypatch):
        """The hop is given; what its figures and words name is what the search was asked for."""
        tasks, gaits = [], along(CABLE, **self.OVER)
        system = with_numbers(with_knee(gaits.system(robot), SWITCHED, 2e4), {"cable.hip": 0.012})
        monkeypatch.setattr(hopping_study, "_begun", lambda system, asked: [])
        monkeypatch.setattr(hopping_study, "best_hop", lambda task, begun: tasks.append(task) or Best(system, None, 1))
        monkeypatch.setattr(hopping_study, "figures_of", lambda gait, motors, best, mesh, over, own: dict(over))
        found = [gaits.search(robot, motors, Search(Point(kind, 0.2, 2e4), None, gaits.meshes)) for kind in KINDS]
        assert [figures for _, figures, _ in found] == [{}, {"cable.hip": (-0.01, 0.02)}, {"cable.hip": (-0.01, 0.02)}]
        assert ["cable.hip" in task.chosen for task in tasks] == [False, True, True]
        assert problem(tasks[-1], system).over["cable.hip"] == (-0.01, 0.02)

    def test_are_told_with_ranges_and_units(self, robot):
        words = words_for(along(CABLE, **self.OVER), robot)
        assert ("chosen too", "cable.hip from -0.01 to 0.02 m") in words.rests
        assert words.of_numbers({"cable.hip": 0.0123456}) == "cable.hip 0.0123 m"
        assert words_for(Hops({"knee_ratio": (5.0, 30.0)}), robot).of_numbers({"knee_ratio": 12.0}) == "knee_ratio 12"

    @pytest.mark.parametrize(
        ("over", "why"),
        [
            ({"elbow": (0.01, 0.02)}, "unknown parameter of the robot 'cable.elbow'; .*cable.knee, cable.hip"),
            ({"hip": (0.01, 0.02)}, "a range with the robot's own value in it, 0.006"),
            ({"hip": (0.0, 0.02)}, "other than zero"),
        ],
    )
    def test_that_are_none_of_the_path(self, robot, over, why):
        gaits = along(CABLE, **over)
        with pytest.raises(SpearError, match=why):
            gaits.check(robot, [0.2])


OF_FILE = 'robot = "spear_ii"\nlocked = ["boom_x"]\n'
SPRING = "\n[springs.{}]\npath = {{ knee = 0.03, hip = 0.006 }}\nstiffness = 5e4\n"


@pytest.mark.parametrize(
    ("text", "name", "why"),
    [
        (SPRING.format("cable"), "rope", "unknown spring 'rope'; valid: knee, cable"),
        (SPRING.format("cable") + SPRING.format("rope"), None, "as the robot's file has several: cable, rope"),
        (SPRING.format("cable") + "clutch = { on_delay = 0.01 }", None, "None: this study switches at once"),
    ],
)
def test_springs_that_cannot_be_studied(tmp_path, text, name, why):
    (tmp_path / "leg.toml").write_text(OF_FILE + text)
    with pytest.raises(SpearError, match=why):
        hops(load(tmp_path / "leg.toml"), tmp_path / "payoff.jsonl", spring=name)


def test_the_knee_keeps_the_damper_of_the_file(tmp_path):
    (tmp_path / "leg.toml").write_text(OF_FILE + SPRING.format("cable") + "[springs.knee]\ndamping = 0.7\n")
    robot = load(tmp_path / "leg.toml")
    along = along_of(robot, None)
    assert along == ("cable", CABLE)
    assert Hops(along=along).system(robot).springs["knee"] == Spring(0.0, damping=0.7)


@pytest.mark.slow
@pytest.mark.extra("heyoka")
class TestDescent:
    @pytest.mark.parametrize(("stiffness", "over"), [(45e3, {}), (49.2e3, {"cable.hip": (1e-5, 0.02)})])
    def test_its_end_is_the_hop_that_a_search_finds_alone(self, hop, motors, stiffness, over):
        """Of a system that is made by hand; its electricity is that of samples."""
        found, robot = along(CABLE), hop.system.robot
        point = Point(SWITCHED, 0.2, stiffness)
        task = replace(task_of(robot, motors, "electricity", Search(point, None, found.meshes), over), tolerance=1e-2)
        system = found.system(robot)
        law = replace(system.law, hold_extension=True, minimum_force=0.05 * robot.weight)
        begun = find_gait(of_law(system, law=law), ["stance_torque"], {"flight_time": 0.2})
        end, design = descend(task, lead_hop(point, SWITCHED, begun))
        pulley = design.parameters["cable.hip"].value if over else 0.006
        cable = Spring(stiffness, damping=0.0, path=Joints({"knee": 0.03, "hip": pulley}))
        springs = {"cable": cable, "knee": Spring(0.0, damping=1.3)}
        law = replace(end.system.law, stance_torque=1.02 * end.system.law.stance_torque)
        beside = end.state[0] + 2e-3, end.state[1] + 2e-2
        made = hopping(robot, law, springs)
        alone = find_gait(made, ["stance_torque"], {"flight_time": 0.2}, guess=beside)
        assert alone.system.law.stance_torque == pytest.approx(end.system.law.stance_torque, rel=1e-6)
        cycle = simulate(alone.system, alone.state, samples=480, progress=False)
        drawn = drawn_by(robot, cycle, motors)
        assert drawn == pytest.approx(design.objective, rel=1e-4) and design.missed < 1e-3
        assert min(cycle.springs.stretch[cycle.phase == "stance", 0][1:]) > 0.0
        assert pulley > 0.008 if over else pulley == 0.006  # the descent enlarges it

    @pytest.mark.parametrize("name", ["hip_touchdown", "cable.hip"])
    def test_a_tied_one_has_the_derivative_by_where_it_rests(self, hop, name):
        """Against cycles in which the spring was put there by hand."""
        system = with_knee(along(CABLE).system(hop.system.robot), FIXED, 2e4)
        law = replace(system.law, hold_extension=True, minimum_force=3.3)
        system = of_law(system, law=law)
        orbit, h, own = Orbit(tie_springs(system), hop.state, (name,)), 1e-4, number(system, name)

        def end(step):
            return Orbit(with_values(system, {name: own + step}), hop.state, ()).cycle.y

        beside = [end(k * h) for k in (1, -1, 2, -2)]
        expected = (8.0 * (beside[0] - beside[1]) - (beside[2] - beside[3])) / (12.0 * h)
        assert orbit.cycle.dy[:, -1] == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())
