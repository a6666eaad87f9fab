"""Let HOPPY, a leg that others have published, hop round its post, about which the boom turns and tilts.

Objective: reproduce the events of the published simulator from the published start, to nine digits. Then find the
periodic hop under the published law, for three motor models:

- Motors without rotors give the commanded torque, as in the published simulation.
- Motors with rotors give the commanded torque.
- Motors have rotors and back-EMF, as HOPPY's have.

A fourth hop has the third model and Coulomb friction with a coefficient of 0.8.

What to notice: behind gears of 26.9 and 28.8, the rotors have more reflected inertia than thigh and shank. With rotors
and ideal torques HOPPY falls from the published start. Back-EMF acts as a damper and prevents the fall. Each model has
a periodic hop. It is a relative periodic orbit, because nothing depends on the robot's place round the post.

Contact is as published: rigid along the circle and vertically, free along the boom, and without a limit of friction.
The program prints the friction that a hop uses, which is more than rubber has. It also prints the torques, which are
larger than 12 A can give. With friction of 0.8 the toe slips at both ends of a stance, and HOPPY still hops.

Run: python examples/hoppy.py [FOLDER]
"""

import math
import sys
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Contact, find_gait, load, simulate
from spear_pin.gaits.round_hopping import RoundHoppingLaw, round_hopping
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.robot import Robot
from spear_pin.studies.round_hop import summarize_round
from spear_pin.viz.player import record
from spear_pin.viz.plots import save_figure, style

START = np.array([0.0, 0.0, math.pi / 3, math.pi / 2]), np.zeros(4)  # at rest, the toe 7 mm above the ground


@dataclass(frozen=True)
class Published:
    """An event of the published simulator: its time in s, and q1 to q4 in rad, of which q4 is minus the knee."""

    name: str
    time: float
    angles: tuple[float, float, float, float]


EVENTS = (
    Published("touchdown", 0.1075166038, (-0.0021682033, 0.0628108993, 1.2624981888, -1.8812924798)),
    Published("lift_off", 0.3133645125, (-0.0000663941, -0.0448145011, 0.7163496917, -1.1306125716)),
    Published("touchdown", 0.7768067384, (-0.3990689115, 0.0642046222, 0.8872384740, -1.7935110314)),
    Published("lift_off", 1.0319416092, (-0.4098865806, -0.0005675017, 0.6769264598, -1.4022414433)),
)


def without_rotors(robot: Robot) -> Robot:
    model = robot.model.copy()
    model.armature = np.zeros(robot.nv)
    return robot.with_model(model)


def kinds() -> dict[str, HybridSystem]:
    hoppy = load("hoppy")
    driven = RoundHoppingLaw.driven(hoppy)
    return {
        "no rotors, torque": round_hopping(without_rotors(hoppy), RoundHoppingLaw()),
        "rotors, torque": round_hopping(hoppy, RoundHoppingLaw()),
        "rotors, voltage": round_hopping(hoppy, driven),  # the default
        "and slip": round_hopping(hoppy, replace(driven, unlimited_friction=False), contact=Contact(friction=0.8)),
    }


def check(run: Trajectory) -> None:
    """Print the published events beside this package's."""
    own = [event for event in run.events if event.name in ("touchdown", "lift_off")]
    print("event        published [s]       here [s]   angles differ by [rad]")
    for event, theirs in zip(own, EVENTS, strict=False):
        off = np.abs(event.q * [1.0, 1.0, 1.0, -1.0] - theirs.angles).max()
        print(f"{theirs.name:<12}{theirs.time:14.10f}{event.time:15.10f}{off:14.0e}")


def main(folder: Path) -> None:
    systems = kinds()
    check(simulate(systems["no rotors, torque"], START, cycles=2, rtol=1e-10))
    runs = {}
    print("\nmotors             from the start  period   a hop  apex of hip  multiplier  friction  torques [N·m]")
    for name, system in systems.items():
        begun = simulate(system, START, cycles=10)
        gait = find_gait(system)
        runs[name] = simulate(system, gait.state, cycles=9)
        hop = summarize_round(gait, runs[name])
        began = "hops on" if begun.reason == "complete" else f"{begun.reason} after {begun.cycles}"
        torques = ", ".join(f"{torque:.1f}" for torque in hop["peak_torque"].values())
        print(f"{name:<19}{began:<15}{gait.period:7.4f} s{math.degrees(hop['turn']):7.1f}°", end="")
        print(f"{hop['apex_height']:11.4f} m{abs(gait.multipliers[0]):12.4f}{hop['friction_used']:10.1f}  {torques}")
    hops = runs["rotors, voltage"]
    print("\nfile", save_figure(from_above(runs), folder / "hoppy.svg"), end=" ")
    print(record(load("hoppy"), hops, folder / "hoppy.html", title="HOPPY hops round its post"))


def from_above(runs: dict[str, Trajectory]) -> Figure:
    """Paths of the toe, and where it stands."""
    hoppy = load("hoppy")
    with style():
        figure = Figure(figsize=(2.1 * len(runs), 2.5), layout="constrained")
        for axes, (name, run) in zip(figure.subplots(1, len(runs), sharey=True), runs.items(), strict=True):
            x, y, _ = np.array([hoppy.toe_position(q, "toe") for q in run.q]).T
            axes.plot(x, y, color="0.7", label="toe in the air")
            stands = run.phase == "stance"
            axes.plot(
                np.where(stands, x, np.nan), np.where(stands, y, np.nan), linewidth=2.5, label="and on the ground"
            )
            axes.plot(0.0, 0.0, "k+", label="post")
            axes.set(title=name, xlabel="x [m]", aspect="equal", xlim=(-0.65, 0.65), ylim=(-0.65, 0.65))
        figure.axes[0].set_ylabel("y [m]")
        figure.axes[0].legend(loc="center", bbox_to_anchor=(0.5, 0.35), frameon=False)
        return figure


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
