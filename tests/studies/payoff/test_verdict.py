"""Verdicts of a payoff study, each for its reason, by tables of searches that are written by hand."""

import math

import pytest

from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.studies.payoff.verdict import SPRING, SWITCHABLE, UNKNOWN, Outcome, judge, spread

LOST = math.inf


def table(none=(), fixed=(), switched=(), *, at=6.0, more=()):
    """Outcomes of searches: costs without a spring, and with springs of one stiffness, and more of them."""
    kinds = {NONE: (0.0, none), FIXED: (at, fixed), SWITCHED: (at, switched)}
    return [Outcome(kind, k, cost) for kind, (k, costs) in kinds.items() for cost in costs] + list(more)


def free(kind, stiffness, cost):
    return Outcome(kind, stiffness, cost, chosen=True)


class TestASavingThatEveryStartShows:
    def test_half_by_either_spring(self):
        """A leg of 2.1 kg: free searches that ended at 9 and at 27 N·m/rad say nothing against it."""
        ends = [free(FIXED, 9.0, 4.4), free(FIXED, 27.0, 2.2), free(SWITCHED, 9.1, 4.9), free(SWITCHED, 20.0, 3.9)]
        for more, saved, spring in (([], 0.498, 6.0), (ends, 0.827, 27.0)):
            found = judge(table((12.74, 12.742), (6.39, 6.391), (6.52, 6.52), more=more), (6.0,))
            assert found.verdict == FIXED and found.pays == {FIXED: True, SWITCHED: True} and found.why == ""
            assert found.saving[FIXED] == pytest.approx(saved, abs=1e-3)
            assert found.best[FIXED].stiffness == spring
        assert found.outside == {FIXED: 27.0, SWITCHED: 20.0}

    def test_though_starts_differ_by_more_than_it(self):
        """They differ by 25 and by 100 %, and each spring that was found is below each knee without one."""
        found = judge(table((10.0, 12.5), (4.0, 8.0), (9.0, 9.0)), (6.0,))
        assert found.pays[FIXED] is True and found.spread[FIXED] == pytest.approx(1.0)
        assert found.verdict == FIXED and found.saving[FIXED] == pytest.approx(0.6)

    def test_of_one_stiffness_though_starts_of_another_do_not_agree(self):
        other = [Outcome(FIXED, 9.0, 8.0), Outcome(FIXED, 9.0, 30.0)]
        found = judge(table((10.0, 10.0), (7.0, 7.1), (9.9, 9.9), more=other), (6.0, 9.0))
        assert found.pays[FIXED] is True

    def test_by_a_spring_that_one_search_found(self):
        """The gait is there; what has to be sure is that without a spring there is none so cheap."""
        found = judge(table((10.0, 10.0), (5.0, LOST), (9.95, 9.95)), (6.0,))
        assert found.pays[FIXED] is True and math.isnan(found.spread[FIXED])


class TestTheSwitch:
    def test_is_better(self):
        found = judge(table((10.0, 10.1), (9.0, 9.1), (7.0, 7.2)), (6.0,))
        assert found.verdict == SWITCHABLE and found.saving == pytest.approx({FIXED: 0.1, SWITCHED: 0.3})

    def test_is_the_only_one_that_saves(self):
        """The fixed one saves 1 %, the other 2.5 %: less than 2 % lie between them."""
        assert judge(table((100.0, 100.0), (99.0, 99.0), (97.5, 97.5)), (6.0,)).verdict == SWITCHABLE

    def test_adds_nothing(self):
        assert judge(table((10.0, 10.0), (7.1, 7.1), (7.0, 7.0)), (6.0,)).verdict == FIXED

    def test_is_open_where_its_starts_differ(self):
        found = judge(table((10.0, 10.0), (9.0, 9.0), (8.0, 11.2)), (6.0,))
        assert found.verdict == SPRING and found.pays == {FIXED: True, SWITCHED: None}
        assert "9 with a fixed spring of 6 N·m/rad, 8 to 11.2 with a switchable spring of 6 N·m/rad" in found.why

    def test_is_open_where_no_fixed_spring_has_a_gait(self):
        found = judge(table((10.0, 10.0), (LOST, LOST), (8.0, 8.0)), (6.0,))
        assert found.verdict == SPRING and found.why == "no gait was found with a fixed spring of 6 N·m/rad"
        assert math.isnan(found.saving[FIXED]) and found.pays == {FIXED: None, SWITCHED: True}


class TestNoSaving:
    def test_is_sure_where_every_start_shows_it(self):
        found = judge(table((10.0, 10.0), (11.0, 11.2), (9.9, 9.9)), (6.0,))
        assert found.verdict == NONE and found.pays == {FIXED: False, SWITCHED: False} and found.why == ""

    def test_though_one_search_only_found_a_gait_without(self):
        """That gait is there, and springs cost more from every start."""
        assert judge(table((10.0, LOST), (11.0, 11.0), (12.0, 12.0)), (6.0,)).verdict == NONE

    def test_is_not_sure_by_one_search_of_a_spring(self):
        found = judge(table((10.0, 10.0), (11.0, LOST), (12.0, 12.0)), (6.0,))
        assert found.verdict == UNKNOWN
        assert found.why == "one search only found a gait with a fixed spring of 6 N·m/rad"

    def test_is_not_sure_where_a_stiffness_has_no_gait(self):
        more = [Outcome(kind, 9.0, 13.0) for kind in (SWITCHED, SWITCHED)]
        found = judge(table((10.0, 10.0), (11.0, 11.0), (12.0, 12.0), more=more), (6.0, 9.0))
        assert found.verdict == UNKNOWN and "with a fixed spring of 9 N·m/rad" in found.why


class TestCannotTell:
    def test_where_starts_differ_by_more_than_knees(self):
        found = judge(table((10.0, 30.0), (12.0, 12.0), (13.0, 13.0)), (6.0,))
        assert found.verdict == UNKNOWN and found.pays == {FIXED: None, SWITCHED: None}
        assert "10 to 30 without a spring, 12 with a fixed spring" in found.why

    def test_by_one_search_without_a_spring(self):
        found = judge(table((10.0,), (5.0, 5.0), (6.0, 6.0)), (6.0,))
        assert found.verdict == UNKNOWN and found.why == "one search only found a gait without a spring"

    def test_that_one_again_on_a_finer_mesh_is_no_second_start(self):
        again = [Outcome(NONE, 0.0, 10.0, again=True)]
        assert judge(table((10.0,), (5.0, 5.0), (6.0, 6.0), more=again), (6.0,)).verdict == UNKNOWN

    def test_unless_starts_of_that_search_ended_alike(self):
        agreed = [Outcome(NONE, 0.0, 10.0, starts=2)]
        assert judge(table((), (5.0, 5.0), (6.0, 6.0), more=agreed), (6.0,)).verdict == FIXED

    def test_without_a_gait_without_a_spring(self):
        found = judge(table((LOST, LOST), (5.0, 5.0), (6.0, 6.0)), (6.0,))
        assert found.verdict == UNKNOWN and found.why == "no gait was found without a spring"
        assert all(map(math.isnan, found.saving.values()))

    @pytest.mark.parametrize("rows", [[], table((10.0, 10.0)), table((), (5.0, 5.0))])
    def test_where_there_is_nothing_to_compare(self, rows):
        found = judge(rows, (6.0,))
        assert found.verdict == UNKNOWN and found.why.startswith("no gait was found with")

    @pytest.mark.parametrize("cost", [math.nan, -1.0, 0.0, math.inf, -math.inf])
    def test_by_costs_that_are_none(self, cost):
        found = judge(table((10.0, 10.0), (cost, cost), (cost, cost)), (6.0,))
        assert found.verdict == UNKNOWN and FIXED not in found.best
        assert judge(table((cost, 10.0), (5.0, 5.0), (6.0, 6.0)), (6.0,)).why == (
            "one search only found a gait without a spring"
        )


class TestStiffnesses:
    def test_a_winner_outside_those_asked_for_is_told(self):
        more = [Outcome(kind, k, 8.0) for kind in (FIXED, SWITCHED) for k in (9.0, 9.0)]
        rows = table(
            (10.0, 10.0), (8.5, 8.5), (8.6, 8.6), more=[*more, free(FIXED, 23.2, 2.0), free(SWITCHED, 7.0, 7.0)]
        )
        found = judge(rows, (6.0, 9.0))
        assert found.outside == {FIXED: 23.2} and found.best[SWITCHED].stiffness == 7.0

    def test_a_chosen_one_like_one_asked_for_is_a_start_of_that(self):
        found = judge(table((10.0, 10.0), (5.0,), (6.0, 6.0), more=[free(FIXED, 6.01, 5.5)]), (6.0,))
        assert found.spread[FIXED] == pytest.approx(0.1) and found.outside == {}

    def test_unlike_ones_are_not_compared(self):
        assert math.isnan(spread([free(FIXED, 9.0, 4.4), free(FIXED, 27.0, 2.2), free(SWITCHED, 9.0, 8.8)]))
        assert spread([Outcome(NONE, 0.0, 10.0), Outcome(NONE, 0.0, 12.0)]) == pytest.approx(0.2)
