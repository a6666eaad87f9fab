"""Closed loops in MJCF files: a pin is a `<connect>` of two points, a belt a `<joint>` of `<equality>`."""

from __future__ import annotations

from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.model.frames import frame_id
from spear_pin.model.loops import Loop
from spear_pin.model.mjcf_adding import add
from spear_pin.model.mjcf_motors import MOVABLE
from spear_pin.model.mjcf_sections import section
from spear_pin.model.mjcf_springs import SITE
from spear_pin.model.mjcf_writing import Writing
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import WORLD
from spear_pin.printable import printable

CALLED = ("name", "body1", "site1", "joint1")  # attributes after which a loop is called, the first that it has
LINEAR = (0.0, 1.0, 0.0, 0.0, 0.0)  # MuJoCo's own polynomial
PAIR = 2  # joints that MuJoCo ties
MOST = 50  # equality constraints that are read: to close more takes long


def read_loops(writing: Writing) -> tuple[dict[str, dict[str, Any]], list[Any]]:
    """Reads the loops as tables of a TOML file, by name; equality constraints that are none are noted in `writing`.

    Returns:
        the tables, and the elements that are noted.
    """
    found: dict[str, dict[str, Any]] = {}
    others, elements = [], section(writing.root, "equality")
    flags = [flag for flag in section(writing.root, "option") if flag.tag == "flag"]
    off = any(flag.get(each) == "disable" for flag in flags for each in ("equality", "constraint"))
    for element in elements:
        said = writing.defaults.of(element)
        name = next((element.get(each) for each in CALLED if element.get(each)), "")
        if len(elements) > MOST:
            table: dict[str, Any] | str = f"which has more than {MOST}"
        elif off or said.get("active") == "false":
            table = "which is off"
        elif element.tag == "connect":
            table = _pin(writing, element, said)
        elif element.tag == "joint":
            table = _belt(writing, element, said)
        else:
            table = "which is no pin or belt"
        if isinstance(table, str):
            writing.unread.lose(f"<{element.tag}>", "", f"<equality>, {table}", name)
            others.append(element)
            continue
        while name in found:
            name += "_"
        found[name] = table
    return found, others


def _pin(writing: Writing, element: Any, said: dict[str, str]) -> dict[str, Any] | str:
    """Returns the table of a pin, or why it is none."""
    sites = [said[each] for each in ("site1", "site2") if each in said]
    if len(sites) == 2:
        bodies = {body.get("name") for body in writing.root.iter("body")}
        if twice := bodies & {*sites}:
            return f"whose site {twice.pop()!r} is called as a body"
        fixed = {each.get("name"): each for each in section(writing.root, "worldbody") if each.tag == "site"}
        ends = [{"body": site, "at": (0.0, 0.0, 0.0)} for site in sites]
        for i, site in enumerate(sites):
            if site in fixed:
                place = {"pos": "0 0 0", **writing.defaults.of(fixed[site])}
                ends[i] = {"body": WORLD, "at": writing.counted(fixed[site], place, "pos")}
        return dict(zip("ab", ends, strict=True))
    if not {"body1", "anchor"} <= {*said}:
        return "which has neither body1 and anchor nor site1 and site2"
    first, second = (WORLD if each == "world" else each for each in (said["body1"], said.get("body2", "world")))
    return {"a": {"body": first, "at": writing.counted(element, said, "anchor")}, "b": {"body": second}}


def _belt(writing: Writing, element: Any, said: dict[str, str]) -> dict[str, Any] | str:
    """Returns the table of a belt, or why it is none."""
    joints = [said[each] for each in ("joint1", "joint2") if each in said]
    if len({*joints}) < PAIR or any(writing.joints.get(each) not in MOVABLE for each in joints):
        return "which ties no two joints that turn or slide"
    given = writing.values(element, said.get("polycoef", "0"))
    offset, slope, *higher = (*given, *LINEAR[len(given) :])
    if offset or not slope or any(higher):
        return "whose polynomial is not linear without an offset"
    return {"joints": {joints[0]: 1.0, joints[1]: -slope}}


def list_left_out_loops(robot: Robot) -> list[str]:
    """Returns a line for each loop that a file for MuJoCo has not."""
    return [
        f"loop {printable(loop.name)}: MuJoCo ties two joints, not {len(loop.joints)}"
        for loop in robot.loops
        if len(loop.joints) > PAIR
    ]


def add_loops(robot: Robot, root: Any, elements: list[Any]) -> None:
    """Adds the loops of a robot, with a site at each end of a pin.

    Args:
        robot: the robot.
        root: the file's root.
        elements: its bodies by their joints, the world's first.
    """
    written = [loop for loop in robot.loops if len(loop.joints) <= PAIR]
    equality = add(root, "equality") if written else None
    for loop in written:
        name = printable(loop.name)
        if loop.ends:
            sites = {f"site{i}": f"{name}_site{i}" for i in (1, 2)}
            for site, (joint, at) in zip(sites.values(), _ends(robot, loop), strict=True):
                add(elements[joint], "site", name=site, pos=at, size=SITE)
            add(equality, "connect", name=name, **sites)
        else:
            (first, weight), (second, other) = loop.joints
            slope = (0.0, -other / weight, 0.0, 0.0, 0.0)
            add(equality, "joint", name=name, joint1=first, joint2=second, polycoef=slope)


def _ends(robot: Robot, loop: Loop) -> list[tuple[int, Any]]:
    """Returns joint and place of both ends of a pin; the second is moved along y to where the first is."""
    model, data = robot.model, robot.model.createData()
    pin.framesForwardKinematics(model, data, pin.neutral(model))
    frames = [frame_id(model, end) for end in loop.ends]
    joints = [int(model.frames[frame].parentJoint) for frame in frames]
    points = [np.array(data.oMf[frame].translation) for frame in frames]
    points[1][1] = points[0][1]
    return [(joint, data.oMi[joint].actInv(point)) for joint, point in zip(joints, points, strict=True)]
