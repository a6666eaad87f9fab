"""Figures of a trajectory: angles, ground force, torque, energy and height, and all of it at a glance."""

from __future__ import annotations

from matplotlib.figure import Figure

from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.viz.plots.panels import draw_angle, draw_clearance, draw_energy, draw_force, draw_height, draw_torque
from spear_pin.viz.plots.paper import Picture, style

DETAIL = 2  # cycles that a composite shows of the quantities that repeat


@typed
def joint_angles(trajectory: Trajectory, gait: Gait | None = None) -> Figure:
    """Plots hip and knee angles over time, with the angles that the springs latch at touchdown.

    Args:
        trajectory: motion of the robot.
        gait: if given, the angles that its law commands in flight are drawn as well.
    """
    with style():
        figure = Picture(figsize=(3.4, 3.2), layout="constrained")
        hip, knee = figure.subplots(2, 1, sharex=True)
        draw_angle(hip, trajectory, "hip", gait)
        draw_angle(knee, trajectory, "knee", gait)
        hip.set_xlabel("")
        return figure


@typed
def ground_force(trajectory: Trajectory) -> Figure:
    """Plots the ground force on each toe over time, tangential and normal; impulses at touchdown are not in it."""
    with style():
        figure = Picture(layout="constrained")
        draw_force(figure.subplots(), trajectory)
        return figure


@typed
def knee_torque(trajectory: Trajectory, joint: str = "knee") -> Figure:
    """Plots the torque on a knee over time, positive in flexion, split into motor, spring and damping."""
    with style():
        figure = Picture(layout="constrained")
        draw_torque(figure.subplots(), trajectory, joint)
        return figure


@typed
def energy_per_hop(trajectory: Trajectory) -> Figure:
    """Plots the energy ledger as stacked bars, one a hop: into the mechanism upward, out of it downward.

    The mark is the change of the stored energy, to which the bars add up. Flows too small to be seen are left out.

    Raises:
        BadValue: the trajectory has no whole hop.
    """
    with style():
        figure = Picture(layout="constrained")
        draw_energy(figure.subplots(), trajectory)
        return figure


@typed
def boom_height(trajectory: Trajectory) -> Figure:
    """Plots the height of the hip over time, and how far the toe is above the ground."""
    with style():
        figure = Picture(figsize=(3.4, 3.0), layout="constrained")
        height, clearance = figure.subplots(2, 1, sharex=True, height_ratios=(2, 1))
        draw_height(height, trajectory)
        draw_clearance(clearance, trajectory)
        height.set_xlabel("")
        return figure


@typed
def hop_summary(trajectory: Trajectory, gait: Gait | None = None) -> Figure:
    """Plots everything at a glance: height and energy of all hops; force, angles and torque of the first two.

    A leg with closed loops has the angles of its motors, and the torque of the last.

    Args:
        trajectory: motion of the robot.
        gait: if given, the angles that its law commands in flight are drawn as well.

    Raises:
        BadValue: the trajectory has no whole hop.
    """
    with style():
        figure = Picture(figsize=(7.0, 5.6), layout="constrained")
        axes = figure.subplots(3, 2)
        (height, energy), (hip, knee), (force, torque) = axes
        draw_height(height, trajectory)
        draw_energy(energy, trajectory)
        *others, last = trajectory.actuated if len(trajectory.actuated) <= 2 else ("hip", "knee")
        for joint in others:
            draw_angle(hip, trajectory, joint, gait)
        if not others:
            hip.set_axis_off()
        draw_angle(knee, trajectory, last, gait)
        draw_force(force, trajectory)
        draw_torque(torque, trajectory, last)
        shown = trajectory.t[trajectory.cycle <= DETAIL]
        for detail in (hip, knee, force, torque):
            detail.set_xlim(shown[0], shown[-1])
        for letter, panel in zip("abcdef", [each for each in axes.flat if each.axison], strict=False):
            panel.text(-0.17, 1.03, f"({letter})", transform=panel.transAxes, va="bottom")
        return figure
