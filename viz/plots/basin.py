"""Maps of basins of attraction: over two pushes, and over a grid of states."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.studies.basin.attraction import ELSEWHERE, Attraction
from spear_pin.viz.plots.paper import Picture, legend_above, style

# a gait that is lost is grey, in shades that a print still tells apart
LOST = {"fall": "0.80", "no_event": "0.55", ELSEWHERE: "#d55e00", "zeno": "black"}
WORDS = {
    "fall": "falls",
    "no_event": "stays down",
    ELSEWHERE: "goes on elsewhere",
    "zeno": "events accumulate",
    "painleve": "Painlevé's paradox",
}
OTHER = "black"


def basin_map(strides: ArrayLike, axes: Mapping[str, ArrayLike]) -> Figure:
    """Plots strides to recovery over a grid of pushes, hatched where the gait is lost.

    Args:
        strides: result of `basin`.
        axes: axes that `basin` was given.

    Raises:
        BadValue: the shapes do not fit.
    """
    counts = np.asarray(strides, dtype=float)
    (first, rows), (second, columns) = ((name, np.asarray(values, dtype=float)) for name, values in axes.items())
    if counts.shape != (len(rows), len(columns)):
        raise BadValue("strides", counts.shape, f"an array of {len(rows)} x {len(columns)}")
    with style():
        figure = Picture(figsize=(3.4, 2.8), layout="constrained")
        panel = figure.subplots()
        panel.set_facecolor("0.9")
        across, up = _edges(columns), _edges(rows)
        panel.fill_between(across[[0, -1]], up[0], up[-1], facecolor="none", edgecolor="0.55", hatch="////", gid="lost")
        top = max(float(np.nanmax(counts)), 1.0) if np.isfinite(counts).any() else 1.0
        mesh = panel.pcolormesh(across, up, np.ma.masked_invalid(counts), cmap="cividis_r", vmin=0.0, vmax=top)
        panel.axhline(0.0, color="black", linewidth=0.4)
        panel.axvline(0.0, color="black", linewidth=0.4)
        panel.set_xlim(across[0], across[-1])
        panel.set_ylim(up[0], up[-1])
        panel.set_xlabel(_push(second))
        panel.set_ylabel(_push(first))
        figure.colorbar(mesh, label="Strides to 1 % of the error", ticks=MaxNLocator(integer=True))
        lost = Patch(facecolor="0.9", edgecolor="0.55", hatch="////", label="lost")
        legend_above(panel, handles=[lost])
        return figure


def attraction_map(found: Attraction, rows: ArrayLike, columns: ArrayLike, up: str, across: str) -> Figure:
    """Plots how many cycles states of a grid take to the gait, and how the other states end.

    Args:
        found: result of `attraction` for a grid with the columns varying fastest.
        rows: values of the first axis, equally spaced.
        columns: values of the second axis, equally spaced.
        up: label of the first axis, with its unit.
        across: label of the second axis, with its unit.

    Raises:
        BadValue: the number of states differs from the grid's.
    """
    y, x = np.asarray(rows, dtype=float), np.asarray(columns, dtype=float)
    if found.cycles.shape != (y.size * x.size,):
        raise BadValue("found", found.cycles.shape, f"a grid of {y.size} x {x.size} states")
    shape = y.size, x.size
    cycles, reason = found.cycles.reshape(shape), found.reason.reshape(shape)
    options: dict[str, Any] = {
        "extent": _extent(x) + _extent(y),
        "origin": "lower",
        "aspect": "auto",
        "interpolation": "none",
    }
    with style():
        figure = Picture(figsize=(4.4, 3.2), layout="constrained")
        axes = figure.subplots()
        present = [name for name in np.unique(reason).tolist() if name != "reached"]
        for name in present:
            shade = np.where(reason == name, 0.0, np.nan)
            color = ListedColormap([LOST.get(name, OTHER)])
            axes.imshow(shade, cmap=color, **options)
        top = float(np.nanmax(cycles)) if np.isfinite(cycles).any() else 1.0
        picture = axes.imshow(cycles, cmap="cividis_r", vmin=1.0, vmax=top, **options)
        axes.set_xlabel(across)
        axes.set_ylabel(up)
        figure.colorbar(picture, label="Cycles to the gait", ticks=MaxNLocator(integer=True))
        if present:
            patches = [Patch(facecolor=LOST.get(name, OTHER), label=WORDS.get(name, name)) for name in present]
            figure.legend(handles=patches, loc="outside upper left", ncols=len(patches))
        return figure


def _push(name: str) -> str:
    unit = "m/s" if name in ("torso_x", "torso_z") else "rad/s"
    return f"Push on {name.replace('_', ' ')} ({unit})"


def _edges(values: Array) -> Array:
    """Returns edges of cells around values."""
    if len(values) < 2:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middle = 0.5 * (values[1:] + values[:-1])
    return np.concatenate([[2 * values[0] - middle[0]], middle, [2 * values[-1] - middle[-1]]])


def _extent(values: Array) -> tuple[float, float]:
    half = 0.5 * (values[-1] - values[0]) / max(values.size - 1, 1) or 0.5
    return float(values[0] - half), float(values[-1] + half)
