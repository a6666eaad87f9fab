"""A Sankey diagram: bands whose width is an energy, of a flow that runs to the right and gets thinner."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon, Rectangle, Wedge

from spear_pin.viz.plots.paper import BLUE

WANTED, LOST, KEPT = "#a9d8c8", "#efb799", "#b9d3ea"  # colours of wanted flows, of losses, of what is stored
SEAM = 0.4  # points: without, patches side by side have a gap
NEGLIGIBLE = 1e-4  # of what the batteries give: too little for a band
WIDEST, APART, HEAD, REACH, LINE = 1.4, 0.66, 0.05, 0.45, 0.115  # of the picture of the flow, in inches


class Sankey:
    """A band that runs to the right and gets thinner; in inches."""

    def __init__(self, axes: Axes, given: float) -> None:
        self.axes, self.given, self.scale = axes, given, WIDEST / given
        self.x, self.top, self.bottom = 0.0, 0.0, -WIDEST
        self.floor, self.lowest, self.ceiling = -WIDEST - REACH, 0.0, 0.0
        self.nothing: list[str] = []
        self._text(-0.08, -0.5 * WIDEST, self._said("batteries\ngive", given), "right", "center")

    def down(self, label: str, energy: float, color: str, parts: Sequence[str] = ()) -> None:
        """Draws a flow that leaves downward; `parts` are lines below its label."""
        thick = self._thick(energy, label if color == LOST else "")
        if not thick:
            return
        self._run(0.12)
        self.axes.add_patch(Wedge((self.x, self.bottom), thick, 0.0, 90.0, color=color, linewidth=SEAM))
        self._arrow(self.x, self.bottom, self.floor, thick, color, label)
        text = "\n".join((self._said(label, energy), *parts))
        self._text(self.x + 0.5 * thick, self.floor - self._head(WIDEST) - 0.05, text, "center", "top")
        self.bottom += thick
        self._run(max(thick + 0.3, APART))

    def up(self, label: str, energy: float) -> None:
        """Draws a wanted flow that leaves upward."""
        thick = self._thick(energy)
        self._run(0.35)
        if thick:
            self.axes.add_patch(Wedge((self.x, self.top), thick, 270.0, 360.0, color=WANTED, linewidth=SEAM))
            self._arrow(self.x, self.top, self.top + 0.25, thick, WANTED, label)
            tip = self.top + 0.25 + self._head(thick) + 0.04
            self._text(self.x + 0.5 * thick, tip, self._said(label, energy), "center", "bottom")
            self.top -= thick
            self._run(thick + 0.2)

    def into(self, label: str, energy: float) -> None:
        """Draws a flow that enters from above."""
        thick = self._thick(energy)
        if not thick:
            return
        self._run(0.3)
        height = self.top + thick + 0.3
        self.axes.add_patch(Wedge((self.x, self.top + thick), thick, 180.0, 270.0, color=KEPT, linewidth=SEAM))
        self.axes.add_patch(
            Rectangle((self.x - thick, self.top + thick), thick, 0.3, color=KEPT, gid=label, linewidth=SEAM)
        )
        self._text(self.x - 0.5 * thick, height + 0.04, self._said(label, energy), "center", "bottom")
        self.top += thick
        self._run(0.3)

    def label(self, label: str, energy: float) -> None:
        """Writes a name at the band's present place."""
        self._text(self.x + 0.1, self.top + 0.05, self._said(label, energy), "center", "bottom")
        self._run(0.3)

    def loop(self, stored: float, returned: float) -> None:
        """Draws the energy that the spring takes from the leg and gives back."""
        down, up = self._thick(returned), self._thick(stored)
        if not up:
            return
        self._run(0.35)
        foot, box, apart = self.top + 0.06, self.top + 0.65, max(0.25, 0.7 - 0.5 * (up + down))
        self._arrow(self.x, foot, box - self._head(up) - 0.03, up, KEPT, "stored")
        self._arrow(self.x + up + apart, box, foot + self._head(down), down, KEPT, "returned")
        width = up + down + apart
        self.axes.add_patch(Rectangle((self.x, box), width, 0.24, facecolor="white", edgecolor=BLUE, linewidth=0.8))
        self._text(self.x + 0.5 * width, box + 0.12, "springs", "center", "center")
        self._text(self.x + 0.5 * up, box + 0.29, self._said("stored", stored), "center", "bottom")
        self._text(self.x + width - 0.5 * down, box + 0.29, self._said("returned", returned), "center", "bottom")
        self._run(width + 0.1)

    def fit(self, figure: Figure) -> None:
        """Makes the figure as large as the picture."""
        if self.nothing:
            self._text(self.x, self.lowest, f"next to nothing: {', '.join(self.nothing)}", "right", "top")
        left, right, low, high = -0.8, self.x + 0.15, self.lowest - 0.05, self.ceiling + 0.05
        figure.set_size_inches(right - left, high - low)
        self.axes.set(xlim=(left, right), ylim=(low, high))

    def _thick(self, energy: float, name: str = "") -> float:
        if energy > NEGLIGIBLE * self.given:
            return energy * self.scale
        self.nothing += [name] if name else []
        return 0.0

    def _said(self, label: str, energy: float) -> str:
        return f"{label}\n{energy:.2f} J\n{100.0 * energy / self.given:.1f} %"

    def _run(self, length: float) -> None:
        thick = self.top - self.bottom
        if thick > NEGLIGIBLE * WIDEST:
            patch = Rectangle((self.x, self.bottom), length, thick, color=WANTED, linewidth=SEAM)
            self.axes.add_patch(patch)
        self.x += length

    @staticmethod
    def _head(thick: float) -> float:
        return HEAD + min(0.35 * thick, 0.15)

    def _arrow(self, x: float, begin: float, end: float, thick: float, color: str, name: str) -> None:
        self.axes.add_patch(
            Rectangle((x, min(begin, end)), thick, abs(end - begin), color=color, gid=name, linewidth=SEAM)
        )
        tip = end + np.sign(end - begin) * self._head(thick)
        corners = [(x - HEAD, end), (x + 0.5 * thick, tip), (x + thick + HEAD, end)]
        self.axes.add_patch(Polygon(corners, color=color, linewidth=SEAM))

    def _text(self, x: float, y: float, text: str, across: str, upright: str) -> None:
        self.axes.text(x, y, text, ha=across, va=upright, fontsize=7.0, linespacing=1.1)
        if upright == "bottom":
            self.ceiling = max(self.ceiling, y + LINE * (1 + text.count("\n")))
        if upright == "top":
            self.lowest = min(self.lowest, y - LINE * (1 + text.count("\n")))
