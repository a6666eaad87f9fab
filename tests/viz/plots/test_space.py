"""Plots of a motion in space, against the trajectory that they show."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

from spear_pin import Gait, Trajectory, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.viz import plots
from spear_pin.viz.playback.footfalls import COLORS
from spear_pin.viz.plots import space

KEPT = Path(__file__).parents[3] / "examples" / "turn.json"
LEGS = [f"{pair} {side}" for pair in ("posterior", "anterior") for side in ("left", "right")]


@pytest.fixture(scope="module")
def motion() -> Trajectory:
    gait = Gait.load(KEPT)
    return simulate(gait.system, gait.state, 2, progress=False)


@pytest.fixture(scope="module")
def planar() -> Trajectory:
    gait = Gait.load("long_stride")
    return simulate(gait.system, gait.state, 1, progress=False)


@pytest.fixture(scope="module")
def figure(motion: Trajectory) -> Figure:
    return space.space_summary(motion, 1)


def drawn(axes: object, label: str) -> np.ndarray:
    line = next(line for line in axes.lines if line.get_label() == label)  # type: ignore[attr-defined]
    return np.column_stack((line.get_xdata(), line.get_ydata()))


@pytest.mark.slow
def test_units(figure: Figure) -> None:
    way, falls, *others = figure.axes
    assert (way.get_xlabel(), way.get_ylabel()) == ("x (m)", "y (m)")
    for axes in others:
        assert re.search(r"\((m/s|°|N|N·m)\)$", axes.get_ylabel()), axes.get_ylabel()
    assert falls.get_xlim() == others[-1].get_xlim()


@pytest.mark.slow
def test_way_and_footprints(figure: Figure, motion: Trajectory) -> None:
    way, robot = figure.axes[0], motion.load_robot()
    np.testing.assert_array_equal(drawn(way, "torso"), motion.q[:, :2])
    assert way.get_aspect() == 1.0
    for number, (leg, toe) in enumerate(zip(LEGS, motion.toes, strict=True)):
        landed = [event.q for event in motion.named(f"{leg.replace(' ', '_')}_touchdown")]
        places = [robot.frame_position(q, toe)[:2] for q in landed]
        np.testing.assert_allclose(drawn(way, leg), places, atol=1e-9)
        line = next(line for line in way.lines if line.get_label() == leg)
        assert line.get_color() == COLORS[number]


def test_footfalls(motion: Trajectory) -> None:
    axes = space.footfall_diagram({"turning": motion}).axes[0]
    period = np.ptp(motion.t[motion.cycle == 1])
    assert [label.get_text() for label in axes.get_yticklabels()] == LEGS[::-1]
    for number, toe in enumerate(motion.toes):
        bars = [patch for patch in axes.patches if patch.get_gid() == toe]
        down = motion.named(f"{toe.removesuffix('_toe')}_touchdown")[0].time
        up = motion.named(f"{toe.removesuffix('_toe')}_lift_off")[0].time
        assert [bar.get_x() for bar in bars] == pytest.approx([100 * down / period], abs=1e-6)
        assert [bar.get_width() for bar in bars] == pytest.approx([100 * (up - down) / period], abs=1e-6)
        assert {to_hex(bar.get_facecolor()).upper() for bar in bars} == {COLORS[number]}


def test_footfalls_of_pairs_in_the_plane(planar: Trajectory) -> None:
    axes = space.footfall_diagram({"straight": planar}).axes[0]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["anterior", "posterior"]
    assert len(axes.patches) == 2


@pytest.mark.slow
def test_a_stride_of_mirrored_halves_has_two_cycles() -> None:
    gait = Gait.load("trot")
    trot = simulate(gait.system, gait.state, 3, progress=False)
    axes = space.footfall_diagram({"trot": trot}).axes[0]
    begins = {patch.get_gid().removesuffix("_toe"): patch.get_x() for patch in axes.patches}
    assert begins["posterior_left"] == pytest.approx(begins["anterior_right"], abs=0.5)
    assert begins["posterior_right"] == pytest.approx(begins["anterior_left"], abs=0.5)
    assert begins["posterior_right"] - begins["posterior_left"] == pytest.approx(50.0, abs=0.5)


def test_speed_and_force_are_across_the_heading(figure: Figure, motion: Trajectory) -> None:
    first = motion.in_cycles(1)
    left = np.column_stack((-np.sin(first.q[:, 3]), np.cos(first.q[:, 3])))
    speed, force = figure.axes[4], figure.axes[8]
    np.testing.assert_allclose(speed.lines[-1].get_ydata(), (left * first.v[:, :2]).sum(axis=1), atol=1e-12)
    expected = (left[:, None] * first.force[:, :, :2]).sum(axis=2)
    for number, leg in enumerate(LEGS):
        np.testing.assert_allclose(drawn(force, leg)[:, 1], expected[:, number], atol=1e-9)
    assert expected.sum(axis=1).mean() > 0.0, "inward, to the left"


def test_the_force_on_toes_has_two_parts(motion: Trajectory) -> None:
    axes = plots.ground_force(motion).axes[0]
    force = motion.force[:, 1]
    normal, tangential = (drawn(axes, f"{part} of posterior right toe") for part in ("normal", "tangential"))
    np.testing.assert_array_equal(normal[:, 1], force[:, 2])
    np.testing.assert_allclose(tangential[:, 1], np.linalg.norm(force[:, :2], axis=1))


def test_mistakes(motion: Trajectory, planar: Trajectory) -> None:
    with pytest.raises(BadValue, match="chain in space"):
        space.space_summary(planar)
    with pytest.raises(BadValue, match="one at least"):
        space.footfall_diagram({})
    with pytest.raises(BadValue, match="whole stride"):
        space.draw_footfalls_of_a_stride(Figure().subplots(), motion, 3)
    with pytest.raises(UnknownName, match="along"):
        space.draw_forces(Figure().subplots(), motion, "along")
