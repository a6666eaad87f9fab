"""Let the boom slide forward as well: the hop in place is unstable, and foot placement stabilises it.

Objective: find the hop in place with boom_x free, and see its multiplier outside the unit circle. Then choose the gain
of a foot-placement term that moves every multiplier inside, and recover from a push.

What to notice: the Poincaré section leaves out translation along the ground, so the hop in place has to be a target of
the search. The search varies the hip angle until the hop does not advance. Without feedback the multiplier is about
2.3: errors of the forward speed more than double from hop to hop. The law adds K (ẋ - ẋ*) to the commanded hip angle,
where ẋ is the speed at lift-off. If ẋ* is the hop's own ẋ, the fixed point is the same for every K; only the
multipliers move. If K is too large, the feedback overshoots: a multiplier leaves the unit circle through -1.

Run: python examples/free_x.py [FOLDER]
"""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import HoppingLaw, SpearError, find_gait, hopping, load, simulate
from spear_pin.viz.player import record
from spear_pin.viz.plots import save_figure, style


def main(folder: Path) -> None:
    robot = load("spear_ii")
    in_place = find_gait(
        hopping(robot, HoppingLaw(hip_touchdown=0.5)),
        vary=["stance_torque", "hip_touchdown"],
        target={"flight_time": 0.2, "mean_speed": 0.0},
    )
    hop = simulate(in_place.system, in_place.state)
    lift_off, apex = hop.named("lift_off")[-1], hop.named("apex")[-1]
    speed = float(lift_off.v[0])
    print(f"hop in place: stance torque {in_place.parameters['stance_torque']:.4f} N·m,", end=" ")
    print(f"hip {in_place.parameters['hip_touchdown']:.4f} rad, {1e3 * speed:.2f} mm/s forward at lift-off")

    gaits = {}
    print("K [rad·s/m]  multipliers")
    for gain in (0.0, 0.05, 0.1, 0.12, 0.14, 0.16, 0.18, 0.2):
        law = replace(in_place.system.law, foot_placement=gain, speed=speed)
        gaits[gain] = find_gait(hopping(robot, law), guess=in_place.state)
        verdict = "stable" if gaits[gain].stable else "unstable"
        print(f"{gain:11.2f}  {', '.join(f'{m:.3f}' for m in gaits[gain].multipliers)}  {verdict}")
    best = min(gaits, key=lambda gain: abs(gaits[gain].multipliers[0]))
    print(f"best of these: K = {best} rad·s/m, largest multiplier {abs(gaits[best].multipliers[0]):.4f}")

    with style():
        figure = Figure(figsize=(6.0, 3.2), layout="constrained")
        axes = figure.subplots()
        axes.set(xlabel="hops after the push", ylabel="error of the forward speed [m/s]", ylim=(-0.2, 1.0))
    for gain in (0.0, best):
        system = gaits[gain].system
        for push in (0.1, 0.3):
            v = apex.v.copy()
            v[robot.index("boom_x")] += push
            pushed = simulate(system, (apex.q, v), cycles=12, rtol=1e-8)
            speeds = np.array([event.v[0] for event in pushed.named("apex")]) - apex.v[0]
            print(f"K = {gain}, pushed by {push} m/s at the apex: {pushed.reason} after {pushed.cycles} hops")
            print(f"  error of the forward speed at the apex [m/s]: {np.round(speeds[:8], 3)}")
            axes.plot([push, *speeds], "o-", markersize=3, label=f"pushed by {push} m/s, K = {gain}")
            if push == 0.3 and gain == best:
                print(f"  it ends {pushed.q[-1, 0] - apex.q[0]:.3f} m further on")
                print("file", record(robot, pushed, folder / "free_x.html", title="SPEAR-II recovers from a push"))
    with style():
        axes.legend()
    print("file", save_figure(figure, folder / "free_x.svg"))

    try:
        hopping(load("spear_ii", locked=["boom_x"]), gaits[best].system.law)
    except SpearError as error:
        print(f"a locked boom has no speed to feed back: {error}")


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
