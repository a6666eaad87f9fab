"""What one more per cent of each number does to the hop, by exact derivatives.

Objective: which numbers of spring, gears, ground and body matter for what. The hop keeps its 0.2 s of flight, the
stance torque being solved for. Derivatives of its measures are those of the equations, through touchdown, latch and
slip, from one cycle. Then a prediction is held against a gait that is found anew.

What to notice: damping is the number to know. One more per cent of it takes 1.1 % more energy, for nearly all that the
motor gives ends there; of the spring's stiffness it takes 0.6 % less. Of the gears' ratio it takes 0.8 % less heat, but
the knee has a peak torque higher by 1.7 %. Friction of the ground matters for nothing but the |F_x| / F_z that is used,
which is all there is, as the toe slips at touchdown. What 5 % more damping does is foretold to 0.1 % of the energy.

Run: python examples/what_numbers_do.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin import Spring, find_gait, hopping, load
from spear_pin.model.catalogue import motor
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.sensitivity import elasticities

OVER = ("stiffness", "damping", "friction", "knee_ratio", "knee_touchdown", "knee_mass", "hip_to_knee")
OF = ("energy", "heat_knee", "peak_torque_knee", "greatest_height_toe", "knee_rate_at_touchdown", "multiplier_1")
FLIGHT, MOTORS, MORE = {"flight_time": 0.2}, {"knee": motor("spear_ii_knee")}, 1.05


def main(folder: Path) -> None:
    robot = load("spear_ii", locked=["boom_x"])
    hop = find_gait(hopping(robot), ["stance_torque"], FLIGHT)
    table = hop.sensitivity(OVER, vary=["stance_torque"], keep=["flight_time"], motors=MOTORS)
    print(table)
    print("\nwhat matters most, % for one more %:")
    for name in OF:
        found = sorted(zip(table.elasticity(name), OVER, strict=True), key=lambda each: -abs(each[0]))
        print(f"  {name:<23}" + ", ".join(f"{number} {percent:+.2f}" for percent, number in found[:3]))

    damping = hop.system.spring.damping
    foretold = table.outputs["energy"] + table.derivatives["energy"][OVER.index("damping")] * (MORE - 1.0) * damping
    other = find_gait(hopping(robot, spring=Spring(damping=MORE * damping)), ["stance_torque"], FLIGHT)
    energy = other.sensitivity(["damping"], motors=MOTORS).outputs["energy"]
    print(f"{MORE:.0%} of the damping: foretold {foretold:.4f} J, found anew {energy:.4f} J")
    print("file", save_figure(elasticities(table), folder / "what_numbers_do.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
