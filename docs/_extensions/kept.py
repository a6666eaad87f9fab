"""Keep outputs by the content of what they were made from: folders of the checkout, and versions of libraries.

Run as a program, it runs another one and records what that read: `python kept.py PROGRAM RECORD`. Whole folders are
recorded, so that a process which the program started may read other files of the same package.
"""

import hashlib
import importlib.metadata
import json
import os
import runpy
import sys
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SOURCES = ("spear_pin", "viz", "urdf")  # folders on which what is drawn or computed can depend
LIBRARIES = ("casadi", "heyoka", "matplotlib", "meshcat", "numpy", "pin", "scipy")


def digest(place: Path) -> str:
    """Hash the names and contents of the files in a folder, without those below it, or of one file."""
    found = hashlib.sha256()
    paths = [place] if place.is_file() else sorted(path for path in place.iterdir() if path.is_file())
    for path in paths:
        found.update(path.name.encode() + b"\0" + hashlib.sha256(path.read_bytes()).digest())
    return found.hexdigest()


def environment() -> dict[str, str]:
    """Return the versions of Python and of the libraries that numbers depend on."""
    versions = {"python": sys.version}
    for name in LIBRARIES:
        try:
            versions[name] = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            versions[name] = ""
    return versions


def everything() -> str:
    """Hash all sources and the environment."""
    folders = sorted(path for name in SOURCES for path in (ROOT / name).rglob("*") if path.is_dir())
    parts = [digest(folder) for folder in (*(ROOT / name for name in SOURCES), *folders)]
    return hashlib.sha256(json.dumps([environment(), parts]).encode()).hexdigest()


def record(read: Iterable[str]) -> dict[str, object]:
    """Hash the folders of the package and the data of the examples that were read, and name the environment."""
    files = {path for path in map(Path, read) if path.is_relative_to(ROOT) and path.is_file()}
    folders = {path.parent for path in files if path.relative_to(ROOT).parts[0] in SOURCES}
    data = {path for path in files if path.parent == ROOT / "examples" and path.suffix != ".py"}
    places = {place.relative_to(ROOT).as_posix(): digest(place) for place in sorted(folders | data)}
    return {"environment": environment(), "places": places}


def still_holds(recorded: Path) -> bool:
    """Tell whether everything that a record names is as it was."""
    if not recorded.is_file():
        return False
    known = json.loads(recorded.read_text(encoding="utf-8"))
    return known["environment"] == environment() and all(
        (ROOT / name).exists() and digest(ROOT / name) == value for name, value in known["places"].items()
    )


def main(program: str, recorded: str) -> None:
    """Run a program as `python PROGRAM` would, and write what it read."""
    read: set[str] = set()
    directory = Path.cwd()

    def note(event: str, arguments: tuple[object, ...]) -> None:
        if event == "open" and isinstance(arguments[0], str):
            read.add(arguments[0])

    sys.addaudithook(note)
    sys.argv = [program]
    sys.path[0] = os.path.dirname(program)
    runpy.run_path(program, run_name="__main__")
    modules = {module.__file__ for module in [*sys.modules.values()] if getattr(module, "__file__", None)}
    files = {os.path.realpath(directory / name) for name in read | modules}
    Path(directory / recorded).write_text(json.dumps(record(files), indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
