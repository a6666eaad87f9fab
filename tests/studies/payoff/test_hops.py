"""Hops of a payoff study: what they cost, what starts one knee from another, and one that is really searched."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import load, simulate
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart
from spear_pin.studies.payoff import Motors, Point, Search, answer, hops
from spear_pin.studies.payoff.cycles import Cycles, Task, with_values
from spear_pin.studies.payoff.gaits import attempt
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.studies.payoff.hopping import HOPS, MESH, electricity, figures_of, ranges, within, work
from spear_pin.studies.payoff.leading import Place, begun
from spear_pin.studies.payoff.motors import known
from spear_pin.studies.payoff.searches import rebuilt, written
from tests.model.small_leg import small_leg


@pytest.fixture(scope="module")
def motors():
    robot = load("spear_ii", locked=["boom_x"])
    return Motors(*(known(robot, part)[0] for part in ("knee", "hip")), own=("knee", "hip"))


class TestFigures:
    def test_cost_is_electricity_over_the_work_of_the_rise(self, hop, motors):
        found, flight = figures_of(hop, motors), hop.durations["flight"]
        rise = 9.81 * flight**2 / 8.0
        assert work(hop.system.robot, flight) == pytest.approx(6.8 * 9.81 * rise)
        drawn = electricity(motors, hop.system, simulate(hop.system, hop.state, samples=MESH))
        assert found.cost == pytest.approx(drawn / (6.8 * 9.81 * rise))
        assert HOPS.energy(hop.system.robot, found) == pytest.approx(drawn)
        assert found.speed == flight and set(found.peak) == {"knee", "hip"} and found.residual <= 1e-9

    def test_one_motor_a_joint(self, hop, motors):
        cycle = simulate(hop.system, hop.state, samples=MESH)
        assert figures_of(hop, motors).peak["knee"] == pytest.approx(np.abs(cycle.u[:, 1]).max(), rel=1e-3)
        left = within(None, hop.system, cycle)
        assert left.min() > 0.0 and 1.0 - np.abs(cycle.u[:, 1]).max() / 60.0 in left

    def test_motors_are_spear_ii_s(self):
        robot = load("spear_ii", locked=["boom_x"])
        drive, said = known(robot, "knee")
        assert drive.motor.torque_constant == 0.115 and drive.gearbox.ratio == 15.0 and said == "SPEAR-II's"

    def test_written_and_rebuilt(self, hop):
        again = rebuilt(HOPS.kind, hop.system.robot, written(hop))
        assert again.system.law == hop.system.law and again.system.spring == hop.system.spring


class TestStart:
    @pytest.mark.parametrize(("kind", "stiffness"), [(NONE, 0.0), (SWITCHED, 20.0), (SWITCHED, None)])
    def test_another_knee_begins_with_the_same_motion(self, hop, kind, stiffness):
        """What its spring does not do the motor does as one."""
        place = Place.of(SWITCHED, hop)
        plain, other = begun(place, Point(SWITCHED, 0.2, 48.84)), begun(place, Point(kind, 0.2, stiffness))
        ends = [simulate(start.system, start.state).q[-1] for start in (plain, other)]
        np.testing.assert_allclose(ends[1], ends[0], atol=1e-8)
        assert other.whole == pytest.approx(48.84) and other.system.spring.damping == hop.system.spring.damping

    def test_a_fixed_spring_rests_where_the_knee_lands(self, hop):
        place = begun(Place.of(SWITCHED, hop), Point(FIXED, 0.2, 30.0))
        moved = with_values(place.system, {"knee_touchdown": 0.8})
        assert (moved.spring.rest, moved.law.knee_touchdown, moved.spring.unilateral) == (0.8, 0.8, False)

    def test_ranges_are_within_the_joints_limits(self, hop):
        found = ranges(hop.system.robot, free=True)
        assert found["knee_touchdown"] == (0.3, 2.2) and "stiffness" in found
        assert "stiffness" not in ranges(hop.system.robot, free=False)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(("kind", "stiffness"), [(SWITCHED, 48.84), pytest.param(FIXED, 30.0, marks=pytest.mark.slow)])
def test_the_fast_engine_sees_the_same_gap(hop, motors, kind, stiffness):
    """Away from the state, where charts bend, and with each number that is chosen; derivatives by differences."""
    place = begun(Place.of(SWITCHED, hop), Point(kind, 0.2, stiffness))
    place = replace(place, system=with_parameters(place.system, {"hip_touchdown": 0.5}))
    chosen = ranges(hop.system.robot, free=False)
    task = Task(0.2, lambda *_: 1.0, lambda *_: np.ones(1), chosen, 4, 0.05, 1e-10)
    cycles = Cycles(task, place.system, place.state, chart(place.system, place.state))
    given = [parameter(place.system, name) for name in chosen]
    base = np.concatenate([np.zeros(cycles.chart.dimension), given]) / cycles.units
    x = base + 0.03 * np.cos(np.arange(len(base)))
    gap, slopes = cycles.glance(x)
    np.testing.assert_allclose(gap, cycles.at(x).gap, atol=1e-7)
    ends = [cycles.glance(x + 1e-5 * sign * unit)[0] for unit in np.eye(len(x)) for sign in (1.0, -1.0)]
    np.testing.assert_allclose(slopes.T, (np.array(ends[::2]) - np.array(ends[1::2])) / 2e-5, atol=1e-5)


@pytest.mark.slow
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
