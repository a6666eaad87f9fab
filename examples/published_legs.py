"""Let published legs with parallel springs hop, and ask what the springs are worth.

Objective: let three legs hop in place, each with its knee spring as published. They are HOPPY's leg, MUPS v2 and a leg
of Delft's E-Go, which is a Go1 with springs. A table shows how hard the knee motor works and how much the motors draw,
with the spring and without it.

What to notice: unlike SPEAR-II's spring, these springs never switch. If a spring extends the knee in stance, the motor
has to work against it in flight. "Without" means the same motion, in which the motor supplies the spring's torque.
MUPS's spring carries the leg's weight alone. HOPPY's carries less than a twentieth of the torque in stance, and E-Go's
is soft.
For these two the law makes the motor imitate a spring of the missing stiffness, "imitated" in the table. MUPS's torque
falls where its linkage passes its best lever; a spring given as a table can do this. If the source has no motor data,
the table gives positive mechanical work instead of electrical energy.

E-Go needs example-robot-data, the extra 'robots'. Without it the program leaves E-Go out.

Run: python examples/published_legs.py [FOLDER]
"""

import sys
import warnings
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from spear_pin import Gait, HoppingLaw, RobotWarning, find_gait, hopping, load, monopod, simulate
from spear_pin.errors import UnknownName
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.model.robot import Robot
from spear_pin.studies.energetics import Costs, costs
from spear_pin.viz.plots import save_figure, style

BUS = 24.0  # V, as in SPEAR-II; it limits what the motors can do, not what they draw
WORK, DRAWN = "mechanical_positive", "electrical_0"  # costs without recuperation: negative power gives nothing back


@dataclass(frozen=True)
class Published:
    """A leg and the hop that is asked of it; everything but the robot is this example's choice.

    Attributes:
        title: what its makers call it.
        source: what `load` takes.
        flight_time: in s.
        knee: commanded at touchdown, in rad, where the leg of its makers has room to flex.
        pace: of the square wave, over that which is SPEAR-II's scaled.
        imitated: of a spring that the motor imitates in stance, in N·m/rad.
        law: other fields of the law.
    """

    title: str
    source: str
    flight_time: float
    knee: float
    pace: float = 1.0
    imitated: float = 0.0
    law: dict[str, float] = field(default_factory=dict)


# HOPPY's makers use 150 N/m and 5 N·s/m at the toe, which is 0.217 m from the hip and 0.163 m from the knee. This uses
# 70 % of both, with which the motors stay within their torque limits.
TOE = 0.7 * np.array([150.0, 5.0])
HOPPY_GAINS = dict(
    zip(("hip_gain", "hip_damping", "knee_gain", "knee_damping"), [*TOE * 0.217**2, *TOE * 0.163**2], strict=True)
)
E_GO = str(Path(__file__).with_name("e_go.toml"))
LEGS = (
    Published("HOPPY's leg", "hoppy_leg", 0.14, 1.2, pace=0.75, imitated=1.0, law=HOPPY_GAINS),
    Published("MUPS v2", "mups_v2", 0.32, 1.6, pace=1.5, law={"stance_torque": 0.8}),
    Published("E-Go, one leg", E_GO, 0.164, 1.3, imitated=10.8),
)


def leg_of(published: Published) -> Robot:
    """The leg as a monopod that hops in place."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        robot = load(published.source)
    return monopod(robot, robot.legs[0], locked=["boom_x"])


def hop(published: Published, leg: Robot) -> Gait:
    law = HoppingLaw.scaled(leg, damping_ratio=0.7)
    law = replace(
        law,
        knee_touchdown=published.knee,
        hip_touchdown=leg.legs[0].lean(published.knee),
        frequency=published.pace * law.frequency,
        virtual_stiffness=published.imitated,
        **published.law,
    )
    system = hopping(leg, law, leg.settings.springs["knee"])
    return find_gait(system, vary=["stance_torque"], target={"flight_time": published.flight_time})


def without_spring(run: Trajectory) -> Trajectory:
    """The same motion, the motor of the knee giving what the spring gave."""
    torques = run.u.copy()
    torques[:, run.actuated.index("knee")] += run.spring[:, run.spring_joints.index("knee")]
    return replace(run, u=torques)


def cost(gait: Gait, run: Trajectory) -> Costs:
    """Of a hop, electrical where the motors are known."""
    leg, known = gait.system.robot, gait.system.robot.settings
    drives = [
        Drive(known.motors[joint], Gearbox(leg.gear_ratio(joint), known.efficiencies[joint]), BUS)
        for joint in leg.actuated
        if joint in known.motors
    ]
    return costs(gait.system, run, drives or None)


def main(folder: Path) -> None:
    runs = {}
    print(f"{'leg':<14}{'spring at most':>15}{'imitated':>16}{'period':>9}{'knee motor, peak':>21}{'energy a hop':>25}")
    print(f"{'':<14}{'':>15}{'':>16}{'':>9}{'with':>13}{'without':>8}{'with':>11}{'without':>8}")
    for published in LEGS:
        try:
            leg = leg_of(published)
        except UnknownName as error:
            print(f"{published.title:<14} left out: {error.kind} {error.value!r} needs the extra 'robots'")
            continue
        gait = hop(published, leg)
        run = simulate(gait.system, gait.state, cycles=1)
        bare = without_spring(run)
        column = run.actuated.index("knee")
        peaks = [np.abs(each.u[:, column]).max() for each in (run, bare)]
        energies = [cost(gait, each).energy for each in (run, bare)]
        kind = DRAWN if DRAWN in energies[0] else WORK
        print(f"{published.title:<14}{np.abs(run.spring).max():>11.3f} N·m{published.imitated:>9.2f} N·m/rad", end="")
        print(f"{gait.period:>7.3f} s{peaks[0]:>9.3f} N·m{peaks[1]:>8.3f}", end="")
        print(f"{energies[0][kind]:>9.3f} J{energies[1][kind]:>8.3f} {kind.partition('_')[0]}", end="")
        print(f"   residual {gait.residual:.0e}, {'stable' if gait.stable else 'unstable'}")
        runs[published.title] = run
    print("file", save_figure(drawn(runs), folder / "published_legs.svg"))


def drawn(runs: dict[str, Trajectory]) -> Figure:
    """Torques at the knee over a hop, one panel a leg."""
    with style():
        figure = Figure(figsize=(3.0 * len(runs), 3.0), layout="constrained")
        for axes, (title, run) in zip(figure.subplots(1, len(runs), squeeze=False)[0], runs.items(), strict=True):
            motor, spring = run.u[:, run.actuated.index("knee")], run.spring[:, run.spring_joints.index("knee")]
            axes.plot(run.t, spring, label="spring")
            axes.plot(run.t, motor, label="motor")
            axes.plot(run.t, motor + spring, color="0.6", linestyle="--", zorder=0, label="motor without spring")
            axes.set(title=title, xlabel="time [s]", ylabel="torque at the knee [N·m]")
        axes.legend()
    return figure


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "."))
