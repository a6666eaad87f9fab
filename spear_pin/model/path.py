"""Paths along which springs act: the length of each at a posture, and how it changes with the coordinates.

A force F along a path acts on each coordinate with the slope as its lever: Q = F ∂s/∂q. So no lever is given twice.
"""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol, Self, TypeVar

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.linkage import slider
from spear_pin.model.scalars import dot, plus, times
from spear_pin.model.vectors import Vector, subtract

AXES = "x", "y", "z"
ALIKE = 1e-9  # m: by how much a distance that stays the same may change
D = TypeVar("D")


class Point(NamedTuple):
    """A point of a body in the world.

    Attributes:
        position: x, y and z, in m.
        columns: by the index of each coordinate that moves it, the point's velocity for each unit of its rate.
    """

    position: Vector
    columns: Mapping[int, Vector]


class Posture(Protocol):
    """The configuration of a robot, of scalars of any kind."""

    @property
    def ops(self) -> Any:
        """Elementary functions of the scalars."""

    def index(self, joint: str) -> int:
        """Returns the index of a coordinate."""

    def angle(self, joint: str) -> Any:
        """Returns the value of a coordinate, in rad or m."""

    def point(self, frame: str, at: Sequence[Any]) -> Point:
        """Returns a point that a frame carries, given in the frame's axes, in m."""


class Slope(dict[int, Any]):
    """How a length changes with the coordinates, by their indices."""

    def rate(self, v: Sequence[Any]) -> Any:
        """Returns the rate of the length."""
        if len(self) == 1:
            ((i, value),) = self.items()
            return times(value, v[i])
        first, *others = [times(value, v[i]) for i, value in self.items()]
        return sum(others, first)


class Path(ABC):
    """A path along which a spring acts; in rad where it is an angle, else in m."""

    @abstractmethod
    def length(self, posture: Posture) -> Any:
        """Returns the length s."""

    @abstractmethod
    def slope(self, posture: Posture) -> Slope:
        """Returns ∂s/∂q."""

    @abstractmethod
    def indices(self, posture: Posture) -> list[int]:
        """Returns the indices of the coordinates on which the length depends, in their order."""

    def check(self, postures: Sequence[Posture]) -> None:
        """Checks what only a robot shows, at some of its postures.

        Raises:
            UnknownName: there is no joint, or no frame, of a name.
            BadValue: the path does not fit the robot.
        """
        for posture in postures:
            self.indices(posture)

    @property
    @abstractmethod
    def numbers(self) -> Mapping[str, Any]:
        """Its numbers by name."""

    @abstractmethod
    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the path with other numbers, which may be symbols; those not named stay."""

    def moved(self, numbers: Mapping[str, float]) -> Self:
        """Returns the path with other numbers, and checks them.

        Raises:
            BadValue: a number is not valid.
        """
        for name, value in numbers.items():
            require(name, value, lambda number: abs(number) >= 0, "a finite number")
        other: Any = self.with_numbers(numbers)
        checked: Self = replace(other)
        return checked

    @property
    @abstractmethod
    def units(self) -> Mapping[str, str]:
        """The units of its numbers by name."""

    @abstractmethod
    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the same path on other joints and frames, by their names here; those not named stay.

        Args:
            names: the other names.
            side: -1 on a leg that bends to the other side: its angles are counted the other way, and x is mirrored.
        """

    @property
    @abstractmethod
    def turns(self) -> bool:
        """Tells whether the length is an angle."""

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames that carry its points."""
        return ()


@typed
@dataclass(frozen=True)
class Joints(Path):
    """A weighted sum of joint angles: one joint, or a cable over a pulley of each joint.

    Attributes:
        weights: weight of each joint by its name: the radius of its pulley, in m; 1 where the length is an angle.
        side: -1 if angles are counted the other way, else 1.

    Example:
        >>> from spear_pin.model.path import Joints
        >>> Joints({"knee": 0.03, "hip": -0.006}).numbers["hip"]  # m
        -0.006
    """

    weights: Any
    side: float = 1.0

    def __post_init__(self) -> None:
        """Checks the weights."""
        pairs = self.weights.items() if isinstance(self.weights, Mapping) else self.weights
        object.__setattr__(self, "weights", tuple((str(joint), weight) for joint, weight in pairs))
        names = [joint for joint, _ in self.weights]
        if not names or len({*names}) < len(names):
            raise BadValue("Joints.weights", self.weights, "a weight for each of one or more joints, each joint once")
        for joint, weight in self.weights:
            require(f"Joints.weights[{joint!r}]", weight, lambda number: abs(number) > 0, "a number other than zero")

    def length(self, posture: Posture) -> Any:
        """Returns Σ c q, times the side."""
        first, *others = [_weighted(weight, posture.angle(joint)) for joint, weight in self.weights]
        return _weighted(self.side, sum(others, first))

    def slope(self, posture: Posture) -> Slope:
        """Returns the weights, times the side."""
        return Slope({posture.index(joint): _weighted(self.side, weight) for joint, weight in self.weights})

    def indices(self, posture: Posture) -> list[int]:
        """Returns those of its joints."""
        return sorted(posture.index(joint) for joint, _ in self.weights)

    @property
    def numbers(self) -> Mapping[str, Any]:
        """The weights."""
        return dict(self.weights)

    @property
    def units(self) -> Mapping[str, str]:
        """1 where the length is an angle, else m."""
        return dict.fromkeys(self.numbers, "1" if self.turns else "m")

    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the path with other weights."""
        return _unchecked(self, weights=tuple((joint, numbers.get(joint, own)) for joint, own in self.weights))

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path on other joints."""
        weights = tuple((names.get(joint, joint), weight) for joint, weight in self.weights)
        return _unchecked(self, weights=weights, side=side * self.side)

    @property
    def turns(self) -> bool:
        """Tells whether all weights are ±1."""
        return all(abs(weight) == 1.0 for _, weight in self.weights)


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
        return posture.point(self.body, (_weighted(self.side, x), y, z))


class _Anchored(Path):
    """A path between points of bodies."""

    def _anchors(self) -> Mapping[str, Anchor]:
        """Returns the anchors by the names of their fields."""
        return {name: each for name, each in vars(self).items() if isinstance(each, Anchor)}

    def indices(self, posture: Posture) -> list[int]:
        """Returns those that move its points with respect to each other."""
        moving = [{*each.seen(posture).columns} for each in self._anchors().values()]
        return sorted(set[int]().union(*moving) - set[int].intersection(*moving))

    @property
    def numbers(self) -> Mapping[str, Any]:
        """The coordinates of the anchors, such as `start_x`."""
        return {
            f"{name}_{axis}": value
            for name, anchor in self._anchors().items()
            for axis, value in zip(AXES, anchor.at, strict=True)
        }

    @property
    def units(self) -> Mapping[str, str]:
        """All of them in m."""
        return dict.fromkeys(self.numbers, "m")

    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the path between other points."""
        moved = {
            name: _unchecked(anchor, at=tuple(numbers.get(f"{name}_{axis}", own) for axis, own in _axes(anchor)))
            for name, anchor in self._anchors().items()
        }
        return _unchecked(self, **moved)

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path between points of other bodies."""
        return _unchecked(
            self,
            **{
                name: replace(each, body=names.get(each.body, each.body), side=side * each.side)
                for name, each in self._anchors().items()
            },
        )

    @property
    def turns(self) -> bool:
        """Tells that the length is none of an angle."""
        return False

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames that carry its points."""
        return tuple(each.body for each in self._anchors().values())


@typed
@dataclass(frozen=True)
class Between(_Anchored):
    """The distance of two points of bodies.

    Attributes:
        start: one point.
        end: the other.

    Example:
        >>> from spear_pin.model.path import Anchor, Between
        >>> Between(Anchor("thigh", (0.03, 0.0, -0.1)), Anchor("shank", (0.012, 0.0, 0.054))).numbers["start_x"]
        0.03
    """

    start: Anchor
    end: Anchor

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
class Over(_Anchored):
    """A cable in the x-z plane from a point over a pulley to another point, free of the pulley where that is shorter.

    With a and b the distances of the points from the pulley's centre, which may not change, and φ the angle between
    them on the side away from the cable, the cable touches the pulley where φ exceeds acos(r/a) + acos(r/b) by w > 0.
    Its length is √(a² + b² - 2 a b cos(φ - w)) + r w, with w = 0 where it is free.

    Attributes:
        start: one point.
        centre: the pulley's centre.
        end: the other point.
        radius: r, in m.
        side: +1 if φ is counted from the start to the end as x turns towards z, -1 if the other way.
    """

    start: Anchor
    centre: Anchor
    end: Anchor
    radius: float
    side: float = 1.0

    def __post_init__(self) -> None:
        """Checks the pulley."""
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
        return _unchecked(super().with_numbers(numbers), radius=numbers.get("radius", self.radius))

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

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path over a pulley of another body."""
        return _unchecked(super().on(names, side), side=side * self.side)

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


@typed
@dataclass(frozen=True)
class Linked(Path):
    """How far a slider has moved that a rod joins to a crank on a joint, see `SliderLinkage`.

    Attributes:
        joint: the joint.
        crank: c, distance from the joint to the pin, in m.
        rod: r, distance from the pin to the slider, in m.
        offset: e, distance of the slider's rail from the joint, in m.
        zero: angle of the joint at which φ is zero, in rad.
        side: +1 if φ grows with the joint's angle, else -1.
        turned: -1 if the joint's angle is counted the other way, else 1.
    """

    joint: str
    crank: float
    rod: float
    offset: float = 0.0
    zero: float = 0.0
    side: float = 1.0
    turned: float = 1.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name in ("crank", "rod"):
            require(f"Linked.{name}", getattr(self, name), lambda length: length > 0, "a number > 0, in m")
        reach = self.rod - self.crank
        require("Linked.offset", self.offset, lambda e: abs(e) < reach, "a number within ±(rod - crank), in m")
        require("Linked.zero", self.zero, lambda angle: abs(angle) >= 0, "a finite number, in rad")
        require("Linked.side", self.side, lambda side: abs(side) == 1, "1 or -1")

    def length(self, posture: Posture) -> Any:
        """Returns the slider's place s(φ)."""
        return self._slider(posture)[0]

    def slope(self, posture: Posture) -> Slope:
        """Returns ds/dφ, with the sign of the side."""
        return Slope({posture.index(self.joint): self.turned * self.side * self._slider(posture)[1]})

    def indices(self, posture: Posture) -> list[int]:
        """Returns that of its joint."""
        return [posture.index(self.joint)]

    @property
    def numbers(self) -> Mapping[str, Any]:
        """Crank, rod, offset and the zero."""
        return {name: getattr(self, name) for name in ("crank", "rod", "offset", "zero")}

    @property
    def units(self) -> Mapping[str, str]:
        """All lengths in m, the zero in rad."""
        return {**dict.fromkeys(self.numbers, "m"), "zero": "rad"}

    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the path of another linkage."""
        return _unchecked(self, **numbers)

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path of the same linkage on another joint."""
        return _unchecked(self, joint=names.get(self.joint, self.joint), turned=side * self.turned)

    @property
    def turns(self) -> bool:
        """Tells that the length is none of an angle."""
        return False

    def _slider(self, posture: Posture) -> tuple[Any, Any]:
        phi = self.side * (self.turned * posture.angle(self.joint) - self.zero)
        return slider(self.crank, self.rod, self.offset, phi, posture.ops)


@typed
@dataclass(frozen=True)
class Sum(Path):
    """A weighted sum of paths, such as a cable that runs along several of them.

    Attributes:
        parts: weight and path of each part.
    """

    parts: Any

    def __post_init__(self) -> None:
        """Checks the parts."""
        object.__setattr__(self, "parts", tuple((weight, path) for weight, path in self.parts))
        if not self.parts or not all(isinstance(path, Path) for _, path in self.parts):
            raise BadValue("Sum.parts", self.parts, "pairs of a weight and a path")
        for weight, _ in self.parts:
            require("Sum.weight", weight, lambda number: abs(number) > 0, "a number other than zero")

    def check(self, postures: Sequence[Posture]) -> None:
        """Checks the parts."""
        for _, path in self.parts:
            path.check(postures)

    def length(self, posture: Posture) -> Any:
        """Returns Σ w s."""
        first, *others = [_weighted(weight, path.length(posture)) for weight, path in self.parts]
        return sum(others, first)

    def slope(self, posture: Posture) -> Slope:
        """Returns Σ w ∂s/∂q."""
        found = Slope()
        for weight, path in self.parts:
            for i, value in path.slope(posture).items():
                found[i] = plus(found.get(i, 0.0), weight * value)
        return found

    def indices(self, posture: Posture) -> list[int]:
        """Returns those of its parts."""
        return sorted({i for _, path in self.parts for i in path.indices(posture)})

    @property
    def numbers(self) -> Mapping[str, Any]:
        """The weights, and the parts' numbers, each with the number of its part."""
        found: dict[str, Any] = {}
        for k, (weight, path) in enumerate(self.parts, 1):
            found |= {f"weight_{k}": weight, **{f"{name}_{k}": value for name, value in path.numbers.items()}}
        return found

    @property
    def units(self) -> Mapping[str, str]:
        """1 for the weights, and the units of the parts' numbers."""
        found: dict[str, str] = {}
        for k, (_, path) in enumerate(self.parts, 1):
            found |= {f"weight_{k}": "1", **{f"{name}_{k}": unit for name, unit in path.units.items()}}
        return found

    def with_numbers(self, numbers: Mapping[str, Any]) -> Self:
        """Returns the sum of other paths."""
        parts = []
        for k, (weight, path) in enumerate(self.parts, 1):
            own = {name: numbers[f"{name}_{k}"] for name in path.numbers if f"{name}_{k}" in numbers}
            parts.append((numbers.get(f"weight_{k}", weight), path.with_numbers(own)))
        return _unchecked(self, parts=tuple(parts))

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the sum of the paths on other joints and frames."""
        return _unchecked(self, parts=tuple((weight, path.on(names, side)) for weight, path in self.parts))

    @property
    def turns(self) -> bool:
        """Tells whether all parts are angles, with weights ±1."""
        return all(path.turns and abs(weight) == 1.0 for weight, path in self.parts)

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames that carry points of its parts."""
        return tuple(frame for _, path in self.parts for frame in path.frames)


def _weighted(weight: Any, value: Any) -> Any:
    return value if isinstance(weight, float) and weight == 1.0 else weight * value


def _axes(anchor: Anchor) -> Iterator[tuple[str, Any]]:
    return zip(AXES, anchor.at, strict=True)


def _unchecked(instance: D, **values: Any) -> D:
    """Returns a dataclass with other values, which need not be numbers."""
    other = object.__new__(type(instance))
    for name, value in (vars(instance) | values).items():
        object.__setattr__(other, name, value)
    return other
