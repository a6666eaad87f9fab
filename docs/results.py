"""Measures tables of docs/results again and puts them into their pages: `python -m docs.results [WORD ...] [--list]`.

A table stands between `<!-- made by: COMMAND -->` and `<!-- end -->`. The command is run, and the Markdown tables that
it prints go to the places that name it, in their order, each with the day and the machine. Words choose commands that
contain one of them. A command that fails or prints fewer tables changes nothing.
"""

from __future__ import annotations

import argparse
import datetime
import os
import platform
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

PAGES = Path(__file__).parent / "results"
PLACE = re.compile(r"<!-- made by: (?P<command>.+?) -->\n(?P<made>.*?)<!-- end -->\n", re.DOTALL)
TABLE = re.compile(r"^\|.*\|\n\|(?: ?:?-+:? ?\|)+\n(?:\|.*\|\n)+", re.MULTILINE)
STAMP = re.compile(r"^\*Computed (?:on|between) \d{4}-\d\d-\d\d\b.+\.\*$", re.MULTILINE)


def main() -> None:
    """Run the commands, or list them."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("words", nargs="*", metavar="WORD")
    parser.add_argument("--list", action="store_true", help="only list the commands, with their pages")
    asked = parser.parse_args()
    for command, pages in commands().items():
        if asked.words and not any(word in command for word in asked.words):
            continue
        print(f"{command}  ({', '.join(page.name for page in pages)})", flush=True)
        if not asked.list:
            tables = made_by(command)
            if tables is None:
                print("it prints no table, for want of what it needs: the pages stay as they are")
                continue
            for page in pages:
                text = page.read_text(encoding="utf-8")
                page.write_text(put(text, command, tables, stamp()), encoding="utf-8")


def commands() -> dict[str, list[Path]]:
    """The commands that tables name, each with its pages."""
    found: dict[str, list[Path]] = {}
    for page in sorted(PAGES.glob("*.md")):
        for place in PLACE.finditer(page.read_text(encoding="utf-8")):
            if page not in found.setdefault(place["command"], []):
                found[place["command"]].append(page)
    return found


def made_by(command: str) -> Iterator[str] | None:
    """Tables that a command prints; None if it prints none.

    Raises:
        SystemExit: it fails.
    """
    words = [sys.executable, *command.split()[1:]]
    done = subprocess.run(words, stdout=subprocess.PIPE, text=True, check=False, cwd=PAGES.parents[1])
    print(done.stdout)
    if done.returncode:
        raise SystemExit(f"{command} ends with {done.returncode}")
    found = TABLE.findall(done.stdout)
    return iter(found) if found else None


def put(text: str, command: str, tables: Iterator[str], made: str) -> str:
    """A page with the next tables in the places of a command.

    Raises:
        SystemExit: there are fewer tables than places.
    """

    def filled(place: re.Match[str]) -> str:
        if place["command"] != command:
            return place[0]
        table = next(tables, None)
        if table is None:
            raise SystemExit(f"{command} prints fewer tables than name it")
        return f"<!-- made by: {command} -->\n\n{table}\n{made}\n\n<!-- end -->\n"

    return PLACE.sub(filled, text)


def stamp() -> str:
    """The line below a table: when and where it was made."""
    day = datetime.datetime.now(datetime.UTC).date()
    version = f"Python {platform.python_version()}"
    return f"*Computed on {day}, {os.cpu_count()} cores of {processor()}, {version}.*"


def processor() -> str:
    """What the processor calls itself."""
    about = Path("/proc/cpuinfo")
    found = (
        re.search(r"^model name\s*:\s*(.+)$", about.read_text(encoding="utf-8"), re.MULTILINE)
        if about.exists()
        else None
    )
    return " ".join(found[1].split()) if found else platform.processor() or platform.machine()


if __name__ == "__main__":
    main()
