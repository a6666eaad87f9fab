"""A solution that is led along a way: how steps grow and shrink, and how far it comes."""

import pytest

from spear_pin.errors import NoGait
from spear_pin.gaits.leading import lead_along


def asked_of(steps, *, gap=(2.0, 2.0), **given):
    """The shares that are asked for, and where the way ends, if a step may not lead into a gap."""
    asked = []

    def solve(share, near):
        asked.append(share)
        if gap[0] < share < gap[1]:
            raise NoGait("there is none", share)
        return [*near, share]

    return asked, lead_along(solve, [0.0], **steps, **given)


def test_steps_double_up_to_the_longest_and_end_at_the_end():
    asked, way = asked_of({"first": 0.125, "shortest": 0.01, "longest": 0.5})
    assert asked == [0.125, 0.375, 0.875, 1.0]
    assert (way.done, way.failure) == (1.0, None) and way.end == [0.0, *asked]


def test_a_step_that_fails_is_halved_and_the_next_no_longer():
    asked, way = asked_of({"first": 0.5, "shortest": 0.01, "longest": 0.5}, gap=(0.9, 1.0 - 1e-9))
    assert asked == [0.5, 1.0] and way.failure is None
    asked, _ = asked_of({"first": 0.5, "shortest": 0.01}, gap=(0.3, 0.6))
    assert asked[:4] == [0.5, 0.25, 0.5, 0.375]


def test_it_ends_where_a_shorter_step_would_be_needed():
    asked, way = asked_of({"first": 0.25, "shortest": 0.05, "longest": 0.25}, gap=(0.3, 2.0))
    assert way.done == 0.25 and way.end == [0.0, 0.25] and asked == [0.25, 0.5, 0.375, 0.3125]
    assert str(way.failure) == str(NoGait("there is none", 0.3125))


def test_it_ends_when_it_is_enough():
    asked, way = asked_of({"first": 0.25, "shortest": 0.0}, gap=(0.3, 2.0), enough=lambda: True)
    assert asked == [0.25, 0.75] and way.failure is not None


def test_other_exceptions_are_not_swallowed():
    def solve(share, near):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        lead_along(solve, 0, first=0.5, shortest=0.1)
