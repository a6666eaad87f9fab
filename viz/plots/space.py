"""Plots of a motion in space, in the style of `plots`: footfalls, the way from above, and turning.

Each leg has its own colour, that of its footprints on the page.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.symmetry import ROLL, YAW, X, Y
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.chain import CHAIN
from spear_pin.viz.playback.footfalls import color_of, footfalls, label_of
from spear_pin.viz.plots.paper import BLUE, Picture, legend_above, style
from spear_pin.words import significant

STRAIGHT = 1e-4  # °/s: what turns more slowly goes straight
OFTEN = 40  # footprints of a foot above which they are small


@typed
def space_summary(trajectory: Trajectory, cycles: int | None = None) -> Figure:
    """Plots a motion in space at a glance: footfalls, the way from above, torso, adductions and forces.

    Args:
        trajectory: trajectory of a quadruped on a chain.
        cycles: number of strides to draw over time, from the first; None: all. The whole way is drawn.

    Raises:
        BadValue: the trajectory is not in space, or has less than two samples.
        UnknownName: its robot is not found.
    """
    _check(trajectory)
    shown = trajectory if cycles is None or trajectory.cycles <= cycles else trajectory.in_cycles(1, cycles)
    with style():
        figure = Picture(figsize=(7.0, 8.2), layout="constrained")
        grid = figure.add_gridspec(5, 2)
        way, falls = figure.add_subplot(grid[0:2, 0]), figure.add_subplot(grid[0, 1])
        others = [figure.add_subplot(grid[1, 1], sharex=falls)]
        others += [figure.add_subplot(grid[row, column], sharex=falls) for row in (2, 3, 4) for column in (0, 1)]
        draw_way(way, trajectory)
        draw_footfalls(falls, shown)
        yaw, roll, across, adductions, torques, normal, lateral = others
        draw_heading(yaw, shown)
        draw_roll(roll, shown)
        draw_speed_across(across, shown)
        draw_adductions(adductions, shown)
        draw_adduction_torques(torques, shown)
        draw_forces(normal, shown)
        draw_forces(lateral, shown, "across")
        for panel in (falls, *others[:-2]):
            panel.set_xlabel("")
            panel.tick_params(labelbottom=False)
        for letter, panel in zip("abcdefghi", (way, falls, *others), strict=True):
            panel.text(-0.02, 1.03, f"({letter})", transform=panel.transAxes, va="bottom", ha="right")
        return figure


@typed
def footfall_diagram(motions: dict[str, Trajectory]) -> Figure:
    """Plots footfalls of one stride of each motion, one below the other: a bar per leg over the stride's share.

    Args:
        motions: motions with a whole stride, by the titles of their panels.

    Raises:
        BadValue: there are no motions, or one has no whole stride.
    """
    if not motions:
        raise BadValue("motions", motions, "one at least")
    with style():
        figure = Picture(figsize=(5.2, 0.35 + 1.0 * len(motions)), layout="constrained")
        axes = figure.subplots(len(motions), 1, sharex=True, squeeze=False)[:, 0]
        for panel, (title, trajectory) in zip(axes, motions.items(), strict=True):
            draw_footfalls_of_a_stride(panel, trajectory)
            panel.set_title(title, loc="left", fontsize="medium")
            if panel is not axes[-1]:
                panel.set_xlabel("")
        return figure


@typed
def way_from_above(trajectory: Trajectory) -> Figure:
    """Plots the way of the torso on the ground, and where feet came down."""
    _check(trajectory)
    with style():
        figure = Picture(figsize=(3.4, 3.4), layout="constrained")
        draw_way(figure.subplots(), trajectory)
        return figure


# one panel each, into axes of the caller's


def draw_footfalls(axes: Axes, trajectory: Trajectory) -> None:
    """Draws when each foot is on the ground, a row for each, in the plane too."""
    _bars(axes, trajectory, 0.0, 1.0)
    axes.set_xlim(trajectory.t[0], trajectory.t[-1])
    axes.set_xlabel("Time (s)")


def draw_footfalls_of_a_stride(axes: Axes, trajectory: Trajectory, cycle: int = 1) -> None:
    """Draws the same over the share of one stride, from a cycle on, until each foot has been down.

    Where halves of a stride are mirror images, as in a trot, the stride has two cycles.

    Raises:
        BadValue: there is no such stride.
    """
    last = next((last for last in range(cycle, trajectory.cycles + 1) if _all_down(trajectory, cycle, last)), None)
    if cycle < 1 or last is None:
        expected = f"the first of a whole stride among {trajectory.cycles} cycles ({trajectory.message})"
        raise BadValue("cycle", cycle, expected)
    stride = trajectory.in_cycles(cycle, last)
    _bars(axes, stride, float(stride.t[0]), 100.0 / float(np.ptp(stride.t)))
    axes.set_xlim(0.0, 100.0)
    axes.set_xlabel("Share of the stride (%)")


def draw_way(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the way of the torso and footprints, x to the right, y up, in one scale."""
    robot, q, colors = trajectory.load_robot(), trajectory.q, _colors(trajectory)
    axes.plot(q[:, X], q[:, Y], color="0.35", label="torso")
    for number, toe in enumerate(trajectory.toes):
        rows = _landed(trajectory.force[:, number])
        prints = np.array([robot.frame_position(q[row], toe)[:2] for row in rows]).reshape(-1, 2)
        size = 3.0 if len(prints) <= OFTEN else 1.5
        axes.plot(
            *prints.T,
            "o",
            color=colors[number],
            markersize=size,
            markeredgewidth=0.0,
            label=label_of(toe),
        )
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x (m)")
    axes.set_ylabel("y (m)")
    legend_above(axes, 3)


def draw_heading(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the heading over time, to the left; for a turning gait, with the mean rate over the whole strides."""
    _over_time(axes, trajectory, "Heading (°)")
    t, yaw = trajectory.t, np.degrees(trajectory.q[:, YAW])
    whole = (trajectory.cycle >= 1) & (trajectory.cycle <= trajectory.cycles)
    rate = np.ptp(yaw[whole][[0, -1]]) / np.ptp(t[whole]) if trajectory.cycles else 0.0
    axes.plot(t, yaw, color=BLUE, label=f"{significant(rate)}°/s in the mean")
    if rate >= STRAIGHT:
        legend_above(axes, 1)


def draw_roll(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the roll of the torso over time."""
    _over_time(axes, trajectory, "Roll, to the right (°)")
    axes.plot(trajectory.t, np.degrees(trajectory.q[:, ROLL]), color=BLUE)


def draw_speed_across(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the velocity of the torso across its heading over time."""
    yaw, (vx, vy) = trajectory.q[:, YAW], trajectory.v[:, [X, Y]].T
    _over_time(axes, trajectory, "Speed to the left (m/s)")
    axes.plot(trajectory.t, np.cos(yaw) * vy - np.sin(yaw) * vx, color=BLUE)


def draw_adductions(axes: Axes, trajectory: Trajectory) -> None:
    """Draws adduction angles over time, to the left."""
    _over_time(axes, trajectory, "Adduction (°)")
    columns = [trajectory.coordinates.index(joint) for joint in _adductions(trajectory)]
    _by_leg(axes, trajectory, [np.degrees(trajectory.q[:, column]) for column in columns])


def draw_adduction_torques(axes: Axes, trajectory: Trajectory) -> None:
    """Draws torques of the adduction motors over time."""
    _over_time(axes, trajectory, "Adduction motor of a leg (N·m)")
    columns = [trajectory.actuated.index(joint) for joint in _adductions(trajectory)]
    _by_leg(axes, trajectory, [trajectory.u[:, column] for column in columns])


def draw_forces(axes: Axes, trajectory: Trajectory, part: str = "normal") -> None:
    """Draws a part of the ground force on each foot over time; impulses at touchdown are not in it.

    Args:
        axes: axes to draw into.
        trajectory: the trajectory.
        part: "normal", or "across": to the left of the heading.

    Raises:
        UnknownName: `part` is neither.
    """
    if part not in ("normal", "across"):
        raise UnknownName("part of the force", part, ("normal", "across"))
    yaw = trajectory.q[:, YAW, None]
    x, y, z = np.moveaxis(trajectory.force, 2, 0)
    values = z if part == "normal" else np.cos(yaw) * y - np.sin(yaw) * x
    _over_time(
        axes, trajectory, "Normal force on a foot (N)" if part == "normal" else "Force on a foot, to the left (N)"
    )
    _by_leg(axes, trajectory, list(values.T))


# what the panels share


def _check(trajectory: Trajectory) -> None:
    if trajectory.coordinates[: len(CHAIN)] != CHAIN:
        raise BadValue("trajectory.coordinates", trajectory.coordinates, "those of a robot on a chain in space")
    if len(trajectory.t) < 2:
        raise BadValue("trajectory.t", trajectory.t, "at least two samples")


def _adductions(trajectory: Trajectory) -> list[str]:
    """Returns names of the joints that swing the legs sideways, in the order of the toes."""
    joints = [leg.abduction for leg in trajectory.load_robot().legs]
    found = [joint for joint in joints if joint is not None]
    if len(found) < len(trajectory.toes):
        raise BadValue("trajectory.robot", trajectory.robot, "a robot whose legs swing sideways")
    return found


def _all_down(trajectory: Trajectory, first: int, last: int) -> bool:
    rows = (trajectory.cycle >= first) & (trajectory.cycle <= last)
    return bool((trajectory.force[rows, :, -1] > 0.0).any(axis=0).all())


def _bars(axes: Axes, trajectory: Trajectory, begin: float, scale: float) -> None:
    feet = footfalls(trajectory.toes, trajectory.t, trajectory.force)
    for row, foot in enumerate(feet[::-1]):
        for first, last in foot.spans:
            axes.barh(row, scale * (last - first), 0.6, scale * (first - begin), color=foot.color, gid=foot.toe)
    axes.set_yticks(range(len(feet)), [foot.label for foot in feet[::-1]])
    axes.set_ylim(-0.5, len(feet) - 0.5)


def _landed(force: Array) -> NDArray[np.intp]:
    bears = np.concatenate(([False], force[:, -1] > 0.0))
    return np.flatnonzero(np.diff(bears.astype(int)) == 1)


def _over_time(axes: Axes, trajectory: Trajectory, label: str) -> None:
    axes.axhline(0.0, color="0.6", linewidth=0.5)
    axes.set_xlim(trajectory.t[0], trajectory.t[-1])
    axes.set_xlabel("Time (s)")
    axes.set_ylabel(label)


def _by_leg(axes: Axes, trajectory: Trajectory, lines: Sequence[Array]) -> None:
    for toe, values, color in zip(trajectory.toes, lines, _colors(trajectory), strict=True):
        axes.plot(trajectory.t, values, color=color, label=label_of(toe), linewidth=0.9)


def _colors(trajectory: Trajectory) -> list[str]:
    return [color_of(number, len(trajectory.toes)) for number in range(len(trajectory.toes))]
