"""A gait with given footfalls as a nonlinear programme: motion, contact, impacts, law and closing at the nodes.

It is the same in the plane and in space; `Room` says what a robot and a request allow there.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.collocation import Guess, Programme, Solution, casadi, hermite_simpson, node_name, quadrature
from spear_pin.gaits.footfalls.nodes import Free, Mechanics, Node, Room, Support
from spear_pin.gaits.footfalls.sequence import Bearing, opposite
from spear_pin.gaits.footfalls.swing import Air, Swings
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.objectives import Costs, at_most
from spear_pin.gaits.virtual_constraints import Evolution
from spear_pin.hybrid.fields import with_fields
from spear_pin.hybrid.symmetry import YAW, X, Y, mirror_of

CONE = 0.98  # share of the requested friction; the collocation's error may use the rest
HITS = 30.0  # of 10 N·s of Q-SPEAR: at most
ROUND = 1e-6  # rad²: smoothing of a spring that only pulls


@dataclass
class Transcription:
    """The nonlinear programme for a request, and its parts.

    Attributes:
        room: the robot, the request, and what they allow.
        programme: the programme to be solved.
        costs: the objective.
        support: the law for legs on the ground.
        spring: the spring of a knee.
        phases: the nodes of each phase.
        torques: motor torques at each node of each phase, nv - 6 or nv - 3.
        durations: durations of the phases.
        constants: constants of the stance law for each leg: hip, knee and in space adduction.
        evolutions: swing law in each phase for each leg in the air.
        aims: angle at which the adduction of each leg lands.
    """

    room: Room
    programme: Programme
    costs: Costs
    support: Support | None
    spring: Any
    phases: list[list[Node]] = field(default_factory=list)
    torques: list[list[Any]] = field(default_factory=list)
    durations: list[Any] = field(default_factory=list)
    constants: dict[str, tuple[Any, ...]] = field(default_factory=dict)
    evolutions: list[dict[str, Evolution]] = field(default_factory=list)
    aims: dict[str, Any] = field(default_factory=dict)

    def number(self, expression: Any, solution: Solution) -> float:
        """Returns the value of a scalar at a solution."""
        return float(self.programme.read(expression, solution)[0])

    def evolutions_at(self, solution: Solution) -> list[dict[str, Evolution]]:
        """Returns the numbers of the swing law at a solution, in each phase for each leg in the air."""

        def solved(each: Evolution) -> Evolution:
            found = [self.programme.read(casadi().vertcat(*row), solution) for row in each.alpha]
            alpha = tuple(tuple(row.tolist()) for row in found)
            return Evolution(alpha, self.number(each.origin, solution), self.number(each.span, solution))

        return [{leg: solved(each) for leg, each in swings.items()} for swings in self.evolutions]


def transcribe(room: Room, start: Guess | None = None) -> Transcription:
    """Builds the nonlinear programme for a request.

    Args:
        room: the robot, the request, and what they allow.
        start: values to start from, by name.

    Raises:
        MissingExtra: CasADi is not installed.
    """
    writer = _Writer(room, start)
    for i in range(len(room.footfalls.phases)):
        writer.add_phase(i)
        if i:
            writer.join(i)
    writer.close()
    return writer.result


def impulse_name(phase: str, leg: str) -> str:
    """Returns the name of the impulse on a leg's foot as a phase begins."""
    return f"impulse of {leg} into {phase}"


class _Writer:
    """Writer of the programme; holds what its parts share while they are written."""

    def __init__(self, room: Room, start: Guess | None) -> None:
        self.room, self.request, self.scale, self.limbs, self.start = room, room.request, room.scale, room.limbs, start
        self.programme = programme = Programme(start)
        self.mechanics = Mechanics(room.mechanism, room.limbs)
        self.footfalls, self.labels = room.footfalls, [name.replace("_", " ") for name in room.names]
        self.unit, self.force = room.units
        self.landed: dict[str, Node] = {}
        self.support = support = room.support
        if support is not None:
            knee, stiffness = (self.chosen(number) for number in (support.knee_touchdown, support.stiffness))
            self.support = support = support._replace(knee_touchdown=knee, stiffness=stiffness)
        spring = room.spring and with_fields(room.spring, {"stiffness": self.chosen(room.spring.stiffness)})
        self.swings = Swings(programme, room, support) if support is not None and room.swings else None
        costs = Costs(programme, room.request, room.scale, room.motors)
        self.result = Transcription(room, programme, costs, support, spring)

    def chosen(self, number: Any) -> Any:
        """Returns a number, as an unknown if it is free."""
        return self.programme.variable(*number) if isinstance(number, Free) else number

    # phases

    def add_phase(self, i: int) -> None:
        """Adds one phase by itself."""
        programme, label, result, room = self.programme, self.labels[i], self.result, self.room
        bearing, count = self.footfalls.phases[i], 2 * self.footfalls.intervals[i]
        duration = programme.variable(f"{label} lasts", *room.durations[i])
        nodes = [self.mechanics.node(*room.add(programme, i, k / count)) for k in range(count + 1)]
        for leg in bearing:
            if i == 0 or leg not in self.footfalls.phases[i - 1]:
                self.lands(leg, nodes[0])
        result.phases.append(nodes)
        result.durations.append(duration)
        result.torques.append([self.torques(label, node, bearing) for node in nodes])
        after = self.footfalls.whole[(i + 1) % len(self.footfalls.whole)]
        for k, node in enumerate(nodes):
            for leg in bearing:
                self.keep(label, leg, node, inside=0 < k < count, lifts=k == count and leg not in after)
            for leg in self.limbs:
                least = None if leg in bearing else room.height(i, leg, k / count)
                if least is not None:
                    over, size = node.toes[leg][0][-1], 0.1 * self.scale.length
                    programme.require(f"clearance in {label}", over, least, scale=size, wish="m" if least else "")
        if self.swings is not None:
            self.swing(i, self.swings)
        for part, slope, unit in (("q", "v", self.unit), ("v", "a", self.unit / self.scale.time)):
            x, f = ([getattr(node, name) for node in nodes] for name in (part, slope))
            hermite_simpson(programme, f"motion in {label}", duration, x, f, unit)

    def swing(self, i: int, swings: Swings) -> None:
        """Makes legs in the air follow the law."""
        phases = self.footfalls.whole
        landing = tuple(leg for leg in phases[(i + 1) % len(phases)] if leg not in phases[i])

        def guess(s: float) -> Array:
            given = None if self.start is None else self.start(node_name(self.room.names[i], s, "q"))
            return self.room.posture(i, s) if given is None else given

        air = Air(self.labels[i], phases[i], landing, self.result.phases[i], guess)
        aims = {name: self.aim(name, limb) for name, limb in self.limbs.items() if name not in phases[i]}
        self.result.evolutions.append(swings.follow(air, aims))

    def aim(self, leg: str, limb: Leg) -> Any:
        """Returns the angle at which a leg's adduction lands; with mirrored footfalls a right leg's is the left's."""
        if limb.adduction is None:
            return 0.0
        own, aims = opposite(leg) if self.footfalls.mirrored and leg.endswith("right") else leg, self.result.aims
        if own not in aims:
            least, most = (bound[self.limbs[own].rows[0]] for bound in self.room.configurations)
            aims[own] = self.programme.variable(f"{own} adduction lands at", 0.0, least, most)
        if leg not in aims:
            aims[leg] = -aims[own]
        return aims[leg]

    def lands(self, leg: str, node: Node) -> None:
        """Lets a leg land: its spring is latched, and its law's constants hold from here on."""
        self.landed[leg] = node
        if (support := self.support) is None:
            return
        self.result.constants[leg] = tuple(
            self.programme.variable(f"{leg} {part}", guess, least, most, 0.25 * most)
            for part, (guess, least, most) in support.constants.items()
        )
        if self.swings is None or self.room.coarse:
            flexion = self.limbs[leg].flexion(node.q)
            self.programme.require(f"knee of {leg} at touchdown", flexion - support.knee_touchdown, 0.0, 0.0)

    def torques(self, label: str, node: Node, bearing: Bearing) -> Any:
        """Returns the motor torques within the joints' limits; no force acts on the torso itself."""
        ca, programme, room = casadi(), self.programme, self.room
        base, needed = room.base, node.needed + ca.DM(room.robot.model.damping) * node.v
        programme.require(f"motion in {label}", needed[:base], 0.0, 0.0, scale=50.0 * self.force[:base])
        u = needed[base:]
        for leg, limb in self.limbs.items():
            u[limb.knee - base] -= self.elastic(limb, node, leg in bearing)
            if leg in bearing and self.support is not None:
                self.follow(label, self.support, limb, node, u)
        for joint, torque, most in zip(room.robot.coordinates[base:], ca.vertsplit(u), room.effort, strict=True):
            if np.isfinite(most):
                at_most(programme, f"torque of the {joint}", torque, float(most), self.scale)
        self.result.costs.limit(u, node.v[base:])
        return u

    def elastic(self, limb: Leg, node: Node, bears: bool) -> Any:
        """Returns the torque of a knee's spring: a switched one pulls only beyond the angle at touchdown."""
        spring, side = self.result.spring, limb.side
        if spring is None or not bears and spring.rest is None:
            return 0.0
        flexion, rate = limb.flexion(node.q), side * node.v[limb.knee]
        if spring.rest is not None:
            return side * (spring.torque(flexion - spring.rest) + spring.drag(rate))
        law = self.support
        deflection = flexion - (limb.flexion(self.landed[limb.name].q) if law is None else law.knee_touchdown)
        if self.room.passes:
            distance = (deflection * deflection + ROUND) ** 0.5
            preload = 0.5 * spring.preload * (1.0 + deflection / distance)
            spring, deflection = with_fields(spring, {"preload": preload}), 0.5 * (deflection + distance)
        return side * (spring.torque(deflection, SimpleNamespace(maximum=casadi().fmax)) + spring.drag(rate))

    def follow(self, label: str, law: Support, limb: Leg, node: Node, u: Any) -> None:
        """Requires that torques of a leg on the ground have the form of the law."""
        base, (hip, knee, *upright) = self.room.base, self.result.constants[limb.name]
        total = u[limb.knee - base] + self.elastic(limb, node, True)
        missed = [
            u[limb.hip - base] - hip,
            total + limb.side * (knee + law.stiffness * (limb.flexion(node.q) - law.knee_rest)),
        ]
        if (i := limb.adduction) is not None:
            stiffness, damping, _ = law.upright
            held = stiffness * (node.q[i] - self.landed[limb.name].q[i]) + damping * node.v[i]
            missed.append(u[i - base] - upright[0] + held)
        self.programme.require(f"law in {label}", casadi().vertcat(*missed), 0.0, 0.0, scale=50.0 * self.scale.torque)

    def keep(self, label: str, leg: str, node: Node, *, inside: bool, lifts: bool) -> None:
        """Requires that a foot on the ground rests, pressed into it within the friction cone.

        Args:
            label: label of the phase.
            leg: the leg.
            node: the node.
            inside: whether the node is inside the phase, where the law wants the knee flexed beyond its rest angle.
            lifts: whether the leg lifts off at this node.
        """
        programme, scale, law, F = self.programme, self.scale, self.support, node.F[leg]
        programme.require(f"motion in {label}", node.toes[leg][2], 0.0, 0.0, scale=10.0 * scale.length / scale.time**2)
        if law is not None and inside:
            programme.require(f"knee flexed in {label}", self.limbs[leg].flexion(node.q), law.knee_rest)
        if law is not None and law.by_force and lifts:
            programme.require(f"no force at lift-off from {label}", F, 0.0, 0.0, scale=50.0 * scale.force)
            return
        self.cone(f"friction in {label}", F, 100.0 * scale.force, "N")
        least = 0.0 if law is not None and law.by_force else self.request.minimum_force
        programme.require(f"normal force in {label}", F[-1], least, scale=100.0 * scale.force, wish="N")

    def cone(self, label: str, F: Any, scale: float, unit: str) -> None:
        """Requires that a force or impulse lies inside the friction cone: a square law for a round one."""
        most, aside = CONE * self.request.friction * F[-1], casadi().vertsplit(F[:-1])
        if len(aside) == 1:
            for side in (1.0, -1.0):
                self.programme.require(label, most + side * aside[0], 0.0, scale=scale, wish=unit)
            return
        left = most * most - sum(part * part for part in aside)
        self.programme.require(label, left, 0.0, scale=scale**2, wish=f"({unit})²")

    # between phases

    def join(self, i: int) -> None:
        """Requires that a phase follows another."""
        last, first, label = self.result.phases[i - 1][-1], self.result.phases[i][0], self.labels[i]
        before, after = (self.footfalls.phases[j] for j in (i - 1, i))
        self.programme.require(f"motion in {label}", first.q - last.q, 0.0, 0.0, scale=self.unit)
        for leg in before:
            if leg not in after:
                self.lifts(f"{leg} lifts off into {label}", self.limbs[leg], last, first.toes[leg])
        self.strike(i, last, first.v, after, before)

    def lifts(self, label: str, limb: Leg, last: Node, toe: tuple[Any, Any, Any]) -> None:
        """Requires that a foot leaves the ground rising, and by the law with its knee back at its rest angle."""
        unit = self.scale.length / self.scale.time**2
        self.programme.require(label, toe[2][-1], self.room.rises, scale=10.0 * unit)
        if (law := self.support) is not None and not law.by_force:
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
        programme, scale, label = self.programme, self.scale, f"touchdown into {self.labels[i]}"
        landing = [leg for leg in bearing if leg not in bore]
        if not landing:
            programme.require(f"motion in {self.labels[i]}", v - before.v, 0.0, 0.0, scale=self.unit / scale.time)
            return
        unit, speed, aside = 10.0 * scale.force * scale.time, scale.speed, len(self.room.mechanism.lift) - 1
        sizes = [0.0, -HITS, HITS], [1.0, 1e-3, 2.0 * HITS]  # guess and bounds, along the ground and across
        first, least, most = ([along] * aside + [across] for along, across in zip(*sizes, strict=True))
        impulses = {
            leg: programme.variable(impulse_name(self.room.names[i], leg), first, least, most, unit=unit)
            for leg in bearing
        }
        missed = self.mechanics.struck(before.q, v - before.v, impulses)
        programme.require(label, missed, 0.0, 0.0, scale=10.0 * self.force * scale.time)
        after = self.mechanics.moving(before.q, v)
        for leg in bearing:
            programme.require(label, after[leg][1], 0.0, 0.0, scale=speed)
            self.cone(f"friction at {label}", impulses[leg], unit, "N·s")
        for leg in landing:
            position, velocity, _ = before.toes[leg]
            programme.require(label, position[-1], 0.0, 0.0, scale=scale.length)
            programme.require(f"approach at {label}", velocity[-1], -np.inf, -self.room.falls, scale=speed)

    # the whole

    def close(self) -> None:
        """Requires that the last state is the first one, moved on, turned or mirrored; sets speed and objective."""
        programme, scale, result, room = self.programme, self.scale, self.result, self.room
        first, last, mirrored, turn = result.phases[0][0], result.phases[-1][-1], self.footfalls.mirrored, room.turn
        period, half_turn = sum(result.durations), 0.5 * (turn or 0.0)
        speed, q = self.request.speed * float(np.sinc(half_turn / math.pi)), self.image(first.q)
        programme.require("origin", first.q[X], 0.0, 0.0, scale=scale.length)
        if turn is not None:
            q[Y], q[YAW] = q[Y] + speed * period * math.sin(half_turn), q[YAW] + turn
            if not mirrored:  # a mirrored stride is in the middle, and heads along its path, as it is
                programme.require("origin", first.q[Y], 0.0, 0.0, scale=scale.length)
                phases = zip(result.durations, result.phases, strict=True)
                turned = sum(quadrature(time, [node.q[YAW] for node in nodes]) for time, nodes in phases)
                programme.require("heading", turned - half_turn * period, 0.0, 0.0, scale=scale.time)
        programme.require("closing", last.q[X + 1 :] - q[X + 1 :], 0.0, 0.0, scale=self.unit[X + 1 :])
        wanted = speed * math.cos(half_turn)
        programme.require("mean speed", last.q[X] / period, wanted, wanted, scale=scale.speed, wish="m/s")
        images = {opposite(leg) if mirrored else leg: leg for leg in self.limbs}
        bearing = tuple(leg for leg in self.limbs if images[leg] in self.footfalls.phases[0])
        bore = self.footfalls.phases[-1]
        for leg in bore:
            if leg not in bearing:
                self.lifts(f"{leg} lifts off as the stride ends", self.limbs[leg], last, first.toes[images[leg]])
        self.strike(0, last, self.turned(self.image(first.v)), bearing, bore)
        whole = (2.0 if mirrored else 1.0) * period
        programme.require("duration of the stride", whole, *room.stride, scale=scale.time, wish="s")
        torques = [
            (time, [(u, node.v[room.base :]) for u, node in zip(each, nodes, strict=True)])
            for time, each, nodes in zip(result.durations, result.torques, result.phases, strict=True)
        ]
        programme.objective = result.costs.of(torques, room.robot.weight, self.request.speed * period)

    def image(self, vector: Any) -> Any:
        """Returns a vector of the first node as it is where the stride closes: mirrored if the gait is mirrored."""
        if not self.footfalls.mirrored:
            return +vector
        seen, mirror = casadi().SX(vector), mirror_of(self.room.robot)
        for i, (of, sign) in enumerate(zip(mirror.of, mirror.signs, strict=True)):
            seen[of] = sign * vector[i]
        return seen

    def turned(self, v: Any) -> Any:
        """Returns a velocity turned by the turn of a stride."""
        if not self.room.turn:
            return v
        cosine, sine, seen = math.cos(self.room.turn), math.sin(self.room.turn), +v
        seen[X], seen[Y] = cosine * v[X] - sine * v[Y], sine * v[X] + cosine * v[Y]
        return seen
