"""Search for bounding gaits of least effort, or another objective, by direct collocation.

The unknowns are the states, accelerations, swing torques and ground forces at the nodes, the
durations, the law's parameters and the impulses; the dynamics are `model.planar`'s, the outputs and
the stance law those the simulation runs. What is found is then polished to a fixed point of the
event-exact simulation. Every optimum is a local one.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import Infeasible, UnknownName, require
from spear_pin.gaits.bounding import BoundingLaw, Leg, Phase, bounding, legs_of, phases_of, support
from spear_pin.gaits.collocation import (
    Guess,
    Programme,
    Progress,
    Solution,
    casadi,
    hermite_simpson,
    node_name,
    quadrature,
    resampled,
)
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import find_gait
from spear_pin.gaits.virtual_constraints import Evolution, desired, dot, resume
from spear_pin.hybrid.contact import Contact
from spear_pin.model.motor import Drive
from spear_pin.model.planar import Planar
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

Array = NDArray[np.float64]
COARSE, FINE = 6, 10  # intervals of each phase, for a cold start and for what is polished
CONE = 0.98  # of the friction asked for: what the collocation's error may use up
END = {True: 0.98, False: 1.02}  # s at the end of a stance, where the polynomial is not to run out, and of a flight
ANGLES, FLEXIONS = (-1.2, 1.2), (-0.2, 2.4)  # rad: of Bézier coefficients of leg angles and knees
GRAVITY = 9.81
SPEED_BY = "posterior_hip_torque"  # what the polishing varies to meet the speed


@dataclass(frozen=True)
class Request:
    """What is asked of a bounding gait. Torques and forces are those of a pair of legs.

    Attributes:
        speed: mean forward speed, in m/s (source: 2.5).
        objective: a key of `OBJECTIVES`.
        lift_off: "knee" or "force", see `BoundingLaw`.
        friction: coefficient of friction that forces and impulses may use.
        minimum_force: least normal force in stance, in N; with lift-off by force it fades out at the end.
        clearance: least height of the other toe during a stance, in m.
        minimum_stride: least duration of a stride, in s.
        minimum_stance: least duration of a stance, in s.
        minimum_knee_torque: least |ū| of (5.5)-(5.6), in N·m.
        hip_torque: largest hip torque, in N·m; None means no bound.
        stiffness: of the physical knee springs, in N·m/rad; None leaves it free.
        virtual_stiffness: k of (5.5)-(5.6), in N·m/rad.
        knee_touchdown: knee angle at touchdown, by magnitude, in rad; None leaves it free.
        leg_touchdown: bounds on the leg angle at touchdown, in rad.
        knee_drive: motor, gearbox and bus of each knee, two a pair; None means no bound.
        hip_drive: those of each hip.
    """

    speed: float = 2.5
    objective: str = "effort"
    lift_off: str = "knee"
    friction: float = 0.6
    minimum_force: float = 20.0
    clearance: float = 0.03
    minimum_stride: float = 0.0
    minimum_stance: float = 0.05
    minimum_knee_torque: float = 10.0
    hip_torque: float | None = None
    stiffness: float | None = 112.0
    virtual_stiffness: float = 400.0
    knee_touchdown: float | None = math.radians(40.0)
    leg_touchdown: tuple[float, float] = (-0.3, 0.7)
    knee_drive: Drive | None = None
    hip_drive: Drive | None = None

    def __post_init__(self) -> None:
        """Check the fields."""
        if self.objective not in OBJECTIVES:
            raise UnknownName("objective", self.objective, OBJECTIVES)
        if self.lift_off not in ("knee", "force"):
            raise UnknownName("rule of lift-off", self.lift_off, ("knee", "force"))
        require("speed", self.speed, lambda s: s > 0, "a number > 0, in m/s")
        require("friction", self.friction, lambda mu: mu > 0, "a number > 0")
        for name in ("clearance", "minimum_force", "minimum_stride", "minimum_knee_torque", "virtual_stiffness"):
            require(name, getattr(self, name), lambda number: number >= 0, "a number >= 0")
        require("minimum_stance", self.minimum_stance, lambda t: 0 < t < 0.4, "between 0 and 0.4 s")
        for name in ("stiffness", "hip_torque"):
            if getattr(self, name) is not None:
                require(name, getattr(self, name), lambda number: number >= 0, "a number >= 0, or None")
        if self.knee_touchdown is not None:
            require("knee_touchdown", self.knee_touchdown, lambda a: 0 < a < math.pi, "between 0 and π rad, or None")


def _effort(nodes: Mapping[str, list[Any]], durations: Mapping[str, Any], weights: Array) -> Any:
    ca = casadi()
    return sum(
        quadrature(durations[name], [ca.dot(weights, node.u * node.u) for node in nodes[name]]) for name in nodes
    )


def _mechanical(nodes: Mapping[str, list[Any]], durations: Mapping[str, Any]) -> Any:
    total: Any = 0.0
    for name in nodes:
        powers = []
        for node in nodes[name]:
            power = node.u * node.v[3:]
            powers.append(casadi().sum1((power * power + 1.0) ** 0.5))  # |P|, smooth within a watt
        total = total + quadrature(durations[name], powers)
    return total


OBJECTIVES: dict[str, tuple[str, str]] = {
    "effort": ("N²m²s/m", "integral of the squared motor torques, per metre"),
    "hip": ("N²m²s/m", "the same, the hips' counted ten times"),
    "cot": ("1", "mechanical cost of transport: integral of |motor power| over weight and distance"),
    "peak": ("N·m", "largest motor torque"),
}
"""What can be minimised: name -> unit, meaning."""


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
    robot: Robot, request: Request, intervals: int = FINE, *, seed: int = 0, start: Guess | None = None
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
    weights = _peaks(request, programme)
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
                programme.require(f"clearance in {label}", height, request.clearance, scale=0.1, wish=True)
                rate = dot(phase.outputs.phase, node.v)
                programme.require(f"sweep of the leg in {label}", rate, -30.0, -0.3)
            else:
                D, h = terms["D"], terms["h"]
                applied = ca.vertcat(ca.SX.zeros(3), node.u)
                programme.require(f"motion in {label}", D @ node.a + h - applied, 0.0, 0.0, scale=50.0)
                if 0 < i < 2 * intervals:
                    for leg in legs:
                        programme.require(f"toes in the air in {label}", terms[leg.toe][0][1], 5e-4, scale=0.1)
            _limit(programme, request, label, node, weights)
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
    programme.objective = _objective(request, robot, result, before.q[0], weights)
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
    _cone(programme, f"friction in {label}", request, node.F, 100.0)
    least = 0.0 if request.lift_off == "force" else request.minimum_force
    programme.require(f"normal force in {label}", node.F[1], least, scale=100.0, wish=True)


def _cone(programme: Programme, label: str, request: Request, F: Any, scale: float) -> None:
    for side in (1.0, -1.0):
        programme.require(label, CONE * request.friction * F[1] + side * F[0], 0.0, scale=scale, wish=True)


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
    _cone(programme, f"friction at {label}", request, impulse, 10.0)


def _close(programme: Programme, request: Request, result: Transcription, leg: Leg, last: _Node, dynamics: Any) -> None:
    """Periodicity, speed, duration."""
    q, v = result.start
    programme.require("origin", q[0], 0.0, 0.0)
    programme.require("periodicity", last.q[1:] - q[1:], 0.0, 0.0)
    period = sum(result.durations.values())
    programme.require("mean speed", last.q[0] - request.speed * period, 0.0, 0.0, wish=True)
    programme.require("duration of the stride", period, request.minimum_stride, 1.0, wish=True)
    _strike(programme, request, leg, last, v, dynamics)


def _peaks(request: Request, programme: Programme) -> Any:
    """The unknown that bounds every torque, for the objective that minimises it."""
    return programme.variable("peak torque", 200.0, 0.0, 1000.0, 100.0) if request.objective == "peak" else None


def _limit(programme: Programme, request: Request, label: str, node: _Node, peak: Any) -> None:
    """Bounds on torques, and the motors' torque-speed envelopes."""
    names = ("posterior hip", "posterior knee", "anterior hip", "anterior knee")
    for i, name in enumerate(names):
        torque, rate = node.u[i], node.v[3 + i]
        if peak is not None:
            for side in (1.0, -1.0):
                programme.require("peak torque", peak - side * torque, 0.0, scale=100.0)
        if "hip" in name and request.hip_torque is not None:
            limit = request.hip_torque
            programme.require(f"torque of the {name}", torque, -limit, limit, scale=100.0, wish=True)
        drive = request.knee_drive if "knee" in name else request.hip_drive
        if drive is not None:
            _within(programme, f"envelope of the {name} motor", drive, 0.5 * torque, rate)


def _within(programme: Programme, label: str, drive: Drive, torque: Any, rate: Any) -> None:
    """One motor's voltage and current, its gearbox taken as lossy both ways, which is on the safe side."""
    line = replace(drive, current_limit=None).stall_torque
    for side in (1.0, -1.0):
        available = line * (1.0 - side * rate / drive.no_load_speed)
        programme.require(label, available - side * torque, 0.0, scale=50.0, wish=True)
        if drive.current_limit is not None:
            programme.require(label, drive.stall_torque - side * torque, 0.0, scale=50.0, wish=True)


def _objective(request: Request, robot: Robot, result: Transcription, distance: Any, peak: Any) -> Any:
    """Scaled to order ten."""
    if request.objective == "peak":
        return 0.1 * peak + 1e-3 * _effort(result.nodes, result.durations, np.ones(4)) / distance / 100.0
    if request.objective == "cot":
        return 10.0 * _mechanical(result.nodes, result.durations) / (robot.mass * GRAVITY * distance)
    weights = np.array([10.0, 1.0, 10.0, 1.0]) if request.objective == "hip" else np.ones(4)
    return _effort(result.nodes, result.durations, weights) / distance / 100.0


def search(
    robot: Robot,
    request: Request,
    *,
    seed: int = 0,
    start: Solution | None = None,
    contact: Contact | None = None,
    on_iteration: Progress | None = None,
) -> tuple[Gait, Solution]:
    """A gait that meets the request, locally optimal, as a fixed point of the event-exact simulation.

    A cold search goes over a coarse mesh first.

    Args:
        robot: Q-SPEAR in the sagittal plane.
        request: what is asked.
        seed: of the initial guess of a cold search.
        start: the solution of another request to start from instead.
        contact: the ground of the simulation; the friction that the gait may use is the request's.
        on_iteration: called with the optimiser's iteration, objective and largest violation.

    Returns:
        the gait, and the optimiser's solution to start another search from.

    Raises:
        Infeasible: the optimiser found nothing; names the wish that a relaxed solve misses most.
        NoGait: what the optimiser found is not a fixed point nearby.
        MissingExtra: CasADi is not installed.
    """
    for intervals in (FINE,) if start else (COARSE, FINE):
        guess = resampled(start) if start else None
        transcription = transcribe(robot, request, intervals, seed=seed, start=guess)
        solution = transcription.programme.solve(on_iteration=on_iteration)
        if not solution.success:
            raise obstacle(transcription, solution)
        start = solution
    return polish(robot, transcription, solution, contact), solution


def polish(robot: Robot, transcription: Transcription, solution: Solution, contact: Contact | None = None) -> Gait:
    """The fixed point of the event-exact simulation beside a solution, at its mean speed.

    Raises:
        NoGait: there is none nearby.
    """
    law, state, stiffness = transcription.read(solution)
    system = bounding(robot, law, Spring(stiffness=stiffness, damping=0.0), contact)
    state = _on_ground(robot, ("posterior_toe",), state)
    gait = find_gait(system, [SPEED_BY], {"mean_speed": transcription.request.speed}, guess=state)
    q, v = gait.state
    law = replace(gait.system.law, nominal=(*q[1:].tolist(), *v.tolist()))
    return replace(gait, system=system.build(robot, law, system.spring, system.contact))


def obstacle(transcription: Transcription, solution: Solution) -> Infeasible:
    """What stands in the way of a request: the wish that a relaxed solve misses most, as a share of its unit."""
    relaxed, margins = transcription.programme.relaxed(resampled(solution))
    loosened = relaxed.solve(iterations=300)
    missed = {label: float(loosened.values[name][0]) for label, (name, _) in margins.items()}
    worst = max(missed, key=lambda label: missed[label])
    return Infeasible(worst, missed[worst] * margins[worst][1])


def _on_ground(robot: Robot, toes: tuple[str, ...], state: tuple[Array, Array]) -> tuple[Array, Array]:
    """The state with the toes exactly on the ground and at rest."""
    q, v = state
    rows = np.vstack([robot.toe_jacobian(q, toe) for toe in toes])
    for _ in range(5):
        heights = np.array([robot.toe_position(q, toe)[1] for toe in toes])
        q = q - np.linalg.pinv(rows[1::2]) @ heights
        rows = np.vstack([robot.toe_jacobian(q, toe) for toe in toes])
    return q, v - np.linalg.pinv(rows) @ (rows @ v)
