"""Store of a payoff study: a file with one search a line, so that nothing is searched twice.

Each line is a JSON object, one field of which is a checksum of the others. The first line says what is studied. Lines
are appended as searches end. An incomplete line after a kill is dropped.
"""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from spear_pin.errors import BadFile, list_names
from spear_pin.files import parse_json, read_bytes, write_text

FORMAT = "spear_pin payoff 2"
BEFORE = '{"format":"spear_pin payoff 1"'  # of stores whose lines began with the checksum
CHECKSUM = "checksum"
DIGITS = 16  # of it
MAX_BYTES = 200_000_000


class Store:
    """Lines by their keys, on disk as soon as they are kept.

    Args:
        path: path of the file; where there is none, the first line that is kept makes it.
        asked: subject of the study, as JSON; a file of another study is refused.

    Raises:
        BadFile: the file is not a store, is damaged other than at its end, or belongs to another study.
    """

    def __init__(self, path: Path, asked: Mapping[str, Any]) -> None:
        self.path = path
        self._lines: dict[str, dict[str, Any]] = {}
        self._head = head = json.loads(json.dumps({"format": FORMAT, **asked}))
        if not path.exists():
            return
        found = _read(path)
        if not found or found[0].get("format") != FORMAT:
            raise BadFile(path, "is not the store of a payoff study; give another --out, or remove it")
        if differing := [name for name in {**head, **found[0]} if head.get(name) != found[0].get(name)]:
            raise BadFile(
                path, f"is of another study, which differs in {list_names(differing)}; give another --out, or remove it"
            )
        self._lines = {line["key"]: line for line in found[1:]}

    def __len__(self) -> int:
        return len(self._lines)

    def get(self, key: str) -> dict[str, Any] | None:
        """Returns the line with a key, if there is one."""
        return self._lines.get(key)

    def keep(self, line: dict[str, Any]) -> None:
        """Appends a line, the first behind the one that says what is studied; it is on disk when this returns.

        Raises:
            BadFile: the line cannot be written.
        """
        if not self.path.exists():
            write_text(self.path, _line(self._head), at_once=True)
        try:
            with open(self.path, "a", encoding="utf-8") as file:
                file.write(_line(line))
                file.flush()
                os.fsync(file.fileno())
        except OSError as error:
            raise BadFile(self.path, f"cannot be written: {error.strerror or error}") from None
        self._lines[line["key"]] = line


def digest(value: Any) -> str:
    """Returns a short name for JSON data."""
    return hashlib.sha256(json.dumps(value, sort_keys=True).encode()).hexdigest()[:DIGITS]


def _line(value: Mapping[str, Any]) -> str:
    plain = json.loads(json.dumps(value, allow_nan=False))
    return json.dumps({**plain, CHECKSUM: digest(plain)}, separators=(",", ":")) + "\n"


def _read(path: Path) -> list[dict[str, Any]]:
    """Returns the lines of a file; an incomplete one at its end is removed from it."""
    text = read_bytes(path, MAX_BYTES).decode("utf-8", errors="replace")
    *whole, rest = text.split("\n")
    if whole and whole[0][DIGITS + 1 :].startswith(BEFORE):
        raise BadFile(path, "is of an earlier version; give another --out, or remove it")
    found = []
    for number, line in enumerate(whole, 1):
        try:
            said = parse_json(line)
        except ValueError:
            said = None
        mark = said.pop(CHECKSUM, None) if isinstance(said, dict) else None
        if mark is None or mark != digest(said):
            raise BadFile(
                path, "is damaged, or not the store of a payoff study; give another --out, or remove it", number
            )
        found.append(said)
    if rest:
        write_text(path, "".join(f"{line}\n" for line in whole), at_once=True)
    return found
