"""Python in the documentation: its blocks."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
FENCE = r"^```%s\n(.*?)^```$"


def fenced(page: Path, language: str) -> list[str]:
    """The code blocks of a page."""
    return re.findall(FENCE % language, page.read_text(encoding="utf-8"), re.M | re.S)


def blocks() -> dict[str, str]:
    """All blocks of Python, by the name of the page and their number."""
    return {f"{page.name}-{n}": block for page in PAGES for n, block in enumerate(fenced(page, "python"), 1)}
