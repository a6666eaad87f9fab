"""Figures of a bound per stride: speed, ground forces, torques of each motor, energy and its cost."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import PAIR, Leg, legs_of
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.curves import Curves, Mask
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.virtual_constraints import value
from spear_pin.hybrid.trajectory import Event, Trajectory
from spear_pin.kinds import typed

LAST = 1e-3  # s: the end of a stance in which, with lift-off by force, force and its friction fade together
NEAR = 1e-3  # s: around its own events a toe is near the ground in flight
INSTANT = 1e-12  # s: an event's time and its samples' may differ by rounding


@typed
def summarize(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Returns figures of a bounding gait, from the gait and a trajectory of it, in SI units and radians.

    `spear_pin.gaits.measures.catalogue` defines the measures: forces act on a pair of legs, torques are those of one
    motor, and work is that of all motors. All figures of the motion are from the first whole stride. "By leg" means the
    keys "posterior" and "anterior"; "by joint" means the joints with motors.

    Returns:
        Of the gait:

        - lift_off: the rule, "knee" or "force", see `BoundingLaw`.
        - stiffness, stiffness_per_leg: of a pair's knee spring, and of one leg's, half of it, in N·m/rad.
        - friction: of the ground.
        - knee_rest, knee_touchdown: θ̄ and the commanded knee angle of a landing leg, by magnitude.
        - durations: seconds by phase. residual, multipliers, stable: see `Gait`.

        Of the motion:

        - speed, period, stride: mean forward speed, in m/s; in s; in m.
        - knee_at_touchdown, leg_at_touchdown: by leg, knee angle by magnitude and leg angle γ.
        - pitch, height: lowest and highest pitch, and height of the torso, in m.

        Of the ground, by leg but for those marked *:

        - peak_force: largest normal force, in N.
        - lift_off_force: normal force just before lift-off, in N.
        - minimum_force*: least normal force in stance, in N.
        - friction_used*: largest |F_x| / F_z where a toe carries at least 2 % of its even share of the weight.
        - friction_at_impact: |Λ_x| / Λ_z of the impulse at touchdown.
        - clearance: lowest height of the toe while only the other leg is on the ground, without 1 ms
          around its own events, in m; None if that never happens.
        - flight_clearance: lowest height of the toe in flight, without 1 ms around its own events, in m; None
          without flight.
        - scuff_free*: whether all of these heights are above zero.

        Of the motors, by joint:

        - peak_torque, rms_torque: in N·m.
        - peak_torque_stance, peak_torque_swing: while the joint's leg is on the ground, and while it is not, in N·m.
        - peak_speed: of the joint, in rad/s.

        Of the energy, all motors together, in J a stride:

        - energy: by flow, from the ledger. impact_loss: energy lost in impacts, >= 0. released: energy
          lost with springs that release, <= 0.
        - energy_balance: sum of all flows, zero for a periodic stride. energy_residual: largest
          imbalance of any stride.
        - work, positive_work, absolute_work, cost_of_transport, cost_of_transport_positive, effort and
          effort_per_distance: as of the catalogue.
        - measures: all of `spear_pin.gaits.measures.catalogue`, by name.

        cycles and reason are those of the trajectory.

    Raises:
        BadValue: the gait is not a bounding gait, or the trajectory has no whole stride.
    """
    if gait.system.kind != "bounding":
        raise BadValue("gait", gait.system.kind, "a bounding gait")
    if trajectory.cycles == 0:
        raise BadValue("trajectory.cycles", 0, f"at least one whole stride ({trajectory.message})")
    stride = _Stride(gait, trajectory)
    law, ledger = gait.system.law, trajectory.ledger
    flows = {name: float(ledger[name][0]) for name in ledger.flows}
    return {
        "lift_off": law.lift_off,
        "stiffness": gait.system.spring.stiffness,
        "stiffness_per_leg": gait.system.spring.stiffness / PAIR,
        "friction": gait.system.contact.friction,
        "knee_rest": law.knee_rest,
        "knee_touchdown": law.knee_touchdown,
        "durations": dict(gait.durations),
        "residual": gait.residual,
        "multipliers": gait.multipliers,
        "stable": gait.stable,
        **stride.motion(),
        **stride.ground(),
        **stride.motors(),
        "energy_flows": flows,
        "impact_loss": -flows["impact"],
        "released": flows["released"],
        "energy_balance": sum(flows.values()),
        "energy_residual": float(np.abs(ledger.residual).max()),
        "measures": stride.sampled.values(),
        "cycles": trajectory.cycles,
        "reason": trajectory.reason,
    }


class _Stride:
    """The first whole stride of a trajectory."""

    def __init__(self, gait: Gait, trajectory: Trajectory) -> None:
        chosen = trajectory.cycle == 1
        self.robot, self.law, self.toes = gait.system.robot, gait.system.law, trajectory.toes
        self.system, self.legs = gait.system, legs_of(self.robot)
        self.t, self.q, self.v, self.u = (getattr(trajectory, name)[chosen] for name in ("t", "q", "v", "u"))
        self.force, self.phase, self.domain = (
            trajectory.force[chosen],
            trajectory.phase[chosen],
            trajectory.domain[chosen],
        )
        begin, end = self.t[0] + INSTANT, self.t[-1] + INSTANT
        self.events = [event for event in trajectory.events if begin < event.time <= end]
        happened = {event.name for event in self.events}
        if not {f"{leg.name}_{event}" for leg in self.legs for event in ("touchdown", "lift_off")} <= happened:
            raise BadValue("trajectory.events", sorted(happened), "a first stride in which both legs land and lift off")
        self.sampled, self.chosen = Sampled(self.robot, trajectory), chosen
        self.stride = float(self.q[-1, 0] - self.q[0, 0])
        self.bears = {leg.name: self._bearing(leg) for leg in self.legs}

    def motion(self) -> dict[str, Any]:
        """Returns figures of the body, and of the legs as they land."""
        landed = {leg.name: self._named(f"{leg.name}_touchdown")[0].q for leg in self.legs}
        return {
            "speed": self.stride / float(self.t[-1] - self.t[0]),
            "period": float(self.t[-1] - self.t[0]),
            "stride": self.stride,
            "knee_at_touchdown": {leg.name: leg.side * float(landed[leg.name][leg.knee]) for leg in self.legs},
            "leg_at_touchdown": {leg.name: float(value(leg.angle, landed[leg.name].tolist())) for leg in self.legs},
            "pitch": self.sampled.curves.range(self.sampled.trajectory.q[:, 2]),
            "height": self.sampled.curves.range(self.sampled.trajectory.q[:, 1]),
        }

    def ground(self) -> dict[str, Any]:
        """Returns ground forces, and how near the toes come to the ground."""
        names = [leg.name for leg in self.legs]
        normal = {name: self.force[:, i, 1] for i, name in enumerate(names)}
        least = []
        for i, name in enumerate(names):
            last = self.bears[name] & (self._until(f"{name}_lift_off") <= LAST)
            counted = self.bears[name] & ~(last if self.law.lift_off == "force" else np.zeros_like(last))
            least.append(-self._curves(counted).peak(-self.sampled.trajectory.force[:, i, 1]))
        heights = {leg.name: self._heights(leg) for leg in self.legs}
        other = dict(zip(names, names[::-1], strict=True))
        clearance = {name: _lowest(heights[name][self._aloft(name, f"{other[name]}_stance")]) for name in names}
        flight = {name: _lowest(heights[name][self._aloft(name, "flight")]) for name in names}
        return {
            "peak_force": dict(zip(names, self.sampled.of("peak_force").values(), strict=True)),
            "lift_off_force": {name: self._lift_off_force(name, normal[name]) for name in names},
            "minimum_force": float(min(least)),
            "friction_used": self.sampled.largest("friction_used"),
            "friction_at_impact": {
                name: max(
                    [
                        abs(float(event.impulse[i, 0])) / float(event.impulse[i, 1])
                        for event in self._named(f"{name}_touchdown")
                        if event.impulse[i, 1] > 0.0
                    ],
                    default=0.0,
                )
                for i, name in enumerate(names)
            },
            "clearance": clearance,
            "flight_clearance": flight,
            "scuff_free": all(height is None or height > 0.0 for height in (*clearance.values(), *flight.values())),
        }

    def motors(self) -> dict[str, Any]:
        """Returns figures of the motors, and the costs."""
        joints, costs = self.robot.actuated, ("cost_of_transport", "cost_of_transport_positive", "effort_per_distance")
        leg_of = {column: leg.name for leg in self.legs for column in leg.motors}

        def peaks(bears: bool) -> dict[str, float]:
            return {
                joint: self._curves(self.bears[leg_of[i]] == bears).amount(self.sampled.trajectory.u[:, i]) / PAIR
                for i, joint in enumerate(joints)
            }

        return {
            **{name: self.sampled.of(name) for name in ("peak_torque", "rms_torque", "peak_speed")},
            "peak_torque_stance": peaks(True),
            "peak_torque_swing": peaks(False),
            **{
                name: self.sampled.largest(name)
                for name in ("work", "positive_work", "absolute_work", "effort", *costs)
            },
        }

    def _curves(self, chosen: Mask) -> Curves:
        """Returns the chosen samples of the stride."""
        among = np.zeros_like(self.chosen)
        among[self.chosen] = chosen
        return self.sampled.curves.among(among)

    def _bearing(self, leg: Leg) -> Mask:
        double = np.char.startswith(self.phase, "double")
        return np.asarray((self.phase == f"{leg.name}_stance") | double)

    def _named(self, name: str) -> list[Event]:
        return [event for event in self.events if event.name == name]

    def _until(self, name: str) -> Array:
        """Returns the time from each sample to the next event of a name, in s; infinite where none follows."""
        times = np.array([*(event.time for event in self._named(name)), np.inf])
        return np.asarray(times[np.searchsorted(times, self.t - INSTANT)] - self.t)

    def _since(self, name: str) -> Array:
        times = np.array([-np.inf, *(event.time for event in self._named(name))])
        return np.asarray(self.t - times[np.searchsorted(times, self.t + INSTANT) - 1])

    def _aloft(self, name: str, phase: str) -> Mask:
        """Tells which samples are in phases with names that begin so, away from the leg's own events."""
        near = (self._until(f"{name}_touchdown") < NEAR) | (self._since(f"{name}_lift_off") < NEAR)
        return np.char.startswith(self.phase, phase) & ~near

    def _heights(self, leg: Leg) -> Array:
        return np.array([self.system.ground.foot(self.robot, q, leg.toe)[0] for q in self.q])

    def _lift_off_force(self, name: str, normal: Array) -> float:
        """Returns the largest force of several lift-offs; 0 where the foot slid too briefly for a sample."""
        found = [0.0]
        for event in self._named(f"{name}_lift_off"):
            before = np.flatnonzero((self.t <= event.time + INSTANT) & (self.domain == event.domain))
            found += normal[before[-1:]].tolist()
        return max(found)


def _lowest(heights: Array) -> float | None:
    return float(heights.min()) if len(heights) else None
