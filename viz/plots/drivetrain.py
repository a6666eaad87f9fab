"""Plots of the choice of a motor and a gear ratio for the knee, in the style of `plots`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Literal

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from spear_pin.errors import BadValue
from spear_pin.studies.drivetrain import KneeDrive
from spear_pin.viz.plots.paper import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILLION, Picture, style

HEATING = "Rms over continuous torque"
MARGIN = "Margin to the envelope (N·m)"
COLORS = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, "black")
LINES: tuple[Literal["-", "--", "-.", ":"], ...] = (
    "-",
    "--",
    "-.",
    ":",
    "-",
    "--",
    "-.",
)  # rotors alike have lines upon each other
MARKERS = "osD^vPp"
STEPS = np.outer(10.0 ** np.arange(-3, 5), (1.0, 2.0, 3.0, 5.0)).ravel()  # of a logarithmic axis
TORQUES = np.array([10.0, 20.0, 50.0, 100.0, 200.0, 500.0])  # N·m, beyond the first logarithmic
PANELS: dict[str, Callable[[KneeDrive], float]] = {
    "Energy of the battery (J a hop)": lambda row: row.energy,
    "Heat of the winding (J a hop)": lambda row: row.heat,
    HEATING: lambda row: row.thermal_load,
    MARGIN: lambda row: row.margin,
    "Lost at the impact (J a hop)": lambda row: row.impact,
    "Reflected inertia (g·m²)": lambda row: 1e3 * row.reflected_inertia,
}
LOGARITHMIC = ("Energy of the battery (J a hop)", "Heat of the winding (J a hop)", HEATING)
LIMITS = {HEATING: 1.0, MARGIN: 0.0}


def drivetrain(rows: Sequence[KneeDrive]) -> Figure:
    """Plots each motor's load on battery and winding over the gear ratio, the margin, and the cost of the rotor.

    A point is filled where the drive can do the hop, hollow where it is outside its envelope or the hop is
    unstable; a cross at the bottom is a ratio without a gait. The side beyond a limit is grey. The
    margin's axis is linear up to 10 N·m and logarithmic beyond.

    Args:
        rows: rows of `knee_drives`.

    Raises:
        BadValue: no row has a gait, or there are more than seven motors.
    """
    motors = list(dict.fromkeys(row.motor for row in rows))
    if not any(row.gait for row in rows):
        raise BadValue("rows", len(rows), "at least one with a gait")
    if len(motors) > len(COLORS):
        raise BadValue("rows", motors, f"at most {len(COLORS)} motors")
    ratios = sorted({row.ratio for row in rows})
    with style():
        figure = Picture(figsize=(7.0, 4.2), layout="constrained")
        panels = figure.subplots(2, 3, sharex=True)
        for axes, (label, value) in zip(panels.flat, PANELS.items(), strict=True):
            for place, motor in enumerate(motors):
                _line(axes, [row for row in rows if row.motor == motor], value, place)
            axes.set_ylabel(label)
            if label in LOGARITHMIC:
                axes.set_yscale("log")
                axes.yaxis.set_major_locator(FixedLocator(STEPS.tolist()))
                axes.yaxis.set_minor_locator(NullLocator())
                axes.yaxis.set_major_formatter(FuncFormatter(lambda tick, _: f"{tick:g}"))
            elif label == MARGIN:
                axes.set_yscale("symlog", linthresh=10.0)
                axes.yaxis.set_major_locator(FixedLocator([*-TORQUES[::-1], 0.0, *TORQUES]))
                axes.yaxis.set_major_formatter(
                    FuncFormatter(lambda tick, _: f"{tick:g}".replace("-", "\N{MINUS SIGN}"))
                )
            elif min((value(row) for row in rows if row.gait), default=0.0) >= 0.0:
                axes.set_ylim(bottom=0.0)
            if label in LIMITS:
                _beyond(axes, LIMITS[label], above=label in LOGARITHMIC)
            axes.margins(x=0.05)
        for axes in panels[-1]:
            axes.set_xlabel("Gear ratio")
        panels[0, 0].set_xticks(ratios if len(ratios) < 8 else ratios[:: len(ratios) // 6 + 1])
        handles = [
            Line2D([], [], color=color, linestyle=line, marker=marker, label=motor)
            for color, line, marker, motor in zip(COLORS, LINES, MARKERS, motors, strict=False)
        ]
        kinds = (
            ("o", "0.3", "can do it"),
            ("o", "white", "outside its envelope, or unstable"),
            ("x", "0.3", "no gait"),
        )
        handles += [
            Line2D([], [], linestyle="", marker=marker, color="0.3", markerfacecolor=face, label=kind)
            for marker, face, kind in kinds
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=4)
        return figure


def _line(axes: Axes, rows: Sequence[KneeDrive], value: Callable[[KneeDrive], float], place: int) -> None:
    """Plots a motor's line over the ratio, interrupted where there is no gait."""
    rows = sorted(rows, key=lambda row: row.ratio)
    ratios = np.array([row.ratio for row in rows])
    values = np.array([value(row) if row.gait else np.nan for row in rows])
    color, marker = COLORS[place], MARKERS[place]
    axes.plot(ratios, values, LINES[place], color=color, label=rows[0].motor)
    for can, face in ((True, color), (False, "white")):
        chosen = np.array([row.can == can for row in rows]) & np.isfinite(values)
        gid = f"{rows[0].motor}, {'can' if can else 'cannot'}"
        axes.plot(ratios[chosen], values[chosen], marker, color=color, markerfacecolor=face, gid=gid)
    lost = np.array([row.gait is None for row in rows])
    axes.plot(
        ratios[lost], np.full(lost.sum(), 0.03), "x", color=color, transform=axes.get_xaxis_transform(),
        gid=f"{rows[0].motor}, no gait",
    )  # fmt: skip


def _beyond(axes: Axes, limit: float, above: bool) -> None:
    """Plots a limit, with the side of it where it is exceeded in grey."""
    low, high = axes.get_ylim()
    low, high = min(low, 0.8 * limit if above else limit), max(high, limit)
    axes.axhspan(*((limit, high) if above else (low, limit)), color="0.93", zorder=0)
    axes.axhline(limit, color="0.4", linewidth=0.8, gid="limit")
    axes.set_ylim(low, high)
