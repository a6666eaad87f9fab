"""The gallery: every program in `examples/` is run as a reader would, and shown with what it drew and printed.

Not by sphinx-gallery: it runs programs inside its own process, and shows neither the pages nor the files they write.
The directive `player` shows such a page anywhere: the name of the example, then that of the page, and what its address
says, for which there is more room.
"""

import ast
import html
import os
import shutil
import subprocess
import sys
import tempfile
import time
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import kept
from docutils import nodes
from sphinx.application import Sphinx
from sphinx.errors import ExtensionError
from sphinx.util import logging
from sphinx.util.docutils import SphinxDirective

from spear_pin.viz import chromium
from spear_pin.viz.video import STYLE

ROOT = Path(__file__).parents[2]
PRINTED, PROGRAM, READ = "printed.txt", "program.txt", "read.json"  # of an example: kept beside what it drew
THUMBNAILS = "thumbnails"
ROBOTS = ("hop", "bound", "biped", "your_own_urdf")  # whose figures look like each other, and whose robots do not
SEEN = 0.05  # s: when they are seen, all on a foot
ALONE = f"<style>{STYLE} header, footer, aside {{ display: none !important }}</style></head>"

logger = logging.getLogger(__name__)


@dataclass(frozen=True)
class Example:
    """A program and the folder that it writes into."""

    path: Path
    folder: Path

    @property
    def name(self) -> str:
        """Its name, which its page has, too."""
        return self.path.stem

    @property
    def pictures(self) -> list[str]:
        """Names of the pictures it drew."""
        return sorted(path.name for path in self.folder.iterdir() if path.suffix in (".svg", ".png"))

    @property
    def players(self) -> list[str]:
        """Names of the pages it recorded."""
        return sorted(path.name for path in self.folder.glob("*.html"))

    @property
    def text(self) -> tuple[str, str]:
        """What it does in a sentence, and the rest of its docstring, as Markdown."""
        docstring = ast.get_docstring(ast.parse(self.path.read_text(encoding="utf-8"))) or ""
        sentence, _, rest = docstring.replace("<", "\\<").partition("\n\n")
        return " ".join(sentence.split()), rest

    @property
    def up_to_date(self) -> bool:
        """Whether it, and all that it read of the package, is as it was when it was run."""
        program = self.folder / PROGRAM
        return (
            (self.folder / PRINTED).is_file()
            and program.is_file()
            and program.read_bytes() == self.path.read_bytes()
            and kept.still_holds(self.folder / READ)
        )


def examples(gallery: Path) -> list[Example]:
    """All programs, in the order of the page on examples."""
    listed = (ROOT / "docs" / "how_to" / "examples.md").read_text(encoding="utf-8")
    paths = sorted((ROOT / "examples").glob("*.py"), key=lambda path: listed.find(f"/examples/{path.name})"))
    return [Example(path, gallery / path.stem) for path in paths]


def run(example: Example) -> str | None:
    """Run a program in its folder; what went wrong, if anything did."""
    if example.up_to_date:
        return None
    shutil.rmtree(example.folder, ignore_errors=True)
    example.folder.mkdir(parents=True)
    environment = os.environ | {"MPLBACKEND": "Agg", "PYTHONPATH": str(ROOT), "PYTHONIOENCODING": "utf-8"}
    begin = time.monotonic()
    done = subprocess.run(
        [sys.executable, kept.__file__, example.path, READ],
        cwd=example.folder,
        env=environment,
        capture_output=True,
        encoding="utf-8",
    )
    logger.info("example %s: %.0f s", example.name, time.monotonic() - begin)
    if done.returncode != 0:
        return f"{example.path.name} failed:\n{done.stderr}"
    if not example.pictures:
        return f"{example.path.name} drew no picture"
    shutil.copyfile(example.path, example.folder / PROGRAM)
    (example.folder / PRINTED).write_text(done.stdout, encoding="utf-8")
    return None


def thumbnail(example: Example) -> str:
    """Path from the gallery of what its card shows: the first picture or, with a Chromium, the robot on its page."""
    drawn = f"{example.name}/{example.pictures[0]}"
    if example.name not in ROBOTS or not example.players or chromium.find() is None:
        return drawn
    seen = example.folder.parent / THUMBNAILS / f"{example.name}.png"
    made = example.folder / example.players[0]
    if not seen.is_file() or seen.stat().st_mtime < made.stat().st_mtime:
        seen.parent.mkdir(exist_ok=True)
        with tempfile.TemporaryDirectory() as folder, chromium.Browser(480, 360) as browser:
            alone = Path(folder) / "page.html"
            alone.write_text(made.read_text(encoding="utf-8").replace("</head>", ALONE, 1), encoding="utf-8")
            browser.open(alone, f"#t={SEEN}")
            seen.write_bytes(browser.capture())
    return f"{THUMBNAILS}/{seen.name}"


class Player(SphinxDirective):
    """A page that an example recorded, in a frame, and a link to it."""

    required_arguments, optional_arguments = 2, 1

    def run(self) -> list[nodes.Node]:
        """The frame, at the place where `copy_players` puts its page."""
        example, name, *shown = self.arguments
        if not (Path(self.env.srcdir) / "gallery" / example / name).is_file():
            raise self.error(f"the example {example} recorded no page {name}")
        address = "../" * self.env.docname.count("/") + f"play/{example}/{name}"
        kind, fragment = ("player tall", f"#{html.escape(shown[0])}") if shown else ("player", "")
        text = (
            f'<iframe class="{kind}" src="{address}{fragment}" title="{name}" loading="lazy"></iframe>\n'
            f'<p><a href="{address}">{name} on a page of its own</a></p>'
        )
        return [nodes.raw("", text, format="html")]


def page(example: Example) -> str:
    """The page of an example, which stands beside its folder."""
    sentence, rest = example.text
    pictures = "\n\n".join(f"![{name}, drawn by the program]({example.name}/{name})" for name in example.pictures)
    players = "".join(f"\n```{{player}} {example.name} {name}\n```\n" for name in example.players)
    return f"""# {example.name}

{sentence}

{rest}

{pictures}
{players}
## What it prints

```{{literalinclude}} {example.name}/{PRINTED}
:language: none
```

## The program

```{{literalinclude}} ../../examples/{example.path.name}
```
"""


def index(shown: list[Example]) -> str:
    """The first page: a card for each example."""
    cards = "\n".join(
        f":::{{grid-item-card}} {example.name}\n:link: {example.name}\n:link-type: doc\n"
        f":img-top: {thumbnail(example)}\n{example.text[0]}\n:::"
        for example in shown
    )
    names = "\n".join(example.name for example in shown)
    return f"""# Gallery

Every figure here is drawn by the program it stands for, and every robot seen on the page that it records, when this
site was built.

::::{{grid}} 1 2 2 3
{cards}
::::

```{{toctree}}
:hidden:

{names}
```
"""


def make(app: Sphinx) -> None:
    """Run the examples, two and more at a time, and write their pages."""
    gallery = Path(app.srcdir) / "gallery"
    shown = examples(gallery)
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        failures = [failure for failure in pool.map(run, shown) if failure]
    if failures:
        raise ExtensionError("\n".join(failures))
    for example in shown:
        (gallery / f"{example.name}.md").write_text(page(example), encoding="utf-8")
    (gallery / "index.md").write_text(index(shown), encoding="utf-8")


def copy_players(app: Sphinx, exception: Exception | None) -> None:
    """Put the recorded pages where the gallery's links lead."""
    if exception is None:
        for example in examples(Path(app.srcdir) / "gallery"):
            for name in example.players:
                target = Path(app.outdir) / "play" / example.name / name
                target.parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(example.folder / name, target)


def setup(app: Sphinx) -> dict[str, Any]:
    """Listen to the build's beginning and end."""
    app.add_directive("player", Player)
    app.connect("builder-inited", make)
    app.connect("build-finished", copy_players)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
