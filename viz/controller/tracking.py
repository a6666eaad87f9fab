"""A gait as a table for a tracking controller: positions, rates, torques, contacts and gains of one cycle."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, import_extra, require
from spear_pin.files import atomic
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.column_names import heading, lengths
from spear_pin.hybrid.controller import commands
from spear_pin.kinds import typed

RATE = 1000.0  # Hz
FASTEST = 1e5  # Hz
SUFFIXES = ".csv", ".npz", ".mcap"
TOPIC = "/reference"


@typed
def write_table(gait: Gait, path: str | Path, rate: float = RATE) -> Path:
    """Writes one cycle of a gait as a table, from the section on, for u = torque + stiffness Δq + damping Δv.

    Δq and Δv are how far positions and rates of the joints are behind the table's. Stiffness and damping are those of
    the gait's own law, -∂u/∂q and -∂u/∂v; rows are torques, columns joints.

    Args:
        gait: the gait.
        path: the file: `.csv`, `.npz` with an array for each quantity, or `.mcap` with a message of JSON for each row.
        rate: rows in a second.

    Raises:
        BadValue: the rate or the name of the file is not valid, or the cycle is not whole.
        MissingExtra: the library for `.mcap` is not installed.
        BadFile: the file cannot be written.

    Example:
        >>> from spear_pin import Gait
        >>> from spear_pin.viz.controller.tracking import write_table
        >>> path = write_table(Gait.load("long_stride"), "bound_table.csv", rate=500)
        >>> path.read_text().splitlines()[0][:58]
        't [s],q_posterior_hip [rad],q_posterior_knee [rad],q_anter'
    """
    require("rate", rate, lambda hertz: 0.0 < hertz <= FASTEST, f"a number above 0 and at most {FASTEST:g}, in Hz")
    path = Path(path)
    if path.suffix not in SUFFIXES:
        raise BadValue("path", str(path), f"a name ending in {', '.join(SUFFIXES)}")
    writer = import_extra("mcap.writer", "logs", "a table as .mcap").Writer if path.suffix == ".mcap" else None
    arrays = tabulated(gait, rate)
    with atomic(path) as temporary, temporary.open("wb") as file:
        if path.suffix == ".npz":
            robot = gait.system.robot
            np.savez(file, allow_pickle=False, joints=robot.actuated, toes=robot.toes, **arrays)
            return path
        names, rows = _columns(gait, arrays)
        if writer is None:
            import pandas

            pandas.DataFrame(rows, columns=names).to_csv(file, index=False, encoding="utf-8")
        else:
            _write_mcap(writer(file), names, rows)
    return path


def tabulated(gait: Gait, rate: float) -> dict[str, Array]:
    """Returns t, (n,), q, v and u of the joints, (n, nu), contacts, (n, toes), and gains, (n, nu, nu), at a rate."""
    rows = commands(gait.system, gait.state, rate)
    return {name: np.array([getattr(row, name) for row in rows]) for name in rows[0]._fields}


def _columns(gait: Gait, arrays: dict[str, Array]) -> tuple[list[str], Array]:
    """Returns the columns' names with their units, and the rows."""
    robot, measured = gait.system.robot, lengths(gait.system.robot)
    joints = robot.actuated
    names = ["t [s]"]
    for symbol, per in (("q", ""), ("v", "/s")):
        names += [heading(f"{symbol}_{joint}", f"{measured[joint]}{per}") for joint in joints]
    names += [heading(f"u_{joint}", "N·m") for joint in joints]
    names += [f"contact_{toe}" for toe in robot.toes]
    for gain, unit in (("stiffness", "N·m/rad"), ("damping", "N·m·s/rad")):
        names += [heading(f"{gain}_{one}_by_{other}", unit) for one in joints for other in joints]
    n = len(arrays["t"])
    return names, np.hstack([np.asarray(each, dtype=float).reshape(n, -1) for each in arrays.values()])


def _write_mcap(writer: Any, names: list[str], rows: Array) -> None:
    plain = [name.partition(" [")[0] for name in names]
    properties = {name: {"type": "number", "description": whole} for name, whole in zip(plain, names, strict=True)}
    writer.start(profile="", library="spear_pin")
    schema = json.dumps({"type": "object", "properties": properties}).encode()
    number = writer.register_schema("spear_pin.Reference", "jsonschema", schema)
    channel = writer.register_channel(topic=TOPIC, message_encoding="json", schema_id=number)
    for i, row in enumerate(rows.tolist()):
        time = round(1e9 * row[0])
        writer.add_message(channel, time, json.dumps(dict(zip(plain, row, strict=True))).encode(), time, i)
    writer.finish()
