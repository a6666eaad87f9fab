"""Survival of a gait over each randomly drawn number, in the style of `plots`."""

from __future__ import annotations

import numpy as np
import scipy
from matplotlib.figure import Figure

from spear_pin.studies.basin.robustness import Robustness
from spear_pin.viz.plots.paper import BLUE, Picture, style
from spear_pin.viz.plots.sweep import label

BINS = 10  # as many draws in each


def robustness_figure(found: Robustness) -> Figure:
    """Plots the share of draws that survive, over each drawn number, with 95 % intervals; a tenth in each bin."""
    names = list(found.drawn)
    columns = max(1, min(len(names), 4))
    with style():
        rows = max(1, -(-len(names) // columns))
        figure = Picture(figsize=(1.9 * columns + 0.4, 1.9 * rows + 0.2), layout="constrained")
        panels = figure.subplots(rows, columns, sharey=True, squeeze=False)
        for axes in panels.flat[len(names) :]:
            axes.set_visible(False)
        for name, axes in zip(names, panels.flat, strict=False):
            order = np.argsort(found.drawn[name])
            for part in np.array_split(order, min(BINS, len(order))):
                counted = scipy.stats.binomtest(int(found.survives[part].sum()), len(part))
                bounds = counted.proportion_ci(0.95)
                middle, share = float(np.median(found.drawn[name][part])), counted.statistic
                axes.plot([middle, middle], [bounds.low, bounds.high], color=BLUE, linewidth=0.8)
                axes.plot(middle, share, "o", color=BLUE, markersize=3)
            axes.set_xlabel(label(name))
            axes.margins(x=0.08)
            axes.set_ylim(-0.03, 1.03)
        for row in panels:
            row[0].set_ylabel("Share that survives")
        return figure
