"""Functions of a controller in C: torques and guards of each phase, and what its events latch, by CasADi."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from spear_pin.errors import SpearError
from spear_pin.gaits.collocation import casadi
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.controller import Happening, after, beginnings, happenings, motion
from spear_pin.hybrid.domain import Held
from spear_pin.hybrid.dynamics import Operations
from spear_pin.hybrid.elimination import solve_sparse
from spear_pin.hybrid.fields import flatten, map_nested

Shape = Any  # 0.0, or nested tuples of it
BODY = re.compile(r"static int casadi_f0\([^)]*\) \{\n(.*?)  return 0;\n\}\n", re.DOTALL)
PLAIN = {"real": "double", "sq": "square", "fmax": "fmax", "fmin": "fmin", "fabs": "fabs"}  # CasADi's names


@dataclass(frozen=True)
class Phase:
    """A phase of a controller.

    Attributes:
        name: its name.
        held: shape of each held value.
        events: its events.
        guards: for each watched guard the index of its event.
        tolerances: values at or below which these guards count as zero.
        schedule: times of the scheduled event since the phase began, in s.
    """

    name: str
    held: Mapping[str, Shape]
    events: tuple[Happening, ...]
    guards: tuple[int, ...]
    tolerances: tuple[float, ...]
    schedule: tuple[float, ...]

    @property
    def size(self) -> int:
        """Number of the held numbers."""
        return len(flatten(list(self.held.values())))


def phases_of(system: HybridSystem) -> tuple[Phase, ...]:
    """Returns the phases of a controller, with all that its events hold in them."""
    held = _held(system)
    found = []
    for name in system.phases:
        domain = system.of_phase(name)[0]
        events = happenings(domain)
        values = motion(system, name, *_symbols(system, held[name]), _operations()).guards
        moving = [(i, event) for i, event in _watched(events) if _moves(values[i])]
        guards, tolerances = tuple(event for _, event in moving), tuple(domain.guards[i].tolerance for i, _ in moving)
        times = [] if domain.switch is None else [domain.switch.time(n, system.law) for n in range(1, 1000)]
        schedule = tuple(time for time in times if time <= system.phase_limit)
        found.append(Phase(name, held[name], events, guards, tolerances, schedule))
    return tuple(found)


def functions_of(system: HybridSystem, phases: Sequence[Phase]) -> dict[str, str]:
    """Returns the C functions by name: the law of each phase, the latch of each of its events, and the beginnings."""
    ca, found, held = casadi(), dict[str, str](), {phase.name: phase.held for phase in phases}

    def written(name: str, inputs: Sequence[Any], *outputs: Sequence[Any]) -> None:
        rows = [ca.vertcat(*map(ca.SX, output)) if output else ca.SX(0, 1) for output in outputs]
        found[name] = _in_c(name, ca.Function(name, inputs, rows, {"cse": True}))

    for phase in phases:
        t, q, v, values = arguments = _symbols(system, phase.held)
        inputs = [t, ca.vertcat(*q), ca.vertcat(*v), ca.vertcat(*flatten(list(values.values())))]
        moving = motion(system, phase.name, *arguments, _operations())
        values_seen = [moving.guards[i] for i, _ in _watched(phase.events) if _moves(moving.guards[i])]
        written(f"{phase.name}_law", inputs, moving.u, values_seen)
        for event in phase.events:
            reached = after(system, event, t, q, v, values)
            into = held[event.reset.phase or phase.name]
            written(f"{phase.name}_{identifier(event.name)}", inputs, _flat(reached, into))
    for event in beginnings(system):
        t, q, v, _ = _symbols(system, {})
        reached = after(system, event, t, q, v, {})
        inputs = [t, ca.vertcat(*q), ca.vertcat(*v), ca.SX(0, 1)]
        written(f"begin_{event.name}", inputs, _flat(reached, held[str(event.reset.phase)]))
    return found


def _held(system: HybridSystem) -> dict[str, dict[str, Shape]]:
    """Returns the shapes of the values held in each phase, by following its events until nothing is added."""
    found: dict[str, dict[str, Shape]] = {name: {} for name in system.phases}
    waiting: list[tuple[Happening, str]] = [(event, "") for event in beginnings(system)]
    while waiting:
        event, phase = waiting.pop(0)
        into = event.reset.phase or phase
        reached = after(system, event, *_symbols(system, found.get(phase, {})))
        shapes = {name: map_nested(lambda value: 0.0, value) for name, value in reached.items()}
        if shapes.keys() - found[into].keys() or not found[into]:
            found[into] |= {name: shape for name, shape in shapes.items() if name not in found[into]}
            waiting += [(each, into) for each in happenings(system.of_phase(into)[0])]
    return found


def _watched(events: Sequence[Happening]) -> list[tuple[int, int]]:
    """Returns the guards that tell of events, in their order, each with the index of its event."""
    return sorted((i, event) for event, each in enumerate(events) for i in each.guards)


def _symbols(system: HybridSystem, held: Mapping[str, Shape]) -> tuple[Any, list[Any], list[Any], Held]:
    """Returns symbols of time, configuration, velocity and held values."""
    ca, robot = casadi(), system.robot
    q, v = (ca.vertsplit(ca.SX.sym(name, count)) for name, count in (("q", robot.nq), ("v", robot.nv)))
    values = {name: map_nested(lambda zero: ca.SX.sym("held"), shape) for name, shape in held.items()}
    return ca.SX.sym("t"), q, v, values


def _operations() -> Operations:
    ca = casadi()
    names = "sin", "cos", "tan", "tanh", "sqrt", "exp", "atan2"
    return Operations(**{name: getattr(ca, name) for name in names}, maximum=ca.fmax, solve=solve_sparse)


def _moves(value: Any) -> bool:
    """Tells whether a guard depends on anything."""
    return isinstance(value, casadi().SX) and not value.is_constant()


def _flat(values: Held, shapes: Mapping[str, Shape]) -> list[Any]:
    """Returns held values in the order of their shapes; a value that is not held yet is zero."""
    flat: list[Any] = []
    for name, shape in shapes.items():
        found = flatten([values.get(name, shape)])
        if len(found) != len(flatten([shape])):
            raise SpearError(f"the held value {name!r} has another size from event to event: its law cannot be written")
        flat += found
    return flat


def _in_c(name: str, function: Any) -> str:
    generator = casadi().CodeGenerator("controller.c", {"casadi_real": "double", "casadi_int": "int"})
    generator.add(function)
    body = BODY.search(generator.dump())
    text = "" if body is None else re.sub(r"casadi_(\w+)", lambda found: PLAIN.get(found[1], found[0]), body[1])
    assert text and "casadi_" not in text, f"CasADi writes {name} in another form"
    if "arg[" not in text:
        text = f"  (void)arg;\n{text}"
    return f"static void {name}(const double **arg, double **res)\n{{\n{text}}}\n"


def identifier(name: str) -> str:
    """Returns a name of C for the name of an event."""
    return re.sub(r"\W", "_", name)
