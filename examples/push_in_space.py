"""Push it: a bound in 3-D, which one number a stride keeps upright, is hit from the side.

Objective: see whether the quadruped's gait survives a sideways push, with feedback and without. A planar model cannot
answer this.

What to notice: in 3-D the planar gait is still a periodic orbit. But the robot falls sideways: an error grows by a
factor of about 1.6 a stride. The feedback moves the place where both posterior legs land to the side. It does so once a
stride, from the state at touchdown, and reduces this factor to 0.3. It leaves the planar gait's own largest multiplier,
1.07. The sideways speed of the push is gone after some strides. The heading stays where the push has turned it, because
no heading differs from another for the robot. Without feedback the feet slip as the robot falls, and after five strides
the run ends in Painlevé's paradox.

The command `spear bound long_stride --space --save upright.json` found upright.json; it takes a minute.

Run: python examples/push_in_space.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

from spear_pin import Gait, SpatialLaw, simulate
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.studies.bound.in_space import summarize_in_space
from spear_pin.viz.player import record
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.space import space_summary

PUSH, STRIDES = 0.15, 10  # m/s to the left


def pushed(gait):
    q, v = (part.copy() for part in gait.state)
    v[1] += PUSH
    return simulate(gait.system, (q, v), STRIDES)


def main(folder: Path) -> None:
    plane = Gait.load("long_stride")
    system, state = embed(plane, SpatialLaw(plane.system.law))
    straight = Gait(system, state, {}, 0.0, np.ones(1, complex), {})
    upright = Gait.load(Path(__file__).parent / "upright.json")
    print(f"largest multipliers with feedback: {np.sort(abs(upright.multipliers))[:-4:-1].round(3)}")
    for name, gait in (("with feedback", upright), ("without", straight)):
        motion = pushed(gait)
        figures = summarize_in_space(gait, motion)
        print(
            f"{name}: {motion.cycles} strides ({motion.message}), rolls by {np.degrees(figures['largest_roll']):.1f}°"
            f" at most, ends {figures['aside']:.2f} m aside, heading {np.degrees(figures['heading']):.1f}°"
        )
        if gait is upright:
            kept = motion
    page = record(system.robot, kept, folder / "push_in_space.html", title="Q-SPEAR pushed to the left")
    print("files", page, save_figure(space_summary(kept), folder / "push_in_space.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
