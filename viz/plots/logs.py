"""Plots of logs: what was measured and the model beside each other over time, residuals, and what was left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees
from pathlib import Path
from textwrap import wrap
from typing import Any

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from spear_pin.arrays import Array
from spear_pin.studies.logs import LogPhase, MotionFit, Replay
from spear_pin.studies.logs.measured import STANCE
from spear_pin.viz.plots.paper import STANCE_COLOR, VERMILLION, Picture, style

MEASURED = "0.7"
WIDEST = 14.4  # in, of a picture
KEPT = "\N{NO-BREAK SPACE}"
LETTERS = 19  # to an inch, of the line below


@dataclass(frozen=True)
class _Piece:
    """A stretch of a log with the model's motion: times, (n,), and both, (n, m)."""

    t: Array
    log: Array
    model: Array
    phase: LogPhase


def fit_over_log(fit: MotionFit) -> Figure:
    """Plots log and model of a fit over time, with the residuals; phases that are left out are hatched.

    Args:
        fit: the fit.
    """
    pieces = [
        _Piece(arc.t, arc.seen, arc.seen + residual, arc.phase)
        for arc, residual in zip(fit.arcs, fit.residuals, strict=True)
    ]
    names = {name: fit.leg.robot.units[fit.leg.robot.index(name)] for name in fit.joints}
    words = ", ".join(f"{name} {found}".replace(" ", KEPT) for name, found in fit.found.items())
    return _drawn(pieces, names, fit.left_out, words)


def replay_over_log(replay: Replay) -> Figure:
    """Plots a log and the model that replays it over time, with the residuals.

    Args:
        replay: the replay.
    """
    pieces = [_Piece(hop.t, hop.positions, hop.modelled, hop.stance) for hop in replay.hops]
    names = dict(zip(replay.joints, replay.units, strict=True))
    words = "; ".join(
        f"{name} {100.0 * replay.off(name):+.1f} %".replace(" ", KEPT) for name in replay.hops[0].measures
    )
    return _drawn(pieces, names, replay.left_out, f"model less log: {words}")


def _drawn(pieces: Sequence[_Piece], names: dict[str, str], left_out: Sequence[LogPhase], words: str) -> Figure:
    """Draws a column of panels for each log: every joint, and its residual below."""
    logs = list(dict.fromkeys(piece.phase.source for piece in pieces))
    titles = [Path(source).name for source in logs]
    with style():
        width = max(4.6, min(3.6 * len(logs), WIDEST))
        figure = Picture(figsize=(width, 1.0 + 2.4 * len(names)), layout="constrained")
        ratios = (1.8, 1.0) * len(names)
        panels = figure.subplots(
            2 * len(names), len(logs), sharex="col", sharey="row", squeeze=False, height_ratios=ratios
        )
        for column, (source, title) in enumerate(zip(logs, titles, strict=True)):
            mine = [piece for piece in pieces if piece.phase.source == source]
            others = [phase for phase in left_out if phase.source == source]
            for row, (name, unit) in enumerate(names.items()):
                size, shown = (degrees(1.0), "deg") if unit == "rad" else (1e3, "mm")
                upper, lower = panels[2 * row : 2 * row + 2, column]
                for panel in (upper, lower):
                    _shaded(panel, [piece.phase for piece in mine if piece.phase.name == STANCE], others)
                for piece in mine:
                    upper.plot(piece.t, size * piece.log[:, row], color=MEASURED, linewidth=2.8)
                    upper.plot(piece.t, size * piece.model[:, row], color=VERMILLION, linewidth=0.8)
                    lower.plot(piece.t, size * (piece.model - piece.log)[:, row], color="0.45", linewidth=0.5)
                lower.axhline(0.0, color="0.4", linewidth=0.5)
                if column == 0:
                    upper.set_ylabel(f"{name.replace('_', ' ').capitalize()} ({shown})")
                    lower.set_ylabel(f"Residual ({shown})")
            panels[0, column].set_title(title if titles.count(title) == 1 else source, fontsize=8.0, wrap=True)
            panels[-1, column].set_xlabel("Time of the log (s)")
        figure.align_ylabels(panels[:, 0])
        handles = [
            Line2D([], [], color=MEASURED, linewidth=2.8, label="log"),
            Line2D([], [], color=VERMILLION, linewidth=0.8, label="model"),
            Patch(facecolor=STANCE_COLOR, label="stance"),
            *([Patch(facecolor="none", edgecolor="0.6", hatch="///", label="left out")] if left_out else []),
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=4)
        figure.supxlabel("\n".join(wrap(words, round(LETTERS * width))), fontsize=7.0)
        return figure


def _shaded(panel: Any, stances: Sequence[LogPhase], left_out: Sequence[LogPhase]) -> None:
    """Shades stances, and hatches what is left out."""
    for phase in stances:
        panel.axvspan(phase.begin, phase.end, color=STANCE_COLOR, zorder=0)
    for phase in left_out:
        panel.axvspan(phase.begin, phase.end, facecolor="none", edgecolor="0.6", hatch="///", linewidth=0.0, zorder=0)
