"""The search for the best hop: limits, starts, descents, and the way to another point."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import HoppingLaw, Spring, find_gait, hopping, load, simulate
from spear_pin.errors import MissingExtra, NoGait
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number, rebuilt, with_parameters
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.studies.design import points_of
from spear_pin.studies.payoff import Point, hop_search
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.studies.payoff.hop_search import CLEAR, TAUT, TREAD, Task, best_hop, descend, lead_hop, limits, starts
from spear_pin.studies.payoff.hopping import ranges
from spear_pin.studies.payoff.knee import release_springs, tie_springs, with_knee, with_values
from spear_pin.studies.payoff.motors import PARTS
from tests.studies.payoff.stub import drawn_by


@pytest.fixture(scope="module")
def start(hop):
    """A hop of the study's, before it is led down."""
    law = replace(hop.system.law, hold_extension=True, minimum_force=0.05 * hop.system.robot.weight, hip_touchdown=0.5)
    return find_gait(rebuilt(hop.system, law=law), ["stance_torque"], {"flight_time": 0.2})


def task(robot, motors=None, measure="electricity", count=0):
    return Task(0.2, measure, motors, ranges(robot, free=False), 1e-5, count, 0)


class TestLimits:
    def test_are_those_of_file_and_motors(self, motors):
        robot = load("spear_ii", locked=["boom_x"])
        at_most, at_least = limits(robot, motors)
        assert at_most["peak_torque_knee"] == 60.0 and at_most["greatest_knee"] == pytest.approx(2.8)
        assert at_least["reserve_hip"] == 0.0 and at_least["least_knee"] == pytest.approx(-0.2)
        assert not [name for name in limits(robot, None)[1] if name.startswith("reserve")]
        slower = replace(motors, knee=replace(motors.knee, motor=replace(motors.knee.motor, max_speed=150.0)))
        assert limits(robot, slower)[0]["peak_speed_knee"] == 10.0
        assert limits(robot, slower, {"knee_ratio": (8.0, 30.0)})[0]["peak_speed_knee"] == 5.0

    def test_a_descent_keeps_knee_and_hip_off_the_ground(self, start, motors):
        at_least = hop_search.problem(task(start.system.robot, motors), start.system).at_least
        assert at_least["margin_fall:knee"] == at_least["margin_fall:hip"] == CLEAR


class TestKnee:
    @pytest.mark.parametrize(("kind", "stiffness"), [(NONE, 0.0), (SWITCHED, 20.0)])
    def test_another_one_begins_with_the_same_motion(self, hop, kind, stiffness):
        """What its spring does not do the motor does as one."""
        plain, other = (with_knee(hop.system, each, k) for each, k in ((SWITCHED, 48.84), (kind, stiffness)))
        ends = [simulate(system, hop.state).q[-1] for system in (plain, other)]
        np.testing.assert_allclose(ends[1], ends[0], atol=1e-8)
        assert other.spring.stiffness + other.law.virtual_stiffness == pytest.approx(48.84)
        assert other.spring.damping == hop.system.spring.damping

    def test_a_fixed_spring_rests_where_the_knee_lands(self, hop):
        moved = with_values(with_knee(hop.system, FIXED, 30.0), {"knee_touchdown": 0.8})
        assert (moved.spring.rest, moved.law.knee_touchdown, moved.spring.unilateral) == (0.8, 0.8, False)

    @pytest.mark.extra("heyoka")
    def test_a_tied_spring_has_the_derivative_by_the_commanded_angle(self, hop):
        """Against cycles in which the spring was put there by hand."""
        spring = Spring(stiffness=30.0, rest=1.37, unilateral=False)
        law = HoppingLaw(1.37, 0.64, 7.0, 1.18, virtual_stiffness=5.8, hold_extension=True, minimum_force=3.3)
        system = hopping(hop.system.robot, law, spring)
        state = find_gait(system, guess=(np.array([0.498, 0.649, 1.34]), np.array([-0.895, 2.228, 4.53]))).state
        orbit = Orbit(tie_springs(system), state, ("knee_touchdown",))
        h = 1e-4

        def end(angle):
            moved = rebuilt(with_parameters(system, {"knee_touchdown": angle}), spring=replace(spring, rest=angle))
            return Orbit(moved, state, ()).cycle.y

        beside = [end(law.knee_touchdown + k * h) for k in (1, -1, 2, -2)]
        expected = (8.0 * (beside[0] - beside[1]) - (beside[2] - beside[3])) / (12.0 * h)
        assert orbit.cycle.dy[:, -1] == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


class TestWay:
    """The way to another point, of hops that `_hop` would find."""

    @pytest.fixture
    def passed(self, monkeypatch):
        found = []

        def beside(system, near, flight_time):
            found.append((system, flight_time))
            return replace(near, system=system, durations={**near.durations, "flight": flight_time})

        monkeypatch.setattr(hop_search, "_hop", beside)
        return found

    def test_stiffness_and_flight_grow_together(self, hop, passed):
        end = lead_hop(Point(SWITCHED, 0.3, 150.0), SWITCHED, hop)
        assert end.system.spring.stiffness == 150.0 and end.system.law.virtual_stiffness == 0.0
        assert (
            not any(system.spring.unilateral for system, _ in passed) and release_springs(end.system).spring.unilateral
        )
        stiffer, longer = zip(*((system.spring.stiffness, time) for system, time in passed), strict=True)
        assert len(passed) > 1 and sorted(stiffer) == list(stiffer) and sorted(longer) == list(longer)

    def test_the_kind_changes_where_there_is_no_spring(self, hop, passed):
        end = lead_hop(Point(FIXED, 0.2, 30.0), SWITCHED, hop)
        fixed = [system.spring.rest is not None for system, _ in passed]
        first = fixed.index(True)
        assert not any(fixed[:first]) and all(fixed[first:]) and passed[first - 1][0].spring.stiffness == 0.0
        assert end.system.spring.rest == end.system.law.knee_touchdown
        bare = lead_hop(Point(NONE, 0.2), SWITCHED, hop).system
        assert (bare.spring.stiffness, bare.law.virtual_stiffness) == (0.0, pytest.approx(48.84))

    def test_a_free_stiffness_begins_with_the_one_there_is(self, hop, passed):
        assert lead_hop(Point(SWITCHED, 0.2, None), SWITCHED, hop).system.spring.stiffness == 48.84

    def test_its_end_is_told(self, hop, monkeypatch):
        def beside(system, near, flight_time):
            raise NoGait("it is so", 1.0)

        monkeypatch.setattr(hop_search, "_hop", beside)
        with pytest.raises(NoGait, match="it is so"):
            lead_hop(Point(SWITCHED, 0.2, 70.0), SWITCHED, hop)


class TestStarts:
    @pytest.mark.slow
    def test_the_same_seed_has_the_same_starts_within_ranges(self, start):
        chosen = ranges(start.system.robot, free=False)
        found = [list(starts(task(start.system.robot, count=3), [start])) for _ in range(2)]
        assert len(found[0]) > 1 and found[0][0] is start
        for one, other in zip(*found, strict=True):
            assert one.system.law == other.system.law and one.durations["flight"] == pytest.approx(0.2, abs=1e-8)
            assert all(low <= number(one.system, name) <= high for name, (low, high) in chosen.items())


class TestBest:
    """Of descents with given ends."""

    @pytest.fixture
    def ends(self, start, monkeypatch):
        def given(*found, away=()):
            left, span = iter(found), np.ptp(ranges(start.system.robot, free=False)["frequency"])
            shares = [*away, *(len(found) - len(away)) * [0.5]]
            own = start.system.law.frequency
            begun = [replace(start, system=with_values(start.system, {"frequency": own + x * span})) for x in shares]

            def down(task, start):
                end = next(left)
                if isinstance(end, Exception):
                    raise end
                cost, missed, *beyond = end
                system = with_values(start.system, {"stance_torque": beyond[0] if beyond else 8.0})
                bounds = {"reserve_knee at least": (-5.0 * missed, 0.0), "peak_speed_knee at most": (9.0, 10.0)}
                gait = SimpleNamespace(system=system, cost=cost, residual=0.0)
                return gait, SimpleNamespace(objective=cost, missed=missed, bounds=bounds)

            monkeypatch.setattr(hop_search, "descend", down)
            monkeypatch.setattr(hop_search, "starts", lambda task, given: begun)
            return best_hop(task(start.system.robot), [start])

        return given

    def test_the_cheapest_within_limits(self, ends):
        best = ends((5.0, 0.0), NoGait("none", 1.0), (3.0, 0.5), (2.0, 0.0, 1e3), (4.0, 1e-6), (4.03, 0.0))
        assert (best.gait.cost, best.starts) == (4.0, 2)

    def test_starts_beside_each_other_are_one(self, ends):
        assert ends((4.0, 0.0), (4.01, 0.0), away=(0.5, 0.09)).starts == 1
        assert ends((4.0, 0.0), (4.01, 0.0), away=(0.5, 0.11)).starts == 2

    def test_the_limit_that_is_missed_is_named(self, ends):
        with pytest.raises(
            NoGait, match="in the nearest one reserve knee is -2 instead of at least 0 N·m; try a stronger motor"
        ):
            ends((5.0, 0.8), (6.0, 0.4))

    def test_no_descent(self, ends):
        with pytest.raises(NoGait, match="no descent to a hop succeeds; of the first: toes alternate"):
            ends(NotDifferentiable("toes alternate"), NoGait("none", 1.0), ZeroDivisionError())

    def test_that_heyoka_is_missing_is_told(self, ends):
        with pytest.raises(MissingExtra, match="fast"):
            ends(MissingExtra("heyoka", "fast", "a descent"))


def test_a_spring_that_is_slack_on_the_way_is_told(start, monkeypatch):
    design = SimpleNamespace(missed=0.0, gait=replace(start, state=(start.state[0], start.state[1] + 1e-3)))
    monkeypatch.setattr(hop_search, "optimize_design", lambda *given, **named: design)
    with pytest.raises(NoGait, match="the spring is slack in stance"):
        descend(task(start.system.robot), replace(start, system=start.system))


@pytest.mark.slow
@pytest.mark.extra("heyoka")
class TestDescent:
    def drawn(self, gait, motors):
        cycle = simulate(gait.system, gait.state, samples=480, progress=False)
        return drawn_by(gait.system.robot, cycle, motors)

    @pytest.mark.parametrize(("kind", "stiffness"), [(SWITCHED, 48.84), (FIXED, 100.0)])
    def test_it_leads_down_within_limits(self, start, motors, kind, stiffness):
        """Costs, torques and load are those of samples, which the descent does not use."""
        begun = lead_hop(Point(kind, 0.2, stiffness), SWITCHED, start)
        wanted = task(start.system.robot, motors)
        end, design = descend(wanted, begun)
        assert self.drawn(end, motors) == pytest.approx(design.objective, rel=1e-4)
        assert self.drawn(end, motors) < 0.9 * self.drawn(begun, motors) and design.missed < 1e-3
        assert end.durations["flight"] == pytest.approx(0.2, abs=1e-8) and end.residual < 1e-9
        assert end.system.spring.unilateral == (kind == SWITCHED)
        assert all(low <= number(end.system, name) <= high for name, (low, high) in wanted.ranges.items())
        cycle = simulate(end.system, end.state, samples=480, progress=False)
        stance, knee = cycle.phase == "stance", end.system.robot.index("knee")
        load = cycle.force[stance, 0, 1]
        wave = cycle.t[stance] - cycle.t[stance][0] < 0.5 / end.system.law.frequency
        assert load[wave].min() > (TREAD - 1e-3) * end.system.robot.weight
        heights = [end.system.robot.frame_position(q, "knee")[-1] for q in cycle.q]
        assert min(heights) > CLEAR - 1e-5
        if kind == SWITCHED:
            angle = cycle.q[stance, knee]
            assert angle[-1] - angle[0] > TAUT - 1e-4
        for part in PARTS:
            given, drive = points_of(end.system.robot, cycle, part), getattr(motors, part)
            assert np.min(drive.margin(given.torque, given.speed)) > -1e-3 * drive.stall_torque

    def test_least_effort(self, start):
        end, design = descend(task(start.system.robot, measure="effort"), start)
        cycle = simulate(end.system, end.state, samples=480, progress=False)
        effort = float(np.trapezoid((cycle.u**2).sum(axis=1), cycle.t))
        assert design.objective == pytest.approx(effort, rel=1e-3) and design.objective < design.start
