"""Cables between points of bodies, straight or over a pulley, as paths of springs."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Self

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.path import Path, Point, Posture, Slope, replace_unchecked, weigh
from spear_pin.model.scalars import dot, plus
from spear_pin.model.vectors import Vector, subtract

AXES = "x", "y", "z"
ALIKE = 1e-9  # m: by how much a distance that stays the same may change
CHORDS = 6  # of the part of a cable that is on a pulley, where it is drawn


@typed
@dataclass(frozen=True)
class Anchor:
    """A point of a body at which a spring's cable ends.

    Attributes:
        body: the body, or another frame of the robot; "universe" for the world.
        at: the point in the frame's axes: x, y and z, in m.
        side: -1 if x is counted the other way, else 1.
    """

    body: str
    at: Any
    side: float = 1.0

    def __post_init__(self) -> None:
        """Checks the point."""
        try:
            point = tuple(float(each) for each in self.at)
        except (TypeError, ValueError):
            point = ()
        if len(point) != 3 or not all(map(math.isfinite, point)):
            raise BadValue("Anchor.at", self.at, "three numbers, x, y and z, in m")
        object.__setattr__(self, "at", point)

    def seen(self, posture: Posture) -> Point:
        """Returns the point in the world."""
        x, y, z = self.at
        return posture.point(self.body, (weigh(self.side, x), y, z))


class Cabled(Path):
    """A path between points of bodies, which has a place in the world."""

    POINTS: ClassVar[tuple[str, ...]] = "start", "end"

    def __post_init__(self) -> None:
        """Makes anchors of pairs of a body's name and a point."""
        for name in self.POINTS:
            given = getattr(self, name)
            if isinstance(given, tuple) and len(given) == 2:
                object.__setattr__(self, name, Anchor(*given))
            elif not isinstance(given, Anchor):
                expected = "an Anchor, or the name of a body and a point (x, y, z), in m"
                raise BadValue(f"{type(self).__name__}.{name}", given, expected)

    def anchors(self) -> Mapping[str, Anchor]:
        """Returns the anchors by the names of their fields."""
        return {name: each for name, each in vars(self).items() if isinstance(each, Anchor)}

    def indices(self, posture: Posture) -> list[int]:
        """Returns those that move its points with respect to each other."""
        moving = [{*each.seen(posture).columns} for each in self.anchors().values()]
        return sorted(set[int]().union(*moving) - set[int].intersection(*moving))

    @property
    def numbers(self) -> Mapping[str, Any]:
        """The coordinates of the anchors, such as `start_x`."""
        return {
            f"{name}_{axis}": value
            for name, anchor in self.anchors().items()
            for axis, value in zip(AXES, anchor.at, strict=True)
        }

    @property
    def units(self) -> Mapping[str, str]:
        """All of them in m."""
        return dict.fromkeys(self.numbers, "m")

    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the path between other points."""
        moved = {
            name: replace_unchecked(anchor, at=tuple(numbers.get(f"{name}_{axis}", own) for axis, own in _axes(anchor)))
            for name, anchor in self.anchors().items()
        }
        return replace_unchecked(self, **moved)

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path between points of other bodies."""
        return replace_unchecked(
            self,
            **{
                name: replace(each, body=names.get(each.body, each.body), side=side * each.side)
                for name, each in self.anchors().items()
            },
        )

    def course(self, posture: Posture) -> list[Vector]:
        """Returns the points through which the cable runs in the world, in m."""
        return [each.seen(posture).position for each in self.anchors().values()]

    @property
    def turns(self) -> bool:
        """Tells that the length is none of an angle."""
        return False

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames that carry its points."""
        return tuple(each.body for each in self.anchors().values())


@typed
@dataclass(frozen=True)
class Between(Cabled):
    """The distance of two points of bodies.

    Attributes:
        start: one point, an `Anchor`, or the name of a body and the point in its axes.
        end: the other.

    Example:
        >>> from spear_pin import Between
        >>> Between(("thigh", (0.03, 0.0, -0.1)), ("shank", (0.012, 0.0, 0.054))).numbers["start_x"]
        0.03
    """

    start: Any
    end: Any

    def length(self, posture: Posture) -> Any:
        """Returns ℓ = √(d·d)."""
        d = subtract(self.end.seen(posture).position, self.start.seen(posture).position)
        return posture.ops.sqrt(dot(d, d))

    def slope(self, posture: Posture) -> Slope:
        """Returns dᵀ(J_end - J_start)/ℓ; what carries both points moves neither with respect to the other."""
        start, end = self.start.seen(posture), self.end.seen(posture)
        d = subtract(end.position, start.position)
        length = posture.ops.sqrt(dot(d, d))
        only = {i: column for i, column in end.columns.items() if i not in start.columns}
        also = {i: column for i, column in start.columns.items() if i not in end.columns}
        there = {i: dot(d, column) / length for i, column in only.items()}
        return Slope(there | {i: -dot(d, column) / length for i, column in also.items()})


@typed
@dataclass(frozen=True)
class Over(Cabled):
    """A cable in the x-z plane from a point over a pulley to another point, free of the pulley where that is shorter.

    With a and b the distances of the points from the pulley's centre, which may not change, and φ the angle between
    them on the side away from the cable, the cable touches the pulley where φ exceeds acos(r/a) + acos(r/b) by w > 0.
    Its length is √(a² + b² - 2 a b cos(φ - w)) + r w, with w = 0 where it is free.

    Attributes:
        start: one point, an `Anchor`, or the name of a body and the point in its axes.
        centre: the pulley's centre.
        end: the other point.
        radius: r, in m.
        side: +1 if φ is counted from the start to the end as x turns towards z, -1 if the other way.

    Example:
        >>> from spear_pin import Over
        >>> knee = ("thigh", (0.0, 0.0, -0.318))
        >>> Over(("thigh", (0.03, 0.0, -0.1)), knee, ("shank", (0.03, 0.0, -0.1)), 0.02).numbers["radius"]  # m
        0.02
    """

    POINTS = "start", "centre", "end"

    start: Any
    centre: Any
    end: Any
    radius: float
    side: float = 1.0

    def __post_init__(self) -> None:
        """Checks the points and the pulley."""
        super().__post_init__()
        require("Over.radius", self.radius, lambda r: r > 0, "a number > 0, in m")
        require("Over.side", self.side, lambda side: abs(side) == 1, "1 or -1")

    def length(self, posture: Posture) -> Any:
        """Returns the cable's length."""
        a, b, bend, wrapped = self._seen(posture)
        return self._straight(a, b, bend, posture.ops) + self.radius * wrapped

    def slope(self, posture: Posture) -> Slope:
        """Returns ∂s/∂φ ∂φ/∂q, where ∂s/∂φ = a b sin(φ - w)/√(a² + b² - 2 a b cos(φ - w)), r where it is wrapped."""
        a, b, bend, _ = self._seen(posture)
        lever = a * b * posture.ops.sin(bend) / self._straight(a, b, bend, posture.ops)
        (start, from_start), (end, from_end) = self._arms(posture)
        found = Slope()
        for columns, (x, z), square, sign in ((from_start, start, a * a, -1.0), (from_end, end, b * b, 1.0)):
            for i in self.indices(posture):
                along, up = columns.get(i, (0.0, 0.0))
                found[i] = plus(found.get(i, 0.0), sign * self.side * lever * (x * up - z * along) / square)
        return found

    @property
    def numbers(self) -> Mapping[str, Any]:
        """The coordinates of the points, and the radius."""
        return {**super().numbers, "radius": self.radius}

    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the path over another pulley."""
        return replace_unchecked(super().with_numbers(numbers), radius=numbers.get("radius", self.radius))

    def check(self, postures: Sequence[Posture]) -> None:
        """Checks that the ends keep their distances from the centre, and are outside the pulley."""
        for name, arm in (("start", 0), ("end", 1)):
            points = [self._arms(posture)[arm][0] for posture in postures]
            lengths = [math.hypot(x, z) for x, z in points]
            if min(lengths) <= self.radius:
                raise BadValue(
                    f"Over.{name}", getattr(self, name), f"a point farther than the radius {self.radius:g} m"
                )
            if max(lengths) - min(lengths) > ALIKE:
                expected = "a point that keeps its distance from the pulley's centre as joints move"
                raise BadValue(f"Over.{name}", getattr(self, name), expected)

    def course(self, posture: Posture) -> list[Vector]:
        """Returns the points through which the cable runs in the world, in m: its ends, and between them on the pulley.

        Where it is free of the pulley, the points between are on the straight line.
        """
        start, centre, end = (each.seen(posture).position for each in self.anchors().values())
        shares = [i / CHORDS for i in range(CHORDS + 1)]
        ((x, z), _), _ = self._arms(posture)
        a, _, _, wrapped = self._seen(posture)
        if not wrapped:
            between = [tuple(p + share * (q - p) for p, q in zip(start, end, strict=True)) for share in shares]
        else:
            begins = math.atan2(z, x) + self.side * math.acos(self.radius / a)
            turned = [begins + self.side * share * wrapped for share in shares]
            x, y, z = centre
            between = [(x + self.radius * math.cos(at), y, z + self.radius * math.sin(at)) for at in turned]
        return [start, *between, end]

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path over a pulley of another body."""
        return replace_unchecked(super().on(names, side), side=side * self.side)

    def _arms(self, posture: Posture) -> list[tuple[tuple[Any, Any], dict[int, tuple[Any, Any]]]]:
        """Returns both points as seen from the centre, in the plane, with their columns."""
        centre, found = self.centre.seen(posture), []
        for point in (self.start.seen(posture), self.end.seen(posture)):
            x, _, z = subtract(point.position, centre.position)
            columns = {}
            for i in {**point.columns, **centre.columns}:
                own, other = point.columns.get(i, (0.0, 0.0, 0.0)), centre.columns.get(i, (0.0, 0.0, 0.0))
                along, _, up = subtract(own, other)
                columns[i] = along, up
            found.append(((x, z), columns))
        return found

    def _seen(self, posture: Posture) -> tuple[Any, Any, Any, Any]:
        """Returns both distances, φ - w, and w."""
        ops = posture.ops
        (start, _), (end, _) = self._arms(posture)
        a, b = ops.sqrt(dot(start, start)), ops.sqrt(dot(end, end))
        across, along = start[0] * end[1] - start[1] * end[0], dot(start, end)
        bend = math.pi + ops.atan2(-self.side * across, -along)
        touches = sum(ops.atan2(ops.sqrt(arm * arm - self.radius * self.radius), self.radius) for arm in (a, b))
        wrapped = ops.maximum(bend - touches, 0.0)
        return a, b, bend - wrapped, wrapped

    @staticmethod
    def _straight(a: Any, b: Any, bend: Any, ops: Any) -> Any:
        return ops.sqrt(a * a + b * b - 2.0 * a * b * ops.cos(bend))


def _axes(anchor: Anchor) -> Iterator[tuple[str, Any]]:
    return zip(AXES, anchor.at, strict=True)
