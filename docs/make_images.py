"""Make the pictures of the README and the documentation: `python -m docs.make_images`.

Needs Chromium. The picture on top of the README is what the recorded page shows at one instant,
beside plots of the same hop with that instant marked.
"""

from __future__ import annotations

import tempfile
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Gait, HoppingLaw, Trajectory, find_gait, hopping, load, simulate
from spear_pin.viz import plots
from spear_pin.viz.player import record
from tests.viz.chromium import Browser

IMAGES = Path(__file__).parent / "images"
INSTANT = 0.27  # s: the knee extends, spring and motor push
WIDTH, HEIGHT = 1000, 900  # of the page, in pixels


def main() -> None:
    """Solve the gaits and write every picture."""
    robot = load("spear_ii", locked=["boom_x"])
    gait = find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2})
    hops = simulate(gait.system, gait.state, cycles=11)
    print(overview(gait, simulate(gait.system, gait.state, cycles=2), IMAGES / "hop.png"))
    print(plots.save_figure(plots.hop_summary(hops, gait), IMAGES / "summary.svg"))
    recovery = simulate(gait.system, _dropped(hops, 0.02), cycles=11)
    print(plots.save_figure(plots.boom_height(recovery), IMAGES / "recovery.svg"))
    late = find_gait(hopping(robot, HoppingLaw(stance_torque=7.5)))
    print(plots.save_figure(plots.knee_torque(simulate(late.system, late.state, cycles=2)), IMAGES / "late.svg"))


def overview(gait: Gait, hops: Trajectory, path: Path) -> Path:
    """The page at one instant beside height, force and torque of the same hops."""
    picture = screenshot(gait, hops)
    with plots.style():
        figure = Figure(figsize=(7.0, 3.5), layout="constrained")
        page, right = figure.subfigures(1, 2, width_ratios=(1.25, 1.0))
        axes = page.add_axes((0.0, 0.0, 1.0, 1.0))
        axes.imshow(picture)
        axes.axis("off")
        panels = right.subplots(3, 1, sharex=True)
        draws = (plots.draw_height, plots.draw_force, plots.draw_torque)
        labels = ("Hip height (m)", "Force (N)", "Torque (N·m)")
        for panel, draw, label in zip(panels, draws, labels, strict=True):
            draw(panel, hops)
            panel.set_ylabel(label)
            panel.axvline(INSTANT, color="black", linewidth=0.7)
            panel.label_outer()
    return plots.save_figure(figure, path)


def screenshot(gait: Gait, hops: Trajectory) -> np.ndarray:
    """What the recorded page shows at the instant."""
    with tempfile.TemporaryDirectory() as folder, Browser(WIDTH, HEIGHT) as browser:
        page = record(gait.system.robot, hops, Path(folder) / "hop.html", title="SPEAR-II hopping in place")
        browser.open(page, f"#t={INSTANT}")
        return browser.screenshot()


def _dropped(hops: Trajectory, height: float) -> tuple[np.ndarray, np.ndarray]:
    """The apex, lifted."""
    apex = hops.named("apex")[0]
    q = apex.q.copy()
    q[hops.coordinates.index("boom_z")] += height
    return q, apex.v


if __name__ == "__main__":
    main()
