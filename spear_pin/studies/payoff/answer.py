"""Answer of a payoff study: what springs save, whether that is more than the doubt, and in one sentence."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED, Point
from spear_pin.studies.payoff.searches import SearchEnd
from spear_pin.studies.payoff.study import Study

PEAKS = {NONE: "without a spring", FIXED: "with a fixed one", SWITCHED: "with a switchable one"}
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
        spread: largest relative difference between starts, of the best points.
        mesh: largest relative change on a finer mesh, of the best points; NaN where the finer search failed.
        spread_of_all: median and largest relative difference between starts, of all points with several gaits.
        edges: where the best point is at the edge of what was tried, in words.
    """

    verdict: str
    sentence: str
    saving: Mapping[str, float]
    by_speed: Mapping[float, Mapping[str, float]]
    doubt: float
    spread: float
    mesh: float
    spread_of_all: tuple[float, float]
    edges: tuple[str, ...]


def answer(study: Study) -> Answer:
    """What follows from a study."""
    saving = {kind: _saving(study.best.get(NONE), study.best.get(kind)) for kind in (FIXED, SWITCHED)}
    by_speed = {
        speed: {kind: _saving(study.at(Point(NONE, speed)), _least(study, kind, speed)) for kind in (FIXED, SWITCHED)}
        for speed in study.grid.speeds
    }
    spread = max((_spread(study, each.point) for each in study.best.values()), default=0.0)
    changes = [change(each, study.finer[kind]) for kind, each in study.best.items()]
    mesh = float(np.nan) if not changes or np.isnan(changes).any() else float(max(changes))
    doubt = max(spread, 0.0 if np.isnan(mesh) else mesh)
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
        edges=_edges(study),
    )


def change(coarse: SearchEnd, fine: SearchEnd) -> float:
    """Relative change of the cost on a finer mesh, by magnitude; NaN where there is no gait on it."""
    return abs(fine.cost / coarse.cost - 1.0) if np.isfinite(fine.cost) else float(np.nan)


def _saving(without: SearchEnd | None, with_spring: SearchEnd | None) -> float:
    return float(np.nan) if without is None or with_spring is None else 1.0 - with_spring.cost / without.cost


def _least(study: Study, kind: str, speed: float) -> SearchEnd | None:
    """The cheapest of a kind at a speed, whatever the stiffness."""
    own = [found for point in study.tries if (point.kind, point.speed) == (kind, speed) and (found := study.at(point))]
    return min(own, key=lambda each: each.cost, default=None)


def _spread(study: Study, point: Point) -> float:
    """Relative difference between what the starts of a point led to."""
    costs = [each.cost for each in study.tries.get(point, ()) if each.figures is not None]
    return max(costs) / min(costs) - 1.0 if costs else 0.0


def _verdict(saving: Mapping[str, float], doubt: float) -> str:
    least = max(LEAST, doubt)
    if np.isnan(saving[SWITCHED]) and np.isnan(saving[FIXED]):
        return "unknown"
    fixed, switched = (float(np.nan_to_num(saving[kind], nan=-np.inf)) for kind in (FIXED, SWITCHED))
    if max(fixed, switched) < least:
        return "none"
    return "switchable" if switched - fixed >= least else "fixed"


def _sentence(study: Study, verdict: str, saving: Mapping[str, float], doubt: float) -> str:
    if verdict == "unknown":
        return "unknown: no gait with a spring, or none without one, was found"
    least = 100.0 * max(LEAST, doubt)
    opening = {
        "switchable": "yes",
        "fixed": "a spring pays, the switch does not",
        "none": f"no, no spring saves more than the {least:.2g} % that the search can tell apart",
    }[verdict]
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
        found.append(f"{extreme} that was asked for is the best")
    for kind in (FIXED, SWITCHED):
        best = study.best.get(kind)
        if best is not None and best.point.stiffness == stiffnesses[-1]:
            found.append(f"of {kind} springs the stiffest is the best")
        elif best is not None and best.point.stiffness == stiffnesses[0]:
            found.append(f"of {kind} springs the softest is the best")
    return tuple(found)
