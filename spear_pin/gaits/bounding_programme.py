"""The bounding gait as a nonlinear programme: motion, contact, impact, law and periodicity at the nodes."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import SimpleNamespace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.bounding_law import LEGS, BoundingLaw, Leg, Phase, phases_of, support
from spear_pin.gaits.bounding_nodes import KNEE_REST, Node, Room
from spear_pin.gaits.collocation import Guess, Programme, Solution, casadi, hermite_simpson
from spear_pin.gaits.objectives import at_most, ceiling, limit, objective
from spear_pin.gaits.request import (
    FLEXED,
    LONGEST_PHASE,
    LONGEST_STRIDE,
    SHORTEST_FLIGHT,
    STEEPEST,
    Request,
)
from spear_pin.gaits.virtual_constraints import Evolution, accelerations, jet, resume, value
from spear_pin.hybrid.fields import with_fields
from spear_pin.model.planar import Planar
from spear_pin.model.robot import Robot
from spear_pin.model.scale import Scale, scale_of
from spear_pin.model.spring import PAIR_STIFFNESS

CONE = 0.98  # share of the requested friction; the collocation's error may use the rest
STIFFEST = 2000.0  # N·m/rad: limit of free springs, also the law's, of a pair of Q-SPEAR's legs
END = {True: 0.98, False: 1.02}  # s at the end of a stance, before the polynomial ends, and of a flight
ANGLES, FLEXIONS = (-STEEPEST, STEEPEST), (-0.2, FLEXED)  # rad: of Bézier coefficients of leg angles and knees


@dataclass
class Transcription:
    """The nonlinear programme for a request, with a method that reads its solution."""

    request: Request
    scale: Scale
    programme: Programme
    law: dict[str, Any]
    stiffness: Any
    nodes: dict[str, list[Node]] = field(default_factory=dict)
    durations: dict[str, Any] = field(default_factory=dict)

    def read(self, solution: Solution) -> tuple[BoundingLaw, tuple[Array, Array], float]:
        """Returns the law, the section state and the springs' stiffness at a solution."""
        values = {name: _read(self.programme, entry, solution) for name, entry in self.law.items()}
        first = next(iter(self.nodes.values()))[0]
        q, v = (self.programme.read(part, solution) for part in (first.q, first.v))
        stiffness = float(self.programme.read(self.stiffness, solution)[0])
        request = self.request
        law = BoundingLaw(
            **values,
            knee_rest=request.knee_rest,
            lift_off=request.lift_off,
            epsilon=BoundingLaw.epsilon * self.scale.time,
            nominal=(*q[1:].tolist(), *v.tolist()),
        )
        return law, (q, v), stiffness


def _read(programme: Programme, entry: Any, solution: Solution) -> Any:
    if isinstance(entry, tuple):
        return tuple(_read(programme, item, solution) for item in entry)
    return float(programme.read(entry, solution)[0])


def transcribe(
    robot: Robot, request: Request, intervals: int, *, seed: int = 0, start: Guess | None = None
) -> Transcription:
    """Builds the nonlinear programme for a request.

    Args:
        robot: Q-SPEAR in the sagittal plane, or another quadruped as `spear_pin.sagittal` cuts it.
        request: the request for the gait.
        intervals: number of intervals of each phase.
        seed: seed of the perturbation of the initial guess.
        start: values to start from, by name.

    Raises:
        BadValue: the robot is not such a quadruped, or the request is outside the range of the search.
    """
    request.check(scale_of(robot))
    writer = _Writer(robot, request, Programme(start), np.random.default_rng(seed))
    travelled = 0.0
    for phase in phases_of(robot):
        travelled += writer.add_phase(phase, intervals, travelled)
    for before, phase in pairwise(phases_of(robot)):
        writer.join(before, phase)
    writer.close()
    return writer.result


class _Writer:
    """Writer of the programme; holds what its parts share while they are written."""

    def __init__(self, robot: Robot, request: Request, programme: Programme, rng: np.random.Generator) -> None:
        self.request, self.programme, self.rng = request, programme, rng
        planar, self.room = Planar(robot), Room(robot, request)
        self.scale, self.units, self.legs = self.room.scale, self.room.units, self.room.legs
        self.weight, self.dynamics = robot.weight, _dynamics(planar)
        self.law = _law(programme, request, self.scale)
        # what `support` reads of a law
        self.p: Any = SimpleNamespace(virtual_stiffness=self.law["virtual_stiffness"], knee_rest=request.knee_rest)
        self.stiffness: Any = request.stiffness
        if request.stiffness is None:
            unit = self.scale.torque
            self.stiffness = programme.variable("stiffness", PAIR_STIFFNESS, 0.0, STIFFEST, 100.0, unit=unit)
        self.top = ceiling(programme, request, self.scale)
        self.result = Transcription(request, self.scale, programme, self.law, self.stiffness)

    def add_phase(self, phase: Phase, intervals: int, travelled: float) -> float:
        """Adds one phase by itself; returns how far its guess travels."""
        programme, request, bearing = self.programme, self.request, phase.bearing
        label, stance, time = _words(phase), bearing is not None, self.scale.time
        guess, shortest = (0.1 * time, request.minimum_stance) if stance else (0.06 * time, SHORTEST_FLIGHT * time)
        around = guess * (1.0 + 0.2 * self.rng.uniform(-1, 1))
        duration = programme.variable(f"{label} lasts", around, shortest, LONGEST_PHASE * time)
        nodes = []
        for i in range(2 * intervals + 1):
            s = i / (2 * intervals)
            posture = self.room.posture(phase.name, travelled + request.speed * guess * s, s)
            nodes.append(self.room.node(programme, phase.name, s, posture, self.rng))
        self.result.nodes[phase.name], self.result.durations[phase.name] = nodes, duration
        ca, measured = casadi(), phase.outputs.phase
        span = (value(measured, nodes[-1].q, ca) - value(measured, nodes[0].q, ca)) / END[stance]
        self.law[f"{phase.name}_span"] = span
        begun = resume(phase.outputs, _shapes(programme, self.law, phase), nodes[0].q, nodes[0].v, span, ca)
        for i, node in enumerate(nodes):
            last = i == 2 * intervals
            _follow(programme, label, phase, replace(begun, past=0.0 if stance or not last else 1.0), node, self.scale)
            if bearing is None:
                self.fly(label, node, 0 < i and not last)
            else:
                self.stand(label, phase, bearing, node, 0 < i and not last, last)
            limit(programme, request, self.scale, node.u, node.v, self.top)
            self.keep(node)
        if bearing is not None:
            programme.require(f"sweep of the leg in {label}", span, -1.5, -0.05)
        for part, slope, unit in (("q", "v", self.units.q), ("v", "a", self.units.v)):
            x, f = ([getattr(node, name) for node in nodes] for name in (part, slope))
            hermite_simpson(programme, f"motion in {label}", duration, x, f, unit)
        return request.speed * guess

    def keep(self, node: Node) -> None:
        """Requires torques within the limits of the robot's file."""
        coordinates = self.room.robot.coordinates
        for joint, torque, most in zip(
            coordinates[3:], casadi().vertsplit(node.u), self.room.joints("effort")[3:], strict=True
        ):
            if np.isfinite(most):
                at_most(self.programme, f"torque of the {joint}", torque, float(most), self.scale)

    def fly(self, label: str, node: Node, inside: bool) -> None:
        """Requires motion in the air, with the toes above the ground."""
        terms = self.dynamics(node.q, node.v)
        applied = casadi().vertcat(casadi().SX.zeros(3), node.u)
        for leg in self.legs if self.request.rest is not None else ():
            applied[leg.knee] += self.spring(leg, node.q)
        motion = terms["D"] @ node.a + terms["h"] + self.friction(node.v) - applied
        self.programme.require(f"motion in {label}", motion, 0.0, 0.0, scale=50.0, unit=self.units.force)
        length = self.scale.length
        for leg in self.legs if inside else ():
            self.programme.require(f"toes in the air in {label}", terms[leg.toe][0][1], 0.0, scale=0.1, unit=length)

    def stand(self, label: str, phase: Phase, leg: Leg, node: Node, inside: bool, last: bool) -> None:
        """Requires motion with one toe at rest, its force within the cone, and the other leg clear of the ground."""
        ca, programme, request, scale = casadi(), self.programme, self.request, self.scale
        held = {f"{leg.name}_{part}_torque": self.law[f"{leg.name}_{part}_torque"] for part in ("hip", "knee")}
        elastic = self.spring(leg, node.q)
        dyn = SimpleNamespace(spring_torque=lambda joint: elastic)
        given = support(leg, node.q, held, self.p, dyn)
        swing = zip(phase.outputs.motors, ca.vertsplit(node.u), strict=True)
        node.u = ca.vertcat(*[torque for _, torque in sorted([*given, *swing], key=lambda pair: pair[0])])
        applied = ca.vertcat(ca.SX.zeros(3), node.u)
        applied[leg.knee] += elastic
        (other,) = phase.legs
        if request.rest is not None:
            applied[other.knee] += self.spring(other, node.q)
        terms = self.dynamics(node.q, node.v)
        _, J, dJv = terms[leg.toe]
        motion = terms["D"] @ node.a + terms["h"] + self.friction(node.v) - applied - J.T @ node.F
        programme.require(f"motion in {label}", motion, 0.0, 0.0, scale=50.0, unit=self.units.force)
        programme.require(
            f"motion in {label}", J @ node.a + dJv, 0.0, 0.0, scale=10.0, unit=scale.length / scale.time**2
        )
        if last and request.lift_off == "force":
            programme.require(f"no force at lift-off from {label}", node.F, 0.0, 0.0, scale=50.0, unit=scale.force)
        else:
            self.cone(f"friction in {label}", node.F, 100.0 * scale.force, "N")
            least = 0.0 if request.lift_off == "force" else request.minimum_force
            programme.require(f"normal force in {label}", node.F[1], least, scale=100.0 * scale.force, wish="N")
        if inside:
            programme.require(f"knee flexed in {label}", leg.side * node.q[leg.knee], request.knee_rest)
        if last and request.lift_off == "knee":
            programme.require(
                f"knee at lift-off from {label}", leg.side * node.q[leg.knee], request.knee_rest, request.knee_rest
            )
        (other,) = phase.legs
        programme.require(
            f"clearance in {label}", terms[other.toe][0][1], request.clearance, scale=0.1 * scale.length, wish="m"
        )
        rate = jet(phase.outputs.phase, node.q, node.v, ca).rate
        programme.require(f"sweep of the leg in {label}", rate, -30.0, -0.3, unit=1.0 / scale.time)

    def friction(self, v: Any) -> Any:
        """Returns viscous friction of the joints."""
        return casadi().DM(self.room.robot.model.damping) * v

    def spring(self, leg: Leg, q: Any) -> Any:
        """Returns the torque of the physical spring, smooth about its rest angle where the knee may pass that."""
        if self.request.rest is not None:
            fixed = with_fields(self.request.spring(0.0), {"stiffness": self.stiffness})
            return leg.side * fixed.torque(leg.side * q[leg.knee] - self.request.rest)
        deflection, preload = leg.side * q[leg.knee] - self.law["knee_touchdown"], self.request.preload
        if self.request.lift_off == "force" or self.request.knee_touchdown != self.request.knee_rest:
            distance = (deflection * deflection + 1e-6) ** 0.5
            preload, deflection = 0.5 * preload * (1.0 + deflection / distance), 0.5 * (deflection + distance)
        spring = with_fields(self.request.spring(0.0), {"stiffness": self.stiffness, "preload": preload})
        return leg.side * spring.torque(deflection, SimpleNamespace(maximum=casadi().fmax))

    def cone(self, label: str, F: Any, scale: float, unit: str) -> None:
        """Requires that a force or impulse lies inside the friction cone."""
        for side in (1.0, -1.0):
            inside = CONE * self.request.friction * F[1] + side * F[0]
            self.programme.require(label, inside, 0.0, scale=scale, wish=unit)

    def join(self, before: Phase, after: Phase) -> None:
        """Requires that one phase follows another: by an impact, or by a toe that leaves the ground."""
        label, programme = f"motion in {_words(after)}", self.programme
        last, first = self.result.nodes[before.name][-1], self.result.nodes[after.name][0]
        programme.require(label, first.q - last.q, 0.0, 0.0, unit=self.units.q)
        if after.bearing is not None:
            self.strike(after.bearing, last, first.v)
            return
        assert after.lifted is not None
        programme.require(label, first.v - last.v, 0.0, 0.0, unit=self.units.v)
        _, J, dJv = self.dynamics(first.q, first.v)[after.lifted.toe]
        unit = self.scale.length / self.scale.time**2
        rises = (J @ first.a + dJv)[1]
        programme.require(f"toe leaves the ground into {_words(after)}", rises, 5.0, scale=10.0, unit=unit)

    def strike(self, leg: Leg, before: Node, v: Any) -> None:
        """Requires a touchdown: the toe falls onto the ground and stops, by an impulse within the cone."""
        label, programme, scale, push = (
            f"{leg.name} touchdown",
            self.programme,
            self.scale,
            self.units.force * self.scale.time,
        )
        terms = self.dynamics(before.q, before.v)
        position, J, _ = terms[leg.toe]
        lower, upper = [-300.0, 0.01], [300.0, 600.0]
        impulse = programme.variable(
            f"{leg.name} impulse", [0.0, 30.0], lower, upper, 10.0, unit=scale.force * scale.time
        )
        programme.require(label, position[1], 0.0, 0.0, unit=scale.length)
        programme.require(f"approach at {label}", (J @ before.v)[1], -np.inf, -0.2, unit=scale.speed)
        programme.require(label, terms["D"] @ (v - before.v) - J.T @ impulse, 0.0, 0.0, unit=push)
        programme.require(label, J @ v, 0.0, 0.0, unit=scale.speed)
        self.cone(f"friction at {label}", impulse, 10.0 * scale.force * scale.time, "N·s")

    def close(self) -> None:
        """Requires periodicity, speed and duration, and sets the objective."""
        programme, request, result, scale = self.programme, self.request, self.result, self.scale
        everything = list(result.nodes.values())
        first, last = everything[0][0], everything[-1][-1]
        period = sum(result.durations.values())
        programme.require("origin", first.q[0], 0.0, 0.0, unit=scale.length)
        programme.require("periodicity", last.q[1:] - first.q[1:], 0.0, 0.0, unit=self.units.q[1:])
        self.strike(self.legs[0], last, first.v)
        programme.require("mean speed", last.q[0] / period, request.speed, request.speed, scale=scale.speed, wish="m/s")
        programme.require(
            "duration of the stride",
            period,
            request.minimum_stride,
            LONGEST_STRIDE * scale.time,
            scale=scale.time,
            wish="s",
        )
        phases = list(zip(result.durations.values(), everything, strict=True))
        programme.objective = objective(request, scale, self.weight, phases, last.q[0], self.top)


def _words(phase: Phase) -> str:
    return phase.name.replace("_", " ")


def _law(programme: Programme, request: Request, scale: Scale) -> dict[str, Any]:
    """Adds the unknowns among the law's parameters that belong to no phase."""
    knee, bounds, least, unit = request.knee_touchdown, request.leg_touchdown, request.minimum_knee_torque, scale.torque
    if knee is None:
        freely = math.radians(20.0), math.radians(70.0) + request.knee_rest - KNEE_REST
        knee = programme.variable("knee touchdown", request.knee_rest, *freely)
    law: dict[str, Any] = {"knee_touchdown": knee, "virtual_stiffness": request.virtual_stiffness}
    if request.virtual_stiffness is None:
        usual = BoundingLaw.virtual_stiffness
        law["virtual_stiffness"] = programme.variable("virtual stiffness", usual, 0.0, STIFFEST, 100.0, unit=unit)
    for name in LEGS:
        law[f"{name}_hip_torque"] = programme.variable(f"{name} hip", 0.0, -400.0, 400.0, 100.0, unit=unit)
        law[f"{name}_knee_torque"] = programme.variable(
            f"{name} knee", max(20.0 * unit, least), least, least + 400.0 * unit, 100.0 * unit
        )
        law[f"{name}_leg_touchdown"] = programme.variable(f"{name} leg", np.clip(0.22, *bounds), *bounds)
    return law


def _dynamics(planar: Planar) -> Callable[[Any, Any], dict[str, Any]]:
    """Returns D, h and (position, J, drift) of each toe as functions of symbols."""
    ca = casadi()
    q, v = ca.SX.sym("q", planar.nv), ca.SX.sym("v", planar.nv)
    terms = planar.terms(ca.vertsplit(q), ca.vertsplit(v), ca)
    rows = [ca.vertcat(*[ca.horzcat(*row) for row in terms.mass_matrix]), ca.vertcat(*terms.bias)]
    for toe in planar.toes:
        jacobian = ca.vertcat(*[ca.horzcat(*row) for row in terms.jacobians[toe]])
        rows += [ca.vertcat(*terms.positions[toe]), jacobian, ca.vertcat(*terms.drifts[toe])]
    function = ca.Function("dynamics", [q, v], rows, {"cse": True})

    def evaluate(at: Any, rate: Any) -> dict[str, Any]:
        values = function(at, rate)
        toes = {toe: tuple(values[2 + 3 * i : 5 + 3 * i]) for i, toe in enumerate(planar.toes)}
        return {"D": values[0], "h": values[1], **toes}

    return evaluate


def _shapes(programme: Programme, law: dict[str, Any], phase: Phase) -> Any:
    """Returns Bézier coefficients from the third on, as the law holds them; some are new unknowns."""
    shapes: list[tuple[Any, ...]] = []
    for leg in phase.legs:
        if leg == phase.landing:
            ends = law[f"{leg.name}_leg_touchdown"], leg.side * law["knee_touchdown"]
            third = f"{phase.name} {leg.name} third"
            thirds = programme.variable(f"{third} angle", 0.2, *ANGLES), _knee(programme, f"{third} knee", leg)
            law[f"{phase.name}_landing"] = thirds
            shapes += [(third, end, end, end) for third, end in zip(thirds, ends, strict=True)]
        else:
            name = f"{phase.name} {leg.name}"
            free = (
                tuple(programme.variable(f"{name} angle {i}", 0.0, *ANGLES) for i in range(4)),
                tuple(_knee(programme, f"{name} knee {i}", leg) for i in range(4)),
            )
            law[f"{phase.name}_{'trailing' if leg == phase.lifted else 'swing'}"] = free
            shapes += free
    return shapes


def _knee(programme: Programme, name: str, leg: Leg) -> Any:
    return leg.side * programme.variable(name, 1.0, *FLEXIONS)


def _follow(programme: Programme, label: str, phase: Phase, begun: Evolution, node: Node, scale: Scale) -> None:
    """Requires ÿ = 0."""
    unit = 1.0 / scale.time**2
    for missed in accelerations(phase.outputs, begun, node.q, node.v, node.a, casadi()):
        programme.require(f"motion in {label}", missed, 0.0, 0.0, scale=50.0, unit=unit)
