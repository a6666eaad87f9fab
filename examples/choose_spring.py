"""Choose the knee spring of the quadruped for a shipped bounding gait.

Objective: vary the spring's stiffness and compute the torque that remains for the motors. The law prescribes the knee
torque, and the motor supplies what the spring does not. The motion is the same with any spring, so you may choose the
spring after the gait.

What to notice: without a spring the motors supply the whole torque. A stiffer spring supplies more of it, up to the
law's virtual stiffness, 200 N·m/rad a leg. There the motor supplies only the constant preload. With a stiffer spring
the peak first stays the same: the spring is empty at touchdown, so the motor still supplies its preload there. Then the
motor has to pull against the spring, and the peak rises. It rises in the posterior knees first, because they flex more.
The root mean square over the whole stride heats the windings. It falls further beyond 200 N·m/rad, so its best spring
is a stiffer one.

Run: python examples/choose_spring.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Gait
from spear_pin.studies.design import spring_sweep
from spear_pin.viz.plots import save_figure, style

LEGS = ("posterior", "anterior")
STIFFNESSES = (0.0, 56.0, 100.0, 140.0, 180.0, 200.0, 220.0, 260.0, 300.0, 350.0, 400.0)  # per leg, N·m/rad


def main(folder: Path) -> None:
    gait = Gait.load("long_stride")
    sweep = spring_sweep(gait, STIFFNESSES)
    peak = np.array([points.peak for points in sweep.values()])
    rms = np.array([points.rms for points in sweep.values()])
    print("spring of a leg    knee motor in stance, peak [N·m]   rms over the stride [N·m]")
    for stiffness, most, mean in zip(STIFFNESSES, peak, rms, strict=True):
        print(f"{stiffness:8.0f} N·m/rad  {most[0]:7.1f} posterior {most[1]:7.1f} anterior", end="")
        print(f"   {mean[0]:6.1f} {mean[1]:6.1f}")
    for title, values in (("least peak", peak), ("least heat", rms)):
        worst = values.max(axis=1)
        best = int(np.flatnonzero(worst < worst.min() + 0.1)[0])  # the softest among equally good ones
        print(f"{title}: {STIFFNESSES[best]:.0f} N·m/rad a leg, {worst[best]:.1f} N·m in the worse leg", end="")
        print(f" against {worst[0]:.1f} without a spring")

    with style():
        figure = Figure(figsize=(6.0, 3.6), layout="constrained")
        axes = figure.subplots()
        for i, leg in enumerate(LEGS):
            (line,) = axes.plot(STIFFNESSES, peak[:, i], marker="o", markersize=3, label=f"{leg}, peak in stance")
            axes.plot(STIFFNESSES, rms[:, i], linestyle="--", color=line.get_color(), label=f"{leg}, rms")
        axes.axvline(gait.system.law.virtual_stiffness / 2.0, color="0.7", zorder=0)
        axes.set(
            xlabel="stiffness of a leg's spring [N·m/rad]", ylabel="torque of a knee motor [N·m]", ylim=(0.0, None)
        )
        axes.legend()
    print("file", save_figure(figure, folder / "springs.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
