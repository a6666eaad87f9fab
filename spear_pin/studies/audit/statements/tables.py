"""The tables of the source that hold numbers, each with this package's numbers next to them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import isnan
from typing import TypeAlias

from spear_pin.model.loading import load
from spear_pin.studies.audit.printed_designs import (
    SPEAR_I,
    SPEAR_II,
    TABLE_2_4,
    TABLE_5_1,
    by_urdf,
    improvement,
    reflected_rotor,
    shipped,
)
from spear_pin.studies.audit.printed_estimates import COLUMNS, TABLE_4_1, TABLE_4_2, TableRow, average
from spear_pin.studies.prose import read

Cell: TypeAlias = str | float | None
Rows: TypeAlias = list[tuple[Cell, ...]]


@dataclass(frozen=True)
class Tabulation:
    """A table of the report.

    Attributes:
        id: name by which statements refer to it.
        place: the tables of the source that it shows.
        caption: what it shows.
        head: heads of its columns.
        rows: a function of a module that returns its rows, as long as the head.
        assumes: ids of the assumptions that it uses.
    """

    id: str
    place: str
    caption: str
    head: tuple[str, ...]
    rows: Callable[[], Rows]
    assumes: tuple[str, ...] = ()


SAID = read(__package__, "tables.toml")
MOTORS = ("hip_inertia", "knee_inertia")


def legs() -> Rows:
    """Returns Tables 2.2 and 2.4: both legs as printed, SPEAR-II by its URDF, rotors by the catalogue."""
    rows: Rows = []
    for name in TABLE_2_4:
        one, other = (
            (getattr(design, name), reflected_rotor(robot, name.split("_")[0]) if name in MOTORS else None)
            for robot, design in (("SPEAR-I", SPEAR_I), ("SPEAR-II", SPEAR_II))
        )
        rows.append((*SAID["labels"][name], *one, *other, _known(shipped(name)), improvement(name)))
    return rows


def symbols() -> Rows:
    """Returns Table 3.1: its symbols, with SPEAR-II's values by its URDF."""
    robot, leg = load("spear_ii"), vars(by_urdf("spear_ii"))
    known = leg | {f"{joint}_rotor": float(robot.model.rotorInertia[robot.index(joint)]) for joint in ("hip", "knee")}
    return [
        (symbol, what, known[name] if name else None, unit, source)
        for symbol, (what, name, unit, source) in SAID["symbols"].items()
    ]


def estimates() -> Rows:
    """Returns Tables 4.1 and 4.2: the rows, their means computed here, and the means as printed."""
    rows: Rows = []
    for motor, case in ((True, "With motor"), (False, "No motor")):
        printed = next(row for row in TABLE_4_2 if row.motor == motor)
        rows += [_row(f"{case}, {100 * (row.depth or 0.0):g} cm", row) for row in TABLE_4_1 if row.motor == motor]
        rows += [_row(f"{case}, mean", average(motor)), _row(f"{case}, as printed", printed)]
    return rows


def quadruped() -> Rows:
    """Returns Table 5.1: as printed, and Q-SPEAR by its URDF."""
    labels, design = SAID["labels"] | SAID["link_only"], by_urdf("q_spear")
    return [(*labels[name], printed, _known(getattr(design, name))) for name, printed in TABLE_5_1.items()]


def _known(value: float) -> float | None:
    return None if isnan(value) else value


def _row(name: str, row: TableRow) -> tuple[Cell, ...]:
    return (name, *(float(getattr(row, column)) for column in COLUMNS))


TABULATIONS: dict[int, tuple[Tabulation, ...]] = {
    chapter: tuple(Tabulation(rows=rows, **SAID[f"chapter{chapter}"][rows.__name__]) for rows in own)
    for chapter, own in {2: (legs,), 3: (symbols,), 4: (estimates,), 5: (quadruped,)}.items()
}
