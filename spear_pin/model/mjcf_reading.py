"""Read an MJCF file, MuJoCo's own format, safely, and reduce it to what the dynamics needs.

Pinocchio's parser reads neither includes nor scenes, takes the first body alone, and makes one joint of several on a
body. So it is given an MJCF of our own writing: one tree of bodies, with what their classes say written out, one
joint each, and no meshes. MuJoCo need not be installed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
from lxml import etree

from spear_pin.errors import BadFile, listed
from spear_pin.model.elements import fault
from spear_pin.model.inertial import notes_on
from spear_pin.model.mjcf_mass import add_mass
from spear_pin.model.mjcf_motors import MOVABLE, DrivenJoint, read_drives
from spear_pin.model.mjcf_rotations import angle_unit
from spear_pin.model.mjcf_sections import MAIN, Defaults, include, read_defaults, section, settings
from spear_pin.model.mjcf_writing import PLACE, SHORTEST, Writing, at_least_zero, called, copy, counted, is_true, values
from spear_pin.model.urdf import BASE, MAX_LINKS, UNIVERSE, WORLD, Base

JOINTS = ("joint", "freejoint")
JOINT_TYPES = ("free", "ball", "slide", "hinge")
JOINT = ("axis", "pos", "frictionloss", "actuatorfrcrange")
UNREAD = ("frame", "replicate", "composite", "flexcomp", "attach", "plugin")  # in a body: they would change it
# settings of the compiler that change masses, and values of them that change nothing
MASSES = {"boundmass": ("0", 1e-9), "boundinertia": ("0", 1e-9), "settotalmass": ("-1", 0.0)}
FLAGS = {"inertiagrouprange": "0 5"}
# words that the compiler takes
KEYWORDS = {"angle": ("degree", "radian"), "inertiafromgeom": ("auto", "false", "true")}
REMEDY = "let MuJoCo write it anew (mujoco.mj_saveLastXML), which expands it"


@dataclass(frozen=True)
class Look:
    """What an MJCF file says of how it looks, as attributes of elements, with what their classes say.

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
        path: where it was read.
        name: the robot's name.
        root: name of its first body.
        text: one tree of bodies.
        gravity: in m/s², (3,).
        drives: the motors.
        rubbing: armature and damping of joints, by name; Pinocchio does not read those of all.
        notes: what is not as in the file, a line each.
        look: what the bodies look like.
    """

    path: Path
    name: str
    root: str
    text: str
    gravity: tuple[float, ...]
    drives: tuple[DrivenJoint, ...]
    rubbing: Mapping[str, tuple[float, float]]
    notes: tuple[str, ...]
    look: Look


def mjcf_of(path: Path, root: Any, base: Base | None = None, repair: bool = False) -> Mjcf:
    """The dynamics of an MJCF file, from its root element.

    Args:
        path: of the file.
        root: its element; includes are put in their places.
        base: "free" puts a free joint on the first body, unless it has one; "fixed" takes it away.
        repair: mend inertias that no body can have.

    Raises:
        BadFile: there is no body, an include is not to be read, or an element would change a body in a way that is
            not supported; a number is none, a mass negative, an inertia none that a body can have, or something else
            that MuJoCo refuses.
    """
    include(path, root)
    compiler, defaults = settings(root, "compiler"), read_defaults(path, root)
    if compiler.get("coordinate") == "global":
        raise BadFile(path, 'has global coordinates: let MuJoCo 2.3.3 or older save it with coordinate="local"')
    for key, valid in KEYWORDS.items():
        if compiler.get(key, valid[0]) not in valid:
            raise BadFile(path, f"<compiler> has the {key} {compiler[key]!r}; valid: {', '.join(valid)}")
    body, others = _robot(path, root)
    _check_names(path, root, body, defaults)
    writing = Writing(path, defaults, compiler, repair, _names(root, "body", "site"), _names(root, *JOINTS))
    written = etree.Element("mujoco", model="robot")
    etree.SubElement(written, "compiler", angle="radian")
    world = etree.SubElement(written, "worldbody")
    trunk = _based(writing, body, base)
    if trunk.find("joint") is None and trunk.find("freejoint") is None:  # of such a one Pinocchio ignores the place
        world = etree.SubElement(world, "body", name=writing.name(WORLD))
    _add_body(writing, trunk, world, None)
    autolimits = is_true(compiler.get("autolimits"), True)
    drives, left_out = read_drives(path, root, defaults, writing.joints, writing.jointed, autolimits)
    option = settings(root, "option")
    gravity = values(path, root, option.get("gravity", "0 0 -9.81"))
    if len(gravity) != 3:
        raise BadFile(path, f"has a gravity of {len(gravity)} numbers; expected 3")
    if any(flag.get("gravity") == "disable" for flag in section(root, "option")):
        gravity = (0.0, 0.0, 0.0)
    lost = [f"{what} of {listed(names)}" for what, names in writing.lost.items()]
    lost += _beside(path, root, compiler, [other.get("name") or "nameless" for other in others]) + left_out
    notes = [f"not taken over: {'; '.join(lost)}"] if lost else []
    notes += notes_on(writing.faults, "body", repair)
    text = str(etree.tostring(written, encoding="unicode"))
    name, first = root.get("model") or path.stem, world.find("body").get("name")
    look = Look(tuple(writing.geoms), _assets(root, defaults), compiler)
    return Mjcf(path, name, first, text, gravity, drives, writing.rubbing, tuple(notes), look)


def _assets(root: Any, defaults: Defaults) -> dict[tuple[str, str], Mapping[str, str]]:
    """Meshes and materials by tag and name; a mesh without a name is called as its file."""
    assets: dict[tuple[str, str], Mapping[str, str]] = {}
    for element in section(root, "asset"):
        said = defaults.of(element)
        assets[element.tag, element.get("name") or PurePosixPath(said.get("file", "")).stem] = said
    return assets


def _names(root: Any, *tags: str) -> set[str]:
    return {each.get("name") for each in root.iter(*tags)} - {None}


def _check_names(path: Path, root: Any, body: Any, defaults: Defaults) -> None:
    """Refuse names that are taken, by Pinocchio for the world or twice, and classes that are not there."""
    for tags in (("body",), JOINTS):
        named = [each for each in body.iter(*tags) if each.get("name")]
        for name, count in Counter(each.get("name") for each in named).items():
            if count > 1:
                raise BadFile(path, f"{tags[0]} {name!r} is defined {count} times")
            if name == UNIVERSE and tags == JOINTS:
                raise BadFile(path, f"a joint is called {name!r}, which is Pinocchio's name of the world")
    for element in (*body.iter(etree.Element), *section(root, "actuator")):
        for attribute in ("class", "childclass"):
            if element.get(attribute, MAIN) not in defaults.classes:
                raise fault(path, element, f"there is no class {element.get(attribute)!r}")


def _robot(path: Path, root: Any) -> tuple[Any, list[Any]]:
    """The body of the world with the most joints on it, and the others."""
    bodies = []
    for element in section(root, "worldbody"):
        if element.tag in UNREAD:
            raise fault(path, element, f"has a <{element.tag}>, which is not read: {REMEDY}")
        if element.tag == "body":
            bodies.append(element)
    if not bodies:
        raise BadFile(path, "has no <body> in its <worldbody>")
    robot = max(bodies, key=lambda body: sum(1 for _ in body.iter(*JOINTS)))
    return robot, [body for body in bodies if body is not robot]


def _beside(path: Path, root: Any, compiler: Mapping[str, str], bodies: list[str]) -> list[str]:
    """Elements beside the robot that would act on it."""
    found = [f"the bodies beside it, {listed(bodies)}"] if bodies else []
    for tag, what in (("equality", "equality constraints"), ("tendon", "tendons")):
        names = [each.get("name") or f"a {each.tag}" for each in section(root, tag)]
        if names:
            found.append(f"{what}, {listed(names)}")
    option = settings(root, "option")
    odd = [key for key, (usual, least) in MASSES.items() if values(path, root, compiler.get(key, usual))[0] > least]
    odd += [key for key, usual in FLAGS.items() if compiler.get(key, usual) != usual]
    fluid = [key for key in ("density", "viscosity") if any(values(path, root, option.get(key, "0")))]
    return (
        found + ([f"of <compiler> {listed(odd)}"] if odd else []) + ([f"the fluid's {listed(fluid)}"] if fluid else [])
    )


def _based(writing: Writing, body: Any, base: Base | None) -> Any:
    """The first body, with or without a free joint as asked for; if it has other joints, on one that floats."""
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
        writing.defaults.of(joint, body.get("childclass")).get("type") == "free" for joint in body.findall("joint")
    )


def _add_body(writing: Writing, body: Any, parent: Any, inherited: str | None) -> None:
    """Write a body, with all that is on it, into another; `inherited` is the class of the one around it."""
    path, inherited = writing.path, body.get("childclass") or inherited
    writing.bodies += 1
    if writing.bodies > MAX_LINKS:
        raise BadFile(path, f"has more than {MAX_LINKS} bodies")
    name = body.get("name") or writing.name(f"body_{writing.bodies}")
    if any(values(path, body, body.get("gravcomp", "0"))):
        writing.lose("gravcomp", name)
    children = list(body.iterchildren(etree.Element))
    inner = etree.SubElement(parent, "body")
    floats = _floats(writing, body)
    copy(writing, body, etree.Element("body") if floats else inner, body.attrib, PLACE)  # of what floats it is in q
    if floats and (writing.bodies > 1 or sum(child.tag in JOINTS for child in children) > 1):
        expected = "one on the first body alone, without another joint"
        raise writing.fault(body, f"body {name!r} has a free joint; expected {expected}")
    for child in (child for child in children if child.tag in JOINTS):
        if len(inner):  # one joint a body
            inner.set("name", writing.name(f"{name}_{len(writing.joints)}"))
            inner = etree.SubElement(inner, "body")
        _add_joint(writing, child, inner, name, inherited)
    inner.set("name", name)  # what all its joints move
    add_mass(writing, body, inner, inherited)
    writing.geoms += [(name, writing.defaults.of(geom, inherited)) for geom in body.findall("geom")]
    for child in children:
        if child.tag in UNREAD:
            raise fault(path, child, f"body {name!r} has a <{child.tag}>, which is not read: {REMEDY}")
        if child.tag in ("site", "geom"):
            _add_point(writing, child, inner, inherited)
        elif child.tag == "body":
            _add_body(writing, child, inner, inherited)


def _add_joint(writing: Writing, joint: Any, body: Any, owner: str, inherited: str | None) -> None:
    path = writing.path
    said = writing.defaults.of(joint, inherited) if joint.tag == "joint" else {"type": "free"}
    kind = said.get("type", "hinge")
    if kind not in JOINT_TYPES:
        raise writing.fault(joint, f"{called(joint)} has the type {kind!r}; valid: {', '.join(JOINT_TYPES)}")
    name = joint.get("name") or writing.name(BASE if kind == "free" else f"{owner}_joint", joint=True)
    writing.joints[name] = kind
    armature, damping, frictionloss = (
        at_least_zero(writing, joint, said, each, f"joint {name!r}") for each in ("armature", "damping", "frictionloss")
    )
    writing.rubbing[name] = armature, damping
    if kind == "free":
        etree.SubElement(body, "freejoint", name=name)
        return
    copied = etree.SubElement(body, "joint", name=name, type=kind)
    copy(writing, joint, copied, said, JOINT)
    if kind in MOVABLE and np.linalg.norm(counted(writing, joint, {"axis": "0 0 1", **said}, "axis")) < SHORTEST:
        raise writing.fault(joint, f"joint {name!r} has the axis {said['axis']!r}; expected a direction")
    if "range" in said:
        unit = 1.0 if kind == "slide" else angle_unit(writing.compiler)
        ref, *_ = values(path, joint, said.get("ref", "0"))
        ends = [unit * (end - ref) for end in counted(writing, joint, said, "range")]
        copied.set("range", " ".join(map(repr, ends)))
    low, high = counted(writing, joint, {"range": "0 0", **said}, "range")
    if said.get("limited") == "true" and low >= high:
        problem = f"joint {name!r} is limited, but has the range {said.get('range', '')!r}"
        raise writing.fault(joint, f"{problem}; expected two angles, or lengths, the lower one first")
    auto = is_true(writing.compiler.get("autolimits"), True)
    for limited, limits in (("limited", "range"), ("actuatorfrclimited", "actuatorfrcrange")):
        copied.set(limited, "true" if is_true(said.get(limited), auto and limits in said) else "false")
    for what, numbers in (
        ("damping that is not viscous", values(path, joint, said.get("damping", "0"))[1:]),
        ("frictionloss", [frictionloss]),
        ("springdamper", values(path, joint, said.get("springdamper", "0"))),
        ("stiffness", values(path, joint, said.get("stiffness", "0"))),
        ("ref (q is MuJoCo's qpos less ref)", values(path, joint, said.get("ref", "0"))),
    ):
        if any(numbers):
            writing.lose(what, name)


def _add_point(writing: Writing, element: Any, body: Any, inherited: str | None) -> None:
    """Write a site, or the middle of a geom, that has a name: a frame, which may be a toe."""
    said, name = writing.defaults.of(element, inherited), element.get("name")
    if not name or "fromto" in said or "mesh" in said:
        return
    if element.tag == "geom":
        if name in writing.taken:
            return
        writing.taken.add(name)
    copy(writing, element, etree.SubElement(body, "site", name=name), said, PLACE)
