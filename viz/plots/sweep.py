"""Maps of a sweep: the largest multiplier, and a solved number, over the first two parameters.

In the style of `plots`. Points without a gait are hatched on a grid, and crosses in a sample.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.model.variants import PARAMETERS
from spear_pin.viz.plots.paper import BLUE, VERMILLION, Picture, style, with_unit

UNITS = {
    "stiffness": "N·m/rad",
    "damping": "N·m·s/rad",
    "frequency": "Hz",
    "knee_touchdown": "rad",
    "hip_touchdown": "rad",
    "flight_time": "s",
    "stance_time": "s",
    "period": "s",
    "apex_height": "m",
    "mean_speed": "m/s",
    **dict.fromkeys(("stance_torque", "hip_stance_torque", "posterior_hip_torque"), "N·m"),
    **{name: parameter.unit for name, parameter in PARAMETERS.items()},
}


def sweep_map(dataset: Any) -> Figure:
    """Plots the largest multiplier, and the first solved number or else the period.

    The plot has lines over one parameter, cells over a grid of two, or points over a sample. With more parameters it
    shows the first two, with the others in sequence.

    Args:
        dataset: the Dataset that `studies.sweep.sweep` returned.

    Raises:
        BadValue: no gait was found, so that there is nothing to draw.
    """
    names, vary = list(dataset.attrs["names"]), list(dataset.attrs["vary"])
    axes = [dataset[name].to_numpy() for name in names]
    largest = dataset["largest_multiplier"].to_numpy()
    if not np.isfinite(largest).any():
        raise BadValue("dataset", f"{len(largest)} points", "a sweep in which a gait was found")
    solved = dataset[vary[0]].to_numpy() if vary else dataset["duration"].to_numpy().sum(axis=1)
    panels = {"Largest multiplier": largest, label(vary[0] if vary else "period"): solved}
    with style():
        figure = Picture(figsize=(7.0, 2.8), layout="constrained")
        for i, (panel, (title, values)) in enumerate(zip(figure.subplots(1, 2), panels.items(), strict=True)):
            panel.set_xlabel(label(names[0]))
            if len(names) == 1:
                _line(panel, axes[0], values, first=i == 0)
                panel.set_ylabel(title)
                continue
            panel.set_ylabel(label(names[1]))
            draw = _cells if _is_grid(axes) else _points
            drawn = draw(panel, axes[0], axes[1], values)
            bar = figure.colorbar(drawn, label=title)
            if i == 0:
                _stable(panel, axes, values)
                if np.nanmin(values) < 1.0 < np.nanmax(values):
                    bar.ax.axhline(1.0, color=VERMILLION)
        return figure


def _line(axes: Axes, x: Array, values: Array, *, first: bool) -> None:
    order = np.argsort(x, kind="stable")
    axes.plot(x[order], values[order], ".-", color=BLUE)
    if first:
        axes.axhline(1.0, color="0.6", linewidth=0.5)
    lost = x[~np.isfinite(values)]
    axes.plot(lost, np.full(len(lost), 0.05), "x", color="0.4", transform=axes.get_xaxis_transform(), gid="lost")


def _is_grid(axes: list[Array]) -> bool:
    """Tells whether two parameters form a grid, of more than a line."""
    counts = [len(np.unique(axis)) for axis in axes]
    return len(axes) == 2 and counts[0] * counts[1] == len(axes[0]) and min(counts) > 1


def _table(x: Array, y: Array, values: Array) -> tuple[Array, Array, Array]:
    """Returns values of a grid in rows of the same y."""
    across, i = np.unique(x, return_inverse=True)
    up, j = np.unique(y, return_inverse=True)
    table = np.full((len(up), len(across)), np.nan)
    table[j, i] = values
    return across, up, table


def _cells(axes: Axes, x: Array, y: Array, values: Array) -> Any:
    across, up, table = _table(x, y, values)
    axes.set_facecolor("0.9")
    edges = _edges(across), _edges(up)
    axes.fill_between(
        edges[0][[0, -1]], edges[1][0], edges[1][-1], facecolor="none", edgecolor="0.55", hatch="////", gid="lost"
    )
    axes.set_xlim(edges[0][0], edges[0][-1])
    axes.set_ylim(edges[1][0], edges[1][-1])
    return axes.pcolormesh(*edges, np.ma.masked_invalid(table), cmap="cividis", rasterized=table.size > 500)


def _points(axes: Axes, x: Array, y: Array, values: Array) -> Any:
    lost = ~np.isfinite(values)
    axes.plot(x[lost], y[lost], "x", color="0.6", markersize=2.5, gid="lost")
    return axes.scatter(x[~lost], y[~lost], c=values[~lost], s=6.0, cmap="cividis", linewidths=0.0)


def _stable(axes: Axes, given: list[Array], values: Array) -> None:
    """Draws the line on which the largest multiplier is 1."""
    if _is_grid(given) and np.nanmin(values) < 1.0 < np.nanmax(values):
        across, up, table = _table(given[0], given[1], values)
        axes.contour(across, up, np.ma.masked_invalid(table), levels=[1.0], colors=[VERMILLION], linewidths=0.8)


def _edges(values: Array) -> Array:
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def label(name: str) -> str:
    """Returns a parameter's or measure's name and unit, for an axis."""
    return with_unit(name, UNITS.get(name, "1"))
