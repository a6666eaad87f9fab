"""Recorded pages: what they hold, and that they are written whole or not at all."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any
from xml.sax.saxutils import quoteattr

import numpy as np
import pinocchio as pin
import pytest
from lxml import etree

from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.viz import player
from spear_pin.viz.playback import trajectory as pieces
from spear_pin.viz.playback.overlays import spring_path
from spear_pin.viz.playback.scene import joint_paths
from spear_pin.viz.playback.stage import WORLD
from spear_pin.viz.template import asset
from spear_pin.viz.template import library as meshcat
from tests.viz import samples
from tests.viz.recording import Recording, read

UPLOT = "bench/vendor/uplot.js"
USER_URDF = """<?xml version="1.0"?>
<robot name="pogo">
  <material name="red"><color rgba="0.8 0.1 0.1 1"/></material>
  <link name="world"/>
  <link name="body">
    <inertial><mass value="2"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><box size="0.2 0.1 0.1"/></geometry><material name="red"/></visual>
    <visual><geometry><mesh filename="package://nowhere/cover.stl"/></geometry></visual>
  </link>
  <link name="leg">
    <inertial>
      <origin xyz="0 0 -0.2"/><mass value="1"/>
      <inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/>
    </inertial>
    <visual><geometry><mesh filename="leg.dae"/></geometry></visual>
  </link>
  <link name="tip"/>
  <joint name="up" type="prismatic">
    <parent link="world"/><child link="body"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="0" velocity="9"/>
  </joint>
  <joint name="spring/slide" type="prismatic">
    <parent link="body"/><child link="leg"/><axis xyz="0 0 1"/>
    <limit lower="-9" upper="9" effort="0" velocity="9"/>
  </joint>
  <joint name="end" type="fixed"><parent link="leg"/><child link="tip"/><origin xyz="0 0 -0.4"/></joint>
</robot>
"""


def test_page_fetches_nothing(hop_page: str) -> None:
    # the library names addresses in its texts; the security policy keeps it from using them
    own = re.sub(r"<!--.*?-->", "", hop_page.replace(meshcat(), "").replace(asset(UPLOT), ""), flags=re.DOTALL)
    assert "http:" not in own and "https:" not in own and "//" not in own.replace("// ", "").split("<body>")[0]
    assert set(re.findall(r"(?:src|href)\s*=\s*[\"']?([^\"'\s>]*)", own)) <= {"data:,"}
    assert not re.search(r"@import|url\(|fetch\(|XMLHttpRequest|WebSocket|import\(", own)
    assert "default-src 'none'" in own and "connect-src" not in own


def test_page_names_the_licences_of_what_it_holds(hop_page: str) -> None:
    assert "Three.js Authors" in hop_page
    assert "Permission is hereby granted" in hop_page
    assert "Copyright (c) 2022 Leon Sorokin" in hop_page


def test_pages_are_small(hop_page: str) -> None:
    assert len(hop_page.encode()) <= 1_250_000
    assert len(player.page(load("q_spear"), samples.bound()).encode()) <= 1_600_000


@pytest.mark.slow
def test_a_long_motion_gets_fewer_frames(spear: Robot) -> None:
    text = player.page(spear, samples.hop(hops=150, samples=40))
    assert len(text.encode()) <= player.MOST_BYTES
    assert read(text).data["duration"] > 60


def test_a_motion_too_long_is_refused(spear: Robot, hop: SimpleNamespace, tmp_path: Path) -> None:
    slow = SimpleNamespace(**{**vars(hop), "t": hop.t * 1e4, "events": []})
    with pytest.raises(BadValue, match="shorter"):
        player.record(spear, slow, tmp_path / "long.html")
    assert not list(tmp_path.iterdir())


def test_the_same_motion_gives_the_same_page(spear: Robot, hop: SimpleNamespace, hop_page: str) -> None:
    assert player.page(spear, hop, title="A hop") == hop_page


def test_page_data_names_domains_and_events(recording: Recording, hop: SimpleNamespace) -> None:
    data = recording.data
    assert [span[0] for span in data["spans"]] == ["stance", "flight", "stance", "flight"]
    assert data["spans"][1][1:] == pytest.approx([0.22, 0.22 + 3.2 / 9.81])
    assert data["events"][0] == ["liftoff", pytest.approx(0.22)]
    assert data["start"] == 3.0
    assert data["duration"] == pytest.approx(hop.t[-1] - 3.0)


def test_record_writes_a_file_with_spaces_and_a_title(spear: Robot, hop: SimpleNamespace, tmp_path: Path) -> None:
    folder = tmp_path / "two words"
    folder.mkdir()
    path = player.record(spear, hop, str(folder / "my hop é.html"), title="</script><b>A & B")
    assert path == folder / "my hop é.html"
    text = path.read_text(encoding="utf-8")
    assert "<title>&lt;/script&gt;&lt;b&gt;A &amp; B</title>" in text
    assert read(text).data["title"] == "</script><b>A & B"
    assert [entry.name for entry in folder.iterdir()] == ["my hop é.html"]


def test_record_writes_all_or_nothing(
    spear: Robot, hop: SimpleNamespace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "hop.html"
    path.write_text("before")

    def fail(*_: object) -> None:
        raise OSError(28, "No space left on device")

    with monkeypatch.context() as patch:
        patch.setattr(os, "replace", fail)
        with pytest.raises(BadFile, match="No space left"):
            player.record(spear, hop, path)
    assert path.read_text() == "before"
    assert list(tmp_path.iterdir()) == [path]
    player.record(spear, hop, path)
    assert path.read_text(encoding="utf-8").startswith("<!DOCTYPE html>")


@pytest.mark.parametrize("where", ["", "missing/hop.html"])
def test_record_needs_a_file_in_a_folder(spear: Robot, hop: SimpleNamespace, tmp_path: Path, where: str) -> None:
    with pytest.raises(BadValue, match="existing folder"):
        player.record(spear, hop, tmp_path / where)


def pogo(tmp_path: Path, name: str = "pogo", mesh: str = "leg.dae") -> tuple[Robot, SimpleNamespace]:
    path = tmp_path / "pogo stick.urdf"
    path.write_text(USER_URDF.replace('"pogo"', quoteattr(name)).replace('"leg.dae"', quoteattr(mesh)))
    t = np.linspace(0.0, 1.0, 30)
    return load(path, toes=["tip"], motors=[]), SimpleNamespace(
        t=t,
        q=np.column_stack((0.4 + 0.1 * np.sin(6 * t), 0.05 * np.sin(6 * t))),
        domain=["ride"] * 30,
        force=np.zeros((30, 1, 2)),
        events=(),
        spring_joints=("spring/slide",),
        engaged=t < 0.5,
    )


def test_a_users_urdf_plays_without_its_meshes(tmp_path: Path) -> None:
    robot, trajectory = pogo(tmp_path)
    record = read(player.page(robot, trajectory))
    up, slide = joint_paths(robot.model)[1:]
    assert [record.color(path) for path in record.paths if path.startswith(f"{up}/shape")] == [0xCC1A1A]
    assert any(path.startswith(f"{slide}/shape") for path in record.paths), "a leg without shapes has a bone"
    cover = "mesh 'package://nowhere/cover.stl' of 'body' (no such file)"
    assert record.data["notes"] == [f"not drawn: {cover}, mesh 'leg.dae' of 'leg' (no such file)"]
    assert spring_path(up, "spring/slide") in record.paths
    assert not any("force" in path for path in record.paths)


def test_odd_names_are_shown_as_they_are(tmp_path: Path) -> None:
    robot, trajectory = pogo(tmp_path, name=samples.ODD, mesh=f"{samples.ODD}.dae")
    text = player.page(robot, trajectory)
    tree = etree.HTML(text)
    assert tree.xpath("//title/text()") == tree.xpath("//h1/text()") == [samples.ODD]
    assert len(tree.xpath("//script")) == 3 and not tree.xpath("//b")
    data = read(text).data
    assert data["title"] == samples.ODD and f"mesh {f'{samples.ODD}.dae'!r} of 'leg' (no such file)" in data["notes"][0]


def test_a_robot_whose_urdf_is_gone_plays_as_bones(tmp_path: Path) -> None:
    robot, trajectory = pogo(tmp_path)
    (tmp_path / "pogo stick.urdf").unlink()
    record = read(player.page(robot, trajectory))
    assert record.data["notes"][0].startswith("drawn as bones")
    assert any("shape" in path for path in record.paths)


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("t", [0.0]),
        ("t", "soon"),
        ("t", [[0.0, 1.0]]),
        ("q", np.zeros((3, 4))),
        ("force", np.zeros((640, 2, 2))),
        ("domain", ["stance"]),
        ("engaged", np.ones((640, 2), dtype=bool)),
        ("events", [SimpleNamespace(name="now", time="soon")]),
    ],
)
def test_bad_trajectories_are_refused(spear: Robot, hop: SimpleNamespace, field: str, value: object) -> None:
    with pytest.raises(BadValue, match=f"trajectory.{field}"):
        player.page(spear, SimpleNamespace(**{**vars(hop), field: value}))


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_refused(spear: Robot, hop: SimpleNamespace, bad: float) -> None:
    for field in ("t", "q", "force"):
        values = np.array(getattr(hop, field))
        values.flat[7] = bad
        with pytest.raises(BadValue, match=f"trajectory.{field}"):
            player.page(spear, SimpleNamespace(**{**vars(hop), field: values}))


def test_time_may_not_run_backward(spear: Robot, hop: SimpleNamespace) -> None:
    with pytest.raises(BadValue, match="nondecreasing"):
        player.page(spear, SimpleNamespace(**{**vars(hop), "t": hop.t[::-1]}))


def test_a_spring_needs_a_joint(spear: Robot, hop: SimpleNamespace) -> None:
    with pytest.raises(UnknownName, match="knee"):
        player.page(spear, SimpleNamespace(**{**vars(hop), "spring_joints": ("ankle",)}))


def test_importing_the_player_is_cheap() -> None:
    costly = {"meshcat", "zmq", "yourdfpy", "trimesh", "IPython", "jinja2"}
    script = f"import sys, spear_pin.viz.player; print({costly} & set(sys.modules))"
    done = subprocess.run([sys.executable, "-W", "error", "-c", script], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


@pytest.fixture
def sent(monkeypatch: pytest.MonkeyPatch) -> list[dict[str, Any]]:
    """What reaches the window of a meshcat that starts no server."""
    commands: list[dict[str, Any]] = []
    window = SimpleNamespace(send=lambda command: commands.append(command.lower()))
    fake = ModuleType("meshcat")
    vars(fake)["Visualizer"] = lambda: SimpleNamespace(window=window)
    monkeypatch.setitem(sys.modules, "meshcat", fake)
    return commands


def test_live_sends_the_same_scene(
    spear: Robot, hop: SimpleNamespace, recording: Recording, sent: list[dict[str, Any]]
) -> None:
    player.live(spear, hop, speed=0.5)
    assert [command["path"] for command in sent] == [command["path"] for command in recording.commands]
    clip = sent[-1]["animations"][0]["clip"]
    assert (clip["fps"], clip["duration"]) == (0.5, pytest.approx(2 * recording.data["duration"]))
    with pytest.raises(BadValue, match="speed"):
        player.live(spear, hop, speed=0.0)


def test_viewer_shows_a_configuration(spear: Robot, sent: list[dict[str, Any]]) -> None:
    q = np.array([0.3, 0.5, 0.4, 0.8])
    player.viewer(spear, q)
    record = Recording({}, (*sent, {"type": "set_animation", "animations": []}))
    data = spear.model.createData()
    pin.forwardKinematics(spear.model, data, q)
    shank = np.linalg.inv(record.pose(WORLD, 0.0)) @ record.pose(joint_paths(spear.model)[-1], 0.0)
    assert shank == pytest.approx(data.oMi[4].homogeneous, abs=1e-9)
    with pytest.raises(BadValue, match="boom_x, boom_z, hip, knee"):
        player.viewer(spear, [0.0])


class TestParts:
    @pytest.fixture
    def long(self, spear: Robot, monkeypatch: pytest.MonkeyPatch) -> SimpleNamespace:
        """Forty hops, and pages that hold four seconds of them."""
        hops = samples.hop(hops=40, samples=10)
        four = player.page(spear, samples.hop(hops=7, samples=10))
        monkeypatch.setattr(player, "MOST_BYTES", len(four.encode()))
        monkeypatch.setattr(player, "WORST_RATE", player.PART_RATE)
        return hops

    def test_what_fits_is_shown_whole(self, spear: Robot, hop: SimpleNamespace) -> None:
        assert player.shortened(spear, hop) is hop

    @pytest.mark.slow
    def test_the_last_part_of_a_long_motion(self, spear: Robot, long: SimpleNamespace, tmp_path: Path) -> None:
        with pytest.raises(BadValue, match="`shortened` makes one"):
            player.record(spear, long, tmp_path / "long.html")
        part = player.shortened(spear, long)
        assert isinstance(part, pieces.Part) and part.t[-1] == long.t[-1] and 2.0 < np.ptp(part.t) < np.ptp(long.t)
        text = player.record(spear, part, tmp_path / "part.html").read_text(encoding="utf-8")
        assert 0.95 * player.MOST_BYTES < len(text.encode()) <= player.MOST_BYTES
        data = read(text).data
        assert data["notes"] == [f"shown: {part.said}"]
        assert part.said == f"the last {np.ptp(part.t):.1f} s of 21.8 s, from {part.t[0]:.1f} to 21.8 s"
        assert data["start"] == part.t[0] and data["start"] + data["duration"] == pytest.approx(long.t[-1])
        assert all(0.0 <= time <= data["duration"] for _, time in data["events"])

    def test_the_first_part(self, spear: Robot, long: SimpleNamespace) -> None:
        part = player.shortened(spear, long, pieces.first)
        assert part.t[0] == long.t[0] and part.said.startswith("the first ")

    def test_a_part_of_ones_own(self, spear: Robot, hop: SimpleNamespace) -> None:
        part = pieces.between(hop, 3.1, 3.4)
        inside = (hop.t >= 3.1) & (hop.t <= 3.4)
        for name in ("t", "q", "domain", "force", "engaged"):
            np.testing.assert_array_equal(getattr(part, name), np.asarray(getattr(hop, name))[inside])
        assert [event.name for event in part.events] == ["liftoff"] and part.whole == (3.0, hop.t[-1])
        assert part.said.startswith("the middle 0.3 s of ")
        assert player.page(spear, part)

    def test_both_sides_of_an_event_at_its_end(self, hop: SimpleNamespace) -> None:
        touchdown = hop.events[1].time
        before, after = pieces.first(hop, touchdown - 3.0), pieces.last(hop, hop.t[-1] - touchdown)
        assert set(np.flatnonzero(hop.t == touchdown)) == {len(before.t) - 2, len(before.t) - 1}
        assert after.t[0] == after.t[1] == touchdown and len(before.t) + len(after.t) == len(hop.t) + 2

    def test_a_scene_that_leaves_no_room(
        self, spear: Robot, hop: SimpleNamespace, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(player, "MOST_BYTES", 1000)
        with pytest.raises(BadValue, match="a page of 1000 bytes"):
            player.page(spear, player.shortened(spear, hop))
