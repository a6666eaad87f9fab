"""Plot of an optimised design: its path, its parameters in their ranges, and the effect of assumptions."""

from __future__ import annotations

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from spear_pin.gaits.codesign.design import Design
from spear_pin.viz.plots.paper import BLUE, ORANGE, VERMILLION, Picture, style, with_unit

MOST = 10  # assumptions
LEAST = 1e-6  # of what is missed in all, the end of the scale


def optimised(design: Design) -> Figure:
    """Plots objective and missed bounds over iterations, parameters from start to end, and assumptions' elasticity."""
    count = len(design.parameters)
    names = design.ranked[:MOST]
    with style():
        rows = [2.2, 0.5 + 0.3 * count, 0.5 + 0.2 * len(names)]
        figure = Picture(figsize=(6.5, sum(rows)), layout="constrained")
        path, box, bars = figure.subplots(3, 1, height_ratios=rows)
        _path(path, design)
        _box(box, design)
        values = [design.elasticity(name) for name in names]
        bars.barh(range(len(names)), values, color=BLUE, height=0.6)
        bars.set_yticks(range(len(names)), [name.replace("_", " ") for name in names])
        bars.invert_yaxis()
        bars.axvline(0.0, color="0.4", linewidth=0.5)
        bars.set_xlabel(f"Elasticity of {_words(design.minimize)}, % for one more %")
        bars.margins(x=0.05)
        return figure


def _path(panel: Axes, design: Design) -> None:
    values, missed = np.array(design.path).T
    iterations = np.arange(len(values))
    panel.plot(iterations, values, color=BLUE, marker=".")
    panel.set_xlabel("Iteration")
    panel.xaxis.set_major_locator(MaxNLocator(integer=True))
    panel.set_ylabel(with_unit(design.minimize, design.unit or "1"), color=BLUE)
    if missed.any():
        other = panel.twinx()
        other.semilogy(iterations, np.maximum(missed, LEAST), color=VERMILLION, marker=".", linestyle="--")
        other.set_ylabel("Bounds missed", color=VERMILLION)


def _box(panel: Axes, design: Design) -> None:
    for i, each in enumerate(design.parameters.values()):
        start, end = ((value - each.low) / (each.high - each.low) for value in (each.start, each.value))
        panel.plot([0.0, 1.0], [i, i], color="0.8", linewidth=4.0, solid_capstyle="round")
        panel.plot([start, end], [i, i], color=BLUE)
        panel.plot(start, i, "o", color="white", markeredgecolor=BLUE)
        panel.plot(end, i, "o", color=ORANGE if min(end, 1.0 - end) < 1e-6 else BLUE)
        unit = "" if each.unit in ("", "1") else f" {each.unit}"
        panel.annotate(f"{each.low:g}", (-0.02, i), ha="right", va="center", fontsize=7.0)
        panel.annotate(f"{each.high:g}{unit}", (1.02, i), ha="left", va="center", fontsize=7.0)
        panel.annotate(f"{each.value:.4g}", (end, i), (0, 6), textcoords="offset points", ha="center", fontsize=7.0)
    panel.set_yticks(range(len(design.parameters)), [_words(name) for name in design.parameters])
    panel.invert_yaxis()
    panel.set_xlim(-0.15, 1.25)
    panel.set_ylim(len(design.parameters) - 0.4, -0.7)
    panel.set_xticks([])
    panel.tick_params(length=0.0)
    panel.spines[:].set_visible(False)


def _words(name: str) -> str:
    return name.replace("_", " ")
