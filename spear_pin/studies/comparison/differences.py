"""Measures of several sides in one table, parameters that differ, and the largest differences in sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import chain
from typing import Any

from spear_pin.errors import list_names
from spear_pin.studies.comparison.measures import BODY, GAIT, GROUPS, of_side
from spear_pin.studies.comparison.sides import Side, parameters, units
from spear_pin.studies.hop import durations

SPEED = "mean speed"
SAME = 1e-9  # of a value: less is rounding
TOLD = 1.0  # %: smaller differences make no sentence
STRAIGHT = 3  # decimals of a degree a cycle: what turns by less goes straight
MOST_TOLD = 4  # measures that a sentence names
KEY = (  # what measures begin with that sentences name
    SPEED, "period", "flight time", "greatest height", "peak normal force", "peak torque", "peak spring torque",
    "motors' work, |power|", "cost of transport", "mass",
)  # fmt: skip
TOLERATED = 1e-3  # of the largest: what differs by less is the same task
ERRORS = ("residual", "unaccounted")  # of which a share says nothing
NOTHING = 1e-6  # of the first value, in its unit: a share of less says nothing


@dataclass(frozen=True)
class ComparedMeasure:
    """A measure of all sides.

    Attributes:
        group: group of the measure.
        name: name of the measure.
        unit: unit of its values.
        values: one for each side; None where a side has no such measure.
    """

    group: str
    name: str
    unit: str
    values: tuple[float | None, ...]

    @property
    def changes(self) -> tuple[float | None, ...]:
        """Difference of each value from the first, in the unit."""
        first = self.values[0]
        return tuple(None if first is None or value is None else self._less(value, first) for value in self.values)

    @property
    def shares(self) -> tuple[float | None, ...]:
        """Difference of each value from the first in %; None where the first is near zero, or where it says nothing."""
        first = self.values[0]
        if first is None or abs(first) < NOTHING or self.name.startswith(ERRORS):
            return (None,) * len(self.values)
        return tuple(None if change is None else 100.0 * change / abs(first) for change in self.changes)

    @staticmethod
    def _less(value: float, first: float) -> float:
        return 0.0 if math.isclose(value, first, rel_tol=SAME) else value - first


@dataclass(frozen=True)
class Difference:
    """A parameter that differs between sides.

    Attributes:
        name: part and name of the parameter.
        values: one for each side; None where a side does not have it.
        units: unit of each value of a spring; empty for other parameters, whose names tell it.
    """

    name: str
    values: tuple[Any, ...]
    units: tuple[str, ...] = ()


def compare_measures(sides: Sequence[Side]) -> tuple[ComparedMeasure, ...]:
    """Returns every measure that some side has; for robots only where they differ, or if all sides are robots."""
    found = [of_side(side) for side in sides]
    rows = []
    for group in GROUPS:
        keys = dict.fromkeys(key for each in found for key in each.get(group, {}))
        for name, unit in keys:
            rows.append(
                ComparedMeasure(group, name, unit, tuple(each.get(group, {}).get((name, unit)) for each in found))
            )
    robots = all(side.kind == "robot" for side in sides)
    return tuple(row for row in rows if row.group != BODY or robots or _differs(row.values))


def differences(sides: Sequence[Side]) -> tuple[Difference, ...]:
    """Returns parameters of robot, law, spring and ground that differ between the sides that give them."""
    found = [parameters(side) for side in sides]
    names = dict.fromkeys(name for each in found for name in each)
    # a motion does not say its law; what a robot does not say is as usual
    known = {name: [each.get(name) for each in found if name in each or name.startswith("robot")] for name in names}
    measured = [units(side) for side in sides]
    told = {name: tuple(each.get(name, "") for each in measured) for name in dict.fromkeys(chain(*measured))}
    return tuple(
        Difference(name, tuple(each.get(name) for each in found), told.get(name, ()))
        for name in names
        if _differs(known[name])
    )


def describe_differences(sides: Sequence[Side], rows: Sequence[ComparedMeasure]) -> tuple[str, ...]:
    """Says in sentences how sides differ: different tasks, which gaits are stable, and the largest differences."""
    sentences = other_task(sides, rows)
    gaits = [side for side in sides if side.gait is not None]
    if gaits:
        largest = next(row for row in rows if row.group == GAIT and row.name == "largest multiplier")
        by_label = dict(zip((side.label for side in sides), largest.values, strict=True))
        parts = [
            f"{side.label} is {'stable' if side.gait.stable else 'unstable'}"
            f" (largest multiplier {by_label[side.label]:.4g})"
            for side in gaits
            if side.gait is not None
        ]
        sentences.append("; ".join(parts) + ".")
    told = [row for row in rows if row.name.startswith(KEY)]
    for i, side in enumerate(sides[1:], start=1):
        both = [row for row in told if row.values[i] is not None and row.values[0] is not None]
        changed = [(row, share) for row in both if (share := row.shares[i]) is not None and abs(share) >= TOLD]
        if both and not changed and (side.run is None) == (sides[0].run is None):
            names = list_names([row.name for row in both])
            sentences.append(f"{side.label} differs from {sides[0].label} by less than {TOLD:g} % in {names}.")
        if not changed:
            continue
        changed.sort(key=lambda pair: -abs(pair[1]))
        parts = [f"{row.name} {_percent(share)} ({_pair(row, i)})" for row, share in changed[:MOST_TOLD]]
        sentences.append(f"{side.label} against {sides[0].label}: {', '.join(parts)}.")
    robots = list(dict.fromkeys(side.robot.name for side in sides))
    if len(robots) > 1:
        sentences.append(f"The robots are different: {list_names(robots)}.")
    return tuple(sentences)


def other_task(sides: Sequence[Side], rows: Sequence[ComparedMeasure]) -> list[str]:
    """Says in which way sides have different tasks: kind of gait, flight time, speed, turn of a cycle, or slope.

    Args:
        sides: the compared sides.
        rows: their measures.

    Returns:
        One sentence; none where all do the same, as far as they say it.
    """
    kinds = [side.gait.system.kind.replace("_", " ") for side in sides if side.gait is not None]
    parts = [f"gaits of different kinds ({list_names(list(dict.fromkeys(kinds)))})"] if len(set(kinds)) > 1 else []
    speeds = next((row.values for row in rows if row.name == SPEED), ())
    known = {
        "flight times": ("s", [_flight(side) for side in sides]),
        "mean speeds": ("m/s", speeds),
        "turns a cycle": ("°", [_turn(side) for side in sides]),
        "slopes": ("rad", [_slope(side) for side in sides]),
    }
    for name, (unit, values) in known.items():
        told = [value for value in values if value is not None]
        scale = max(map(abs, told), default=0.0)
        if scale > NOTHING and max(told) - min(told) > TOLERATED * scale:
            *others, last = [f"{value:#.4g}".replace("-", "−") for value in told]
            parts.append(f"{name} {', '.join(others)} and {last} {unit}")
    return [f"Not the same task: {'; '.join(parts)}."] if parts else []


def _flight(side: Side) -> float | None:
    """Returns the flight time of a hop, in s; None for other sides."""
    if side.gait is not None:
        return side.gait.durations.get("flight")
    if side.run is None or not side.run.cycles or not side.run.named("lift_off"):
        return None
    return float(durations(side.run)[:, 1].mean())


def _turn(side: Side) -> float | None:
    """Returns by how much the heading turns in a cycle, in °; None in the plane, or without a whole cycle."""
    run = side.run
    if run is None or "yaw" not in run.coordinates:
        return None
    halves = side.gait is None or bool(side.gait.system.mirrored_toes)  # of which one undoes what the other turns
    cycles = run.cycles - run.cycles % 2 if halves else run.cycles
    if not cycles:
        return None
    yaw = run.q[(run.cycle >= 1) & (run.cycle <= cycles), run.coordinates.index("yaw")]
    return round(math.degrees(float(yaw[-1] - yaw[0])) / cycles, STRAIGHT)


def _slope(side: Side) -> float | None:
    """Returns the slope of the ground, in rad; None if it is unknown or the ground is not a plane."""
    ground = side.gait.system.ground if side.gait is not None else None if side.run is None else side.run.ground
    return None if ground is None else float(ground.slope)


def _percent(share: float) -> str:
    return f"{share:+.3g} %".replace("-", "−")


def _pair(row: ComparedMeasure, i: int) -> str:
    first, value = row.values[0], row.values[i]
    return f"{value:.4g} against {first:.4g}{' ' if row.unit else ''}{row.unit}".replace("-", "−")


def _differs(values: Sequence[Any]) -> bool:
    return any(not _same(value, values[0]) for value in values[1:])


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    numbers = all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in (one, other))
    return math.isclose(one, other, rel_tol=SAME) if numbers else bool(one == other)
