"""How soon recorded pages open, and what a frame of them costs: `python -m benchmarks.playing PAGE...`.

Each page is opened in a headless Chromium, drawn by the processor, and played for some seconds: its size, first paint,
the time in scripts until it is open, the frames drawn a second, and the time in scripts for each. Pages that older
versions wrote are opened as well.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from spear_pin.viz.chromium import Browser

SECONDS = 6
PAINT = "performance.getEntriesByType('paint').map((entry) => entry.startTime)[0]"
DRAWN = """new Promise((done) => {
  const { viewer } = player, render = viewer.render.bind(viewer);
  let drawn = 0;
  viewer.render = () => { drawn++; render(); };
  setTimeout(() => done(drawn), 1000 * SECONDS);
})""".replace("SECONDS", str(SECONDS))


def measured(path: Path, width: int = 1280, height: int = 800) -> str:
    """The figures of a page, as a line."""
    with Browser(width, height) as browser:
        browser.send("Performance.enable", page=True)
        browser.open(path)
        paint, opened = browser.run(PAINT), scripts(browser)
        drawn = browser.run(DRAWN)
        spent = scripts(browser) - opened
    size = path.stat().st_size / 1e6
    return f"{size:7.2f} MB{paint:9.0f} ms{1e3 * opened:12.0f} ms{drawn / SECONDS:10.1f}{1e3 * spent / drawn:12.1f} ms"


def scripts(browser: Browser) -> float:
    """Time spent in scripts until now, in s."""
    metrics = browser.send("Performance.getMetrics", page=True)["metrics"]
    return float(next(each["value"] for each in metrics if each["name"] == "ScriptDuration"))


def main(arguments: Sequence[str] | None = None) -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("pages", type=Path, nargs="+", help="recorded pages")
    print(f"{'':24}{'page':>10}{'paint':>12}{'scripts':>15}{'frames/s':>10}{'a frame':>15}")
    for path in parser.parse_args(arguments).pages:
        print(f"{path.stem:24}{measured(path)}", flush=True)


if __name__ == "__main__":
    main()
