"""A gait of given footfalls as a nonlinear programme: motion, contact, impacts and closing at the nodes."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.collocation import Guess, Programme, casadi, hermite_simpson, quadrature
from spear_pin.gaits.footfalls.limbs import Limb, limbs_of
from spear_pin.gaits.footfalls.nodes import BASE, Mechanics, Node, Room
from spear_pin.gaits.footfalls.plan import X, Y, YAW, Plan
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.footfalls.sequence import Bearing, opposite
from spear_pin.hybrid.symmetry import mirror_of
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_in_space

Array = NDArray[np.float64]
CONE = 0.98  # of the friction asked for: what the collocation's error may use up
OF_EFFORT = 1e-3  # what the effort is multiplied by to be of order ten
FALLS = 0.1  # m/s of Q-SPEAR: at least, of a foot that lands
RISES = 1.0  # m/s² of Q-SPEAR: at least, of one that lifts off
ROUND = 1e-6  # rad²: about which a spring that pulls only is smooth
CONSTANTS = ("hip", "knee", "adduction")


@dataclass
class Transcription:
    """The nonlinear programme of a request, and its parts.

    Attributes:
        request: what is asked.
        programme: to be solved.
        limbs: the robot's legs.
        phases: the nodes of each phase.
        torques: of the motors at each of them, nv - 6.
        durations: of the phases.
        constants: of the stance law, of each leg: hip, knee and adduction.
        stride: distance of all phases.
    """

    request: FootfallRequest
    programme: Programme
    limbs: Mapping[str, Limb]
    phases: list[list[Node]] = field(default_factory=list)
    torques: list[list[Any]] = field(default_factory=list)
    durations: list[Any] = field(default_factory=list)
    constants: dict[str, tuple[Any, Any, Any]] = field(default_factory=dict)
    stride: Any = 0.0


def transcribe(robot: Robot, request: FootfallRequest, *, start: Guess | None = None) -> Transcription:
    """The nonlinear programme of a request.

    Args:
        robot: a quadruped on a chain, such as `load("q_spear_full", base="chain")`.
        request: what is asked.
        start: values to start from, by name.

    Raises:
        BadValue: the robot is none of these.
        MissingExtra: CasADi is not installed.
    """
    writer = _Writer(robot, request, Programme(start))
    for i in range(len(request.footfalls.phases)):
        writer.add_phase(i)
        if i:
            writer.join(i)
    writer.close()
    return writer.result


def name_of(phase: int, bearing: Sequence[str]) -> str:
    """Name of a phase among the unknowns, in words."""
    return f"phase {phase + 1}, {' and '.join(each.replace('_', ' ') for each in bearing) or 'flight'}"


class _Writer:
    """Writer of the programme, with what its parts share while they are written."""

    def __init__(self, robot: Robot, request: FootfallRequest, programme: Programme) -> None:
        self.robot, self.request, self.programme = robot, request, programme
        self.limbs, self.scale, self.mirror = limbs_of(robot), scale_in_space(robot), mirror_of(robot)
        self.room, self.mechanics = Room(robot, self.limbs, request, self.scale), Mechanics(robot, self.limbs)
        gravity = float(np.linalg.norm(robot.model.gravity.linear))
        self.plan = Plan(self.limbs, request, self.scale, robot.mass * gravity)
        self.unit, self.force = self.room.units
        self.names = [name_of(i, phase) for i, phase in enumerate(request.footfalls.phases)]
        self.landed: dict[str, Node] = {}
        self.result = Transcription(request, programme, self.limbs)

    # phases

    def add_phase(self, i: int) -> None:
        """One phase by itself."""
        programme, request, plan, label = self.programme, self.request, self.plan, self.names[i]
        bearing, count = request.footfalls.phases[i], 2 * request.footfalls.intervals[i]
        shortest = request.shortest[0 if bearing else 1]
        duration = programme.variable(f"{label} lasts", plan.durations[i], shortest, request.longest)
        nodes = []
        for k in range(count + 1):
            time = plan.begins(i) + plan.durations[i] * k / count
            guess = plan.q(time, self.robot.nv), plan.v(time, self.robot.nv)
            unknowns = self.room.add(programme, label, k / count, guess, bearing, plan.push)
            nodes.append(self.mechanics.node(*unknowns))
        for leg in bearing:
            if i == 0 or leg not in request.footfalls.phases[i - 1]:
                self.lands(leg, nodes[0])
        self.result.phases.append(nodes)
        self.result.durations.append(duration)
        self.result.torques.append([self.torques(label, node, bearing) for node in nodes])
        for k, node in enumerate(nodes):
            self.keep(label, node, bearing)
            time = plan.begins(i) + plan.durations[i] * k / count
            self.clear(label, node, [(leg, plan.swung(leg, time)) for leg in self.limbs if leg not in bearing])
        speed = self.unit / self.scale.time
        for part, slope, unit in (("q", "v", self.unit), ("v", "a", speed)):
            x, f = ([getattr(node, name) for node in nodes] for name in (part, slope))
            hermite_simpson(programme, f"motion in {label}", duration, x, f, unit)

    def lands(self, leg: str, node: Node) -> None:
        """A leg begins to bear: its spring is latched, and its law's constants hold from here on."""
        self.landed[leg] = node
        law = self.request.law
        if law is None:
            return
        most = law.most
        self.result.constants[leg] = tuple(  # type: ignore[assignment]
            self.programme.variable(f"{leg} {name}", 0.0, -most, most, 0.2 * most) for name in CONSTANTS
        )
        flexion = self.limbs[leg].flexion(node.q)
        self.programme.require(f"knee of {leg} at touchdown", flexion, law.knee_rest, law.knee_rest)

    def torques(self, label: str, node: Node, bearing: Bearing) -> Any:
        """Torques of the motors, (nv - 6,), the torso being moved by nothing; within the limits of the joints."""
        ca, programme, most = casadi(), self.programme, self.room.joints("effort", np.inf)
        needed = node.needed + ca.DM(self.robot.model.damping) * node.v
        programme.require(f"motion in {label}", needed[:BASE], 0.0, 0.0, scale=50.0 * self.force[:BASE])
        u = needed[BASE:]
        for leg in bearing:
            limb = self.limbs[leg]
            u[limb.knee - BASE] -= self.spring(limb, node)
            if self.request.law is not None:
                self.follow(label, limb, node, u)
        if np.isfinite(most).any():
            rows = np.flatnonzero(np.isfinite(most)).tolist()
            programme.require(f"torques in {label}", u[rows], -most[rows], most[rows], scale=50.0 * self.scale.torque)
        return u

    def spring(self, limb: Limb, node: Node) -> Any:
        """Torque of a knee's spring, which pulls only beyond the angle at touchdown."""
        if self.request.spring is None:
            return 0.0
        deflection = limb.flexion(node.q) - limb.flexion(self.landed[limb.name].q)
        deflection = 0.5 * (deflection + (deflection * deflection + ROUND) ** 0.5)
        ops, side = SimpleNamespace(maximum=casadi().fmax), limb.leg.side
        rate = side * node.v[limb.knee]
        return side * (self.request.spring.torque(deflection, ops) + self.request.spring.drag(rate))

    def follow(self, label: str, limb: Limb, node: Node, u: Any) -> None:
        """Torques of a leg on the ground in the form of the law."""
        law, (hip, knee, upright) = self.request.law, self.result.constants[limb.name]
        assert law is not None
        total = u[limb.knee - BASE] + self.spring(limb, node)
        off = node.q[limb.adduction] - self.landed[limb.name].q[limb.adduction]
        held = law.adduction_stiffness * off + law.adduction_damping * node.v[limb.adduction]
        missed = (
            u[limb.hip - BASE] - hip,
            total + limb.leg.side * (knee + law.stiffness * (limb.flexion(node.q) - law.knee_rest)),
            u[limb.adduction - BASE] - upright + held,
        )
        self.programme.require(f"law in {label}", casadi().vertcat(*missed), 0.0, 0.0, scale=50.0 * self.scale.torque)

    def keep(self, label: str, node: Node, bearing: Bearing) -> None:
        """Feet on the ground stay at rest, pressed into it within the friction cone."""
        programme, scale = self.programme, self.scale
        for leg in bearing:
            _, _, acceleration = node.toes[leg]
            unit = 10.0 * scale.length / scale.time**2
            programme.require(f"motion in {label}", acceleration, 0.0, 0.0, scale=unit)
            self.cone(f"friction in {label}", node.F[leg], 100.0 * scale.force)
            programme.require(
                f"normal force in {label}", node.F[leg][2], self.request.minimum_force, scale=100.0 * scale.force
            )

    def clear(self, label: str, node: Node, swinging: Sequence[tuple[str, float]]) -> None:
        """Feet in the air are above the ground, in the middle of their way at least by the clearance.

        Nothing is asked where they land and lift off: that they touch the ground there is asked elsewhere.
        """
        for leg, gone in swinging:
            if 1e-6 < gone < 1.0 - 1e-6:
                height = 4.0 * gone * (1.0 - gone) * self.request.clearance
                position, _, _ = node.toes[leg]
                self.programme.require(f"clearance in {label}", position[2], height, scale=0.1 * self.scale.length)

    def cone(self, label: str, F: Any, unit: float) -> None:
        """A force or impulse inside the friction cone."""
        most = CONE * self.request.friction * F[2] / unit
        self.programme.require(label, most * most - (F[0] * F[0] + F[1] * F[1]) / unit**2, 0.0)

    # between phases

    def join(self, i: int) -> None:
        """A phase follows another: feet lift off, and others land by an impact."""
        last, first, label = self.result.phases[i - 1][-1], self.result.phases[i][0], f"motion in {self.names[i]}"
        before, after = (self.request.footfalls.phases[j] for j in (i - 1, i))
        self.programme.require(label, first.q - last.q, 0.0, 0.0, scale=self.unit)
        for leg in before:
            if leg not in after:
                self.lifts(i, leg, last, first)
        if landing := [leg for leg in after if leg not in before]:
            self.strike(i, last, first.v, after, landing)
        else:
            self.programme.require(label, first.v - last.v, 0.0, 0.0, scale=self.unit / self.scale.time)

    def lifts(self, i: int, leg: str, last: Node, first: Node) -> None:
        """A foot leaves the ground."""
        law, unit = self.request.law, 10.0 * self.scale.length / self.scale.time**2
        _, _, acceleration = first.toes[leg]
        label = f"{leg} lifts off into {self.names[i]}"
        self.programme.require(label, acceleration[2], 0.1 * RISES * unit, scale=unit)
        if law is not None:
            self.programme.require(label, self.limbs[leg].flexion(last.q), law.knee_rest, law.knee_rest)

    def strike(self, i: int, before: Node, v: Any, bearing: Sequence[str], landing: Sequence[str]) -> None:
        """Feet land: those that bear then are at rest, by impulses within the cone."""
        programme, scale, label = self.programme, self.scale, f"touchdown into {self.names[i]}"
        unit, speed = 10.0 * scale.force * scale.time, scale.speed
        impulses = {
            leg: programme.variable(
                f"{label}, impulse of {leg}",
                [0.0, 0.0, unit],
                [-30.0 * unit, -30.0 * unit, 1e-3 * unit],
                60.0 * unit,
                unit,
            )
            for leg in bearing
        }
        missed = self.mechanics.struck(before.q, v - before.v, impulses)
        programme.require(label, missed, 0.0, 0.0, scale=10.0 * self.force * scale.time)
        resting = self.mechanics.moving(before.q, v)
        for leg in bearing:
            programme.require(label, resting[leg][1], 0.0, 0.0, scale=speed)
            self.cone(f"friction at {label}", impulses[leg], unit)
        for leg in landing:
            position, velocity, _ = before.toes[leg]
            programme.require(label, position[2], 0.0, 0.0, scale=scale.length)
            programme.require(f"approach at {label}", velocity[2], -np.inf, -FALLS * speed, scale=speed)

    # the whole

    def close(self) -> None:
        """The last state is the first one, moved on, turned or mirrored; the speed; what is minimised."""
        programme, request, scale, result = self.programme, self.request, self.scale, self.result
        first, last = result.phases[0][0], result.phases[-1][-1]
        period, bearing = sum(result.durations), request.footfalls.phases[0]
        advance = request.speed * period * float(np.sinc(0.5 * request.turn / math.pi))
        q, v = self.image(first.q), self.moved(first.v)
        along, aside = (advance * part(0.5 * request.turn) for part in (math.cos, math.sin))
        q[X], q[Y], q[YAW] = along, q[Y] + aside, q[YAW] + request.turn
        programme.require("origin", first.q[X], 0.0, 0.0, scale=scale.length)
        if request.footfalls.mirrored:
            bearing = tuple(map(opposite, bearing))
        else:
            programme.require("origin", first.q[Y], 0.0, 0.0, scale=scale.length)
        programme.require("closing", last.q - q, 0.0, 0.0, scale=self.unit)
        for leg in self.request.footfalls.phases[-1]:
            if leg not in bearing:
                self.lifts_at_closing(leg, last)
        self.strike(0, last, v, bearing, [leg for leg in bearing if leg not in request.footfalls.phases[-1]])
        times = 2.0 if request.footfalls.mirrored else 1.0
        programme.require("duration of the stride", times * period, 0.0, request.longest_stride, scale=scale.time)
        phases = zip(result.durations, result.torques, strict=True)
        effort = sum(quadrature(time, [casadi().dot(u, u) for u in torques]) for time, torques in phases)
        result.stride = request.speed * period
        unit = scale.torque**2 * scale.time / scale.length
        programme.objective = OF_EFFORT * effort / (result.stride * unit)

    def lifts_at_closing(self, leg: str, last: Node) -> None:
        """A foot leaves the ground as a stride ends."""
        if self.request.law is not None:
            rest = self.request.law.knee_rest
            self.programme.require(f"{leg} lifts off", self.limbs[leg].flexion(last.q), rest, rest)

    def image(self, vector: Any) -> Any:
        """A configuration or velocity of the first node where the stride closes, mirrored if it is then."""
        if not self.request.footfalls.mirrored:
            return +vector
        seen = casadi().SX(vector)
        for i, (of, sign) in enumerate(zip(self.mirror.of, self.mirror.signs, strict=True)):
            seen[of] = sign * vector[i]
        return seen

    def moved(self, v: Any) -> Any:
        """A velocity of the first node where the stride closes."""
        seen, turn = self.image(v), self.request.turn
        x, y = seen[X], seen[Y]
        seen[X] = math.cos(turn) * x - math.sin(turn) * y
        seen[Y] = math.sin(turn) * x + math.cos(turn) * y
        return seen
