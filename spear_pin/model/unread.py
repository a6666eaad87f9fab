"""Finds the data in a robot's file that this package does not use, so that one line can name it.

A `Grammar` lists the data that are read in a format. Everything else in the document counts as unused, unless it cannot
change a motion: shapes, colours, sensors, names.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

from lxml import etree

from spear_pin.errors import list_names

NAMED, LONG = (4, 2, 1), 600  # how many owners are named, the fewer the longer the line would be, in characters
NAMES = ("name", "reference")  # attributes that tell which element it is
JOINED = ("joint1", "body1", "geom1", "site1", "tendon1", "joint", "link", "body")  # of one that has no name
ANNOTATIONS = (  # the first two are XML's own
    *("http://www.w3.org/XML", "http://www.w3.org/2001/XMLSchema", "http://www.w3.org/2000/xmlns"),
    *("http://www.ros.org/wiki/xacro", "http://ros.org/wiki/xacro", "xacro", "spear_pin"),
)
NOTHING: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Grammar:
    """The data that are read in a format, and those that never change a motion.

    Attributes:
        read: names of attributes that are read of an element, in one text, by its path from the root, such as
            "robot/joint/limit".
        nested: tags of elements that may be in one of the same tag, as a body in a body; they have the same path.
        kinds: tags of elements whose name tells of what kind they are, not which one.
        single: paths of elements of which a parent has one; a second one is not read.
        idle: tags of elements that change no motion, with all that is in them.
        still: attributes that change no motion, of any element.
        usual: texts of attributes and of elements that change nothing, by the last part of the path and the attribute.
    """

    read: Mapping[str, str]
    nested: frozenset[str] = NOTHING
    kinds: frozenset[str] = NOTHING
    single: frozenset[str] = NOTHING
    idle: frozenset[str] = NOTHING
    still: frozenset[str] = NOTHING
    usual: Mapping[str, Collection[str]] = field(default_factory=dict)

    def idles(self, title: str) -> bool:
        """Tells whether an element of that tag changes no motion; `sensor:ray` counts as `sensor`."""
        return title in self.idle or title.partition(":")[0] in self.idle

    def unusual(self, name: str, text: str | None) -> bool:
        """Tells whether a text differs from those that change nothing."""
        return name not in self.usual or _plain(text or "") not in self.usual[name]


class Unread:
    """Unused data: names of joints, links or bodies by the data that they lose, in the order of the file."""

    def __init__(self) -> None:
        self._owners: dict[tuple[str, str, str], list[str]] = {}

    def lose(self, what: str, owner: str = "", where: str = "", called: str = "") -> None:
        """Adds lost data.

        Args:
            what: the lost data, in words.
            owner: name of the element that loses it; empty if it has none.
            where: element that it stands in, such as "<dynamics>".
            called: its own name, if it has one, which then goes before the owner's.
        """
        self._owners.setdefault((where, called or owner, "" if called else "of "), []).append(what)

    @property
    def line(self) -> str | None:
        """Returns one line that names all lost data, grouped by the owners; None if there are none."""
        alike: dict[tuple[str, str, str], list[str]] = {}
        for (where, owner, of), lost in self._owners.items():
            alike.setdefault((where, ", ".join(dict.fromkeys(lost)), of), []).append(owner)
        text = ""
        for most in NAMED:
            parts = [_part(*key, [owner for owner in owners if owner], most) for key, owners in alike.items()]
            text = f"not taken over: {'; '.join(parts)}"
            if len(text) <= LONG:
                break
        return text if alike else None


def _plain(text: str) -> str:
    """Returns a text in lower case, with numbers in one notation, and equal numbers as one."""
    try:
        numbers = {float(part) for part in text.split()}
    except ValueError:
        return text.strip().lower()
    return f"{numbers.pop():g}" if len(numbers) == 1 else text.strip().lower()


def _part(where: str, lost: str, of: str, owners: list[str], most: int) -> str:
    names = f" {of}{list_names([repr(owner) for owner in owners], most)}" if owners else ""
    inside = f" in {where}" if where else ""
    return f"{lost}{inside}{names}" if of else f"{lost}{names}{inside}"


def find_unread(
    root: Any,
    grammar: Grammar,
    into: Unread,
    said: Callable[[Any], Mapping[str, str]] = lambda element: element.attrib,
    known: Collection[Any] = (),
) -> None:
    """Adds the data of a document that a grammar does not read.

    Args:
        root: root element of the document.
        grammar: grammar of its format.
        into: collection to which the data are added.
        said: returns the attributes of an element, with those of its class.
        known: elements that are read or reported elsewhere, and skipped with all that is in them.
    """
    skipped = set(known)

    def visit(element: Any, path: str, owner: str) -> None:
        tag = path.rpartition("/")[2]
        if "/" in path and tag not in grammar.kinds:  # the robot's own name tells nothing
            owner = _name(element) or owner or _name(element, JOINED)
        read = grammar.read[path].split()
        for name, value in said(element).items():
            ordinary = name in read or name in grammar.still or _annotates(name)
            if not ordinary and grammar.unusual(f"{tag}@{name}", value):
                into.lose(_shown(name, element), owner, f"<{tag}>")
        seen: set[str] = set()
        for child in element.iterchildren(etree.Element):
            title = _title(child)
            below = path if title == tag and tag in grammar.nested else f"{path}/{title}"
            if child in skipped or grammar.idles(title) or _annotates(child.tag):
                continue
            if below in grammar.read and not (below in grammar.single and below in seen):
                seen.add(below)
                visit(child, below, owner)
            elif _matters(child, grammar):
                again = "a second " if below in seen else ""
                called = _name(child) or ("" if owner else _name(child, JOINED))
                inside = f"<{tag}>" if path.count("/") else ""
                inside += f" of {owner!r}" if inside and called and owner else ""
                into.lose(f"{again}<{title}>", owner, inside, called)

    visit(root, _title(root), "")


def _matters(element: Any, grammar: Grammar) -> bool:
    """Tells whether an element that is not read, or an element in it, may change a motion."""
    title = _title(element)
    if grammar.idles(title) or _annotates(element.tag) or not grammar.unusual(title, element.text):
        return False
    children = list(element.iterchildren(etree.Element))
    says = any(name not in grammar.still and name not in NAMES for name in element.attrib)
    return says or not children or any(_matters(child, grammar) for child in children)


def _title(element: Any) -> str:
    """Returns the tag of an element as a file writes it, with its prefix."""
    return _shown(element.tag, element)


def _shown(tag: str, element: Any) -> str:
    if not tag.startswith("{"):
        return tag
    name = etree.QName(tag)
    declared = {uri: prefix for prefix, uri in element.nsmap.items() if prefix} if "/" in name.namespace else {}
    return f"{declared.get(name.namespace, name.namespace)}:{name.localname}"  # `parse` has others as they are written


def _name(element: Any, names: Collection[str] = NAMES) -> str:
    return next((element.get(name) for name in names if element.get(name)), "")


def _annotates(tag: str) -> bool:
    """Tells whether a name is of a namespace that only annotates: XML's own, or that of xacro."""
    return tag.startswith("{") and tag[1:].startswith(ANNOTATIONS)
