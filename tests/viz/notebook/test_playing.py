"""Players in a notebook."""

import html
import re
from dataclasses import replace

import pytest

from spear_pin import Trajectory
from spear_pin.errors import BadFile, BadValue
from tests.viz.recording import read


def test_is_the_page_in_a_frame(hops, tmp_path):
    player = Trajectory.load(hops.in_cycles(3, 4).save(tmp_path / "two.npz")).play(title="two hops", height=333)
    frame = re.fullmatch(r'<iframe srcdoc="([^"]*)" style="([^"]*)"[^>]*></iframe>', player._repr_html_())
    assert frame and "height:333px" in frame[2]
    assert html.unescape(frame[1]) == player.page
    data = read(player.page).data
    assert data["title"] == "two hops" and data["start"] == pytest.approx(hops.in_cycles(3).t[0])
    assert player.save(tmp_path / "two.html").read_text(encoding="utf-8") == player.page
    assert len(repr(player)) < 100


def test_of_a_robot_that_is_not_found(hops, robot):
    lost = replace(hops.in_cycles(1), origin=None, robot="lost.urdf")
    with pytest.raises(BadValue, match=r"lost\.urdf.*play\(robot\)"):
        lost.play()
    assert read(lost.play(robot).page).data["title"] == "spear_ii"


def test_gaps_are_refused(hops):
    with pytest.raises(BadValue, match="in_cycles"):
        hops.in_phase("flight").play()


@pytest.mark.parametrize("height", [0, -3, float("nan"), "tall"])
def test_a_height_that_is_none(hops, height):
    with pytest.raises(BadValue, match="height"):
        hops.play(height=height)


def test_into_a_folder_that_is_not_there(hops, robot, tmp_path):
    with pytest.raises(BadFile, match="nowhere"):
        hops.in_cycles(1).play(robot).save(tmp_path / "nowhere" / "x.html")
