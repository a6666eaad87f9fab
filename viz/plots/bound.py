"""Plots of a bound, in the style of `plots`: stance of each leg shaded, torques those of one motor."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import LEGS, PAIR
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.viz.plots.paper import BLUE, GREEN, VERMILLION, Picture, legend_above, style
from spear_pin.viz.plots.trajectory import DETAIL

COLORS = {"posterior": BLUE, "anterior": VERMILLION}
SHADES = {"posterior": "#dfe9f3", "anterior": "#f9e7db"}


def bound_summary(trajectory: Trajectory, gait: Gait) -> Figure:
    """Plots a bound at a glance: foot-falls, torso, ground forces and torques of the first two strides.

    Forces are those of a pair of legs, torques those of one motor, half of the pair's.

    Args:
        trajectory: motion of the robot.
        gait: the gait it shows, for the heights of its toes and the resting angle of its knees.

    Raises:
        BadValue: the gait is not a bounding gait, or there are no samples.
    """
    if gait.system.kind != "bounding":
        raise BadValue("gait", gait.system.kind, "a bounding gait")
    with style():
        figure = Picture(figsize=(7.0, 6.8), layout="constrained")
        axes = figure.subplots(4, 2, sharex=True)
        (falls, toes), (height, pitch), (force, hips), (posterior, anterior) = axes
        draw_foot_falls(falls, trajectory)
        draw_toes(toes, trajectory, gait)
        draw_torso(height, trajectory, "torso_z", "Height of the torso (m)")
        draw_torso(pitch, trajectory, "pitch", "Pitch, nose up (rad)")
        draw_forces(force, trajectory)
        draw_hips(hips, trajectory)
        draw_knee(posterior, trajectory, "posterior")
        draw_knee(anterior, trajectory, "anterior")
        for panel in axes[:-1].flat:
            panel.set_xlabel("")
        shown = trajectory.t[trajectory.cycle <= DETAIL]
        posterior.set_xlim(shown[0], shown[-1])
        for letter, panel in zip("abcdefgh", axes.flat, strict=True):
            panel.text(-0.17, 1.03, f"({letter})", transform=panel.transAxes, va="bottom")
        return figure


# one panel each, into axes of the caller's


def draw_foot_falls(axes: Axes, trajectory: Trajectory) -> None:
    """Draws when each pair of feet is on the ground."""
    _over_time(axes, trajectory, "Feet on the ground")
    for row, leg in enumerate(LEGS[::-1]):
        for begin, end in stances(trajectory, leg):
            axes.barh(row, end - begin, 0.5, begin, color=COLORS[leg], gid=leg)
    axes.set_yticks(range(len(LEGS)), LEGS[::-1])
    axes.set_ylim(-0.6, len(LEGS) - 0.4)


def draw_toes(axes: Axes, trajectory: Trajectory, gait: Gait) -> None:
    """Draws the height of the toes above the ground over time."""
    _over_time(axes, trajectory, "Toe height (mm)")
    for leg in LEGS:
        heights = np.array([gait.system.ground.foot(gait.system.robot, q, f"{leg}_toe")[0] for q in trajectory.q])
        axes.plot(trajectory.t, 1e3 * heights, color=COLORS[leg], label=leg)
    legend_above(axes)


def draw_torso(axes: Axes, trajectory: Trajectory, coordinate: str, label: str) -> None:
    """Draws one of the torso's coordinates over time."""
    _over_time(axes, trajectory, label)
    axes.plot(trajectory.t, trajectory.q[:, trajectory.coordinates.index(coordinate)], color="black")


def draw_forces(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the ground force on each pair of feet over time; impulses at touchdown are not in it."""
    _over_time(axes, trajectory, "Force on a pair (N)")
    for index, leg in enumerate(LEGS):
        for column, line, label in ((1, "-", "normal"), (0, "--", "tangential")):
            axes.plot(
                trajectory.t,
                np.where(_bears(trajectory, leg), trajectory.force[:, index, column], np.nan),
                line,
                color=COLORS[leg],
                label=label if index == 0 else None,
            )
    axes.axhline(0.0, color="0.6", linewidth=0.5)
    legend_above(axes)


def draw_hips(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the torque of one hip motor of each pair over time."""
    _over_time(axes, trajectory, "One hip motor (N·m)")
    axes.axhline(0.0, color="0.6", linewidth=0.5)
    for leg in LEGS:
        torque = trajectory.u[:, trajectory.actuated.index(f"{leg}_hip")] / PAIR
        _plot_pieces(axes, trajectory, torque, COLORS[leg], "-", leg)
    legend_above(axes)


def draw_knee(axes: Axes, trajectory: Trajectory, leg: str) -> None:
    """Draws the torque on one knee of a pair over time, and its motor's and spring's parts."""
    motor = trajectory.u[:, trajectory.actuated.index(f"{leg}_knee")] / PAIR
    spring = trajectory.spring[:, trajectory.spring_joints.index(f"{leg}_knee")] / PAIR
    _over_time(axes, trajectory, f"One {leg} knee (N·m)")
    axes.axhline(0.0, color="0.6", linewidth=0.5)
    _plot_pieces(axes, trajectory, motor + spring, "black", ":", "together")
    _plot_pieces(axes, trajectory, spring, GREEN, "-", "spring")
    _plot_pieces(axes, trajectory, motor, COLORS[leg], "-", "motor")
    legend_above(axes)


def stances(trajectory: Trajectory, leg: str) -> list[tuple[float, float]]:
    """Returns when a leg, "posterior" or "anterior", comes down and lifts off, in s."""
    t, bears = trajectory.t, _bears(trajectory, leg)
    edges = np.flatnonzero(np.diff(np.concatenate(([False], bears, [False])).astype(int)))
    spans = [(float(t[first]), float(t[end - 1])) for first, end in list(pairwise(edges))[::2]]
    return [(begin, end) for begin, end in spans if end > begin]


# what the panels share


def _bears(trajectory: Trajectory, leg: str) -> NDArray[np.bool_]:
    return np.asarray((trajectory.phase == f"{leg}_stance") | np.char.startswith(trajectory.phase, "double"))


def _over_time(axes: Axes, trajectory: Trajectory, label: str) -> None:
    if len(trajectory.t) < 2:
        raise BadValue("trajectory.t", trajectory.t, "at least two samples")
    for leg in LEGS:
        for begin, end in stances(trajectory, leg):
            axes.axvspan(begin, end, color=SHADES[leg], zorder=0, gid=f"{leg}_stance")
    axes.set_xlim(trajectory.t[0], trajectory.t[-1])
    axes.set_xlabel("Time (s)")
    axes.set_ylabel(label)


def _plot_pieces(axes: Axes, trajectory: Trajectory, values: Array, color: str, line: str, label: str) -> None:
    """Plots a line, interrupted where the phase changes and the torque jumps."""
    jumps = np.flatnonzero(trajectory.phase[1:] != trajectory.phase[:-1]) + 1
    times, pieces = np.insert(trajectory.t, jumps, np.nan), np.insert(values, jumps, np.nan)
    axes.plot(times, pieces, line, color=color, label=label)
