"""The hopping experiment of Section 4.3 on hardware: how the hop fares with real motors, wires and sensors.

Which amplifiers the robot has, the source does not say, nor how noisy its sensors are: what is not in the
catalogue is an assumption, each a field of `Rig`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.hardware import Hardware, Sensing
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.actuator import Actuator, Thermal
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import gearbox, motor
from spear_pin.model.motor import Gearbox, Motor
from spear_pin.model.robot import Robot

HOPS = 11  # of Fig. 4.13
RTOL = 1e-7  # of runs by the hundred: a hop is then right to a micrometre


@typed
@dataclass(frozen=True)
class Rig:
    """Hardware that drives SPEAR-II's joints and reads them.

    Attributes:
        hip: its motor (source: Faulhaber).
        knee: its motor (source: Maxon EC 60 flat 100 W; its resistance and inductance are assumptions).
        hip_efficiency: of its gears, three stages (assumption).
        knee_efficiency: of its gears (a recollection).
        battery: 24 V (source), no resistance (assumption); each motor has its own.
        current_limit: of the amplifiers, in A (assumption).
        bandwidth: of the current loops, in Hz; None: at once (assumption).
        thermal: i²t protection; None: none (assumption).
        sensing: noise and lost commands; None: none (assumption).
    """

    hip: Motor = field(default_factory=lambda: motor("faulhaber_3863h024cr"))
    knee: Motor = field(default_factory=lambda: motor("spear_ii_knee"))
    hip_efficiency: float = 0.75
    knee_efficiency: float = field(default_factory=lambda: gearbox("spear_ii_knee_gear").efficiency)
    battery: Battery = Battery()
    current_limit: float = 10.0
    bandwidth: float | None = None
    thermal: Thermal | None = None
    sensing: Sensing | None = None

    def on(self, robot: Robot) -> Hardware:
        """For a robot with motors on its joints "hip" and "knee"; the gear ratios are the robot's."""
        shared = (self.battery, self.current_limit, self.bandwidth, self.thermal)
        parts = {"hip": (self.hip, self.hip_efficiency), "knee": (self.knee, self.knee_efficiency)}
        actuators = []
        for joint in robot.actuated:
            machine, efficiency = parts[joint]
            actuators.append(Actuator(machine, Gearbox(robot.gear_ratio(joint), efficiency), *shared))
        return Hardware(tuple(actuators), self.sensing)


@dataclass(frozen=True)
class Outcome:
    """One run of many.

    Attributes:
        seed: of its noise and lost commands.
        hops: whole ones.
        reason: why it ended; "complete" if it hopped to the end.
        message: the same in a sentence.
        apexes: heights of the hip, in m.
    """

    seed: int
    hops: int
    reason: str
    message: str
    apexes: tuple[float, ...]


@typed
def on_rig(gait: Gait, rig: Rig, hops: int = HOPS, rtol: float = 1e-9, progress: bool = True) -> Trajectory:
    """The hop on hardware, from the gait's state."""
    return simulate(with_hardware(gait.system, rig.on(gait.system.robot)), gait.state, hops, rtol, progress=progress)


@typed
def outcome(gait: Gait, rig: Rig, seed: int, hops: int = HOPS) -> Outcome:
    """One seeded run."""
    sensing = replace(rig.sensing or Sensing(), seed=seed)
    run = on_rig(gait, replace(rig, sensing=sensing), hops, RTOL, progress=False)
    apexes = tuple(float(event.q[0]) for event in run.named("apex"))
    return Outcome(seed, run.cycles, run.reason, run.message, apexes)


def reasons(outcomes: Iterable[Outcome]) -> dict[str, int]:
    """Number of runs that ended for each reason, most frequent first."""
    return dict(Counter(each.reason for each in outcomes).most_common())
