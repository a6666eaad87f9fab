"""Read an MJCF file, MuJoCo's own format, safely, and reduce it to what the dynamics needs.

Pinocchio's parser reads neither includes nor scenes, takes the first body alone, and makes one joint of several on a
body. So it is given an MJCF of our own writing: one tree of bodies, with what their classes say written out, one
joint each, and no meshes. MuJoCo need not be installed.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

import numpy as np
import pinocchio as pin
from lxml import etree

from spear_pin.errors import BadFile
from spear_pin.model.elements import parse_number
from spear_pin.model.mjcf_motors import Drive, read_drives
from spear_pin.model.mjcf_rotations import angle_unit, rotation
from spear_pin.model.mjcf_sections import MAIN, Defaults, include, read_defaults, section, settings
from spear_pin.model.urdf import BASE, MAX_LINKS, UNIVERSE, WORLD, Base

PLACE = ("pos", "quat", "axisangle", "xyaxes", "zaxis", "euler")
INERTIAL = (*PLACE, "mass", "diaginertia", "fullinertia")
JOINTS = ("joint", "freejoint")
JOINT_TYPES = ("free", "ball", "slide", "hinge")
JOINT = ("axis", "pos", "frictionloss", "actuatorfrcrange")
GEOM = ("size", "mass", "density")
# how many numbers an attribute has, where that is not free
COUNTS = {
    **{"pos": 3, "quat": 4, "axisangle": 4, "xyaxes": 6, "zaxis": 3, "euler": 3, "axis": 3, "fromto": 6},
    **{"mass": 1, "density": 1, "diaginertia": 3, "fullinertia": 6, "range": 2, "actuatorfrcrange": 2, "ref": 1},
}
SOLIDS = ("sphere", "capsule", "cylinder", "box", "ellipsoid")  # geoms whose mass is read
UNREAD = ("frame", "replicate", "composite", "flexcomp", "attach", "plugin")  # in a body: they would change it
# settings of the compiler that change masses, and values of them that change nothing
MASSES = {"boundmass": ("0", 1e-9), "boundinertia": ("0", 1e-9), "settotalmass": ("-1", 0.0)}
FLAGS = {"balanceinertia": "false", "inertiagrouprange": "0 5"}
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
    drives: tuple[Drive, ...]
    rubbing: Mapping[str, tuple[float, float]]
    notes: tuple[str, ...]
    look: Look


@dataclass
class _Writing:
    """State of the writing of a tree of bodies."""

    path: Path
    defaults: Defaults
    compiler: Mapping[str, str]
    taken: set[str]  # names of bodies and sites
    jointed: set[str]  # names of joints, which may be those of bodies
    joints: dict[str, str] = field(default_factory=dict)  # types by name
    rubbing: dict[str, tuple[float, float]] = field(default_factory=dict)
    lost: dict[str, list[str]] = field(default_factory=dict)  # names of joints and bodies by what they lose
    geoms: list[tuple[str, Mapping[str, str]]] = field(default_factory=list)
    bodies: int = 0

    def name(self, wanted: str, joint: bool = False) -> str:
        """A name that no other body, or joint, has."""
        taken = self.jointed if joint else self.taken
        while wanted in taken:
            wanted += "_"
        taken.add(wanted)
        return wanted

    def lose(self, what: str, name: str) -> None:
        self.lost.setdefault(what, []).append(name)


def mjcf_of(path: Path, root: Any, base: Base | None = None) -> Mjcf:
    """The dynamics of an MJCF file, from its root element.

    Args:
        path: of the file.
        root: its element; includes are put in their places.
        base: "free" puts a free joint on the first body, unless it has one; "fixed" takes it away.

    Raises:
        BadFile: there is no body, an include is not to be read, or an element would change a body in a way that is
            not supported; a number is none, or a mass negative.
    """
    include(path, root)
    compiler, defaults = settings(root, "compiler"), read_defaults(path, root)
    if compiler.get("coordinate") == "global":
        raise BadFile(path, 'has global coordinates: let MuJoCo 2.3.3 or older save it with coordinate="local"')
    body, others = _robot(path, root)
    _check_names(path, body, defaults)
    writing = _Writing(path, defaults, compiler, _names(root, "body", "site"), _names(root, *JOINTS))
    written = etree.Element("mujoco", model="robot")
    etree.SubElement(written, "compiler", angle="radian")
    world = etree.SubElement(written, "worldbody")
    trunk = _based(writing, body, base)
    if trunk.find("joint") is None and trunk.find("freejoint") is None:  # of such a one Pinocchio ignores the place
        world = etree.SubElement(world, "body", name=writing.name(WORLD))
    _add_body(writing, trunk, world, None)
    drives, left_out = read_drives(path, root, defaults, writing.joints, _true(compiler.get("autolimits"), True))
    option = settings(root, "option")
    gravity = _values(path, root, option.get("gravity", "0 0 -9.81"))
    if len(gravity) != 3:
        raise BadFile(path, f"has a gravity of {len(gravity)} numbers; expected 3")
    if any(flag.get("gravity") == "disable" for flag in section(root, "option")):
        gravity = (0.0, 0.0, 0.0)
    lost = [f"{what} of {_listed(names)}" for what, names in writing.lost.items()]
    lost += _beside(path, root, compiler, [other.get("name") or "nameless" for other in others]) + left_out
    notes = [f"not taken over: {'; '.join(lost)}"] if lost else []
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


def _check_names(path: Path, body: Any, defaults: Defaults) -> None:
    """Refuse names that are taken, by Pinocchio for the world or twice, and classes that are not there."""
    for tags in (("body",), JOINTS):
        named = [each for each in body.iter(*tags) if each.get("name")]
        for name, count in Counter(each.get("name") for each in named).items():
            if count > 1:
                raise BadFile(path, f"{tags[0]} {name!r} is defined {count} times")
            if name == UNIVERSE and tags == JOINTS:
                raise BadFile(path, f"a joint is called {name!r}, which is Pinocchio's name of the world")
    for element in body.iter(etree.Element):
        for attribute in ("class", "childclass"):
            if element.get(attribute, MAIN) not in defaults.classes:
                raise BadFile(path, f"there is no class {element.get(attribute)!r}", element.sourceline)


def _robot(path: Path, root: Any) -> tuple[Any, list[Any]]:
    """The body of the world with the most joints on it, and the others."""
    bodies = []
    for element in section(root, "worldbody"):
        if element.tag in UNREAD:
            raise BadFile(path, f"has a <{element.tag}>, which is not read: {REMEDY}", element.sourceline)
        if element.tag == "body":
            bodies.append(element)
    if not bodies:
        raise BadFile(path, "has no <body> in its <worldbody>")
    robot = max(bodies, key=lambda body: sum(1 for _ in body.iter(*JOINTS)))
    return robot, [body for body in bodies if body is not robot]


def _beside(path: Path, root: Any, compiler: Mapping[str, str], bodies: list[str]) -> list[str]:
    """Elements beside the robot that would act on it."""
    found = [f"the bodies beside it, {_listed(bodies)}"] if bodies else []
    for tag, what in (("equality", "equality constraints"), ("tendon", "tendons")):
        names = [each.get("name") or f"a {each.tag}" for each in section(root, tag)]
        if names:
            found.append(f"{what}, {_listed(names)}")
    option = settings(root, "option")
    odd = [key for key, (usual, least) in MASSES.items() if _values(path, root, compiler.get(key, usual))[0] > least]
    odd += [key for key, usual in FLAGS.items() if compiler.get(key, usual) != usual]
    fluid = [key for key in ("density", "viscosity") if any(_values(path, root, option.get(key, "0")))]
    return (
        found
        + ([f"of <compiler> {_listed(odd)}"] if odd else [])
        + ([f"the fluid's {_listed(fluid)}"] if fluid else [])
    )


def _based(writing: _Writing, body: Any, base: Base | None) -> Any:
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


def _floats(writing: _Writing, body: Any) -> bool:
    return body.find("freejoint") is not None or any(
        writing.defaults.of(joint, body.get("childclass")).get("type") == "free" for joint in body.findall("joint")
    )


def _add_body(writing: _Writing, body: Any, parent: Any, inherited: str | None) -> None:
    """Write a body, with all that is on it, into another; `inherited` is the class of the one around it."""
    path, inherited = writing.path, body.get("childclass") or inherited
    writing.bodies += 1
    if writing.bodies > MAX_LINKS:
        raise BadFile(path, f"has more than {MAX_LINKS} bodies")
    name = body.get("name") or writing.name(f"body_{writing.bodies}")
    if any(_values(path, body, body.get("gravcomp", "0"))):
        writing.lose("gravcomp", name)
    children = list(body.iterchildren(etree.Element))
    inner = copy = etree.SubElement(parent, "body")
    if not _floats(writing, body):  # the place of what floats is in q
        _copy(writing, body, copy, body.attrib, PLACE)
    for child in (child for child in children if child.tag in JOINTS):
        if len(inner):  # one joint a body
            inner.set("name", writing.name(f"{name}_{len(writing.joints)}"))
            inner = etree.SubElement(inner, "body")
        _add_joint(writing, child, inner, name, inherited)
    inner.set("name", name)  # what all its joints move
    _add_mass(writing, body, inner, inherited)
    writing.geoms += [(name, writing.defaults.of(geom, inherited)) for geom in body.findall("geom")]
    for child in children:
        if child.tag in UNREAD:
            raise BadFile(path, f"body {name!r} has a <{child.tag}>, which is not read: {REMEDY}", child.sourceline)
        if child.tag in ("site", "geom"):
            _add_point(writing, child, inner, inherited)
        elif child.tag == "body":
            _add_body(writing, child, inner, inherited)


def _add_joint(writing: _Writing, joint: Any, body: Any, owner: str, inherited: str | None) -> None:
    path = writing.path
    said = writing.defaults.of(joint, inherited) if joint.tag == "joint" else {"type": "free"}
    kind = said.get("type", "hinge")
    if kind not in JOINT_TYPES:
        raise BadFile(path, f"a joint has the type {kind!r}; valid: {', '.join(JOINT_TYPES)}", joint.sourceline)
    name = joint.get("name") or writing.name(BASE if kind == "free" else f"{owner}_joint", joint=True)
    writing.joints[name] = kind
    (armature, *_), (damping, *higher) = (_values(path, joint, said.get(each, "0")) for each in ("armature", "damping"))
    writing.rubbing[name] = armature, damping
    if kind == "free":
        etree.SubElement(body, "freejoint", name=name)
        return
    copy = etree.SubElement(body, "joint", name=name, type=kind)
    _copy(writing, joint, copy, said, JOINT)
    if "range" in said:
        unit, (ref, *_) = (
            1.0 if kind == "slide" else angle_unit(writing.compiler),
            _values(path, joint, said.get("ref", "0")),
        )
        ends = [unit * (end - ref) for end in _counted(path, joint, said, "range")]
        copy.set("range", " ".join(map(repr, ends)))
    auto = _true(writing.compiler.get("autolimits"), True)
    for limited, limits in (("limited", "range"), ("actuatorfrclimited", "actuatorfrcrange")):
        copy.set(limited, "true" if _true(said.get(limited), auto and limits in said) else "false")
    for what, numbers in (
        ("damping that is not viscous", higher),
        ("frictionloss", _values(path, joint, said.get("frictionloss", "0"))),
        ("springdamper", _values(path, joint, said.get("springdamper", "0"))),
        ("stiffness", _values(path, joint, said.get("stiffness", "0"))),
        ("ref (q is MuJoCo's qpos less ref)", _values(path, joint, said.get("ref", "0"))),
    ):
        if any(numbers):
            writing.lose(what, name)


def _add_mass(writing: _Writing, body: Any, copy: Any, inherited: str | None) -> None:
    """Write what gives a body its mass: its `<inertial>`, or its geoms."""
    path, inertial = writing.path, body.find("inertial")
    from_geoms = writing.compiler.get("inertiafromgeom", "auto")
    if inertial is not None and from_geoms != "true":
        _copy(writing, inertial, etree.SubElement(copy, "inertial"), inertial.attrib, INERTIAL)
        _check_inertial(path, body, inertial)
    elif from_geoms != "false":
        for geom in body.findall("geom"):
            said = writing.defaults.of(geom, inherited)
            kind = said.get("type", "mesh" if "mesh" in said else "sphere")
            if kind in SOLIDS and "mesh" not in said:
                placed = ("fromto",) if "fromto" in said else PLACE  # of both, MuJoCo heeds the former
                _copy(writing, geom, etree.SubElement(copy, "geom", type=kind), said, (*placed, *GEOM))
                if said.get("shellinertia") == "true":
                    writing.lose("shellinertia", body.get("name") or "nameless")
            elif kind != "plane" and _values(path, geom, said.get("mass", "1"))[0] > 0:
                writing.lose("mass of a mesh", copy.get("name"))


def _check_inertial(path: Path, body: Any, inertial: Any) -> None:
    mass = _values(path, inertial, inertial.get("mass", ""))
    if len(mass) != 1 or mass[0] < 0:
        problem = f"body {body.get('name')!r} has the mass {inertial.get('mass')!r}; expected a number >= 0"
        raise BadFile(path, problem, inertial.sourceline)
    moments = [*_values(path, inertial, inertial.get("fullinertia", inertial.get("diaginertia", "0 0 0"))), 0, 0, 0]
    xx, yy, zz, xy, xz, yz = moments[:6]
    if np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])[0] < -1e-9 * max(abs(xx), abs(yy), abs(zz)):
        problem = f"body {body.get('name')!r} has an inertia that is not positive semidefinite"
        raise BadFile(path, problem, inertial.sourceline)


def _add_point(writing: _Writing, element: Any, body: Any, inherited: str | None) -> None:
    """Write a site, or the middle of a geom, that has a name: a frame, which may be a toe."""
    said, name = writing.defaults.of(element, inherited), element.get("name")
    if not name or "fromto" in said or "mesh" in said:
        return
    if element.tag == "geom":
        if name in writing.taken:
            return
        writing.taken.add(name)
    _copy(writing, element, etree.SubElement(body, "site", name=name), said, PLACE)


def _copy(writing: _Writing, element: Any, copy: Any, said: Mapping[str, str], attributes: Iterable[str]) -> None:
    for attribute in attributes:
        if attribute in said:
            values = _counted(writing.path, element, said, attribute)
            if attribute in ("euler", "axisangle"):
                values, attribute = _quaternion(writing, element, attribute, values), "quat"
            copy.set(attribute, " ".join(map(repr, values)))


def _quaternion(writing: _Writing, element: Any, notation: str, values: Sequence[float]) -> tuple[float, ...]:
    """(w, x, y, z) of a rotation; Pinocchio takes capitals of an Euler sequence, and axes of any length, otherwise."""
    try:
        turned = rotation(notation, values, writing.compiler)
    except ValueError as error:
        raise BadFile(writing.path, f"{error}, in <{element.tag}>", element.sourceline) from None
    x, y, z, w = map(float, pin.Quaternion(turned).coeffs())
    return w, x, y, z


def _counted(path: Path, element: Any, said: Mapping[str, str], attribute: str) -> tuple[float, ...]:
    values = _values(path, element, said[attribute])
    if len(values) != COUNTS.get(attribute, len(values)):
        what = f"{attribute} of <{element.tag}> is {said[attribute]!r}"
        raise BadFile(path, f"{what}; expected {COUNTS[attribute]} numbers", element.sourceline)
    return values


def _values(path: Path, element: Any, text: str) -> tuple[float, ...]:
    """The numbers of an attribute, one at least."""
    return tuple(parse_number(path, element, part) for part in text.split() or [""])


def _true(text: str | None, otherwise: bool) -> bool:
    return otherwise if text in (None, "auto") else text == "true"


def _listed(names: list[str], most: int = 4) -> str:
    rest = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(names[:most]) + rest
