"""Gauss's points along arcs: as many panels as a motion needs, whatever the engine's steps were."""

import math

import numpy as np
import pytest

from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.tangent.collocation import ENDS, INSIDE, POINTS, rule
from spear_pin.hybrid.tangent.points import MOST_PANELS, points
from spear_pin.hybrid.tangent.resets import NotDifferentiable

FLIGHT = Domain("flight", "flight", ("open",), lambda *given: [])


def arc(motion, steps=0):
    y, after = motion(np.array([1.0, 3.0])).T
    return Arc(FLIGHT, {}, 1.0, y, 3.0, after, None, 0, motion, steps)


def waves(rate):
    return lambda t: np.array([np.sin(rate * t), rate * np.cos(rate * t)])


@pytest.mark.parametrize("steps", [0, 1, INSIDE.steps + 1, 40, 330, 5000])
def test_steps_are_only_a_first_guess(steps):
    t, lengths, y = points(arc(waves(20.0), steps))
    panels = len(lengths)
    assert len(t) == panels * POINTS and lengths.sum() == pytest.approx(2.0)
    assert panels >= min(math.ceil(steps / INSIDE.steps), MOST_PANELS)
    assert panels >= 11 and (steps > 40 or panels <= 14)
    np.testing.assert_array_equal(y, waves(20.0)(t))
    assert 1.0 < t[0] < t[-1] < 3.0 and (np.diff(t) > 0.0).all()


def test_panels_are_short_where_the_motion_is_rough():
    """A root's singularity just before the arc, as where a toe begins to slide: equal panels would be 500."""
    _, lengths, y = points(arc(lambda t: np.array([np.sqrt(t - 0.999), 0.5 / np.sqrt(t - 0.999)])))
    assert lengths.sum() == pytest.approx(2.0) and len(lengths) <= 24
    assert lengths[0] < 0.01 < 0.2 < lengths[-1]
    end = 1.0 + np.cumsum(lengths)
    speeds = y[1].reshape(len(lengths), POINTS) @ rule().weights
    np.testing.assert_allclose(np.cumsum(lengths * speeds), np.sqrt(end - 0.999) - np.sqrt(0.001), rtol=1e-12)


def test_fewer_panels_where_only_ends_count():
    motion = arc(waves(20.0), 6)
    fine, coarse = points(motion), points(motion, ENDS)
    assert coarse[1].max() > fine[1].max() and len(coarse[0]) < len(fine[0])


@pytest.mark.parametrize("steps", [0, 5000])
def test_what_is_not_smooth_is_refused(steps):
    with pytest.raises(NotDifferentiable, match="the motion in flight is not smooth over 2 s"):
        points(arc(lambda t: np.array([np.abs(t - 2.1), np.sign(t - 2.1)]), steps))


def test_rounding_does_not_hold_the_panels_up(monkeypatch):
    """A motion that is too rough by the last digit gets a panel more."""
    seen = []

    def rough(states):
        seen.append(len(states))
        return np.full(len(states), INSIDE.tail * (1.0 + 5e-15 if len(states) < 12 else 1.0))

    monkeypatch.setattr("spear_pin.hybrid.tangent.points.roughness", rough)
    points(arc(waves(1.0), 10 * INSIDE.steps))
    assert seen == [10, 11, 12]


def test_the_most_panels_are_tried():
    """A motion for which one panel seems to ask for more of them than there may be."""
    t, _, _ = points(arc(waves(110.0)))
    assert 8 * POINTS < len(t) <= MOST_PANELS * POINTS
