"""Resolves an MJCF file: puts its includes in place, joins its sections, resolves its defaults."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from lxml import etree

from spear_pin.errors import BadFile
from spear_pin.model.elements import MAX_BYTES, SOURCE, fault, parse

MAX_INCLUDES, MAX_DEPTH = 100, 256
EQUALITY = "equality"
MAIN = "main"  # the class of what names none
ACTUATORS = (
    *("general", "motor", "position", "velocity", "intvelocity", "damper", "cylinder", "muscle", "adhesion"),
    *("orientation", "pid", "dcmotor"),
)
Attributes = Mapping[str, str]
NOTHING: Attributes = MappingProxyType({})


def include(path: Path, root: Any) -> None:
    """Puts the contents of included files in their places.

    Files are read from its folder, or one below, alone; each once.

    Raises:
        BadFile: one is elsewhere, cannot be read, or is included twice; or they are too many, large or deep together.
    """
    folder, seen, size = path.resolve().parent, {path.resolve()}, 0
    while (element := root.find(".//include")) is not None:
        name = element.get("file") or ""
        try:
            target = (folder / name).resolve()
        except (OSError, ValueError, RuntimeError):
            raise fault(path, element, f"includes {name!r}, which is no path of a file") from None
        if not target.is_relative_to(folder):
            raise fault(path, element, f"includes {name!r}, which is not in its folder")
        if target in seen or len(seen) > MAX_INCLUDES:
            problem = "again" if target in seen else f"which is one of more than {MAX_INCLUDES} files"
            raise fault(path, element, f"includes {name!r}, {problem}")
        seen.add(target)
        try:
            _, other = parse(target)
        except BadFile as error:
            if error.line is not None:
                raise
            raise fault(path, element, f"includes {name!r}, which {error.problem}") from None
        for each in other.iter(etree.Element):
            each.set(SOURCE, str(target))
        size += target.stat().st_size
        if size > MAX_BYTES:
            raise BadFile(path, f"includes more than {MAX_BYTES} bytes")
        if sum(1 for _ in element.iterancestors()) + _depth(other) > MAX_DEPTH:
            raise BadFile(path, f"is nested deeper than {MAX_DEPTH} elements with what it includes")
        parent, place = element.getparent(), element.getparent().index(element)
        parent.remove(element)
        for offset, child in enumerate(list(other)):
            parent.insert(place + offset, child)


def _depth(root: Any) -> int:
    level = deepest = 0
    for event, _ in etree.iterwalk(root, events=("start", "end")):
        level += 1 if event == "start" else -1
        deepest = max(deepest, level)
    return deepest


def inherit_classes(root: Any) -> None:
    """Gives the class of a body to all that is in it and names none."""
    for body in root.iter("body"):
        inherited = body.get("childclass")
        for element in body.iterchildren(etree.Element) if inherited else ():
            attribute = "childclass" if element.tag == "body" else "class"
            element.set(attribute, element.get(attribute) or inherited)


def section(root: Any, tag: str) -> list[Any]:
    """Returns the children of all sections of that tag."""
    return [child for part in root.findall(tag) for child in part.iterchildren(etree.Element)]


def settings(root: Any, tag: str) -> dict[str, str]:
    """Returns the attributes of all sections of that tag; the last one counts."""
    return {name: value for part in root.findall(tag) for name, value in part.attrib.items()}


@dataclass(frozen=True)
class Defaults:
    """Attributes that elements have unless they say otherwise.

    Attributes:
        classes: by class, attributes by tag; those of actuators, which share them, stand under "actuator".
    """

    classes: Mapping[str, Mapping[str, Attributes]]

    def of(self, element: Any) -> dict[str, str]:
        """Returns the attributes of an element, its own and those of its class."""
        templates = self.classes.get(element.get("class") or MAIN, {})
        parent = element.getparent()
        tied = parent is not None and parent.tag == EQUALITY  # of which a <joint> is no joint
        return {**templates.get(EQUALITY if tied else _kind(element.tag), NOTHING), **element.attrib}


def read_defaults(path: Path, root: Any) -> Defaults:
    """Reads the defaults of a file; top-level ones apply to all elements, whatever their class's name, as in MuJoCo 3.

    Raises:
        BadFile: a class has no name.
    """
    classes: dict[str, dict[str, dict[str, str]]] = {MAIN: {}}
    tops = root.findall("default")
    for top in tops:
        _collect(path, top, MAIN, {}, classes)
    for name in {top.get("class") for top in tops} - {None}:
        classes.setdefault(str(name), classes[MAIN])
    return Defaults(classes)


def _collect(path: Path, element: Any, name: str, above: Mapping[str, Attributes], classes: dict[str, Any]) -> None:
    templates = {tag: dict(attributes) for tag, attributes in {**above, **classes.get(name, {})}.items()}
    children: Iterable[Any] = list(element.iterchildren(etree.Element))
    for child in children:
        if child.tag != "default":
            templates.setdefault(_kind(child.tag), {}).update(child.attrib)
    classes[name] = templates
    for child in children:
        if child.tag == "default":
            if not child.get("class"):
                raise fault(path, child, "a <default> in another has no class")
            _collect(path, child, child.get("class"), templates, classes)


def _kind(tag: str) -> str:
    return "actuator" if tag in ACTUATORS else tag
