"""Footfalls: which legs are on the ground in the phases of a gait, in order, and how a stride closes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from spear_pin.errors import BadValue
from spear_pin.kinds import typed

LEGS = ("posterior_left", "posterior_right", "anterior_left", "anterior_right")
PAIRS = ("posterior", "anterior")  # in the plane
OPPOSITE = {"left": "right", "right": "left"}
Bearing = tuple[str, ...]


@typed
@dataclass(frozen=True)
class Footfalls:
    """Phases of a stride, or of half a stride whose other half is its mirror image.

    Attributes:
        phases: the legs on the ground in each phase, by their names in `LEGS`, in the plane in `PAIRS`; () is a flight.
            All legs of the first phase land as it begins.
        intervals: number of intervals of collocation in each phase, at least 1.
        mirrored: whether this is half a stride, after which left and right change places.

    Raises:
        BadValue: a name is not a leg's, two phases in a row have the same legs, or a leg lands twice.

    Example:
        >>> from spear_pin.gaits.footfalls.sequence import FOOTFALLS
        >>> FOOTFALLS["trot"].phases  # half a stride
        (('posterior_left', 'anterior_right'), ())
    """

    phases: tuple[tuple[str, ...], ...]
    intervals: tuple[int, ...]
    mirrored: bool = False

    def __post_init__(self) -> None:
        """Checks the fields."""
        legs = f"phases with legs among {', '.join(LEGS)}"
        expected = f"{legs}; neighbours differ, and all legs of the first phase land as it begins"
        names = {name for phase in self.phases for name in phase}
        known = names <= {*LEGS} or names <= {*PAIRS} and not self.mirrored
        if not known or any(len(set(phase)) < len(phase) for phase in self.phases):
            raise BadValue("Footfalls.phases", self.phases, expected)
        if len(self.intervals) != len(self.phases) or min(self.intervals, default=0) < 1:
            raise BadValue("Footfalls.intervals", self.intervals, "a whole number, at least 1, for each phase")
        whole = [set(phase) for phase in self.whole]
        alike = any(before == after for before, after in zip(whole, [*whole[1:], whole[0]], strict=True))
        if alike or not whole[0] or whole[0] & whole[-1]:
            raise BadValue("Footfalls.phases", self.phases, expected)
        for name in {name for phase in whole for name in phase}:
            if len(self.landings(name)) > 1:
                raise BadValue("Footfalls.phases", self.phases, f"{name} to land once a stride")

    @property
    def whole(self) -> tuple[Bearing, ...]:
        """The phases of a whole stride."""
        return *self.phases, *(tuple(map(opposite, phase)) for phase in self.phases if self.mirrored)

    @property
    def unfolded(self) -> Footfalls:
        """The same footfalls as a whole stride."""
        return Footfalls(self.whole, self.intervals * (2 if self.mirrored else 1)) if self.mirrored else self

    def landings(self, leg: str) -> list[int]:
        """Returns the numbers of the phases of a whole stride that begin as a leg lands."""
        return [i for i, phase in enumerate(self.whole) if leg in phase and leg not in self.whole[i - 1]]

    def finer(self, times: int) -> Footfalls:
        """Returns the same footfalls with `times` times the intervals."""
        return Footfalls(self.phases, tuple(times * count for count in self.intervals), self.mirrored)


def opposite(leg: str) -> str:
    """Returns the leg on the other side."""
    pair, _, side = leg.rpartition("_")
    return f"{pair}_{OPPOSITE[side]}"


def _of(intervals: Sequence[int], *phases: str, mirrored: bool = False) -> Footfalls:
    """Makes footfalls from letters: "pl ar" are the posterior left and the anterior right leg."""
    short = {"".join(part[0] for part in name.split("_")): name for name in LEGS}
    return Footfalls(
        tuple(tuple(short[each] for each in phase.split()) for phase in phases), tuple(intervals), mirrored
    )


FOOTFALLS: Mapping[str, Footfalls] = {
    "trot": _of((5, 3), "pl ar", "", mirrored=True),
    "pace": _of((5, 3), "pl al", "", mirrored=True),
    "pronk": _of((5, 4), "pl pr al ar", ""),
    "bound": _of((5, 3, 5, 3), "pl pr", "", "al ar", ""),
    "gallop": _of((2, 4, 2, 2, 2, 4, 2, 2), "pl", "pl pr", "pr", "", "al", "al ar", "ar", ""),
}
"""Footfalls of gaits by name, on meshes that are coarse."""
