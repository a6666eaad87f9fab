"""Cards: rows with the contents of a result, and a drawing."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import singledispatch

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import list_names
from spear_pin.gaits.codesign.design import Design
from spear_pin.gaits.continuation.branch import Branch
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.gait_table import GaitTable
from spear_pin.gaits.sensitivity.monte_carlo import MonteCarlo
from spear_pin.gaits.sensitivity.sensitivity import Sensitivity
from spear_pin.gaits.sensitivity.uncertainty import Uncertainty
from spear_pin.hybrid.batch import Batch
from spear_pin.hybrid.column_names import PAIR, of_a_pair
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.robot import Robot
from spear_pin.studies.logs import MotionFit, Replay
from spear_pin.studies.logs.replaying import MEASURES
from spear_pin.viz.notebook import sketches
from spear_pin.viz.notebook.sketches import Sketch
from spear_pin.viz.plots.sweep import UNITS
from spear_pin.viz.template import environment
from spear_pin.words import show_unit

MOST_ROWS = 12  # of a kind
ROUNDING = 1e-9  # of the largest value: less is zero


@dataclass(frozen=True)
class Row:
    """A line of a card: name, value, unit, and a drawing beside it."""

    name: str
    value: str
    unit: str = ""
    sketch: Sketch | None = None


@dataclass(frozen=True)
class Card:
    """Contents of a card: a title, a remark on it, rows, and a drawing beside them."""

    title: str
    remark: str
    rows: tuple[Row, ...]
    sketch: Sketch | None = None


def card(shown: object) -> str:
    """Returns the card of a robot, a gait, a trajectory or a table of many, as HTML."""
    return environment().get_template("notebook/card.html").render(card=described(shown))


@singledispatch
def described(shown: object) -> Card:
    """Returns the contents of a card; for an unknown object, its text."""
    return Card(type(shown).__name__, repr(shown), ())


@described.register
def _(robot: Robot) -> Card:
    units = [
        f" ({unit})" if robot.nq == robot.nv else "" for unit in robot.units
    ]  # a floating joint's are of its rates
    coordinates = (f"{name}{unit}" for name, unit in zip(robot.coordinates, units, strict=True))
    ratios = (f"{joint} ({robot.gear_ratio(joint):.4g} : 1)" for joint in robot.actuated)
    rows = [
        Row("mass", _number(robot.mass), "kg"),
        Row("coordinates", _some(coordinates)),
        Row("motors", _some(ratios) or "none"),
        Row("toes", _some(robot.toes) or "none"),
        *([Row("locked", _some(robot.locked))] if robot.locked else []),
        *(Row(name, _number(value), UNITS.get(name, "")) for name, value in robot.varied.items()),
    ]
    kind = "planar" if robot.planar else "three-dimensional"
    return Card(robot.name, f"{kind} robot", tuple(rows), sketches.standing(robot))


@described.register
def _(gait: Gait) -> Card:
    largest = float(np.abs(gait.multipliers).max())
    verdict = "stable" if gait.stable else "unstable"
    rows = [
        *(Row(_words(name), _number(value), UNITS.get(name, "")) for name, value in gait.parameters.items()),
        Row("period", _number(gait.period), "s"),
        *(Row(_words(phase), _number(seconds), "s") for phase, seconds in gait.durations.items()),
        Row("largest multiplier", f"{_number(largest)}, {verdict}"),
        Row("residual", f"{gait.residual:.1e}"),
    ]
    system = gait.system
    remark = f"{verdict} gait of {system.robot.name}"
    return Card(_words(system.kind), remark, tuple(rows), sketches.circle(gait.multipliers))


@described.register
def _(run: Trajectory) -> Card:
    units, t = run.units(), run.t
    counts = Counter(event.name for event in run.events)
    residual = np.abs(run.ledger.residual).max(initial=0.0)
    rows = [
        Row("time", f"{_number(t[0])} to {_number(t[-1])}", "s"),
        Row("cycles", f"{run.cycles} whole"),
        Row("events", _some(f"{count} {_words(name)}" for name, count in counts.items()) or "none"),
        *(
            Row(f"q_{name}", _range(run.q[:, i]), units[f"q_{name}"], _line(run, run.q[:, i], name))
            for i, name in list(enumerate(run.coordinates))[:MOST_ROWS]
        ),
        *(
            Row(
                f"force_z_{toe}{PAIR * of_a_pair(f'force_z_{toe}')}",
                _range(run.force[:, i, -1]),
                "N",
                _line(run, run.force[:, i, -1], toe),
            )
            for i, toe in list(enumerate(run.toes))[:MOST_ROWS]
        ),
        *([Row("energy unaccounted for", f"{residual:.1e}", "J a cycle")] if run.cycles else []),
        *([] if run.complete else [Row("ended", run.message)]),
    ]
    return Card(f"Motion of {run.robot}", f"{len(run):,} samples", tuple(rows))


@described.register
def _(table: GaitTable) -> Card:
    rows = [
        *_reasons(table.reason),
        Row("stable", f"{table.stable.sum():,}", sketch=sketches.bar(float(table.stable.mean()), "share of the lanes")),
        *(Row(_words(name), _range(values), UNITS.get(name, "")) for name, values in table.parameters.items()),
        Row("largest multiplier", _range(table.largest)),
        *(Row(_words(phase), _range(values), "s") for phase, values in table.durations.items()),
    ]
    name, values = next(iter(table.parameters.items()))
    drawn = sketches.scatter(values, table.largest, 1.0, f"largest multiplier over {_words(name)}, and 1")
    return Card("Gaits", f"of {len(table):,} lanes", tuple(rows), drawn)


@described.register
def _(branch: Branch) -> Card:
    unit = UNITS.get(branch.over, "")
    happens = branch.rows()
    rows = [
        Row(_words(branch.over), _range(branch.values), unit),
        *(Row(_words(name), _range(values), UNITS.get(name, "")) for name, values in branch.solved.items()),
        Row("stable", f"{branch.stable.sum():,} of {len(branch):,} points"),
        Row("largest multiplier", _range(branch.largest)),
        *(Row(f"at {_number(value)}", text, "") for value, text in happens[:MOST_ROWS]),
        *([Row("", f"and {len(happens) - MOST_ROWS} more")] if len(happens) > MOST_ROWS else []),
    ]
    says = f"largest multiplier over {_words(branch.over)}, and 1"
    drawn = sketches.scatter(branch.values, branch.largest, 1.0, says)
    return Card("Branch of gaits", f"of {branch.family.system.robot.name}", tuple(rows), drawn)


@described.register
def _(table: Sensitivity) -> Card:
    rows = [
        *(
            Row(_words(name), _number(value), unit)
            for name, value, unit in zip(table.parameters, table.given, table.units, strict=True)
        ),
        *(
            Row(_words(name), f"{_number(value)}; {_elasticities(table, name)}", table.output_units[name])
            for name, value in table.outputs.items()
        ),
    ]
    remark = "per cent for one more per cent of each parameter"
    return Card("Sensitivity of a gait", f"of {table.system.robot.name}; {remark}", tuple(rows))


@described.register
def _(spread: Uncertainty) -> Card:
    given = zip(spread.over, spread.table.given, spread.parameter_deviations, spread.table.units, strict=True)
    rows = [
        *(Row(_words(name), f"{_number(value)} ± {_number(sigma)}", unit) for name, value, sigma, unit in given),
        *(
            Row(
                _words(name),
                f"{_number(value)} ± {_number(spread.deviation(name))}; {_gains(spread, name)}",
                spread.output_units[name],
            )
            for name, value in spread.outputs.items()
            if spread.moves(name)
        ),
    ]
    remark = "standard deviations to first order; per cent of the variance that knowing each parameter takes away"
    return Card("Uncertainty of a gait", f"of {spread.table.system.robot.name}; {remark}", tuple(rows))


def _gains(spread: Uncertainty, name: str) -> str:
    return ", ".join(f"{100.0 * gain:.2g} %" for gain in spread.gains(name))


@described.register
def _(drawn: MonteCarlo) -> Card:
    rows = [
        Row(
            _words(name),
            f"{_number(first)} to first order, {_number(drawn.deviation(name))} ± {_number(drawn.error(name))}",
            drawn.spread.output_units[name],
        )
        for name, first in drawn.first.items()
    ]
    said = [Row("", line) for line in drawn.statement().splitlines()]
    return Card("Monte Carlo of a gait", f"standard deviations over {', '.join(drawn.over)}", (*rows, *said))


def _elasticities(table: Sensitivity, name: str) -> str:
    return ", ".join(f"{value:+.2g} %" if np.isfinite(value) else "none" for value in table.elasticity(name))


@described.register
def _(design: Design) -> Card:
    rows = [
        Row(_words(design.minimize), f"{_number(design.start)} to {_number(design.objective)}", design.unit),
        *(
            Row(_words(name), f"{_number(each.start)} to {_number(each.value)}", show_unit(each.unit))
            for name, each in design.parameters.items()
        ),
        Row("largest multiplier", _number(design.largest)),
        *(Row(_words(name), f"{price:+.3g} for one more", "") for name, price in design.active.items()),
        *(Row(_words(name), f"{design.elasticity(name):+.2g} % for 1 %") for name in design.ranked[:MOST_ROWS]),
        Row("cycles", f"{design.cycles:,}"),
    ]
    iterations = np.arange(len(design.path), dtype=float)
    values = np.array([value for value, _ in design.path])
    drawn = sketches.scatter(iterations, values, design.objective, f"{_words(design.minimize)} over iterations")
    return Card("Design", f"of {design.gait.system.robot.name}; {design.reason}", tuple(rows), drawn)


@described.register
def _(batch: Batch) -> Card:
    rows = [
        *_reasons(batch.reason),
        Row("cycles", _range(batch.cycles.astype(float))),
        *(Row(_words(phase), _range(values), "s") for phase, values in batch.durations.items()),
        Row("run by the reference engine", f"{batch.repeated.sum():,}"),
    ]
    return Card("Runs", f"of {len(batch):,} lanes", tuple(rows))


@described.register
def _(fit: MotionFit) -> Card:
    rows = [
        *(
            Row(
                _words(name),
                f"{_number(each.value)} ± {_number(each.deviation)}",
                show_unit(each.unit),
            )
            for name, each in fit.found.items()
        ),
        Row("residual", _number(fit.rms), fit.unit),
        *(Row("", doubt) for doubt in fit.doubts),
    ]
    return Card("Fit to logs", f"{len(fit.arcs)} phases; values ± standard deviations", tuple(rows))


@described.register
def _(replay: Replay) -> Card:
    rows = [
        Row(
            f"{_words(name)} from {hop.stance.begin:.3f} s",
            f"{_number(hop.measures[name][0])}; in the log {_number(hop.measures[name][1])}",
            unit,
        )
        for hop in replay.hops[:MOST_ROWS]
        for name, unit in MEASURES.items()
    ]
    off = [Row(f"{_words(name)}, off on average", _number(100.0 * replay.off(name)), "%") for name in MEASURES]
    return Card("Replay of a log", f"of {len(replay.hops)} hops by the model", (*rows, *off))


def _reasons(reasons: NDArray[np.str_]) -> Iterator[Row]:
    """Says how many lanes ended for each reason."""
    for reason, count in Counter(reasons.tolist()).most_common():
        yield Row(_words(reason), f"{count:,}", sketch=sketches.bar(count / len(reasons), "share of the lanes"))


def _line(run: Trajectory, values: NDArray[np.float64], name: str) -> Sketch:
    return sketches.over_time(run.t, values, f"{name} over time")


def _words(name: str) -> str:
    return name.replace("_", " ")


def _number(value: float) -> str:
    return f"{value:.4g}".replace("-", "−")


def _range(values: NDArray[np.float64]) -> str:
    known = values[np.isfinite(values)]
    if not len(known):
        return "none"
    tiny = ROUNDING * np.abs(known).max()
    low, high = (_number(0.0 if abs(value) <= tiny else float(value)) for value in (known.min(), known.max()))
    return low if low == high else f"{low} to {high}"


def _some(words: Iterable[str]) -> str:
    return list_names(list(words), MOST_ROWS)
