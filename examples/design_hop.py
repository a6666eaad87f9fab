"""Design spring, gears and crouch of the hop together, for the least energy, with a margin to where hops end.

Objective: optimise parameters of the spring, the robot and the law together; each step of the optimisation is a gait.
The objective is the least energy: the work and the heat of the knee's motor. There are three constraints:

- The flight lasts 0.2 s.
- At lift-off the knee is at least 20 mrad from the angle at which its spring would grow slack.
- All multipliers have a modulus of at most 0.6.

The program then prints which constraints limit the design, what they cost, and which parameters the energy depends on.

What to notice: the initial hop needs less energy than the design, but is only 5.5 mrad from the end of its family. So
the margin costs energy: each further mrad costs 0.09 J. This price is known without another design, and so are the
effects of other parameters. With 1 % more damping an optimal design needs 0.7 % more energy, and the initial hop needs
1.1 % more; see what_numbers_do.py.

Needs heyoka: pip install '.[fast]'

Run: python examples/design_hop.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin import find_gait, hopping, load, optimize_design
from spear_pin.errors import MissingExtra
from spear_pin.model.catalogue import motor
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.design_by_gradient import optimised

OVER = {"stiffness": (42.0, 60.0), "knee_ratio": (8.0, 30.0), "knee_touchdown": (0.80, 1.02)}
FLIGHT = {"flight_time": 0.2}
SLACK = "margin_spring_switch"


def main(folder: Path) -> None:
    hop = find_gait(hopping(load("spear_ii", locked=["boom_x"])), ["stance_torque"], FLIGHT)
    best = optimize_design(
        hop,
        minimize="energy",
        over=OVER,
        keep=FLIGHT,
        at_least={SLACK: 0.02},
        largest_multiplier=0.6,
        motors={"knee": motor("spear_ii_knee")},
        on_iteration=lambda n, energy, missed: print(f"  {n:2d}: {energy:.4f} J, bounds missed by {missed:.1e}"),
    )
    print(best)
    print(f"one mrad more costs {1e-3 * best.active[f'{SLACK} at least']:.3f} J")
    print("files", save_figure(optimised(best), folder / "design.svg"), best.gait.save(folder / "design_gait.json"))


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    except MissingExtra as missing:
        print(missing)
