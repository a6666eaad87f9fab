"""The page of a release: what is played is the release, held before it by a hand."""

import numpy as np
import pytest
from lxml import etree

from spear_pin.studies.push_test import WITH_MOTOR, WITHOUT_MOTOR, release, rest_at, spear_ii
from spear_pin.viz import release_page
from tests.viz.samples import ODD


@pytest.fixture
def played(monkeypatch, tmp_path):
    """Plays a release, and gives what the player was handed."""
    seen = {}
    monkeypatch.setattr(
        release_page, "record", lambda robot, motion, path, title: seen.update(motion=motion, title=title)
    )

    def play(leg, knee):
        result = release(leg, knee)
        release_page.record_release(leg, knee, result, tmp_path / "x.html", title="x")
        return seen["motion"], result

    return play


def test_motion(played):
    leg = spear_ii()
    motion, result = played(leg, WITH_MOTOR)
    assert motion.t[0] == -0.5 and motion.t[1] == motion.t[2] == 0.0
    np.testing.assert_array_equal(motion.q[:2], motion.q[[2, 2]])
    np.testing.assert_allclose(motion.q[2:, 2], result.angle, atol=1e-12)
    assert max(np.abs(leg.robot.toe_position(q, "toe")).max() for q in motion.q[::97]) < 1e-12
    assert [event.name for event in motion.events] == ["release"]
    assert set(motion.domain[2:]) == {"pinned"} and motion.engaged.all()


def test_hand_bears_the_spring(played):
    """Held down, hand and weight stand on the toe: by virtual work of the hand along the hip's height."""
    leg = spear_ii()
    motion, result = played(leg, WITH_MOTOR)
    angle, step = result.angle[0], 1e-5
    sinks = (leg.hip_height(angle + step) - leg.hip_height(angle - step)) / (2 * step)
    hand = (48.25 * (angle - 1.0) + float(leg.gravity(angle))) / -sinks
    assert motion.force[0, 0, 1] == pytest.approx(9.81 * 6.8 + hand, rel=1e-7)
    assert motion.force[0, 0, 1] == pytest.approx(146.4, abs=0.1) and motion.force[0, 0, 1] > motion.force[2, 0, 1]


def test_says_where_the_pin_pulls(played):
    leg = spear_ii(None)
    motion, result = played(leg, rest_at(leg, WITHOUT_MOTOR, 1.0))
    assert motion.events[1].time == result.lift_off
    pulls = np.array(motion.domain[2:]) == "pulls"
    np.testing.assert_array_equal(pulls, result.force[:, 1] < 0)


def test_writes_a_page(tmp_path):
    leg = spear_ii()
    motion = release(leg, WITH_MOTOR, duration=0.2)
    path = release_page.record_release(leg, WITH_MOTOR, motion, tmp_path / "a.html", title=ODD)
    assert path.stat().st_size > 100_000
    assert etree.HTML(path.read_text(encoding="utf-8")).xpath("//h1/text()") == [ODD]
