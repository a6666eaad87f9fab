"""How soon the page of `spear explore` follows a slider, in a headless Chromium: `python -m benchmarks.explore`.

Sliders are moved one at a time from where they stand at first, within the ranges in which the robot hops; the picture
counts as changed when the frame with it was drawn. WebGL is drawn by the processor there. `--picture FILE` writes what
the page looks like instead.
"""

from __future__ import annotations

import argparse
import os
import random
import statistics
import time
from pathlib import Path
from urllib.parse import urlencode

from benchmarks import markdown
from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import REFERENCE, TAYLOR, best_engine
from spear_pin.studies.explore.legs import spear_ii_hop
from spear_pin.viz.explore.server import Explorer
from tests.viz.chromium import Browser
from tests.viz.explore.exploring import move, serving, visit

RANGES = {
    "stiffness": (46.0, 56.0),
    "knee_ratio": (8.0, 17.0),
    "stance_torque": (6.5, 9.5),
    "knee_touchdown": (0.85, 1.1),
    "friction": (0.3, 1.4),
    "frequency": (2.2, 2.8),
    "damping": (1.1, 1.6),
}
SHOWN = "?stiffness=54&stance_torque=9#t=0.27"


def drawn(moves: int, seed: int) -> list[tuple[str, float]]:
    """Sliders and where they are moved."""
    chance = random.Random(seed)
    names = [chance.choice(list(RANGES)) for _ in range(moves)]
    return [(name, round(chance.uniform(*RANGES[name]), 2)) for name in names]


def row(name: str, values: list[float]) -> None:
    """Median and worst of some milliseconds."""
    markdown.row(name, f"{statistics.median(values):.0f}", f"{max(values):.0f}")


def spent_on(explorer: Explorer, path: str, questions: list[str]) -> float:
    """Median of the processor's time for an answer, in ms."""
    found = []
    for question in questions:
        begun = time.process_time()
        explorer.answer(f"{path}?{question}")
        found.append(1e3 * (time.process_time() - begun))
    return statistics.median(found)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--moves", type=int, default=20)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--engine", choices=("Taylor", "reference"), default=best_engine().name)
    parser.add_argument("--picture", type=Path, metavar="FILE")
    given = parser.parse_args()
    explorer = Explorer(spear_ii_hop(), {"Taylor": TAYLOR, "reference": REFERENCE}[given.engine], write_script)
    questions = [urlencode({name: value}) for name, value in drawn(given.moves, given.rounds)]
    spent = {path: spent_on(explorer, path, questions) for path in ("/hop", "/tangents", "/tangents/multiplier")}
    with serving(explorer) as server, Browser(1280, 900) as browser:
        if given.picture:
            visit(browser, server, SHOWN)
            for stiffness in (48, 49, 50, 51, 52, 53, 54):
                move(browser, "stiffness", stiffness)
            browser.run("explorer.tangents.arrived()")
            time.sleep(1.0)
            browser.screenshot(given.picture)
            return
        machine = f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}"
        told = ", ".join(f"{path} {value:.0f}" for path, value in spent.items())
        print(f"{given.engine} engine; {machine}; answers take, in ms of CPU: {told}\n")
        for number in range(given.rounds):
            visit(browser, server)
            found = []
            for name, value in drawn(given.moves, number):
                browser.run("document.getElementById('reset').click(), explorer.idle()")
                found.append(move(browser, name, value))
            markdown.begin(f"round {number + 1}, {given.moves} moves [ms]", "median", "worst")
            row("slider to picture", [each["total"] for each in found])
            row("simulated", [each["simulate"] for each in found])
            row("drawn into commands", [each["draw"] for each in found])
            row("sent", [each["answered"] - each["simulate"] - each["draw"] for each in found])
            row("rendered", [each["rendered"] for each in found])
            print()


if __name__ == "__main__":
    main()
