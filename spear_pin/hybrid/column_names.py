"""Columns of a trajectory's samples: their names, contents, units, order and headings.

A name, for instance `q_knee`, joins a symbol and a part of the robot. In memory a column has its name, and its unit is
kept separately. In a file the heading of a column is its name with its unit: `q_knee [rad]`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from spear_pin.model.robot import Robot
from spear_pin.model.sagittal import ENDS

TIME, CYCLE, ENGAGED, ACTS = "t", "cycle", "engaged", "acts"
FIRST = (TIME, "domain", "phase", CYCLE)
UNSAID = "m or rad"  # unit of a coordinate whose robot is not found
QUANTITIES: dict[str, tuple[str, tuple[str, ...]]] = {  # by symbol: the quantity, its units along m and rad
    "q": ("position", ("m", "rad")),
    "v": ("velocity", ("m/s", "rad/s")),
    "a": ("acceleration", ("m/s²", "rad/s²")),
    "u": ("motor torque", ("N", "N·m")),
    "tau": ("joint torque", ("N", "N·m")),
    "friction": ("friction", ("N", "N·m")),
    "spring": ("spring torque", ("N", "N·m")),
    "current": ("current", ("A",)),
    "reference": ("current asked for", ("A",)),
    "force_x": ("force along the ground", ("N",)),
    "force_y": ("force across", ("N",)),
    "force_z": ("force normal to the ground", ("N",)),
    "length": ("length of a spring's path", ("m", "rad")),
    "stretch": ("stretch of a spring", ("m", "rad")),
    "pull": ("pull of a spring", ("N", "N·m")),
}

TOGETHER = ("u", "tau", "friction", "spring", "force_x", "force_z")
PAIRED = frozenset(f"{end}_{part}" for end in ENDS for part in ("hip", "knee", "toe"))
PAIR = ", a pair"


def split_column_name(name: str) -> tuple[str, str]:
    """Splits a column's name into symbol and label, `force_x` and `toe`; the symbol is "" if not in `QUANTITIES`."""
    symbol = next((each for each in QUANTITIES if name.startswith(f"{each}_")), "")
    return symbol, name.removeprefix(f"{symbol}_") if symbol else name


def of_a_pair(name: str) -> bool:
    """Tells whether a column adds up both legs of a pair: forces and torques of a quadruped in its sagittal plane."""
    symbol, label = split_column_name(name)
    return label in PAIRED and symbol in TOGETHER


def motors_at(joint: str) -> int:
    """Returns how many motors share a joint's torque: two in a pair of legs."""
    return 2 if of_a_pair(f"u_{joint}") else 1


def quantity(name: str) -> str:
    """Describes a column in words: "motor torque", or "motor torque, a pair"; else returns its name."""
    symbol, label = split_column_name(name)
    return QUANTITIES[symbol][0] + PAIR * of_a_pair(name) if symbol else label


def lengths(robot: Robot) -> dict[str, str]:
    """Returns the unit of each coordinate, "m" or "rad", by its name."""
    return dict(zip(robot.coordinates, robot.units, strict=True))


def unit(name: str, measured: Mapping[str, str]) -> str:
    """Returns the unit of a column, "" if it has none.

    Args:
        name: name of the column.
        measured: unit of each coordinate, "m" or "rad", see `lengths`, and by a column's name of what a spring's path
            is measured in; for others both units are given.
    """
    symbol, label = split_column_name(name)
    if not symbol:
        return "s" if name == TIME else ""
    return unit_of(symbol, measured.get(name, measured.get(label, UNSAID)))


def unit_of(symbol: str, length: str = UNSAID) -> str:
    """Returns the unit of a quantity along a coordinate in "m" or "rad"; both units if that is not known."""
    _, units = QUANTITIES[symbol]
    either = dict(zip(("m", "rad"), units, strict=True)) if len(units) > 1 else {}
    return either.get(length, " or ".join(units))


def heading(name: str, its_unit: str) -> str:
    """Returns the heading of a column in a file."""
    return f"{name} [{its_unit}]" if its_unit else name


def read_heading(text: str) -> tuple[str, str]:
    """Splits a heading into the column's name and unit, "" if it has none."""
    name, _, rest = text.partition(" [")
    return name, rest.removesuffix("]")


def sort_columns(names: Iterable[str]) -> list[str]:
    """Sorts names as in a table: time, domain, phase and cycle, the numbers, and which springs are engaged."""
    there = list(names)
    last = [name for name in there if name.startswith((f"{ENGAGED}_", f"{ACTS}_"))]
    between = [name for name in there if name not in (*FIRST, *last)]
    return [*(name for name in FIRST if name in there), *between, *last]
