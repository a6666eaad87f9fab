"""A gait compared with the knee's drive: torque-speed envelope, heat, and electrical cost of transport."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.gait import Gait
from spear_pin.kinds import typed
from spear_pin.model.motor import Drive
from spear_pin.studies.bound import mean_speed
from spear_pin.studies.design.operating_points import Points, points


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
    share = np.trapezoid(out.astype(float), given.t, axis=0) / (given.t[-1] - given.t[0])
    near = (given.since < 0.02) | (given.until < 0.02)
    return EnvelopeUse(
        drive=drive,
        margin=margin,
        outside=np.asarray(share),
        worst=margin.min(axis=0),
        near_events=float(near[out].mean()) if out.any() else float("nan"),
        heating=given.rms / drive.continuous_torque,
    )


@typed
def energy_drawn(given: Points, drive: Drive, regeneration: float = 0.0) -> float:
    """Returns the electrical energy that all motors of one kind of joint draw in a cycle, both legs of each pair, in J.

    Args:
        given: operating points of one cycle.
        drive: drive of each of the joints.
        regeneration: share of the electrical power given back that is stored.
    """
    columns = zip(given.torque.T, given.speed.T, strict=True)
    halves = [given.curves.halves(drive.bus_power, torque, speed) for torque, speed in columns]
    return given.motors * sum(drawn - regeneration * back for drawn, back in halves)


@typed
def electrical_cost(gait: Gait, knee: Drive, regeneration: float = 0.0) -> float:
    """Returns the cost of transport from the knee motors' electricity and the hips' positive mechanical power.

    Args:
        gait: a bounding gait.
        knee: drive of each knee.
        regeneration: share of the electrical power given back that is stored.
    """
    knees, hips = points(gait, "knee"), points(gait, "hip")
    positive = sum(hips.curves.positive(power) for power in (hips.torque * hips.speed).T)
    energy = energy_drawn(knees, knee, regeneration) + PAIR * positive
    return energy / (gait.system.robot.weight * gait.period * abs(mean_speed(gait)))
