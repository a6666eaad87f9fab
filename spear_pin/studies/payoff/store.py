"""Store of a payoff study: a file with one search a line, each with a checksum, so that nothing is searched twice.

The first line says what is studied. Lines are appended as searches end; one that was cut off by a kill is dropped.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spear_pin.errors import BadFile
from spear_pin.files import atomic, parse_json, regular

FORMAT = "spear_pin payoff 1"
DIGITS = 16  # of a checksum, at the beginning of each line


class Store:
    """Lines by their keys, on disk as soon as they are kept.

    Args:
        path: of the file; it is made where there is none.
        asked: what is studied, in JSON's terms; a file of another study is refused.

    Raises:
        BadFile: the file is none, is damaged other than at its end, or is of another study.
    """

    def __init__(self, path: Path, asked: Mapping[str, Any]) -> None:
        self.path = path
        self._lines: dict[str, dict[str, Any]] = {}
        head = json.loads(json.dumps({"format": FORMAT, **asked}))
        if not path.exists():
            with atomic(path) as temporary:
                temporary.write_text(_line(head), encoding="utf-8")
            return
        found = _read(path)
        if not found or found[0].get("format") != FORMAT:
            raise BadFile(path, "is not the store of a payoff study")
        if differing := [name for name in {**head, **found[0]} if head.get(name) != found[0].get(name)]:
            raise BadFile(
                path, f"is of another study, which differs in {', '.join(differing)}; give another --out, or remove it"
            )
        self._lines = {line["key"]: line for line in found[1:]}

    def __len__(self) -> int:
        return len(self._lines)

    def get(self, key: str) -> dict[str, Any] | None:
        """The line of a key, if there is one."""
        return self._lines.get(key)

    def keep(self, line: dict[str, Any]) -> None:
        """Append a line; it is on disk when this returns.

        Raises:
            BadFile: it cannot be written.
        """
        try:
            with open(self.path, "a", encoding="utf-8") as file:
                file.write(_line(line))
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise BadFile(self.path, f"cannot be written: {error.strerror or error}") from None
        self._lines[line["key"]] = line


def digest(value: Any) -> str:
    """A short name of something in JSON's terms."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:DIGITS]


def _line(value: Mapping[str, Any]) -> str:
    text = json.dumps(value, allow_nan=False, separators=(",", ":"))
    return f"{hashlib.sha256(text.encode()).hexdigest()[:DIGITS]} {text}\n"


def _read(path: Path) -> list[dict[str, Any]]:
    """The lines of a file; one at its end that was cut off is removed from it."""
    try:
        text = regular(path).read_bytes().decode("utf-8", errors="replace")
    except OSError as error:
        raise BadFile(path, f"cannot be read: {error.strerror or error}") from None
    *whole, rest = text.split("\n")
    found = []
    for number, line in enumerate(whole, 1):
        mark, _, said = line.partition(" ")
        if hashlib.sha256(said.encode()).hexdigest()[:DIGITS] != mark:
            raise BadFile(path, "is damaged, or not the store of a payoff study", number)
        try:
            found.append(parse_json(said))
        except ValueError as error:
            raise BadFile(path, str(error), number) from None
    if rest:
        with atomic(path) as temporary:
            temporary.write_text("".join(f"{line}\n" for line in whole), encoding="utf-8")
    return found
