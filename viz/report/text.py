"""Text of the report as HTML: numbers, symbols with their indices, and the little Markdown of the errata.

It does not use a library for Markdown, because indices, links without targets and framed tables would need rules of our
own there, too.
"""

from __future__ import annotations

import math
import re
from typing import TypeAlias

from markupsafe import Markup, escape

from spear_pin.studies.audit.statements.criteria import Value

SUBSCRIPT = re.compile(r"(?<![\w./-])([^\W\d_]{1,2}[\u0300-\u036f]?)_([A-Za-z0-9]+)")  # of k_rot, not of long_stride
SUPERSCRIPT = re.compile(r"\^([A-Za-z]+)")
INLINE = (
    (re.compile(r"`([^`]+)`"), r"<code>\1</code>"),
    (re.compile(r"\[([^\]]+)\]\([^)]+\)"), r"\1"),
    (re.compile(r"(?<!\*)\*([^*]+)\*(?!\*)"), r"<em>\1</em>"),
)
DIGITS = 4

Table: TypeAlias = list[list[str]]


def symbols(words: str) -> Markup:
    """Returns words with the indices of their symbols."""
    return Markup(SUPERSCRIPT.sub(r"<sup>\1</sup>", SUBSCRIPT.sub(r"\1<sub>\2</sub>", str(escape(words)))))


def number(value: float) -> Markup:
    """Formats a number with four digits, a power of ten where it is far from one, and a minus sign."""
    if value == 0.0:
        return Markup("0")
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 6:
        plain = f"{value:.{max(DIGITS - 1 - exponent, 0)}f}"
        return Markup((plain.rstrip("0").rstrip(".") if "." in plain else plain).replace("-", "−"))
    mantissa, power = f"{value:.{DIGITS - 2}e}".split("e")
    return Markup(f"{mantissa}·10<sup>{int(power)}</sup>".replace("-", "−"))


def numbers(value: Value, unit: str = "") -> Markup:
    """Formats numbers with their unit."""
    shown = Markup("; ").join(map(number, value)) if isinstance(value, tuple) else number(value)
    return Markup("{} {}").format(shown, unit).rstrip()


def blocks(source: str) -> list[str | Table]:
    """Splits Markdown into paragraphs and tables; a table is rows of cells, with the head first."""
    return [_rows(block) if block.startswith("|") else block for block in source.split("\n\n")]


def _rows(block: str) -> Table:
    head, _, *body = ([cell.strip() for cell in line.strip("|").split("|")] for line in block.splitlines())
    return [head, *body]


def prose(block: str) -> Markup:
    """Formats a paragraph or cell of Markdown; links lose their targets, which are not in the report."""
    escaped = str(symbols(block))
    for pattern, replacement in INLINE:
        escaped = pattern.sub(replacement, escaped)
    return Markup(escaped)
