"""What axe-core finds in recorded pages: `python -m benchmarks.accessible AXE PAGE...`.

AXE is `axe.min.js` of the npm package axe-core (`npm pack axe-core`), which is no part of this one. Each page is opened
in light and in dark, on a wide and on a narrow window, plain and with all its panels open; violations are printed with
what they are about, and what axe could not decide is counted.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from spear_pin.viz.chromium import Browser

SIZES = ((1280, 800), (375, 667))
THEMES = ("light", "dark")
STATES = {
    "plain": "0",
    "panels": "(player.switches.set('plots', true), player.switches.set('forces', true),"
    " player.switches.set('angles', true), document.body.classList.add('more'),"
    " document.getElementById('columns').open = true)",
    "keys": "document.getElementById('help').showModal()",
}
RUN = """new Promise((done) => setTimeout(done, 300))
  .then(() => axe.run(document))
  .then(({ violations, incomplete, passes }) => ({
    violations: violations.map(({ id, help, nodes }) => [id, help, nodes.map((node) => node.html.slice(0, 90))]),
    incomplete: incomplete.map(({ id, nodes }) => `${id} (${nodes.length})`),
    passes: passes.length }))"""


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("axe", type=Path, help="axe.min.js")
    parser.add_argument("pages", type=Path, nargs="+", help="recorded pages")
    given = parser.parse_args(arguments)
    script = given.axe.read_text(encoding="utf-8")
    with Browser() as browser:
        browser.send("Page.setBypassCSP", page=True, enabled=True)
        for path in given.pages:
            for width, height in SIZES:
                size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
                browser.send("Emulation.setDeviceMetricsOverride", page=True, **size)
                for theme in THEMES:
                    feature = [{"name": "prefers-color-scheme", "value": theme}]
                    browser.send("Emulation.setEmulatedMedia", page=True, features=feature)
                    for state, act in STATES.items():
                        browser.open(path, "#t=0")
                        browser.run(f"{script}\n;0")
                        browser.run(act)
                        found = browser.run(RUN)
                        said = f"{path.stem} {width}x{height} {theme} {state}: {found['passes']} rules pass"
                        print(said, *(f"undecided: {each}" for each in found["incomplete"]), sep="; ")
                        for name, what, nodes in found["violations"]:
                            print(f"  {name}: {what}", *nodes, sep="\n    ")


if __name__ == "__main__":
    main()
