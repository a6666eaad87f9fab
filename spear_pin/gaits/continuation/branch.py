"""A branch of periodic gaits over one number: its points, their stability, its special points, and why it ends."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import overload

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.gaits.continuation.borders import CONTINUOUS, DISCONTINUOUS, LOST, TURNED
from spear_pin.gaits.continuation.signs import CROSSING, FLIP, FOLD, KINK, SADDLE, TORUS
from spear_pin.gaits.family import Family
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.gait_table import REASONS
from spear_pin.hybrid.orders import Order, find_differing, write_order
from spear_pin.showing import Shown

FORMAT = "spear_pin branch 1"
KINDS: Mapping[str, str] = {
    FOLD: "fold",
    FLIP: "flip: the period doubles",
    TORUS: "Neimark-Sacker point",
    SADDLE: "neutral saddle: two real multipliers have the product 1",
    CROSSING: "a multiplier is 1",
    KINK: "kink: multipliers jump in the same order of events",
}
"""What special points are, in words."""
WHY: Mapping[str, str] = {
    "range": "the end of the range",
    "border": "a border",
    "lost": "no gait was found beyond",
    "closed": "the branch is closed: it is back where it began",
    "points": "as many points as asked for",
}
"""Why branches end."""


@dataclass(frozen=True)
class SpecialPoint:
    """A point where multipliers meet the unit circle, or where they jump.

    Attributes:
        kind: a key of `KINDS`.
        index: index of the point on the branch.
        parameter: value of the parameter there.
        critical: the multipliers concerned, (1,) or (2,); empty for a kink.
    """

    kind: str
    index: int
    parameter: float
    critical: NDArray[np.complex128]

    def __str__(self) -> str:
        values = ", ".join(_value(each) for each in self.critical)
        return KINDS[self.kind] + (f" ({values})" if values else "")


@dataclass(frozen=True)
class BorderPoint:
    """A point where the order of events changes, or where the cycle ends.

    Attributes:
        kind: "continuous" (the branch goes on), "turned" (the branch goes on, and the parameter turns back),
            "discontinuous" (the branch ends: no gait is near beyond it), "lost" (the branch ends for an unknown reason:
            no gait was found beyond, though the map does not jump).
        index: index of the last point before the border, seen from where the continuation began.
        beyond: index of the first point behind the border; None where the branch ends.
        parameter: value of the parameter there.
        before: (domain, event) of each event on the near side.
        after: (domain, event) of each event on the far side; of a cycle that does not close, as far as they are known.
        reason: why the cycle does not close there, a key of `gaits.gait_table.REASONS`; empty if it does.
        jump: ‖P(x) - x‖∞ just beyond the border where the branch ends; else zero.
    """

    kind: str
    index: int
    beyond: int | None
    parameter: float
    before: Order
    after: Order
    reason: str
    jump: float

    def __str__(self) -> str:
        if self.kind == LOST:
            there = "in whatever order of events" if self.before == self.after else "where "
            return f"no gait was found beyond, {there}" + _change(self.before, self.after) * (self.before != self.after)
        if self.reason:
            return f"the cycle ends: {REASONS.get(self.reason, self.reason)}"
        kind = {CONTINUOUS: "border", TURNED: "border, where it turns", DISCONTINUOUS: "border, where it ends"}
        jump = f"; beyond, the cycle does not close: its end differs from its start by {self.jump:.2g}"
        said = f"{kind[self.kind]}: {_change(self.before, self.after)}"
        return said + jump * (self.kind == DISCONTINUOUS)


@dataclass(frozen=True)
class End:
    """An end of a branch.

    Attributes:
        parameter: value of the parameter there.
        reason: a key of `WHY`.
        border: the border at this end, if there is one.
    """

    parameter: float
    reason: str
    border: BorderPoint | None = None

    def __str__(self) -> str:
        return WHY[self.reason] if self.border is None else str(self.border)


@dataclass(frozen=True, repr=False)
class Branch(Shown):
    """Gaits along a branch, in the order of the arc; at first the parameter grows from where the continuation began.

    Attributes:
        family: the systems along the branch.
        over: the parameter.
        vary: names of the numbers that are solved for.
        target: target values that the solved numbers reach, by name.
        start: index of the point where the continuation began.
        values: values of the parameter, (n,).
        q: configurations on the section, (n, nq).
        v: velocities on the section, (n, nv).
        solved: values of the numbers that are solved for, by name, (n,) each.
        multipliers: Floquet multipliers by decreasing modulus, (n, d); NaN beyond the section's dimension, which is one
            less where no toe slides as it lands.
        durations: seconds in each phase, (n,) each.
        residual: largest component of x - P(x) in the section's coordinates, (n,).
        orders: (domain, event) of each event of the cycle, (n,).
        tangents: d(q, v, solved, parameter) by the arc length, (n, nq + nv + k + 1).
        specials: special points, in the order of the arc.
        borders: borders, in the order of the arc.
        ends: the two ends of the branch, the first and the last.

    Example:
        >>> from spear_pin import continue_gait, find_gait, hopping, load
        >>> gait = find_gait(hopping(load("spear_ii", locked=["boom_x"])))
        >>> branch = continue_gait(gait, "stance_torque", (7.0, 9.0))
        >>> [round(end.parameter, 3) for end in branch.ends], len(branch.folds)
        ([7.598, 9.0], 0)
    """

    family: Family
    over: str
    vary: tuple[str, ...]
    target: Mapping[str, float]
    start: int
    values: Array
    q: Array
    v: Array
    solved: Mapping[str, Array]
    multipliers: NDArray[np.complex128]
    durations: Mapping[str, Array]
    residual: Array
    orders: tuple[Order, ...]
    tangents: Array
    specials: tuple[SpecialPoint, ...]
    borders: tuple[BorderPoint, ...]
    ends: tuple[End, End]

    def __len__(self) -> int:
        """Returns the number of points."""
        return len(self.values)

    def __repr__(self) -> str:
        first, last = (f"{end.parameter:.5g}" for end in self.ends)
        met = f"{len(self.borders)} borders, {len(self.specials)} special points"
        return f"Branch({self.over} {first} to {last}: {len(self)} points, {self.stable.sum()} stable, {met})"

    def __str__(self) -> str:
        lines = [f"{value:12.6g}  {text}" for value, text in self.rows()]
        return "\n".join([f"{self.over:>12}  what happens", *lines])

    @property
    def largest(self) -> Array:
        """Modulus of the largest multiplier, (n,)."""
        return np.asarray(np.abs(self.multipliers[:, 0]))

    @property
    def stable(self) -> NDArray[np.bool_]:
        """Whether every multiplier lies inside the unit circle, (n,)."""
        return np.asarray(self.largest < 1.0)

    @property
    def period(self) -> Array:
        """Duration of one cycle in s, (n,)."""
        return np.asarray(sum(self.durations.values()))

    @property
    def folds(self) -> tuple[SpecialPoint, ...]:
        """Special points where the parameter turns."""
        return self._of(FOLD)

    @property
    def flips(self) -> tuple[SpecialPoint, ...]:
        """Special points where a multiplier is -1."""
        return self._of(FLIP)

    @property
    def neimark_sacker(self) -> tuple[SpecialPoint, ...]:
        """Special points where a complex pair of multipliers is on the unit circle."""
        return self._of(TORUS)

    @property
    def why(self) -> tuple[str, str]:
        """Why the branch ends, in words, for each end."""
        return str(self.ends[0]), str(self.ends[1])

    def _of(self, kind: str) -> tuple[SpecialPoint, ...]:
        return tuple(special for special in self.specials if special.kind == kind)

    def rows(self) -> list[tuple[float, str]]:
        """Lists what happens along the arc: the parameter's value and a sentence for each event, with the ends."""
        first, last = ((end.parameter, f"end: {end}") for end in self.ends)
        return [first, *((each.parameter, str(each)) for each in self.events), last]

    @property
    def gaits(self) -> Sequence[Gait]:
        """Gaits at all points; each gait is made when it is first read."""
        return _Gaits(self)

    @property
    def events(self) -> tuple[SpecialPoint | BorderPoint, ...]:
        """Special points, and borders that are not ends, in the order of the arc."""
        inner = [border for border in self.borders if border.beyond is not None]
        return tuple(sorted([*self.specials, *inner], key=lambda each: each.index))

    def _gait(self, index: int) -> Gait:
        solved = {name: float(values[index]) for name, values in self.solved.items()}
        numbers = {**solved, self.over: float(self.values[index])}
        return Gait(
            system=self.family.member([numbers[name] for name in self.family.names]),
            state=(self.q[index].copy(), self.v[index].copy()),
            parameters=solved,
            residual=float(self.residual[index]),
            multipliers=self.multipliers[index][np.isfinite(self.multipliers[index])],
            durations={phase: float(seconds[index]) for phase, seconds in self.durations.items()},
        )

    def to_json(self) -> str:
        """Returns the whole branch as a JSON object: points by column, special points, borders and ends."""
        orders = list(dict.fromkeys(self.orders))
        data = {
            "format": FORMAT,
            "kind": self.family.system.kind,
            "robot": self.family.system.robot.source,
            "over": self.over,
            "vary": list(self.vary),
            "target": dict(self.target),
            "start": self.start,
            "values": self.values.tolist(),
            "q": self.q.tolist(),
            "v": self.v.tolist(),
            "solved": {name: values.tolist() for name, values in self.solved.items()},
            "multipliers": [[[value.real, value.imag] for value in row[np.isfinite(row)]] for row in self.multipliers],
            "durations": {phase: seconds.tolist() for phase, seconds in self.durations.items()},
            "residual": self.residual.tolist(),
            "orders": [[list(pair) for pair in order] for order in orders],
            "order": [orders.index(order) for order in self.orders],
            "tangents": self.tangents.tolist(),
            "specials": [
                {**vars(each), "critical": [[value.real, value.imag] for value in each.critical.tolist()]}
                for each in self.specials
            ],
            "borders": [vars(each) | {"text": str(each)} for each in self.borders],
            "ends": [{"parameter": end.parameter, "reason": end.reason, "text": str(end)} for end in self.ends],
        }
        return json.dumps(data, allow_nan=False)


@dataclass(frozen=True)
class _Gaits(Sequence[Gait]):
    """Gaits of a branch, as a sequence."""

    branch: Branch

    def __len__(self) -> int:
        return len(self.branch)

    @overload
    def __getitem__(self, index: int) -> Gait: ...
    @overload
    def __getitem__(self, index: slice) -> list[Gait]: ...
    def __getitem__(self, index: int | slice) -> Gait | list[Gait]:
        places = range(len(self))[index]
        return [self.branch._gait(i) for i in places] if isinstance(places, range) else self.branch._gait(places)


def _change(before: Order, after: Order) -> str:
    """Tells in words how two orders of events differ."""
    near, far = find_differing(before, after)
    if before == after:
        return "a toe begins or ceases to slide as it lands"
    if not near:
        return f"[{write_order(far)}] comes in"
    return f"[{write_order(near)}] becomes [{write_order(far)}]" if far else f"[{write_order(near)}] no longer happens"


def _value(number: complex) -> str:
    if abs(number.imag) < 1e-9:
        return f"{number.real:.5g}"
    return f"{number.real:.5g} {'+' if number.imag > 0 else '-'} {abs(number.imag):.5g}i"
