"""Finds the data in an MJCF file that this package does not use."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from lxml import etree

from spear_pin.model.grammars import MJCF
from spear_pin.model.mjcf_motors import Drives
from spear_pin.model.mjcf_sections import section
from spear_pin.model.mjcf_writing import TURNS, Writing
from spear_pin.model.unread import find_unread

LEAN = 1e-9  # half of the angle, in rad, by which level ground may lean
CONTACT = "condim friction solref solimp margin gap adhesion surfacevel".split()
# of what other actuators have by a class that they share with motors, which are none of this
SERVO = "kp kv ki dampratio timeconst gaintype gainprm biastype biasprm dyntype dynprm".split()
SMALL = 1e-9  # kg, kg·m²: bounds of inertias that only keep them from being zero


def tell_unread(writing: Writing, others: list[Any], drives: Drives, told: list[Any]) -> None:
    """Adds unused data to `writing.unread`.

    Args:
        writing: state.
        others: bodies beside the robot.
        drives: its actuators.
        told: elements that are noted already.
    """
    unread, root = writing.unread, writing.root

    def said(element: Any) -> dict[str, str]:
        plain = element.getparent() in (None, root) or element.tag == "body"  # of which there are no classes
        attributes = dict(element.attrib) if plain else writing.defaults.of(element)
        return _without_effect(element.tag, attributes)

    ground = [geom for geom in section(root, "worldbody") if geom.tag == "geom" and not _level(writing, said(geom))]
    find_unread(root, MJCF, unread, said, (*others, *drives.elements, *ground, *told))
    for what, name in (
        *(("the bodies beside it", other.get("name") or "nameless") for other in others),
        *(("the ground's shape", geom.get("name") or f"a {said(geom).get('type', 'sphere')}") for geom in ground),
        *drives.unread,
    ):
        unread.lose(what, name)


def _level(writing: Writing, said: Mapping[str, str]) -> bool:
    """Tells whether a geom of the world is ground at height zero, or touches nothing."""
    if said.get("contype") == said.get("conaffinity") == "0":
        return True
    place = writing.values(None, said.get("pos", "0 0 0"))
    turned = etree.Element("geom")
    writing.copy(etree.Element("geom", dict(said)), turned, said, TURNS)
    w, x, y, z = writing.values(None, turned.get("quat", "1 0 0 0"))
    upright = abs(x) + abs(y) < LEAN * max(abs(w), abs(z))
    flat = upright and not any(turned.get(each) for each in TURNS if each != "quat")
    return said.get("type") == "plane" and len(place) == 3 and place[2] == 0.0 and flat


def _without_effect(tag: str, said: Mapping[str, str]) -> dict[str, str]:
    """Leaves out attributes without effect: contact of elements that touch nothing, small bounds of inertias.

    Args:
        tag: tag of the element.
        said: its attributes, with those of its class.
    """
    idle: Any = ()
    if tag == "geom" and said.get("contype") == said.get("conaffinity") == "0":
        idle = CONTACT
    if tag == "motor":
        idle = SERVO
    if tag == "compiler":
        idle = [name for name in ("boundmass", "boundinertia") if _small(said.get(name, "0"))]
    return {name: value for name, value in said.items() if name not in idle}


def _small(text: str) -> bool:
    try:
        return abs(float(text)) <= SMALL
    except ValueError:
        return False
