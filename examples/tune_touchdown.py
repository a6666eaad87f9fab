"""Tune the flight gains so that the joints are at rest when the toe touches down.

Objective: the source requires that its flight controller reaches the touchdown angles within 0.2 s, nearly at rest.
With the printed gains both joints still swing at about 1 rad/s. Here `find_gait` solves for gains, stance torque and
fixed point together, with several targets at once.

What to notice: with the printed gains the modes of the leg have damping ratios of 0.23 and 0.19. The knee comes to rest
if its own K_D is tuned. With the printed K_hip no K_D brings the hip to rest: its reflected rotor makes it too slow for
0.2 s. So this program sets K_hip to 100 N·m/rad, which is our choice. Then both rates can be zero, and the leg lands
within 7 mrad of the commanded angles. The largest multiplier nearly halves. The price is a harder impact, because a
knee that already flexes would yield.

The commanded knee angle is 0.95 rad, not the 1.0 rad of the other examples. At 1.0 rad the search finds no such hop,
because the chain would go slack before the toe is unloaded (see docs/how_to/hop.md).

Run: python examples/tune_touchdown.py [FOLDER]
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np

from spear_pin import HoppingLaw, find_gait, hopping, load, simulate
from spear_pin.viz.plots import joint_angles, save_figure


def poles(robot, q, law):
    """Poles in flight of the mode in which mostly the hip swings, and of the knee's, in rad/s."""
    D = robot.mass_matrix(q)
    inertia = np.linalg.inv(np.linalg.inv(D)[1:, 1:])  # of hip and knee, while the boom moves freely up and down
    stiffness = np.linalg.solve(inertia, np.diag([law.hip_gain, law.knee_gain]))
    damping = np.linalg.solve(inertia, np.diag([law.hip_damping, law.knee_damping]))
    eigenvalues = np.linalg.eigvals(np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]]))
    return sorted((pole for pole in eigenvalues if pole.imag > 0), key=abs)


def report(title, gait):
    law, robot = gait.system.law, gait.system.robot
    touchdown = simulate(gait.system, gait.state).named("touchdown")[-1]
    print(f"{title}: stance torque {law.stance_torque:.4f} N·m, flight {gait.durations['flight']:.4f} s")
    for i, (joint, pole) in enumerate(zip(("hip", "knee"), poles(robot, touchdown.q, law), strict=True), start=1):
        print(
            f"  {joint:<5}K {getattr(law, joint + '_gain'):6.2f} N·m/rad, K_D {getattr(law, joint + '_damping'):.4f}"
            f" N·m·s/rad, pole {pole:.2f} rad/s (damping ratio {-pole.real / abs(pole):.2f});"
            f" at touchdown {touchdown.q[i]:.4f} rad, {touchdown.v_before[i]:+.4f} rad/s"
        )
    print(f"  lost at impact {-touchdown.work['impact']:.3f} J; largest multiplier {abs(gait.multipliers[0]):.4f}")
    return gait


def main(folder: Path) -> None:
    robot = load("spear_ii", locked=["boom_x"])
    law = HoppingLaw(knee_touchdown=0.95)
    flight = {"flight_time": 0.2}
    printed = report("printed gains", find_gait(hopping(robot, law), ["stance_torque"], flight))

    knee = find_gait(
        hopping(robot, replace(printed.system.law, knee_damping=1.2)),
        vary=["stance_torque", "knee_damping"],
        target=flight | {"knee_rate_at_touchdown": 0.0},
    )
    report("knee at rest, by its K_D", knee)

    begin = replace(knee.system.law, hip_gain=100.0, hip_damping=4.0, knee_damping=1.8)
    both = find_gait(
        hopping(robot, begin),
        vary=["stance_torque", "knee_damping", "hip_damping"],
        target=flight | {"knee_rate_at_touchdown": 0.0, "hip_rate_at_touchdown": 0.0},
    )
    report("knee and hip at rest, by their K_D, with a stiffer hip", both)

    for name, gait in (("printed", printed), ("tuned", both)):
        figure = joint_angles(simulate(gait.system, gait.state, 2), gait)
        print("file", save_figure(figure, folder / f"touchdown_{name}.svg"))
    print("file", both.save(folder / "touchdown_tuned.json"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
