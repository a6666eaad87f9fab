"""Contributions of numbers to a gait's spread, and Monte Carlo compared with first order; in the style of `plots`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.sensitivity.monte_carlo import STAYS, MonteCarlo
from spear_pin.gaits.sensitivity.uncertainty import Uncertainty
from spear_pin.viz.plots.paper import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILLION, Picture, style, with_unit
from spear_pin.viz.plots.sweep import UNITS

COLORS = (BLUE, ORANGE, GREEN, PURPLE, SKY, VERMILLION, "0.3", "0.6")
COSTS = ("cost_of_transport", "positive_work")
BINS, WIDTH = 60, 5.0  # of a histogram, over so many standard deviations on each side


def variance_shares(spread: Uncertainty) -> Figure:
    """Plots by how many per cent each output's variance falls if a parameter is known exactly.

    For independent errors these are shares, stacked to 100 %. For correlated errors they do not add up, and are side by
    side.
    """
    names = [name for name in spread.outputs if spread.moves(name)]
    gains = 100.0 * np.array([spread.gains(name) for name in names]).reshape(len(names), len(spread.over))
    beside, count = spread.correlated, max(len(spread.over), 1)
    height = 0.8 / (count if beside else 1)
    with style():
        rows = 0.1 * count + 0.14 if beside else 0.22
        figure = Picture(figsize=(6.2, 1.1 + rows * len(names)), layout="constrained")
        panel = figure.subplots()
        left = np.zeros(len(names))
        for j, name in enumerate(spread.over):
            place = np.arange(len(names)) + (height * (j - 0.5 * (count - 1)) if beside else 0.0)
            color = COLORS[j % len(COLORS)]
            unit = spread.table.units[j] or UNITS.get(name, "")
            sigma = f"{spread.parameter_deviations[j]:.3g} {unit}".strip()
            label = f"{name.replace('_', ' ')}, ±{sigma}"
            panel.barh(place, gains[:, j], height, left=0.0 if beside else left, color=color, label=label)
            left = left + gains[:, j]
        labels = [f"{name.replace('_', ' ')}, ±{_said(spread, name)}" for name in names]
        panel.set_yticks(np.arange(len(names)), labels, fontsize=7.5)
        panel.tick_params(axis="y", length=0.0)
        panel.set_ylim(len(names) - 0.4, -0.6)
        panel.set_xlim(0.0, 100.0)
        panel.set_xlabel("Variance that knowing the parameter takes away (%)")
        figure.legend(*panel.get_legend_handles_labels(), loc="outside upper center", ncols=min(count, 3))
        return figure


def monte_carlo(drawn: MonteCarlo, outputs: Sequence[str] = ()) -> Figure:
    """Plots histograms of outputs with the normal distribution of the first order over each.

    Args:
        drawn: the samples.
        outputs: outputs to plot (default: solved numbers, the cost, the largest multiplier).

    Raises:
        UnknownName: no output has such a name.
        BadValue: none of them moves.
    """
    for name in outputs:
        if name not in drawn.first:
            raise UnknownName("output", name, drawn.first)
    chosen = drawable(drawn, outputs)
    if not chosen:
        raise BadValue("outputs", list(outputs), "some that depend on an uncertain parameter")
    with style():
        columns = min(len(chosen), 3)
        rows = -(-len(chosen) // columns)
        figure = Picture(figsize=(2.4 * columns + 0.4, 2.1 * rows + 0.5), layout="constrained")
        panels = figure.subplots(rows, columns, squeeze=False)
        for axes in panels.flat[len(chosen) :]:
            axes.set_visible(False)
        for name, axes in zip(chosen, panels.flat, strict=False):
            draw(axes, drawn, name)
        for row in panels:
            row[0].set_ylabel("Samples")
        figure.legend(*panels[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=3)
        return figure


def draw(axes: Axes, drawn: MonteCarlo, name: str) -> None:
    """Draws a histogram of an output's samples, another order of events apart, with the first order's normal."""
    values = drawn.samples.outputs[name]
    middle, first = drawn.spread.outputs[name], drawn.first[name]
    half = WIDTH * max(first, min(drawn.deviation(name), 3.0 * first)) if first > 0.0 else WIDTH * drawn.deviation(name)
    edges = np.linspace(middle - half, middle + half, BINS + 1)
    there = np.isfinite(values)
    alike = [values[there & drawn.samples.alike], values[there & ~drawn.samples.alike]]
    kinds = 1 + bool((drawn.samples.found & ~drawn.samples.alike).any())
    labels = ["same order of events", "another order"][:kinds]
    axes.hist(alike[:kinds], edges.tolist(), stacked=True, color=[SKY, ORANGE][:kinds], label=labels)
    if first > 0.0:
        x = np.linspace(edges[0], edges[-1], 400)
        density = np.exp(-0.5 * ((x - middle) / first) ** 2) / (first * np.sqrt(2.0 * np.pi))
        axes.plot(x, density * len(drawn) * (edges[1] - edges[0]), color=VERMILLION, label="first order")
    beyond = int((there & (np.abs(values - middle) > half)).sum())
    lost = int((~there).sum())
    notes = [f"{beyond} beyond"] * bool(beyond) + [f"{lost} without a value"] * bool(lost)
    axes.set_title("\n".join(notes), fontsize=7.0)
    axes.set_xlabel(with_unit(name, drawn.spread.output_units[name] or UNITS.get(name, "") or "1"))
    axes.set_xlim(edges[0], edges[-1])


def drawable(drawn: MonteCarlo, outputs: Sequence[str] = ()) -> list[str]:
    """Returns the outputs among some that move and have samples; see `monte_carlo` for the arguments."""
    chosen = outputs or _usual(drawn)
    return [name for name in chosen if drawn.verdict(name) != STAYS and len(drawn.drawn(name))]


def _usual(drawn: MonteCarlo) -> list[str]:
    """Returns the solved numbers, the cost, and the largest multiplier."""
    names = list(drawn.first)
    solved = names[: next(i for i, name in enumerate(names) if name.endswith("_time"))]
    cost = [next(name for name in COSTS if name in drawn.first)]
    return [*solved, *cost, *(["multiplier_1"] if "multiplier_1" in drawn.first else [])]


def _said(spread: Uncertainty, name: str) -> str:
    unit = spread.output_units[name] or UNITS.get(name, "")
    return f"{spread.deviation(name):.2g}{'' if unit in ('', '1') else ' ' + unit}"
