"""Prose and numbers of studies, from TOML files beside their modules."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any


def read(package: str, name: str) -> dict[str, Any]:
    """Returns the content of a file of a package, with tuples for lists, and prose with a line for each paragraph."""
    found: dict[str, Any] = _plain(tomllib.loads(files(package).joinpath(name).read_text(encoding="utf-8")))
    return found


def _plain(each: Any) -> Any:
    if isinstance(each, dict):
        return {name: _plain(part) for name, part in each.items()}
    if isinstance(each, list):
        return tuple(map(_plain, each))
    return _joined(each) if isinstance(each, str) else each


def _joined(text: str) -> str:
    """Returns Markdown with each paragraph in one line; tables stay as they are."""
    blocks = text.split("\n\n")
    return "\n\n".join(block if block.startswith("|") else block.replace("\n", " ") for block in blocks)
