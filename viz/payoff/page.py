"""Data for the template of a payoff study's page."""

from __future__ import annotations

import io
import math
from collections.abc import Mapping
from dataclasses import asdict
from typing import Any, NamedTuple

from markupsafe import Markup
from matplotlib.figure import Figure

from spear_pin import __version__
from spear_pin.hybrid.simulate import simulate
from spear_pin.studies.design import joints_of
from spear_pin.studies.payoff import Answer, SearchEnd, Study
from spear_pin.studies.payoff.answer import spread_of
from spear_pin.studies.payoff.figures import most
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.studies.payoff.motors import PARTS
from spear_pin.studies.payoff.verdict import LEAST, SWITCHABLE
from spear_pin.viz.embedding import drawing, shared
from spear_pin.viz.player import page, shortened
from spear_pin.viz.plots.paper import style
from spear_pin.viz.plots.payoff import TITLES
from spear_pin.viz.template import environment

STRIDES = 4  # that are played
CAPTIONS = {
    "cost": "{cost} of the cheapest gait found at each point, knees and hips together, nothing stored of what motors"
    " give back. Hatched: no gait was found.",
    "saving": "What the spring saves against the knee without one in the same row; below zero it costs.",
    "torque": "Torque of one knee motor of each leg that is shown over a cycle, of the best gait with each knee.",
}


class Row(NamedTuple):
    """A row of the table of all points."""

    point: str
    finding: SearchEnd | None
    starts: int
    spread: float | None
    failures: list[str]


NAMES: Mapping[str, str] = {  # in JSON, of fields of points and figures that are called by less among themselves
    "stiffness": "stiffness_per_leg",
    "peak": "peak_torque",
    "rms": "rms_torque",
    "rate": "peak_speed",
    "heat": "heating",
    "friction": "friction_used",
    "mechanical": "mechanical_cost",
    "multiplier": "largest_multiplier",
    "ledger": "ledger_gap",
}


def render(
    study: Study, answer: Answer, name: str, assumptions: list[tuple[str, str]], figures: Mapping[str, Figure]
) -> str:
    """Returns the text of the page.

    Args:
        study: the study.
        answer: conclusions of the study.
        name: name of the robot.
        assumptions: assumptions of the study, as names and texts.
        figures: figures of `spear_pin.viz.plots.payoff`.
    """
    best = {kind: finding for kind, finding in study.best.items() if finding.figures is not None}
    cheaper = min(
        (kind for kind in (FIXED, SWITCHED) if kind in best), key=lambda kind: best[kind].cost, default=SWITCHED
    )
    spring = {SWITCHABLE: SWITCHED, FIXED: FIXED}.get(answer.verdict, cheaper)
    played = [kind for kind in (NONE, spring) if kind in best]
    viewer, sides = shared(_playback(study, best[kind], f"{name}, {TITLES[kind].lower()}") for kind in played)
    return (
        environment()
        .get_template("payoff/page.html")
        .render(
            version=__version__,
            name=name,
            study=study,
            answer=answer,
            best=best,
            titles=TITLES,
            words=study.gaits.words,
            most=most,
            least=LEAST,
            energy=lambda figures: study.gaits.energy(study.robot, figures),
            joints=[joint for part in PARTS for joint in joints_of(study.robot, part)],
            played=played,
            rows=rows(study),
            assumptions=assumptions,
            figures={key: _element(figure, key, study) for key, figure in figures.items()},
            failed=[each for each in study.searches if each.reason],
            searches=len(study.searches),
            data={"viewer": viewer, "pages": dict(zip(played, sides, strict=True))},
        )
    )


def rows(study: Study) -> list[Row]:
    """Returns every point with its finding; freely chosen stiffnesses come last."""
    points = [*study.grid, *(point for point in study.tries if point.stiffness is None)]
    found = []
    for point in points:
        tries = study.tries.get(point, ())
        share = spread_of(tries)
        spread = None if math.isnan(share) else share
        failures = [f"from {each.origin}: {each.reason}" for each in tries if each.reason]
        found.append(Row(study.gaits.words.of(point), study.at(point), len(tries), spread, failures))
    return found


def _playback(study: Study, finding: SearchEnd, title: str) -> str:
    gait = study.gait(finding)
    trajectory = simulate(gait.system, gait.state, STRIDES, progress=False)
    pace = study.gaits.words.pace.format(finding.point.speed)
    return page(study.robot, shortened(study.robot, trajectory), title=f"{title}, {pace}")


def _element(figure: Figure, key: str, study: Study) -> tuple[Markup, str]:
    """Returns a figure and its caption."""
    file, caption = io.BytesIO(), CAPTIONS[key].format(cost=study.gaits.words.cost)
    with style():
        figure.savefig(file, format="svg", metadata={"Date": None})
    return drawing(file.getvalue(), key, caption), caption


def summary(study: Study, finding: SearchEnd) -> dict[str, Any]:
    """Returns a finding as JSON without the optimiser's unknowns; its electricity is that of a cycle, in J."""
    figures = finding.figures
    drawn = None if figures is None else study.gaits.energy(study.robot, figures)
    return {
        **_named(study, asdict(finding.point)),
        "reason": finding.reason,
        "electricity": drawn,
        "figures": None if figures is None else _named(study, asdict(figures)),
    }


def _named(study: Study, values: Mapping[str, Any]) -> dict[str, Any]:
    """Returns values by the names that other commands use."""
    names = {**NAMES, "speed": study.gaits.words.measure}
    return {names.get(name, name): value for name, value in values.items()}


def as_json(study: Study, answer: Answer) -> dict[str, Any]:
    """Returns the study and its answer as JSON; None for unknown values."""
    said = {part: {**asdict(getattr(study.motors, part)), "from": study.motors.said[part]} for part in PARTS}
    pace = study.gaits.words.measure
    result: dict[str, Any] = _known(
        {
            "answer": asdict(answer),
            pace: study.speed,
            f"{pace}s": study.grid.speeds,
            "stiffnesses_per_leg": study.grid.stiffnesses,
            "chosen_stiffness_per_leg": study.chosen,
            "motors": said,
            "best": {kind: summary(study, each) for kind, each in study.best.items()},
            "finer": {kind: summary(study, each) for kind, each in study.finer.items()},
            "points": [
                {"point": row.point, "starts": row.starts, "spread": row.spread, "failures": row.failures}
                | ({} if row.finding is None else summary(study, row.finding))
                for row in rows(study)
            ],
            "cpu_seconds": study.seconds,
        }
    )
    return result


def _known(value: Any) -> Any:
    """Returns a value with None for what is not a finite number."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {str(key): _known(item) for key, item in value.items()}
    return [_known(item) for item in value] if isinstance(value, (list, tuple)) else value
