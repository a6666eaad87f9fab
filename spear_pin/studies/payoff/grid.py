"""Grid of a payoff study: kinds of knee, stiffnesses, speeds, and which points are neighbours."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from spear_pin.errors import BadValue

NONE, FIXED, SWITCHED = KINDS = ("none", "fixed", "switched")
WORDS = {NONE: "no spring", FIXED: "a fixed spring", SWITCHED: "a switchable spring"}


@dataclass(frozen=True)
class Point:
    """A knee at a speed.

    Attributes:
        kind: one of `KINDS`.
        speed: wanted mean forward speed, in m/s; for a hop in place, which has none, its flight time, in s.
        stiffness: stiffness of a leg's spring, in N·m/rad, or N/m along a path whose length is in m; 0 without one,
            None where the optimiser chooses it.
    """

    kind: str
    speed: float
    stiffness: float | None = 0.0

    def said(self, pace: str, unit: str) -> str:
        """Returns the point in words.

        Args:
            pace: format for its speed, such as "at {:.3g} m/s".
            unit: unit of its stiffness.
        """
        spring = "the best stiffness" if self.stiffness is None else f"{self.stiffness:.3g} {unit}"
        own = "" if self.kind == NONE else f" of {spring}"
        return f"{WORDS[self.kind]}{own} {pace.format(self.speed)}"


@dataclass(frozen=True)
class Grid:
    """Speeds and stiffnesses of a leg, see `Point`, both rising; knees without a spring are added."""

    speeds: tuple[float, ...]
    stiffnesses: tuple[float, ...]

    def __post_init__(self) -> None:
        """Checks the fields."""
        for name in ("speeds", "stiffnesses"):
            values = getattr(self, name)
            if not values or values[0] <= 0 or any(a >= b for a, b in zip(values, values[1:], strict=False)):
                raise BadValue(name, values, "numbers > 0 that rise")

    def __iter__(self) -> Iterator[Point]:
        for speed in self.speeds:
            yield Point(NONE, speed)
            for kind in (FIXED, SWITCHED):
                yield from (Point(kind, speed, stiffness) for stiffness in self.stiffnesses)

    def __len__(self) -> int:
        return len(self.speeds) * (1 + 2 * len(self.stiffnesses))

    def neighbours(self, point: Point) -> list[Point]:
        """Returns points one step away; those from which a search likely succeeds come first: softer, slower ones."""
        j = self.speeds.index(point.speed)
        if point.kind == NONE:
            softer = []
            harder = [Point(kind, point.speed, self.stiffnesses[0]) for kind in (SWITCHED, FIXED)]
            other = []
        else:
            assert point.stiffness is not None
            i = self.stiffnesses.index(point.stiffness)
            softer = [replace(point, stiffness=self.stiffnesses[i - 1]) if i else Point(NONE, point.speed)]
            harder = [replace(point, stiffness=k) for k in self.stiffnesses[i + 1 : i + 2]]
            other = [replace(point, kind=FIXED if point.kind == SWITCHED else SWITCHED)]
        slower = [replace(point, speed=speed) for speed in self.speeds[max(j - 1, 0) : j]]
        faster = [replace(point, speed=speed) for speed in self.speeds[j + 1 : j + 2]]
        return [*softer, *slower, *other, *harder, *faster]
