"""Reads closed loops from tables, puts their ends into the model as frames, and checks that they can close and move."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName, list_names
from spear_pin.model.cable import Anchor
from spear_pin.model.frames import POINT, frame_id
from spear_pin.model.loops import DEPENDENT, Loop
from spear_pin.model.path_data import keys_of
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import WORLD

ENDS = ("a", "b")
STARTS = 8  # configurations from which the loops are tried to close


def loop_of(name: str, table: Mapping[str, Any], model: pin.Model) -> Loop:
    """Returns a loop from its table; adds a frame to the model for each end of a pin.

    Raises:
        BadValue: a key or a value is not valid, or both ends are on one body.
        UnknownName: there is no such body or joint.
    """
    if "joints" in table:
        keys_of("a loop of joints", table, ("joints",), ())
        return Loop(name, joints=_tied(table["joints"], model))
    keys_of("a loop", table, ENDS, ())
    start, other = Anchor(**keys_of("a", table["a"], ("body", "at"), ())), keys_of("b", table["b"], ("body",), ("at",))
    carriers = [0 if body == WORLD else frame_id(model, body) for body in (start.body, other["body"])]
    if model.frames[carriers[0]].parentJoint == model.frames[carriers[1]].parentJoint:
        raise BadValue("b", table["b"], f"a point of another body than {start.body}, which moves against it")
    end = Anchor(**{"at": _met(model, carriers, start), **other})
    return Loop(
        name, ends=(_marked(model, f"{name}_a", carriers[0], start), _marked(model, f"{name}_b", carriers[1], end))
    )


def _met(model: pin.Model, carriers: Sequence[int], start: Anchor) -> Array:
    """Returns the point of the second frame, (3,), that is at a point of the first where all coordinates are zero."""
    data = model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    first, second = (data.oMf[carrier] for carrier in carriers)
    return np.asarray(second.actInv(first.act(np.array(start.at))))


def _marked(model: pin.Model, name: str, carrier: int, end: Anchor) -> str:
    """Adds the frame of an end of a loop to the model, and returns its name."""
    frame = model.frames[carrier]
    if any(each.name == name for each in model.frames):
        raise BadValue(
            "the loop's name",
            name[:-2],
            f"a name that is free, such as {name[:-2] + '_loop'!r}: the robot has a frame {name!r}",
        )
    placement = frame.placement * pin.SE3(np.eye(3), np.array(end.at, dtype=float))
    model.addFrame(pin.Frame(name, frame.parentJoint, carrier, placement, POINT, pin.Inertia.Zero()), False)
    return name


def _tied(given: Any, model: pin.Model) -> tuple[tuple[str, float], ...]:
    single = [name for name, joint in zip(model.names, model.joints, strict=True) if joint.nv == 1]
    for joint, weight in given.items():
        if joint not in single:
            raise UnknownName("joint", joint, single)
        if type(weight) not in (int, float) or not weight or not math.isfinite(weight):
            raise BadValue(f"joints.{joint}", weight, "a weight, a finite number other than 0")
    if len(given) < 2:
        raise BadValue("joints", given, "at least two joints with their weights")
    return tuple((joint, float(weight)) for joint, weight in given.items())


def check_loops(robot: Robot) -> None:
    """Checks that a robot's loops can close, that no row depends on others, and which coordinates are independent.

    Raises:
        BadValue: they cannot, or the independent coordinates do not determine the others.
        UnknownName: an independent coordinate is not tied by a loop.
    """
    closure, names = robot.closure, [loop.name for loop in robot.loops]
    if not names:
        return
    if closure is None:
        turns = "" if robot.nq == robot.nv else ", none of whose joints is continuous"
        raise BadValue("loops", names, f"loops of a robot that moves in the x-z plane alone{turns}")
    starts = np.random.default_rng(0).uniform(-1.0, 1.0, (STARTS, robot.nv))
    starts[0] = 0.0
    found = [q for q in map(closure.closed, starts) if np.isfinite(q).all()]
    if not found:
        gap = float(np.abs(closure.at(starts[0])[0]).max())
        raise BadValue(
            "loops", names, f"loops that can close: their ends are {gap:.3g} m apart at zero angles, and stay apart"
        )
    sizes = [np.linalg.svd(closure.at(q)[1], compute_uv=False) for q in found]
    if all((each <= DEPENDENT * each[0]).any() for each in sizes):
        expected = (
            "loops of which none follows from the others: one is given twice, or bodies cannot move against each other"
        )
        raise BadValue("loops", names, expected)
    tied = closure.tied
    said = robot.settings.independent
    for name in said:
        if name not in tied:
            raise UnknownName("independent joint in a loop", name, tied)
    count, own = len(tied) - closure.size, [name for name in tied if name in robot.independent]
    if count < 1:
        raise BadValue(
            "loops", names, f"loops that leave a joint of {list_names(tied)} free to move: these make them rigid"
        )
    if len(own) != count:
        some = str([*tied[:count]]).replace("'", '"')
        expected = f"{count} of {list_names(tied)}, which determine the others: name them, as independent = {some}"
        raise BadValue("independent", own, expected)
    free = [name not in robot.independent for name in robot.coordinates]
    if all(np.linalg.svd(closure.at(q)[1][:, free], compute_uv=False)[-1] <= DEPENDENT for q in found):
        raise BadValue("independent", own, f"joints that determine the others of {list_names(tied)}")
