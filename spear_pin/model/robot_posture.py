"""A robot at a configuration by Pinocchio, for the paths of springs; and the coordinates that move a path."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.model.cable import Anchor
from spear_pin.model.directions import WORLD_ALIGNED
from spear_pin.model.frames import frame_id
from spear_pin.model.path import Joints, Path, Point
from spear_pin.model.robot import Robot

Lever = tuple[tuple[int, float], ...]
"""A path's lever on each coordinate that it spans, with the coordinate's index."""

WORLD = "universe"
TRIED = 3  # postures at which a path is checked


class RobotPosture:
    """A robot at a configuration, as `path.Posture` describes it.

    Args:
        robot: a robot whose joints have one coordinate each.
        ops: elementary functions of numbers.
    """

    def __init__(self, robot: Robot, ops: Any) -> None:
        self._robot, self.ops = robot, ops
        self._index = {name: i for i, name in enumerate(robot.coordinates)}
        self._frames: dict[str, int] = {}
        self.at(np.zeros(robot.nv))

    def at(self, q: Array) -> RobotPosture:
        """Moves the robot to a configuration, (nv,)."""
        self._q, self._placed = q, False
        return self

    def index(self, joint: str) -> int:
        """Returns the index of a coordinate."""
        return self._index[joint] if joint in self._index else self._robot.index(joint)

    def angle(self, joint: str) -> float:
        """Returns the value of a coordinate, in rad or m."""
        return float(self._q[self.index(joint)])

    def point(self, frame: str, at: Sequence[Any]) -> Point:
        """Returns a point that a frame carries, given in the frame's axes, in m."""
        model, data = self._robot.model, self._data
        if not self._placed:
            pin.computeJointJacobians(model, data, self._q)
            self._placed = True
        index = self._frame(frame)
        placement = pin.updateFramePlacement(model, data, index)
        arm = placement.rotation @ np.array(at)
        jacobian = pin.getFrameJacobian(model, data, index, WORLD_ALIGNED)
        velocity = jacobian[:3] - pin.skew(arm) @ jacobian[3:]
        carried = [model.joints[joint].idx_v for joint in model.supports[model.frames[index].parentJoint] if joint]
        columns = {i: tuple(velocity[:, i].tolist()) for i in carried}
        return Point(tuple((placement.translation + arm).tolist()), columns)

    @cached_property
    def _data(self) -> pin.Data:
        return pin.Data(self._robot.model)

    def _frame(self, frame: str) -> int:
        if frame not in self._frames:
            self._frames[frame] = 0 if frame == WORLD else frame_id(self._robot.model, frame)
        return self._frames[frame]


def find_carrier(robot: Robot, anchor: Anchor) -> tuple[int, Array]:
    """Returns the joint that carries an anchor, 0 for the world, and its place in the joint's frame, (3,), in m.

    Raises:
        UnknownName: there is no such frame.
    """
    x, y, z = anchor.at
    at = np.array([anchor.side * x, y, z])
    if anchor.body == WORLD:
        return 0, at
    frame = robot.model.frames[frame_id(robot.model, anchor.body)]
    return int(frame.parentJoint), np.asarray(frame.placement.act(at))


@lru_cache(maxsize=256)
def row_along(path: Joints, robot: Robot) -> Array:
    """Returns the lever of a path over joints on each coordinate, (nv,)."""
    row = np.zeros(robot.nv)
    for index, lever in path.slope(RobotPosture(robot, None)).items():
        row[index] = lever
    row.setflags(write=False)
    return row


def lever_along(path: Joints, robot: Robot) -> Lever:
    """Returns the lever of a path over joints on the coordinates that it spans."""
    return tuple((i, lever) for i, lever in enumerate(row_along(path, robot).tolist()) if lever)


@lru_cache(maxsize=256)
def find_spanned(path: Path, robot: Robot) -> tuple[str, ...]:
    """Returns the names of the coordinates on which a path's length depends, in their order; checks the path.

    Raises:
        UnknownName: there is no such joint or frame.
        BadValue: the path does not fit the robot, or its length never changes.
    """
    some = np.random.default_rng(0).uniform(-0.5, 0.5, (TRIED, robot.nv))
    postures = [RobotPosture(robot, None).at(q) for q in some]
    path.check(postures)
    names = tuple(robot.coordinates[i] for i in path.indices(postures[0]))
    if not names:
        raise BadValue("path", path, "one whose length changes as joints move")
    return names
