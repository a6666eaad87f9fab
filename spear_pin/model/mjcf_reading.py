"""Reads an MJCF file, MuJoCo's own format, safely, and reduces it to the data for the dynamics.

Pinocchio's parser reads neither includes nor scenes, takes the first body alone, and makes one joint of several on a
body. So it is given an MJCF of our own writing: one tree of bodies, with what their classes say written out, one
joint each, and no meshes. MuJoCo need not be installed.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from lxml import etree

from spear_pin.errors import BadFile
from spear_pin.model.elements import fault, name_element
from spear_pin.model.inertial import notes_on
from spear_pin.model.mjcf_keyframes import places_of, read_keyframes
from spear_pin.model.mjcf_loops import read_loops
from spear_pin.model.mjcf_mass import add_mass
from spear_pin.model.mjcf_motors import LIMITED, MOVABLE, DrivenJoint, either_way, ends_of, is_limited, read_drives
from spear_pin.model.mjcf_points import add_point
from spear_pin.model.mjcf_rotations import angle_unit
from spear_pin.model.mjcf_sections import MAIN, Defaults, include, inherit_classes, read_defaults, section, settings
from spear_pin.model.mjcf_unread import tell_unread
from spear_pin.model.mjcf_writing import PLACE, SHORTEST, Rubbing, Writing
from spear_pin.model.urdf import BASE, MAX_LINKS, WORLD, Base, check_names

JOINTS = ("joint", "freejoint")
JOINT_TYPES = ("free", "ball", "slide", "hinge")
RANGES = ("range", "actuatorfrcrange")  # of joints
JOINT = ("axis", "pos", "frictionloss")
UNREAD = ("frame", "replicate", "composite", "flexcomp", "attach", "plugin")  # in a body: they would change it
# words that the compiler takes
KEYWORDS = {"angle": ("degree", "radian"), "inertiafromgeom": ("auto", "false", "true")}
MOST = sys.float_info.max  # which Pinocchio reads, as it does not read "inf"
REMEDY = "let MuJoCo write it anew (mujoco.mj_saveLastXML), which expands it"


@dataclass(frozen=True)
class Look:
    """The look of an MJCF file's bodies, as attributes of elements, with those of their classes.

    Attributes:
        geoms: name of a body, and a geom of it.
        assets: meshes and materials, by tag and name.
        compiler: settings that they are read by.
    """

    geoms: tuple[tuple[str, Mapping[str, str]], ...]
    assets: Mapping[tuple[str, str], Mapping[str, str]]
    compiler: Mapping[str, str]


@dataclass(frozen=True)
class Mjcf:
    """Contents of an MJCF file that the dynamics needs.

    Attributes:
        path: path of the file.
        name: the robot's name.
        root: name of its first body.
        text: one tree of bodies.
        gravity: gravity, in m/s², (3,).
        drives: the motors.
        loops: closed loops, by name, as tables of a TOML file.
        rubbing: armature and damping of joints, by name; Pinocchio does not read all of them.
        postures: postures of keyframes, by name: MuJoCo's coordinates by joint, in rad or m, with the model's zeros.
        notes: differences from the file, a line each.
        look: look of the bodies.
        inside: names of geoms of which the middle is no end of a limb.
    """

    path: Path
    name: str
    root: str
    text: str
    gravity: tuple[float, ...]
    drives: tuple[DrivenJoint, ...]
    loops: Mapping[str, Mapping[str, Any]]
    rubbing: Mapping[str, Rubbing]
    postures: Mapping[str, Mapping[str, tuple[float, ...]]]
    notes: tuple[str, ...]
    look: Look
    inside: frozenset[str]


def mjcf_of(path: Path, root: Any, base: Base | None = None, repair: bool = False) -> Mjcf:
    """Reads the dynamics of an MJCF file from its root element.

    Args:
        path: path of the file.
        root: root element of the file; includes are put in their places.
        base: "free" puts a free joint on the first body, unless it has one; "fixed" removes it.
        repair: whether to repair inertias that no body can have.

    Raises:
        BadFile: there is no body, an include is not to be read, or an element would change a body in a way that is
            not supported; a number is none, a mass negative, an inertia none that a body can have, or something else
            that MuJoCo refuses.
    """
    include(path, root)
    inherit_classes(root)
    compiler, defaults = settings(root, "compiler"), read_defaults(path, root)
    if compiler.get("coordinate") == "global":
        raise BadFile(path, 'has global coordinates: let MuJoCo 2.3.3 or older save it with coordinate="local"')
    for key, valid in KEYWORDS.items():
        if compiler.get(key, valid[0]) not in valid:
            raise BadFile(path, f"<compiler> has the {key} {compiler[key]!r}; valid: {', '.join(valid)}")
    body, others = _robot(path, root)
    _check_names(path, root, body, defaults)
    writing = Writing(path, root, defaults, compiler, repair, _names(root, "body", "site"), _names(root, *JOINTS))
    written = etree.Element("mujoco", model="robot")
    etree.SubElement(written, "compiler", angle="radian")
    world = etree.SubElement(written, "worldbody")
    places = places_of(section(root, "worldbody"), defaults)
    trunk = _based(writing, body, base)
    if trunk.find("joint") is None and trunk.find("freejoint") is None:  # of such a one Pinocchio ignores the place
        world = etree.SubElement(world, "body", name=writing.name(WORLD))
    _add_body(writing, trunk, world)
    drives = read_drives(writing)
    option = settings(root, "option")
    gravity = writing.values(root, option.get("gravity", "0 0 -9.81"))
    if len(gravity) != 3:
        raise BadFile(path, f"has a gravity of {len(gravity)} numbers; expected 3")
    if any(flag.get("gravity") == "disable" for flag in section(root, "option")):
        gravity = (0.0, 0.0, 0.0)
    postures = read_keyframes(path, root, {name: places[at] for name, at in writing.elements.items() if at in places})
    loops, told = read_loops(writing)
    tell_unread(writing, others, drives, told)
    notes = [*filter(None, [writing.unread.line]), *notes_on(writing.faults, "body", repair)]
    text = str(etree.tostring(written, encoding="unicode"))
    name, first = root.get("model") or path.stem, world.find("body").get("name")
    look = Look(tuple(writing.geoms), _assets(root, defaults), compiler)
    return Mjcf(
        path,
        name,
        first,
        text,
        gravity,
        drives.motors,
        loops,
        writing.rubbing,
        postures,
        tuple(notes),
        look,
        frozenset(writing.inside),
    )


def _assets(root: Any, defaults: Defaults) -> dict[tuple[str, str], Mapping[str, str]]:
    """Returns meshes and materials by tag and name; a mesh without a name has the name of its file."""
    assets: dict[tuple[str, str], Mapping[str, str]] = {}
    for element in section(root, "asset"):
        said = defaults.of(element)
        assets[element.tag, element.get("name") or PurePosixPath(said.get("file", "")).stem] = said
    return assets


def _names(root: Any, *tags: str) -> set[str]:
    return {each.get("name") for each in root.iter(*tags)} - {None}


def _check_names(path: Path, root: Any, body: Any, defaults: Defaults) -> None:
    """Refuses names that no body or joint may have, see `check_names`, and classes that do not exist."""
    for tags in (("body",), JOINTS):
        check_names(path, tags[0], [name for each in body.iter(*tags) if (name := each.get("name"))])
    for element in (*body.iter(etree.Element), *section(root, "actuator")):
        for attribute in ("class", "childclass"):
            if element.get(attribute, MAIN) not in defaults.classes:
                raise fault(path, element, f"there is no class {element.get(attribute)!r}")


def _robot(path: Path, root: Any) -> tuple[Any, list[Any]]:
    """Returns the body of the world with the most joints on it, and the other bodies."""
    bodies = []
    for element in section(root, "worldbody"):
        if element.tag in UNREAD:
            raise fault(path, element, f"has a <{element.tag}>, which is not read: {REMEDY}")
        if element.tag == "body":
            bodies.append(element)
    if not bodies:
        raise BadFile(path, "has no <body> in its <worldbody>; expected a robot there")
    robot = max(bodies, key=lambda body: sum(1 for _ in body.iter(*JOINTS)))
    return robot, [body for body in bodies if body is not robot]


def _based(writing: Writing, body: Any, base: Base | None) -> Any:
    """Returns the first body with or without a free joint, as `base` says; other joints go on a floating body."""
    floats = _floats(writing, body)
    if base == "fixed" and floats:
        for joint in body.xpath("joint | freejoint"):
            body.remove(joint)
    if base != "free" or floats:
        return body
    if body.find("joint") is not None:
        carrier = etree.Element("body", name=writing.name(f"{BASE}_link"))
        carrier.append(body)
        body = carrier
    body.insert(0, etree.Element("freejoint", name=writing.name(BASE, joint=True)))
    return body


def _floats(writing: Writing, body: Any) -> bool:
    return body.find("freejoint") is not None or any(
        writing.defaults.of(joint).get("type") == "free" for joint in body.findall("joint")
    )


def _add_body(writing: Writing, body: Any, parent: Any) -> None:
    """Writes a body and its contents into another."""
    path = writing.path
    writing.bodies += 1
    if writing.bodies > MAX_LINKS:
        raise BadFile(path, f"has more than {MAX_LINKS} bodies")
    name = body.get("name") or writing.name(f"body_{writing.bodies}")
    children = list(body.iterchildren(etree.Element))
    inner = etree.SubElement(parent, "body")
    floats = _floats(writing, body)
    writing.copy(body, etree.Element("body") if floats else inner, body.attrib, PLACE)  # of what floats it is in q
    if floats and (writing.bodies > 1 or sum(child.tag in JOINTS for child in children) > 1):
        expected = "one on the first body alone, without another joint"
        raise writing.fault(body, f"body {name!r} has a free joint; expected {expected}")
    for child in (child for child in children if child.tag in JOINTS):
        if len(inner):  # one joint a body
            inner.set("name", writing.name(f"{name}_{len(writing.joints)}"))
            inner = etree.SubElement(inner, "body")
        _add_joint(writing, child, inner, name)
    inner.set("name", name)  # what all its joints move
    add_mass(writing, body, inner)
    writing.geoms += [(name, writing.defaults.of(geom)) for geom in body.findall("geom")]
    alone = body.find("body") is None
    for child in children:
        if child.tag in UNREAD:
            raise fault(path, child, f"body {name!r} has a <{child.tag}>, which is not read: {REMEDY}")
        if child.tag in ("site", "geom"):
            add_point(writing, child, inner, alone=alone)
        elif child.tag == "body":
            _add_body(writing, child, inner)


def _add_joint(writing: Writing, joint: Any, body: Any, owner: str) -> None:
    said = writing.defaults.of(joint) if joint.tag == "joint" else {"type": "free"}
    kind = said.get("type", "hinge")
    if kind not in JOINT_TYPES:
        raise writing.fault(joint, f"{name_element(joint)} has the type {kind!r}; valid: {', '.join(JOINT_TYPES)}")
    name = joint.get("name") or writing.name(BASE if kind == "free" else f"{owner}_joint", joint=True)
    writing.joints[name], writing.elements[name] = kind, joint
    writing.rubbing[name] = writing.read_rubbing(joint, said, f"joint {name!r}")
    frictionloss = writing.at_least_zero(joint, said, "frictionloss", f"joint {name!r}")
    if kind == "free":
        etree.SubElement(body, "freejoint", name=name)
        return
    copied = etree.SubElement(body, "joint", name=name, type=kind)
    writing.copy(joint, copied, said, JOINT)
    if kind in MOVABLE and np.linalg.norm(writing.counted(joint, {"axis": "0 0 1", **said}, "axis")) < SHORTEST:
        raise writing.fault(joint, f"joint {name!r} has the axis {said['axis']!r}; expected a direction")
    limited = {name: is_limited(writing, joint, said, name) for name in RANGES}
    low, high = ends_of(writing, joint, {"range": "0 0", **said}, "range")
    if limited["range"] and kind in MOVABLE:
        unit = 1.0 if kind == "slide" else angle_unit(writing.compiler)
        ref, *_ = writing.values(joint, said.get("ref", "0"))
        ends = [unit * (end - ref) for end in (low, high)]
        copied.set("range", " ".join(repr(min(max(end, -MOST), MOST)) for end in ends))
    elif limited["range"]:
        writing.unread.lose("range", name, "<joint>")
    if limited["actuatorfrcrange"]:
        force, told = either_way(ends_of(writing, joint, said, "actuatorfrcrange"))
        copied.set("actuatorfrcrange", " ".join(repr(min(max(end, -MOST), MOST)) for end in (-force, force)))
        if told:
            writing.unread.lose(f"{told} of actuatorfrcrange", name)
    if said.get("limited") == "true" and low >= high:
        problem = f"joint {name!r} is limited, but has the range {said.get('range', '')!r}"
        raise writing.fault(joint, f"{problem}; expected two angles, or lengths, the lower one first")
    for limits, acts in limited.items():
        copied.set(LIMITED[limits], "true" if acts else "false")
    for what, numbers in (
        ("damping that is not viscous", writing.values(joint, said.get("damping", "0"))[1:]),
        ("frictionloss", [frictionloss]),
        ("ref (q is MuJoCo's qpos less ref)", writing.values(joint, said.get("ref", "0"))),
    ):
        if any(numbers):
            writing.unread.lose(what, name)
