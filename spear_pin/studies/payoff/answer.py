"""Answer of a payoff study: how much springs save, how sure that is, and a sentence that says it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from spear_pin.studies.payoff.figures import most
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.studies.payoff.searches import SearchEnd
from spear_pin.studies.payoff.study import Study
from spear_pin.studies.payoff.verdict import LEAST, SPRING, SWITCHABLE, UNKNOWN, Judgement, Outcome, judge, spread

PEAKS = {NONE: "without a spring", FIXED: "with a fixed one", SWITCHED: "with a switchable one"}
BEYOND = ": beyond it there may be better"


@dataclass(frozen=True)
class Answer:
    """Conclusions of a study.

    Attributes:
        verdict: the knee that pays, one of ``VERDICTS`` of `verdict`: "switchable"; "fixed", if it does as well as a
            switchable one; "spring", if it is open which; "none"; "unknown", if it cannot be decided.
        sentence: the verdict with its numbers.
        saving: for each kind of spring, the share of the electrical cost that it saves at the speed; negative: it costs
            more.
        by_speed: conclusions at each speed of the grid, with the speed of the study.
        spread: largest relative difference between starts with one stiffness, for the best points; NaN if there is
            none.
        mesh: largest relative change on a finer mesh, for the best points that were found on it; NaN if there is none.
        spread_of_all: median and largest relative difference between starts with one stiffness, of all points with
            several gaits.
        cautions: reservations about the best points, in words: they are at the edge of the range, were not found on a
            finer mesh, or overload a motor.
    """

    verdict: str
    sentence: str
    saving: Mapping[str, float]
    by_speed: Mapping[float, Judgement]
    spread: float
    mesh: float
    spread_of_all: tuple[float, float]
    cautions: tuple[str, ...]


def answer(study: Study) -> Answer:
    """Returns the conclusions of a study."""
    stiffnesses, unit = study.grid.stiffnesses, study.gaits.words.unit
    by_speed = {speed: judge(_table(study, speed), stiffnesses, unit) for speed in study.grid.speeds}
    found = by_speed[study.speed]
    everywhere = [share for point in study.tries if (share := spread_of(study.tries[point])) > 0.0] or [0.0]
    return Answer(
        verdict=found.verdict,
        sentence=_sentence(study, found),
        saving=found.saving,
        by_speed=by_speed,
        spread=_largest(found.spread.values()),
        mesh=_largest(study.changes.values()),
        spread_of_all=(float(np.median(everywhere)), float(max(everywhere))),
        cautions=(*_at_limits(study), *_edges(study), *_missed(study), *_overheated(study)),
    )


def spread_of(ends: Iterable[SearchEnd]) -> float:
    """Returns the largest relative difference between starts with one stiffness; NaN where no two have one."""
    return spread(map(_outcome, ends))


def _table(study: Study, speed: float) -> list[Outcome]:
    """Lists every search at a speed."""
    return [_outcome(end, study) for point in study.tries if point.speed == speed for end in study.ends(point)]


def _outcome(end: SearchEnd, study: Study | None = None) -> Outcome:
    """Returns the outcome of a search; one on a study's finer mesh began with the gait of the same knee."""
    point, figures = end.point, end.figures
    stiffness = point.stiffness if point.stiffness is not None else figures.stiffness if figures else float(np.nan)
    again = study is not None and end.key in {each.key for each in study.finer.values()}
    starts = figures.starts if figures else 1
    return Outcome(point.kind, stiffness, end.cost, point.stiffness is None, again, starts)


def _largest(values: Iterable[float]) -> float:
    """Returns the largest known value; NaN where none is known."""
    return max((value for value in values if not np.isnan(value)), default=float(np.nan))


def _sentence(study: Study, found: Judgement) -> str:
    """Returns the verdict in words, with its reasons."""
    least = f"{100.0 * LEAST:g} %"
    opening = {
        SWITCHABLE: "yes",
        FIXED: "a spring pays, and switching it adds nothing that the search can tell",
        SPRING: f"a spring pays, but whether it has to be switched cannot be told, for {found.why}",
        NONE: f"no, no spring that was tried saves {least} or more",
        UNKNOWN: f"cannot tell, for {found.why}",
    }[found.verdict]
    if NONE not in study.best or len(study.best) == 1:
        return opening
    cost = {kind: end.cost for kind, end in study.best.items()}
    first, second = sorted((FIXED, SWITCHED), key=lambda kind: cost.get(kind, np.inf))
    costs = f" ({cost[first]:.3g} against {cost[NONE]:.3g} without)" if first in cost else ""
    peaks = ", ".join(
        f"{most(best.figures.peak, 'knee'):.3g} {word}"
        for kind, word in PEAKS.items()
        if (best := study.best.get(kind)) is not None and best.figures is not None
    )
    pace = study.gaits.words.pace.format(study.speed)
    return (
        f"{opening}: {pace} {_does(study, first, found)}{costs}, {_does(study, second, found)};"
        f" peak knee torque, in N·m: {peaks}"
    )


def _does(study: Study, kind: str, found: Judgement) -> str:
    """Says how much a spring of a kind saves."""
    best, name = study.best.get(kind), {FIXED: "fixed", SWITCHED: "switchable"}[kind]
    if best is None or best.figures is None:
        return f"with a {name} spring no gait was found"
    share, tried, unit = 100.0 * found.saving[kind], study.grid.stiffnesses, study.gaits.words.unit
    does = f"saves {share:.1f} % of" if share >= 0.0 else f"adds {-share:.1f} % to"
    outside = f", outside the {tried[0]:.3g} to {tried[-1]:.3g} of the grid," if kind in found.outside else ""
    chosen = study.gaits.words.of_numbers(best.figures.chosen)
    own = f"{unit} per leg{outside}" + f" with {chosen}" * bool(chosen)
    return f"a {name} spring of {best.figures.stiffness:.3g} {own} {does} the electricity"


def _edges(study: Study) -> tuple[str, ...]:
    """Says where the best point is at the edge of the range that was tried, or beyond."""
    words, speeds, stiffnesses = study.gaits.words, study.grid.speeds, study.grid.stiffnesses
    found = []
    if len(speeds) > 1 and study.speed in (speeds[0], speeds[-1]):
        extreme = words.slowest if study.speed == speeds[0] else words.fastest
        found.append(f"{extreme} that was asked for is the best{BEYOND}")
    for kind in (FIXED, SWITCHED) if len(stiffnesses) > 1 else ():
        best = study.best.get(kind)
        if best is not None and best.point.stiffness == stiffnesses[-1]:
            found.append(f"of {kind} springs the stiffest is the best{BEYOND}")
        elif best is not None and best.point.stiffness == stiffnesses[0]:
            found.append(f"of {kind} springs the softest is the best{BEYOND}")
    return tuple(found)


def _at_limits(study: Study) -> list[str]:
    """Says which best points the search's limits hold: a wider search may find less cost there."""
    found = []
    for kind, end in study.best.items():
        if end.figures is not None and end.figures.held:
            less = ", and the springs then save less" if kind == NONE else ""
            held = "; ".join(end.figures.held)
            found.append(f"{PEAKS[kind]}, limits hold the best: {held}. Without them it may cost less{less}")
    return found


def _missed(study: Study) -> list[str]:
    """Lists knees without a gait on a finer mesh."""
    failed = [PEAKS[kind] for kind, share in study.changes.items() if np.isnan(share)]
    return [f"no gait was found on a finer mesh {' and '.join(failed)}"] * bool(failed)


def _overheated(study: Study) -> list[str]:
    """Lists motors of the best points that cannot give their torque continuously."""
    return [
        f"{PEAKS[kind]}, the motor of the {joint.replace('_', ' ')} gets {share:.2f} times its continuous heat"
        for kind, found in study.best.items()
        for joint, share in (found.figures.heat if found.figures else {}).items()
        if share > 1.0
    ]
