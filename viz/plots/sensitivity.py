"""Elasticities of a gait as a heat map: change of each output in % for 1 % more of each parameter."""

from __future__ import annotations

import numpy as np
from matplotlib.colors import SymLogNorm
from matplotlib.figure import Figure

from spear_pin.gaits.sensitivity.measure import estimate_rounding
from spear_pin.gaits.sensitivity.sensitivity import NOTHING, Sensitivity
from spear_pin.viz.plots.paper import Picture, style
from spear_pin.words import show_unit

LINEAR = 0.1  # elasticities up to this are told apart linearly, larger ones by their logarithms


def elasticities(table: Sensitivity) -> Figure:
    """Plots the table as a heat map, red where an output grows, blue where it shrinks, grey without a derivative."""
    rows = np.array([table.elasticity(name) for name in table.outputs])
    top = max(1.0, float(np.nanmax(np.abs(rows), initial=0.0)))
    with style():
        size = 3.9 + 0.75 * len(table.parameters), 0.9 + 0.24 * len(rows)
        figure = Picture(figsize=size, layout="constrained")
        panel = figure.subplots()
        panel.set_facecolor("0.85")
        scale = SymLogNorm(LINEAR, vmin=-top, vmax=top)
        mesh = panel.pcolormesh(
            np.ma.masked_invalid(rows), cmap="RdBu_r", norm=scale, edgecolors="white", linewidth=0.5
        )
        for (i, j), value in np.ndenumerate(rows):
            dark = np.isfinite(value) and abs(float(scale(value)) - 0.5) > 0.3
            text = (
                "none" if not np.isfinite(value) else f"{value if abs(value) > NOTHING else 0.0:.2g}".replace("-", "−")
            )
            color = "white" if dark else "black"
            panel.text(j + 0.5, i + 0.5, text, ha="center", va="center", fontsize=7.0, color=color)
        labels = [f"{name.replace('_', ' ')}\n{value:.4g} {unit}" for name, value, unit in _parameters(table)]
        panel.set_xticks(np.arange(len(table.parameters)) + 0.5, labels, rotation=30.0, ha="right", fontsize=7.5)
        panel.set_yticks(np.arange(len(rows)) + 0.5, [_said(table, name) for name in table.outputs], fontsize=7.5)
        panel.tick_params(length=0.0)
        panel.invert_yaxis()
        figure.colorbar(mesh, label="Elasticity, % for one more %")
        return figure


def _parameters(table: Sensitivity) -> list[tuple[str, float, str]]:
    units = [show_unit(unit) for unit in table.units]
    return list(zip(table.parameters, table.given.tolist(), units, strict=True))


def _said(table: Sensitivity, name: str) -> str:
    unit, value = table.output_units[name], table.outputs[name]
    value = value if abs(value) > estimate_rounding(name) else 0.0
    return f"{name.replace('_', ' ')}, {value:.4g}{'' if unit == '1' else ' ' + unit}"
