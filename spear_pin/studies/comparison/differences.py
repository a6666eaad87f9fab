"""Measures of several sides in one table, parameters that differ, and the largest differences in sentences."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from spear_pin.errors import listed
from spear_pin.studies.comparison.measures import BODY, GAIT, GROUPS, of_side
from spear_pin.studies.comparison.sides import Side, parameters

SAME = 1e-9  # of a value: less is rounding
TOLD = 1.0  # %: smaller differences make no sentence
MOST_TOLD = 4  # measures that a sentence names
KEY = (  # what measures begin with that sentences name
    "mean speed", "period", "flight time", "greatest height", "peak normal force", "peak torque", "peak spring torque",
    "motors' work, |power|", "cost of transport", "mass",
)  # fmt: skip
ERRORS = ("residual", "unaccounted")  # of which a share says nothing
NOTHING = 1e-6  # of the first value, in its unit: a share of less says nothing


@dataclass(frozen=True)
class Measure:
    """A measure of all sides.

    Attributes:
        group: what it is of.
        name: what it is.
        unit: of its values.
        values: one for each side; None where it has no such.
    """

    group: str
    name: str
    unit: str
    values: tuple[float | None, ...]

    @property
    def changes(self) -> tuple[float | None, ...]:
        """What each value is more than the first, in the unit."""
        first = self.values[0]
        return tuple(None if first is None or value is None else self._less(value, first) for value in self.values)

    @property
    def shares(self) -> tuple[float | None, ...]:
        """The same in % of the first; None where that is next to zero, or where it says nothing."""
        first = self.values[0]
        if first is None or abs(first) < NOTHING or self.name.startswith(ERRORS):
            return (None,) * len(self.values)
        return tuple(None if change is None else 100.0 * change / abs(first) for change in self.changes)

    @staticmethod
    def _less(value: float, first: float) -> float:
        return 0.0 if math.isclose(value, first, rel_tol=SAME) else value - first


@dataclass(frozen=True)
class Difference:
    """A parameter that is not the same of all sides; values that a side does not have are None."""

    name: str
    values: tuple[Any, ...]


def measures(sides: Sequence[Side]) -> tuple[Measure, ...]:
    """Every measure that some side has; of robots only where they differ, or where there are but robots."""
    found = [of_side(side) for side in sides]
    rows = []
    for group in GROUPS:
        keys = dict.fromkeys(key for each in found for key in each.get(group, {}))
        for name, unit in keys:
            rows.append(Measure(group, name, unit, tuple(each.get(group, {}).get((name, unit)) for each in found)))
    robots = all(side.kind == "robot" for side in sides)
    return tuple(row for row in rows if row.group != BODY or robots or _differs(row.values))


def differences(sides: Sequence[Side]) -> tuple[Difference, ...]:
    """Parameters of robot, law, spring and ground that differ between sides that say them."""
    found = [parameters(side) for side in sides]
    names = dict.fromkeys(name for each in found for name in each)
    # a motion does not say its law; what a robot does not say is as usual
    known = {name: [each.get(name) for each in found if name in each or name.startswith("robot")] for name in names}
    return tuple(Difference(name, tuple(each.get(name) for each in found)) for name in names if _differs(known[name]))


def said(sides: Sequence[Side], rows: Sequence[Measure]) -> tuple[str, ...]:
    """What there is to say, a sentence each: who is stable, and by how much the main measures differ."""
    sentences = []
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
            names = listed([row.name for row in both])
            sentences.append(f"{side.label} differs from {sides[0].label} by less than {TOLD:g} % in {names}.")
        if not changed:
            continue
        changed.sort(key=lambda pair: -abs(pair[1]))
        parts = [f"{row.name} {_percent(share)} ({_pair(row, i)})" for row, share in changed[:MOST_TOLD]]
        sentences.append(f"{side.label} against {sides[0].label}: {', '.join(parts)}.")
    kinds = {side.gait.system.kind for side in gaits if side.gait is not None}
    robots = list(dict.fromkeys(side.robot.name for side in sides))
    if len(kinds) > 1:
        sentences.append(f"The gaits are of different automata: {listed(sorted(kinds))}.")
    if len(robots) > 1:
        sentences.append(f"The robots are different: {listed(robots)}.")
    return tuple(sentences)


def _percent(share: float) -> str:
    return f"{share:+.3g} %".replace("-", "−")


def _pair(row: Measure, i: int) -> str:
    first, value = row.values[0], row.values[i]
    return f"{value:.4g} against {first:.4g}{' ' if row.unit else ''}{row.unit}".replace("-", "−")


def _differs(values: Sequence[Any]) -> bool:
    return any(not _same(value, values[0]) for value in values[1:])


def _same(one: Any, other: Any) -> bool:
    if isinstance(one, tuple) and isinstance(other, tuple):
        return len(one) == len(other) and all(map(_same, one, other))
    numbers = all(isinstance(each, (int, float)) and not isinstance(each, bool) for each in (one, other))
    return math.isclose(one, other, rel_tol=SAME) if numbers else bool(one == other)
