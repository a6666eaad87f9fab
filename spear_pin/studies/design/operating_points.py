"""Operating points of motors over a cycle: torque and speed, with springs of any stiffness."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import UnknownName
from spear_pin.gaits.bounding_law import PAIR, legs_of
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.curves import Curves
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot

STIFFNESSES = (0.0, 56.0, 112.0, 200.0, 300.0, 400.0)  # N·m/rad, of Fig. 5.6; 112 is twice the source's 56


@dataclass(frozen=True)
class Points:
    """Operating points of one kind of joint over a cycle, for one motor; a column for each of the model's legs.

    Attributes:
        t: time, in s, (n,).
        torque: torque of a motor, by leg (posterior, anterior, or the only one), in N·m, (n, 2) or (n, 1).
        speed: speed of the joint, in rad/s, in the shape of the torque.
        bears: whether the leg is on the ground, in the shape of the torque.
        since: time since its touchdown, in s, NaN in the air, in the shape of the torque.
        until: time until its lift-off, in s, NaN in the air, in the shape of the torque.
        motors: number of motors that share the torque of a joint.
    """

    t: Array
    torque: Array
    speed: Array
    bears: NDArray[np.bool_]
    since: Array
    until: Array
    motors: int = PAIR

    @property
    def peak(self) -> Array:
        """Largest torque in stance by leg, in N·m, (2,)."""
        curves = self.curves
        bears = zip(self.torque.T, self.bears.T, strict=True)
        return np.array([max(0.0, curves.among(on).amount(torque)) for torque, on in bears])

    @property
    def rms(self) -> Array:
        """Root mean square of the torque over the stride by leg, in N·m, (2,)."""
        return np.sqrt([self.curves.integral(each**2) / self.curves.duration for each in self.torque.T])

    @property
    def curves(self) -> Curves:
        """The samples, joined between events."""
        return Curves.of(self.t)


@typed
def points(gait: Gait, part: str = "knee", stiffness: float | None = None) -> Points:
    """Returns operating points of the knees or hips over one stride.

    The law gives the total torque at the knee, and the motor gives the part that the spring does not. So another spring
    changes only the motor's torque.

    Args:
        gait: a bounding gait.
        part: "knee" or "hip".
        stiffness: stiffness of a leg's knee spring, in N·m/rad; None means the gait's own.

    Raises:
        UnknownName: `part` is neither "knee" nor "hip".
        BadValue: the stiffness is negative.
    """
    if part not in ("knee", "hip"):
        raise UnknownName("part of a leg", part, ("knee", "hip"))
    system = gait.system if stiffness is None else sprung(gait.system, stiffness)
    return points_of(system.robot, simulate(system, gait.state, progress=False), part)


def sprung(system: HybridSystem, stiffness: float) -> HybridSystem:
    """Returns a bounding system with knee springs of another stiffness a leg, in N·m/rad."""
    return rebuilt(system, spring=replace(system.spring, stiffness=PAIR * stiffness))


def points_of(robot: Robot, trajectory: Trajectory, part: str) -> Points:
    """Returns operating points of the knees ("knee") or hips ("hip") over a cycle of a robot."""
    joints, motors = joints_of(robot, part), motors_of(robot)
    columns = [robot.actuated.index(joint) for joint in joints]
    rows = [robot.index(joint) for joint in joints]
    bears = np.stack([trajectory.force[:, i].any(axis=1) for i in range(len(joints))], axis=1)
    since, until = np.full(bears.shape, np.nan), np.full(bears.shape, np.nan)
    for i in range(len(joints)):
        times = trajectory.t[bears[:, i]]
        if len(times):
            since[bears[:, i], i], until[bears[:, i], i] = times - times[0], times[-1] - times
    return Points(trajectory.t, trajectory.u[:, columns] / motors, trajectory.v[:, rows], bears, since, until, motors)


def joints_of(robot: Robot, part: str) -> tuple[str, ...]:
    """Returns the knees ("knee") or hips ("hip") of a robot in the plane, in the order of its toes."""
    return (part,) if motors_of(robot) == 1 else tuple(f"{leg.name}_{part}" for leg in legs_of(robot))


def motors_of(robot: Robot) -> int:
    """Returns how many motors one joint of a planar robot stands for: one for a leg, two for a pair."""
    return 1 if len(robot.legs) == 1 else PAIR


@typed
def spring_sweep(gait: Gait, stiffnesses: Sequence[float] = STIFFNESSES) -> dict[float, Points]:
    """Returns knee motor torques for springs of other stiffness on the same gait, Figs. 5.5 and 5.6.

    Args:
        gait: a bounding gait.
        stiffnesses: stiffnesses of a leg's spring, in N·m/rad; 0 is "no compliance".
    """
    return {stiffness: points(gait, "knee", stiffness) for stiffness in stiffnesses}
