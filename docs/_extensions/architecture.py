"""The floor plan of the package and the path of a hop through it, drawn from the code where the docs are built."""

from __future__ import annotations

import ast
import os
import sys
import tomllib
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cache
from html import escape
from importlib import import_module
from pathlib import Path
from types import CodeType, FrameType
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "spear_pin"
WIDTH, FLOOR, GAP, NAMES = 1000, 74, 34, 110  # of the drawing, in px
DEEPEST = 5  # calls within a hop that are shown


@dataclass(frozen=True)
class Room:
    """Modules of one folder.

    Attributes:
        name: the folder below its floor; empty for the floor's own files.
        modules: by name the first line of its docstring, and its number of lines.
    """

    name: str
    modules: dict[str, tuple[str, int]]

    @property
    def lines(self) -> int:
        """Number of lines."""
        return sum(lines for _, lines in self.modules.values())


def floors() -> list[str]:
    """The floors from top to bottom, as import-linter holds them."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    layers = settings["tool"]["importlinter"]["contracts"][0]["layers"]
    names = [name.strip("()") for layer in layers for name in map(str.strip, layer.split("|"))]
    return [name for name in names if (PACKAGE / name / "__init__.py").exists() or (PACKAGE / f"{name}.py").exists()]


def modules(folder: Path) -> list[Path]:
    """Files of Python below a folder, through links as well."""
    found = [Path(at) / name for at, _, names in os.walk(folder, followlinks=True) for name in names]
    return sorted(path for path in found if path.suffix == ".py")


def rooms(floor: str) -> list[Room]:
    """The rooms of a floor, its own files first."""
    folder = PACKAGE / floor
    paths = modules(folder) if folder.is_dir() else [folder.with_suffix(".py")]
    found: dict[str, dict[str, tuple[str, int]]] = {}
    for path in paths:
        text = path.read_text(encoding="utf-8")
        says = (ast.get_docstring(ast.parse(text)) or "").split("\n", 1)[0]
        room = "/".join(path.relative_to(folder).parts[:-1]) if folder.is_dir() else ""
        found.setdefault(room, {})[path.stem] = says, text.count("\n")
    return [Room(name, found[name]) for name in sorted(found)]


def imports() -> Counter[tuple[str, str]]:
    """How many modules of one floor import from another."""
    counts: Counter[tuple[str, str]] = Counter()
    for path in modules(PACKAGE):
        floor = path.relative_to(PACKAGE).parts[0].removesuffix(".py")
        tree = ast.parse(path.read_text(encoding="utf-8"))
        froms = (node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom))
        targets = {name.split(".")[1] for name in froms if name.startswith("spear_pin.")}
        counts.update((floor, target) for target in targets - {floor})
    return counts


def floor_plan() -> str:
    """The drawing, as SVG: a box for each room, as wide as it has lines."""
    plan = {floor: rooms(floor) for floor in floors() if (PACKAGE / floor).is_dir() and floor != "urdf"}
    widest = max(sum(room.lines for room in each) for each in plan.values())
    counts, parts, height = imports(), [], len(plan) * (FLOOR + GAP)
    for i, (floor, each) in enumerate(plan.items()):
        top, left = i * (FLOOR + GAP), float(NAMES)
        parts.append(f'<text x="0" y="{top + 32}" class="floor">{floor}</text>')
        parts.append(f'<text x="0" y="{top + 52}" class="small">{sum(room.lines for room in each):,} lines</text>')
        for room in each:
            width = (WIDTH - NAMES) * room.lines / widest
            titles = "\n".join(f"{name}: {says}" for name, (says, _) in room.modules.items())
            parts.append(f'<g><title>{escape(titles)}</title><rect x="{left:.1f}" y="{top}" width="{width:.1f}" ')
            parts.append(f'height="{FLOOR}" rx="4"/>')
            if width > 60:
                name = room.name.rsplit("/", 1)[-1] or "files of its own"
                parts.append(f'<text x="{left + 8:.1f}" y="{top + 30}">{name}</text>')
                parts.append(f'<text x="{left + 8:.1f}" y="{top + 50}" class="small">{len(room.modules)} files</text>')
            parts.append("</g>")
            left += width
        below = [f"{count} from {name}" for name, count in asked(counts, floor) if name in plan]
        if below:
            text = "asks: " + ", ".join(below)
            parts.append(f'<text x="{NAMES}" y="{top + FLOOR + 20}" class="small">{text}</text>')
    style = (
        "text{font:15px sans-serif;fill:currentColor}.small{font-size:12px;opacity:.75}.floor{font-weight:600}"
        "rect{fill:currentColor;fill-opacity:.08;stroke:currentColor;stroke-opacity:.5}"
    )
    return (
        f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="Floors and rooms of the package" '
        f'style="width:100%"><style>{style}</style>{"".join(parts)}</svg>'
    )


def asked(counts: Counter[tuple[str, str]], floor: str) -> Iterator[tuple[str, int]]:
    """The floors that a floor imports from, the most asked first."""
    for (asker, target), count in counts.most_common():
        if asker == floor:
            yield target, count


@dataclass
class Call:
    """A function that a hop goes through.

    Attributes:
        name: with its module, as in "hybrid.run.run".
        says: the first line of its docstring.
        calls: what it calls, in the order of the first calls.
    """

    name: str
    says: str
    calls: list[Call] = field(default_factory=list)


def path_of_a_hop() -> Call:
    """Public functions of the floors from `gaits` down that a hop goes through, each where it is called first."""
    from spear_pin import hopping, load
    from spear_pin.hybrid.result import Options
    from spear_pin.hybrid.run import run

    system = hopping(load("spear_ii", locked=["boom_x"]))
    top = Call("", "")
    open_calls, seen = [top], set[str]()
    frames: list[bool] = []

    def watch(frame: FrameType, event: str, argument: Any) -> None:
        if event == "call":
            entered = described(frame.f_code)
            new = entered is not None and entered.name not in seen and len(open_calls) <= DEEPEST
            if entered is not None and new:
                seen.add(entered.name)
                open_calls[-1].calls.append(entered)
                open_calls.append(entered)
            frames.append(new)
        elif event == "return" and frames and frames.pop():
            open_calls.pop()

    sys.setprofile(watch)
    try:
        run(system, system.guess(), 1, Options(1e-8))
    finally:
        sys.setprofile(None)
    return next(call for call in top.calls if call.name == "hybrid.run.run")


@cache
def described(code: CodeType) -> Call | None:
    """The function that code is of, if it is a public one of these floors with a docstring."""
    path, name = Path(code.co_filename), code.co_qualname
    if PACKAGE not in path.parents or "<" in name or any(part.startswith("_") for part in name.split(".")):
        return None
    module = ".".join(path.relative_to(PACKAGE).with_suffix("").parts)
    if module.split(".")[0] not in ("gaits", "hybrid", "model"):
        return None
    found: Any = import_module(f"spear_pin.{module}")
    for part in name.split("."):
        found = getattr(found, part, None)
    if not callable(found) or not found.__doc__:  # properties are left out
        return None
    return Call(f"{module}.{name}", found.__doc__.split("\n", 1)[0])


def listed(calls: list[Call]) -> str:
    """Calls as a nested list, as HTML."""
    items = (f"<li><code>{escape(c.name)}</code> {escape(c.says)}{listed(c.calls)}</li>" for c in calls)
    return f"<ol>{''.join(items)}</ol>" if calls else ""


def directory() -> str:
    """Every module with what it says of itself, as HTML."""
    parts = []
    for floor in floors():
        for room in rooms(floor):
            where = f"{floor}/{room.name}".rstrip("/") if (PACKAGE / floor).is_dir() else floor
            rows = (f"<dt><code>{name}</code></dt><dd>{escape(says)}</dd>" for name, (says, _) in room.modules.items())
            parts.append(f"<details><summary><code>{where}</code>: {len(room.modules)} files</summary><dl>")
            parts.append("".join(rows) + "</dl></details>")
    return "".join(parts)


class Drawn(SphinxDirective):
    """HTML that a function makes."""

    MAKERS = {"floor-plan": floor_plan, "hop-path": lambda: listed([path_of_a_hop()]), "directory": directory}

    def run(self) -> list[nodes.Node]:
        """The HTML."""
        for path in modules(PACKAGE):
            self.env.note_dependency(str(path))
        return [nodes.raw("", self.MAKERS[self.name](), format="html")]


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directives."""
    for name in Drawn.MAKERS:
        app.add_directive(name, Drawn)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
