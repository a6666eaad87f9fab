"""Plots of the push test: releases, gear ratios, fits to records, and what the source's tables say.

In the style of `plots`. What was fitted to synthetic records says so.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from spear_pin.errors import BadValue
from spear_pin.studies.audit.printed_estimates import TABLE_4_1, TABLE_4_2, TableRow, average
from spear_pin.studies.identification import NUISANCES, QUANTITIES, Estimate
from spear_pin.studies.identification.estimate import Parameter
from spear_pin.studies.push_test import GearRow, Release, spear_ii
from spear_pin.viz.plots import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILLION, style

RELEASES = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, "black")
SYNTHETIC = "synthetic"
CHARACTERS = 96  # of a title, across the page
MOST = 12  # parameters in a matrix of correlations
PLACES = (0.0, 1.0, 2.0, 3.4, 5.0)  # of three depths, their mean and the printed one
ASIDE = 0.1  # of a place, by which the belt on and off lie apart
TIME, ANGLE = "Time since the release (s)", "Knee angle (rad)"


def release_summary(releases: Mapping[str, Release]) -> Figure:
    """Knee, hip and normal ground force after a release; where the pinned toe pulls on the ground is shaded.

    The dashed lines are the angles at rest.

    Args:
        releases: by name.

    Raises:
        BadValue: there are no releases, or more than seven.
    """
    if not 0 < len(releases) <= len(RELEASES):
        raise BadValue("releases", list(releases), f"one to {len(RELEASES)} releases")
    with style():
        figure = Figure(figsize=(4.2, 5.0), layout="constrained")
        knee, hip, force = figure.subplots(3, 1, sharex=True)
        for color, (name, given) in zip(RELEASES, releases.items(), strict=False):
            knee.axhline(given.rest, color=color, linewidth=0.6, linestyle="--", gid=f"rest {name}")
            knee.plot(given.t, given.angle, color=color, label=_named(name, given))
            hip.plot(given.t, given.height, color=color, label=name)
            normal = given.force[:, 1]
            force.fill_between(
                given.t, normal, 0.0, where=normal < 0.0, interpolate=True, color=color, alpha=0.3, gid=f"pull {name}"
            )  # fmt: skip
            force.plot(given.t, normal, color=color, label=name)
            if given.lift_off is not None:
                force.plot([given.lift_off], [0.0], "v", color=color, markersize=4.5, gid=f"lift-off {name}")
        force.axhline(0.0, color="0.4", linewidth=0.6)
        if any(given.lift_off is not None for given in releases.values()):
            pull = [_mark("v", "a free toe would lift off"), Patch(facecolor="0.5", alpha=0.4, label="the pin pulls")]
            force.legend(handles=pull, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
        knee.set_xlim(0.0, max(given.t[-1] for given in releases.values()))
        for panel, label in ((knee, ANGLE), (hip, "Height of the hip (m)"), (force, "Normal ground force (N)")):
            panel.set_ylabel(label)
        force.set_xlabel(TIME)
        handles = [
            *knee.get_legend_handles_labels()[0],
            Line2D([], [], color="0.4", linewidth=0.6, linestyle="--", label="at rest"),
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=2)
        return figure


def gear_comparison(rows: Sequence[GearRow]) -> Figure:
    """The release of SPEAR-II with other gear ratios, as in Figs. 4.5 and 4.6, and the inertia that swings.

    Args:
        rows: as `gear_study` finds them.

    Raises:
        BadValue: there are no rows.
    """
    if not rows:
        raise BadValue("rows", rows, "at least one")
    colors = colormaps["cividis"](np.linspace(0.0, 0.85, len(rows)))
    names = ["no motor" if row.ratio is None else f"{row.ratio:g}:1" for row in rows]
    body = np.array([float(spear_ii(None).effective_inertia(row.release.rest)) for row in rows])
    rotor = np.array([row.rotor for row in rows])
    at = np.arange(len(rows))
    with style():
        figure = Figure(figsize=(7.0, max(2.7, 1.2 + 0.22 * len(rows))), layout="constrained")
        knee, inertia = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
        for row, name, color in zip(rows, names, colors, strict=True):
            given = row.release
            knee.plot(given.t, given.angle, "-" if row.ratio else "--", color=color, label=_named(name, given))
            knee.plot(given.turns[:1], given.extrema[:1], "o", color=color, markersize=4.0, gid=f"turn {name}")
        knee.set_xlim(0.0, max(row.release.t[-1] for row in rows))
        knee.set_xlabel(TIME)
        knee.set_ylabel(ANGLE)
        handles = [*knee.get_legend_handles_labels()[0], _mark("o", "first turn")]
        knee.legend(handles=handles, loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=5)
        inertia.barh(at, body, 0.6, color=SKY, label="leg")
        inertia.barh(at, rotor, 0.6, body, color=VERMILLION, label="rotor, share of the whole")
        for place, row, whole in zip(at, rows, body + rotor, strict=True):
            share = f" {100.0 * row.swing.rotor_share:.0f} %" if row.rotor else ""
            inertia.text(whole, place, share, va="center", fontsize=7.5)
        inertia.set_xlim(0.0, 1.2 * float((body + rotor).max()))
        inertia.set_yticks(at, names)
        inertia.invert_yaxis()
        inertia.set_xlabel("Effective inertia at rest (kg·m²)")
        inertia.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2)
        return figure


def fit_summary(estimates: Mapping[str, Estimate]) -> Figure:
    """Data and model of every estimate, as in Fig. 4.4, with the residuals and what was estimated.

    All releases of an estimate lie over each other, from its release times on. Angles have one scale and
    residuals have one, so that estimates can be compared.

    Args:
        estimates: by name.

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
        figure = Figure(figsize=(7.0 if columns > 1 else 4.2, 3.4 * rows), layout="constrained")
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


def correlations(estimate: Estimate) -> Figure:
    """Correlations of the parameters as a heat map; of many, those shared and those of the first release.

    Raises:
        BadValue: the data do not tell the parameters apart.
    """
    if not np.isfinite(estimate.covariance).all() or not np.diag(estimate.covariance).all():
        raise BadValue("estimate.condition", estimate.condition, "parameters that the data tell apart")
    few = len(estimate.parameters) <= MOST
    chosen = [i for i, p in enumerate(estimate.parameters) if few or p.trial in (None, 0)]
    names = [_symbol(estimate.parameters[i]) for i in chosen]
    matrix = estimate.correlation[np.ix_(chosen, chosen)]
    source = _source(estimate)
    which = "" if few else f"\nshared, and of release 1 of {len(estimate.trials)}"
    with style():
        side = 1.3 + 0.36 * len(chosen)
        figure = Figure(figsize=(side + 0.5, side), layout="constrained")
        panel = figure.subplots()
        mesh = panel.pcolormesh(matrix, cmap="RdBu_r", vmin=-1.0, vmax=1.0, edgecolors="white", linewidth=0.5)
        for (i, j), value in np.ndenumerate(matrix):
            color = "white" if abs(value) > 0.6 else "black"
            number = f"{value:.2f}".replace("-", "−")
            panel.text(j + 0.5, i + 0.5, number, color=color, ha="center", va="center", fontsize=7.5)
        centres = np.arange(len(chosen)) + 0.5
        panel.set_xticks(centres, names)
        panel.set_yticks(centres, names)
        panel.tick_params(length=0.0)
        panel.set_aspect("equal")
        panel.invert_yaxis()
        panel.set_title(f"Data: {source}{which}", color=VERMILLION if SYNTHETIC in source else "black")
        figure.colorbar(mesh, label="Correlation (1)", shrink=0.8)
        return figure


def source_comparison() -> Figure:
    """Stiffness and damping of Table 4.1 with their standard deviations, their mean, and the mean of Table 4.2."""
    with style():
        figure = Figure(figsize=(5.4, 4.2), layout="constrained")
        stiffness, damping = figure.subplots(2, 1, sharex=True)
        for motor, color, side, name in ((True, BLUE, -1, "with motor"), (False, VERMILLION, 1, "without motor")):
            rows = [*(row for row in TABLE_4_1 if row.motor == motor), average(motor)]
            printed = next(row for row in TABLE_4_2 if row.motor == motor)
            for panel, column in ((stiffness, "stiffness"), (damping, "damping")):
                _draw_rows(panel, [*rows, printed], column, color, side, name)
        for panel, quantity in ((stiffness, QUANTITIES["stiffness"]), (damping, QUANTITIES["damping"])):
            panel.axvspan(0.5 * (PLACES[2] + PLACES[3]), PLACES[-1] + 1.0, color="0.95", zorder=0)
            panel.set_xlim(-0.5, PLACES[-1] + 0.9)
            panel.set_ylabel(f"{_mathematical(quantity.symbol)} ({quantity.unit})")
        depths = [f"{100.0 * row.depth:g}" for row in TABLE_4_1 if row.motor and row.depth is not None]
        damping.set_xticks(PLACES, [*depths, "mean of Table 4.1", "printed in Table 4.2"])
        damping.set_xlabel("Depth of the push (cm)", loc="left")
        figure.legend(*stiffness.get_legend_handles_labels(), loc="outside upper left", ncols=3)
        return figure


# what the plots share


def _draw_fit(upper: Axes, lower: Axes, given: Estimate) -> None:
    """Data, model and residuals over the time since the estimated releases; noise as plain pixels: files stay small."""
    let_go = {p.trial: p.value for p in given.parameters if p.name == "release_time"}
    pixels: dict[str, Any] = {"rasterized": True, "antialiased": False}
    for j, (trial, model) in enumerate(zip(given.trials, given.predicted, strict=True)):
        since = trial.t - let_go.get(j, trial.let_go)
        upper.plot(since, trial.angle, color="0.7", linewidth=2.8, gid=f"data {j + 1}", **pixels)
        upper.plot(since, model, color=VERMILLION, linewidth=0.8, zorder=3, gid=f"model {j + 1}")
        residual = 1e3 * (model - trial.angle)
        lower.plot(since, residual, color="0.45", linewidth=0.4, gid=f"residual {j + 1}", **pixels)
    lower.axhline(0.0, color=VERMILLION, linewidth=0.6)


def _draw_rows(panel: Axes, rows: Sequence[TableRow], quantity: str, color: str, side: int, name: str) -> None:
    """Values of one column of the tables, the last two with numbers: the mean, and what is printed for it."""
    values = [float(getattr(row, quantity)) for row in rows]
    deviations = [float(getattr(row, f"sigma_{quantity}")) for row in rows]
    places = np.array(PLACES) + side * ASIDE
    panel.errorbar(
        places, values, deviations, fmt="none", ecolor=color, elinewidth=0.8, capsize=2.5, label=f"{name}, ± σ"
    )
    panel.plot(places[:-1], values[:-1], "o", color=color, markersize=4.0, gid=f"table 4.1 {name}")
    panel.plot(places[-1:], values[-1:], "s", color=color, markersize=4.5, gid=f"table 4.2 {name}")
    mean, printed = values[-2:]
    remark = "" if round(mean, 2) == round(printed, 2) else "\nnot the mean"
    for place, value, text in ((places[-2], mean, ""), (places[-1], printed, remark)):
        panel.annotate(
            f"{value:.2f}{text}", (place, value), (6 * side, 0), textcoords="offset points", color=color, fontsize=7.5,
            ha="left" if side > 0 else "right", va="center",
        )  # fmt: skip


def _named(name: str, given: Release) -> str:
    return name if given.reason == "complete" else f"{name}, ended by {given.reason}"


def _mark(marker: str, label: str) -> Line2D:
    return Line2D([], [], color="0.4", linestyle="none", marker=marker, markersize=4.5, label=label)


def _source(given: Estimate) -> str:
    """Whether the data are synthetic: all of them, some or none."""
    marked = sum(trial.synthetic for trial in given.trials)
    if marked == len(given.trials):
        return SYNTHETIC
    return f"{SYNTHETIC} in part" if marked else "measured"


def _found(name: str, given: Estimate, width: int) -> str:
    """Name, fit and parameters of the knee, a line each."""
    warned = f", warnings: {len(given.warnings)}" if given.warnings else ""
    lines = [fill(f"{name}: fit {given.fit:.1f} %{warned}", width)]
    for quantity in dict.fromkeys(p.name for p in given.parameters if p.name not in NUISANCES):
        same = [p for p in given.parameters if p.name == quantity]
        symbol, unit = _mathematical(QUANTITIES[quantity].symbol), QUANTITIES[quantity].unit
        deviation = max(p.deviation for p in same)
        decimals = int(np.clip(1 - np.floor(np.log10(deviation)), 0, 6)) if 0.0 < deviation < np.inf else 4
        values = " … ".join(dict.fromkeys(f"{pick(p.value for p in same):.{decimals}f}" for pick in (min, max)))
        error = f"± {deviation:.{decimals}f}" if deviation < np.inf else "± ∞"
        if len(same) > 1:
            lines += [f"{symbol} = {values} {unit}", f"    each release its own, {error} at most"]
        else:
            lines.append(f"{symbol} = {values} {error} {unit}")
    return "\n".join(lines)


def _mathematical(symbol: str) -> str:
    """A symbol as one writes it in a formula."""
    letter, _, index = symbol.replace("₀", "_0").replace("²", "^2").partition("_")
    upright = f"\\mathrm{{{letter}}}" if letter.isupper() and letter.isalpha() else letter
    return f"${upright}_{{\\mathrm{{{index}}}}}$" if index else f"${upright}$"


def _symbol(parameter: Parameter) -> str:
    symbol = _mathematical(QUANTITIES[parameter.name].symbol)
    return symbol if parameter.trial is None else f"{symbol}\n({parameter.trial + 1})"
