"""Prose of the audit, from TOML files beside this module."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from typing import Any


def read(name: str) -> dict[str, Any]:
    """Returns the content of a file of this package."""
    return tomllib.loads(files(__package__).joinpath(name).read_text(encoding="utf-8"))


def joined(text: str) -> str:
    """Returns Markdown with each paragraph in one line; tables stay as they are."""
    blocks = text.split("\n\n")
    return "\n\n".join(block if block.startswith("|") else block.replace("\n", " ") for block in blocks)
