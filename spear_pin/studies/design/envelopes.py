"""A gait compared with the knee's drive: torque-speed envelope, heat, and electrical cost of transport."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.measures.signals import transport
from spear_pin.hybrid.simulate import simulate
from spear_pin.kinds import typed
from spear_pin.model.motor import Drive
from spear_pin.studies.design.operating_points import Points, joints_of


@dataclass(frozen=True)
class EnvelopeUse:
    """Operating points compared with a drive.

    Attributes:
        drive: the drive.
        margin: available less required torque at each point, in N·m, by leg; see `Points`; negative outside.
        outside: share of the cycle's time outside the envelope, by leg.
        worst: least margin by leg, in N·m.
        near_events: share of the points outside that lie within 20 ms after touchdown or before lift-off; NaN where
            none is outside.
        heating: rms torque over the drive's continuous torque, by leg.
    """

    drive: Drive
    margin: Array
    outside: Array
    worst: Array
    near_events: float
    heating: Array

    @property
    def fits(self) -> bool:
        """Whether no point is outside."""
        return bool((self.worst >= 0.0).all())


@typed
def against(given: Points, drive: Drive) -> EnvelopeUse:
    """Compares operating points with a drive's torque-speed envelope, Fig. 5.8."""
    margin = np.asarray(drive.margin(given.torque, given.speed))
    out = margin < 0.0
    curves, columns = given.curves, zip(given.torque.T, given.speed.T, strict=True)
    missed = [curves.halves(lambda u, w: np.sign(drive.margin(u, w)), *each)[1] for each in columns]
    near = (given.since < 0.02) | (given.until < 0.02)
    return EnvelopeUse(
        drive=drive,
        margin=margin,
        outside=np.array(missed) / curves.duration,
        worst=margin.min(axis=0),
        near_events=float(near[out].mean()) if out.any() else float("nan"),
        heating=given.rms / drive.continuous_torque,
    )


@typed
def electrical_cost(gait: Gait, knee: Drive) -> float:
    """Returns the cost of transport from the knee motors' electricity and the hips' positive mechanical power.

    Args:
        gait: a bounding gait.
        knee: drive of each knee; nothing that it gives back is stored.
    """
    robot = gait.system.robot
    knees = joints_of(robot, "knee")
    sampled = Sampled(robot, simulate(gait.system, gait.state, progress=False), drives=dict.fromkeys(knees, knee))
    hips = sum(sampled.positive(power) for joint, power in sampled.powers.items() if joint not in knees)
    return float(transport(sum(sampled.of("electricity").values()) + hips, sampled.weight, sampled.distance))
