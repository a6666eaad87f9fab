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


LABELS = {
    "leg_mass": ("Leg, mass", "kg"),
    "thigh_mass": ("Thigh, mass", "kg"),
    "shank_mass": ("Shank, mass", "kg"),
    "thigh_inertia": ("Thigh, inertia, taken about the hip", "kg·m²"),
    "shank_inertia": ("Shank, inertia, taken about the knee", "kg·m²"),
    "hip_inertia": ("Hip motor, inertia at the joint", "kg·m²"),
    "knee_inertia": ("Knee motor, inertia at the joint", "kg·m²"),
    "thigh_com": ("Thigh, centre of mass from the hip", "m"),
    "shank_com": ("Shank, centre of mass from the knee", "m"),
    "hip_ratio": ("Hip, gear ratio", "1"),
    "knee_ratio": ("Knee, gear ratio", "1"),
    "thigh_width": ("Thigh, width", "m"),
    "torso_mass": ("Torso, mass", "kg"),
    "total_mass": ("Robot, mass", "kg"),
    "torso_inertia": ("Torso, inertia", "kg·m²"),
    "thigh_length": ("Thigh, length", "m"),
    "shank_length": ("Shank, length", "m"),
    "stiffness": ("Knee spring of a leg", "N·m/rad"),
    "speed": ("Speed", "m/s"),
}
MOTORS = ("hip_inertia", "knee_inertia")
LINK_ONLY = {
    "thigh_inertia": ("Thigh, inertia, taken about its centre of mass", "kg·m²"),
    "shank_inertia": ("Shank, inertia, taken about its centre of mass", "kg·m²"),
}


def legs() -> Rows:
    """Returns Tables 2.2 and 2.4: both legs as printed, SPEAR-II by its URDF, rotors by the catalogue."""
    rows: Rows = []
    for name in TABLE_2_4:
        one, other = (
            (getattr(design, name), reflected_rotor(robot, name.split("_")[0]) if name in MOTORS else None)
            for robot, design in (("SPEAR-I", SPEAR_I), ("SPEAR-II", SPEAR_II))
        )
        rows.append((*LABELS[name], *one, *other, _known(shipped(name)), improvement(name)))
    return rows


def symbols() -> Rows:
    """Returns Table 3.1: its symbols, with SPEAR-II's values by its URDF."""
    robot, leg = load("spear_ii"), by_urdf("spear_ii")
    hip, knee = (float(robot.model.rotorInertia[robot.index(joint)]) for joint in ("hip", "knee"))
    return [
        ("M", "moving slider and what it carries", leg.torso_mass, "kg", '"mass of the boom"'),
        ("m₁", "mass of the thigh", leg.thigh_mass, "kg", ""),
        ("m₂", "mass of the shank", leg.shank_mass, "kg", ""),
        ("J₁", "inertia of the thigh about its centre of mass", leg.thigh_inertia, "kg·m²", ""),
        (
            "J₂",
            "inertia of the shank about its centre of mass",
            leg.shank_inertia,
            "kg·m²",
            "Table 2.4: about the knee",
        ),
        ("J_mH", "inertia of the hip's rotor itself", hip, "kg·m²", "Table 2.4: times N²"),
        ("J_mK", "inertia of the knee's rotor itself", knee, "kg·m²", "Table 2.4: times N²"),
        ("N_Knee", "gear ratio of the knee", leg.knee_ratio, "1", "exchanged with N_Hip in the table"),
        ("N_Hip", "gear ratio of the hip", leg.hip_ratio, "1", "exchanged with N_Knee in the table"),
        ("d₁", "hip to the thigh's centre of mass", leg.thigh_com, "m", ""),
        ("d₂", "knee to the shank's centre of mass", leg.shank_com, "m", ""),
        ("l₁", "length of the thigh", leg.thigh_length, "m", "Table 5.1"),
        ("l₂", "length of the shank", leg.shank_length, "m", "Table 5.1"),
        ("θ_mHip, θ_mKnee", "angles of the rotors", None, "rad", '"rad/s²" in the table'),
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
    labels, design = LABELS | LINK_ONLY, by_urdf("q_spear")
    return [(*labels[name], printed, _known(getattr(design, name))) for name, printed in TABLE_5_1.items()]


def _known(value: float) -> float | None:
    return None if isnan(value) else value


def _row(name: str, row: TableRow) -> tuple[Cell, ...]:
    return (name, *(float(getattr(row, column)) for column in COLUMNS))


ESTIMATE_HEAD = ("", "k_rot (N·m/rad)", "b (N·m·s/rad)", "RA (rad)", "σ of k_rot", "σ of b", "σ of RA", "fit (%)")
TABULATIONS: dict[int, tuple[Tabulation, ...]] = {
    2: (
        Tabulation(
            "table-2.4",
            "Tables 2.2 and 2.4",
            "Both legs as printed; N² J of the motors in the catalogue that stand for theirs; SPEAR-II as the URDF "
            "has it.",
            ("", "Unit", "SPEAR-I", "by catalogue", "SPEAR-II", "by catalogue", "by URDF", "II / I"),
            legs,
            ("knee-motor", "hip-motor"),
        ),
    ),
    3: (
        Tabulation(
            "table-3.1",
            "Table 3.1",
            "The symbols of Chapter 3 with SPEAR-II's values, as the URDF has them.",
            ("Symbol", "What it is", "Value", "Unit", "In the source"),
            symbols,
        ),
    ),
    4: (
        Tabulation(
            "table-4.1",
            "Tables 4.1 and 4.2",
            "The rows of Table 4.1, their mean computed here, and Table 4.2 as printed.",
            ESTIMATE_HEAD,
            estimates,
        ),
    ),
    5: (
        Tabulation(
            "table-5.1",
            "Table 5.1",
            "The quadruped's numbers as printed, and as the URDF has them, of one leg of a pair.",
            ("", "Unit", "as printed", "by URDF"),
            quadruped,
        ),
    ),
}
