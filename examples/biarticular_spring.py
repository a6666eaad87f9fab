"""Find the best spring over hip and knee for the hop, and say what it saves against one at the knee.

Objective: let a cable run over a pulley at the hip as well. The pulley at the knee has a radius of 30 mm (assumption);
that at the hip, the spring's stiffness, the knee's angle at touchdown and the frequency of the torque are chosen for
the least energy: the work of the motors and the heat of the knee's. All springs have four constraints:

- The flight lasts 0.2 s.
- At lift-off the knee is flexed at least 20 mrad more than at touchdown.
- At lift-off the cable is at least 0.6 mm from growing slack, which is the same for a cable over the knee alone.
- All multipliers have a modulus of at most 0.6.

What to notice: flexion of the hip should stretch the spring, too, and the saving is small. Without the second
constraint it would seem to be 7.6 %: the hip keeps the cable taut, and the knee could come closer to where hops end.
The knee's damper stays at the knee. With the damper along the cable, a hip pulley of the other sign would seem to save
43 %: not because of the spring, but because the cable, and with it the damper, would move less.

Needs heyoka: pip install '.[fast]'

Run: python examples/biarticular_spring.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin import HoppingLaw, Joints, Spring, find_gait, hopping, load, optimize_design
from spear_pin.errors import MissingExtra
from spear_pin.model.catalogue import motor
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.design_by_gradient import optimised

RADIUS = 0.03  # m, of the pulley at the knee
FLIGHT = {"flight_time": 0.2}
CABLE = {"margin_spring_switch": 0.02 * RADIUS}
MARGINS = {"deflection_knee": 0.02, **CABLE}
OVER = {"stiffness": (1e4, 1.5e5), "knee_touchdown": (0.85, 1.15), "frequency": (2.0, 3.2)}
KNEE = "knee alone"
HIPS = {  # m: where the search for the hip's radius begins, and its range
    KNEE: None,
    "hip and knee": (0.0002, (1e-5, RADIUS)),
    "hip and knee, begun at 6 mm": (0.006, (1e-5, RADIUS)),
    "a larger pulley at the hip": (0.0002, (1e-5, 0.1)),
    "the hip's other way": (-0.0002, (-RADIUS, -1e-5)),
}


def designed(hip, margins=MARGINS):
    """The best cable with a pulley at the hip, or without one."""
    radii = {"knee": RADIUS} | ({} if hip is None else {"hip": hip[0]})
    cable = Spring(48.84 / RADIUS**2, damping=0.0, path=Joints(radii))
    springs = {"cable": cable, "knee": Spring(0.0, damping=1.3, unilateral=False)}  # the knee keeps its damper
    system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(hold_extension=True), springs)
    return optimize_design(
        find_gait(system, ["stance_torque"], FLIGHT),
        minimize="energy",
        over=OVER | ({} if hip is None else {"cable.hip": hip[1]}),
        keep=FLIGHT,
        at_least=margins,
        largest_multiplier=0.6,
        motors={"knee": motor("spear_ii_knee")},
    )


def main(folder: Path) -> None:
    print("| cable over | hip's radius (mm) | stiffness (N/m) | energy (J a hop) | saved | held back by | end |")
    print("| --- | --- | --- | --- | --- | --- | --- |")
    best = {}
    for name, hip in HIPS.items():
        best[name] = found = designed(hip)
        values = {each: chosen.value for each, chosen in found.parameters.items()}
        radius = f"{1e3 * values['cable.hip']:.3g}" if hip else ""
        saved = f"{1 - found.objective / best[KNEE].objective:z.1%}" if hip else ""
        held, end = ", ".join(found.active).replace("_", " "), found.reason
        print(f"| {name} | {radius} | {values['stiffness']:.0f} | {found.objective:.2f} | {saved} | {held} | {end} |")
    one, both = best[KNEE].objective, best["hip and knee"].objective
    print(f"\nthe spring over hip and knee takes {both:.2f} J a hop instead of {one:.2f} J: {1 - both / one:.1%} less")
    one, both = (designed(HIPS[name], CABLE).objective for name in (KNEE, "hip and knee"))
    print(f"with the cable's margin alone {both:.2f} J instead of {one:.2f} J: {1 - both / one:.1%} less")
    figure = save_figure(optimised(best["hip and knee"]), folder / "biarticular.svg")
    print("files", figure, best["hip and knee"].gait.save(folder / "biarticular.json"))


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
    except MissingExtra as missing:
        print(missing)
