"""A rough initial motion: torso level and steady, feet swept on the ground and swung back through the air."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.footfalls.limbs import find_limb_angles, length
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.legs import Leg
from spear_pin.model.chain import CHAIN
from spear_pin.model.scale import Scale

X, Y, Z, YAW = (CHAIN.index(name) for name in ("torso_x", "torso_y", "torso_z", "yaw"))
BENT = math.radians(45.0)  # of a knee that bears
FLIGHT, CONTACTS, SWEEP = 0.06, (0.1, 0.22), 0.4  # s, s and m of Q-SPEAR: a flight, a foot on the ground
INSTANT = 1e-4  # s: time step of the differences for velocities


@dataclass(frozen=True)
class Plan:
    """A rough motion.

    Attributes:
        limbs: the robot's legs.
        hips: height of each hip above the torso's frame, in m.
        request: the request for the gait.
        scale: the robot's size.
        weight: m g, in N.
    """

    limbs: Mapping[str, Leg]
    hips: Mapping[str, float]
    request: FootfallRequest
    scale: Scale
    weight: float

    @cached_property
    def durations(self) -> tuple[float, ...]:
        """Durations of the phases of a whole stride, in s."""
        whole, shortest, longest = self.request.footfalls.whole, self.request.shortest, self.request.longest
        legs = sum(1 for leg in self.limbs if any(leg in phase for phase in whole))
        phases_of_a_leg = sum(len(phase) for phase in whole) / legs
        least, most = (time * self.scale.time for time in CONTACTS)
        contact = min(max(SWEEP * self.scale.length / self.request.speed, least), most)
        rough = (contact / phases_of_a_leg if phase else FLIGHT * self.scale.time for phase in whole)
        return tuple(
            min(max(time, shortest[0 if phase else 1]), longest) for time, phase in zip(rough, whole, strict=True)
        )

    @property
    def stride(self) -> float:
        """Duration of a whole stride, in s."""
        return sum(self.durations)

    @cached_property
    def contacts(self) -> dict[str, tuple[float, float]]:
        """Time at which each leg lands, and how long it stays on the ground, in s."""
        whole, found = self.request.footfalls.whole, {}
        for leg in self.limbs:
            for landing in self.request.footfalls.landings(leg):
                last = landing
                while leg in whole[(last + 1) % len(whole)] and last - landing < len(whole):
                    last += 1
                bearing = sum(self.durations[i % len(whole)] for i in range(landing, last + 1))
                found[leg] = sum(self.durations[:landing]), bearing
        return found

    def begins(self, phase: int) -> float:
        """Returns the time at which a phase begins, in s."""
        return sum(self.durations[:phase])

    def swung(self, leg: str, time: float) -> float:
        """Returns the fraction of a leg's way through the air that has passed; 0 on the ground."""
        landing, bearing = self.contacts[leg]
        since = (time - landing) % self.stride - bearing
        return max(since / (self.stride - bearing), 0.0)

    def q(self, time: float, nv: int) -> Array:
        """Returns the configuration, (nv,)."""
        request = self.request
        height = float(np.mean([length(limb.lengths, BENT) - self.hips[name] for name, limb in self.limbs.items()]))
        turned = request.turn * time / self.stride
        q, along = np.zeros(nv), request.speed * time * float(np.sinc(0.5 * turned / math.pi))
        q[[X, Y, Z, YAW]] = along * math.cos(0.5 * turned), along * math.sin(0.5 * turned), height, turned
        for name, limb in self.limbs.items():
            landing, bearing = self.contacts[name]
            half, swung = 0.5 * request.speed * bearing, self.swung(name, time)
            if swung:
                ahead, raised = -half * math.cos(math.pi * swung), 1.5 * request.clearance * math.sin(math.pi * swung)
            else:
                ahead, raised = half - request.speed * ((time - landing) % self.stride), 0.0
            q[[limb.hip, limb.knee]] = find_limb_angles(limb, ahead, height + self.hips[name] - raised)
        return q

    def v(self, time: float, nv: int) -> Array:
        """Returns the velocity, (nv,), which is rough where a foot lands or lifts off."""
        return (self.q(time + INSTANT, nv) - self.q(time, nv)) / INSTANT

    @property
    def push(self) -> float:
        """Upward force on a foot on the ground, in N."""
        return self.weight * self.stride / sum(bearing for _, bearing in self.contacts.values())
