"""Text of the report as HTML: numbers, symbols with their indices, and the little Markdown of the errata."""

from __future__ import annotations

import html
import math
import re

from spear_pin.studies.audit.statements.criteria import Value

SUBSCRIPT = re.compile(r"(?<![\w./-])([^\W\d_]{1,2}[\u0300-\u036f]?)_([A-Za-z0-9]+)")  # of k_rot, not of long_stride
SUPERSCRIPT = re.compile(r"\^([A-Za-z]+)")
INLINE = (
    (re.compile(r"`([^`]+)`"), r"<code>\1</code>"),
    (re.compile(r"\[([^\]]+)\]\([^)]+\)"), r"\1"),
    (re.compile(r"(?<!\*)\*([^*]+)\*(?!\*)"), r"<em>\1</em>"),
)
DIGITS = 4


def text(words: str) -> str:
    """Words with the indices of their symbols, escaped."""
    return SUPERSCRIPT.sub(r"<sup>\1</sup>", SUBSCRIPT.sub(r"\1<sub>\2</sub>", html.escape(words)))


def number(value: float) -> str:
    """A number to four digits, a power of ten where it is far from one, with a minus sign."""
    if value == 0.0:
        return "0"
    exponent = math.floor(math.log10(abs(value)))
    if -4 <= exponent < 6:
        plain = f"{value:.{max(DIGITS - 1 - exponent, 0)}f}"
        return (plain.rstrip("0").rstrip(".") if "." in plain else plain).replace("-", "−")
    mantissa, power = f"{value:.{DIGITS - 2}e}".split("e")
    return f"{mantissa}·10<sup>{int(power)}</sup>".replace("-", "−")


def numbers(value: Value, unit: str = "") -> str:
    """Numbers with their unit."""
    shown = "; ".join(map(number, value)) if isinstance(value, tuple) else number(value)
    return f"{shown} {html.escape(unit)}".rstrip()


def markdown(source: str) -> str:
    """Paragraphs and tables; links lose their targets, which are not in the report."""
    return "".join(
        _table(block) if block.startswith("|") else f"<p>{_inline(block)}</p>" for block in source.split("\n\n")
    )


def _inline(block: str) -> str:
    escaped = text(block)
    for pattern, replacement in INLINE:
        escaped = pattern.sub(replacement, escaped)
    return escaped


def _table(block: str) -> str:
    head, _, *body = ([cell.strip() for cell in line.strip("|").split("|")] for line in block.splitlines())
    rows = [head, *body]
    cells = [
        "".join(f"<{tag}>{_inline(cell)}</{tag}>" for cell in row)
        for row, tag in zip(rows, ["th", *["td"] * len(body)], strict=True)
    ]
    return f'<div class="wide"><table class="data">{"".join(f"<tr>{row}</tr>" for row in cells)}</table></div>'
