"""Springs that never release as tendons of an MJCF file, where MuJoCo has such springs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree

from spear_pin.arrays import Array
from spear_pin.model.cable import Between, Cabled, Over
from spear_pin.model.mjcf_adding import UNTOUCHED, add, place
from spear_pin.model.path import Joints
from spear_pin.model.postures import home
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import WORLD, RobotPosture, find_carrier
from spear_pin.model.spring import Spring
from spear_pin.printable import printable

LOOSE = -1e6  # rad or m: a spring that only pulls has no force between this length and its rest
SITE = 0.003  # m, radius of an end that is shown
WIDTH = 0.01  # m, half of a pulley's
ANGLES = 61  # of a joint, at which the bend of a cable about a pulley is looked at
SPARE = 0.05  # rad
LATCHED = "a switch releases it, which MJCF cannot say"
UNDAMPED = "its damper, which acts in stance only, is left out"


def springs_of(robot: Robot) -> dict[str, Spring]:
    """Returns the springs that a robot's file gives it, each with its path: a knee's grows with its flexion."""
    legs, found = {leg.knee: leg for leg in robot.legs}, {}
    for name, spring in robot.settings.springs.items():
        if spring.path is None and name in legs:
            side, zero = float(legs[name].side), legs[name].knee_zero
            rest = None if spring.rest is None else spring.rest + side * zero
            spring = replace(spring, path=Joints({name: 1.0}, side), rest=rest)
        found[name] = spring
    return found


def list_left_out_springs(robot: Robot, springs: Mapping[str, Spring]) -> list[str]:
    """Returns a line for each spring of which a file for MuJoCo has not all."""
    reasons = {name: _reason(robot, spring) or UNDAMPED * bool(spring.damping) for name, spring in springs.items()}
    return [f"spring {printable(name)}: {reason}" for name, reason in reasons.items() if reason]


def add_springs(robot: Robot, springs: Mapping[str, Spring], root: Any, elements: list[Any]) -> None:
    """Adds tendons, the sites and pulleys of those in space, and comments about what is left out.

    Args:
        robot: the robot.
        springs: springs by name, each with its path.
        root: the file's root.
        elements: its bodies by their joints, the world's first.
    """
    for line in list_left_out_springs(robot, springs):
        elements[0].addprevious(etree.Comment(f" {line.replace('-', '_')} "))
    said = [(printable(name), spring) for name, spring in springs.items() if spring.pulls]
    written = {name: spring for name, spring in said if not _reason(robot, spring)}
    tendons = add(root, "tendon") if written else None
    for name, spring in written.items():
        rests = (LOOSE, spring.rest) if spring.unilateral else (spring.rest,)
        law: dict[str, Any] = {"name": name, "stiffness": spring.stiffness, "springlength": rests}
        if isinstance(spring.path, Joints):
            tendon = add(tendons, "fixed", **law)
            for joint, weight in spring.path.weights:
                add(tendon, "joint", joint=joint, coef=spring.path.side * weight)
        elif isinstance(spring.path, Cabled):
            tendon = add(tendons, "spatial", **law, width=SITE)
            _add_course(robot, name, spring.path, tendon, elements)


def _reason(robot: Robot, spring: Spring) -> str:
    """Returns why MuJoCo has no such spring; empty if it has."""
    path = spring.path
    if spring.clutch is not None or spring.rest is None:
        return LATCHED
    if type(spring) is not Spring or spring.hardening or spring.preload or spring.table or spring.hysteresis:
        return "its law is not linear"
    if not isinstance(path, Joints | Between | Over | None):
        return f"no tendon runs along a {type(path).__name__}"
    joints = [joint for joint, _ in path.weights] if isinstance(path, Joints) else []
    frames = {*path.frames} - {WORLD} if path is not None else set()
    if path is None or not {*joints} <= {*robot.model.names} or not all(map(robot.model.existFrame, frames)):
        return "only a gait tells which parts of a leg it joins"
    if isinstance(path, Over) and _beside(robot, path) is None:
        return "its pulley turns too far for a tendon to stay on its side"
    return ""


def _add_course(robot: Robot, name: str, path: Cabled, tendon: Any, elements: list[Any]) -> None:
    """Adds the points of a spring's tendon, and its pulley."""
    for end, anchor in path.anchors().items():
        joint, at = find_carrier(robot, anchor)
        if isinstance(path, Over) and end == "centre":
            _add_pulley(robot, name, path, tendon, elements[joint])
            continue
        site = f"{name}_{end}"
        add(elements[joint], "site", name=site, pos=at, size=SITE)
        add(tendon, "site", site=site)


def _add_pulley(robot: Robot, name: str, path: Over, tendon: Any, body: Any) -> None:
    """Adds a pulley to a body and to a tendon, and a point beside it on the tendon's side."""
    joint, centre = find_carrier(robot, path.centre)
    data = robot.model.createData()
    pin.forwardKinematics(robot.model, data, home(robot))
    axis = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), data.oMi[joint].rotation[1])
    pulley, side, placed = f"{name}_pulley", f"{name}_side", place(pin.SE3(axis.matrix(), centre))
    add(body, "geom", name=pulley, type="cylinder", size=(path.radius, WIDTH), **placed, **UNTOUCHED)
    beside = _beside(robot, path)
    assert beside is not None
    add(body, "site", name=side, pos=beside, size=SITE, group="4")
    add(tendon, "geom", geom=pulley, sidesite=side)


def _beside(robot: Robot, path: Over) -> Array | None:
    """Returns a point, (3,), in m, in the frame of a pulley's joint, by which MuJoCo keeps a tendon on its side.

    Its direction from the pulley is at an angle β from that end of the cable which turns with the pulley. With φ as in
    `Over`, MuJoCo takes the other side where φ - β exceeds π, or, while the cable is free, where β exceeds (π + φ)/2.
    None if there is no such angle within the limits of the joint, or none of the ends turns with the pulley.
    """
    model, posture = robot.model, RobotPosture(robot, None)
    (start, _), (joint, _), (end, _) = (find_carrier(robot, each) for each in path.anchors().values())
    indices = path.indices(posture)
    if joint not in (start, end) or len(indices) != 1:
        return None
    entry = next(each.idx_q for each in model.joints if each.nv and each.idx_v == indices[0])
    least, most = np.clip([model.lowerPositionLimit[entry], model.upperPositionLimit[entry]], -np.pi, np.pi)
    bends = []
    for angle in np.linspace(least, most, ANGLES):
        q = home(robot)
        q[entry] = angle
        tip, centre, other = (np.array(each.seen(posture.at(q)).position) for each in path.anchors().values())
        arms = [np.arctan2(*(each - centre)[[2, 0]]) for each in (tip, other)]
        bends.append(float(path.side * (arms[1] - arms[0]) % (2.0 * np.pi)))
    low, high = max(bends) - np.pi, 0.5 * (np.pi + min(bends))
    if high - low < SPARE:
        return None
    turn = 0.5 * path.side * (low + high)
    direction = arms[1] - turn if joint == end else arms[0] + turn
    data = model.createData()
    pin.forwardKinematics(model, data, q)
    beside = centre + 2.0 * path.radius * np.array([np.cos(direction), 0.0, np.sin(direction)])
    return np.asarray(data.oMi[joint].actInv(beside))
