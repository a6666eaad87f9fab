"""Units of a log's columns: of joints' positions and rates, of torques and forces, by what the column holds."""

from __future__ import annotations

import re
from collections.abc import Mapping

from spear_pin.studies.identification.units import ANGLES, TIMES, find_unit

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
    **{"nm": "N·m", "newtonmeter": "N·m", "newtonmetre": "N·m", "mnm": "mN·m", "newton": "N"},
    **{"meter": "m", "metre": "m", "dps": "deg/s", "rps": "turns/s"},
}
_BETWEEN = re.compile(r"[\s.·⋅*]")  # factors of a unit


def find_units(name: str) -> Mapping[str, float]:
    """Returns the units that a quantity may have, with their sizes in SI units."""
    if name in (TIME, MODE):
        return TIMES if name == TIME else PLAIN
    return next((units for ending, units in KINDS.items() if name.endswith(ending)), POSITIONS)


def known_unit(word: str, units: Mapping[str, float]) -> str | None:
    """Returns the unit among some that a word means, None for a word that means none of them."""
    plain = word.strip(" []()")
    joined = _BETWEEN.sub("", plain).lower()
    for meant in (plain, find_unit(plain), _WORDS.get(joined), _rate(plain)):
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
