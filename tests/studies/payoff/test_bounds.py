"""A payoff study over searches that end at once: which are made, from where, and that none is made twice."""

import json
import math
from dataclasses import replace

import pytest

from spear_pin import Spring, load
from spear_pin.errors import BadFile, BadValue, NoGait, SpearError
from spear_pin.studies.payoff import Grid, Point, answer
from spear_pin.studies.payoff import bounds as front
from spear_pin.studies.payoff.bounding import FINER
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from tests.studies.payoff.stub import DRIVES, Stub, Stubbed, cost

SPEEDS, STIFFNESSES = (1.8, 2.0, 2.2), (20.0, 40.0, 60.0)


@pytest.fixture
def study(monkeypatch, tmp_path):
    def run(stub, path=tmp_path / "store.jsonl", begins=Stubbed.begins, cold=(), valleys=(), robot=None, **options):
        monkeypatch.setattr("spear_pin.studies.payoff.bounding.BOUNDS", Stubbed(stub, begins, cold, valleys))
        values = {"speeds": SPEEDS, "stiffnesses": STIFFNESSES, "drives": DRIVES} | options
        return front(robot or load("q_spear"), path, **values)

    return run


class TestGrid:
    def test_neighbours_are_one_step_away_and_mutual(self):
        grid = Grid(SPEEDS, STIFFNESSES)
        assert len(list(grid)) == len(grid) == 21
        for point in grid:
            near = grid.neighbours(point)
            assert len(set(near)) == len(near) and all(other in list(grid) for other in near)
            assert all(point in grid.neighbours(other) for other in near)
        assert grid.neighbours(Point(FIXED, 2.0, 20.0))[0] == Point(NONE, 2.0)

    @pytest.mark.parametrize("speeds", [(), (0.0, 1.0), (2.0, 1.0), (1.0, 1.0)])
    def test_what_does_not_rise_is_refused(self, speeds):
        with pytest.raises(BadValue, match="speeds"):
            Grid(speeds, STIFFNESSES)


class TestBounds:
    def test_every_point_is_searched_from_a_neighbour_and_again_from_another(self, study):
        stub = Stub()
        found = study(stub)
        assert {point for point, start, _ in stub.asked if start is None} == {Point(NONE, 1.8), Point(NONE, 2.0)}
        for point in found.grid:
            assert found.at(point).cost == cost(point) and len(found.tries[point]) == 2
            starts = {start for asked, start, meshes in stub.asked if asked == point and meshes != FINER}
            assert len(starts) == 2 and starts - {None} <= set(found.grid.neighbours(point))
        assert 0.0 < found.seconds < 60.0

    def test_a_study_of_a_robot_whose_file_says_something_else_is_another(self, study):
        study(Stub())
        robot = load("q_spear")
        other = robot.with_model(robot.model, settings=replace(robot.settings, springs={"anterior_knee": Spring(40.0)}))
        with pytest.raises(BadFile, match="another study, which differs in settings"):
            study(Stub(), robot=other)

    def test_the_best_are_refined_and_their_stiffness_left_free(self, study):
        stub = Stub()
        found = study(stub)
        assert found.speed == 2.0 and set(found.best) == {NONE, FIXED, SWITCHED} == set(found.finer)
        assert found.best[SWITCHED].point == Point(SWITCHED, 2.0, None)
        assert found.best[SWITCHED].figures.stiffness == 50.0 and found.best[FIXED].figures.stiffness == 30.0
        refined = [(point, start) for point, start, meshes in stub.asked if meshes == FINER]
        assert refined == [(each.point, each.point) for each in found.best.values()]

    def test_a_point_that_fails_is_tried_from_its_other_neighbours(self, study):
        hard = Point(SWITCHED, 2.0, 40.0)
        found = study(Stub(lambda point, start: point == hard and start != Point(SWITCHED, 2.0, 60.0)))
        assert [bool(each.reason) for each in found.tries[hard]][:4] == [True, True, True, False]
        assert found.at(hard).cost == cost(hard) and "it is so" in found.tries[hard][0].reason

    def test_where_no_neighbour_leads_to_a_gait_initial_guesses_do(self, study):
        """Once the neighbours have failed; what is beside it then begins there."""
        hard, alone = Point(SWITCHED, 2.0, 40.0), Point(FIXED, 2.2, 60.0)
        stub = Stub(lambda point, start: point in (hard, alone) and start is not None)
        found = study(stub, cold=(SWITCHED,))
        assert found.at(hard).cost == cost(hard) and found.at(alone) is None
        assert [point for point, start, _ in stub.asked if start is None].count(hard) == 1

    def test_a_kind_that_has_no_gait_anywhere_is_not_searched_from_initial_guesses_at_each_point(self, study):
        stub = Stub(lambda point, start: point.kind == SWITCHED)
        study(stub, cold=(SWITCHED,))
        assert not [point for point, start, _ in stub.asked if start is None and point.kind == SWITCHED]

    def test_a_kind_with_valleys_is_searched_from_initial_guesses_at_each_speed(self, study):
        """A better valley then spreads over the whole grid, by every neighbour."""

        def deep(point, start):
            below = start is None or (start.kind == FIXED and start in reached)
            if point.kind == FIXED and below:
                reached.add(point)
            return cost(point) * (0.5 if point.kind == FIXED and below else 1.0)

        reached = set()
        stub = Stub(costs=deep)
        found = study(stub, valleys=(FIXED,))
        softest = [Point(FIXED, speed, 20.0) for speed in SPEEDS]
        assert [point for point, start, _ in stub.asked if start is None and point.kind == FIXED] == softest
        assert all(found.at(point).cost == 0.5 * cost(point) for point in found.grid if point.kind == FIXED)

    def test_a_second_start_that_fails_gives_way_to_another(self, study):
        """For the doubt compares two gaits of a point."""
        hard, last = Point(NONE, 2.0), Point(NONE, 2.2)
        found = study(Stub(lambda point, start: point == hard and start in (last, Point(FIXED, 2.0, 20.0))))
        assert sum(not each.reason for each in found.tries[hard]) == 2 and len(found.tries[hard]) > 2
        assert answer(found).verdict == "switchable"

    def test_what_never_has_a_gait_is_given_up_and_said(self, study):
        hard = Point(SWITCHED, 2.0, 40.0)
        found = study(Stub(lambda point, start: point == hard))
        assert found.at(hard) is None and all(each.reason for each in found.tries[hard])
        assert all(found.at(point) is not None for point in found.grid if point != hard)

    def test_a_first_gait_of_free_stiffness_leads_to_the_points_beside_it_or_else_to_all(self, study, tmp_path):
        stub = Stub()
        found = study(stub, begins=(SWITCHED,))
        free = Point(SWITCHED, 1.8, None)
        assert {point for point, start, _ in stub.asked if start == free} <= {
            *(Point(SWITCHED, 1.8, stiffness) for stiffness in STIFFNESSES)
        }
        assert all(found.at(point) is not None for point in found.grid)
        stub = Stub(fails=lambda point, start: point.stiffness is not None and point.speed == 1.8)
        found = study(stub, tmp_path / "other.jsonl", begins=(SWITCHED,))
        assert all((found.at(point) is None) == (point.speed == 1.8) for point in found.grid)

    def test_no_point_of_the_grid_has_a_gait(self, study):
        with pytest.raises(SpearError, match="no point has a bound; .*: no gait found: it is so"):
            study(Stub(fails=lambda point, start: point.stiffness is not None), begins=(SWITCHED,))

    def test_a_better_gait_spreads_to_its_neighbours(self, study):
        """From the fastest speed a better branch is found, which slower ones reach from there only."""

        def branch(point, start):
            better = point == Point(NONE, 2.2) or (start is not None and start.speed > point.speed)
            return cost(point) * (0.8 if better else 1.0)

        found = study(Stub(costs=branch))
        assert found.at(Point(NONE, 2.0)).cost == pytest.approx(0.8 * cost(Point(NONE, 2.0)))
        assert answer(found).spread_of_all[1] == pytest.approx(0.25)

    def test_without_stiffnesses_the_optimiser_s_own_leads(self, study):
        found = study(Stub(), stiffnesses=None)
        assert found.chosen == 50.0 and found.grid.stiffnesses == (12.5, 25.0, 50.0, 75.0, 100.0)

    def test_no_bound_at_all_is_said(self, study):
        with pytest.raises(SpearError, match="no bound to begin with: no spring at 1.8 m/s: no gait found: it is so"):
            study(Stub(lambda point, start: True))

    def test_resumed_after_every_search_it_ends_the_same_and_repeats_none(self, study, tmp_path):
        class Killed(Exception):
            pass

        def breaking(stub, after):
            def attempt(*arguments):
                if len(stub.asked) == after:
                    raise Killed
                return stub(*arguments)

            return attempt

        whole, stub = study(Stub(), tmp_path / "whole.jsonl"), Stub()
        total = len((tmp_path / "whole.jsonl").read_bytes().splitlines()) - 1
        for _ in range(0, total, 7):
            try:
                study(breaking(stub, len(stub.asked) + 7))
            except Killed:
                pass
        again = study(stub)
        assert len(stub.asked) == total and again.best.keys() == whole.best.keys()
        assert {point: again.at(point).key for point in again.grid} == {p: whole.at(p).key for p in whole.grid}
        keys = [[line["key"] for line in lines(tmp_path / name)] for name in ("store.jsonl", "whole.jsonl")]
        assert keys[0] == keys[1]


def lines(path):
    """What a store holds."""
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()[1:]]


class TestAnswer:
    def verdict(self, study, fixed, switched, fine=1.0):
        def costs(point, start):
            shares = {NONE: 1.0, FIXED: fixed, SWITCHED: switched}
            return (1.0 + (point.speed - 2.0) ** 2) * shares[point.kind]

        stub = Stub(costs=costs)
        return answer(study(stub, speeds=(2.0,), stiffnesses=(40.0,)))

    def test_the_switch_pays(self, study):
        found = self.verdict(study, 0.9, 0.7)
        assert found.verdict == "switchable" and found.saving == pytest.approx({FIXED: 0.1, SWITCHED: 0.3})
        assert found.sentence.startswith("yes: at 2 m/s a switchable spring of 40 N·m/rad per leg saves 30.0 % of the")

    def test_the_switch_does_not_pay_where_a_fixed_spring_does_as_well(self, study):
        found = self.verdict(study, 0.71, 0.7)
        assert found.verdict == "fixed" and "switching it adds nothing" in found.sentence

    def test_no_spring_pays(self, study):
        found = self.verdict(study, 1.1, 0.99)
        assert found.verdict == "none" and "adds 10.0 % to the electricity" in found.sentence

    def test_what_starts_differ_by_is_open(self, study):
        """Of the switchable spring one start led 40 % higher, above the fixed one and the knee without."""

        def costs(point, start):
            unlucky = point.kind == SWITCHED and start == Point(NONE, 2.0)
            return {NONE: 1.0, FIXED: 0.9, SWITCHED: 0.8}[point.kind] * (1.4 if unlucky else 1.0)

        found = answer(study(Stub(costs=costs), speeds=(2.0,), stiffnesses=(40.0,)))
        assert found.spread == pytest.approx(0.4) and found.by_speed[2.0].pays == {FIXED: True, SWITCHED: None}
        assert (
            found.verdict == "spring" and "whether it has to be switched cannot be told, for searches" in found.sentence
        )

    def test_knees_without_a_gait(self, study):
        found = answer(study(Stub(lambda point, start: point.kind != NONE)))
        assert found.verdict == "unknown" and math.isnan(found.saving[FIXED])
        assert found.sentence == "cannot tell, for no gait was found with a fixed spring of 20 N·m/rad"

    def test_one_stiffness_is_answered_for_that_one(self, study):
        """No search leaves the stiffness free, and the sentence says what the table of speeds says."""
        stub = Stub()
        found = answer(study(stub, stiffnesses=(40.0,)))
        assert {point.stiffness for point, _, _ in stub.asked} == {0.0, 40.0}
        saved = 100.0 * found.by_speed[2.0].saving[SWITCHED]
        assert found.by_speed[2.0].saving == found.saving
        assert f"a switchable spring of 40 N·m/rad per leg saves {saved:.1f} % of the electricity" in found.sentence
        assert not any("springs the" in caution for caution in found.cautions)

    def test_a_winner_outside_the_grid_is_told(self, study):
        """The best fixed one has 30 N·m/rad."""
        found = answer(study(Stub(), stiffnesses=(40.0, 60.0)))
        assert "a fixed spring of 30 N·m/rad per leg, outside the 40 to 60 of the grid, saves 10.0 %" in found.sentence
        assert "of 50 N·m/rad per leg saves 30.0 %" in found.sentence

    def test_free_stiffnesses_that_end_apart_are_no_doubt(self, study):
        """They end at 9 and at 27 N·m/rad, one 40 % dearer than the other."""

        class Apart(Stub):
            def __call__(self, robot, motors, search):
                gait, found, solution = super().__call__(robot, motors, search)
                if search.point.stiffness is not None or search.point.kind == NONE:
                    return gait, found, solution
                far = search.start.point.stiffness == 40.0
                return gait, replace(found, stiffness=27.0 if far else 9.0, cost=0.3 if far else 0.42), solution

        found = answer(study(Apart(), speeds=(2.0,)))
        assert found.verdict == "fixed" and found.spread_of_all[1] < 0.01
        assert found.saving == pytest.approx({FIXED: 0.7, SWITCHED: 0.7})

    def test_the_speed_is_one_that_most_knees_have(self, study):
        """At 2 m/s, where it is cheapest, there is nothing to compare a spring with."""
        found = study(Stub(lambda point, start: point.kind == NONE and point.speed == 2.0))
        assert found.speed == 1.8 and answer(found).verdict == "switchable"

    def test_edges_are_said(self, study):
        found = answer(study(Stub(), speeds=(1.0, 2.0)))
        assert "the fastest speed that was asked for is the best: beyond it there may be better" in found.cautions

    def test_a_fixed_spring_pays_only_where_it_saves_what_can_be_told(self, study):
        assert self.verdict(study, 0.99, 0.975).verdict == "switchable"

    def test_a_knee_without_a_gait_leaves_the_comparison_open(self, study):
        found = answer(study(Stub(lambda point, start: point.kind == FIXED)))
        assert (
            found.verdict == "spring" and "whether it has to be switched cannot be told, for no gait" in found.sentence
        )
        assert "with a fixed spring no gait was found" in found.sentence

    def test_a_single_start_is_no_agreement(self, study):
        found = study(Stub(), speeds=(2.0,), stiffnesses=(40.0,))
        lone = replace(found, tries={point: tries[:1] for point, tries in found.tries.items()})
        assert math.isnan(answer(lone).spread)

    def test_a_finer_mesh_that_fails_is_said_and_one_that_is_cheaper_counts(self, study):
        def cheaper(point, start):
            return {NONE: 1.0, FIXED: 0.9, SWITCHED: 0.8}[point.kind]

        class Finer(Stub):
            def __call__(self, robot, motors, search):
                gait, found, solution = super().__call__(robot, motors, search)
                if search.meshes == FINER and search.point.kind == FIXED:
                    raise NoGait("it is so", 1.0)
                return gait, replace(found, cost=found.cost * (0.95 if search.meshes == FINER else 1.0)), solution

        found = study(Finer(costs=cheaper), speeds=(2.0,), stiffnesses=(40.0,))
        said = answer(found)
        assert found.best[NONE].cost == pytest.approx(0.95) and found.best[FIXED].cost == 0.9
        assert found.at(Point(NONE, 2.0)) == found.best[NONE] and said.by_speed[2.0].saving == said.saving
        assert said.mesh == pytest.approx(0.05) and math.isnan(found.changes[FIXED])
        assert "no gait was found on a finer mesh with a fixed one" in said.cautions


def test_a_gait_at_a_limit_of_the_search_is_told(study):
    """Without a spring too, where it makes the springs look better than they are."""

    class Held(Stub):
        def __call__(self, robot, motors, search):
            gait, found, solution = super().__call__(robot, motors, search)
            held = ("frequency is the largest allowed",) * (search.point.kind == NONE)
            return gait, replace(found, held=held), solution

    found = study(Held(), speeds=(2.0,), stiffnesses=(40.0,))
    (said,) = [caution for caution in answer(found).cautions if "limits hold" in caution]
    assert said.startswith("without a spring, limits hold the best: frequency is") and "springs then save less" in said
    assert len(found.searches) == len({each.key for each in found.searches}) > len(found.best)


def test_the_store_names_what_is_studied(study, tmp_path):
    study(Stub(), speeds=(2.0,), stiffnesses=(40.0,))
    head = json.loads((tmp_path / "store.jsonl").read_text(encoding="utf-8").splitlines()[0])
    assert head["speeds"] == [2.0] and "virtual_stiffness=None" in head["request"]
