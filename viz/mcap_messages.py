"""Messages of Foxglove's schemas: places of frames, states of joints, shapes, arrows and lines of a log."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import import_extra
from spear_pin.model.cut import STAY, Cut
from spear_pin.model.robot import Robot
from spear_pin.viz.playback.overlays import ARROW_COLOR
from spear_pin.viz.playback.shapes import Shape

Schemas = Any  # classes of messages by their names

WORLD = "world"
NAMES = (
    *("FrameTransform", "FrameTransforms", "JointState", "JointStates", "Log", "SceneEntity", "SceneUpdate"),
    *("ArrowPrimitive", "CubePrimitive", "CylinderPrimitive", "SpherePrimitive", "TriangleListPrimitive"),
    *("Color", "Point3", "Pose", "Quaternion", "Vector3"),
)
BODY = pin.FrameType.BODY
SHAFT, HEAD = 0.012, 0.03  # m, diameters of an arrow


class Anchor(NamedTuple):
    """A named frame that moves with a joint, and its place in the joint's frame."""

    name: str
    placement: pin.SE3


@dataclass(frozen=True)
class JointState:
    """State of a joint of one degree of freedom, in m or rad and s, effort in N or N·m."""

    name: str
    position: float
    velocity: float
    acceleration: float
    effort: float


def load() -> Schemas:
    """Returns the classes of the messages.

    Raises:
        MissingExtra: the messages, or the library that writes them, are not installed.
    """

    def library(module: str) -> Any:
        return import_extra(module, "logs", "a log in an MCAP file")

    for module in ("mcap.writer", "mcap_protobuf.schema"):
        library(module)
    found = {name: getattr(library(f"foxglove_schemas_protobuf.{name}_pb2"), name) for name in NAMES}
    return SimpleNamespace(**found, Timestamp=library("google.protobuf.timestamp_pb2").Timestamp)


def anchors(model: pin.Model) -> list[Anchor]:
    """Returns a named frame for each joint, the world's first: its first body where it has one."""
    found = [Anchor(WORLD, STAY)]
    for joint in range(1, model.njoints):
        bodies = (frame for frame in model.frames if frame.parentJoint == joint and frame.type == BODY)
        frame = next(bodies, None)
        found.append(Anchor(model.names[joint], STAY) if frame is None else Anchor(frame.name, frame.placement))
    return found


def frames(robot: Robot) -> dict[str, int]:
    """Returns names of links, of joints without any, and of toes, with their numbers among the model's frames."""
    model = robot.model
    links = {frame.name: number for number, frame in enumerate(model.frames) if frame.type == BODY}
    there = {int(model.frames[number].parentJoint) for number in links.values()}
    joints = (name for name in list(model.names)[1:] if model.existFrame(name))  # a chain's in space have no frames
    bare = {name: int(model.getFrameId(name)) for name in joints}
    bare = {name: number for name, number in bare.items() if int(model.frames[number].parentJoint) not in there}
    found = {**bare, **links, **{toe: robot.toe_id(toe) for toe in robot.toes}}
    return {name: number for name, number in found.items() if name != WORLD}


def transforms(schemas: Schemas, data: pin.Data, numbers: Mapping[str, int], time: int) -> Any:
    """Returns places of frames in the world."""
    message = schemas.FrameTransforms()
    for name, number in numbers.items():
        place = data.oMf[number]
        message.transforms.append(
            schemas.FrameTransform(
                timestamp=stamp(schemas, time),
                parent_frame_id=WORLD,
                child_frame_id=name,
                translation=_vector(schemas, place.translation),
                rotation=_rotation(schemas, place.rotation),
            )
        )
    return message


def joints_of(model: pin.Model, q: Array, v: Array, a: Array, effort: Array) -> list[JointState]:
    """Returns states of the joints that turn or slide about one axis."""
    found = []
    for name, joint in list(zip(model.names, model.joints, strict=True))[1:]:
        if joint.nv == 1:
            at, row = q[joint.idx_q : joint.idx_q + joint.nq], joint.idx_v
            position = float(at[0] if joint.nq == 1 else np.arctan2(at[1], at[0]))
            found.append(JointState(name, position, float(v[row]), float(a[row]), float(effort[row])))
    return found


def uncut(cut: Cut, states: Iterable[JointState]) -> list[JointState]:
    """Returns states of the joints of the robot from which a cut came: those that turn with it, and fixed ones.

    If a pair of legs is one leg in the plane, each leg has half the effort.
    """
    there = {state.name: state for state in states}
    found = [JointState(name, 0.0, 0.0, 0.0, 0.0) for name in cut.held]
    for name, turns in cut.angles.items():
        state = there.get(name)
        if state is None:  # locked
            found += [JointState(turn.joint, turn.zero, 0.0, 0.0, 0.0) for turn in turns]
            continue
        found += [
            JointState(
                turn.joint,
                turn.zero + turn.sign * state.position,
                turn.sign * state.velocity,
                turn.sign * state.acceleration,
                turn.sign * state.effort / len(turns),
            )
            for turn in turns
        ]
    return list({state.name: state for state in found}.values())


def joint_states(schemas: Schemas, states: Iterable[JointState], time: int) -> Any:
    """Returns states of joints as a message."""
    joints = [schemas.JointState(**vars(state)) for state in states]
    return schemas.JointStates(timestamp=stamp(schemas, time), joints=joints)


def log(schemas: Schemas, message: str, name: str, time: int) -> Any:
    """Returns a line of a log."""
    return schemas.Log(timestamp=stamp(schemas, time), level=schemas.Log.INFO, message=message, name=name)


def scene(schemas: Schemas, shapes: Sequence[Shape], anchored: Sequence[Anchor], time: int) -> Any:
    """Returns shapes, each moving with the frame that its joint is anchored by."""
    update = schemas.SceneUpdate()
    for number, anchor in enumerate(anchored):
        those = [shape for shape in shapes if shape.joint == number]
        if those:
            entity = _entity(schemas, f"robot {anchor.name}", anchor.name, time)
            for shape in those:
                _add(schemas, entity, shape, anchor.placement.inverse().homogeneous @ shape.placement)
            update.entities.append(entity)
    return update


def arrows(schemas: Schemas, drawn: Iterable[tuple[str, Array, Array | None]], time: int) -> Any:
    """Returns arrows at toes: name, place in the world, and direction with length, in m, or None if there is none."""
    update = schemas.SceneUpdate()
    for name, place, along in drawn:
        entity = _entity(schemas, f"force {name}", WORLD, time)
        if along is not None:
            length = float(np.linalg.norm(along))
            turn = pin.Quaternion.FromTwoVectors(np.array([1.0, 0.0, 0.0]), along)
            head = min(2.0 * HEAD, 0.4 * length)
            entity.arrows.append(
                schemas.ArrowPrimitive(
                    pose=_pose(schemas, place, turn.matrix()),
                    shaft_length=length - head,
                    shaft_diameter=SHAFT,
                    head_length=head,
                    head_diameter=HEAD,
                    color=_color(schemas, (*ARROW_COLOR, 1.0)),
                )
            )
        update.entities.append(entity)
    return update


def strip(schemas: Schemas, name: str, line: Array, half: float, color: Sequence[float], time: int) -> Any:
    """Returns a surface along a line of places (x, z) in the world, (n, 2), up to `half` to either side, in m."""
    update, entity = schemas.SceneUpdate(), _entity(schemas, name, WORLD, time)
    sides = [schemas.Point3(x=x, y=y, z=z) for x, z in line.tolist() for y in (-half, half)]
    pieces = [(2 * i + np.array([[0, 2, 3], [0, 3, 1]])).ravel() for i in range(len(line) - 1)]
    entity.triangles.append(
        schemas.TriangleListPrimitive(
            pose=_pose(schemas, np.zeros(3), np.eye(3)),
            points=sides,
            indices=np.concatenate(pieces).tolist(),
            color=_color(schemas, color),
        )
    )
    update.entities.append(entity)
    return update


def stamp(schemas: Schemas, time: int) -> Any:
    """Returns a time stamp for a time in ns."""
    seconds, nanos = divmod(time, 1_000_000_000)
    return schemas.Timestamp(seconds=seconds, nanos=nanos)


def _entity(schemas: Schemas, name: str, frame: str, time: int) -> Any:
    return schemas.SceneEntity(timestamp=stamp(schemas, time), frame_id=frame, id=name, frame_locked=True)


def _add(schemas: Schemas, entity: Any, shape: Shape, placement: Array) -> None:
    color = _color(schemas, shape.color)
    scale = np.linalg.norm(placement[:3, :3], axis=0)  # of a mesh or an ellipsoid
    if shape.mesh is not None:
        corners = shape.mesh.vertices @ placement[:3, :3].T + placement[:3, 3]
        entity.triangles.append(
            schemas.TriangleListPrimitive(
                pose=_pose(schemas, np.zeros(3), np.eye(3)),
                points=[schemas.Point3(x=x, y=y, z=z) for x, y, z in corners.tolist()],
                indices=np.ravel(shape.mesh.faces).tolist(),
                color=color,
            )
        )
        return
    pose = _pose(schemas, placement[:3, 3], placement[:3, :3] / scale)
    if shape.kind == "box":
        entity.cubes.append(schemas.CubePrimitive(pose=pose, size=_vector(schemas, shape.size), color=color))
    elif shape.kind == "cylinder":
        radius, length = shape.size
        size = _vector(schemas, (2.0 * radius, 2.0 * radius, length))
        entity.cylinders.append(
            schemas.CylinderPrimitive(pose=pose, size=size, bottom_scale=1.0, top_scale=1.0, color=color)
        )
    else:
        size = _vector(schemas, 2.0 * shape.size[0] * scale)
        entity.spheres.append(schemas.SpherePrimitive(pose=pose, size=size, color=color))


def _pose(schemas: Schemas, place: Array, rotation: Array) -> Any:
    return schemas.Pose(position=_vector(schemas, place), orientation=_rotation(schemas, rotation))


def _vector(schemas: Schemas, values: Any) -> Any:
    x, y, z = map(float, values)
    return schemas.Vector3(x=x, y=y, z=z)


def _rotation(schemas: Schemas, matrix: Array) -> Any:
    x, y, z, w = map(float, pin.Quaternion(np.array(matrix)).coeffs())
    return schemas.Quaternion(x=x, y=y, z=z, w=w)


def _color(schemas: Schemas, rgba: Sequence[float]) -> Any:
    red, green, blue, alpha = map(float, rgba)
    return schemas.Color(r=red, g=green, b=blue, a=alpha)
