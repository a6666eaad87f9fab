"""The page and the plots of a bound that was simulated."""

from __future__ import annotations

import re
from dataclasses import replace

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from spear_pin import Gait, Trajectory, simulate
from spear_pin.errors import BadValue
from spear_pin.model.robot import Robot
from spear_pin.viz import player
from spear_pin.viz.playback.overlays import arrow_path, spring_path
from spear_pin.viz.playback.scene import joint_paths
from spear_pin.viz.playback.stage import WORLD
from spear_pin.viz.player import in_words
from spear_pin.viz.plots import bound as bound_plots
from tests.viz.recording import Recording, read

LEGS = ("posterior", "anterior")
STRIDES = 5


@pytest.fixture(scope="module")
def gait() -> Gait:
    return Gait.load("long_stride")


@pytest.fixture(scope="module")
def robot(gait: Gait) -> Robot:
    return gait.system.robot


@pytest.fixture(scope="module")
def strides(gait: Gait) -> Trajectory:
    return simulate(gait.system, gait.state, STRIDES, progress=False)


@pytest.fixture(scope="module")
def page(robot: Robot, strides: Trajectory) -> str:
    return player.page(robot, strides)


@pytest.fixture(scope="module")
def recording(page: str) -> Recording:
    return read(page)


def middles(strides: Trajectory, phase: str) -> list[int]:
    """A sample in the middle of each time the phase is passed through."""
    chosen = np.flatnonzero(strides.phase == phase)
    return [int(group[len(group) // 2]) for group in np.split(chosen, np.flatnonzero(np.diff(chosen) > 1) + 1)]


PHASES = ("posterior_stance", "flight_1", "anterior_stance", "flight_2")


class TestPage:
    @pytest.mark.slow
    def test_both_coils_show_while_engaged(self, robot: Robot, strides: Trajectory, recording: Recording) -> None:
        paths = joint_paths(robot.model)
        for phase in PHASES:
            for leg in LEGS:
                parent = robot.model.parents[robot.model.getJointId(f"{leg}_knee")]
                path = spring_path(paths[parent], f"{leg}_knee")
                assert path in recording.paths
                for sample in middles(strides, phase):
                    shown = bool(recording.value(path, "visible", strides.t[sample])[0])
                    assert shown == (phase == f"{leg}_stance")

    @pytest.mark.slow
    def test_each_foot_of_a_pair_has_its_arrow(self, robot: Robot, strides: Trajectory, recording: Recording) -> None:
        for phase in PHASES:
            for sample in middles(strides, phase):
                time = strides.t[sample]
                for i, leg in enumerate(LEGS):
                    toe, sides = robot.toe_position(strides.q[sample], f"{leg}_toe"), []
                    for side in ("left", "right"):
                        path = arrow_path(f"{leg}_toe {side}")
                        assert bool(recording.value(path, "visible", time)[0]) == (phase == f"{leg}_stance")
                        if phase != f"{leg}_stance":
                            continue
                        pose = recording.pose(path, time)
                        base = np.linalg.inv(recording.pose(WORLD, time)) @ pose[:, 3]
                        force = strides.force[sample, i]
                        assert base[[0, 2]] == pytest.approx(toe, abs=1e-3)
                        assert pose[[0, 2], 2] @ force / np.linalg.norm(force) == pytest.approx(1.0, abs=1e-3)
                        sides.append(base[1])
                    assert sides == pytest.approx([0.16, -0.16][: len(sides)])

    @pytest.mark.slow
    def test_the_legend_gives_the_force_on_a_foot(self, strides: Trajectory, recording: Recording) -> None:
        peak = 0.5 * np.linalg.norm(strides.force, axis=2).max()
        (text,) = (text for text, _ in recording.data["legend"] if "force" in text)
        found = re.fullmatch(r"ground force on each foot, arrows up to (\d+) N", text)
        assert found and float(found[1]) == pytest.approx(peak, rel=0.01)

    @pytest.mark.slow
    def test_each_foot_has_its_path(self, recording: Recording) -> None:
        trails = [path for path in recording.paths if "path of" in path]
        assert sorted(trails) == [
            f"{WORLD}/path of {leg}_toe {side}" for leg in sorted(LEGS) for side in ("left", "right")
        ]

    def test_phases_and_events_in_words(self, recording: Recording) -> None:
        names = [span[0] for span in recording.data["spans"]]
        assert names == ["posterior stance", "flight 1", "anterior stance", "flight 2"] * STRIDES
        assert {"posterior touchdown", "anterior lift off"} <= {name for name, _ in recording.data["events"]}

    def test_the_picture_follows(self, strides: Trajectory, recording: Recording) -> None:
        times, shift = recording.track(WORLD, "position") or pytest.fail("the world does not move")
        assert np.abs(shift[:, 0] + np.interp(times, strides.t, strides.q[:, 0])).max() < 0.2
        assert np.ptp(shift[:, 0]) > 3.0

    def test_size(self, page: str) -> None:
        assert len(page.encode()) < 2_000_000


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("stance", "stance"),
        ("stance slip-", "stance, slipping"),
        ("posterior_stance slip+", "posterior stance, slipping"),
        ("double_1", "double stance 1"),
        ("double_2 anterior slip+", "double stance 2, anterior slipping"),
        ("double_1 posterior slip- anterior slip+", "double stance 1, posterior and anterior slipping"),
        ("posterior_lift_off", "posterior lift off"),
        ("slip", "slip"),
    ],
)
def test_names_in_words(name: str, words: str) -> None:
    assert in_words(name) == words


def line(axes: Axes, label: str) -> np.ndarray:
    drawn = next(line for line in axes.lines if line.get_label() == label)
    values = np.asarray(drawn.get_ydata(), dtype=float)
    return values[~np.isnan(values)]


@pytest.fixture(scope="module")
def figure(strides: Trajectory, gait: Gait) -> Figure:
    return bound_plots.bound_summary(strides, gait)


class TestPlots:
    def test_units_and_range(self, figure: Figure, strides: Trajectory) -> None:
        assert len(figure.axes) == 8
        for axes in figure.axes[1:]:
            assert re.search(r"\((m|mm|rad|N|N·m)\)$", axes.get_ylabel()), axes.get_ylabel()
        assert {axes.get_xlim() for axes in figure.axes} == {(0.0, strides.t[strides.cycle <= 2][-1])}

    def test_stances_are_shaded(self, figure: Figure, strides: Trajectory) -> None:
        for leg in LEGS:
            ends = [event.time for event in strides.named(f"{leg}_lift_off")]
            assert [end for _, end in bound_plots.stances(strides, leg)] == pytest.approx(ends)
            for axes in figure.axes:
                shades = [patch for patch in axes.patches if patch.get_gid() == f"{leg}_stance"]
                assert [shade.get_x() + shade.get_width() for shade in shades] == pytest.approx(ends)

    def test_foot_falls(self, figure: Figure, strides: Trajectory) -> None:
        falls = figure.axes[0]
        for leg in LEGS:
            bars = [patch for patch in falls.patches if patch.get_gid() == leg]
            spans = [(bar.get_x(), bar.get_x() + bar.get_width()) for bar in bars]
            assert np.array(spans) == pytest.approx(np.array(bound_plots.stances(strides, leg)))
            assert {to_hex(bar.get_facecolor()) for bar in bars} == {bound_plots.COLORS[leg].lower()}

    def test_torques_are_those_of_one_motor(self, figure: Figure, strides: Trajectory) -> None:
        hips, *knees = figure.axes[5:]
        for leg, knee in zip(LEGS, knees, strict=True):
            assert line(hips, leg) == pytest.approx(0.5 * strides.u[:, strides.actuated.index(f"{leg}_hip")])
            motor, spring, together = (line(knee, label) for label in ("motor", "spring", "together"))
            column = strides.actuated.index(f"{leg}_knee")
            assert motor == pytest.approx(0.5 * strides.u[:, column])
            assert together == pytest.approx(motor + spring)
            assert together == pytest.approx(0.5 * strides.tau[:, column], abs=1e-9)  # there is no damping

    def test_forces_show_in_stance_only(self, figure: Figure, strides: Trajectory) -> None:
        bearing = strides.phase == "posterior_stance"
        assert line(figure.axes[4], "normal") == pytest.approx(strides.force[bearing, 0, 1])

    def test_double_stance_is_stance_of_both(self, strides: Trajectory) -> None:
        changed = np.where(strides.phase == "flight_2", "double_2", strides.phase)
        other = replace(strides, phase=changed)
        begins = [event.time for event in strides.named("posterior_touchdown")]
        ends = [end for _, end in bound_plots.stances(other, "anterior")]
        assert ends == pytest.approx(begins)

    def test_mistakes(self, strides: Trajectory, gait: Gait) -> None:
        hop = replace(gait, system=replace(gait.system, kind="hopping"))
        with pytest.raises(BadValue, match="a bounding gait"):
            bound_plots.bound_summary(strides, hop)
        with pytest.raises(BadValue, match="two samples"):
            bound_plots.bound_summary(replace(strides, t=strides.t[:1]), gait)
