"""A robot as an SRDF file: data for planners that a URDF leaves out, and rotors for Pinocchio."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lxml import etree
from numpy.typing import ArrayLike

from spear_pin.errors import BadValue
from spear_pin.kinds import typed
from spear_pin.model.document import document
from spear_pin.model.legs import leg_name
from spear_pin.model.postures import check_configuration, home
from spear_pin.model.robot import Robot
from spear_pin.printable import printable

EVERYTHING = "all"  # the group of every joint
NOTE = """
  Written by spear_pin, to go with the URDF of the robot. Units are SI and radians.
  Pinocchio's loadRotorParameters reads rotor_params; mass is its word for the inertia of a rotor, in kg m^2.
"""


@typed
def to_srdf(robot: Robot, postures: Mapping[str, ArrayLike] | None = None) -> str:
    """Writes the text of an SRDF file that goes with the robot's URDF.

    It has a group and an end effector for each leg, a group "all", the postures, the pairs of adjacent links, which
    may touch, and for Pinocchio the rotors' inertias and gear ratios.

    Args:
        robot: the robot, unchanged from its URDF.
        postures: configurations, (nq,) each, by name, in addition to "home" (see `postures.home`).

    Raises:
        BadValue: joints of the robot are locked, or numbers varied; or a posture has not nq numbers.
        BadFile: its URDF is gone.
    """
    if robot.cut is not None:
        expected = f"a robot with a URDF, such as {robot.cut.of}, out of which it is cut; MJCF needs none"
        raise BadValue("robot", robot.source, expected)
    if robot.locked or robot.varied:
        raise BadValue("robot", robot, "a robot as its URDF describes it, with nothing locked or varied")
    urdf = document(robot)
    root = etree.Element("robot", name=urdf.get("name", printable(robot.name)))
    root.append(etree.Comment(NOTE))
    parents = {joint.find("child").get("link"): joint for joint in urdf.findall("joint")}
    everything = etree.SubElement(root, "group", name=EVERYTHING)
    for joint in list(robot.model.names)[1:]:
        etree.SubElement(everything, "joint", name=joint)
    for toe in robot.toes:
        base = _hip_link(robot, parents, toe)
        if base is not None:
            group = etree.SubElement(root, "group", name=leg_name(toe))
            etree.SubElement(group, "chain", base_link=base, tip_link=toe)
            carrier = parents[toe].find("parent").get("link")
            etree.SubElement(root, "end_effector", name=toe, parent_link=carrier, group=leg_name(toe))
    for name, q in {"home": home(robot), **(postures or {})}.items():
        _add_posture(robot, root, name, q)
    for child, joint in parents.items():
        pair = {"link1": joint.find("parent").get("link"), "link2": child}
        etree.SubElement(root, "disable_collisions", **pair, reason="Adjacent")
    rotors = etree.SubElement(root, "rotor_params")
    for joint in robot.actuated:
        inertia = float(robot.model.rotorInertia[robot.index(joint)])
        if inertia:  # a rotor that is not known is left out
            ratio = repr(robot.gear_ratio(joint))
            etree.SubElement(rotors, "joint", name=joint, mass=repr(inertia), gear_ratio=ratio)
    return str(etree.tostring(root, encoding="unicode", pretty_print=True))


def _hip_link(robot: Robot, parents: Mapping[str, Any], toe: str) -> str | None:
    """Returns the link that carries the first motor on the way to a toe; None if there is none."""
    found, link = None, toe
    while link in parents:
        joint = parents[link]
        link = joint.find("parent").get("link")
        if joint.get("name") in robot.actuated:
            found = link
    return found


def _add_posture(robot: Robot, root: Any, name: str, q: ArrayLike) -> None:
    values = check_configuration(robot, name, q)
    state = etree.SubElement(root, "group_state", name=name, group=EVERYTHING)
    for joint, kind in list(zip(robot.model.names, robot.model.joints, strict=True))[1:]:
        numbers = " ".join(repr(float(value)) for value in values[kind.idx_q : kind.idx_q + kind.nq])
        etree.SubElement(state, "joint", name=joint, value=numbers)
