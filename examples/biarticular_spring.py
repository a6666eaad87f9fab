"""Find the best spring over hip and knee for the hop, and say what it saves against one at the knee.

Objective: let a cable run over a pulley at the hip as well. The pulley at the knee has a radius of 30 mm (assumption);
that at the hip, the spring's stiffness, the knee's angle at touchdown and the frequency of the torque are chosen for
the least energy: the work of the motors and the heat of the knee's. Both springs have three constraints:

- The flight lasts 0.2 s.
- At lift-off the cable is at least 0.6 mm from growing slack, which at the knee is 20 mrad.
- All multipliers have a modulus of at most 0.6.

What to notice: flexion of the hip should stretch the spring, too, and the saving is small. The knee's damper stays at
the knee. With the damper along the cable, a hip pulley of the other sign would seem to save 43 %: not because of the
spring, but because the cable, and with it the damper, would move less.

Needs heyoka: pip install '.[fast]'

Run: python examples/biarticular_spring.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin import HoppingLaw, Spring, find_gait, hopping, load, optimize_design
from spear_pin.errors import MissingExtra
from spear_pin.model.catalogue import motor
from spear_pin.model.path import Joints
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.design_by_gradient import optimised

RADIUS = 0.03  # m, of the pulley at the knee
FLIGHT = {"flight_time": 0.2}
OVER = {"stiffness": (2e4, 1.5e5), "knee_touchdown": (0.85, 1.15), "frequency": (2.0, 3.2)}
HIPS = {"knee alone": {}, "hip and knee": {"hip": 0.0002}}  # m, where the search begins


def main(folder: Path) -> None:
    best = {}
    for name, hip in HIPS.items():
        cable = Spring(48.84 / RADIUS**2, damping=0.0, path=Joints({"knee": RADIUS, **hip}))
        springs = {"cable": cable, "knee": Spring(0.0, damping=1.3)}  # the knee keeps its damper
        system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(hold_extension=True), springs)
        best[name] = optimize_design(
            find_gait(system, ["stance_torque"], FLIGHT),
            minimize="energy",
            over=OVER | ({"cable.hip": (1e-5, RADIUS)} if hip else {}),
            keep=FLIGHT,
            at_least={"margin_spring_switch": 0.02 * RADIUS},
            largest_multiplier=0.6,
            motors={"knee": motor("spear_ii_knee")},
        )
        print(f"{name}:\n{best[name]}\n")
    one, both = (each.objective for each in best.values())
    print(f"the spring over hip and knee takes {both:.2f} J a hop instead of {one:.2f} J: {1 - both / one:.1%} less")
    figure = save_figure(optimised(best["hip and knee"]), folder / "biarticular.svg")
    print("files", figure, best["hip and knee"].gait.save(folder / "biarticular.json"))


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    except MissingExtra as missing:
        print(missing)
