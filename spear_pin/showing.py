"""What shows itself in a notebook. It is drawn by `viz`, asked as it is shown: the one way that leads upward."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from spear_pin.files import write_text

if TYPE_CHECKING:
    from matplotlib.figure import Figure


class Shown:
    """Something that a notebook shows as a card: a table with units, and a small drawing."""

    def _repr_html_(self) -> str:
        from spear_pin.viz.notebook import card

        return card(self)


@dataclass(frozen=True, repr=False)
class Player:
    """A playback that a notebook shows in place.

    It needs neither server nor network, and plays on in a saved notebook and on a page made from it.

    Attributes:
        page: text of the page that plays.
        height: of the frame in which it is shown, in pixels; it is as wide as there is room.
    """

    page: str
    height: int

    def __repr__(self) -> str:
        return f"Player({len(self.page.encode()) / 1e6:.1f} MB; a notebook shows it, save(path) writes a page)"

    def _repr_html_(self) -> str:
        style = f"width:100%;height:{self.height}px;border:0"
        return f'<iframe srcdoc="{escape(self.page)}" style="{style}" title="playback" allowfullscreen></iframe>'

    def save(self, path: str | Path) -> Path:
        """Write the page, which plays in any browser.

        Raises:
            BadFile: the file cannot be written.
        """
        return write_text(path, self.page)


def play_page(robot: Any, trajectory: Any, title: str, height: int) -> Player:
    """A trajectory as `viz.player` plays it; of a long one the end, as far as a page can hold it."""
    from spear_pin.viz.player import page, shortened

    return Player(page(robot, shortened(robot, trajectory), title=title), height)


def plot_columns(trajectory: Any, columns: tuple[str, ...], cycles: int | None) -> Figure:
    """Columns of a trajectory, as `viz.plots.columns` draws them."""
    from spear_pin.viz.plots.columns import over_time

    return over_time(trajectory, columns, cycles)
