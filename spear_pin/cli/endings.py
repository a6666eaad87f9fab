"""How a motion ended that a command played: as asked for, or lost; status 1 tells the latter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from spear_pin.errors import SpearError, describe_remedy

if TYPE_CHECKING:
    from spear_pin.hybrid.trajectory import Trajectory

A_CYCLE = 10_000  # evaluations; a cycle in space takes some 2,500


def patience(cycles: int) -> int:
    """How many evaluations a motion in space may take: enough for its cycles, and for one in which it is lost."""
    from spear_pin.hybrid.result import EVALUATIONS

    return EVALUATIONS + cycles * A_CYCLE


def lost(trajectory: Trajectory, cycle: str, of: int = 1, remedy: str = "") -> str | None:
    """Say after how many cycles a motion is lost, and why; None of one that went on as long as was asked for.

    Args:
        trajectory: the motion.
        cycle: what is counted, "hop" or "stride".
        of: cycles of the automaton that make one.
        remedy: what to try where none is whole.

    Raises:
        SpearError: not one is whole, so that there is nothing to measure or to play.
    """
    if trajectory.complete:
        return None
    whole = trajectory.cycles // of
    how = "falls" if trajectory.reason == "fall" else "is lost"
    if not whole:
        raise SpearError(f"the motion {how} in its first {cycle}: {trajectory.message}{describe_remedy(remedy)}")
    return f"{how} after {whole} {cycle}{'s' if whole > 1 else ''}: {trajectory.message}"


def show_ending(said: str | None) -> list[tuple[str, str]]:
    """Row of a command's text for what `lost` says; none of a motion that went on."""
    return [] if said is None else [("the motion", said)]


def notes_of(summary: Mapping[str, Any]) -> list[str]:
    """What the page of a motion says of it, as its text does: how it was lost, and which limits it does not keep."""
    said = [] if summary["lost"] is None else [f"the motion {summary['lost']}"]
    return [*said, *summary["implausible"]]
