"""Style of a paper: one style sheet, colours that differ in print and for the colour-blind, files without a date."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from importlib.resources import as_file, files
from io import BytesIO
from pathlib import Path
from typing import Any

from matplotlib import rc_context, rcParams, rcParamsDefault
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.legend import Legend
from matplotlib.transforms import Bbox, BboxBase

from spear_pin.errors import BadValue
from spear_pin.files import atomic
from spear_pin.kinds import typed

STANCE = "stance"
STANCE_COLOR = "0.92"
BLUE, VERMILLION, GREEN, PURPLE, ORANGE, SKY = "#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9"
SCREEN, SHARPNESS = 120, 2.0  # pixels for an inch of paper, of which a sharp screen shows several for one
FONTS = ("font.family", "font.serif", "font.sans-serif", "font.monospace", "mathtext.fontset")
FORMATS = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}, ".png": {}}  # with the metadata left out


@contextmanager
def style() -> Iterator[None]:
    """Applies the style sheet for as long as the block lasts; fonts that the user has chosen in `rcParams` stay."""
    now: dict[Any, Any] = dict(rcParams)
    chosen = any(now[name] != dict[Any, Any](rcParamsDefault)[name] for name in FONTS)
    own: dict[Any, Any] = {name: now[name] for name in FONTS} if chosen else {}
    with as_file(files("spear_pin.viz.plots").joinpath("paper.mplstyle")) as sheet, rc_context(own, sheet):
        yield


class _Above(Legend):
    """A legend above its axes, and above their title where they have one."""

    def get_bbox_to_anchor(self) -> BboxBase:
        """Returns the place of the legend's lower left corner, in pixels."""
        at = super().get_bbox_to_anchor()
        titles = [getattr(self.axes, name) for name in ("title", "_left_title", "_right_title")]
        tops = [title.get_window_extent().y1 for title in titles if title.get_text()]
        return Bbox.from_bounds(at.x0, max([at.y0, *tops]), 0.0, 0.0)


def legend_above(axes: Axes, columns: int = 4, **options: Any) -> None:
    """Puts a legend above axes, and above their title, even if that is set later.

    Args:
        axes: the axes.
        columns: number of columns of the legend.
        options: `handles`, and other options of `Axes.legend`.
    """
    legend = axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=columns, **options)
    legend.__class__ = _Above  # made by `Axes.legend`, which tells the axes of it


class Picture(Figure):
    """A figure that belongs to no window, and that a notebook shows."""

    def _repr_png_(self) -> tuple[bytes, dict[str, int]]:
        """Returns the picture, and its display size, in pixels."""
        file = BytesIO()
        with style():
            self.savefig(file, format="png", dpi=SHARPNESS * SCREEN)
        return file.getvalue(), {"width": round(SCREEN * self.get_figwidth())}


def with_unit(name: str, unit: str) -> str:
    """Returns a quantity's name in words for an axis, with its unit in brackets, where it has one ("1" is none)."""
    words = name.replace("_", " ").capitalize()
    return words if unit == "1" else f"{words} ({unit})"


@typed
def save_figure(figure: Figure, path: str | Path) -> Path:
    """Writes a figure, whole or not at all, in the format of the path's suffix.

    The text of an svg is drawn as outlines, so that it looks the same without the fonts.

    Raises:
        BadValue: the suffix is not .svg, .pdf or .png.
        BadFile: the file cannot be written.
    """
    target = Path(path)
    suffix = target.suffix.lower()
    if suffix not in FORMATS:
        raise BadValue("path", str(path), f"a name ending in {', '.join(FORMATS)}")
    with style(), atomic(target) as temporary:
        figure.savefig(temporary, format=suffix[1:], metadata=FORMATS[suffix])
    return target
