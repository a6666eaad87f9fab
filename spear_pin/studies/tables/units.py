"""Units by the words that logs use for them, and those that a quantity may have, by how its name ends."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array

TIMES = {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}  # in s
ANGLES = {"rad": 1.0, "mrad": 1e-3, "deg": np.pi / 180.0, "turns": 2.0 * np.pi}  # in rad
READOUTS = {"V": 1.0, "mV": 1e-3, "counts": 1.0}  # in V, or in counts: they need a calibration
VALUES = ANGLES | READOUTS
LENGTHS = {"m": 1.0, "mm": 1e-3, "cm": 1e-2}
TORQUES = {"N·m": 1.0, "mN·m": 1e-3}
FORCES = {"N": 1.0, "kN": 1e3}
POSITIONS = ANGLES | LENGTHS
RATES = {f"{unit}/s": size for unit, size in POSITIONS.items()} | {"rpm": ANGLES["turns"] / 60.0}
PLAIN = {"1": 1.0}
TIME, MODE, TORQUE = "time", "mode", "_torque"
KINDS: Mapping[str, Mapping[str, float]] = {
    "_rate": RATES,
    TORQUE: TORQUES | FORCES,  # a motor that slides has a force
    "_force": FORCES,
}
"""The units of a quantity, by how its name ends; of a name with another ending those of a position."""
OTHERS = RATES | TORQUES | FORCES
"""Units that no position has."""
_WORDS = {
    "s": "s sec secs second seconds sek sekunde sekunden",
    "ms": "ms msec msecs millisec millisecond milliseconds millisekunde millisekunden",
    "us": "us µs usec usecs µsec microsec microsecond microseconds mikrosekunde mikrosekunden",
    "ns": "ns nsec nsecs nanosec nanosecond nanoseconds nanosekunde nanosekunden",
    "min": "min mins minute minutes minuten",
    "h": "h hr hrs hour hours stunde stunden",
    "rad": "rad rads radian radians radiant",
    "mrad": "mrad milliradian milliradians",
    "deg": "deg degs degree degrees ° grad",
    "turns": "turn turns rev revs revolution revolutions rotation rotations umdrehung umdrehungen",
    "V": "v volt volts",
    "mV": "mv millivolt millivolts",
    "counts": "count counts tick ticks lsb",
    **{"N·m": "nm newtonmeter newtonmetre", "mN·m": "mnm", "N": "newton", "m": "meter metre"},
    **{"deg/s": "dps", "turns/s": "rps"},
}
_BETWEEN = re.compile(r"[\s.·⋅*]")  # factors of a unit
_UNITS = {word: unit for unit, words in _WORDS.items() for word in words.split()}
_ALIKE = str.maketrans({"μ": "µ", "º": "°", "˚": "°", "（": "(", "）": ")", "［": "[", "］": "]"})
_BRACKETED = re.compile(r"(.*?)[\s_/]*[\[(]\s*([^\[\]()]*?)\s*[\])]", re.DOTALL)
_TRAILING = re.compile(r"(.*?)(?:[\s_/.]+|(?<=[a-z])(?=[A-Z])|(?=°))([^\s_/.]+)", re.DOTALL)
_CAMEL = re.compile(r"(?<=[a-z])(?=[A-Z])")
_OF_ANGLE = "|".join(word for unit in ANGLES for word in _WORDS[unit].split())
_OF_VALUE = "|".join(word for unit in VALUES for word in _WORDS[unit].split())
_OF_TIME = "|".join(word for unit in TIMES for word in _WORDS[unit].split())
_RATE = re.compile(
    rf"(?P<stem>.*?)(?:^|[\s_/.,]|(?=°))(?P<word>rpm|rps|dps|hz|[uk1]/({_OF_TIME})"
    rf"|({_OF_VALUE})[\s_]*(/|per|pro|p)[\s_]*({_OF_TIME})[\s^*]*[²2]?"
    rf"|({_OF_ANGLE})[\s_]*[·*]?({_OF_TIME})[\s^*]*(-[12]|⁻[¹²])"
    rf"|({_OF_ANGLE})[\s_.]+(s|sec|secs|seconds?|ms)[²2]?)",
    re.I | re.DOTALL,
)
_LETTERS = {"s", "h", "v"}  # after a name they are units only as they are usually written
_TIME = r"t|time|zeit|stamp|time[\s_]?stamp"
_SURELY, _PERHAPS = re.compile(rf"[%_/]*({_TIME})", re.I), re.compile(r"(.*[^a-z])?(time|clock|epoch)|.*stamp", re.I)
_ROS = re.compile(r"%time|field\.(.*\.)?stamp")  # as `rostopic echo -p` writes them: in ns
_UNIX = (3e8, 5e9)  # s since 1970 that a clock may show


@dataclass(frozen=True)
class Named:
    """Parts of a column's name, such as `knee [deg]` or `time_ms`.

    Attributes:
        stem: the name without the unit.
        word: word that may be a unit.
        unit: unit of that word, one of `TIMES`, `ANGLES` or `READOUTS`, or None.
        meant: whether the word is surely meant as a unit: it stands in brackets, or is a unit of a rate, such as
            `rad/s`.
    """

    stem: str
    word: str
    unit: str | None
    meant: bool = False


def find_unit(word: str) -> str | None:
    """Finds the unit that a word names, one of `TIMES`, `ANGLES` or `READOUTS`, or None."""
    return _UNITS.get(word.translate(_ALIKE).strip(" []().").lower())


def split_name(name: str) -> Named:
    """Splits a column's name into what it names and the unit."""
    name = name.translate(_ALIKE).strip().rstrip(".")
    found = _BRACKETED.fullmatch(name)
    if found and found[2]:
        return Named(found[1], found[2], find_unit(found[2]), True)
    if found := _RATE.fullmatch(_CAMEL.sub("_", name)):
        return Named(found["stem"], found["word"], None, True)
    found = _TRAILING.fullmatch(name)
    if found and (unit := find_unit(found[2])) and not (found[2].lower() in _LETTERS and found[2] != unit):
        return Named(found[1], found[2], unit)
    return Named(name, name, find_unit(name))


def find_times(names: Sequence[str]) -> list[str]:
    """Finds the columns whose names say that they hold times, the surest first."""
    split = {name: split_name(name) for name in names}
    stems = {name: each.stem if each.unit in TIMES or each.meant else name.strip() for name, each in split.items()}
    surely = [name for name in names if _SURELY.fullmatch(stems[name])]
    perhaps = [name for name in names if _PERHAPS.fullmatch(stems[name]) or split[name].unit in TIMES]
    return surely + [name for name in perhaps if name not in surely]


def guess_time_unit(name: str, times: Array) -> str:
    """Guesses the unit of times without one: ns for ROS's own names, the unit of Unix times, or s."""
    if _ROS.fullmatch(name):
        return "ns"
    largest = float(np.abs(times).max(initial=0.0, where=np.isfinite(times)))
    unix = [unit for unit in ("s", "ms", "us", "ns") if _UNIX[0] <= largest * TIMES[unit] <= _UNIX[1]]
    return unix[0] if unix else "s"


def find_units(name: str) -> Mapping[str, float]:
    """Returns the units that a quantity may have, with their sizes in SI units."""
    if name in (TIME, MODE):
        return TIMES if name == TIME else PLAIN
    return next((units for ending, units in KINDS.items() if name.endswith(ending)), POSITIONS)


def known_unit(word: str, units: Mapping[str, float]) -> str | None:
    """Returns the unit among some that a word means, None for a word that means none of them."""
    plain = word.strip(" []()")
    joined = _BETWEEN.sub("", plain).lower()
    for meant in (plain, find_unit(plain), find_unit(joined), _rate(plain)):
        if meant in units:
            return meant
    return next((unit for unit in units if unit.lower() == plain.lower()), None)


def _rate(word: str) -> str | None:
    """Returns the unit of a rate, such as "deg/s", of a word such as "deg_s" or "deg per s"."""
    for mark in ("/", "_per_", " per ", "_", " "):
        above, found, below = word.partition(mark)
        if found and find_unit(below) == "s" and above:
            return f"{find_unit(above) or above}/s"
    return None
