"""What axe-core finds in pages: `python -m benchmarks.accessible AXE PAGE... --explore`.

AXE is `axe.min.js` of the npm package axe-core (`npm pack axe-core`), which is no part of this one. Each page, and with
`--explore` those that `spear explore` serves of a hop and of a bound, is opened in light and in dark, on a wide and on
a narrow window, plain and with all its panels open; violations are printed with what they are about, and what axe could
not decide is counted.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path

from spear_pin import Gait
from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import best_engine
from spear_pin.studies.explore.gaits import bound_to_explore
from spear_pin.studies.explore.legs import spear_ii_hop
from spear_pin.viz.chromium import Browser
from spear_pin.viz.explore.server import Explorer
from tests.viz import chromium
from tests.viz.explore.exploring import serving, visit

SIZES = ((1280, 800), (375, 667))
THEMES = ("light", "dark")
STATES = {
    "plain": "0",
    "panels": """(() => {
        for (const name of ["plots", "forces", "angles"]) window.player?.switches?.set(name, true);
        for (const each of document.querySelectorAll("details")) each.open = true;
        document.body.classList.add("more");
        return 0;
    })()""",
    "keys": "document.getElementById('help').showModal()",
}
# what a page that asks a server says: of two numbers beside each other, of one that it refuses, of one without a motion
EXPLORED = {"": STATES, "?stiffness=52": {"compared": "0"}, "?stiffness=1000": {"refused": "0"}}
NONE = {"hop": "?keep=yes&stiffness=20", "bound": "?friction=0.1"}
RUN = """new Promise((done) => setTimeout(done, 300))
  .then(() => axe.run(document))
  .then(({ violations, incomplete, passes }) => ({
    violations: violations.map(({ id, impact, help, nodes }) =>
      [`${id} (${impact})`, help, nodes.map((node) => node.html.slice(0, 90))]),
    incomplete: incomplete.map(({ id, nodes }) => `${id} (${nodes.length})`),
    passes: passes.length }))"""


def audit(browser: Browser, script: str, name: str, show: Callable[[], None], states: Mapping[str, str]) -> None:
    """Print what axe finds in a page, in every size, theme and state.

    Args:
        browser: it is shown in.
        script: axe.
        name: of the page.
        show: opens it anew.
        states: what is done in it, scripts by their names.
    """
    for width, height in SIZES:
        size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
        browser.send("Emulation.setDeviceMetricsOverride", page=True, **size)
        for theme in THEMES:
            feature = [{"name": "prefers-color-scheme", "value": theme}]
            browser.send("Emulation.setEmulatedMedia", page=True, features=feature)
            for state, act in states.items():
                show()
                browser.run(f"{script}\n;0")
                browser.run(act)
                found = browser.run(RUN)
                said = f"{name} {width}x{height} {theme} {state}: {found['passes']} rules pass"
                print(said, *(f"undecided: {each}" for each in found["incomplete"]), sep="; ")
                for rule, what, nodes in found["violations"]:
                    print(f"  {rule}: {what}", *nodes, sep="\n    ")


def audit_explore(browser: chromium.Browser, script: str) -> None:
    """Print what axe finds in the pages that `spear explore` and `spear explore bound` serve."""
    bound = bound_to_explore(Gait.load("long_stride"), "Q-SPEAR bounding")
    for subject in (spear_ii_hop(), bound):
        with serving(Explorer(subject, best_engine(), write_script)) as server:
            for query, states in (EXPLORED | {NONE[subject.kind]: {"none": "0"}}).items():
                show = partial(visit, browser, server, f"{query}#t=0")
                audit(browser, script, f"explore {subject.kind}", show, states)


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("axe", type=Path, help="axe.min.js")
    parser.add_argument("pages", type=Path, nargs="*", help="recorded pages, pages of comparisons")
    parser.add_argument("--explore", action="store_true", help="what `spear explore` serves, too")
    given = parser.parse_args(arguments)
    script = given.axe.read_text(encoding="utf-8")
    with chromium.Browser() as browser:
        browser.send("Page.setBypassCSP", page=True, enabled=True)
        for path in given.pages:
            audit(browser, script, path.stem, partial(browser.open, path, "#t=0"), STATES)
        if given.explore:
            audit_explore(browser, script)


if __name__ == "__main__":
    main()
