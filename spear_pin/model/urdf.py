"""Reads a URDF safely: checks it, reduces it to the data for the dynamics, fetches and expands nothing.

Pinocchio's parser drops an inertia it cannot read, complains on stderr about shapes it does not
need, and orders the joints of a fork by name. So this module writes a URDF for it, with only the
links' inertias and the joints, numbers in one notation, and numbered joints.
"""

from __future__ import annotations

import math
import sys
from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from lxml import etree

from spear_pin.errors import BadFile
from spear_pin.model.elements import MAX_NUMBER, child, fault, number, numbers, parse
from spear_pin.model.gears import Gear
from spear_pin.model.grammars import URDF
from spear_pin.model.inertial import Fault, copy_inertial, notes_on
from spear_pin.model.origins import copy_origin, turn_quaternions
from spear_pin.model.transmissions import read_transmissions
from spear_pin.model.unread import Unread, find_unread

MAX_LINKS = 500
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")
AXLESS = ("fixed", "floating")  # joints whose axis means nothing
SEVERAL = ("floating", "planar")  # of several degrees of freedom, to which one damping does not apply
NOT_NEGATIVE = ("effort", "velocity", "damping", "friction")  # numbers of joints
LIMITS = ("lower", "upper", "effort", "velocity")
OPEN = {"lower": "-inf", "upper": "inf"}  # limits where a file says the other one alone
UNLIMITED = -1.0  # an effort or a velocity that is not limited
NORMAL = (1.0, 0.0, 0.0)  # axis of a joint that names none
UNIVERSE = "universe"
BASE, WORLD = "base", "world"  # the joint and the link that are put under a root that is to float
Base = Literal["free", "fixed"]


@dataclass(frozen=True)
class Urdf:
    """Contents of a URDF that the dynamics needs.

    Attributes:
        path: path of the file.
        name: the robot's name.
        root: name of its root link.
        document: the whole of it, without comments.
        text: links and joints only; joint i of the document is called "i:" and its name.
        transmissions: the motors, by joint.
        normals: normals of planar joints, by joint, (3,).
        notes: differences from the file, a line each.
    """

    path: Path
    name: str
    root: str
    document: str
    text: str
    transmissions: Mapping[str, Gear]
    normals: Mapping[str, tuple[float, ...]]
    notes: tuple[str, ...] = ()


def read_urdf(path: str | Path, base: Base | None = None, repair: bool = False) -> Urdf:
    """Reads and checks a URDF.

    Args:
        path: path of the file.
        base: "free" puts a floating joint under the root link, unless there is one; "fixed" fixes an existing one.
        repair: whether to repair inertias that no body can have.

    Raises:
        BadFile: the file is missing, not XML, declares a document type or entities, is no tree of
            links, has an invalid inertia, or a transmission that contradicts itself. The text
            names the place.
    """
    return urdf_of(*parse(path), base, repair)


def urdf_of(path: Path, root: Any, base: Base | None = None, repair: bool = False) -> Urdf:
    """Makes a description from the root element of the file, for `read_urdf`."""
    if root.tag == "mujoco":
        raise BadFile(path, "is an MJCF file; expected a URDF")
    if root.tag != "robot":
        raise BadFile(path, f"the root element is <{root.tag}>; expected <robot>, or <mujoco>", root.sourceline)
    _check_expanded(path, root)
    if len(root.findall("link")) > MAX_LINKS:
        raise BadFile(path, f"has {len(root.findall('link'))} links; at most {MAX_LINKS} are read")
    turn_quaternions(path, root)
    trunk = _check_tree(path, root)
    document = str(etree.tostring(root, encoding="unicode"))
    motors = read_transmissions(path, root)
    text, changed = _dynamics(path, root, trunk, base, repair)
    normals = {joint.get("name"): _normal(path, joint) for joint in root.findall("joint[@type='planar']")}
    notes = [*changed, *_half_limited(root), *motors.notes, *filter(None, [_unread(root, motors.elements)])]
    return Urdf(path, root.get("name") or path.stem, trunk, document, text, motors.gears, normals, tuple(notes))


def _unread(root: Any, known: tuple[Any, ...] = ()) -> str | None:
    """Returns one line about unused data."""
    unread = Unread()
    find_unread(root, URDF, unread, known=known)
    for joint in root.xpath("joint[@type='floating' or @type='planar']"):
        for element in joint.xpath("dynamics[@damping]"):
            if URDF.unusual("damping", element.get("damping")):
                unread.lose("damping", joint.get("name"), "<dynamics>")
        for element in joint.findall("limit"):
            for name in (name for name in LIMITS if _limits(element.get(name))):
                unread.lose(name, joint.get("name"), "<limit>")
    for element in root.xpath("joint[@type='continuous']/limit"):
        lost = ", ".join(name for name in OPEN if _limits(element.get(name)))
        if lost:
            unread.lose(f"{lost} (a continuous joint has no limits)", element.getparent().get("name"), "<limit>")
    return unread.line


def _limits(text: str | None) -> bool:
    """Tells whether a text may be a limit: neither 0 nor infinite, which files write if there is none."""
    try:
        value = float(text or "0")
    except ValueError:
        return True
    return value != 0.0 and abs(value) <= MAX_NUMBER


def _half_limited(root: Any) -> list[str]:
    """Returns a line for each joint for which the file gives only one limit."""
    return [
        f"joint {element.getparent().get('name')!r} says no {side} limit: it has none on that side"
        for element in root.xpath("joint[@type='revolute' or @type='prismatic']/limit")
        for side, other in (("lower", "upper"), ("upper", "lower"))
        if element.get(side) is None and element.get(other) is not None
    ]


def _normal(path: Path, joint: Any) -> tuple[float, ...]:
    """Returns the normal of the plane in which a planar joint moves."""
    axis = joint.find("axis")
    return NORMAL if axis is None else tuple(numbers(path, axis, "xyz", 3))


def _check_expanded(path: Path, root: Any) -> None:
    """Refuses a xacro, which is a program that writes a URDF."""
    for element in root.iter(etree.Element):
        name = etree.QName(element)
        macro = (name.namespace or "").rstrip("/").endswith("xacro") and name.localname not in ("property", "arg")
        if macro or any("${" in value for value in element.values()):
            raise BadFile(path, "is a xacro, not yet a URDF: expand it, `xacro FILE > robot.urdf`", element.sourceline)


def _dynamics(path: Path, root: Any, trunk: str, base: Base | None, repair: bool) -> tuple[str, list[str]]:
    """Returns the URDF with only inertias and joints, and notes on the changes."""
    robot = etree.Element("robot", name="robot")
    faults: dict[str, Fault] = {}
    for link in root.findall("link"):
        copy = etree.SubElement(robot, "link", name=link.get("name"))
        inertials = link.findall("inertial")
        if len(inertials) > 1:
            raise fault(path, inertials[1], f"link {link.get('name')!r} has {len(inertials)} <inertial>; one is valid")
        found = copy_inertial(path, inertials[0], copy, repair) if inertials else None
        if found is not None:
            faults[link.get("name")] = found
    floating = _floating(root, trunk)
    for i, joint in enumerate(root.findall("joint")):
        fixed = base == "fixed" and joint.get("name") == floating
        _copy_joint(path, joint, "fixed" if fixed else joint.get("type"), etree.SubElement(robot, "joint"), i)
    if base == "free" and floating is None:
        links, joints = ([each.get("name") for each in root.findall(tag)] for tag in ("link", "joint"))
        world = etree.SubElement(robot, "link", name=untaken(WORLD, links))
        joint = etree.SubElement(robot, "joint", name=f"0000:{untaken(BASE, joints)}", type="floating")
        etree.SubElement(joint, "parent", link=world.get("name"))
        etree.SubElement(joint, "child", link=trunk)
    return str(etree.tostring(robot, encoding="unicode")), notes_on(faults, "link", repair)


def _copy_joint(path: Path, joint: Any, kind: str, copy: Any, place: int) -> None:
    copy.attrib.update({"name": f"{place:04d}:{joint.get('name')}", "type": kind})
    copy_origin(path, joint, copy)
    for end in ("parent", "child"):
        etree.SubElement(copy, end, link=child(path, joint, end).get("link"))
    if kind == "fixed":
        return
    axis, limit, dynamics = joint.find("axis"), joint.find("limit"), joint.find("dynamics")
    if axis is not None and kind not in AXLESS:
        values = numbers(path, axis, "xyz", 3)
        etree.SubElement(copy, "axis", xyz=" ".join(map(repr, values)))
    if kind in ("revolute", "prismatic"):
        limit = child(path, joint, "limit")
        either = any(limit.get(side) is not None for side in OPEN)  # without both there is none, which 0 and 0 say
        _copy(path, limit, copy, effort=None, velocity=None, **(OPEN if either else dict.fromkeys(OPEN, "0")))
    elif kind == "continuous" and limit is not None:
        _copy(path, limit, copy, effort="inf", velocity="inf")
    if dynamics is not None and kind not in SEVERAL:
        _copy(path, dynamics, copy, damping="0", friction="0")


def _copy(path: Path, element: Any, copy: Any, **attributes: str | None) -> None:
    """Copies attributes that are numbers, each with its default; attributes without one must exist."""
    part = etree.SubElement(copy, element.tag)
    for name, default in attributes.items():
        if default is None and len((element.get(name) or "").split()) != 1:
            numbers(path, element, name, 1)  # which says what is wrong
        value = number(path, element, name, default, limit=name in LIMITS)
        if value == UNLIMITED and name in ("effort", "velocity"):
            value = math.inf
        if value < 0 and name in NOT_NEGATIVE:
            problem = f"joint {element.getparent().get('name')!r} has the {name} {value:g}; expected a number >= 0"
            raise BadFile(path, problem, element.sourceline)
        part.set(name, repr(min(max(value, -sys.float_info.max), sys.float_info.max)))


def _floating(root: Any, trunk: str) -> str | None:
    """Returns the name of the floating joint at the root, above which there are only fixed joints."""
    links = {trunk}
    for joint in _outward(root, trunk):
        if joint.find("parent").get("link") in links:
            if joint.get("type") == "floating":
                return str(joint.get("name"))
            if joint.get("type") == "fixed":
                links.add(joint.find("child").get("link"))
    return None


def untaken(name: str, taken: Collection[str]) -> str:
    """Returns a name that is not taken, by underscores after it if need be."""
    while name in taken:
        name += "_"
    return name


def _outward(root: Any, trunk: str) -> Iterator[Any]:
    """Yields the joints, each after that of its parent."""
    children: dict[str, list[Any]] = {}
    for joint in root.findall("joint"):
        children.setdefault(joint.find("parent").get("link"), []).append(joint)
    frontier = [trunk]
    while frontier:
        joints = [joint for link in frontier for joint in children.get(link, [])]
        yield from joints
        frontier = [joint.find("child").get("link") for joint in joints]


def check_names(path: Path, kind: str, names: Iterable[str]) -> None:
    """Refuses names that occur twice, and for joints the name that Pinocchio uses for the world."""
    for name, count in Counter(names).items():
        if count > 1:
            raise BadFile(path, f"{kind} {name!r} is defined {count} times; give each its own name")
        if name == UNIVERSE and kind == "joint":
            raise BadFile(path, f"a joint is called {name!r}, which is Pinocchio's name of the world; rename it")


def _check_tree(path: Path, root: Any) -> str:
    """Checks that links and joints form a tree; returns the name of the root link."""
    links = [link.get("name") for link in root.findall("link")]
    joints = root.findall("joint")
    for kind, names in (("link", links), ("joint", [joint.get("name") for joint in joints])):
        if None in names:
            raise BadFile(path, f"a <{kind}> has no name")
        check_names(path, kind, names)
    parents: dict[str, str] = {}
    for joint in joints:
        name, line = joint.get("name"), joint.sourceline
        if joint.get("type") not in JOINT_TYPES:
            valid = ", ".join(JOINT_TYPES)
            raise BadFile(path, f"joint {name!r} has type {joint.get('type')!r}; valid: {valid}", line)
        ends = {end: child(path, joint, end).get("link") for end in ("parent", "child")}
        for end, link in ends.items():
            if link not in links:
                raise BadFile(path, f"joint {name!r} has the unknown {end} link {link!r}", line)
        if ends["child"] in parents:
            raise BadFile(path, f"link {ends['child']!r} has two parent joints; expected one", line)
        parents[ends["child"]] = ends["parent"]
        axis = joint.find("axis")
        if axis is not None and joint.get("type") not in AXLESS and not any(numbers(path, axis, "xyz", 3)):
            raise BadFile(path, f"joint {name!r} has a zero axis; expected a direction, such as 0 1 0", axis.sourceline)
    roots = [link for link in links if link not in parents]
    if len(roots) != 1:
        found = ", ".join(roots) or ("none (a loop)" if links else "none (there is no <link>)")
        unread = _unread(root)
        raise BadFile(
            path, f"the links form no single tree; expected one root; roots: {found}{f'; {unread}' if unread else ''}"
        )
    reached = {roots[0], *(joint.find("child").get("link") for joint in _outward(root, roots[0]))}
    looped = next((link for link in links if link not in reached), None)
    if looped is not None:
        raise BadFile(
            path, f"link {looped!r} is part of a loop, or hangs from one; expected a tree: remove a joint of the loop"
        )
    return str(roots[0])
