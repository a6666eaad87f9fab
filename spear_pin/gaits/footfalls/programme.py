"""A gait with given footfalls as a nonlinear programme: motion, contact, impacts and closing at the nodes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.collocation import Guess, Programme, casadi, hermite_simpson, node_name, quadrature
from spear_pin.gaits.footfalls.limbs import hip_heights, legs_of
from spear_pin.gaits.footfalls.nodes import BASE, Mechanics, Node, Room
from spear_pin.gaits.footfalls.plan import YAW, Plan, X, Y
from spear_pin.gaits.footfalls.request import FootfallRequest
from spear_pin.gaits.footfalls.sequence import Bearing, opposite
from spear_pin.gaits.footfalls.swing import Air, Swings
from spear_pin.gaits.spatial.legs import Leg
from spear_pin.gaits.virtual_constraints import Evolution
from spear_pin.hybrid.symmetry import mirror_of
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale, scale_in_space

CONE = 0.98  # share of the requested friction; the collocation's error may use the rest
OF_EFFORT = 1e-3  # factor that brings the effort to order ten
FALLS = 0.1  # m/s for Q-SPEAR: least speed of a landing foot
HITS = 30.0  # of 10 N·s of Q-SPEAR: at most
RISES = 1.0  # m/s² for Q-SPEAR: least acceleration of a foot that lifts off
ROUND = 1e-6  # rad²: smoothing of a spring that only pulls
CONSTANTS = ("hip", "knee", "adduction")


@dataclass
class Transcription:
    """The nonlinear programme for a request, and its parts.

    Attributes:
        request: the request for the gait.
        programme: the programme to be solved.
        scale: the robot's size.
        names: names of the phases among the unknowns.
        phases: the nodes of each phase.
        torques: motor torques at each node of each phase, nv - 6.
        durations: durations of the phases.
        constants: constants of the stance law for each leg: hip, knee and adduction.
        evolutions: swing law in each phase for each leg in the air, and the angle at which its adduction lands.
    """

    request: FootfallRequest
    programme: Programme
    scale: Scale
    names: list[str]
    phases: list[list[Node]] = field(default_factory=list)
    torques: list[list[Any]] = field(default_factory=list)
    durations: list[Any] = field(default_factory=list)
    constants: dict[str, tuple[Any, Any, Any]] = field(default_factory=dict)
    evolutions: list[dict[str, tuple[Evolution, Any]]] = field(default_factory=list)


def transcribe(robot: Robot, request: FootfallRequest, *, start: Guess | None = None) -> Transcription:
    """Builds the nonlinear programme for a request.

    Args:
        robot: a quadruped on a chain, such as `load("q_spear_full", base="chain")`.
        request: the request for the gait.
        start: values to start from, by name.

    Raises:
        BadValue: the robot is not such a quadruped.
        MissingExtra: CasADi is not installed.
    """
    writer = _Writer(robot, request, start)
    for i in range(len(request.footfalls.phases)):
        writer.add_phase(i)
        if i:
            writer.join(i)
    writer.close()
    return writer.result


def impulse_name(phase: str, leg: str) -> str:
    """Returns the name of the impulse on a leg's foot as a phase begins."""
    return f"impulse of {leg} into {phase}"


def constant_name(leg: str, name: str) -> str:
    """Returns the name of a constant of a leg's stance law, one of `CONSTANTS`."""
    return f"{leg} {name}"


def _named(phase: int, bearing: Sequence[str]) -> str:
    """Returns the name of a phase in words."""
    return f"phase {phase + 1}, {' and '.join(each.replace('_', ' ') for each in bearing) or 'flight'}"


class _Writer:
    """Writer of the programme; holds what its parts share while they are written."""

    def __init__(self, robot: Robot, request: FootfallRequest, start: Guess | None) -> None:
        self.robot, self.request, self.start, self.programme = robot, request, start, Programme(start)
        self.limbs, self.scale, self.mirror = legs_of(robot), scale_in_space(robot), mirror_of(robot)
        self.room, self.mechanics = Room(robot, self.limbs, request, self.scale), Mechanics(robot, self.limbs)
        self.plan = Plan(self.limbs, hip_heights(robot), request, self.scale, robot.weight)
        self.unit, self.force = self.room.units
        self.names = [_named(i, phase) for i, phase in enumerate(request.footfalls.phases)]
        self.landed: dict[str, Node] = {}
        self.aims: dict[str, Any] = {}
        law, swing = request.law, request.swing
        self.swings = Swings(self.programme, self.limbs, swing, self.scale, law.knee_rest) if law and swing else None
        self.result = Transcription(request, self.programme, self.scale, self.names)

    # phases

    def add_phase(self, i: int) -> None:
        """Adds one phase by itself."""
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
        if self.swings is not None:
            self.swing(i, self.swings)
        speed = self.unit / self.scale.time
        for part, slope, unit in (("q", "v", self.unit), ("v", "a", speed)):
            x, f = ([getattr(node, name) for node in nodes] for name in (part, slope))
            hermite_simpson(programme, f"motion in {label}", duration, x, f, unit)

    def swing(self, i: int, swings: Swings) -> None:
        """Makes legs in the air follow the law."""
        phases, nodes = self.request.footfalls.whole, self.result.phases[i]
        landing = tuple(leg for leg in phases[(i + 1) % len(phases)] if leg not in phases[i])
        air, begins, lasts = Air(self.names[i], phases[i], landing, nodes), self.plan.begins(i), self.plan.durations[i]
        aims = {leg: self.aim(leg) for leg in self.limbs if leg not in phases[i]}

        def guess(s: float) -> Array:
            given = None if self.start is None else self.start(node_name(self.names[i], s, "q"))
            return self.plan.q(begins + s * lasts, self.robot.nv) if given is None else given

        found = swings.follow(air, guess, aims)
        self.result.evolutions.append({leg: (evolution, aims[leg]) for leg, evolution in found.items()})

    def aim(self, leg: str) -> Any:
        """Returns the angle at which a leg's adduction lands; with mirrored footfalls a right leg's is the left's."""
        own = opposite(leg) if self.request.footfalls.mirrored and leg.endswith("right") else leg
        if own not in self.aims:
            most = self.request.adduction
            self.aims[own] = self.programme.variable(f"{own} adduction lands at", 0.0, -most, most)
        return self.aims[own] if own == leg else -self.aims[own]

    def lands(self, leg: str, node: Node) -> None:
        """Lets a leg land: its spring is latched, and its law's constants hold from here on."""
        self.landed[leg] = node
        law = self.request.law
        if law is None:
            return
        most = law.most
        self.result.constants[leg] = tuple(
            self.programme.variable(constant_name(leg, name), 0.0, -most, most, 0.2 * most) for name in CONSTANTS
        )
        flexion = self.limbs[leg].flexion(node.q)
        self.programme.require(f"knee of {leg} at touchdown", flexion, law.knee_rest, law.knee_rest)

    def torques(self, label: str, node: Node, bearing: Bearing) -> Any:
        """Returns the motor torques, (nv - 6,), within the joints' limits; no force acts on the torso itself."""
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

    def spring(self, limb: Leg, node: Node) -> Any:
        """Returns the torque of a knee's spring, which pulls only beyond the angle at touchdown."""
        if self.request.spring is None:
            return 0.0
        deflection = limb.flexion(node.q) - limb.flexion(self.landed[limb.name].q)
        deflection = 0.5 * (deflection + (deflection * deflection + ROUND) ** 0.5)
        ops, side = SimpleNamespace(maximum=casadi().fmax), limb.side
        rate = side * node.v[limb.knee]
        return side * (self.request.spring.torque(deflection, ops) + self.request.spring.drag(rate))

    def follow(self, label: str, limb: Leg, node: Node, u: Any) -> None:
        """Requires that torques of a leg on the ground have the form of the law."""
        law, (hip, knee, upright) = self.request.law, self.result.constants[limb.name]
        assert law is not None
        total = u[limb.knee - BASE] + self.spring(limb, node)
        off = node.q[limb.adduction] - self.landed[limb.name].q[limb.adduction]
        held = law.adduction_stiffness * off + law.adduction_damping * node.v[limb.adduction]
        missed = (
            u[limb.hip - BASE] - hip,
            total + limb.side * (knee + law.stiffness * (limb.flexion(node.q) - law.knee_rest)),
            u[limb.adduction - BASE] - upright + held,
        )
        self.programme.require(f"law in {label}", casadi().vertcat(*missed), 0.0, 0.0, scale=50.0 * self.scale.torque)

    def keep(self, label: str, node: Node, bearing: Bearing) -> None:
        """Requires that feet on the ground rest, pressed into it within the friction cone."""
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
        """Requires that feet in the air are above the ground, and in mid-swing at least by the clearance.

        No condition holds where they land and lift off; other constraints put them on the ground there.
        """
        for leg, gone in swinging:
            if 1e-6 < gone < 1.0 - 1e-6:
                height = 4.0 * gone * (1.0 - gone) * self.request.clearance
                position, _, _ = node.toes[leg]
                self.programme.require(f"clearance in {label}", position[2], height, scale=0.1 * self.scale.length)

    def cone(self, label: str, F: Any, unit: float) -> None:
        """Requires that a force or impulse lies inside the friction cone."""
        most = CONE * self.request.friction * F[2] / unit
        self.programme.require(label, most * most - (F[0] * F[0] + F[1] * F[1]) / unit**2, 0.0)

    # between phases

    def join(self, i: int) -> None:
        """Requires that a phase follows another."""
        last, first, label = self.result.phases[i - 1][-1], self.result.phases[i][0], f"motion in {self.names[i]}"
        before, after = (self.request.footfalls.phases[j] for j in (i - 1, i))
        self.programme.require(label, first.q - last.q, 0.0, 0.0, scale=self.unit)
        for leg in before:
            if leg not in after:
                self.lifts(f"{leg} lifts off into {self.names[i]}", self.limbs[leg], last, first.toes[leg])
        self.strike(i, last, first.v, after, before)

    def lifts(self, label: str, limb: Leg, last: Node, toe: tuple[Any, Any, Any]) -> None:
        """Requires that a foot leaves the ground rising, and by the law with its knee back at its rest angle."""
        unit = 10.0 * self.scale.length / self.scale.time**2
        self.programme.require(label, toe[2][2], RISES * 0.1 * unit, scale=unit)
        if (law := self.request.law) is not None:
            self.programme.require(label, limb.flexion(last.q), law.knee_rest, law.knee_rest)

    def strike(self, i: int, before: Node, v: Any, bearing: Sequence[str], bore: Sequence[str]) -> None:
        """Requires an impact: feet on the ground rest after it, by impulses within the cone; only if one lands.

        Args:
            i: number of the phase that begins.
            before: the last node before it.
            v: velocity after the impact.
            bearing: the legs on the ground after the impact.
            bore: the legs on the ground before it.
        """
        programme, scale, label = self.programme, self.scale, f"touchdown into {self.names[i]}"
        landing = [leg for leg in bearing if leg not in bore]
        if not landing:
            programme.require(f"motion in {self.names[i]}", v - before.v, 0.0, 0.0, scale=self.unit / scale.time)
            return
        unit, speed = 10.0 * scale.force * scale.time, scale.speed
        least, most = [-HITS, -HITS, 1e-3], [HITS, HITS, 2.0 * HITS]
        impulses = {
            leg: programme.variable(impulse_name(self.names[i], leg), [0.0, 0.0, 1.0], least, most, unit=unit)
            for leg in bearing
        }
        missed = self.mechanics.struck(before.q, v - before.v, impulses)
        programme.require(label, missed, 0.0, 0.0, scale=10.0 * self.force * scale.time)
        after = self.mechanics.moving(before.q, v)
        for leg in bearing:
            programme.require(label, after[leg][1], 0.0, 0.0, scale=speed)
            self.cone(f"friction at {label}", impulses[leg], unit)
        for leg in landing:
            position, velocity, _ = before.toes[leg]
            programme.require(label, position[2], 0.0, 0.0, scale=scale.length)
            programme.require(f"approach at {label}", velocity[2], -np.inf, -FALLS * speed, scale=speed)

    # the whole

    def close(self) -> None:
        """Requires that the last state is the first one, moved on, turned or mirrored; sets speed and objective."""
        programme, request, scale, result = self.programme, self.request, self.scale, self.result
        first, last, mirrored = result.phases[0][0], result.phases[-1][-1], request.footfalls.mirrored
        period, half_turn = sum(result.durations), 0.5 * request.turn
        advance = request.speed * period * float(np.sinc(half_turn / math.pi))
        q = self.image(first.q)
        q[X], q[Y], q[YAW] = advance * math.cos(half_turn), q[Y] + advance * math.sin(half_turn), q[YAW] + request.turn
        programme.require("origin", first.q[X], 0.0, 0.0, scale=scale.length)
        if not mirrored:  # a mirrored stride is in the middle, and heads along its path, as it is
            programme.require("origin", first.q[Y], 0.0, 0.0, scale=scale.length)
            phases = zip(result.durations, result.phases, strict=True)
            turned = sum(quadrature(time, [node.q[YAW] for node in nodes]) for time, nodes in phases)
            programme.require("heading", turned - half_turn * period, 0.0, 0.0, scale=scale.time)
        programme.require("closing", last.q - q, 0.0, 0.0, scale=self.unit)
        images = {opposite(leg) if mirrored else leg: leg for leg in self.limbs}
        bearing = tuple(leg for leg in self.limbs if images[leg] in request.footfalls.phases[0])
        bore = request.footfalls.phases[-1]
        for leg in bore:
            if leg not in bearing:
                self.lifts(f"{leg} lifts off as the stride ends", self.limbs[leg], last, first.toes[images[leg]])
        self.strike(0, last, self.turned(self.image(first.v)), bearing, bore)
        whole = (2.0 if mirrored else 1.0) * period
        programme.require("duration of the stride", whole, 0.0, request.longest_stride, scale=scale.time)
        torques = zip(result.durations, result.torques, strict=True)
        effort = sum(quadrature(time, [casadi().dot(u, u) for u in each]) for time, each in torques)
        unit = scale.torque**2 * scale.time / scale.length
        programme.objective = OF_EFFORT * effort / (request.speed * period * unit)

    def image(self, vector: Any) -> Any:
        """Returns a vector of the first node as it is where the stride closes: mirrored if the gait is mirrored."""
        if not self.request.footfalls.mirrored:
            return +vector
        seen = casadi().SX(vector)
        for i, (of, sign) in enumerate(zip(self.mirror.of, self.mirror.signs, strict=True)):
            seen[of] = sign * vector[i]
        return seen

    def turned(self, v: Any) -> Any:
        """Returns a velocity turned by the turn of a stride."""
        cosine, sine, seen = math.cos(self.request.turn), math.sin(self.request.turn), +v
        seen[X], seen[Y] = cosine * v[X] - sine * v[Y], sine * v[X] + cosine * v[Y]
        return seen
