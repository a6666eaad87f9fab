"""Plots as for a paper: one style sheet, units on every axis, stance shaded.

Here are those of a trajectory, and `save_figure`; those of a study are in the module of its name. They are
`matplotlib.figure.Figure`s that belong to no window, and notebooks show them; a `Picture` is one of one's own. Within
`style()`, the functions `draw_...` draw the same into axes of one's own.
"""

from spear_pin.viz.plots.panels import draw_angle, draw_clearance, draw_energy, draw_force, draw_height, draw_torque
from spear_pin.viz.plots.paper import Picture, save_figure, style
from spear_pin.viz.plots.trajectory import (
    boom_height,
    energy_per_hop,
    ground_force,
    hop_summary,
    joint_angles,
    knee_torque,
)

__all__ = [
    "Picture",
    "boom_height",
    "draw_angle",
    "draw_clearance",
    "draw_energy",
    "draw_force",
    "draw_height",
    "draw_torque",
    "energy_per_hop",
    "ground_force",
    "hop_summary",
    "joint_angles",
    "knee_torque",
    "save_figure",
    "style",
]
