"""Paths along which springs act: the length of each at a posture, and how it changes with the coordinates.

`model.cable` has the paths between points of bodies, and `model.linkage` that of a slider.

A force F along a path acts on each coordinate with the slope as its lever: Q = F ∂s/∂q. So no lever is given twice.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple, Protocol, Self, TypeVar

from spear_pin.errors import BadValue, require
from spear_pin.kinds import typed
from spear_pin.model.scalars import plus, times
from spear_pin.model.vectors import Vector

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
            return value * v[i]
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

    @property
    def members(self) -> tuple[Path, ...]:
        """The paths of which it is the sum: itself alone, if it is none."""
        return (self,)


@typed
@dataclass(frozen=True)
class Joints(Path):
    """A weighted sum of joint angles: one joint, or a cable over a pulley of each joint.

    Attributes:
        weights: weight of each joint by its name: the radius of its pulley, in m; 1 where the length is an angle.
        side: -1 if angles are counted the other way, else 1.

    Example:
        >>> from spear_pin import Joints
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
        first, *others = [weigh(weight, posture.angle(joint)) for joint, weight in self.weights]
        return weigh(self.side, sum(others, first))

    def slope(self, posture: Posture) -> Slope:
        """Returns the weights, times the side."""
        return Slope({posture.index(joint): weigh(self.side, weight) for joint, weight in self.weights})

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
        return replace_unchecked(self, weights=tuple((joint, numbers.get(joint, own)) for joint, own in self.weights))

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the path on other joints."""
        weights = tuple((names.get(joint, joint), weight) for joint, weight in self.weights)
        return replace_unchecked(self, weights=weights, side=side * self.side)

    @property
    def turns(self) -> bool:
        """Tells whether all weights are ±1."""
        return all(abs(weight) == 1.0 for _, weight in self.weights)


@typed
@dataclass(frozen=True)
class Sum(Path):
    """A weighted sum of paths, such as a cable that runs along several of them.

    Attributes:
        parts: weight and path of each part.

    Example:
        >>> from spear_pin import Joints, Sum
        >>> Sum([(2.0, Joints({"knee": 0.03})), (-1.0, Joints({"hip": 0.01}))]).parts[0][0]
        2.0
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
        first, *others = [weigh(weight, path.length(posture)) for weight, path in self.parts]
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
        return replace_unchecked(self, parts=tuple(parts))

    def on(self, names: Mapping[str, str], side: float = 1.0) -> Self:
        """Returns the sum of the paths on other joints and frames."""
        return replace_unchecked(self, parts=tuple((weight, path.on(names, side)) for weight, path in self.parts))

    @property
    def members(self) -> tuple[Path, ...]:
        """The paths of its parts, and of theirs."""
        return tuple(each for _, path in self.parts for each in path.members)

    @property
    def turns(self) -> bool:
        """Tells whether all parts are angles, with weights ±1."""
        return all(path.turns and abs(weight) == 1.0 for weight, path in self.parts)

    @property
    def frames(self) -> tuple[str, ...]:
        """Names of the frames that carry points of its parts."""
        return tuple(frame for _, path in self.parts for frame in path.frames)


def weigh(weight: Any, value: Any) -> Any:
    """Returns the product, or the value itself if the weight is the number 1."""
    return value if isinstance(weight, float) and weight == 1.0 else weight * value


def replace_unchecked(instance: D, **values: Any) -> D:
    """Returns a dataclass with other values, which need not be numbers."""
    other = object.__new__(type(instance))
    for name, value in (vars(instance) | values).items():
        object.__setattr__(other, name, value)
    return other
