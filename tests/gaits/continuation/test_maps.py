"""Maps of a line, in pieces, and of two: every way in which a branch goes on, or ends, in closed form."""

import numpy as np
import pytest

from spear_pin.gaits.continuation.follow import follow
from spear_pin.gaits.continuation.problem import NoValue
from spear_pin.gaits.continuation.stepping import orient_tangent
from tests.gaits.continuation.plain import Plain, kinds

LEFT, RIGHT = (("left", "end"),), (("right", "end"),)
BOUNDS = (-1.0, 2.0)


def pieces(left, right, jump=0.0):
    """Map λ + left x where x < 0, λ + right x + jump elsewhere."""

    def returned(x, parameter):
        return (parameter + left * x, LEFT) if x[0] < 0.0 else (parameter + right * x + jump, RIGHT)

    return returned


def along(returned, x, parameter, bounds=BOUNDS, **options):
    """Down and up from a fixed point."""
    return Plain(returned, np.ones(np.size(x) + 1)).both_ways(np.atleast_1d(x), parameter, bounds, **options)


def at(way, index):
    return way.points[index].local.u


class TestBorders:
    def test_it_goes_on_where_both_maps_agree(self):
        _, up = along(pieces(0.5, -0.5), -1.0, -0.5)
        ((index, border),) = up.met
        assert border.kind == "continuous" and (border.inner.local.order, border.after) == (LEFT, RIGHT)
        assert at(up, index) == pytest.approx([0.0, 0.0], abs=1e-7)
        assert border.inner.local.multipliers == pytest.approx([0.5], abs=1e-6)
        assert border.outer.local.multipliers == pytest.approx([-0.5], abs=1e-6)
        assert up.end == "range" and at(up, -1) == pytest.approx([2.0 / 1.5, 2.0], abs=1e-9)

    @pytest.mark.parametrize("slope", [2.0, 10.0])  # beyond, ahead of the tangent before, and behind it
    def test_it_turns_back_where_the_other_map_has_it_on_the_same_side(self, slope):
        _, up = along(pieces(0.5, slope), -1.0, -0.5)
        ((index, border),) = up.met
        assert border.kind == "turned" and at(up, index) == pytest.approx([0.0, 0.0], abs=1e-7)
        assert up.end == "range" and at(up, -1) == pytest.approx([1.0 / (slope - 1.0), -1.0], abs=1e-9)
        assert up.points[-1].local.multipliers == pytest.approx([slope], abs=1e-6)

    @pytest.mark.parametrize("jump", [0.3, -0.3, 5.0])
    def test_it_ends_where_they_do_not(self, jump):
        _, up = along(pieces(0.5, -0.5, jump), -1.0, -0.5)
        ((_, border),) = up.met
        assert up.end == "border" and border.kind == "discontinuous" and border.outer is None
        assert border.after == RIGHT and border.jump == pytest.approx(abs(jump), rel=1e-3)
        assert at(up, -1) == pytest.approx([0.0, 0.0], abs=1e-7)

    def test_it_ends_where_the_cycle_does(self):
        def returned(x, parameter):
            if x[0] > 0.5:
                raise NoValue("fall", LEFT)
            return parameter + 0.5 * x, LEFT

        _, up = along(returned, 0.0, 0.0)
        ((_, border),) = up.met
        assert up.end == "border" and (border.kind, border.reason, border.after) == ("discontinuous", "fall", LEFT)
        assert at(up, -1) == pytest.approx([0.5, 0.25], abs=1e-5)

    def test_what_has_another_name_and_is_the_same_is_crossed(self):
        down, up = along(pieces(0.5, 0.5), 1.0, 0.5)
        assert kinds(down) == ["continuous"] and kinds(up) == []
        assert down.end == up.end == "range"


class TestSpecialPoints:
    def test_a_kink_without_another_order(self):
        def returned(x, parameter):
            return parameter + np.where(x < 0.0, 0.5, -3.0) * x, LEFT

        _, up = along(returned, -1.0, -0.5)
        assert kinds(up) == ["kink"] and up.met[0][1].critical.size == 0
        assert at(up, up.met[0][0]) == pytest.approx([0.0, 0.0], abs=1e-3)

    def test_branches_that_cross(self):
        down, up = along(lambda x, parameter: (x + x * (parameter - x), LEFT), 0.0, 0.5)
        assert kinds(down) == ["unit_multiplier"] and kinds(up) == []
        assert at(down, down.met[0][0]) == pytest.approx([0.0, 0.0], abs=1e-7)
        assert at(down, -1) == pytest.approx([0.0, -1.0], abs=1e-9)

    def test_a_neutral_saddle(self):
        down, up = along(lambda x, parameter: (x * [-2.0, -parameter], LEFT), [0.0, 0.0], 0.2)
        assert kinds(down) == [] and kinds(up) == ["neutral_saddle", "flip"]
        (_, saddle), (_, flip) = up.met
        assert saddle.point.local.u[-1] == pytest.approx(0.5, abs=1e-7)
        assert saddle.critical == pytest.approx([-2.0, -0.5], abs=1e-6)
        assert flip.point.local.u[-1] == pytest.approx(1.0, abs=1e-7)

    def test_several_on_one_step_come_in_order(self):
        _, up = along(lambda x, parameter: (x * [-parameter, -2.0 * parameter], LEFT), [0.0, 0.0], 0.2, longest=1.0)
        assert kinds(up) == ["flip", "neutral_saddle", "flip"]
        assert [met.point.local.u[-1] for _, met in up.met] == pytest.approx([0.5, 0.5**0.5, 1.0], abs=1e-7)


class TestEnds:
    def test_a_closed_branch_comes_back(self):
        down, _ = along(lambda x, parameter: (x + 0.3 * (1.0 - x**2 - parameter**2), LEFT), 1.0, 0.0, (-2.0, 2.0))
        assert down.end == "closed" and kinds(down) == ["fold", "fold"]
        assert [met.point.local.u[-1] for _, met in down.met] == pytest.approx([-1.0, 1.0], abs=1e-7)
        assert down.points[-1] is down.points[0]

    def test_enough_points(self):
        plain = Plain(pieces(0.5, 0.5), np.ones(2))
        local = plain.local(np.array([1.0, 0.5]))
        way = follow(plain, orient_tangent(local, np.array([0.0, 1.0])), (0.0, 9.0), 0.01, 7)
        assert way.end == "points" and len(way.points) == 7

    def test_a_start_on_the_range_s_end(self):
        down, up = along(pieces(0.5, 0.5), -2.0, -1.0)
        assert down.end == "range" and len(down.points) == 1
        assert up.end == "range" and at(up, -1)[-1] == pytest.approx(2.0)

    def test_it_does_not_jump_to_a_branch_beside(self):
        """Two lines 0.01 apart, the second steeper: steps that would land there are refused."""

        def returned(x, parameter):
            return x - (x - parameter) * (x - 1.5 * parameter - 0.01), LEFT

        _, up = along(returned, 0.5, 0.5, longest=0.2)
        assert at(up, -1) == pytest.approx([2.0, 2.0], abs=1e-7) and kinds(up) == []
