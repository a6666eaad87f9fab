"""The bounding gait as a nonlinear programme: motion, contact, impact, law and periodicity at the nodes."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.bounding_law import BoundingLaw, Leg, Phase, legs_of, phases_of, support
from spear_pin.gaits.collocation import Guess, Programme, Solution, casadi, hermite_simpson, node_name
from spear_pin.gaits.objectives import GRAVITY, ceiling, limit, objective
from spear_pin.gaits.request import Request
from spear_pin.gaits.virtual_constraints import Evolution, desired, dot, resume
from spear_pin.model.planar import Planar
from spear_pin.model.robot import Robot

Array = NDArray[np.float64]
CONE = 0.98  # of the friction asked for: what the collocation's error may use up
END = {True: 0.98, False: 1.02}  # s at the end of a stance, where the polynomial is not to run out, and of a flight
ANGLES, FLEXIONS = (-1.2, 1.2), (-0.2, 2.4)  # rad: of Bézier coefficients of leg angles and knees


@dataclass
class _Node:
    """Unknowns at one node: q, v, v̇, all four motor torques, the ground force."""

    q: Any
    v: Any
    a: Any
    u: Any = None
    F: Any = None


@dataclass
class Transcription:
    """The nonlinear programme of a request, and how to read its solution."""

    request: Request
    programme: Programme
    law: dict[str, Any]
    start: tuple[Any, Any]
    stiffness: Any
    nodes: dict[str, list[_Node]] = field(default_factory=dict)
    durations: dict[str, Any] = field(default_factory=dict)

    def read(self, solution: Solution) -> tuple[BoundingLaw, tuple[Array, Array], float]:
        """The law, the section state and the springs' stiffness at a solution."""
        values = {name: _read(self.programme, entry, solution) for name, entry in self.law.items()}
        q, v = (self.programme.read(part, solution) for part in self.start)
        stiffness = float(self.programme.read(self.stiffness, solution)[0])
        request = self.request
        law = BoundingLaw(
            **values,
            virtual_stiffness=request.virtual_stiffness,
            lift_off=request.lift_off,
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
    """The nonlinear programme of a request.

    Args:
        robot: Q-SPEAR in the sagittal plane.
        request: what is asked.
        intervals: of each phase.
        seed: of the perturbation of the initial guess.
        start: values to start from, by name.
    """
    ca = casadi()
    rng = np.random.default_rng(seed)
    programme = Programme(start)
    planar = Planar(robot)
    dynamics = _dynamics(planar)
    p = SimpleNamespace(virtual_stiffness=request.virtual_stiffness, knee_rest=math.radians(40.0))
    bounds = request.leg_touchdown
    if request.knee_touchdown is None:
        touchdown = programme.variable("knee touchdown", p.knee_rest, math.radians(20.0), math.radians(70.0))
    else:
        touchdown = ca.SX(request.knee_touchdown)
    if request.stiffness is None:
        stiffness = programme.variable("stiffness", 112.0, 0.0, 800.0, 100.0)
    else:
        stiffness = ca.SX(request.stiffness)
    law: dict[str, Any] = {"knee_touchdown": touchdown}
    for name in ("posterior", "anterior"):
        law[f"{name}_hip_torque"] = programme.variable(f"{name} hip", 0.0, -400.0, 400.0, 100.0)
        least = request.minimum_knee_torque
        law[f"{name}_knee_torque"] = programme.variable(f"{name} knee", max(20.0, least), least, least + 400.0, 100.0)
        law[f"{name}_leg_touchdown"] = programme.variable(f"{name} leg", np.clip(0.22, *bounds), *bounds)
    result = Transcription(request, programme, law, (None, None), stiffness)
    top = ceiling(programme, request)
    legs = legs_of(robot)
    before: _Node | None = None
    x = 0.0
    for phase in phases_of(robot):
        bearing = phase.bearing
        stance = bearing is not None
        label = phase.name.replace("_", " ")
        guess = 0.1 if stance else 0.06
        shortest = request.minimum_stance if stance else 0.02
        duration = programme.variable(f"{label} lasts", guess * (1.0 + 0.2 * rng.uniform(-1.0, 1.0)), shortest, 0.4)
        nodes = []
        for i in range(2 * intervals + 1):
            s = i / (2 * intervals)
            posture = _posture(phase.name, x, guess, request.speed, s)
            nodes.append(_node(programme, phase.name, s, posture, stance, rng))
        x += request.speed * guess
        result.nodes[phase.name], result.durations[phase.name] = nodes, duration
        first, last = nodes[0], nodes[-1]
        span = (dot(phase.outputs.phase, last.q) - dot(phase.outputs.phase, first.q)) / END[stance]
        law[f"{phase.name}_span"] = span
        shapes = _shapes(programme, law, phase)
        if stance:
            programme.require(f"sweep of the leg in {label}", span, -1.5, -0.05)
        begun = resume(phase.outputs, shapes, first.q, first.v, span)
        for i, node in enumerate(nodes):
            terms = dynamics(node.q, node.v)
            past = 0.0 if stance or i < 2 * intervals else 1.0
            _follow(programme, label, phase, replace(begun, past=past), node)
            if bearing is not None:
                held = {f"{bearing.name}_{k}_torque": law[f"{bearing.name}_{k}_torque"] for k in ("hip", "knee")}
                elastic = _spring(request, stiffness, touchdown, bearing, node.q)
                given = support(bearing, node.q, held, p, SimpleNamespace(spring_torque=lambda joint, e=elastic: e))  # type: ignore[arg-type]
                swing = list(zip(phase.outputs.motors, ca.vertsplit(node.u), strict=True))
                node.u = ca.vertcat(*[torque for _, torque in sorted([*given, *swing], key=lambda pair: pair[0])])
                joints = node.u + _on(bearing, elastic)
                _stand(programme, label, request, bearing, node, terms, joints, i == 2 * intervals)
                if 0 < i < 2 * intervals:
                    programme.require(f"knee flexed in {label}", bearing.side * node.q[bearing.knee], p.knee_rest)
                swings = next(leg for leg in legs if leg != bearing)
                height = terms[swings.toe][0][1]
                programme.require(f"clearance in {label}", height, request.clearance, scale=0.1, wish="m")
                rate = dot(phase.outputs.phase, node.v)
                programme.require(f"sweep of the leg in {label}", rate, -30.0, -0.3)
            else:
                D, h = terms["D"], terms["h"]
                applied = ca.vertcat(ca.SX.zeros(3), node.u)
                programme.require(f"motion in {label}", D @ node.a + h - applied, 0.0, 0.0, scale=50.0)
                if 0 < i < 2 * intervals:
                    for leg in legs:
                        programme.require(f"toes in the air in {label}", terms[leg.toe][0][1], 5e-4, scale=0.1)
            limit(programme, request, node.u, node.v, top)
        hermite_simpson(programme, f"motion in {label}", duration, [n.q for n in nodes], [n.v for n in nodes])
        hermite_simpson(programme, f"motion in {label}", duration, [n.v for n in nodes], [n.a for n in nodes])
        if before is None:
            result.start = first.q, first.v
        else:
            programme.require(f"motion in {label}", first.q - before.q, 0.0, 0.0)
            if bearing is not None:
                _strike(programme, request, bearing, before, first.v, dynamics)
        if phase.lifted is not None and before is not None:
            programme.require(f"motion in {label}", first.v - before.v, 0.0, 0.0)
            _, J, drift = dynamics(first.q, first.v)[phase.lifted.toe]
            rises = (J @ first.a + drift)[1]
            programme.require(f"toe leaves the ground into {label}", rises, 5.0, scale=10.0)
        if bearing is not None and request.lift_off == "knee":
            knee = bearing.side * last.q[bearing.knee]
            programme.require(f"knee at lift-off from {label}", knee, p.knee_rest, p.knee_rest)
        before = last
    assert before is not None
    _close(programme, request, result, legs[0], before, dynamics)
    phases = [(result.durations[name], nodes) for name, nodes in result.nodes.items()]
    programme.objective = objective(request, robot.mass * GRAVITY, phases, before.q[0], top)
    return result


def _dynamics(planar: Planar) -> Callable[[Any, Any], dict[str, Any]]:
    """D, h and (position, J, drift) of each toe from symbols."""
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


def _posture(phase: str, x: float, duration: float, speed: float, s: float) -> Array:
    """A rough guess of the configuration: level torso, legs sweeping, swing knees flexed."""
    rest = math.radians(40.0)
    posterior, anterior, knees = {
        "posterior_stance": (0.22 - 0.44 * s, -0.2 + 0.25 * s, (rest + 0.2 * math.sin(math.pi * s), rest + 0.6)),
        "flight_1": (-0.22 + 0.1 * s, 0.1 + 0.12 * s, (rest + 0.3 * s, rest + 0.6 * (1.0 - s))),
        "anterior_stance": (-0.1 + 0.2 * s, 0.22 - 0.44 * s, (rest + 0.6, rest + 0.2 * math.sin(math.pi * s))),
        "flight_2": (0.1 + 0.12 * s, -0.22 + 0.1 * s, (rest + 0.6 * (1.0 - s), rest + 0.3 * s)),
    }[phase]
    p, a = knees[0], -knees[1]
    return np.array([x + speed * duration * s, 0.57, 0.0, posterior + 0.5 * p, p, anterior + 0.5 * a, a])


def _node(programme: Programme, phase: str, s: float, posture: Array, stance: bool, rng: np.random.Generator) -> _Node:
    def variable(part: str, *arguments: Any) -> Any:
        return programme.variable(node_name(phase, s, part), *arguments)

    lower, upper = [-1.0, 0.3, -0.8, -1.9, -0.3, -1.9, -2.5], [4.0, 0.9, 0.8, 1.9, 2.5, 1.9, 0.3]
    rates = np.array([2.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
    q = variable("q", np.clip(posture + 0.03 * rng.normal(size=7), lower, upper), lower, upper)
    v = variable("v", rates + 0.1 * rng.normal(size=7), -30.0, 30.0, 10.0)
    a = variable("a", np.zeros(7), -1500.0, 1500.0, 100.0)
    u = variable("u", np.zeros(2 if stance else 4), -600.0, 600.0, 100.0)
    F = variable("F", [0.0, 430.0], [-3000.0, -1.0], [3000.0, 6000.0], 100.0) if stance else None
    return _Node(q, v, a, u, F)


def _shapes(programme: Programme, law: dict[str, Any], phase: Phase) -> Any:
    """Bézier coefficients from the third on, as the law holds them, new unknowns among them."""
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


def _follow(programme: Programme, label: str, phase: Phase, begun: Evolution, node: _Node) -> None:
    """ÿ = 0."""
    rate, second = (dot(phase.outputs.phase, part) / begun.span for part in (node.v, node.a))
    for row, (_, slope, curvature) in zip(phase.outputs.rows, desired(phase.outputs, begun, node.q), strict=True):
        programme.require(
            f"motion in {label}", dot(row, node.a) - slope * second - curvature * rate * rate, 0.0, 0.0, scale=50.0
        )


def _spring(request: Request, stiffness: Any, touchdown: Any, leg: Leg, q: Any) -> Any:
    """Torque of the physical spring, smooth about its rest angle where that is free."""
    deflection = leg.side * q[leg.knee] - touchdown
    if request.knee_touchdown is None:
        deflection = 0.5 * (deflection + (deflection * deflection + 1e-6) ** 0.5)
    return -leg.side * stiffness * deflection


def _on(leg: Leg, torque: Any) -> Any:
    ca = casadi()
    column = ca.SX.zeros(4)
    column[leg.motors[1]] = torque
    return column


def _stand(
    programme: Programme,
    label: str,
    request: Request,
    leg: Leg,
    node: _Node,
    terms: Mapping[str, Any],
    joints: Any,
    last: bool,
) -> None:
    """Motion with the toe at rest, and its force within the cone."""
    ca = casadi()
    _, J, drift = terms[leg.toe]
    applied = ca.vertcat(ca.SX.zeros(3), joints)
    motion = terms["D"] @ node.a + terms["h"] - applied - J.T @ node.F
    programme.require(f"motion in {label}", motion, 0.0, 0.0, scale=50.0)
    programme.require(f"motion in {label}", J @ node.a + drift, 0.0, 0.0, scale=10.0)
    if last and request.lift_off == "force":
        programme.require(f"no force at lift-off from {label}", node.F, 0.0, 0.0, scale=50.0)
        return
    _cone(programme, f"friction in {label}", request, node.F, 100.0, "N")
    least = 0.0 if request.lift_off == "force" else request.minimum_force
    programme.require(f"normal force in {label}", node.F[1], least, scale=100.0, wish="N")


def _cone(programme: Programme, label: str, request: Request, F: Any, scale: float, unit: str) -> None:
    for side in (1.0, -1.0):
        programme.require(label, CONE * request.friction * F[1] + side * F[0], 0.0, scale=scale, wish=unit)


def _strike(programme: Programme, request: Request, leg: Leg, before: _Node, v: Any, dynamics: Any) -> None:
    """The leg touches down: the toe reaches the ground, falling, and stops, by an impulse within the cone."""
    label = f"{leg.name} touchdown"
    terms = dynamics(before.q, before.v)
    position, J, _ = terms[leg.toe]
    impulse = programme.variable(f"{leg.name} impulse", [0.0, 30.0], [-300.0, 0.01], [300.0, 600.0], 10.0)
    programme.require(label, position[1], 0.0, 0.0)
    programme.require(f"approach at {label}", (J @ before.v)[1], -np.inf, -0.2)
    programme.require(label, terms["D"] @ (v - before.v) - J.T @ impulse, 0.0, 0.0)
    programme.require(label, J @ v, 0.0, 0.0)
    _cone(programme, f"friction at {label}", request, impulse, 10.0, "N·s")


def _close(programme: Programme, request: Request, result: Transcription, leg: Leg, last: _Node, dynamics: Any) -> None:
    """Periodicity, speed, duration."""
    q, v = result.start
    programme.require("origin", q[0], 0.0, 0.0)
    programme.require("periodicity", last.q[1:] - q[1:], 0.0, 0.0)
    period = sum(result.durations.values())
    programme.require("mean speed", last.q[0] / period, request.speed, request.speed, wish="m/s")
    programme.require("duration of the stride", period, request.minimum_stride, 1.0, wish="s")
    _strike(programme, request, leg, last, v, dynamics)
