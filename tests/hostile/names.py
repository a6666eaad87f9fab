"""Names: of files, robots, links and joints, that act on a terminal, a shell, XML or a page."""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from pathlib import Path

from tests.hostile.case import Hostile
from tests.hostile.data import HARM
from tests.hostile.robots import LEG, urdf
from tests.wrong_calls.files import record, trajectory

SCRIPTS = {  # what would run, if a page took it for its own
    "a script": "<script>window.hacked=1</script>",
    "the end of a script": "</script><script>window.hacked=1</script>",
    "a picture": "<img src=x onerror=window.hacked=1>",
    "the end of an attribute": '"><svg onload=window.hacked=1>',
    "the end of the other attribute": "'><svg onload=window.hacked=1>",
    "an attribute": '" onmouseover="window.hacked=1" autofocus onfocus="window.hacked=1',
    "a comment": "<!--<script>--><script>window.hacked=1</script>",
    "a template": "{{ 1/0 }}{% raw %}${window.hacked=1}`${window.hacked=1}`",
    "a key of prototypes": "__proto__",
    "the end of a text": "\\u0027;window.hacked=1;//\\",
    "a frame": "<iframe srcdoc='<script>parent.hacked=1</script>'></iframe>",
    "a style": "</style><style>@import 'http://127.0.0.1:9/'</style><base href='http://127.0.0.1:9/'>",
}
FILES = {
    **{f"with {what}": text for what, text in HARM.items() if what != "lone surrogates"},
    "that is no UTF-8": "\udcff\udc9b",
    "of a command": "$(touch hacked)`touch hacked`;touch hacked",
    "of dashes": "----",
    "of an option": "--help",
    "of 240 letters": "x" * 240,
    "of a script": "<script>",
    "of blanks": "   ",
    "of quotes": "'\"'\"",
    "of a pattern": "*[a-z]?{a,b}",
    "of a percent sign": "%s%n%x",
    "of braces": "{0.__class__}",
}
IN_XML = (
    {what: text for what, text in HARM.items() if what not in ("escapes", "lone surrogates")}
    | SCRIPTS
    | {
        "dashes": "--",
        "dashes at both ends": "--a-->",
        "1000 dashes": "-" * 1000,
        "the end of CDATA": "]]>",
    }
)


def cases() -> Iterator[Hostile]:
    """Every name."""
    for what, name in FILES.items():
        yield Hostile(("dynamics", f"./{name}.urdf"), _robot(f"{name}.urdf"), f"a robot's file {what}")
        yield Hostile(
            ("export", f"./{name}.urdf", "--mjcf"), _robot(f"{name}.urdf"), f"a robot's file {what}, exported"
        )
        yield Hostile(("export", f"./{name}.npz", "--csv"), _trajectory(f"{name}.npz"), f"a trajectory's file {what}")
        yield Hostile(("identify", f"./{name}.csv"), _record(f"{name}.csv"), f"a log {what}")
    for what, text in IN_XML.items():
        for words in (("dynamics", "a.urdf"), ("export", "a.urdf", "--mjcf", "--srdf")):
            yield Hostile(words, _named(text), f"a robot, a link and a joint with {what}")


def quoted(name: str) -> str:
    """A name as an attribute of XML has it."""
    return "".join(char if char.isprintable() else f"&#{ord(char)};" for char in escape(name))


def named(text: str) -> str:
    """A leg whose robot, links and joint are called so."""
    name = quoted(text)
    return f'<robot name="{name}">{LEG}</robot>'.replace("knee", f"knee{name}").replace("shank", f"shank{name}")


def _named(text: str):
    return lambda folder: (folder / "a.urdf").write_text(named(text), encoding="utf-8")


def _robot(name: str):
    return lambda folder: (folder / name).write_text(urdf())


def _trajectory(name: str):
    return lambda folder: trajectory(Path(folder) / name)


def _record(name: str):
    return lambda folder: record(Path(folder) / name)
