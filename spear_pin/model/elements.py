"""Elements of an XML file, read safely without fetching or expanding anything, and their numbers."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

from lxml import etree

from spear_pin.errors import BadFile, brief
from spear_pin.files import LARGEST, read_bytes
from spear_pin.printable import is_printable

MAX_BYTES, MAX_NUMBER = LARGEST, 1e30
MAX_TAGS, MAX_ATTRIBUTES = 200_000, 1000  # in a file, in an element
DECLARATION = re.compile(rb"<\?xml\s[^>]*?\?>")
SOURCE = "{spear_pin}source"  # attribute of an included element: path of its file
BOM = b"\xef\xbb\xbf"
VERSION = re.compile(rb"version\s*=\s*[\"'][^\"']*[\"']")


def parse(path: str | Path) -> tuple[Path, Any]:
    """Reads an XML file, and returns its path and its root element, without comments and instructions.

    It also accepts an XML declaration of a version other than 1.0, or one that does not come first, and undeclared
    prefixes: URDFs have them, and other readers of URDFs ignore them.

    Raises:
        BadFile: the file is missing, too large, not XML, declares a document type or entities, or has a name with a
            character that cannot be seen or acts on a terminal.
    """
    path, text = Path(path), read_bytes(path, MAX_BYTES)
    if text.count(b"<") > MAX_TAGS:
        raise BadFile(path, f"has more than {MAX_TAGS} tags")
    try:
        root = _parsed(text)
    except etree.XMLSyntaxError as error:
        root = _parsed_leniently(text)
        if root is None:
            raise BadFile(path, f"not well-formed XML: {error.msg}", error.lineno) from None
    if root.getroottree().docinfo.internalDTD is not None:
        raise BadFile(path, "declares a document type; a robot may not (entities are not expanded)")
    for element in root.iter(etree.Element):
        if len(element.attrib) > MAX_ATTRIBUTES:
            raise fault(path, element, f"<{element.tag}> has more than {MAX_ATTRIBUTES} attributes")
        if not is_printable(name := element.get("name", "")):
            problem = f"the name {brief(name)} of <{element.tag}> has a character that cannot be seen: rename it"
            raise fault(path, element, problem)
    return path, root


def _parsed(text: bytes, **options: Any) -> Any:
    parser = etree.XMLParser(
        resolve_entities=False,
        no_network=True,
        load_dtd=False,
        huge_tree=False,
        remove_comments=True,
        remove_pis=True,
        **options,
    )
    root = etree.fromstring(text, parser)
    faults = {entry.type for entry in parser.error_log}
    if not faults <= {etree.ErrorTypes.NS_ERR_UNDEFINED_NAMESPACE}:
        raise etree.XMLSyntaxError(parser.error_log.last_error.message, None, 0, 0)
    return root


def _parsed_leniently(text: bytes) -> Any | None:
    """Returns the root of a text that fails only by its declaration or by undeclared prefixes; None for other texts."""
    declaration = DECLARATION.search(text)
    if declaration is not None:
        first = VERSION.sub(b'version="1.0"', declaration[0]).replace(b"\n", b" ")
        rest = DECLARATION.sub(lambda found: b"\n" * found[0].count(b"\n"), text.removeprefix(BOM))
        text = first + rest  # every line keeps its number
    try:
        root = _parsed(text, recover=True)
    except etree.XMLSyntaxError:
        return None
    for element in root.iter(etree.Element) if root is not None else ():
        prefix, colon, name = element.tag.partition(":")
        if colon and not prefix.startswith("{"):
            element.tag = f"{{{prefix}}}{name}"
    return root


def fault(path: Path, element: Any, problem: str) -> BadFile:
    """Makes an error at an element, with its line, in the file from which it was included if any (`SOURCE`)."""
    return BadFile(element.get(SOURCE, path), problem, element.sourceline)


def name_element(element: Any) -> str:
    """Returns an element's name for errors: its own name, or that of the body on which it is."""
    names = (each.get("name") for each in (element, *element.iterancestors()))
    name = next((name for name in names if name), None)
    of = "" if name is None else f" {name!r}" if element.get("name") else f" of {name!r}"
    return f"<{etree.QName(element).localname}>{of}"


def child(path: Path, element: Any, tag: str) -> Any:
    """Returns the child with that tag.

    Raises:
        BadFile: there is no such child.
    """
    found = element.find(tag)
    if found is None:
        name = element.get("name") or element.getparent().get("name")
        raise fault(path, element, f"<{element.tag}> of {name!r} has no <{tag}>")
    return found


def number(path: Path, element: Any, attribute: str, default: str | None = None, limit: bool = False) -> float:
    """Returns an attribute that is one number, or a limit, see `parse_limit`."""
    return (parse_limit if limit else parse_number)(path, element, _said(path, element, attribute, default))


def numbers(path: Path, element: Any, attribute: str, count: int) -> list[float]:
    """Returns an attribute of `count` numbers."""
    values = [parse_number(path, element, part) for part in (element.get(attribute) or "").split()]
    if len(values) != count:
        what = f"{attribute} of {name_element(element)} is {_said(path, element, attribute)!r}"
        raise fault(path, element, f"{what}; expected {count} number{'s' * (count > 1)}")
    return values


def parse_limit(path: Path, element: Any, text: str | None) -> float:
    """Reads a limit; returns infinity if it is larger than any limit, as "inf", 1.8e308 and 3.4e38 are.

    Raises:
        BadFile: the text is no number; the message names the element.
    """
    value = _value(text)
    return math.copysign(math.inf, value) if abs(value) > MAX_NUMBER else parse_number(path, element, text)


def parse_number(path: Path, element: Any, text: str | None) -> float:
    """Reads a finite number, in any notation that Python reads.

    Raises:
        BadFile: the text is no finite number; the message names the element.
    """
    value = _value(text)
    if not abs(value) <= MAX_NUMBER:
        had = "no value" if text is None else f"the value {text!r}"
        raise fault(path, element, f"{name_element(element)} has {had}; expected a finite number")
    return value


def _said(path: Path, element: Any, attribute: str, default: str | None = None) -> str:
    text = element.get(attribute, default)
    if text is None:
        raise fault(path, element, f"{name_element(element)} has no {attribute}; expected a number")
    return str(text)


def _value(text: str | None) -> float:
    try:
        return float(text or "")
    except ValueError:
        return math.nan
