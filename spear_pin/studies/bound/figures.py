"""Figures of a bound per stride: speed, ground forces, torques of each motor, energy and its cost."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import PAIR, legs_of
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.measures.curves import Mask
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
        "released": float(ledger["released"][0]),
        "energy_balance": sum(flows.values()),
        "energy_residual": float(np.abs(ledger.residual).max()),
        "measures": stride.sampled.values(),
        "cycles": trajectory.cycles,
        "reason": trajectory.reason,
    }


class _Stride:
    """The first whole stride of a trajectory; masks are of all samples of the trajectory."""

    def __init__(self, gait: Gait, trajectory: Trajectory) -> None:
        self.system, self.robot = gait.system, gait.system.robot
        self.trajectory, self.legs = trajectory, legs_of(self.robot)
        self.sampled = Sampled(self.robot, trajectory)
        self.curves = self.sampled.curves
        begin, end = trajectory.t[self.curves.chosen][[0, -1]] + INSTANT
        self.events = [event for event in trajectory.events if begin < event.time <= end]
        happened = {event.name for event in self.events}
        if not {f"{leg.name}_{event}" for leg in self.legs for event in ("touchdown", "lift_off")} <= happened:
            raise BadValue("trajectory.events", sorted(happened), "a first stride in which both legs land and lift off")
        self.bears = {leg.name: self._in(f"{leg.name}_stance") | self._in("double") for leg in self.legs}

    def motion(self) -> dict[str, Any]:
        """Returns figures of the body, and of the legs as they land."""
        landed = {leg: self._named(f"{leg.name}_touchdown")[0].q for leg in self.legs}
        return {
            "speed": self.sampled.largest("mean_speed"),
            "period": self.sampled.period,
            "stride": self.sampled.stride,
            "knee_at_touchdown": {leg.name: leg.side * float(q[leg.knee]) for leg, q in landed.items()},
            "leg_at_touchdown": {leg.name: float(value(leg.angle, q.tolist())) for leg, q in landed.items()},
            "pitch": self.curves.range(self.trajectory.q[:, 2]),
            "height": self.curves.range(self.trajectory.q[:, 1]),
        }

    def ground(self) -> dict[str, Any]:
        """Returns ground forces, and how near the toes come to the ground."""
        names = [leg.name for leg in self.legs]
        normal = {name: self.trajectory.force[:, i, 1] for i, name in enumerate(names)}
        least = []
        for name in names:
            fades = (self._until(f"{name}_lift_off") <= LAST) & (self.system.law.lift_off == "force")
            least.append(-self.curves.among(self.bears[name] & ~fades).peak(-normal[name]))
        clearance, flight = {}, {}
        for leg, other in zip(self.legs, names[::-1], strict=True):
            clearance[leg.name] = self._lowest(leg, f"{other}_stance")
            flight[leg.name] = self._lowest(leg, "flight")
        return {
            "peak_force": dict(zip(names, self.sampled.of("peak_force").values(), strict=True)),
            "lift_off_force": {name: self._lift_off_force(name, normal[name]) for name in names},
            "minimum_force": float(min(least)),
            "friction_used": self.sampled.largest("friction_used"),
            "friction_at_impact": {
                name: max(
                    [
                        abs(float(along)) / float(upward)
                        for along, upward in (event.impulse[i] for event in self._named(f"{name}_touchdown"))
                        if upward > 0.0
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
        leg_of = {self.robot.actuated[column]: leg.name for leg in self.legs for column in leg.motors}

        def peaks(bears: bool) -> dict[str, float]:
            return {
                joint: self.curves.among(self.bears[leg_of[joint]] == bears).amount(torque)
                for joint, torque in self.sampled.torques.items()
            }

        costs = ("cost_of_transport", "cost_of_transport_positive", "effort_per_distance")
        totals = ("work", "positive_work", "absolute_work", "effort", *costs)
        return {
            **{name: self.sampled.of(name) for name in ("peak_torque", "rms_torque", "peak_speed")},
            "peak_torque_stance": peaks(True),
            "peak_torque_swing": peaks(False),
            **{name: self.sampled.largest(name) for name in totals},
        }

    def _in(self, phase: str) -> Mask:
        """Tells which samples are in phases with names that begin so."""
        return np.char.startswith(self.trajectory.phase, phase)

    def _named(self, name: str) -> list[Event]:
        return [event for event in self.events if event.name == name]

    def _until(self, name: str) -> Array:
        """Returns the time from each sample to the next event of a name, in s; infinite where none follows."""
        times = np.array([*(event.time for event in self._named(name)), np.inf])
        return np.asarray(times[np.searchsorted(times, self.trajectory.t - INSTANT)] - self.trajectory.t)

    def _since(self, name: str) -> Array:
        times = np.array([-np.inf, *(event.time for event in self._named(name))])
        return np.asarray(self.trajectory.t - times[np.searchsorted(times, self.trajectory.t + INSTANT) - 1])

    def _lowest(self, leg: Leg, phase: str) -> float | None:
        """Returns the lowest height of a toe in phases with names that begin so, away from the leg's own events."""
        near = (self._until(f"{leg.name}_touchdown") < NEAR) | (self._since(f"{leg.name}_lift_off") < NEAR)
        aloft = self.trajectory.q[self.curves.chosen & self._in(phase) & ~near]
        return min((float(self.system.ground.foot(self.robot, q, leg.toe)[0]) for q in aloft), default=None)

    def _lift_off_force(self, name: str, normal: Array) -> float:
        """Returns the largest force of several lift-offs; 0 where the foot slid too briefly for a sample."""
        found, one = [0.0], self.trajectory
        for event in self._named(f"{name}_lift_off"):
            before = np.flatnonzero(self.curves.chosen & (one.t <= event.time + INSTANT) & (one.domain == event.domain))
            found += normal[before[-1:]].tolist()
        return max(found)
