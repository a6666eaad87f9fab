"""Play a shipped bounding gait of Q-SPEAR, and share its knee torque between motors and springs of any stiffness.

Objective: load a gait by its name, and make the figures of its stride, a page and plots. The functions are Gait.load,
simulate, summarize and record.

What to notice: posterior and anterior legs carry the robot in turn, and a flight follows each stance. The torso pitches
nose up as the posterior legs push off, and nose down as the anterior legs push off. A stance is short, so the normal
force reaches several times the weight. The motors' net work equals the loss in the two impacts. Nothing else is lost,
because the springs are empty when they release and no toe slides.

The law prescribes the knee torque, and the motor supplies what the spring does not. So the motion does not depend on
the spring; only the motors' share does. If the spring is as stiff as the virtual spring, 200 N·m/rad a leg, the motor's
torque is constant. If the spring is stiffer, the motor works against it. The gait was found by this package's
optimisation, because the source prints no gait.

Run: python examples/bound.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np

from spear_pin import Gait, simulate
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.studies.bound import summarize
from spear_pin.viz.player import record
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.bound import bound_summary

LEGS = ("posterior", "anterior")


def main(folder: Path) -> None:
    gait = Gait.load("long_stride")
    strides = simulate(gait.system, gait.state, cycles=5)
    summary = summarize(gait, strides)
    print(f"speed            {summary['speed']:.3f} m/s, {summary['stride']:.3f} m a stride")
    for phase, seconds in summary["durations"].items():
        print(f"  {phase:<18}{seconds:.4f} s")
    weight = 9.81 * gait.system.robot.mass
    for leg in LEGS:
        print(f"{leg}: peak force {summary['peak_force'][leg] / weight:.2f} of the weight, ", end="")
        print(f"{summary['lift_off_force'][leg]:.0f} N left at lift-off, toe clears {summary['clearance'][leg]:.3f} m")
    print(f"friction used    {summary['friction_used']:.2f}, the ground has {summary['friction']:.2f}")
    print(f"motors put in    {summary['work']:.2f} J a stride, impacts take {summary['impact_loss']:.2f} J")
    print(f"multipliers      largest {np.abs(summary['multipliers']).max():.4f}")

    print("the same motion with other springs: largest torque of a knee motor in stance, N·m")
    for stiffness in (0.0, 56.0, 112.0, 200.0, 300.0):  # per leg, in N·m/rad
        system = with_parameters(gait.system, {"stiffness": 2.0 * stiffness})
        figures = summarize(gait, simulate(system, gait.state))
        torques = [figures["peak_torque_stance"][f"{leg}_knee"] for leg in LEGS]
        print(
            f"  {stiffness:5.0f} N·m/rad  " + ", ".join(f"{t:6.1f} {leg}" for t, leg in zip(torques, LEGS, strict=True))
        )

    title = f"Q-SPEAR bounding at {summary['speed']:.2f} m/s"
    page = record(gait.system.robot, strides, folder / "bound.html", title=title)
    figure = save_figure(bound_summary(strides, gait), folder / "bound.svg")
    print("files", page, strides.save(folder / "bound.npz"), figure)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
