"""Plots of an identification: data and model, residuals. What was fitted to synthetic records says so."""

from __future__ import annotations

from collections.abc import Mapping
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from spear_pin.errors import BadValue
from spear_pin.studies.identification import NUISANCES, QUANTITIES, Estimate
from spear_pin.viz.plots.paper import VERMILLION, Picture, style
from spear_pin.viz.plots.push import ANGLE, TIME

SYNTHETIC = "synthetic"
CHARACTERS = 96  # of a title, across the page


def fit_summary(estimates: Mapping[str, Estimate]) -> Figure:
    """Plots data and model of every estimate, as in Fig. 4.4, with the residuals and the estimated parameters.

    All releases of an estimate lie over each other, from its release times on. Angles share one scale and residuals
    another, so that estimates can be compared.

    Args:
        estimates: estimates by name.

    Raises:
        BadValue: there are no estimates.
    """
    if not estimates:
        raise BadValue("estimates", estimates, "at least one")
    columns = 2 if len(estimates) == 4 else min(len(estimates), 3)
    rows = -(-len(estimates) // columns)
    angles = np.concatenate([trial.angle for given in estimates.values() for trial in given.trials])
    lowest, highest, span = angles.min(), angles.max(), np.ptp(angles)
    sources = [_source(given) for given in estimates.values()]
    with style():
        figure = Picture(figsize=(7.0 if columns > 1 else 4.2, 3.4 * rows), layout="constrained")
        grid = figure.add_gridspec(2 * rows, columns, height_ratios=(1.8, 1.1) * rows)
        upper: Axes | None = None
        lower: Axes | None = None
        for i, (name, given) in enumerate(estimates.items()):
            row, column = divmod(i, columns)
            upper = figure.add_subplot(grid[2 * row, column], sharex=upper, sharey=upper)
            lower = figure.add_subplot(grid[2 * row + 1, column], sharex=upper, sharey=lower)
            _draw_fit(upper, lower, given)
            upper.set_title(_found(name, given, CHARACTERS // max(columns, 2)), fontsize=8.0, linespacing=1.1)
            mark = sources[i] if SYNTHETIC in sources[i] else ""
            upper.text(
                0.98, 0.98, mark, transform=upper.transAxes, ha="right", va="top", color=VERMILLION, weight="bold"
            )
            upper.set_ylim(lowest - 0.08 * span, highest + 0.22 * span)  # with room for the mark
            upper.tick_params(labelbottom=False, labelleft=column == 0)
            lower.tick_params(labelleft=column == 0)
            lower.set_xlabel(TIME)
            if column == 0:
                upper.set_ylabel(ANGLE)
                lower.set_ylabel("Residual (mrad)")
        handles = [
            Line2D([], [], color="0.7", linewidth=2.8, label=f"data ({' or '.join(dict.fromkeys(sources))})"),
            Line2D([], [], color=VERMILLION, linewidth=0.8, label="model"),
            Line2D([], [], color="0.45", linewidth=0.5, label="residual: model minus data"),
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=3)
        return figure


def mathematical(symbol: str) -> str:
    """Returns a symbol in the notation of a formula."""
    letter, _, index = symbol.replace("₀", "_0").replace("²", "^2").partition("_")
    upright = f"\\mathrm{{{letter}}}" if letter.isupper() and letter.isalpha() else letter
    return f"${upright}_{{\\mathrm{{{index}}}}}$" if index else f"${upright}$"


def _draw_fit(upper: Axes, lower: Axes, given: Estimate) -> None:
    """Draws data, model and residuals over the time since the estimated releases; noise as pixels keeps files small."""
    let_go = {p.trial: p.value for p in given.parameters if p.name == "release_time"}
    pixels: dict[str, Any] = {"rasterized": True, "antialiased": False}
    for j, (trial, model) in enumerate(zip(given.trials, given.predicted, strict=True)):
        since = trial.t - let_go.get(j, trial.let_go)
        upper.plot(since, trial.angle, color="0.7", linewidth=2.8, gid=f"data {j + 1}", **pixels)
        upper.plot(since, model, color=VERMILLION, linewidth=0.8, zorder=3, gid=f"model {j + 1}")
        residual = 1e3 * (model - trial.angle)
        lower.plot(since, residual, color="0.45", linewidth=0.4, gid=f"residual {j + 1}", **pixels)
    lower.axhline(0.0, color=VERMILLION, linewidth=0.6)


def _source(given: Estimate) -> str:
    """Says whether the data are synthetic: all of them, some or none."""
    marked = sum(trial.synthetic for trial in given.trials)
    if marked == len(given.trials):
        return SYNTHETIC
    return f"{SYNTHETIC} in part" if marked else "measured"


def _found(name: str, given: Estimate, width: int) -> str:
    """Returns name, fit and parameters of the knee, a line each."""
    warned = f", warnings: {len(given.warnings)}" if given.warnings else ""
    lines = [fill(f"{name}: fit {given.fit:.1f} %{warned}", width)]
    for quantity in dict.fromkeys(p.name for p in given.parameters if p.name not in NUISANCES):
        same = [p for p in given.parameters if p.name == quantity]
        symbol, unit = mathematical(QUANTITIES[quantity].symbol), QUANTITIES[quantity].unit
        deviation = max(p.deviation for p in same)
        decimals = int(np.clip(1 - np.floor(np.log10(deviation)), 0, 6)) if deviation > 0.0 else 4
        values = " … ".join(dict.fromkeys(f"{pick(p.value for p in same):.{decimals}f}" for pick in (min, max)))
        error = f"± {deviation:.{decimals}f}"
        if len(same) > 1:
            lines += [f"{symbol} = {values} {unit}", f"    each release its own, {error} at most"]
        else:
            lines.append(f"{symbol} = {values} {error} {unit}")
    return "\n".join(lines)
