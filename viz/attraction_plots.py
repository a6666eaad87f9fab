"""Plots of basins of attraction, in the style of `plots`."""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MaxNLocator
from numpy.typing import ArrayLike, NDArray

from spear_pin.errors import BadValue
from spear_pin.studies.basin.attraction import ELSEWHERE, Attraction
from spear_pin.viz.plots import style

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


def attraction_map(found: Attraction, rows: ArrayLike, columns: ArrayLike, up: str, across: str) -> Figure:
    """Over a grid of states, how many cycles they take to the gait, and what becomes of the others.

    Args:
        found: as of `attraction`, of a grid with the columns varying fastest.
        rows: values of the first axis, equally spaced.
        columns: values of the second axis, equally spaced.
        up: label of the first axis, with its unit.
        across: label of the second axis, with its unit.

    Raises:
        BadValue: there are not as many states as the grid has.
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
        figure = Figure(figsize=(4.4, 3.2), layout="constrained")
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


def _extent(values: NDArray[np.float64]) -> tuple[float, float]:
    half = 0.5 * (values[-1] - values[0]) / max(values.size - 1, 1) or 0.5
    return float(values[0] - half), float(values[-1] + half)
