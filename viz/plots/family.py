"""A branch of gaits over its parameter, with its stability at a glance.

It has the style of `plots`. Stable parts are solid, unstable ones dashed; special points and borders are marked.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.continuation.branch import Branch
from spear_pin.viz.plots.paper import BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILLION, Picture, style
from spear_pin.viz.plots.sweep import label

MARKS = {
    "fold": ("fold", "o", VERMILLION),
    "flip": ("flip", "D", PURPLE),
    "neimark_sacker": ("Neimark-Sacker", "s", GREEN),
    "neutral_saddle": ("neutral saddle", "v", "0.5"),
    "unit_multiplier": ("multiplier 1", "^", ORANGE),
    "kink": ("kink", "x", "0.4"),
    "border": ("border", "|", "0.2"),
    "end": ("end of the branch", "X", "0.2"),
}
"""Name, marker and colour of what is marked."""


def family(*branches: Branch) -> Figure:
    """Plots moduli of the multipliers, durations of the phases and the solved numbers over the parameter.

    Args:
        *branches: one, or several of the same system over the same parameter, with the same numbers solved for.

    Raises:
        BadValue: there is no branch, or they have different parameters.
    """
    if len({(branch.over, branch.vary) for branch in branches}) != 1:
        raise BadValue(
            "branches",
            [branch.over for branch in branches],
            "branches over the same parameter, with the same numbers solved for",
        )
    parts = [_panels(branch) for branch in branches]
    with style():
        figure = Picture(figsize=(7.0, 2.6 + 1.6 * (len(parts[0]) - 1)), layout="constrained")
        shared = figure.subplots(len(parts[0]), 1, sharex=True, squeeze=False)[:, 0]
        for i, (branch, panels) in enumerate(zip(branches, parts, strict=True)):
            for panel, (title, lines) in zip(shared, panels, strict=True):
                for name, values, color in lines:
                    draw(panel, branch, values, color, "" if i else name)
                panel.set_ylabel(title)
                if len(lines) > 1:
                    panel.legend()
        first = shared[0]
        first.axhline(1.0, color="0.6", linewidth=0.5, gid="circle")
        first.set_ylim(0.0, 1.1 * max(1.0, *(float(branch.largest.max()) for branch in branches)))
        _legend(first, branches)
        for panel in shared:
            panel.margins(x=0.02)
        shared[-1].set_xlabel(label(branches[0].over))
        return figure


def draw(axes: Axes, branch: Branch, values: Array, color: str = BLUE, name: str = "") -> None:
    """Draws values along a branch over its parameter, (n,): stable parts solid, unstable ones dashed, with marks.

    Args:
        axes: axes to draw into.
        branch: the branch.
        values: a number at each point.
        color: colour of the line.
        name: name of the line, for a legend.
    """
    gaps = {frozenset((border.index, border.beyond)) for border in branch.borders if border.beyond is not None}
    for stable, points in _parts(branch.stable, len(branch), gaps):
        dash = "-" if stable else (0, (3.0, 1.5))
        axes.plot(branch.values[points], values[points], color=color, linestyle=dash, label=name, gid="stable" * stable)
        name = ""
    for kind, index in _marked(branch):
        _, marker, edge = MARKS[kind]
        axes.plot(branch.values[index], values[index], marker, color=edge, markersize=5.0, linestyle="none", gid=kind)


def _panels(branch: Branch) -> list[tuple[str, list[tuple[str, Array, str]]]]:
    """Returns titles of the panels, and in each the lines with their names and colours."""
    colors = (BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY)
    moduli = np.abs(branch.multipliers)
    lines = [("", moduli[:, 0], BLUE)]
    phases = [
        (phase.replace("_", " "), seconds, colors[i % len(colors)])
        for i, (phase, seconds) in enumerate(branch.durations.items())
        if seconds.any()
    ]
    solved = [(label(name), [("", values, BLUE)]) for name, values in branch.solved.items()]
    return [("Largest multiplier", lines), ("Duration (s)", phases), *solved]


def _parts(stable: NDArray[np.bool_], n: int, gaps: set[frozenset[int]]) -> list[tuple[bool, list[int]]]:
    """Returns points that belong together, and whether they are stable; a mixed step counts as unstable."""
    parts: list[tuple[bool, list[int]]] = [(bool(stable[0]), [0])]
    for i, j in pairwise(range(n)):
        kind = bool(stable[i] and stable[j])
        if frozenset((i, j)) in gaps:
            parts.append((bool(stable[j]), [j]))
        elif kind == parts[-1][0] or len(parts[-1][1]) == 1:
            parts[-1] = kind, [*parts[-1][1], j]
        else:
            parts.append((kind, [i, j]))
    return parts


def _marked(branch: Branch) -> list[tuple[str, int]]:
    """Returns kinds of marks, keys of `MARKS`, and the points."""
    marks = [(special.kind, special.index) for special in branch.specials]
    return marks + [("end" if border.beyond is None else "border", border.index) for border in branch.borders]


def _legend(axes: Axes, branches: Sequence[Branch]) -> None:
    """Returns a legend of the lines and marks that occur."""
    there_are = {kind for branch in branches for kind, _ in _marked(branch)}
    kinds = [kind for kind in MARKS if kind in there_are]
    stable = np.concatenate([branch.stable for branch in branches])
    handles = []
    for name, dash, there in (
        ("stable", "-", stable.any()),
        ("unstable", (0, (3.0, 1.5)), not stable.all()),
    ):
        if there:
            handles += axes.plot([], [], color=BLUE, linestyle=dash, label=name)
    for kind in kinds:
        name, marker, color = MARKS[kind]
        handles += axes.plot([], [], marker, color=color, markersize=5.0, linestyle="none", label=name)
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0))
