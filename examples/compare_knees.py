"""Show what the switchable spring saves: the same hop with four knees.

Objective: let SPEAR-II hop in place to the same height with four knees. Body, motors, gears and spring are the same.

- Sw-PEA: a foot switch engages the spring.
- PEA: the spring is never released. It rests where the switchable spring latches.
- SEA: the spring is in series between gears and knee.
- rigid: there is no spring, and the motor supplies the spring's torque.

The program solves each gait anew, and then simulates it with motors, gearboxes and a battery.

What to notice: only a parallel spring carries the leg. A series spring stores nearly as much energy, but the motor has
to bear its whole torque, as it does without a spring. The series spring saves the motor two fifths of the power, but
none of the torque. The torque heats the winding. The rotor turns slowly there, so a higher gear ratio would suit it.

The two parallel springs differ by next to nothing here, under three conditions. The fixed spring rests where the other
latches, the law takes account of it, and it does not damp in flight. The reason is that this hop does not draw the leg
up in the air. Running would: to flex the knee by 0.3 rad more, the motor has to hold 15 N·m.

Run: python examples/compare_knees.py [FOLDER]
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Spring, find_gait, hopping, load, simulate
from spear_pin.gaits.series_hopping import series_hopping
from spear_pin.model.bridge import Battery
from spear_pin.studies.hardware import Rig, on_rig
from spear_pin.viz.plots import save_figure, style

# gears have no loss and currents no limit, because this compares knees, not amplifiers
RIG = Rig(hip_efficiency=1.0, knee_efficiency=1.0, battery=Battery(48.0), current_limit=1000.0)


def main(folder: Path) -> None:
    robot = load("spear_ii", locked=["boom_x"])
    switched = find_gait(hopping(robot), ["stance_torque"], {"flight_time": 0.2})
    law, clean = switched.system.law, simulate(switched.system, switched.state)
    latched, apex = clean.named("touchdown")[-1].q[-1], clean.named("apex")[0].q[0]
    knees = {
        "Sw-PEA": switched.system,
        "PEA": hopping(robot, law, Spring(rest=float(latched))),
        "SEA": series_hopping(load("spear_ii_series", locked=["boom_x"])),
        "rigid": hopping(robot, replace(law, virtual_stiffness=48.84), Spring(stiffness=0.0)),
    }
    print("knee     apex [m]  largest multiplier  peak torque [N·m]  peak power [W]  battery [J]  heat [J] a hop")
    with style():
        figure = Figure(figsize=(6.0, 3.4), layout="constrained")
        axes = figure.subplots()
        for name, system in knees.items():
            gait = find_gait(system, ["stance_torque"], {"apex_height": float(apex)})
            run = on_rig(gait, RIG, hops=1)
            assert run.electrical is not None
            torque, power = run.u[:, 1], run.u[:, 1] * run.v[:, run.coordinates.index("knee")]
            battery, heat = (
                float(sum(run.electrical[f"{flow}_{joint}"][0] for joint in run.actuated))
                for flow in ("battery", "joule")
            )
            print(
                f"{name:<8}{run.named('apex')[0].q[0]:9.4f}{abs(gait.multipliers[0]):20.3f}{np.abs(torque).max():19.1f}"
                f"{np.abs(power).max():16.0f}{battery:13.1f}{-heat:10.1f}{'' if gait.stable else '  unstable'}"
            )
            axes.plot(run.t, torque, "--" if name == "Sw-PEA" else "-", label=name, zorder=4 - len(axes.lines))
        axes.set(xlabel="time since touchdown [s]", ylabel="torque of the knee motor [N·m]")
        axes.legend()
    print("file", save_figure(figure, folder / "knees.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
