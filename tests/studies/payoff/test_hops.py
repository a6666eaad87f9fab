"""Hops of a payoff study: what they cost, what starts one knee from another, and one that is really searched."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import load, simulate, vary
from spear_pin.errors import SpearError
from spear_pin.gaits.search import find_gait, gait_beside
from spear_pin.hybrid.parameters import with_numbers, with_parameters
from spear_pin.model.catalogue import size_motor
from spear_pin.studies.payoff import Motors, Point, Search, answer, hops
from spear_pin.studies.payoff.gaits import attempt
from spear_pin.studies.payoff.grid import FIXED, SWITCHED
from spear_pin.studies.payoff.hopping import HOPS, MESH, Hops, figures_of, ranges, task_of, work
from spear_pin.studies.payoff.motors import known
from spear_pin.studies.payoff.searches import SearchEnd, rebuilt, write_gait
from tests.model.small_leg import small_leg
from tests.studies.payoff.stub import drawn_by


class TestFigures:
    def test_cost_is_electricity_over_the_work_of_the_rise(self, hop, motors):
        found, flight = figures_of(hop, motors), hop.durations["flight"]
        rise = 9.81 * flight**2 / 8.0
        assert work(hop.system.robot, flight) == pytest.approx(6.8 * 9.81 * rise)
        cycle = simulate(hop.system, hop.state, samples=MESH)
        drawn = drawn_by(hop.system.robot, cycle, motors)
        assert found.cost == pytest.approx(drawn / (6.8 * 9.81 * rise))
        assert HOPS.energy(hop.system.robot, found) == pytest.approx(drawn)
        assert found.speed == flight and set(found.peak) == {"knee", "hip"} and found.residual <= 1e-9

    def test_one_motor_a_joint(self, hop, motors):
        cycle = simulate(hop.system, hop.state, samples=MESH)
        assert figures_of(hop, motors).peak["knee"] == pytest.approx(np.abs(cycle.u[:, 1]).max(), rel=1e-3)

    def test_motors_are_spear_ii_s(self):
        robot = load("spear_ii", locked=["boom_x"])
        drive, said = known(robot, "knee")
        assert drive.motor.torque_constant == 0.115 and drive.gearbox.ratio == 15.0 and said == "SPEAR-II's"

    def test_written_and_rebuilt(self, hop):
        again = rebuilt(HOPS.kind, hop.system.robot, write_gait(hop))
        assert again.system.law == hop.system.law and again.system.spring == hop.system.spring

    def test_of_another_motor(self, hop, motors):
        """It draws what its own windings and gears make it draw, and is written with its robot."""
        robot = vary(hop.system.robot, knee_motor_size=2.0, knee_ratio=12.0)
        gait = gait_beside(with_numbers(hop.system, {"knee_motor_size": 2.0, "knee_ratio": 12.0}), hop.state, [], {})
        found, flight = figures_of(gait, motors, over=["knee_motor_size"]), gait.durations["flight"]
        other = replace(
            motors.knee, motor=size_motor(motors.knee.motor, 2.0), gearbox=replace(motors.knee.gearbox, ratio=12.0)
        )
        cycle = simulate(gait.system, gait.state, samples=MESH)
        drawn = drawn_by(robot, cycle, Motors(other, motors.hip))
        assert found.cost * work(robot, flight) == pytest.approx(drawn) and found.chosen == {"knee_motor_size": 2.0}
        at_home = figures_of(gait, motors, own=hop.system.robot)
        assert HOPS.energy(hop.system.robot, at_home) == pytest.approx(drawn) and at_home.cost > found.cost
        again = rebuilt(HOPS.kind, hop.system.robot, write_gait(gait)).system.robot
        assert again.mass == pytest.approx(robot.mass) and again.mass > hop.system.robot.mass + 0.1


@pytest.mark.parametrize(
    ("over", "why"),
    [
        ({"knee_motor_size": (2.0, 3.0)}, "a range with the robot's own value in it, 1"),
        ({"knee_motor_size": (1.0, 1.0)}, "a least and a greatest value"),
        ({"knee_motor_size": (-1.0, 2.0)}, "a finite number > 0"),
        ({"frequency": (1.0, 3.0)}, "unknown parameter of the robot 'frequency'"),
        ({"knee_motor": (0.5, 3.0)}, "knee_motor_size"),
    ],
)
def test_numbers_that_cannot_be_chosen(hop, over, why):
    with pytest.raises(SpearError, match=why):
        Hops(over).check(hop.system.robot, [0.2])
        Hops(over).suits(hop.system.robot)


def test_ranges_are_within_the_joints_limits(hop):
    found = ranges(hop.system.robot, free=True)
    assert found["knee_touchdown"] == (0.3, 2.2) and "stiffness" in found
    assert "stiffness" not in ranges(hop.system.robot, free=False)


def test_only_a_search_without_a_start_or_of_a_free_stiffness_has_random_starts(hop, motors):
    robot = hop.system.robot

    def count(point, start=None):
        return task_of(robot, motors, "electricity", Search(point, start, HOPS.meshes)).starts

    soft, free = Point(FIXED, 0.2, 22.0), Point(FIXED, 0.2, None)
    begun = SearchEnd("key", soft, "cold", HOPS.meshes, 0.0)
    assert count(soft, begun) == 0 < count(Point(SWITCHED, 0.2, 22.0)) < count(free, begun) < count(soft)


@pytest.mark.slow
@pytest.mark.extra("heyoka")
def test_a_search_ends_in_a_fixed_point_that_costs_less(motors):
    robot = load("spear_ii", locked=["boom_x"])
    found = attempt(HOPS, robot, motors, Search(Point(SWITCHED, 0.2, 48.84), None, HOPS.meshes))
    assert not found.reason and found.figures.residual <= 1e-9
    assert found.figures.speed == pytest.approx(0.2, abs=1e-8)
    gait = rebuilt(HOPS.kind, robot, found.gait)
    plain = find_gait(gait.system, ["stance_torque"], {"flight_time": 0.2}, guess=gait.state)
    assert plain.system.law.stance_torque == pytest.approx(gait.system.law.stance_torque, rel=1e-6)
    nudged = with_parameters(gait.system, {"frequency": 1.02 * gait.system.law.frequency})
    beside = find_gait(nudged, ["stance_torque"], {"flight_time": 0.2}, guess=gait.state)
    assert figures_of(beside, motors).cost > (1.0 - 1e-3) * found.cost


@pytest.mark.extra("heyoka")
def test_a_small_leg_saves_half_by_a_spring_of_6(tmp_path):
    """Of one stiffness: every search is about that one, and every start shows the saving."""
    found = hops(small_leg(tmp_path), tmp_path / "payoff.jsonl", speeds=(0.15, 0.173), stiffnesses=(6.0,))
    said = answer(found)
    assert {point.stiffness for point in found.tries} == {0.0, 6.0} and found.speed == 0.173
    assert said.verdict in ("fixed", "spring") and said.by_speed[0.173].pays[FIXED] is True
    assert 0.45 < said.saving[FIXED] < 0.55
    assert "a fixed spring of 6 N·m/rad per leg saves" in said.sentence
