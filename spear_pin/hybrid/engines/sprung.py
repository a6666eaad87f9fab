"""The engaged springs of a domain, for numbers, by Pinocchio's kinematics."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.domain import Held, Mount
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.hybrid.engines.own_functions import OwnFunctions
from spear_pin.hybrid.pull import Pull
from spear_pin.hybrid.springs import rest_length
from spear_pin.model.path import Joints, Path, Slope
from spear_pin.model.robot import Robot
from spear_pin.model.robot_posture import RobotPosture


class Sprung:
    """Springs with the held values of a domain.

    Args:
        robot: the robot.
        mounts: the springs.
        own: calls those that are user functions.

    Attributes:
        knots: functions of the configuration, (nv,), where a spring's law is less smooth as they pass zero.
    """

    knots: list[Callable[[Array], float]]

    def __init__(self, robot: Robot, mounts: Sequence[Mount], own: OwnFunctions) -> None:
        self._robot, self._mounts, self._own = robot, mounts, own
        self._posture = RobotPosture(robot, FLOATS)
        # where the length is a weighted sum of angles its slope never changes
        self._levers = [each.along.slope(self._posture) if isinstance(each.along, Joints) else None for each in mounts]

    def hold(self, held: Held) -> None:
        """Replaces the held values."""
        self._held, mounts = held, self._mounts
        self._rests = [rest_length(each, each.spring, each.along, self._robot, held, self._posed) for each in mounts]
        pairs = [*zip(mounts, self._rests, strict=True)]
        self.knots = [
            partial(self._beyond, mount.along, rest + knot) for mount, rest in pairs for knot in mount.spring.knots
        ]
        clipped = [
            (mount, rest)
            for mount, rest in pairs
            if mount.way is not None and mount.spring.unilateral and mount.name not in self._own.springs
        ]
        self.knots += [partial(self._mean_beyond, mount, rest) for mount, rest in clipped]

    def at(self, q: Array, angles: Sequence[float], rates: Sequence[float]) -> list[Pull]:
        """Returns what each spring does at a configuration, which is given twice, and a velocity."""
        return [
            self._pull(mount, rest, levers, q, angles, rates)
            for mount, rest, levers in zip(self._mounts, self._rests, self._levers, strict=True)
        ]

    def _pull(
        self,
        mount: Mount,
        rest: float,
        levers: Slope | None,
        q: Array,
        angles: Sequence[float],
        rates: Sequence[float],
    ) -> Pull:
        if levers is None:
            self._posture.at(q)
            slope, length = mount.along.slope(self._posture), mount.along.length(self._posture)
        else:
            slope, length = levers, levers.rate(angles)
        stretch, rate = mount.stretch(mount.spring, length, rest, self._held), slope.rate(rates)
        if mount.name in self._own.springs:
            force, drag = self._own.spring(mount, stretch, rate, self._held)
        else:
            drag = mount.drag(mount.spring, rate, self._held)
            force = mount.pull(mount.spring, stretch, self._held, FLOATS)
        lost = mount.lost(mount.spring, force, self._held, FLOATS)
        force += mount.idle(mount.spring, length, self._held) + lost
        return Pull(mount.name, mount.spring, stretch, rate, force, lost, drag, slope, mount.slipping(self._held))

    def _posed(self, q: Sequence[float]) -> RobotPosture:
        return self._posture.at(np.array(q))

    def _beyond(self, path: Path, length: float, q: Array) -> float:
        """Returns how much longer a path is than a length."""
        return float(path.length(self._posture.at(q)) - length)

    def _mean_beyond(self, mount: Mount, rest: float, q: Array) -> float:
        """Returns how much more a spring pulls on the mean than its hysteresis takes while it is let go."""
        return -float(mount.spring.torque(self._beyond(mount.along, rest, q))) - mount.spring.hysteresis
