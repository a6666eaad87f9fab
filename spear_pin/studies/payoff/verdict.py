"""Verdict of a payoff study at one speed: which knee pays, by a table of search outcomes.

A gait that was found has its cost for certain, since it is simulated. A search may still miss a cheaper gait. Searches
from several starts, for one knee with one stiffness, show how far that may go. So one knee surely costs less than
another if two conditions hold. Every search for it, with one of its stiffnesses, ended cheaper than every search for
the other knee. And at least two starts led to the other knee's gait. Whatever is sure in neither direction is left
open.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

from spear_pin.studies.payoff.grid import FIXED, KINDS, NONE, SWITCHED

LEAST = 0.02  # of a cost: a smaller saving pays for no spring
SAME = 0.01  # of a stiffness: so near to each other they are one
STARTS = 2  # that have to agree before a cost counts as the least
WITH = {NONE: "without a spring", FIXED: "with a fixed spring", SWITCHED: "with a switchable spring"}

SWITCHABLE, SPRING, UNKNOWN = "switchable", "spring", "unknown"
VERDICTS = (SWITCHABLE, FIXED, SPRING, NONE, UNKNOWN)


@dataclass(frozen=True)
class Outcome:
    """Outcome of one search.

    Attributes:
        kind: kind of the knee, one of ``KINDS`` of `grid`.
        stiffness: stiffness of a leg's spring; 0 without one.
        cost: cost of the gait; a value that is not a finite number > 0 means no gait.
        chosen: whether the optimiser chose the stiffness.
        again: whether the search began with a gait of the same knee, on a finer mesh: then it is not a start of its
            own.
        starts: number of starts of the search that ended at this cost.
    """

    kind: str
    stiffness: float
    cost: float
    chosen: bool = False
    again: bool = False
    starts: int = 1

    @property
    def found(self) -> bool:
        """Whether there is a gait."""
        return math.isfinite(self.cost) and self.cost > 0.0


@dataclass(frozen=True)
class Judgement:
    """Conclusions from a table of searches.

    Attributes:
        verdict: one of `VERDICTS`: a switchable spring pays, a fixed one does as well, a spring pays and it is open
            whether it has to be switched, no spring pays, or it cannot be decided.
        why: why the verdict is open, in words; empty where it is not.
        best: cheapest outcome of each kind.
        saving: for each kind of spring, the share of the cost without one that its best saves, negative where it costs
            more; NaN where one of both is missing.
        pays: for each kind of spring, whether it surely saves `LEAST` or surely does not; None: it is not sure.
        spread: for each kind, the relative difference between the starts with the stiffness of the best; NaN for one
            start.
        outside: for each kind of spring, the stiffness of the best, where it lies outside the given ones.
    """

    verdict: str
    why: str
    best: Mapping[str, Outcome]
    saving: Mapping[str, float]
    pays: Mapping[str, bool | None]
    spread: Mapping[str, float]
    outside: Mapping[str, float]


class _Group(NamedTuple):
    """Searches for one knee with one stiffness."""

    stiffness: float
    costs: tuple[float, ...]


class _Knee(NamedTuple):
    """Searches for one kind of knee by stiffness, and why its least cost is in doubt; empty where it is not."""

    kind: str
    groups: tuple[_Group, ...]
    doubt: str
    unit: str

    @property
    def least(self) -> float:
        return min((min(group.costs) for group in self.groups), default=math.inf)

    @property
    def ends(self) -> str:
        """Results, in words, of the searches for the stiffness with the least cost."""
        group = min(self.groups, key=lambda group: min(group.costs))
        low, high = min(group.costs), max(group.costs)
        cost = f"{low:.3g}" if high == low else f"{low:.3g} to {high:.3g}"
        return f"{cost} {_said(self.kind, group.stiffness, self.unit)}"


class _Comparison(NamedTuple):
    """Whether a knee surely costs less than another, or surely does not; None if it is open, with the reason."""

    less: bool | None
    why: str


def judge(outcomes: Iterable[Outcome], stiffnesses: Sequence[float], unit: str = "N·m/rad") -> Judgement:
    """Judges searches at one speed.

    Args:
        outcomes: outcomes of all searches, with those without a gait.
        stiffnesses: given stiffnesses of a leg's spring, rising.
        unit: unit of stiffnesses.
    """
    table = [outcome for outcome in outcomes if outcome.found]
    knees = {kind: _knee(kind, table, (0.0,) if kind == NONE else stiffnesses, unit) for kind in KINDS}
    best = {
        kind: min(own, key=lambda outcome: outcome.cost)
        for kind in KINDS
        if (own := [outcome for outcome in table if outcome.kind == kind])
    }
    saving = {
        kind: 1.0 - best[kind].cost / best[NONE].cost if {kind, NONE} <= best.keys() else math.nan
        for kind in (FIXED, SWITCHED)
    }
    fixed, switched, switch = (
        _compare(knees[kind], knees[other]) for kind, other in ((FIXED, NONE), (SWITCHED, NONE), (SWITCHED, FIXED))
    )
    verdict = _verdict(fixed.less, switched.less, switch.less)
    open_questions = {UNKNOWN: (fixed, switched), SPRING: (switch, switched, fixed)}.get(verdict, ())
    return Judgement(
        verdict=verdict,
        why=next((each.why for each in open_questions if each.why), ""),
        best=best,
        saving=saving,
        pays={FIXED: fixed.less, SWITCHED: switched.less},
        spread={kind: spread([each for each in table if _alike(each, own)]) for kind, own in best.items()},
        outside={
            kind: own.stiffness
            for kind, own in best.items()
            if kind != NONE and not _within(own.stiffness, stiffnesses[0], stiffnesses[-1])
        },
    )


def spread(outcomes: Iterable[Outcome]) -> float:
    """Returns the largest relative difference between starts for one knee with one stiffness; NaN if none are alike."""
    found = [outcome for outcome in outcomes if outcome.found and not outcome.again]
    groups = [[other.cost for other in found if _alike(other, one)] for one in found]
    return max((max(costs) / min(costs) - 1.0 for costs in groups if len(costs) > 1), default=math.nan)


def _alike(one: Outcome, other: Outcome) -> bool:
    return one.kind == other.kind and _same(one.stiffness, other.stiffness)


def _same(one: float, other: float) -> bool:
    return abs(one - other) <= SAME * max(one, other)


def _within(stiffness: float, low: float, high: float) -> bool:
    return low <= stiffness <= high or _same(stiffness, low) or _same(stiffness, high)


def _knee(kind: str, table: Sequence[Outcome], stiffnesses: Sequence[float], unit: str) -> _Knee:
    """Returns what was found for one kind of knee.

    Args:
        kind: kind of `grid`.
        table: outcomes that have a gait.
        stiffnesses: given stiffnesses; each needs as many starts as agree.
        unit: unit of stiffnesses.
    """
    own = [outcome for outcome in table if outcome.kind == kind]
    groups, doubts = [], []
    for stiffness in stiffnesses:
        here = [outcome for outcome in own if _same(outcome.stiffness, stiffness)]
        asked = [outcome for outcome in here if not outcome.chosen]
        starts = sum(outcome.starts for outcome in here if not outcome.again)
        if here:
            groups.append(_Group(stiffness, tuple(outcome.cost for outcome in here)))
        if not asked:
            doubts.append(f"no gait was found {_said(kind, stiffness, unit)}")
        elif starts < STARTS:
            doubts.append(f"one search only found a gait {_said(kind, stiffness, unit)}")
    rest = [each for each in own if not any(_same(each.stiffness, stiffness) for stiffness in stiffnesses)]
    while rest:
        here = [each for each in rest if _same(each.stiffness, rest[0].stiffness)]
        groups.append(_Group(rest[0].stiffness, tuple(each.cost for each in here)))
        rest = [each for each in rest if each not in here]
    return _Knee(kind, tuple(groups), next(iter(doubts), ""), unit)


def _said(kind: str, stiffness: float, unit: str) -> str:
    return WITH[kind] if kind == NONE else f"{WITH[kind]} of {stiffness:.3g} {unit}"


def _compare(knee: _Knee, other: _Knee) -> _Comparison:
    """Tells whether a knee surely costs less than another by `LEAST` of its cost, or surely does not."""
    share = 1.0 - LEAST
    if any(max(group.costs) <= share * other.least for group in knee.groups):
        return _Comparison(None if other.doubt else True, other.doubt)
    if any(knee.least > share * max(group.costs) for group in other.groups):
        return _Comparison(None if knee.doubt else False, knee.doubt)
    if not knee.groups:
        return _Comparison(None, knee.doubt)
    return _Comparison(None, f"searches for one knee end farther apart than the knees: {other.ends}, {knee.ends}")


def _verdict(fixed: bool | None, switched: bool | None, switch: bool | None) -> str:
    """Returns the simplest knee that pays: a switch has to save something for itself.

    Args:
        fixed: whether a fixed spring saves, by `_compare`.
        switched: whether a switchable one does.
        switch: whether a switchable one costs less than a fixed one.
    """
    if switched and (switch or fixed is False):
        return SWITCHABLE
    if fixed and switch is False:
        return FIXED
    if fixed or switched:
        return SPRING
    return NONE if fixed is False and switched is False else UNKNOWN
