"""Writes the mass of a body of an MJCF file, from its `<inertial>` or its geoms."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from lxml import etree

from spear_pin.model.elements import name_element
from spear_pin.model.inertial import fault_of, nearest
from spear_pin.model.mjcf_writing import PLACE, TURNS, Writing

MOMENTS = ("diaginertia", "fullinertia")
# how many sizes a geom whose mass is read has, between its ends and alone
SIZES = {"sphere": (1, 1), "capsule": (1, 2), "cylinder": (1, 2), "box": (1, 3), "ellipsoid": (1, 3)}
MOST_SIZES = 3
MASSLESS = ("plane", "hfield", "mesh", "sdf")  # of the last two there is a mass, but it is not read
GROUPS = "0 5"  # least and most, of the geoms whose mass counts
SHORTEST = 1e-14  # m, from end to end


def add_mass(writing: Writing, body: Any, to: Any) -> None:
    """Writes the inertial or the geoms that give a body its mass.

    Args:
        writing: state.
        body: body in the file.
        to: the body that is written.

    Raises:
        BadFile: an inertia is incomplete or none that a body can have, or a geom has no size, or no such one.
    """
    inertials, from_geoms = body.findall("inertial"), writing.compiler.get("inertiafromgeom", "auto")
    if len(inertials) > 1:
        raise writing.fault(inertials[1], f"body {to.get('name')!r} has {len(inertials)} <inertial>; one is valid")
    geoms = [] if from_geoms == "false" else _weighed(writing, body)
    if inertials and not (from_geoms == "true" and any(_weighs(writing, geom) for geom in geoms)):
        _add_inertial(writing, body, inertials[0], to)
    else:
        for geom in geoms:
            _add_geom(writing, geom, to)


def _weighed(writing: Writing, body: Any) -> list[Any]:
    """Returns the geoms of a body that are in the groups of which the compiler counts the mass."""
    said = {"inertiagrouprange": GROUPS, **writing.compiler}
    least, most = writing.counted(writing.root, said, "inertiagrouprange")
    return [
        geom
        for geom in body.findall("geom")
        if least <= writing.counted(geom, {"group": "0", **writing.defaults.of(geom)}, "group")[0] <= most
    ]


def _weighs(writing: Writing, geom: Any) -> bool:
    """Tells whether a geom has mass; MuJoCo keeps the `<inertial>` of a body where none has."""
    said = writing.defaults.of(geom)
    numbers = [writing.values(geom, said[each])[0] for each in ("mass", "density") if each in said]
    return said.get("type") != "plane" and (not numbers or numbers[0] > 0)


def _add_inertial(writing: Writing, body: Any, inertial: Any, to: Any) -> None:
    name, said = f"body {to.get('name')!r}", inertial.attrib
    for attribute in ("pos", "mass"):
        if not said.get(attribute, "").strip():
            raise writing.fault(inertial, f"the <inertial> of {name} has no {attribute}")
    if writing.counted(inertial, said, "mass")[0] < 0:
        raise writing.fault(inertial, f"{name} has the mass {said['mass']!r}; expected a number >= 0")
    moments = [each for each in MOMENTS if each in said]
    turns = [each for each in TURNS if each in said]
    if len(moments) > 1 or (moments == ["fullinertia"] and turns):
        both = " and ".join((*moments, *turns))
        raise writing.fault(inertial, f"the <inertial> of {name} has {both}; valid: diaginertia turned, or fullinertia")
    if not moments and body.find("body") is None and body.xpath("joint | freejoint"):
        expected = "diaginertia or fullinertia, without which what moves is a point"
        raise writing.fault(inertial, f"the <inertial> of {name} has no inertia; expected {expected}")
    copied = etree.SubElement(to, "inertial")
    writing.copy(inertial, copied, said, (*PLACE, "mass"))
    kind = moments[0] if moments else "diaginertia"
    numbers = writing.counted(inertial, said, kind) if moments else (0.0, 0.0, 0.0)
    copied.set(kind, " ".join(map(repr, _possible(writing, inertial, to.get("name"), numbers))))


def _possible(writing: Writing, inertial: Any, name: str, moments: tuple[float, ...]) -> tuple[float, ...]:
    """Returns moments that a body can have: those of the file, or repaired ones.

    Raises:
        BadFile: no body can have the moments of the file, and repairs are off.
    """
    xx, yy, zz, xy, xz, yz = (*moments, 0.0, 0.0, 0.0)[:6]
    matrix = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    fault = fault_of(matrix)
    if fault is None:
        return moments
    if fault.possible and writing.compiler.get("balanceinertia") == "true":  # as MuJoCo does
        matrix = np.trace(matrix) / 3 * np.eye(3)
    elif writing.repair:
        matrix, writing.faults[name] = nearest(matrix), fault
    else:
        raise writing.fault(
            inertial, f"body {name!r} has an inertia {fault.problem}, {fault.by} (repair=True mends it)"
        )
    return tuple(map(float, matrix[(0, 1, 2, 0, 0, 1), (0, 1, 2, 1, 2, 2)]))[: len(moments)]


def _add_geom(writing: Writing, geom: Any, to: Any) -> None:
    said, name = writing.defaults.of(geom), name_element(geom)
    kind = said.get("type", "mesh" if "mesh" in said else "sphere")
    if kind not in (*SIZES, *MASSLESS):
        valid = ", ".join((*SIZES, *MASSLESS))
        raise writing.fault(geom, f"{name} has the type {kind!r}; valid: {valid}")
    for attribute in ("mass", "density"):
        writing.at_least_zero(geom, said, attribute, name)
    if kind in SIZES and "mesh" not in said:
        placed = ("fromto",) if "fromto" in said else PLACE  # of both, MuJoCo heeds the former
        _check_size(writing, geom, said, kind, name)
        copied = etree.SubElement(to, "geom", type=kind)
        writing.copy(geom, copied, said, (*placed, "size", "mass", "density"))
    elif kind != "plane" and writing.values(geom, said.get("mass", "1"))[0] > 0:
        writing.unread.lose("mass of a mesh", to.get("name"))


def _check_size(writing: Writing, geom: Any, said: Mapping[str, str], kind: str, name: str) -> None:
    least = SIZES[kind][0 if "fromto" in said else 1]
    sizes = writing.values(geom, said["size"]) if said.get("size", "").strip() else ()
    if not least <= len(sizes) <= MOST_SIZES or min(sizes[:least]) <= 0:
        expected = f"{least} number{'s' * (least > 1)} > 0, in m, for a {kind}"
        raise writing.fault(geom, f"{name} has the size {said.get('size', '')!r}; expected {expected}")
    if "fromto" in said:
        ends = np.reshape(writing.counted(geom, said, "fromto"), (2, 3))
        if kind == "sphere" or np.linalg.norm(ends[1] - ends[0]) < SHORTEST:
            expected = "two points apart, and no sphere"
            raise writing.fault(geom, f"{name} has the fromto {said['fromto']!r}; expected {expected}")
