"""Compute what 1 % more of each parameter does to the hop, by exact derivatives.

Objective: find which parameters of spring, gears, ground and body matter, and for what. The hop keeps its 0.2 s of
flight, because the program solves for the stance torque. The derivatives of its measures come from one cycle. They are
derivatives of the equations themselves, through touchdown, latch and slip. Then the program compares a prediction with
a gait that it finds anew.

What to notice: damping is the parameter to know well. With 1 % more damping the hop needs 1.1 % more energy, because
nearly all of the motor's energy is lost there. With 1 % more spring stiffness it needs 0.6 % less. With a gear ratio
1 % higher it makes 0.8 % less heat, but the knee's peak torque is 1.7 % higher. Ground friction affects only the ratio
|F_x| / F_z that the hop uses. The hop uses all available friction, because the toe slips at touchdown. The derivatives
predict the energy with 5 % more damping to 0.1 %.

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
