"""Python in the documentation: its blocks."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
MADE = ("api", "gallery", "notebooks")  # by the site, or run by it
PAGES = [
    ROOT / "README.md",
    *sorted(page for page in (ROOT / "docs").rglob("*.md") if not {*MADE} & {*page.relative_to(ROOT).parts}),
]
NOTEBOOKS = sorted((ROOT / "docs" / "tutorials" / "notebooks").glob("*.md"))
FENCE = r"^```%s\n(.*?)^```$"


def fenced(page: Path, language: str) -> list[str]:
    """The code blocks of a page."""
    return re.findall(FENCE % language, page.read_text(encoding="utf-8"), re.M | re.S)


def blocks() -> dict[str, str]:
    """All blocks of Python, by the name of the page and their number."""
    return {f"{page.name}-{n}": block for page in PAGES for n, block in enumerate(fenced(page, "python"), 1)}
