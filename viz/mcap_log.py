"""A trajectory as an MCAP file, a log of timed messages that Foxglove and other programs read.

Places, joints, shapes, forces and events are messages of Foxglove's schemas, in protobuf. Every sample is also a JSON
message, as in tables. Times are those of the trajectory, as nanoseconds from zero.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from heapq import merge
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin import __version__
from spear_pin.arrays import Array
from spear_pin.errors import BadValue, SpearError, list_names
from spear_pin.files import atomic
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.hybrid.trajectory_tables import find_engaged
from spear_pin.kinds import typed
from spear_pin.model.document import describe
from spear_pin.model.robot import Robot
from spear_pin.viz import mcap_messages as m
from spear_pin.viz.playback.looks import read_looks
from spear_pin.viz.playback.stage import GROUND
from spear_pin.viz.playback.surface import outline
from spear_pin.viz.playback.trajectory import in_world, read_times

SCHEMA = "spear_pin.Sample"
ARROW = 0.3  # m, of the largest force
BEYOND = 1.0  # m that the ground goes on around the toes
PLACES = 50  # samples that are looked at for where the toes are
LEAST = 1e-3  # of the largest force, below which no arrow is drawn


@dataclass(frozen=True)
class Message:
    """A logged message.

    Attributes:
        time: time in ns.
        topic: name of the channel.
        content: a message of protobuf, or an object of JSON.
    """

    time: int
    topic: str
    content: Any


@typed
def write_mcap(robot: Robot, trajectory: Trajectory, path: str | Path) -> Path:
    """Writes a trajectory as an MCAP file, whole or not at all.

    Topics are `/tf` (every link and toe in the world), `/joint_states` (effort: `tau`), `/scene/robot` (its shapes,
    once), `/scene/ground` (once), `/scene/forces` (arrows), `/events` and `/samples` (all columns, by their names). If
    the robot was cut out of another, `/whole/joint_states` has the joints of that robot. The file from which it was
    loaded is attached.

    Args:
        robot: the robot that moved.
        trajectory: motion of the robot.
        path: path of the file.

    Raises:
        MissingExtra: the libraries are not installed.
        BadValue: the trajectory is not the robot's.
        BadFile: the file cannot be written.
    """
    schemas = m.load()
    if robot.coordinates != trajectory.coordinates or robot.toes != trajectory.toes:
        expected = f"one of this robot, with {list_names(robot.coordinates)} and the toes {list_names(robot.toes)}"
        raise BadValue("trajectory", f"one with {list_names(trajectory.coordinates)}", expected)
    begin = min(0.0, float(read_times(trajectory)[0]))
    times = [round(1e9 * (time - begin)) for time in trajectory.t.tolist()]
    names, table = trajectory.columns()
    forces = in_world(robot, trajectory.q, trajectory.force, trajectory.ground)
    ground = trajectory.ground or Ground()
    peak = float(np.linalg.norm(np.nan_to_num(forces), axis=2).max(initial=0.0))
    anchors = m.anchors(robot.model)
    messages = merge(
        _shapes(schemas, robot, anchors, times[0]),
        _surface(schemas, robot, trajectory, ground, times[0]),
        _motion(schemas, robot, trajectory, times, forces, peak),
        _events(schemas, trajectory, begin),
        _samples(trajectory, times, names, table),
        key=lambda message: message.time,
    )
    said = {
        "robot": trajectory.robot,
        "units": "SI, radians",
        "time_of_zero": repr(begin),
        "ground": json.dumps(vars(ground)),
        "metres_per_newton_of_arrows": repr(ARROW / peak if peak else 0.0),
        "cycles": str(trajectory.cycles),
        "reason": trajectory.reason,
        "message": trajectory.message,
        "origin": json.dumps(trajectory.origin),
    }
    with atomic(path) as temporary, temporary.open("wb") as file:
        _write(file, messages, _schema(trajectory, names), said, _attached(robot))
    return Path(path)


def _write(
    file: Any, messages: Iterable[Message], schema: Mapping[str, Any], said: dict[str, str], attached: dict[str, bytes]
) -> None:
    from mcap.writer import Writer
    from mcap_protobuf.schema import register_schema

    writer: Any = Writer(file)
    writer.start(profile="", library=f"spear_pin {__version__}")
    channels: dict[str, int] = {}
    schemas: dict[str, int] = {}
    for name, data in attached.items():
        writer.add_attachment(create_time=0, log_time=0, name=name, media_type="application/xml", data=data)
    writer.add_metadata("spear_pin", said)
    for number, message in enumerate(messages):
        content, plain = message.content, isinstance(message.content, dict)
        if message.topic not in channels:
            kind = SCHEMA if plain else content.DESCRIPTOR.full_name
            if kind not in schemas:
                own = json.dumps(schema).encode()
                schemas[kind] = (
                    writer.register_schema(kind, "jsonschema", own) if plain else register_schema(writer, type(content))
                )
            channels[message.topic] = writer.register_channel(
                topic=message.topic, message_encoding="json" if plain else "protobuf", schema_id=schemas[kind]
            )
        data = json.dumps(content, allow_nan=False).encode() if plain else content.SerializeToString()
        writer.add_message(channels[message.topic], message.time, data, message.time, number)
    writer.finish()


def _shapes(schemas: m.Schemas, robot: Robot, anchors: list[m.Anchor], time: int) -> Iterator[Message]:
    yield Message(time, "/scene/robot", m.scene(schemas, read_looks(robot).shapes, anchors, time))


def _surface(schemas: m.Schemas, robot: Robot, trajectory: Trajectory, ground: Ground, time: int) -> Iterator[Message]:
    rows = np.unique(np.linspace(0, len(trajectory.t) - 1, PLACES).astype(int))
    toes = [robot.toe_position(trajectory.q[row], toe)[0] for row in rows for toe in robot.toes]
    line = outline(ground, min(toes, default=0.0) - BEYOND, max(toes, default=0.0) + BEYOND)
    yield Message(time, "/scene/ground", m.strip(schemas, "ground", line, BEYOND, (*GROUND, 1.0), time))


def _motion(
    schemas: m.Schemas, robot: Robot, trajectory: Trajectory, times: list[int], forces: Array, peak: float
) -> Iterator[Message]:
    frames = m.frames(robot)
    effort = np.zeros_like(trajectory.v)
    effort[:, [robot.index(joint) for joint in trajectory.actuated]] = np.nan_to_num(trajectory.tau)
    data = pin.Data(robot.model)
    for row, time in enumerate(times):
        pin.framesForwardKinematics(robot.model, data, trajectory.q[row])
        yield Message(time, "/tf", m.transforms(schemas, data, frames, time))
        states = m.joints_of(robot.model, trajectory.q[row], trajectory.v[row], trajectory.a[row], effort[row])
        yield Message(time, "/joint_states", m.joint_states(schemas, states, time))
        if robot.cut is not None:
            yield Message(time, "/whole/joint_states", m.joint_states(schemas, m.uncut(robot.cut, states), time))
        if peak:
            places = [data.oMf[robot.toe_id(toe)].translation for toe in robot.toes]
            arrows = [
                (toe, place, force * ARROW / peak if np.linalg.norm(force) > LEAST * peak else None)
                for toe, place, force in zip(robot.toes, places, forces[row], strict=True)
            ]
            yield Message(time, "/scene/forces", m.arrows(schemas, arrows, time))


def _events(schemas: m.Schemas, trajectory: Trajectory, begin: float) -> Iterator[Message]:
    for event in sorted(trajectory.events, key=lambda event: event.time):
        time = round(1e9 * (event.time - begin))
        yield Message(time, "/events", m.log(schemas, event.name, event.domain, time))


def _samples(trajectory: Trajectory, times: list[int], names: list[str], table: Array) -> Iterator[Message]:
    words, latches = {"domain": trajectory.domain, "phase": trajectory.phase}, find_engaged(trajectory)
    for row, time in enumerate(times):
        numbers = [value if np.isfinite(value) else None for value in table[row].tolist()]
        said: dict[str, Any] = dict(zip(names, numbers, strict=True))
        said |= {name: str(values[row]) for name, values in words.items()}
        said |= {name: bool(on[row]) for name, on in latches.items()}
        yield Message(time, "/samples", said)


def _schema(trajectory: Trajectory, names: list[str]) -> dict[str, Any]:
    """Returns the JSON schema of a sample, each number with its unit."""
    units = trajectory.units()
    said = {name: {"description": units[name]} if units[name] else {} for name in names}
    numbers = {name: {"type": ["number", "null"], **said[name]} for name in names}
    words = {name: {"type": "string"} for name in ("domain", "phase")}
    latches = {name: {"type": "boolean"} for name in find_engaged(trajectory)}
    return {"type": "object", "title": SCHEMA, "properties": {**numbers, **words, **latches}}


def _attached(robot: Robot) -> dict[str, bytes]:
    """Returns the file from which the robot, or the robot it was cut from, was loaded, if it exists."""
    try:
        path = describe(robot if robot.cut is None else robot.cut.robot).path
        return {path.name: path.read_bytes()}
    except (SpearError, OSError):
        return {}
