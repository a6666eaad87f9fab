"""Parts of a trajectory: whole cycles, and the samples of a phase."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, UnknownName

if TYPE_CHECKING:
    from spear_pin.hybrid.trajectory import Ledger, Trajectory


def cycles(trajectory: Trajectory, first: int, last: int) -> Trajectory:
    """Returns the samples, events and ledger of the cycles from the first to the last, inclusive."""
    there = trajectory.cycle
    if not there[0] <= first <= last <= there[-1]:
        given = first if first == last else f"{first} to {last}"
        raise BadValue("cycles", given, f"some of {there[0]} to {there[-1]}, which it has")
    rows = slice(max(first, 1) - 1, max(min(last, trajectory.cycles), 0))
    return _part(trajectory, (there >= first) & (there <= last), rows)


def phase(trajectory: Trajectory, name: str) -> Trajectory:
    """Returns the samples and events of a phase, each time it occurs; the ledger, of whole cycles only, is empty."""
    chosen = trajectory.phase == name
    if not chosen.any():
        raise UnknownName("phase", name, list(dict.fromkeys(trajectory.phase.tolist())))
    return _part(trajectory, chosen, slice(0, 0))


def gaps(trajectory: Trajectory) -> NDArray[np.int64]:
    """Returns the rows after which samples are missing."""
    later = np.diff(trajectory.t) > 0
    elsewhere = (np.diff(trajectory.cycle) != 0) | (trajectory.phase[1:] != trajectory.phase[:-1])
    return np.flatnonzero(later & elsewhere)


def _part(trajectory: Trajectory, chosen: NDArray[np.bool_], rows: slice) -> Trajectory:
    from spear_pin.hybrid.trajectory import SAMPLED

    edges = np.flatnonzero(np.diff(np.concatenate(([False], chosen, [False])).astype(int)))
    spans = [(trajectory.t[begin], trajectory.t[end - 1]) for begin, end in list(pairwise(edges))[::2]]
    ledger, electrical, springs = _some(trajectory.ledger, rows), trajectory.electrical, trajectory.springs
    return replace(
        trajectory,
        **{name: getattr(trajectory, name)[chosen] for name in SAMPLED},
        events=tuple(e for e in trajectory.events if any(begin <= e.time <= end for begin, end in spans)),
        ledger=ledger,
        cycles=len(ledger.change),
        electrical=None if electrical is None else _some(electrical, rows),
        springs=None if springs is None else springs.part(chosen),
    )


def _some(ledger: Ledger, rows: slice) -> Ledger:
    return replace(ledger, work=ledger.work[rows], change=ledger.change[rows])
