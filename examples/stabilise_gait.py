"""Stabilise a bounding gait by event feedback, and push it.

Objective: the shipped gaits are periodic but unstable. Add two kinds of event feedback to one of them and compare the
multipliers. Then push the robot in mid-flight and follow its distance from the fixed point.

What to notice: event feedback adjusts parameters of the law, once a stride or at each touchdown. It adjusts nothing on
the periodic orbit, so the orbit stays the same. Without feedback the distance grows by 7 % a stride, as the largest
multiplier says. On a logarithmic axis a recovery is a straight line, and the largest multiplier again gives its slope.
A single gain on the forward speed recovers in 17 strides. The linear-quadratic feedback, from the whole section state
to six parameters, recovers in 4 strides.

Run: python examples/stabilise_gait.py [FOLDER]
"""

import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Gait
from spear_pin.gaits.feedback import add_feedback, speed_regulated
from spear_pin.studies.basin import midway, push_moment, recover
from spear_pin.viz.plots import save_figure, style

GAIN = 54.0  # N·s; near the best gain, which speed_regulated(bare) finds in some seconds
PUSH = {"torso_x": 0.1, "pitch": 0.1}  # m/s and rad/s, in the middle of the first flight


def main(folder: Path) -> None:
    bare = Gait.load("long_stride")
    print("designing two kinds of feedback: some seventy strides, then sixty after pushes; half a minute", flush=True)
    print("feedback          multipliers (magnitudes)")
    gaits = {}
    for name, designed in (
        ("none", lambda: bare),
        ("speed, one gain", lambda: speed_regulated(bare, GAIN)),
        ("linear-quadratic", lambda: add_feedback(bare)),
    ):
        gaits[name] = gait = designed()
        sizes = np.sort(np.abs(gait.multipliers))[::-1]
        print(f"{name:<18}{', '.join(f'{size:.4f}' for size in sizes[:5])}, ...  ", end="")
        print("stable" if gait.stable else "unstable", flush=True)

    with style():
        figure = Figure(figsize=(6.0, 3.6), layout="constrained")
        axes = figure.subplots()
        for name, gait in gaits.items():
            moment = push_moment(gait, midway(gait, "flight_1"), v=PUSH)
            result = recover(gait, moment, strides=20)
            errors = result.errors
            verdict = f"recovered in {result.strides} strides" if result.recovered else "not recovered"
            print(
                f"pushed, {name}: {verdict}; error in {len(errors) - 1} strides {errors[0]:.2e} -> {errors[-1]:.2e}",
                flush=True,
            )
            axes.semilogy(range(len(errors)), errors, marker="o", markersize=3, label=f"feedback: {name}")
        axes.set(xlabel="strides after a push in mid-flight", ylabel="distance from the fixed point")
        axes.xaxis.get_major_locator().set_params(integer=True)
        axes.legend()
    print("file", save_figure(figure, folder / "stabilised.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
