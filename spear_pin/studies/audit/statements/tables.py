"""The tables of the source that hold numbers, each with this package's numbers next to them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import TypeAlias

import numpy as np

from spear_pin.gaits.bounding_law import PAIR
from spear_pin.model.loading import load
from spear_pin.studies.audit.printed_designs import (
    LEGS,
    Q_SPEAR,
    SPEAR_I,
    SPEAR_II,
    QuadrupedDesign,
    improvement,
    quantities,
    reflected_rotor,
    shank_about_com,
    shipped_leg,
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
LINK_ONLY = {
    "thigh_inertia": ("Thigh, inertia, taken about its centre of mass", "kg·m²"),
    "shank_inertia": ("Shank, inertia, taken about its centre of mass", "kg·m²"),
}


def legs() -> Rows:
    """Returns Tables 2.2 and 2.4: both legs as printed, SPEAR-II by its URDF, rotors by the catalogue."""
    leg = shipped_leg()
    rows: Rows = []
    for name in quantities():
        label, unit = LABELS[name]
        joint, _, kind = name.partition("_")
        rotors = [reflected_rotor(robot, joint) if kind == "inertia" and joint in ("hip", "knee") else None
                  for robot in ("SPEAR-I", "SPEAR-II")]  # fmt: skip
        of_urdf = getattr(leg, name)
        rows.append(
            (label, unit, getattr(SPEAR_I, name), rotors[0], getattr(SPEAR_II, name), rotors[1],
             None if np.isnan(of_urdf) else of_urdf, improvement(name))
        )  # fmt: skip
    return rows


def symbols() -> Rows:
    """Returns Table 3.1: its symbols, with SPEAR-II's values by its URDF."""
    robot, leg = load("spear_ii"), shipped_leg()
    q = np.zeros(robot.nq)
    places = [robot.frame_position(q, name) for name in ("thigh", "shank", "toe")]
    thigh = robot.model.inertias[robot.model.getJointId("hip")]
    rotors = [float(robot.model.rotorInertia[robot.index(joint)]) for joint in ("hip", "knee")]
    boom = robot.model.inertias[robot.model.getJointId("boom_z")]
    return [
        ("M", "moving slider and what it carries", boom.mass, "kg", '"mass of the boom"'),
        ("m₁", "mass of the thigh", leg.thigh_mass, "kg", ""),
        ("m₂", "mass of the shank", leg.shank_mass, "kg", ""),
        ("J₁", "inertia of the thigh about its centre of mass", float(thigh.inertia[1, 1]), "kg·m²", ""),
        (
            "J₂",
            "inertia of the shank about its centre of mass",
            shank_about_com(),
            "kg·m²",
            "Table 2.4: about the knee",
        ),
        ("J_mH", "inertia of the hip's rotor itself", rotors[0], "kg·m²", "Table 2.4: times N²"),
        ("J_mK", "inertia of the knee's rotor itself", rotors[1], "kg·m²", "Table 2.4: times N²"),
        ("N_Knee", "gear ratio of the knee", leg.knee_ratio, "1", "exchanged with N_Hip in the table"),
        ("N_Hip", "gear ratio of the hip", leg.hip_ratio, "1", "exchanged with N_Knee in the table"),
        ("d₁", "hip to the thigh's centre of mass", leg.thigh_com, "m", ""),
        ("d₂", "knee to the shank's centre of mass", leg.shank_com, "m", ""),
        ("l₁", "length of the thigh", float(np.linalg.norm(places[1] - places[0])), "m", "Table 5.1"),
        ("l₂", "length of the shank", float(np.linalg.norm(places[2] - places[1])), "m", "Table 5.1"),
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
    shipped, labels = shipped_quadruped(), LABELS | LINK_ONLY
    return [
        (*labels[field.name], getattr(Q_SPEAR, field.name), shipped[field.name]) for field in fields(QuadrupedDesign)
    ]


def shipped_quadruped() -> dict[str, float | None]:
    """Returns Table 5.1 by Q-SPEAR's URDF, for one leg; None where the URDF gives nothing."""
    robot = load("q_spear")
    torso, thigh, shank = (
        robot.model.inertias[robot.model.getJointId(name)] for name in ("pitch", "posterior_hip", "posterior_knee")
    )
    rows = [robot.index(f"posterior_{joint}") for joint in ("hip", "knee")]
    q = np.zeros(robot.nq)
    places = [robot.frame_position(q, f"posterior_{name}") for name in ("thigh", "shank", "toe")]
    hip, knee = (float(robot.model.armature[row]) / PAIR for row in rows)
    return {
        "torso_mass": torso.mass,
        "thigh_mass": thigh.mass / PAIR,
        "shank_mass": shank.mass / PAIR,
        "total_mass": torso.mass + LEGS / PAIR * (thigh.mass + shank.mass),
        "torso_inertia": float(torso.inertia[1, 1]),
        "thigh_inertia": float(thigh.inertia[1, 1]) / PAIR,
        "shank_inertia": float(shank.inertia[1, 1]) / PAIR,
        "hip_inertia": hip,
        "knee_inertia": knee,
        "knee_ratio": robot.gear_ratio("posterior_knee"),
        "hip_ratio": robot.gear_ratio("posterior_hip"),
        "thigh_length": float(np.linalg.norm(places[1] - places[0])),
        "shank_length": float(np.linalg.norm(places[2] - places[1])),
        "thigh_com": float(abs(thigh.lever[2])),
        "shank_com": float(abs(shank.lever[2])),
        "stiffness": None,
        "speed": None,
    }


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
