"""Columns of a robot in space for its page: by joint over its legs, with its speed ahead and across."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from spear_pin.hybrid.column_names import split_column_name
from spear_pin.model.chain import CHAIN
from spear_pin.model.robot import Robot
from spear_pin.viz.bench.columns import Column
from spear_pin.viz.playback.footfalls import color_of, label_of

X, Y, _, YAW, PITCH, ROLL = CHAIN
AHEAD, ACROSS = "speed_ahead", "speed_across"
FIRST = (f"q_{YAW}", f"q_{ROLL}", ACROSS)
"""Columns that a page plots first, before those of the adductions and the ground."""


def in_space(robot: Robot) -> bool:
    """Tells whether the base of a robot is a chain in space."""
    return robot.coordinates[: len(CHAIN)] == CHAIN


def by_leg(robot: Robot, columns: Sequence[Column]) -> tuple[Column, ...]:
    """Returns columns grouped by joint over the legs, with a colour for each leg; angles of the base are apart."""
    parts: dict[str, tuple[str, str, str]] = {}
    for number, leg in enumerate(robot.legs):
        named = {"adduction": leg.abduction, "hip": leg.hip, "knee": leg.knee}
        own = label_of(leg.toe), color_of(number, len(robot.legs))
        parts |= {joint: (f"{part} ", *own) for part, joint in named.items() if joint is not None}
        parts[leg.toe] = ("", *own)
    found = []
    for column in columns:
        symbol, label = split_column_name(column.name)
        if label in parts and symbol:
            kind, leg_label, color = parts[label]
            column = replace(column, kind=kind + column.kind, label=leg_label, color=color)
        elif symbol == "q" and label in (YAW, PITCH, ROLL):
            column = replace(column, kind=label, label="")
        found.append(column)
    return *found, *_speeds({column.name: column for column in columns})


def _speeds(columns: dict[str, Column]) -> list[Column]:
    """Returns horizontal speeds along the heading and across it, to the left."""
    names = f"v_{X}", f"v_{Y}", f"q_{YAW}"
    if not set(names) <= columns.keys():
        return []
    vx, vy, yaw = (columns[name].values for name in names)
    c, s = np.cos(yaw), np.sin(yaw)
    made = {AHEAD: ("speed ahead", c * vx + s * vy), ACROSS: ("speed across, to the left", c * vy - s * vx)}
    return [Column(name, "", kind, "m/s", values, derived=True) for name, (kind, values) in made.items()]


def plotted_in_space(columns: Sequence[Column]) -> list[str]:
    """Returns names of the columns that a page shows first in space."""
    there = [column for column in columns if column.moves]
    adductions = [
        column.name
        for kind in ("adduction position", "adduction motor torque")
        for column in there
        if column.kind == kind
    ]
    forces = [column.name for column in there if column.name.startswith("force_z_")]
    return [*(name for name in FIRST if any(column.name == name for column in there)), *adductions, *forces]
