"""Plots of energy and hardware: the flow of Fig. 4.1, costs of transport, currents, heights and angles of hopping.

They have the style of `plots`. Computed values say so, and unverified ones are hollow.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise, product

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from spear_pin.errors import BadValue
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.studies.energetics import EnergyFlow
from spear_pin.studies.published_costs import UNVERIFIED, CostPoint, Kind, running_animals
from spear_pin.viz.plots.panels import draw_angle, draw_height
from spear_pin.viz.plots.paper import (
    BLUE,
    GREEN,
    PURPLE,
    STANCE,
    STANCE_COLOR,
    VERMILLION,
    Picture,
    legend_above,
    style,
)
from spear_pin.viz.plots.sankey import KEPT, LOST, Sankey

LOSSES = {
    "joule": "Joule heat",
    "gearbox": "gears",
    "damping": "joint damping",
    "friction": "joint friction",
    "impact": "impact",
    "released": "springs let go",
    "slip": "slip",
}
ACROSS = {"left": 4.0, "right": -4.0, "center": 0.0}  # where a name may stand about its point, in points
UPRIGHT = {"bottom": 1.5, "top": -1.5, "center": 0.0}
MARKERS: dict[Kind, str] = {"electrical": "s", "mechanical": "D", "metabolic": "o", "fuel": "^"}
CLEAN = "without hardware"
DETAIL = 3  # hops that show details


def energy_flow(flow: EnergyFlow) -> Figure:
    """Plots energy from the batteries to the ground as bands, as in Fig. 4.1, in J a cycle and in % of the input.

    The width of a band is its energy; wanted flows are green, losses red, stored energy is blue.

    Raises:
        BadValue: the batteries give nothing, or the net work of the motors is not positive.
    """
    given, work = flow.total("given"), flow.total("motor")
    if not (given > 0.0 and work > 0.0):
        raise BadValue(
            "flow", (given, work), "two numbers > 0, in J: energy from the batteries, and work of the motors"
        )
    with style():
        figure = Picture()
        axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.set_axis_off()
        sankey = Sankey(axes, given)
        sankey.up("back to\nbatteries", flow.total("regained"))
        for name in ("joule", "gearbox"):
            parts = [f"{each.joint.replace('_', ' ')} {getattr(each, name):.2f}" for each in flow.joints]
            sankey.down(LOSSES[name], flow.losses[name], LOST, parts)
        sankey.down("inductances", flow.magnetic, KEPT)
        sankey.label("motors' work", work)
        sankey.loop(flow.spring_stored, flow.spring_returned)
        sankey.into("from what\nwas stored", -flow.change - min(flow.magnetic, 0.0))
        for name in ("damping", "friction", "impact", "released", "slip"):
            sankey.down(LOSSES[name], flow.losses[name], LOST)
        sankey.down("stored", flow.change, KEPT)
        sankey.fit(figure)
        return figure


def cost_of_transport(points: Sequence[CostPoint], computed: Sequence[CostPoint] = ()) -> Figure:
    """Plots cost of transport over mass, as in Fig. 2.4, with the line of running animals.

    The marker is the kind of energy. Unverified points are hollow; computed points are red and labelled so.

    Args:
        points: published points, see `spear_pin.studies.published_costs`.
        computed: computed points, see `spear_pin.studies.energetics.compute_points`.

    Raises:
        BadValue: there are no points.
    """
    everything = [*points, *computed]
    if not everything:
        raise BadValue("points", points, "at least one")
    masses = np.array([point.mass for point in everything])
    span = np.geomspace(0.4 * masses.min(), 3.0 * masses.max(), 50)
    with style():
        figure = Picture(figsize=(5.2, 4.0), layout="constrained")
        axes = figure.subplots()
        axes.plot(span, [running_animals(mass) for mass in span], color=GREEN, label="running animals (recollection)")
        for point in everything:
            ours = point in computed
            color = VERMILLION if ours else BLUE
            face = "none" if point.verification in UNVERIFIED else color
            label = f"{point.name} (computed)" if ours else point.name
            (drawn,) = axes.plot(point.mass, point.cost, MARKERS[point.kind], color=color, markersize=4.5, gid=label)
            drawn.set_markerfacecolor(face)
        axes.set(xscale="log", yscale="log", xlim=(span[0], span[-1]))
        axes.set_xlabel("Mass (kg)")
        axes.set_ylabel("Cost of transport")
        kinds = dict.fromkeys(point.kind for point in everything)
        handles = [axes.lines[0], *(_marker(MARKERS[kind], "0.3", kind) for kind in kinds)]
        handles.append(_marker("o", "none", "hollow: unverified"))
        figure.legend(handles=handles, loc="outside upper left", ncols=3)
        _name(figure, axes)
        return figure


def currents(trajectory: Trajectory, hops: int = DETAIL) -> Figure:
    """Plots the current of each motor and its command, over the first hops, as in Fig. 4.12.

    Args:
        trajectory: a trajectory with hardware.
        hops: number of hops.

    Raises:
        BadValue: the trajectory is without hardware.
    """
    if not trajectory.current.size:
        raise BadValue("trajectory.current", trajectory.current.shape, "currents, of a system with hardware")
    shown = trajectory.cycle <= hops
    with style():
        figure = Picture(figsize=(7.0, 2.3), layout="constrained")
        panels = figure.subplots(1, len(trajectory.actuated), squeeze=False)[0]
        for axes, i in zip(panels, reversed(range(len(trajectory.actuated))), strict=True):
            for begin, end in _stances(trajectory):
                axes.axvspan(begin, end, color=STANCE_COLOR, zorder=0, gid=STANCE)
            axes.axhline(0.0, color="0.6", linewidth=0.5)
            for values, color, line, label in (
                (trajectory.current, BLUE, "-", "actual"),
                (trajectory.reference, VERMILLION, "--", "reference"),
            ):
                axes.plot(*_pieces(trajectory.t[shown], values[shown, i]), line, color=color, label=label)
            axes.set_xlim(trajectory.t[shown][[0, -1]])
            axes.set_xlabel("Time (s)")
            axes.set_ylabel(f"{trajectory.actuated[i].replace('_', ' ').capitalize()} current (A)")
            legend_above(axes)
        return figure


def heights(trajectory: Trajectory, clean: Trajectory | None = None) -> Figure:
    """Plots the height of the hip over all hops, as in Fig. 4.13, with the range of the apexes.

    Args:
        trajectory: motion of the robot.
        clean: the same motion without hardware.
    """
    vertical = trajectory.coordinates.index("boom_z")
    with style():
        figure = Picture(figsize=(7.0, 2.3), layout="constrained")
        axes = figure.subplots()
        draw_height(axes, trajectory)
        if clean is not None:
            axes.plot(clean.t, clean.q[:, clean.coordinates.index("boom_z")], "--", color=PURPLE, lw=0.8, label=CLEAN)
        legend_above(axes)
        apexes = [event.q[vertical] for event in trajectory.named("apex")]
        if len(apexes) > 1:
            text = f"{len(apexes)} apexes within {1e3 * np.ptp(apexes):.1f} mm"
            axes.text(1.0, 1.02, text, transform=axes.transAxes, ha="right", va="bottom", fontsize=7.5)
        return figure


def angles_against(trajectory: Trajectory, clean: Trajectory, gait: Gait | None = None, hops: int = DETAIL) -> Figure:
    """Plots hip and knee over the first hops, as in Fig. 4.11, with the same motion without hardware.

    Args:
        trajectory: motion of the robot.
        clean: the same motion without hardware.
        gait: if given, the angles that its law commands in flight are drawn as well.
        hops: number of hops.
    """
    shown = trajectory.t[trajectory.cycle <= hops]
    with style():
        figure = Picture(figsize=(7.0, 2.4), layout="constrained")
        for axes, joint in zip(figure.subplots(1, 2), ("hip", "knee"), strict=True):
            draw_angle(axes, trajectory, joint, gait)
            axes.plot(clean.t, clean.q[:, clean.coordinates.index(joint)], "-.", color=PURPLE, label=CLEAN)
            axes.set_xlim(shown[0], shown[-1])
            legend_above(axes)
        return figure


# what the panels share


def _marker(marker: str, face: str, label: str) -> Line2D:
    return Line2D([], [], linestyle="", marker=marker, color="0.3", markerfacecolor=face, markersize=4.5, label=label)


def _name(figure: Figure, axes: Axes) -> None:
    """Names the points by their gid, the longest names first, each on the side where it hides least."""
    figure.draw_without_rendering()  # to have the layout
    points = sorted((line for line in axes.lines if line.get_gid()), key=lambda line: -len(str(line.get_gid())))
    taken = [line.get_window_extent().padded(2.0) for line in points]
    line = axes.transData.transform(axes.lines[0].get_xydata())
    crossed = [Bbox([begin, end]) for begin, end in pairwise(line)]
    for point in points:
        (x, y), label = axes.transData.transform(point.get_xydata())[0], str(point.get_gid())
        found: list[tuple[float, Text]] = []
        for (across, dx), (upright, dy) in product(ACROSS.items(), UPRIGHT.items()):
            left, low = axes.transData.inverted().transform((x + dx * figure.dpi / 72, y + dy * figure.dpi / 72))
            name = axes.text(left, low, label, ha=across, va=upright, fontsize=6.5)
            box = name.get_window_extent()
            outside = box.x0 < axes.bbox.x0 or box.x1 > axes.bbox.x1
            hidden = box.count_overlaps(taken) + 0.5 * min(box.count_overlaps(crossed), 1) + 2.0 * outside
            found.append((hidden, name))
        best = min(found, key=lambda each: each[0])[1]
        taken.append(best.get_window_extent())
        for _, name in found:
            if name is not best:
                name.remove()


def _stances(trajectory: Trajectory) -> list[tuple[float, float]]:
    """Returns when the robot comes down and lifts off, in s."""
    down = np.char.find(trajectory.phase, STANCE) >= 0
    edges = np.flatnonzero(np.diff(np.concatenate(([False], down, [False])).astype(int)))
    return [(trajectory.t[first], trajectory.t[end - 1]) for first, end in list(pairwise(edges))[::2]]


def _pieces(t: np.ndarray, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Returns a line that is interrupted at events, where it jumps."""
    jumps = np.flatnonzero(np.diff(t) <= 0.0) + 1
    return np.insert(t, jumps, np.nan), np.insert(values, jumps, np.nan)
