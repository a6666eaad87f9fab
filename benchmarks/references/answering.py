"""The answer to a problem by either engine: its events, with time, state and energies."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from benchmarks.references.problem import LANDS, Problem
from spear_pin.arrays import Array
from spear_pin.errors import SpearError
from spear_pin.hybrid.domain import Reset
from spear_pin.hybrid.dual import ARRAYS
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.result import Options, Segment
from spear_pin.hybrid.rules.cycles import INSTANT
from spear_pin.hybrid.run import run
from spear_pin.hybrid.strikes import Overlap, strike_in_space
from spear_pin.hybrid.tangent.record import many
from spear_pin.model.equations import mechanism_of

LIFTS = "lift_off"
SWEEPS = 3000
Raw = tuple[str, Reset | None, float, Array, Array]


class Happened(NamedTuple):
    """An event.

    Attributes:
        name: its name: touchdown, lift_off, slip, stick, or one of a spring's.
        foot: the foot that touches or leaves, else empty.
        time: time since the start, in s.
        q: configuration, (nq,).
        v: velocity after it, (nv,).
        kinetic: kinetic energy after it, in J.
        potential: potential energy of gravity, in J.
    """

    name: str
    foot: str
    time: float
    q: Array
    v: Array
    kinetic: float
    potential: float

    @property
    def measured(self) -> dict[str, Array]:
        """Its numbers by quantity."""
        energy = np.array([self.kinetic, self.potential])
        return {"time_s": np.array([self.time]), "position": self.q, "velocity": self.v, "energy_J": energy}


def by_reference(problem: Problem, rtol: float) -> list[Happened]:
    """Returns the events by the reference engine.

    Raises:
        SpearError: the motion ends otherwise.
    """
    if problem.strikes:
        return [_struck(problem, _struck_by_reference(problem))]
    ended: list[Segment] = []
    cycles = max(1, problem.landings - (not problem.stands))
    found = run(problem.system, problem.start, cycles, Options(rtol), on_segment=ended.append)
    resets = [segment.ended.reset for segment in ended if segment.ended is not None]
    raw = [
        (event.name, reset, event.time, event.q, event.v) for event, reset in zip(found.events, resets, strict=False)
    ]
    return _until_the_end(problem, raw, found.message)


def by_other(problem: Problem) -> list[Happened]:
    """Returns the events by the Taylor engine, which needs heyoka.

    Raises:
        SpearError: the motion is none that this engine runs alone.
    """
    if problem.strikes:
        return [_struck(problem, _struck_by_other(problem))]
    start, nv, began = problem.start, problem.robot.nv, 0.0
    runner = LoneRunner(many(problem.system, {}), 0)
    phase, y, held = start.phase, np.concatenate([start.q, start.v]), start.held
    raw: list[Raw] = []
    for _ in range(problem.landings):
        record = runner.lap(phase, y, held)
        if record is None:
            break
        for arc, after in zip(record.arcs, [*(each.y for each in record.arcs[1:]), record.y], strict=True):
            if arc.event is not None:
                name, reset = arc.event.name, arc.event.reset
                raw.append((name, reset, began + arc.end, after[:nv], after[nv:]))
                began += arc.end if arc.begins_phase else 0.0
        phase, y, held = record.phase, record.y, record.held
    return _until_the_end(problem, raw, runner.why)


def apart(one: list[Happened], other: list[Happened]) -> dict[str, float]:
    """Returns the largest difference of each quantity.

    Raises:
        SpearError: the events are others.
    """
    names = [[(each.name, each.foot) for each in events] for events in (one, other)]
    if names[0] != names[1]:
        raise SpearError(f"events {names[0]} are {names[1]} in the other run")
    found: dict[str, float] = {}
    for mine, theirs in zip(one, other, strict=True):
        for quantity, value in mine.measured.items():
            difference = float(np.abs(value - theirs.measured[quantity]).max())
            found[quantity] = max(difference, found.get(quantity, 0.0))
    return found


def _until_the_end(problem: Problem, raw: list[Raw], why: str) -> list[Happened]:
    """Returns the events up to the last touchdown."""
    landed = [i for i, event in enumerate(raw) if event[0] == LANDS]
    if len(landed) < problem.landings:
        raise SpearError(f"reference {problem.name!r}: {len(landed)} of {problem.landings} touchdowns: {why}")
    found = [_happened(problem, *event) for event in raw[: landed[problem.landings - 1] + 1]]
    return [one for one, after in zip(found, [*found[1:], None], strict=True) if not _loses_its_force(one, after)]


def _loses_its_force(event: Happened, after: Happened | None) -> bool:
    """Tells whether a foot begins to slide in the instant in which it leaves the ground."""
    leaves = after is not None and after.name == LIFTS and after.time - event.time < INSTANT
    return leaves and event.name == "slip"


def _happened(problem: Problem, name: str, reset: Reset | None, time: float, q: Array, v: Array) -> Happened:
    robot, foot = problem.robot, ""
    if reset is not None and reset.impact:
        name, foot = LANDS, reset.impact[0]
    elif name.endswith(LIFTS):
        foot = next(toe for toe in robot.toes if toe.removesuffix("_toe") == name.removesuffix(f"_{LIFTS}"))
        name = LIFTS
    energies = float(robot.kinetic_energy(q, v)), float(robot.potential_energy(q))
    return Happened(name, foot, float(time), np.array(q), np.array(v), *energies)


def _struck(problem: Problem, v: Array) -> Happened:
    return _happened(problem, "impact", None, 0.0, np.array(problem.q, dtype=float), v)


def _struck_by_reference(problem: Problem) -> Array:
    """Returns the velocity after an impact."""
    system, q, v = problem.system, np.array(problem.q, dtype=float), np.array(problem.v, dtype=float)
    air = system.of_phase("air")[0]
    strike = strike_in_space(system, air, Reset(impact=problem.strikes), q, v, Overlap(0.0), 0.0)
    return strike.v


def _struck_by_other(problem: Problem) -> Array:
    """Returns the velocity after an impact, by sweeps of projections onto the cones, from the derived equations."""
    v, friction = np.array(problem.v, dtype=float), problem.ground.friction
    terms = mechanism_of(problem.robot).terms(list(problem.q), v.tolist(), ARRAYS)
    jacobian = np.concatenate([np.array(terms.jacobians[toe], dtype=float) for toe in problem.strikes])
    response = np.linalg.solve(np.array(terms.mass_matrix, dtype=float), jacobian.T)
    A, before = jacobian @ response, jacobian @ v
    impulse = np.zeros(len(A))
    for _ in range(SWEEPS):
        for i in range(0, len(A), 3):
            here = slice(i, i + 3)
            step = 1.0 / np.linalg.eigvalsh(A[here, here])[-1]
            u = before[here] + A[here] @ impulse
            u[2] += friction * np.hypot(*u[:2])  # de Saxcé's correction: a foot that slides does not rise
            impulse[here] = _on_cone(impulse[here] - step * u, friction)
    return np.asarray(v + response @ impulse)


def _on_cone(impulse: Array, friction: float) -> Array:
    """Returns the nearest point of the cone of friction."""
    across, normal = float(np.hypot(*impulse[:2])), float(impulse[2])
    if across <= friction * normal:
        return impulse
    if friction * across <= -normal:
        return np.zeros(3)
    reached = (friction * across + normal) / (1.0 + friction**2)
    return np.array([*(friction * reached / across * impulse[:2]), reached])
