"""Plots for a paper: one style sheet, units on every axis, stance shaded.

This module has plots of a trajectory, and `save_figure`; plots of a study are in the module with its name. Plots are
`matplotlib.figure.Figure`s that belong to no window, and notebooks show them; make your own as a `Picture`. Within
`style()`, the functions `draw_...` draw the same into axes of your own.
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
