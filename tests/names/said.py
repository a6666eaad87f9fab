"""Numbers by name, out of what commands print and files hold."""

import contextlib
import io
import json
import math
import re
from collections.abc import Iterator, Mapping
from typing import Any

from spear_pin import cli

WORDS = {  # labels of prints and tables that are more than their names with blanks
    "peak normal force": "peak_force",
    "peak ground force": "peak_force",
    "motors' work, positive": "positive_work",
    "motors' work, |power|": "absolute_work",
    "motors' work, net": "work",
    "distance a cycle": "stride",
    "spring's share": "spring_share",
    "apex of the hip": "apex_height",
}
BESIDE = (", a pair", ", one motor")  # what a label adds to a name
SCALES = {"°": math.pi / 180.0, "%": 0.01, "mm": 1e-3}
NUMBER = r"[-−]?\d+(?:\.\d+)?(?:e[-+]\d+)?"


def command(*words: object) -> dict[str, Any]:
    """What a command prints as JSON."""
    return dict(json.loads(_printed(*words, "--json")))


def text(*words: object) -> dict[str, str]:
    """What a command prints as text: rows of two columns by their labels."""
    rows = (re.split(r"\s{2,}", line.rstrip(), maxsplit=1) for line in _printed(*words).splitlines())
    return {row[0]: row[1] for row in rows if len(row) == 2 and row[0]}


def _printed(*words: object) -> str:
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = cli.main([str(word) for word in words])
    if status:
        raise AssertionError(f"spear {' '.join(map(str, words))}: {err.getvalue()}")
    return out.getvalue()


def numbers(values: Mapping[str, Any]) -> Iterator[tuple[str, float]]:
    """All numbers of nested tables, by their names from the outside in; lists are left out but for pairs of a range."""
    for name, value in values.items():
        if isinstance(value, Mapping):
            yield from ((f"{name}_{inner}", each) for inner, each in numbers(value))
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            yield name, float(value)


def called(label: str) -> str:
    """The name that a label stands for."""
    for part in BESIDE:
        label = label.replace(part, "")
    for words, name in WORDS.items():
        if label.startswith(words):
            label = name + label.removeprefix(words)
            break
    return label.replace(", ", "_").replace(" ", "_")


def first_number(row: str) -> tuple[float, float] | None:
    """The first number of a row of text in SI units, and half of its last digit."""
    found = re.match(rf"({NUMBER})\s?(°|%|mm\b)?", row)
    if found is None:
        return None
    digits, scale = found[1].replace("−", "-"), SCALES.get(found[2] or "", 1.0)
    mantissa, _, power = digits.partition("e")
    last = 10.0 ** (-len(mantissa.partition(".")[2]) + int(power or 0))
    return scale * float(digits), scale * 0.5 * last
