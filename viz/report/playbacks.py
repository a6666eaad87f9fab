"""Playbacks of the report: pages of `player` that share one viewer, which is in the report once."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from spear_pin.files import scratch
from spear_pin.studies.audit import runs
from spear_pin.studies.push_test import WITH_MOTOR, release, spear_ii
from spear_pin.viz.player import page
from spear_pin.viz.release_page import record_release


@dataclass(frozen=True)
class Playback:
    """A playback of the report.

    Attributes:
        id: name of the playback in the code.
        caption: caption.
        make: a function of a module that returns its page.
        assumes: ids of the assumptions that it uses.
    """

    id: str
    caption: str
    make: Callable[[], str]
    assumes: tuple[str, ...] = ()


def hop() -> str:
    """Returns the page of SPEAR-II hopping in place."""
    return page(runs.hop().system.robot, runs.hops(), title="SPEAR-II hopping in place")


def bound() -> str:
    """Returns the page of Q-SPEAR bounding."""
    return page(runs.bound().system.robot, runs.strides(), title="Q-SPEAR bounding at 2.5 m/s")


def push_test() -> str:
    """Returns the page of SPEAR-II pushed down by 10 cm and let go."""
    leg = spear_ii()
    with scratch() as folder:
        path = folder / "release.html"
        title = "SPEAR-II released from 10 cm"
        return record_release(leg, WITH_MOTOR, release(leg, WITH_MOTOR), path, title=title).read_text(encoding="utf-8")


PLAYBACKS = (
    Playback("play-hop", "The hop in place.", hop, ("touchdown", "stance-torque", "friction")),
    Playback(
        "play-bound", "Two strides of the bound.", bound, ("bound", "virtual-stiffness", "torso-length", "friction")
    ),
    Playback("play-release", "The push test: held, and let go.", push_test, ("rest-angle",)),
)
