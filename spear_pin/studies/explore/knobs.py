"""Knobs: numbers of a motion that a user can change, with their ranges and the origin of their defaults."""

from __future__ import annotations

import math
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
    """A number that a user can change.

    Attributes:
        label: label of the knob.
        unit: unit of its values; a ratio has the unit 1, and a number of a law that names no units has none.
        default: default value.
        low: least value.
        high: largest value.
        digits: number of decimals.
        origin: origin of the default: the source, a condition for which it was solved, an assumption, the source scaled
            to another robot, or the robot's or the gait's own file.
        note: the origin in words.
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
        """Tells whether the knob can have a value."""
        return self.low <= value <= self.high

    @property
    def expected(self) -> str:
        """Valid values, in words."""
        measured = "" if self.unit in ("", "1") else f", in {self.unit}"
        return f"a number from {self.low:g} to {self.high:g}{measured}"


def about(label: str, unit: str, value: float, note: str, least: float = 0.5, most: float = 2.0) -> Knob:
    """Returns a knob for a gait's own number, from some of it to a multiple of it; to 100 for a number that is zero.

    The ends of its range have no more decimals than the slider gives.
    """
    digits = max(0, 3 - math.floor(math.log10(abs(value) or 1e-3)))
    low, high = sorted((least * value, most * value or 100.0))
    one = 10.0**digits
    low, high = round(math.ceil(low * one) / one, digits), round(math.floor(high * one) / one, digits)
    return Knob(label, unit, value, low, high, digits, "own", note)


class Subject(ABC):
    """A motion whose numbers a user can change; two subjects are compared by identity, not by content.

    Attributes:
        kind: kind of the motion, "hop", "bound" or "gait".
        title: title of the page.
        knobs: knobs by name.
        keeps: the measure that can be kept while numbers change, in words; "" where there is none.
        wanted: value of the measure that can be kept, SI units.
    """

    kind: str
    title: str
    knobs: Mapping[str, Knob]
    keeps: str = ""
    wanted: float = 0.0

    @abstractmethod
    def system(self, values: Mapping[str, float]) -> HybridSystem:
        """Returns the system with these numbers."""

    @property
    @abstractmethod
    def start(self) -> State:
        """State (q, v) on the section of the motion with the default numbers, where every answer begins."""

    @property
    @abstractmethod
    def thorough(self) -> Sequence[Knobs]:
        """Numbers whose motions together have every domain, to be compiled first."""

    def held(self, kept: bool) -> Mapping[str, str]:
        """Returns parameters that are solved for while numbers change, each with the measure that it keeps.

        Args:
            kept: whether the measure that can be kept is kept.
        """
        return {}

    def moved(self, name: str, values: Mapping[str, float]) -> Mapping[str, float]:
        """Returns parameters of the system that a knob changes, with the change for one more unit of the knob.

        The result is empty where the knob is the value of a measure that is kept.

        Args:
            name: name of the knob.
            values: values of all knobs.
        """
        return {name: 1.0}

    def at(self, *, kept: bool = False, **values: float) -> Knobs:
        """Returns knobs with given values, and defaults for the others.

        Raises:
            UnknownName: no knob has such a name.
            BadValue: a value is out of its range; the text names the range.
        """
        for name in values:
            if name not in self.knobs:
                raise UnknownName("knob", name, self.knobs)
        return Knobs(self, tuple(values.get(name, knob.default) for name, knob in self.knobs.items()), kept)

    def read(self, words: Mapping[str, str], kept: bool = False) -> Knobs:
        """Reads knobs from text, with defaults for the others; see `at`.

        Raises:
            UnknownName: no knob has such a name.
            BadValue: a text is not a number, or is out of its range; the text names the range.
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
        subject: the motion.
        numbers: value of each knob, in their order.
        kept: whether the measure that can be kept is kept.
    """

    subject: Subject
    numbers: tuple[float, ...]
    kept: bool = False

    def __post_init__(self) -> None:
        """Checks the ranges."""
        for (name, knob), value in zip(self.subject.knobs.items(), self.numbers, strict=True):
            require(name, value, knob.admits, knob.expected)

    @property
    def values(self) -> dict[str, float]:
        """Numbers by name."""
        return dict(zip(self.subject.knobs, self.numbers, strict=True))

    def turned(self, **values: float) -> Knobs:
        """Returns the knobs with other numbers."""
        return replace(self, numbers=tuple((self.values | values).values()))

    @cached_property
    def system(self) -> HybridSystem:
        """System with these numbers."""
        return self.subject.system(self.values)
