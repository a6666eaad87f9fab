"""Imports that README, docs and examples show work."""

import re
from importlib import import_module
from pathlib import Path

import pytest

from tests import documentation

PAGES = [
    *documentation.PAGES,
    *documentation.NOTEBOOKS,
    *(documentation.ROOT / "examples").glob("*.py"),
]
IMPORT = re.compile(r"^ *from (spear_pin[\w.]*) import (\([^)]*\)|[^\n]+)", re.M)


def shown(page: Path) -> list[tuple[str, str]]:
    """Modules and names that a page imports of this package."""
    found = IMPORT.findall(page.read_text(encoding="utf-8"))
    return [(module, name) for module, names in found for name in re.findall(r"(\w+)(?: as \w+)?[,\s)]*", names)]


def has(module: str, name: str) -> bool:
    """Whether `from module import name` works."""
    if hasattr(import_module(module), name):
        return True
    import_module(f"{module}.{name}")
    return True


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_what_is_shown_now(page):
    assert all(has(*each) for each in shown(page))
