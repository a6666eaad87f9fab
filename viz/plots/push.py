"""Plots of the push test: releases, and the release with other gear ratios."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from spear_pin.errors import BadValue
from spear_pin.studies.push_test import GearRow, Release, spear_ii
from spear_pin.viz.plots.paper import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILLION, Picture, legend_above, style

RELEASES = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY, "black")
TIME, ANGLE = "Time since the release (s)", "Knee angle (rad)"


def release_summary(releases: Mapping[str, Release]) -> Figure:
    """Plots knee, hip and normal ground force after a release; shaded where the pinned toe pulls on the ground.

    The dashed lines are the angles at rest.

    Args:
        releases: releases by name.

    Raises:
        BadValue: there are no releases, or more than seven.
    """
    if not 0 < len(releases) <= len(RELEASES):
        raise BadValue("releases", list(releases), f"one to {len(RELEASES)} releases")
    with style():
        figure = Picture(figsize=(4.2, 5.0), layout="constrained")
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
            legend_above(force, 2, handles=pull)
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
    """Plots SPEAR-II's release with other gear ratios, as in Figs. 4.5 and 4.6, and the effective inertia.

    Args:
        rows: rows of `gear_study`.

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
        figure = Picture(figsize=(7.0, max(2.7, 1.2 + 0.22 * len(rows))), layout="constrained")
        knee, inertia = figure.subplots(1, 2, width_ratios=(1.6, 1.0))
        for row, name, color in zip(rows, names, colors, strict=True):
            given = row.release
            knee.plot(given.t, given.angle, "-" if row.ratio else "--", color=color, label=_named(name, given))
            knee.plot(given.turns[:1], given.extrema[:1], "o", color=color, markersize=4.0, gid=f"turn {name}")
        knee.set_xlim(0.0, max(row.release.t[-1] for row in rows))
        knee.set_xlabel(TIME)
        knee.set_ylabel(ANGLE)
        handles = [*knee.get_legend_handles_labels()[0], _mark("o", "first turn")]
        legend_above(knee, 5, handles=handles)
        inertia.barh(at, body, 0.6, color=SKY, label="leg")
        inertia.barh(at, rotor, 0.6, body, color=VERMILLION, label="rotor, share of the whole")
        for place, row, whole in zip(at, rows, body + rotor, strict=True):
            share = f" {100.0 * row.swing.rotor_share:.0f} %" if row.rotor else ""
            inertia.text(whole, place, share, va="center", fontsize=7.5)
        inertia.set_xlim(0.0, 1.2 * float((body + rotor).max()))
        inertia.set_yticks(at, names)
        inertia.invert_yaxis()
        inertia.set_xlabel("Effective inertia at rest (kg·m²)")
        legend_above(inertia, 2)
        return figure


def _named(name: str, given: Release) -> str:
    return name if given.reason == "complete" else f"{name}, ended by {given.reason}"


def _mark(marker: str, label: str) -> Line2D:
    return Line2D([], [], color="0.4", linestyle="none", marker=marker, markersize=4.5, label=label)
