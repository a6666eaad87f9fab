"""Reads a robot's TOML file, for data that a URDF cannot hold, strictly; `equipping` checks it against the robot."""

from __future__ import annotations

import re
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

from spear_pin.errors import BadFile, BadValue, UnknownName, brief
from spear_pin.files import read_bytes
from spear_pin.model.catalogue import MOTORS
from spear_pin.model.chain import BASES, ONE_OF
from spear_pin.model.elements import MAX_NUMBER
from spear_pin.model.motor import UNITS as MOTOR_UNITS
from spear_pin.model.spring import UNITS as SPRING_UNITS

SUFFIX = ".toml"
MAX_BYTES, MOST_PARTS = 1_000_000, 50
_PART = r"""(?:[A-Za-z0-9_-]++|"[^"\n]*+"|'[^'\n]*+')"""
_DOTTED = re.compile(rf"(?<![A-Za-z0-9_-]){_PART}(?:[ \t]*+\.[ \t]*+{_PART}){{{MOST_PARTS}}}")
ROLES = ("abduction", "hip", "knee")
JOINTS = ("hip", "knee", "toe")  # that a leg has, if it is given by its joints
NAMING = ("urdf", "mjcf", "robot")  # keys that name the robot


class Kind(NamedTuple):
    """Values that a key takes, and its words."""

    accepts: Callable[[Any], bool]
    words: str


@dataclass(frozen=True)
class Sidecar:
    """Contents of the file, each key of its kind; None or empty for missing keys.

    Attributes:
        source: name or path from which the robot is loaded without this file.
        path: path of this file; None if there is none.
        base: base of the robot, see `load`.
        toes: frame names of the toes, see `load`.
        locked: names of joints to hold at zero, see `load`.
        motors: "all", names of joints, or tables by role or joint.
        legs: tables by the names of legs.
        pairs: names of legs.
        springs: tables by "knee", a knee's joint, or the name of a spring on a path.
        post: joint by which the robot turns about a post, round which its toes go.
        loops: tables of closed loops by name, see `spear_pin.model.loops`.
        independent: names of joints in loops that determine the others.
        feet: tables of round feet by their toes.
        reach: tables of motors and weights, for the angles of hip and knee of a leg with loops.
    """

    source: Any
    path: Path | None = None
    base: Any = None
    toes: Sequence[str] | None = None
    locked: Sequence[str] | None = None
    motors: Any = None
    legs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    pairs: Sequence[Sequence[str]] = ()
    springs: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    post: str | None = None
    loops: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    independent: Sequence[str] = ()
    reach: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)
    feet: Mapping[str, Mapping[str, Any]] = field(default_factory=dict)

    @property
    def own_toes(self) -> Sequence[str] | None:
        """Toes that the file names, also by legs that it gives joint by joint."""
        named = [table["toe"] for table in self.legs.values() if "toe" in table]
        return (named or None) if self.toes is None else self.toes


def _is_number(value: Any) -> bool:
    return type(value) in (int, float) and abs(value) <= MAX_NUMBER


def _are_names(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, str) for item in value)


def _are_pairs(value: Any) -> bool:
    return isinstance(value, list) and len(value) == 2 and all(_are_names(pair) and len(pair) == 2 for pair in value)


def _are_points(value: Any) -> bool:
    points = isinstance(value, list) and all(isinstance(point, list) and len(point) == 2 for point in value)
    return points and all(_is_number(number) for point in value for number in point)


def _number(unit: str) -> Kind:
    return Kind(_is_number, "a number" if unit == "1" else f"a number, in {unit}")


TEXT = Kind(lambda value: isinstance(value, str), "a name")
NAMES = Kind(_are_names, "a list of names")
TABLES = Kind(lambda value: isinstance(value, dict) and all(isinstance(x, dict) for x in value.values()), "tables")
KEYS = {
    **dict.fromkeys(NAMING, TEXT),
    "base": Kind(lambda value: value in BASES, ONE_OF),
    "toes": NAMES,
    "locked": NAMES,
    "motors": Kind(
        lambda value: value == "all" or _are_names(value) or TABLES.accepts(value),
        f"'all', a list of joints, or tables by joint or by all, {', '.join(ROLES)}",
    ),
    "legs": TABLES,
    "pairs": Kind(_are_pairs, "two pairs of legs, [[left, right], [left, right]]"),
    "springs": TABLES,
    "post": TEXT,
    "loops": TABLES,
    "independent": NAMES,
    "reach": TABLES,
    "feet": TABLES,
}
LEG = {
    "side": Kind(lambda value: type(value) is int and value in (-1, 1), "1 or -1"),
    **dict.fromkeys((*JOINTS, "abduction"), TEXT),
}
MOTOR = {
    "motor": Kind(lambda value: isinstance(value, str) and value in MOTORS, f"one of {', '.join(MOTORS)}"),
    **{name: _number(MOTOR_UNITS[name]) for name in ("ratio", "rotor_inertia", "efficiency")},
}
TABLE = Kind(lambda value: isinstance(value, dict), "a table")
FOOT = {"radius": _number("m"), "from": _number("rad"), "to": _number("rad")}
LOOP = dict.fromkeys(("a", "b", "joints"), TABLE)
SPRING = {
    **{name: _number(unit) for name, unit in SPRING_UNITS.items()},
    **dict.fromkeys(("path", "from", "to", "over", "linkage", "clutch"), TABLE),
    "sum": Kind(lambda value: isinstance(value, list), "a list of tables, each with weight and a path"),
    "rest": _number("rad"),
    "unilateral": Kind(lambda value: isinstance(value, bool), "true or false"),
    "table": Kind(_are_points, "points [rad, N·m]"),
}


def read(path: Path) -> Sidecar:
    """Reads a file, and checks it as far as possible without the robot; paths in it are relative to its folder.

    Raises:
        BadFile: the file cannot be read, or a key or a value in it is not valid.
    """
    try:
        text = read_bytes(path, MAX_BYTES).decode()
        if _DOTTED.search(text):  # tomllib would take time as the square of its parts
            raise BadFile(path, f"has a key of more than {MOST_PARTS} parts")
        said = tomllib.loads(text)
    except (ValueError, RecursionError) as error:
        raise BadFile(path, f"is not TOML: {error}") from None
    _check(path, said, KEYS, "")
    tables = {"legs": LEG, "springs": SPRING, "motors": MOTOR, "loops": LOOP, "feet": FOOT}
    for key, kinds in tables.items():
        for name, table in said[key].items() if isinstance(said.get(key), dict) else ():
            _check(path, table, kinds, f"{key}.{name}.")
    named = [key for key in NAMING if key in said]
    if len(named) > 1:
        raise BadFile(path, f"{named[1]} is {brief(said[named[1]])}; expected one key of {', '.join(NAMING)}")
    source = None
    for key in named:
        source = said.pop(key)
        if (key == "robot") == bool({"/", "\\", "."} & set(source)):
            what = "the name of a robot; a path is given by urdf or mjcf" if key == "robot" else "the path of a file"
            raise BadFile(path, f"{key} is {brief(source)}; expected {what}")
        source = source if key == "robot" else str(path.parent / source)
    return Sidecar(source, path, **said)


def _check(path: Path, table: Mapping[str, Any], kinds: Mapping[str, Kind], prefix: str) -> None:
    for key, value in table.items():
        if key not in kinds:
            raise BadFile(path, str(UnknownName("key", prefix + key, (prefix + each for each in kinds))))
        if not kinds[key].accepts(value):
            raise BadFile(path, f"{prefix}{key} is {brief(value)}; expected {kinds[key].words}")


@contextmanager
def blame_file(path: Path | None, key: str) -> Iterator[None]:
    """Adds the file and the key to errors about invalid values."""
    try:
        yield
    except (BadValue, UnknownName) as error:
        raise BadFile(path or "", f"{key}: {error}") from None
