"""The hopping experiment of Section 4.3 on hardware: the hop with real motors, wires and sensors.

The source does not name the robot's amplifiers, nor the noise of its sensors. What is not in the catalogue is an
assumption, each a field of `Rig`.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

from spear_pin.errors import BadValue
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.hardware import Hardware, Sensing
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.actuator import Actuator, Thermal
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import gearbox, motor, size_motor
from spear_pin.model.motor import Gearbox, Motor
from spear_pin.model.robot import Robot
from spear_pin.model.variants import motor_size

HOPS = 11  # of Fig. 4.13
RTOL = 1e-7  # of runs by the hundred: a hop is then right to a micrometre


@typed
@dataclass(frozen=True)
class Rig:
    """Hardware that drives SPEAR-II's joints and reads them.

    Attributes:
        hip: motor of the hip (source: Faulhaber).
        knee: motor of the knee (source: Maxon EC 60 flat 100 W; its resistance and inductance are assumptions).
        hip_efficiency: efficiency of the hip's gears, three stages (assumption).
        knee_efficiency: efficiency of the knee's gears (a recollection).
        battery: 24 V (source), no resistance (assumption); each motor has its own.
        current_limit: current limit of the amplifiers, in A (assumption).
        bandwidth: bandwidth of the current loops, in Hz; None: at once (assumption).
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
        """Returns the hardware for a robot with motors on its joints "hip" and "knee", of the robot's gears and sizes.

        Raises:
            BadValue: the robot has a motor at another joint.
        """
        shared = (self.battery, self.current_limit, self.bandwidth, self.thermal)
        parts = {"hip": (self.hip, self.hip_efficiency), "knee": (self.knee, self.knee_efficiency)}
        actuators = []
        for joint in robot.actuated:
            if joint not in parts:
                expected = "hip and knee alone; for other joints make a Hardware with an Actuator for each motor"
                raise BadValue("robot.actuated", joint, expected)
            machine, efficiency = parts[joint]
            if (size := motor_size(robot, joint)) != 1.0:
                machine = size_motor(machine, size)
            actuators.append(Actuator(machine, Gearbox(robot.gear_ratio(joint), efficiency), *shared))
        return Hardware(tuple(actuators), self.sensing)


@dataclass(frozen=True)
class Outcome:
    """One run of many.

    Attributes:
        seed: seed of its noise and lost commands.
        hops: number of whole hops.
        reason: why the run ended; "complete" if it hopped to the end.
        message: the reason in a sentence.
        apexes: heights of the hip, in m.
    """

    seed: int
    hops: int
    reason: str
    message: str
    apexes: tuple[float, ...]


@typed
def on_rig(gait: Gait, rig: Rig, hops: int = HOPS, rtol: float = 1e-9, progress: bool = True) -> Trajectory:
    """Simulates the hop on hardware, from the gait's state."""
    return simulate(with_hardware(gait.system, rig.on(gait.system.robot)), gait.state, hops, rtol, progress=progress)


@typed
def outcome(gait: Gait, rig: Rig, seed: int, hops: int = HOPS) -> Outcome:
    """Simulates one run with a seed."""
    sensing = replace(rig.sensing or Sensing(), seed=seed)
    run = on_rig(gait, replace(rig, sensing=sensing), hops, RTOL, progress=False)
    apexes = tuple(float(event.q[0]) for event in run.named("apex"))
    return Outcome(seed, run.cycles, run.reason, run.message, apexes)


def reasons(outcomes: Iterable[Outcome]) -> dict[str, int]:
    """Counts the runs that ended for each reason, most frequent first."""
    return dict(Counter(each.reason for each in outcomes).most_common())
