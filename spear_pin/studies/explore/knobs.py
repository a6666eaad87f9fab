"""Numbers of a motion that can be turned while one watches: their ranges, and where their defaults come from."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.result import State
from spear_pin.words import number

Origin = Literal["source", "solved", "assumption", "scaled", "own"]


@dataclass(frozen=True)
class Knob:
    """A number that can be turned.

    Attributes:
        label: what it is.
        unit: of its values; a ratio has the unit 1.
        default: where it stands at first.
        low: the least value.
        high: the largest value.
        digits: decimals in which it is set.
        origin: where the default comes from: the source, a condition it was solved for, an assumption, the source
            scaled to another robot, or the robot's or the gait's own file.
        note: the same in words.
    """

    label: str
    unit: str
    default: float
    low: float
    high: float
    digits: int
    origin: Origin
    note: str

    def admits(self, value: float) -> bool:
        """Whether it can be set to a value."""
        return self.low <= value <= self.high

    @property
    def expected(self) -> str:
        """Valid values, in words."""
        return f"a number from {self.low:g} to {self.high:g}" + ("" if self.unit == "1" else f", in {self.unit}")


class Subject(ABC):
    """A motion whose numbers are turned; it is told from others by itself, not by what is in it.

    Attributes:
        kind: of the motion, "hop" or "bound".
        title: of the page.
        knobs: by name.
        keeps: what may be kept while numbers are turned, in words; "" where that is nothing.
        wanted: value of what may be kept, SI units.
    """

    kind: str
    title: str
    knobs: Mapping[str, Knob]
    keeps: str = ""
    wanted: float = 0.0

    @abstractmethod
    def system(self, values: Mapping[str, float]) -> HybridSystem:
        """The system with these numbers."""

    @abstractmethod
    def lane(self, values: Mapping[str, float]) -> tuple[HybridSystem, dict[str, float]]:
        """A system that others share, so that it is compiled once, and the numbers that are put into it."""

    @property
    @abstractmethod
    def start(self) -> State:
        """State (q, v) on the section of the motion with the default numbers: where all else begins."""

    @property
    @abstractmethod
    def thorough(self) -> Sequence[Knobs]:
        """Numbers whose motions between them have every domain, to be compiled first."""

    def held(self, kept: bool) -> Mapping[str, str]:
        """Parameters of the system that are solved for while numbers are turned, each with the measure that it keeps.

        Args:
            kept: whether what may be kept is kept.
        """
        return {}

    def moved(self, name: str, values: Mapping[str, float]) -> Mapping[str, float]:
        """Parameters of the system that a knob moves, by how much for one more unit of it.

        It is empty where the knob is the value of a measure that is kept.

        Args:
            name: of the knob.
            values: of all knobs.
        """
        return {name: 1.0}

    def at(self, *, kept: bool = False, **values: float) -> Knobs:
        """Knobs that are not named at their defaults.

        Raises:
            UnknownName: there is no knob of a name.
            BadValue: a value is out of its range; the text names the range.
        """
        for name in values:
            if name not in self.knobs:
                raise UnknownName("knob", name, self.knobs)
        return Knobs(self, tuple(values.get(name, knob.default) for name, knob in self.knobs.items()), kept)

    def read(self, words: Mapping[str, str], kept: bool = False) -> Knobs:
        """Knobs from what was written, as of `at`.

        Raises:
            UnknownName: there is no knob of a name.
            BadValue: what is written is no number, or out of its range; the text names the range.
        """
        values = {}
        for name, word in words.items():
            if name not in self.knobs:
                raise UnknownName("knob", name, self.knobs)
            try:
                values[name] = number(word)
            except ValueError:
                raise BadValue(name, word, self.knobs[name].expected) from None
        return self.at(kept=kept, **values)


@dataclass(frozen=True)
class Knobs:
    """Values of the knobs of a subject.

    Attributes:
        subject: what is turned.
        numbers: of each knob, in their order.
        kept: whether what the subject keeps is kept.
    """

    subject: Subject
    numbers: tuple[float, ...]
    kept: bool = False

    def __post_init__(self) -> None:
        """Check the ranges."""
        for (name, knob), value in zip(self.subject.knobs.items(), self.numbers, strict=True):
            require(name, value, knob.admits, knob.expected)

    @property
    def values(self) -> dict[str, float]:
        """The numbers by name."""
        return dict(zip(self.subject.knobs, self.numbers, strict=True))

    def turned(self, **values: float) -> Knobs:
        """The same with other numbers."""
        return replace(self, numbers=tuple((self.values | values).values()))

    @cached_property
    def system(self) -> HybridSystem:
        """The system with these numbers."""
        return self.subject.system(self.values)
