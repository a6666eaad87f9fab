"""The numbers of the hop that can be turned while one watches: their ranges, and where their defaults come from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass
from functools import cached_property
from types import MappingProxyType
from typing import Literal

from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import Contact
from spear_pin.model.loading import load
from spear_pin.model.spring import Spring
from spear_pin.model.variants import PARAMETERS, vary
from spear_pin.words import number

Origin = Literal["source", "solved", "assumption"]


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
        origin: where the default comes from: the source, a condition it was solved for, or an assumption.
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


KNOBS: Mapping[str, Knob] = MappingProxyType(
    {
        "stiffness": Knob("Spring stiffness", "N·m/rad", Spring().stiffness, 20, 100, 2, "source", "Table 4.2"),
        "knee_ratio": Knob(
            "Knee gear ratio", "1", PARAMETERS["knee_ratio"].default, 5, 25, 1, "source", "Tables 2.4 and 5.1"
        ),
        "stance_torque": Knob("Stance torque", "N·m", 7.8262, 0, 14, 4, "solved", "for 0.2 s of flight"),
        "knee_touchdown": Knob(
            "Knee at touchdown", "rad", HoppingLaw().knee_touchdown, 0.5, 1.4, 3, "assumption", "commanded in flight"
        ),
        "friction": Knob("Friction coefficient", "1", Contact().friction, 0.1, 1.5, 2, "assumption", "of the ground"),
        "frequency": Knob("Stance frequency", "Hz", HoppingLaw().frequency, 1.5, 4, 2, "source", "with (4.10)"),
        "damping": Knob("Knee damping", "N·m·s/rad", Spring().damping, 0, 3, 2, "source", "Table 4.2"),
    }
)


@dataclass(frozen=True)
class Knobs:
    """Values of the knobs; ranges, units and where the defaults come from are in `KNOBS`."""

    stiffness: float = KNOBS["stiffness"].default
    knee_ratio: float = KNOBS["knee_ratio"].default
    stance_torque: float = KNOBS["stance_torque"].default
    knee_touchdown: float = KNOBS["knee_touchdown"].default
    friction: float = KNOBS["friction"].default
    frequency: float = KNOBS["frequency"].default
    damping: float = KNOBS["damping"].default

    def __post_init__(self) -> None:
        """Check the ranges."""
        for name, knob in KNOBS.items():
            require(name, getattr(self, name), knob.admits, knob.expected)

    @classmethod
    def read(cls, words: Mapping[str, str]) -> Knobs:
        """From what was written, knobs that are not named at their defaults.

        Raises:
            UnknownName: there is no knob of a name.
            BadValue: what is written is no number, or out of its range; the text names the range.
        """
        values = {}
        for name, word in words.items():
            if name not in KNOBS:
                raise UnknownName("knob", name, KNOBS)
            try:
                values[name] = number(word)
            except ValueError:
                raise BadValue(name, word, KNOBS[name].expected) from None
        return cls(**values)

    @property
    def values(self) -> dict[str, float]:
        """The numbers by name."""
        return asdict(self)

    @cached_property
    def system(self) -> HybridSystem:
        """SPEAR-II, boom_x locked, with these numbers."""
        return hopping(
            vary(load("spear_ii", locked=["boom_x"]), knee_ratio=self.knee_ratio),
            HoppingLaw(knee_touchdown=self.knee_touchdown, stance_torque=self.stance_torque, frequency=self.frequency),
            Spring(stiffness=self.stiffness, damping=self.damping),
            Contact(friction=self.friction),
        )
