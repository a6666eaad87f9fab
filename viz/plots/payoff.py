"""Maps of a payoff study: cost and saving over stiffness and speed for each knee, and the torques of its motor.

In the style of `plots`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.patches import Rectangle

from spear_pin.arrays import Array
from spear_pin.hybrid.simulate import simulate
from spear_pin.studies.design import joints_of, points_of
from spear_pin.studies.payoff import KINDS, Point, Study
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.viz.plots.paper import BLUE, GREEN, VERMILLION, style

TITLES = {NONE: "No spring", FIXED: "Fixed spring", SWITCHED: "Switchable spring"}
COLORS = {NONE: VERMILLION, FIXED: GREEN, SWITCHED: BLUE}
STIFFNESS = "Stiffness of a leg ({})"


def cost_map(study: Study) -> Figure:
    """Plots the electrical cost of each point, a panel for each kind of knee; hatched where no gait was found."""
    tables = {kind: costs(study, kind) for kind in KINDS}
    found = np.concatenate([table[np.isfinite(table)] for table in tables.values()])
    scale = Normalize(found.min(), found.max()) if len(found) else Normalize(0.0, 1.0)
    form = "{:.2f}" if found.max(initial=0.0) < 10.0 else "{:.1f}"
    with style():
        figure = Figure(figsize=(7.0, 2.6), layout="constrained")
        across = len(study.grid.stiffnesses)
        panels = figure.subplots(1, 3, sharey=True, width_ratios=[1.2, across, across])
        for panel, (kind, table) in zip(panels, tables.items(), strict=True):
            drawn = _cells(panel, table, study, scale, form, "cividis")
            panel.set_title(TITLES[kind])
            if kind != NONE:
                panel.set_xlabel(STIFFNESS.format(study.gaits.words.unit))
        panels[0].set_ylabel(study.gaits.words.axis)
        figure.colorbar(drawn, ax=panels, label=study.gaits.words.cost)
        return figure


def saving_map(study: Study) -> Figure:
    """Plots how much each spring saves of the cost of the knee without one, at the same speed."""
    bare = costs(study, NONE)
    tables = {kind: 100.0 * (1.0 - costs(study, kind) / bare) for kind in (FIXED, SWITCHED)}
    found = np.concatenate([table[np.isfinite(table)] for table in tables.values()])
    largest = float(np.abs(found).max(initial=1.0))
    with style():
        figure = Figure(figsize=(7.0, 2.6), layout="constrained")
        panels = figure.subplots(1, 2, sharey=True)
        for panel, (kind, table) in zip(panels, tables.items(), strict=True):
            drawn = _cells(panel, table, study, Normalize(-largest, largest), "{:.0f}", "RdBu")
            panel.set_title(TITLES[kind])
            panel.set_xlabel(STIFFNESS.format(study.gaits.words.unit))
        panels[0].set_ylabel(study.gaits.words.axis)
        figure.colorbar(drawn, ax=panels, label="Saved of the electricity (%)")
        return figure


def knee_torques(study: Study) -> Figure:
    """Plots the torque of one knee motor of each pair, or of the leg, over a cycle, for the best gaits by kind."""
    joints = joints_of(study.robot, "knee")
    with style():
        figure = Figure(figsize=(7.0, 2.4), layout="constrained")
        panels = np.atleast_1d(figure.subplots(1, len(joints), sharey=True))
        for kind, finding in study.best.items():
            gait = study.gait(finding)
            given = points_of(study.robot, simulate(gait.system, gait.state, progress=False), "knee")
            for panel, torque in zip(panels, given.torque.T, strict=True):
                panel.plot(given.t - given.t[0], torque, color=COLORS[kind], label=TITLES[kind])
        for panel, joint in zip(panels, joints, strict=True):
            panel.axhline(0.0, color="0.6", linewidth=0.5)
            panel.set_title(joint.replace("_", " ").capitalize())
            panel.set_xlabel(study.gaits.words.since)
        panels[0].set_ylabel("Torque of one motor (N·m)")
        panels[-1].legend(fontsize="x-small")
        return figure


def costs(study: Study, kind: str) -> Array:
    """Returns the cost of each point of a kind, a row for each speed; NaN where there is no gait."""
    stiffnesses = (0.0,) if kind == NONE else study.grid.stiffnesses
    rows = [[study.at(Point(kind, speed, k)) for k in stiffnesses] for speed in study.grid.speeds]
    return np.array([[np.nan if each is None else each.cost for each in row] for row in rows])


def _cells(axes: Axes, table: Array, study: Study, scale: Normalize, form: str, colors: str) -> Any:
    """Draws cells with their numbers; a table with one column has no stiffnesses."""
    grid, (up, across) = study.grid, table.shape
    hatched: dict[str, Any] = {"facecolor": "0.9", "edgecolor": "0.55", "hatch": "////", "linewidth": 0}
    axes.add_patch(Rectangle((0, 0), across, up, gid="lost", **hatched))
    drawn = axes.pcolormesh(np.ma.masked_invalid(table), cmap=colors, norm=scale)
    for (j, i), value in np.ndenumerate(table):
        if np.isfinite(value):
            rgb = drawn.cmap(scale(value))[:3]
            dark = float(np.dot(rgb, (0.299, 0.587, 0.114))) < 0.5
            ink = "w" if dark else "k"
            axes.text(i + 0.5, j + 0.5, form.format(value), ha="center", va="center", color=ink, fontsize=6)
    axes.set_yticks(np.arange(up) + 0.5, [f"{speed:.3g}" for speed in grid.speeds])
    if across > 1 or len(grid.stiffnesses) == 1:
        axes.set_xticks(np.arange(across) + 0.5, [f"{k:.3g}" for k in grid.stiffnesses])
    else:
        axes.set_xticks([])
    return drawn


FIGURES: Mapping[str, Callable[[Study], Figure]] = {"cost": cost_map, "saving": saving_map, "torque": knee_torques}
