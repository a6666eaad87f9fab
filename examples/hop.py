"""Solve SPEAR-II's hop in place, simulate it, and write a page that plays it and a figure.

Objective: go the whole way from a robot to a gait: load, hopping, find_gait, simulate, record, plot.

What to notice: every multiplier is well inside the unit circle, so the hop needs no feedback from hop to hop. An error
of 1 rad/s in the knee's rate is gone after a few hops. The spring does most of the push. Nearly all of the motor's
energy is lost in the knee's damping. The spring latches the knee at an angle below the commanded one, because the knee
still swings at touchdown.

Run: python examples/hop.py [FOLDER]
"""

import sys
from pathlib import Path

from spear_pin import find_gait, hopping, load, simulate
from spear_pin.studies.hop import summarize
from spear_pin.viz.player import record
from spear_pin.viz.plots import hop_summary, save_figure


def main(folder: Path) -> None:
    robot = load("spear_ii", locked=["boom_x"])
    gait = find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2})
    gait.save(folder / "hop_gait.json")
    hops = simulate(gait.system, gait.state, cycles=11)

    summary = summarize(gait, hops)
    print(f"stance torque      {summary['stance_torque']:.4f} N·m")
    print(f"flight, stance     {summary['flight_time']:.4f} s, {summary['stance_time']:.4f} s")
    print(f"apex of the hip    {summary['apex_height']:.4f} m")
    print(f"peak ground force  {summary['peak_force']:.1f} N")
    print(f"spring's share     {100 * summary['spring_share']:.1f} % of the push")
    print("multipliers        " + ", ".join(f"{value:.4f}" for value in gait.multipliers))
    for flow, energy in summary["energy_flows"].items():
        print(f"  {flow:<17}{energy:+10.4f} J a hop")

    # disturb the same hop: at the apex the knee turns 1 rad/s faster than in the gait
    apex = hops.named("apex")[0]
    disturbed = apex.v.copy()
    disturbed[robot.index("knee")] += 1.0
    recovery = simulate(gait.system, (apex.q, disturbed), cycles=11)
    print("hop  apex, less the periodic one")
    for hop in range(1, 12):
        event = next(e for e in recovery.named("apex") if e.time >= recovery.t[recovery.cycle == hop][0])
        print(f"{hop:>3}  {1e3 * (event.q[robot.index('boom_z')] - summary['apex_height']):+9.4f} mm")

    page = record(robot, hops, folder / "hop.html", title="SPEAR-II hopping in place")
    data = hops.save(folder / "hop.npz")
    table = hops.export(folder / "hop.csv")
    figure = save_figure(hop_summary(hops, gait), folder / "hop.svg")
    print("files", page, data, table, figure)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
