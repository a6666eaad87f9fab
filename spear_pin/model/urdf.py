"""Read a URDF safely: checked, reduced to what the dynamics needs, nothing fetched or expanded.

Pinocchio's parser drops an inertia it cannot read, complains on stderr about shapes it does not
need, and orders the joints of a fork by name. So it is given a URDF of our own writing, with the
links' inertias and the joints only, its numbers in one notation, its joints numbered.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from lxml import etree

from spear_pin.errors import BadFile
from spear_pin.files import regular

MAX_BYTES, MAX_LINKS, MAX_NUMBER = 20_000_000, 500, 1e30
JOINT_TYPES = ("revolute", "continuous", "prismatic", "fixed", "floating", "planar")


@dataclass(frozen=True)
class Transmission:
    """One motor on one joint, as `<transmission>` declares it.

    Attributes:
        joint: name of the driven joint.
        gear_ratio: rotor turns per joint turn, N.
        rotor_inertia: inertia of the rotor at the rotor, J, in kg·m².
    """

    joint: str
    gear_ratio: float = 1.0
    rotor_inertia: float = 0.0

    @property
    def reflected_inertia(self) -> float:
        """N² J at the joint, in kg·m² (what (3.12)-(3.13) add to the kinetic energy)."""
        return self.gear_ratio**2 * self.rotor_inertia


@dataclass(frozen=True)
class Urdf:
    """Contents of a URDF that the dynamics needs.

    Attributes:
        path: where it was read.
        name: the robot's name.
        document: the whole of it, without comments.
        text: links and joints only; joint i of the document is called "i:" and its name.
        transmissions: the motors.
    """

    path: Path
    name: str
    document: str
    text: str
    transmissions: tuple[Transmission, ...]


def read_urdf(path: str | Path) -> Urdf:
    """Read and check a URDF.

    Raises:
        BadFile: the file is missing, not XML, declares a document type or entities, is no tree of
            links, has an invalid inertia, or a transmission that contradicts itself. The text
            names the place.
    """
    try:
        path = regular(path)
        if path.stat().st_size > MAX_BYTES:
            raise BadFile(path, f"has more than {MAX_BYTES} bytes")
        text = path.read_bytes()
    except OSError as error:
        raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False, remove_comments=True, remove_pis=True
    )
    try:
        root = etree.fromstring(text, parser)
    except etree.XMLSyntaxError as error:
        raise BadFile(path, f"not well-formed XML: {error.msg}", error.lineno) from None
    if root.getroottree().docinfo.internalDTD is not None:
        raise BadFile(path, "declares a document type; a URDF may not (entities are not expanded)")
    if root.tag != "robot":
        raise BadFile(path, f"the root element is <{root.tag}>; expected <robot>", root.sourceline)
    if len(root.findall("link")) > MAX_LINKS:
        raise BadFile(path, f"has {len(root.findall('link'))} links; at most {MAX_LINKS} are read")
    _check_tree(path, root)
    name = root.get("name") or path.stem
    document = str(etree.tostring(root, encoding="unicode"))
    return Urdf(path, name, document, _dynamics(path, root), _transmissions(path, root))


def _dynamics(path: Path, root: Any) -> str:
    """The URDF with nothing but inertias and joints."""
    robot = etree.Element("robot", name="robot")
    for link in root.findall("link"):
        copy = etree.SubElement(robot, "link", name=link.get("name"))
        inertial = link.find("inertial")
        if inertial is not None:
            _check_inertial(path, inertial)
            part = etree.SubElement(copy, "inertial")
            _origin(path, inertial, part)
            _numeric(path, _child(path, inertial, "mass"), part, ("value",))
            _numeric(path, _child(path, inertial, "inertia"), part, ("ixx", "ixy", "ixz", "iyy", "iyz", "izz"))
    for i, joint in enumerate(root.findall("joint")):
        name, kind = joint.get("name"), joint.get("type")
        copy = etree.SubElement(robot, "joint", name=f"{i:04d}:{name}", type=kind)
        _origin(path, joint, copy)
        for end in ("parent", "child"):
            etree.SubElement(copy, end, link=_child(path, joint, end).get("link"))
        axis = joint.find("axis")
        if axis is not None:
            _numeric(path, axis, copy, ("xyz",), 3)
        if kind in ("revolute", "prismatic"):
            _numeric(path, _child(path, joint, "limit"), copy, ("effort", "velocity"))
            for side in ("lower", "upper"):
                copy[-1].set(side, repr(_number(path, joint.find("limit"), side, "0")))
        dynamics = joint.find("dynamics")
        if dynamics is not None:
            part = etree.SubElement(copy, "dynamics")
            for coefficient in ("damping", "friction"):
                part.set(coefficient, repr(_number(path, dynamics, coefficient, "0")))
        if joint.find("mimic") is not None:
            raise BadFile(path, f"joint {name!r} mimics another; that is not supported", joint.sourceline)
    return str(etree.tostring(robot, encoding="unicode"))


def _origin(path: Path, element: Any, copy: Any) -> None:
    origin = element.find("origin")
    if origin is None:
        return
    part = etree.SubElement(copy, "origin")
    for attribute in ("xyz", "rpy"):
        if origin.get(attribute) is not None:
            part.set(attribute, " ".join(map(repr, _numbers(path, origin, attribute, 3))))


def _numeric(path: Path, element: Any, copy: Any, attributes: tuple[str, ...], count: int = 1) -> None:
    part = etree.SubElement(copy, element.tag)
    for attribute in attributes:
        part.set(attribute, " ".join(map(repr, _numbers(path, element, attribute, count))))


def _check_tree(path: Path, root: Any) -> None:
    links = [link.get("name") for link in root.findall("link")]
    joints = root.findall("joint")
    for kind, names in (("link", links), ("joint", [joint.get("name") for joint in joints])):
        for name, count in Counter(names).items():
            if name is None:
                raise BadFile(path, f"a <{kind}> has no name")
            if count > 1:
                raise BadFile(path, f"{kind} {name!r} is defined {count} times")
    parents: dict[str, str] = {}
    for joint in joints:
        name, line = joint.get("name"), joint.sourceline
        if joint.get("type") not in JOINT_TYPES:
            valid = ", ".join(JOINT_TYPES)
            raise BadFile(path, f"joint {name!r} has type {joint.get('type')!r}; valid: {valid}", line)
        ends = {end: _child(path, joint, end).get("link") for end in ("parent", "child")}
        for end, link in ends.items():
            if link not in links:
                raise BadFile(path, f"joint {name!r} has the unknown {end} link {link!r}", line)
        if ends["child"] in parents:
            raise BadFile(path, f"link {ends['child']!r} has two parent joints", line)
        parents[ends["child"]] = ends["parent"]
        axis = joint.find("axis")
        if axis is not None and not any(_numbers(path, axis, "xyz", 3)):
            raise BadFile(path, f"joint {name!r} has a zero axis", axis.sourceline)
    roots = [link for link in links if link not in parents]
    if len(roots) != 1:
        raise BadFile(path, f"the links form no single tree; roots: {', '.join(roots) or 'none (a loop)'}")
    reached = set(roots)
    children: dict[str, list[str]] = {}
    for child, parent in parents.items():
        children.setdefault(parent, []).append(child)
    frontier = list(roots)
    while frontier:
        frontier = [child for link in frontier for child in children.get(link, [])]
        reached.update(frontier)
    looped = next((link for link in links if link not in reached), None)
    if looped is not None:
        raise BadFile(path, f"link {looped!r} is part of a loop, or hangs from one")


def _check_inertial(path: Path, inertial: Any) -> None:
    link = inertial.getparent().get("name")
    mass = _number(path, _child(path, inertial, "mass"), "value")
    if mass < 0:
        raise BadFile(path, f"link {link!r} has the negative mass {mass}", inertial.sourceline)
    inertia = _child(path, inertial, "inertia")
    xx, yy, zz, xy, xz, yz = (_number(path, inertia, "i" + k) for k in ("xx", "yy", "zz", "xy", "xz", "yz"))
    minors = (xx * yy - xy**2, xx * zz - xz**2, yy * zz - yz**2)
    determinant = xx * minors[2] - xy * (xy * zz - yz * xz) + xz * (xy * yz - yy * xz)
    scale = max(abs(xx), abs(yy), abs(zz), 1e-300)
    if min(xx, yy, zz) < 0 or min(minors) < -1e-9 * scale**2 or determinant < -1e-9 * scale**3:
        raise BadFile(path, f"link {link!r} has an inertia that is not positive semidefinite", inertia.sourceline)


def _transmissions(path: Path, root: Any) -> tuple[Transmission, ...]:
    joints = {joint.get("name"): joint.get("type") for joint in root.findall("joint")}
    found: dict[str, Transmission] = {}
    for element in root.findall("transmission"):
        for tag in ("joint", "actuator"):
            if len(element.findall(tag)) > 1:
                name = element.get("name")
                raise BadFile(path, f"transmission {name!r} has several <{tag}>; one is supported", element.sourceline)
        joint = _child(path, element, "joint").get("name")
        if joint not in joints or joints[joint] == "fixed":
            movable = ", ".join(name for name, kind in joints.items() if kind != "fixed")
            raise BadFile(path, f"a transmission drives the joint {joint!r}; valid: {movable}", element.sourceline)
        if joint in found:
            raise BadFile(path, f"joint {joint!r} has two transmissions", element.sourceline)
        actuator = _child(path, element, "actuator")
        reduction = _optional(actuator, "mechanicalReduction", lambda e: _float(path, e, e.text))
        ratio = _optional(actuator, "gear_ratio", lambda e: _number(path, e, "value"))
        rotor = _optional(actuator, "rotor_inertia", lambda e: _number(path, e, "value"))
        if ratio is not None and reduction is not None and ratio != reduction:
            problem = f"joint {joint!r}: mechanicalReduction {reduction:g} disagrees with gear_ratio {ratio:g}"
            raise BadFile(path, problem, element.sourceline)
        gear = ratio if ratio is not None else reduction if reduction is not None else 1.0
        if gear == 0 or (rotor is not None and rotor < 0):
            problem = f"joint {joint!r}: gear ratio {gear:g}, rotor inertia {rotor}; expected nonzero and >= 0"
            raise BadFile(path, problem, element.sourceline)
        found[joint] = Transmission(joint, gear, rotor or 0.0)
    return tuple(found.values())


def _child(path: Path, element: Any, tag: str) -> Any:
    child = element.find(tag)
    if child is None:
        name = element.get("name") or element.getparent().get("name")
        raise BadFile(path, f"<{element.tag}> of {name!r} has no <{tag}>", element.sourceline)
    return child


def _optional(element: Any, tag: str, read: Callable[[Any], float]) -> float | None:
    """Value that `read` makes of a child, whatever the namespace of its tag."""
    child = element.find("{*}" + tag)
    return None if child is None else read(child)


def _number(path: Path, element: Any, attribute: str, default: str | None = None) -> float:
    return _float(path, element, element.get(attribute, default))


def _numbers(path: Path, element: Any, attribute: str, count: int) -> list[float]:
    values = [_float(path, element, part) for part in (element.get(attribute) or "").split()]
    if len(values) != count:
        what = f"{attribute} of <{element.tag}> is {element.get(attribute)!r}"
        raise BadFile(path, f"{what}; expected {count} number{'s' * (count > 1)}", element.sourceline)
    return values


def _float(path: Path, element: Any, text: str | None) -> float:
    try:
        value = float(text or "")
    except ValueError:
        value = math.nan
    if not abs(value) <= MAX_NUMBER:
        raise BadFile(path, f"<{element.tag}> has the value {text!r}; expected a finite number", element.sourceline)
    return value
