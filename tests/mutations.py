"""Would the tests notice? Mistakes made on purpose, each in a copy of the repository, and the test that catches it.

From the repository: `python -m tests.mutations`, or with words that the names of some mutations
contain: `python -m tests.mutations spring impact`. It ends with status 1 if one survives, if a text to
change is not found just once, or if the tests fail without any change. All of them take a quarter to three quarters
of an hour on two cores. The tests are those of the gate; with `--quick` it names those that no quick test notices.
"""

from __future__ import annotations

import argparse
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from queue import SimpleQueue

from tests.mistakes import MUTATIONS, Mutation

ROOT = Path(__file__).parents[1]
COPIED = ("spear_pin", "urdf", "viz", "tests", "examples", "pyproject.toml", "README.md", "LICENSE")
LONGEST = 300  # s, of the tests of one mistake


def copy_repository(folder: Path) -> None:
    """What the tests need, symlinks as symlinks."""
    ignored = shutil.ignore_patterns("__pycache__", ".*")
    folder.mkdir()
    for name in COPIED:
        source = ROOT / name
        if source.is_dir():
            shutil.copytree(source, folder / name, symlinks=True, ignore=ignored)
        elif source.exists():
            shutil.copy(source, folder / name)


def first_failure(
    folder: Path, tests: tuple[str, ...], marked: str, workers: int = 0, longest: float | None = LONGEST
) -> str | None:
    """The first test that fails in the copy of those that `-m` chooses, or None."""
    options = ["-x", "-q", "-n", str(workers), "-m", marked, "-p", "no:cacheprovider"]
    command = [sys.executable, "-m", "pytest", *options, *tests]
    environment = os.environ | {"PYTHONDONTWRITEBYTECODE": "1"}
    try:
        process = subprocess.run(
            command, cwd=folder, env=environment, capture_output=True, text=True, timeout=longest, check=False
        )
    except subprocess.TimeoutExpired:
        return f"the time limit of {longest} s"
    if process.returncode == 0:
        return None
    found = re.search(r"^(FAILED|ERROR) (.+?)(?: - .*)?$", process.stdout, re.MULTILINE)
    if found is None:
        return f"pytest's status {process.returncode}"
    return found[2] if found[1] == "FAILED" else f"the setup of {found[2]}"


def trial(folder: Path, mutation: Mutation, marked: str) -> tuple[bool, str]:
    """Whether a mutation is caught, and by what."""
    path = folder / mutation.file
    text = path.read_text(encoding="utf-8")
    if text.count(mutation.old) != 1:
        return False, f"NOT APPLIED: {mutation.file} has the text {text.count(mutation.old)} times"
    path.write_text(text.replace(mutation.old, mutation.new), encoding="utf-8")
    try:
        failure = first_failure(folder, mutation.tests, marked)
    finally:
        path.write_text(text, encoding="utf-8")
    return (True, f"caught by {failure}") if failure else (False, "SURVIVED")


@contextmanager
def lent(copies: SimpleQueue[Path]) -> Iterator[Path]:
    """One of the copies, for as long as a mistake is in it."""
    folder = copies.get()
    try:
        yield folder
    finally:
        copies.put(folder)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.mutations", description=__doc__.splitlines()[0])
    parser.add_argument("words", nargs="*", metavar="WORD", help="only mutations whose name contains one of these")
    parser.add_argument("--list", action="store_true", help="print their names only")
    parser.add_argument("--quick", action="store_true", help="by the tests alone that are not marked slow")
    words, names_only, quick = vars(parser.parse_args()).values()
    marked = "not slow" if quick else "not nightly"
    chosen = [m for m in MUTATIONS if not words or any(word in m.name for word in words)]
    if names_only:
        print("\n".join(mutation.name for mutation in chosen))
        return 0
    survived, workers = 0, os.cpu_count() or 1
    with tempfile.TemporaryDirectory() as name:
        copies: SimpleQueue[Path] = SimpleQueue()
        for number in range(workers):
            copies.put(Path(name, str(number)))
            copy_repository(Path(name, str(number)))
        files = tuple(sorted({test for mutation in chosen for test in mutation.tests}))
        if failure := first_failure(Path(name, "0"), files, marked, workers, None):
            print(f"without any change, {failure} fails")
            return 1

        def tried(mutation: Mutation) -> tuple[bool, str]:
            with lent(copies) as folder:
                return trial(folder, mutation, marked)

        with ThreadPoolExecutor(workers) as pool:
            for mutation, (caught, what) in zip(chosen, pool.map(tried, chosen), strict=True):
                survived += not caught
                print(f"{mutation.name:<55} {what}", flush=True)
    print(f"{len(chosen) - survived} of {len(chosen)} caught")
    return 1 if survived else 0


if __name__ == "__main__":
    raise SystemExit(main())
