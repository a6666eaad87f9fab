"""Answer of a payoff study: what springs save, whether that is more than the doubt, and in one sentence."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED, Point
from spear_pin.studies.payoff.searches import SearchEnd
from spear_pin.studies.payoff.study import Study

PEAKS = {NONE: "without a spring", FIXED: "with a fixed one", SWITCHED: "with a switchable one"}
BEYOND = ": beyond it there may be better"
LEAST = 0.02  # of a cost: a smaller saving pays for no spring, whatever the doubt


@dataclass(frozen=True)
class Answer:
    """What follows from a study.

    Attributes:
        verdict: "switchable", "fixed", "none" or "unknown": the knee that pays.
        sentence: that, with its numbers.
        saving: of each kind of spring the share of the electrical cost that it saves at the speed; negative: it costs.
        by_speed: the same at each speed of the grid, of the best stiffness there; NaN where one is missing.
        doubt: share of a cost that a saving has to exceed: the largest of the next two.
        spread: largest relative difference between starts, of the best points that had several; NaN of none.
        mesh: largest relative change on a finer mesh, of the best points that were found on it; NaN of none.
        spread_of_all: median and largest relative difference between starts, of all points with several gaits.
        cautions: what speaks against the best points, in words: that they are at the edge of what was tried, were not
            found on a finer mesh, or ask too much of a motor.
    """

    verdict: str
    sentence: str
    saving: Mapping[str, float]
    by_speed: Mapping[float, Mapping[str, float]]
    doubt: float
    spread: float
    mesh: float
    spread_of_all: tuple[float, float]
    cautions: tuple[str, ...]


def answer(study: Study) -> Answer:
    """What follows from a study."""
    saving = {kind: _saving(study.best.get(NONE), study.best.get(kind)) for kind in (FIXED, SWITCHED)}
    by_speed = {
        speed: {kind: _saving(study.at(Point(NONE, speed)), _least(study, kind, speed)) for kind in (FIXED, SWITCHED)}
        for speed in study.grid.speeds
    }
    spread = _largest(_spread(study, each.point) for each in study.best.values())
    mesh = _largest(study.changes.values())
    doubt = float(np.nan_to_num([spread, mesh], nan=0.0).max())
    everywhere = [each for point in study.tries if (each := _spread(study, point)) > 0.0] or [0.0]
    verdict = _verdict(saving, doubt)
    return Answer(
        verdict=verdict,
        sentence=_sentence(study, verdict, saving, doubt),
        saving=saving,
        by_speed=by_speed,
        doubt=doubt,
        spread=spread,
        mesh=mesh,
        spread_of_all=(float(np.median(everywhere)), float(max(everywhere))),
        cautions=(*_edges(study), *_missed(study), *_overheated(study)),
    )


def _largest(values: Iterable[float]) -> float:
    """The largest that is known; NaN where none is."""
    return max((value for value in values if not np.isnan(value)), default=float(np.nan))


def _saving(without: SearchEnd | None, with_spring: SearchEnd | None) -> float:
    return float(np.nan) if without is None or with_spring is None else 1.0 - with_spring.cost / without.cost


def _least(study: Study, kind: str, speed: float) -> SearchEnd | None:
    """The cheapest of a kind at a speed, whatever the stiffness."""
    own = [found for point in study.tries if (point.kind, point.speed) == (kind, speed) and (found := study.at(point))]
    return min(own, key=lambda each: each.cost, default=None)


def _spread(study: Study, point: Point) -> float:
    """Relative difference between what the starts of a point led to; NaN of a single one."""
    costs = [each.cost for each in study.tries.get(point, ()) if each.figures is not None]
    return max(costs) / min(costs) - 1.0 if len(costs) > 1 else float(np.nan)


def _verdict(saving: Mapping[str, float], doubt: float) -> str:
    """The simplest knee that pays: a switch has to save what can be told more than no switch."""
    least, missing = max(LEAST, doubt), np.isnan(list(saving.values())).any()
    fixed, switched = (float(np.nan_to_num(saving[kind], nan=-np.inf)) for kind in (FIXED, SWITCHED))
    if max(fixed, switched) < least:
        return "unknown" if missing else "none"
    return "switchable" if fixed < least or switched - fixed >= least else "fixed"


def _sentence(study: Study, verdict: str, saving: Mapping[str, float], doubt: float) -> str:
    if NONE not in study.best or len(study.best) == 1:
        return "unknown: no gait with a spring, or none without one, was found"
    told = f"the {100.0 * max(LEAST, doubt):.2g} % that the search can tell apart"
    opening = {
        "switchable": "yes",
        "fixed": "a spring pays, and switching it adds nothing that the search can tell",
        "none": f"no, no spring saves more than {told}",
        "unknown": f"unknown, for what was found saves less than {told}",
    }[verdict]
    if verdict in ("switchable", "fixed") and np.isnan(list(saving.values())).any():
        opening = "a spring pays, and whether it has to be switched is not known"
    first, second = (FIXED, SWITCHED) if verdict == "fixed" else (SWITCHED, FIXED)
    bare = study.best[NONE].cost
    costs = f" ({study.best[first].cost:.3g} against {bare:.3g} without)" if first in study.best else ""
    peaks = ", ".join(f"{_peak(study.best[kind]):.3g} {word}" for kind, word in PEAKS.items() if kind in study.best)
    pace = study.gaits.words.pace.format(study.speed)
    return (
        f"{opening}: {pace} {_does(study, first, saving)}{costs}, {_does(study, second, saving)};"
        f" peak knee torque, in N·m: {peaks}"
    )


def _does(study: Study, kind: str, saving: Mapping[str, float]) -> str:
    """What a spring of a kind saves, in words."""
    found, name = study.best.get(kind), {FIXED: "fixed", SWITCHED: "switchable"}[kind]
    if found is None or found.figures is None:
        return f"with a {name} spring no gait was found"
    share = 100.0 * saving[kind]
    does = f"saves {share:.1f} % of" if share >= 0.0 else f"adds {-share:.1f} % to"
    return f"a {name} spring of {found.figures.stiffness:.3g} N·m/rad per leg {does} the electricity"


def _peak(finding: SearchEnd) -> float:
    """Largest torque of a knee's motor, in N·m."""
    assert finding.figures is not None
    return max(torque for joint, torque in finding.figures.peak.items() if joint.endswith("knee"))


def _edges(study: Study) -> tuple[str, ...]:
    """Where the best point is at the edge of what was tried."""
    words, speeds, stiffnesses = study.gaits.words, study.grid.speeds, study.grid.stiffnesses
    found = []
    if len(speeds) > 1 and study.speed in (speeds[0], speeds[-1]):
        extreme = words.slowest if study.speed == speeds[0] else words.fastest
        found.append(f"{extreme} that was asked for is the best{BEYOND}")
    for kind in (FIXED, SWITCHED):
        best = study.best.get(kind)
        if best is not None and best.point.stiffness == stiffnesses[-1]:
            found.append(f"of {kind} springs the stiffest is the best{BEYOND}")
        elif best is not None and best.point.stiffness == stiffnesses[0]:
            found.append(f"of {kind} springs the softest is the best{BEYOND}")
    return tuple(found)


def _missed(study: Study) -> list[str]:
    """Knees of which no gait was found on a finer mesh."""
    failed = [PEAKS[kind] for kind, share in study.changes.items() if np.isnan(share)]
    return [f"no gait was found on a finer mesh {' and '.join(failed)}"] * bool(failed)


def _overheated(study: Study) -> list[str]:
    """Motors of the best points that do not bear for ever what they give."""
    return [
        f"{PEAKS[kind]}, the motor of the {joint.replace('_', ' ')} is heated {share:.2f} times as it bears for ever"
        for kind, found in study.best.items()
        for joint, share in (found.figures.heat if found.figures else {}).items()
        if share > 1.0
    ]
