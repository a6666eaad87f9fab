"""Turn it: a gait that turns by 4° a stride, its circle, and the torques and angles that its adductions need.

Objective: find a relative periodic orbit of the event-exact simulation, whose heading turns by the same angle each
stride.

What to notice: the law does not steer. The adductions land at angles that stay the same, and are free in stance. Each
stride repeats the last one, apart from a shift and a turn. The feet push inward with speed² / radius per unit mass, and
the robot hardly leans. It does not run exactly along its heading: the two directions differ by some degrees. The mirror
image of the gait turns to the right.

The command `spear turn --angle 4` found turn.json; it takes some two minutes. This program only computes the residual
anew.

Run: python examples/turn.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

from spear_pin import Gait, simulate
from spear_pin.gaits.spatial.law import ACROSS
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import residual
from spear_pin.hybrid.symmetry import mirror_of
from spear_pin.studies.bound.turn import summarize_turn
from spear_pin.viz.player import record
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.space import footfall_diagram, space_summary

STRIDES = 8


def main(folder: Path) -> None:
    gait = Gait.load(Path(__file__).parent / "turn.json")
    motion = simulate(gait.system, gait.state, STRIDES)
    figures = summarize_turn(gait, motion)
    print(f"residual {residual(gait.system, gait.state):.1e}, largest multiplier {figures['largest_multiplier']:.3f}")
    turn, rate = np.degrees([figures["turn"], figures["rate"]])
    print(f"{turn:.2f}° a stride, {rate:.2f}°/s at {figures['speed']:.3f} m/s on a circle of {figures['radius']:.2f} m")
    print(f"lateral acceleration {figures['lateral_acceleration']:.3f} m/s², {np.degrees(figures['drift']):.1f}° askew")
    for part in ("adduction", "knee"):
        of = figures["joints"][part]
        print(f"{part:<10}{np.degrees(of['range']):5.1f}° of range, {of['torque']:5.1f} N·m, {of['power']:6.1f} W")
    mirror = mirror_of(gait.system.robot)
    right = with_parameters(gait.system, {name: -parameter(gait.system, name) for name in ACROSS})
    print(f"its mirror image: residual {residual(right, tuple(mirror(part) for part in gait.state)):.1e}")
    page = record(gait.system.robot, motion, folder / "turn.html", title=f"Q-SPEAR turning left by {rate:.1f}°/s")
    pictures = {"turn": space_summary(motion, 4), "footfalls": footfall_diagram({"turning to the left": motion})}
    print("files", page, *(save_figure(figure, folder / f"{name}.svg") for name, figure in pictures.items()))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
