"""Pages of robots whose names are scripts, opened in Chromium: none runs, and nothing is asked for."""

from __future__ import annotations

import resource
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace

import numpy as np

from tests.hostile.case import Drawn
from tests.hostile.data import HARM
from tests.hostile.names import SCRIPTS, named

TEXTS = SCRIPTS | {what: text for what, text in HARM.items() if what in ("marks of direction", "no width")}


class Ran(Exception):
    """A page did what a name in it says."""


def playing(folder: Path, text: str) -> Path:
    """A page that plays a robot whose robot, links, joints, phases, events, columns and title are called so."""
    from spear_pin import load
    from spear_pin.viz.player import record

    in_file = text if text in SCRIPTS.values() and "${" not in text else ""  # of a xacro, which is refused
    (folder / "a.urdf").write_text(named(in_file), encoding="utf-8")
    robot = load(folder / "a.urdf", toes=[f"shank{in_file}"], base="fixed", motors="all")
    t = np.linspace(0.0, 0.3, 20)
    motion = SimpleNamespace(
        t=t,
        q=0.1 * np.sin(t)[:, None],
        domain=np.array([text, f"b{text}"]).repeat(10),
        force=np.ones((20, 1, 2)),
        events=[SimpleNamespace(name=text, time=0.1)],
        spring_joints=(),
        engaged=np.empty((20, 0), bool),
        columns=lambda: (["t", f"q_{text}", f"v_{text}"], np.column_stack([t, t, t])),
        phase=np.array([text] * 20),
    )
    return record(robot, motion, folder / "page.html", title=text)


def comparing(folder: Path, text: str) -> Path:
    """A page that compares two gaits that are called so."""
    from spear_pin import compare

    found = compare("long_stride", "long_stride_3.00", names=[text, f"other {text}"], cycles=1)
    return found.save(folder / "page.html")


def cases() -> Iterator[Drawn]:
    """Every page."""
    for what, text in TEXTS.items():
        yield Drawn(f"a page that plays, with names of {what}", _opened(playing, text))
    yield Drawn("a page that compares, with names of all scripts", _opened(comparing, "".join(SCRIPTS.values())))


def _opened(make: Callable[[Path, str], Path], text: str) -> Callable[[Path], object]:
    def call(folder: Path) -> None:
        from tests.viz.chromium import Browser

        page = make(folder, text)
        most = resource.getrlimit(resource.RLIMIT_DATA)[1]
        resource.setrlimit(resource.RLIMIT_DATA, (most, most))  # a browser reserves what it does not use
        with Browser() as browser:
            browser.open(page)
            browser.run("document.querySelectorAll('summary').forEach((each) => each.click())")
            hacked = browser.run("[window.hacked, window.frames.length, Object.prototype.polluted].join()")
            asked = [each for each in browser.requests if not each.startswith(("file:", "data:", "blob:", "about:"))]
            if hacked != ",0," or asked:
                raise Ran(f"{hacked}, {asked[:3]}")
            if browser.errors:
                raise Ran(browser.errors[0][:150])

    return call
