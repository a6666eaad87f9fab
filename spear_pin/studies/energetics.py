"""Energy flow of a hop or a stride, from the battery to the ground, and costs of transport (Figs. 2.4, 4.1).

Q-SPEAR's joints in the sagittal plane are pairs: trajectories, and hardware in them, are those of both legs of each
pair, so all energies here are those of the whole robot. A `Drive` belongs to one motor: a pair has two.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.gaits.measures.curves import Curves
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.measures.signals import LEAST_STRIDE, transport
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.rules.cycles import RETOUCH
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.motor import Drive
from spear_pin.studies.published_costs import CostPoint, Kind

REGENERATION = {"electrical_0": 0.0, "electrical_24": 0.24, "electrical_100": 1.0}  # 24 %: Chapter 1, of its [42]


@dataclass(frozen=True)
class JointFlow:
    """Energy that goes through the actuator of a joint, in J a cycle.

    Attributes:
        joint: name of the joint.
        given: energy from the battery.
        regained: energy back to the battery; each actuator has its own battery, so the others do not use it.
        joule: heat of winding and battery.
        gearbox: energy lost in the gears.
        motor: net mechanical work on the joint.
    """

    joint: str
    given: float
    regained: float
    joule: float
    gearbox: float
    motor: float


@dataclass(frozen=True)
class EnergyFlow:
    """Energy flow of Fig. 4.1 in numbers, the mean of whole cycles, in J a cycle; losses are positive.

    Attributes:
        joints: flow through each actuator.
        damping: energy lost in the damping of the joints that carry springs.
        friction: energy lost in friction of the joints, by the URDF.
        impact: energy lost at touchdowns.
        released: energy lost with springs that release.
        slip: energy lost as toes slip on the ground.
        spring_stored: work done on springs by compression.
        spring_returned: work done by springs in extension.
        change: change of the energy that the mechanism stores: kinetic, gravity, springs; zero for a periodic gait.
        magnetic: change of the energy that inductances store.
        gap: difference between quadrature of the battery's power over the samples and the ledger; `regained` is about
            as accurate, and `given` follows from the ledger, so that the balance is exact.
    """

    joints: tuple[JointFlow, ...]
    damping: float
    friction: float
    impact: float
    released: float
    slip: float
    spring_stored: float
    spring_returned: float
    change: float
    magnetic: float
    gap: float

    def total(self, flow: str) -> float:
        """Returns the sum over all actuators of a field of `JointFlow`."""
        return float(sum(getattr(joint, flow) for joint in self.joints))

    @property
    def battery(self) -> float:
        """Net energy from the batteries."""
        return self.total("given") - self.total("regained")

    @property
    def losses(self) -> dict[str, float]:
        """Energy lost, in order from the battery to the ground."""
        electrical = {name: self.total(name) for name in ("joule", "gearbox")}
        return electrical | {name: getattr(self, name) for name in MECHANICAL}

    @property
    def residual(self) -> float:
        """Imbalance of energy: battery less losses less the change of stored energy."""
        return self.battery - sum(self.losses.values()) - self.change - self.magnetic


MECHANICAL = ("damping", "friction", "impact", "released", "slip")  # losses behind the motors


@typed
def energy_flow(system: HybridSystem, trajectory: Trajectory, skip: int = 0) -> EnergyFlow:
    """Returns the energy flow of a trajectory with hardware.

    Args:
        system: the simulated system, for its actuators.
        trajectory: trajectory of whole cycles.
        skip: number of cycles at the beginning to leave out.

    Raises:
        BadValue: there is no hardware, or no cycle is left.
    """
    hardware, electrical, ledger = system.hardware, trajectory.electrical, trajectory.ledger
    if hardware is None or electrical is None:
        raise BadValue("trajectory.electrical", electrical, "a ledger: simulate a system with hardware")
    sampled = Sampled(system.robot, trajectory, _cycles(trajectory, skip))
    given, regained = _halves(sampled, _battery_power(system, sampled))
    columns = [trajectory.coordinates.index(joint) for joint in trajectory.spring_joints]
    extends, compresses = _halves(sampled, trajectory.spring * trajectory.v[:, columns])
    joints = []
    for i, joint in enumerate(trajectory.actuated):
        net, joule, gearbox, motor = (
            float(electrical[f"{flow}_{joint}"][skip:].mean()) for flow in ("battery", "joule", "gearbox", "motor")
        )
        joints.append(JointFlow(joint, net + regained[i], regained[i], -joule, -gearbox, -motor))
    return EnergyFlow(
        tuple(joints),
        **{name: 0.0 - float(ledger[name][skip:].mean()) for name in MECHANICAL},
        spring_stored=sum(compresses),
        spring_returned=sum(extends),
        change=float(ledger.change[skip:].mean()),
        magnetic=float(electrical.change[skip:].mean()),
        gap=sum(given) - sum(joint.given for joint in joints),
    )


@dataclass(frozen=True)
class Costs:
    """Cost of a cycle by each usual definition.

    Attributes:
        energy: in J a cycle: "mechanical_absolute", ∫ Σ |u ω| dt; "mechanical_positive", ∫ Σ max(u ω, 0) dt; where
            the motors are known, of the electrical power "electrical_0", "electrical_24" and "electrical_100", the
            positive part less so many percent of the negative one, motor by motor.
        mass: in kg.
        weight: in N.
        distance: distance covered in a cycle, in m.
        rise: h, height of the hip at the apex above that at lift-off, in m; NaN without apexes.
    """

    energy: Mapping[str, float]
    mass: float
    weight: float
    distance: float
    rise: float

    @property
    def of_transport(self) -> dict[str, float]:
        """E / (m g d), by definition.

        Raises:
            BadValue: the gait does not advance.
        """
        require("distance", self.distance, lambda d: d > LEAST_STRIDE, "a number > 0, in m: a gait that goes forward")
        return {name: transport(energy, self.weight, self.distance) for name, energy in self.energy.items()}

    @property
    def of_height(self) -> dict[str, float]:
        """E / (m g h), by definition.

        Raises:
            BadValue: nothing rises from lift-off to an apex.
        """
        if not self.rise > 0.0:
            raise BadValue("rise", self.rise, "a number > 0, in m: a hop with an apex")
        return {name: energy / (self.weight * self.rise) for name, energy in self.energy.items()}


@typed
def costs(system: HybridSystem, trajectory: Trajectory, drives: Sequence[Drive] | None = None, skip: int = 0) -> Costs:
    """Returns the cost of a gait, the mean of whole cycles.

    Args:
        system: the simulated system; electrical energy is computed from its hardware.
        trajectory: trajectory of whole cycles.
        drives: drive of one motor of each actuated joint, where there is no hardware.
        skip: number of cycles at the beginning to leave out.

    Raises:
        BadValue: hardware and drives are given, the numbers of drives and joints differ, or no cycle is left.
    """
    robot = system.robot
    if drives is not None and len(drives) != len(trajectory.actuated):
        raise BadValue("drives", len(drives), f"{len(trajectory.actuated)}, one for each of {trajectory.actuated}")
    driven = dict(zip(trajectory.actuated, drives or (), strict=False))
    sampled = Sampled(robot, trajectory, _cycles(trajectory, skip), bool(system.mirrored_toes), driven)
    energy = {f"mechanical_{kind}": sampled.largest(f"{kind}_work") for kind in ("absolute", "positive")}
    parts: tuple[float, float] | None = None
    if trajectory.electrical is not None:
        if drives is not None:
            raise BadValue("drives", drives, "None: the trajectory has hardware")
        flow = energy_flow(system, trajectory, skip)
        parts = flow.total("given"), flow.total("regained")
    elif drives is not None:
        halves = [each for joint in driven if (each := sampled.electricity(joint))]
        parts = sum(given for given, _ in halves), sum(regained for _, regained in halves)
    if parts is not None:
        energy |= {name: parts[0] - share * parts[1] for name, share in REGENERATION.items()}
    distance = sampled.stride if system.cyclic else 0.0
    return Costs(energy, robot.mass, robot.weight, distance or 0.0, _rise(sampled))


def compute_points(name: str, of: Costs) -> tuple[CostPoint, ...]:
    """Returns points of a gait to compare with `PUBLISHED`: positive mechanical work, electricity without return."""
    kinds: dict[str, Kind] = {"mechanical_positive": "mechanical", "electrical_0": "electrical"}
    found = of.of_transport
    return tuple(
        CostPoint(name, of.mass, found[definition], kind, definition, "computed")
        for definition, kind in kinds.items()
        if definition in found
    )


def _cycles(trajectory: Trajectory, skip: int) -> range:
    """Returns the numbers of the whole cycles that count."""
    if not 0 <= skip < trajectory.cycles:
        raise BadValue("skip", skip, f"a number from 0 to below the {trajectory.cycles} whole cycles there are")
    return range(skip + 1, trajectory.cycles + 1)


def _battery_power(system: HybridSystem, sampled: Sampled) -> Array:
    """Returns the power of each actuator's battery at the samples, in W, (n, actuators)."""
    assert system.hardware is not None
    t, current, actuators = sampled.trajectory.t, sampled.trajectory.current, system.hardware.actuators
    slope, rates = np.zeros_like(current), np.array([*sampled.speeds.values()]).T
    for run in Curves.of(t).runs:
        slope[run] = scipy.interpolate.PchipInterpolator(t[run], current[run])(t[run], 1)
    return np.array(
        [
            [
                actuator.power(i, rate, change if actuator.bandwidth is not None else 0.0).battery
                for actuator, i, rate, change in zip(actuators, *row, strict=True)
            ]
            for row in zip(current.tolist(), rates.tolist(), slope.tolist(), strict=True)
        ]
    )


def _halves(sampled: Sampled, power: Array) -> tuple[list[float], list[float]]:
    """Returns integrals of the positive and the negative part of powers, (n, k), both positive, in J a cycle, (k,)."""
    return [sampled.positive(each) for each in power.T], [sampled.positive(-each) for each in power.T]


def _rise(sampled: Sampled) -> float:
    """Returns the mean height of the flights' apexes above the lift-offs before them, in m; NaN if there are none."""
    trajectory = sampled.trajectory
    begin, end = trajectory.t[sampled.curves.chosen][[0, -1]]
    rises, left, highest = [], None, math.nan
    for event in trajectory.events:
        if event.name == "lift_off":
            left = event
        elif event.name == "apex" and left is not None and begin <= event.time <= end:
            vertical = trajectory.coordinates.index("boom_z")
            highest = float(event.q[vertical] - left.q[vertical])
        elif event.name in ("touchdown", RETOUCH):
            rises += [highest] if event.name == "touchdown" and math.isfinite(highest) else []
            highest = math.nan
    return float(np.mean(rises)) if rises else math.nan
