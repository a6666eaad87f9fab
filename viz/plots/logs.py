"""Plots of logs: what was measured and the model beside each other over time, residuals, and what was left out."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import degrees
from pathlib import Path

from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from spear_pin.arrays import Array
from spear_pin.studies.logs import LogPhase, MotionFit, Replay
from spear_pin.studies.logs.measured import STANCE
from spear_pin.viz.plots.paper import STANCE_COLOR, VERMILLION, Picture, style

MEASURED = "0.7"


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
        _Piece(arc.t, arc.positions, arc.positions + residual, arc.phase)
        for arc, residual in zip(fit.arcs, fit.residuals, strict=True)
    ]
    sources = [arc.source for arc in fit.arcs]
    names = {name: fit.leg.robot.units[fit.leg.robot.index(name)] for name in fit.joints}
    words = ", ".join(f"{name} {found.value:.4g} ± {found.deviation:.2g} {found.unit}" for name, found in fit.found.items())
    return _drawn(pieces, sources, names, fit.left_out, words)


def replay_over_log(replay: Replay) -> Figure:
    """Plots a log and the model that replays it over time, with the residuals.

    Args:
        replay: the replay.
    """
    pieces = [_Piece(hop.t, hop.positions, hop.modelled, hop.stance) for hop in replay.hops]
    names = dict(zip(replay.joints, replay.units, strict=True))
    words = "; ".join(f"{name} {100.0 * replay.off(name):+.1f} %" for name in replay.hops[0].measures)
    return _drawn(pieces, [replay.log.source] * len(pieces), names, replay.left_out, f"model less log: {words}")


def _drawn(
    pieces: Sequence[_Piece], sources: Sequence[str], names: dict[str, str], left_out: Sequence[LogPhase], words: str
) -> Figure:
    """Draws a column of panels for each log: every joint, and its residual below."""
    logs = list(dict.fromkeys(sources))
    with style():
        figure = Picture(figsize=(max(4.6, 3.6 * len(logs)), 1.0 + 2.4 * len(names)), layout="constrained")
        ratios = (1.8, 1.0) * len(names)
        panels = figure.subplots(2 * len(names), len(logs), sharex="col", squeeze=False, height_ratios=ratios)
        for column, source in enumerate(logs):
            mine = [piece for piece, of in zip(pieces, sources, strict=True) if of == source]
            for row, (name, unit) in enumerate(names.items()):
                turns = unit == "rad"
                size, shown = (degrees(1.0), "deg") if turns else (1e3, "mm")
                upper, lower = panels[2 * row, column], panels[2 * row + 1, column]
                for piece in mine:
                    if piece.phase.name == STANCE:
                        for panel in (upper, lower):
                            panel.axvspan(piece.phase.begin, piece.phase.end, color=STANCE_COLOR, zorder=0)
                    upper.plot(piece.t, size * piece.log[:, row], color=MEASURED, linewidth=2.8)
                    upper.plot(piece.t, size * piece.model[:, row], color=VERMILLION, linewidth=0.8)
                    lower.plot(piece.t, size * (piece.model - piece.log)[:, row], color="0.45", linewidth=0.5)
                for phase in left_out:
                    upper.axvspan(phase.begin, phase.end, facecolor="none", edgecolor="0.6", hatch="///", linewidth=0.0)
                lower.axhline(0.0, color="0.4", linewidth=0.5)
                if column == 0:
                    upper.set_ylabel(f"{name.replace('_', ' ').capitalize()} ({shown})")
                    lower.set_ylabel(f"Residual ({shown})")
            panels[0, column].set_title(Path(source).name, fontsize=8.0)
            panels[-1, column].set_xlabel("Time of the log (s)")
        handles = [
            Line2D([], [], color=MEASURED, linewidth=2.8, label="log"),
            Line2D([], [], color=VERMILLION, linewidth=0.8, label="model"),
            Patch(facecolor=STANCE_COLOR, label="stance"),
            *([Patch(facecolor="none", edgecolor="0.6", hatch="///", label="left out")] if left_out else []),
        ]
        figure.legend(handles=handles, loc="outside upper left", ncols=4)
        figure.supxlabel(words, fontsize=7.0, wrap=True)
        return figure
