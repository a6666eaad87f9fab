"""Write textbook walkers in a few lines each: rimless wheel, simplest walker, spring-mass runner, and round feet.

Objective: show what a hybrid system is. Each has vector fields, guards that fall through zero, jumps of the state, and
an event that closes a cycle. `own_dynamics` makes a system of them, which is simulated like a robot: every event is
exact, and multipliers come from exact derivatives. The last one is a robot from a file, whose contacts and impacts the
package has. The tests compare these systems with published numbers.

What to notice: the walker has two periodic gaits, and the shorter step is unstable. Its published multipliers are
forward differences with steps of 1e-5, and differ from the exact ones by 1e-3. The runner loses no energy, so one of
its multipliers is 1. The other is below 1: it returns to its height although nothing controls it.

Run: python examples/walkers.py [FOLDER]
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Contact, find_gait, load, simulate
from spear_pin.hybrid.automaton import OPEN, STICK, Domain, Guard, HybridSystem, Reset
from spear_pin.hybrid.own_dynamics import own_dynamics
from spear_pin.hybrid.phases import contact_domains
from spear_pin.viz import plots

LONG, SHORT = (0.20031, -0.19983), (0.19394, -0.20387)  # angle and rate of the walker after heelstrike
ROUND = (0.18944, -0.23901)  # the same of the one on round feet


@dataclass(frozen=True)
class Wheel:
    """Spokes of length 1 on a slope, where gravity is 1; angles in rad."""

    incline: float = 0.08
    half: float = math.pi / 8  # half the angle between two spokes


def rimless_wheel(law=None):
    """A wheel without a rim, which rolls over one spoke after the other; q: angle of the spoke from vertical."""

    def fall(t, q, v, held, p, dyn, ops):
        return [ops.sin(q[0])]

    def clearance(t, q, v, held, p, dyn, ops):
        return p.incline + p.half - q[0]

    def next_spoke(q, v, held, p, ops):
        return [q[0] - 2.0 * p.half], [ops.cos(2.0 * p.half) * v[0]]

    def start(p):
        return [p.incline - p.half], [0.5]

    strike = Guard("strike", clearance, Reset(jump=next_spoke, phase="roll"))
    roll = Domain("roll", "roll", (), fall, guards=(strike,))
    return own_dynamics("rimless_wheel", {"angle": "rad"}, law or Wheel(), [roll], section="strike", guess=start)


@dataclass(frozen=True)
class Slope:
    """Legs of length 1 on a slope, where gravity is 1; in rad."""

    incline: float = 0.009


def simplest_walker(step=LONG):
    """A mass at the hip, on legs and feet without mass (Garcia et al. 1998); q: stance leg's angle, that between legs.

    Where the legs pass each other the swing foot is in the ground; heelstrike is the second time that it meets it.
    """

    def swing(t, q, v, held, p, dyn, ops):
        turn = ops.sin(q[0] - p.incline)
        return [turn, turn + ops.sin(q[1]) * (v[0] * v[0] - ops.cos(q[0] - p.incline))]

    def behind(t, q, v, held, p, dyn, ops):
        return q[1] - 2.0 * q[0]

    def ahead(t, q, v, held, p, dyn, ops):
        return 2.0 * q[0] - q[1]

    def heelstrike(q, v, held, p, ops):
        kept = ops.cos(2.0 * q[0])
        return [-q[0], -2.0 * q[0]], [kept * v[0], kept * (1.0 - kept) * v[0]]

    passing = Guard("pass", behind, Reset(phase="reach"), patience=0.1)
    strike = Guard("strike", ahead, Reset(jump=heelstrike, phase="swing"))
    domains = (
        Domain("swing", "swing", (), swing, guards=(passing,)),
        Domain("reach", "reach", (), swing, guards=(strike,)),
    )

    def start(p):
        angle, rate = step
        return [angle, 2.0 * angle], [rate, (1.0 - math.cos(2.0 * angle)) * rate]

    units = {"stance": "rad", "between": "rad"}
    return own_dynamics("simplest_walker", units, Slope(), domains, section="strike", guess=start)


@dataclass(frozen=True)
class Human:
    """A runner with the numbers of Seyfarth, Geyer and Herr 2003, and the apex where it starts."""

    mass: float = 80.0  # kg
    stiffness: float = 20e3  # N/m
    length: float = 1.0  # m
    attack: float = math.radians(68.0)  # of the leg at touchdown, from the ground
    gravity: float = 9.81  # m/s²
    speed: float = 5.0  # m/s
    height: float = 1.0  # m


def runner(law=None):
    """A mass on a springy leg without mass (SLIP), which touches down at a fixed angle; q: x and z."""

    def fly(t, q, v, held, p, dyn, ops):
        return [0.0, -p.gravity]

    def leg(q, held, ops):
        x = q[0] - held["foot"]
        return x, ops.sqrt(x * x + q[1] * q[1])

    def bounce(t, q, v, held, p, dyn, ops):
        x, length = leg(q, held, ops)
        push = p.stiffness / p.mass * (p.length / length - 1.0)
        return [push * x, push * q[1] - p.gravity]

    def clearance(t, q, v, held, p, dyn, ops):
        return q[1] - p.length * ops.sin(p.attack)

    def compression(t, q, v, held, p, dyn, ops):
        return p.length - leg(q, held, ops)[1]

    def climb(t, q, v, held, p, dyn, ops):
        return v[1]

    def height(t, q, v, held, p, dyn, ops):
        return q[1]

    def place(q, v, held, p):
        return {"foot": q[0] + p.length * np.cos(p.attack)}

    def start(p):
        return [0.0, p.height], [p.speed, 0.0]

    down, up = Reset(latch=place, phase="stance"), Reset(phase="rise")
    fallen, top = Guard("fallen", height, ends="fall"), Guard("apex", climb, Reset(phase="sink"))
    sink = Domain("sink", "sink", (), fly, guards=(Guard("touchdown", clearance, down),))
    stance = Domain("stance", "stance", (), bounce, guards=(Guard("lift_off", compression, up), fallen))
    rise = Domain("rise", "rise", (), fly, guards=(top, fallen))
    domains, units = (sink, stance, rise), {"x": "m", "z": "m"}
    return own_dynamics("runner", units, law or Human(), domains, section="apex", cyclic=["x"], guess=start)


@dataclass(frozen=True)
class Passive:
    """A law without numbers."""


def round_walker(robot=None, law=None, spring=None, contact=None):
    """Two straight legs with round feet, which walk down a slope (Bhounsule 2009); q: the hip, the legs' angles.

    x leads down the slope, and gravity is turned in the robot's file. Straight legs of one length scuff: the foot in
    front lands only after the legs have passed each other.
    """
    robot, contact = robot or load(Path(__file__).with_name("round_walker.toml")), contact or Contact(2.0)

    def idle(t, q, v, held, p, dyn, ops):
        return []

    def step(side, other):
        bears, swings = robot.index(side), robot.index(other)
        modes = [STICK if toe == f"{side}_foot" else OPEN for toe in robot.toes]

        def behind(t, q, v, held, p, dyn, ops):
            return q[bears] - q[swings]

        def above(t, q, v, held, p, dyn, ops):
            return dyn.height(f"{other}_foot")

        passing = Guard("pass", behind, Reset(phase=f"{side}_reach"))
        lands = Reset(impact=(f"{other}_foot",), phase=f"{other}_swing")
        strike = Guard(f"{other}_strike", above, lands, patience=0.1)
        for phase, guard in ((f"{side}_swing", passing), (f"{side}_reach", strike)):
            yield from contact_domains(
                Domain(phase, phase, tuple(modes), idle, guards=(guard,)), robot.toes, Reset(phase="air")
            )

    def start():
        (angle, rate), other, reach = ROUND, -0.1854, 0.2 + math.cos(ROUND[0])
        return np.array([0.0, reach, angle, -angle]), np.array([-reach * rate, -math.sin(angle) * rate, rate, other])

    return HybridSystem(
        kind="round_walker",
        robot=robot,
        law=law or Passive(),
        springs={},
        contact=contact,
        domains=(*step("left", "right"), *step("right", "left"), Domain("air", "air", (OPEN, OPEN), idle)),
        section="left_strike",
        cyclic=("x",),
        build=round_walker,
        guess=start,
        phase_limit=10.0,
    )


def main(folder: Path) -> None:
    settled = simulate(runner(), runner().guess(), cycles=40).named("apex")[-1]
    gaits = {
        "rimless wheel": find_gait(rimless_wheel()),
        "simplest walker, long step": find_gait(simplest_walker()),
        "simplest walker, short step": find_gait(simplest_walker(SHORT)),
        "runner": find_gait(runner(), guess=(settled.q, settled.v)),
        "walker on round feet": find_gait(round_walker()),
    }
    for name, gait in gaits.items():
        print(f"{name}: period {gait.period:.6f}, {'stable' if gait.stable else 'not stable'}")
        print("  multipliers", ", ".join(f"{number:.7f}" for number in gait.multipliers))
    runs = {name: simulate(gait.system, gait.state, cycles=2) for name, gait in gaits.items()}
    angles = {"rimless wheel": 0, "simplest walker, long step": 0, "walker on round feet": -2}  # the first column
    with plots.style():
        figure = Figure(figsize=(9.4, 2.6), layout="constrained")
        *portraits, path = figure.subplots(1, 4)
        for axes, (name, first) in zip(portraits, angles.items(), strict=True):
            run = runs[name]
            for row in range(run.q.shape[1])[first:]:
                axes.plot(run.q[:, row], run.v[:, row], label=run.coordinates[row])
            axes.set(title=name.split(",")[0].capitalize(), xlabel="angle (rad)", ylabel="rate")
            axes.margins(y=0.2)
            axes.legend(ncols=2, loc="upper center")
        path.plot(runs["runner"].q[:, 0], runs["runner"].q[:, 1])
        path.set(title="Runner", xlabel="x (m)", ylabel="z (m)")
    print("files", plots.save_figure(figure, folder / "walkers.svg"))


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
