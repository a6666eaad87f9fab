"""Switches of springs: what the edges of a switch hold, and when a delayed switch acts.

A delay ends at a time that is held, on the phase's clock; where a phase ends, that time is counted from there on.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.brake import Brakes
from spear_pin.hybrid.domain import (
    ACTS,
    DUE,
    ENGAGES,
    GRIPS,
    HOLDS,
    KEEPS,
    LEAVES,
    RELEASES,
    SLIPS,
    TOUCHES,
    Edge,
    Guard,
    Held,
    Mount,
    Reset,
    Turn,
)
from spear_pin.hybrid.dual import ARRAYS, value_of
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.springs import number_spring, values_along
from spear_pin.model.equations import mechanism_of
from spear_pin.model.spring import Spring

GRIPPED = 0.0, 0.0  # it does not slip, and has not slipped since the spring was engaged
ON_TOOTH = 1e-12  # pitches: within this of a tooth, that tooth is engaged


class Clock(NamedTuple):
    """What edges depend on besides the state.

    Attributes:
        t: time since the phase began, in s.
        springs: the system's springs, with scalars of any kind.
        system: the system.
        brakes: the system's brakes, with scalars of any kind; None for them as they are.
    """

    t: Any
    springs: Mapping[str, Spring]
    system: HybridSystem
    brakes: Brakes | None = None


def after_edges(edges: Sequence[Edge], held: Held, q: Sequence[Any], clock: Clock) -> Held:
    """Returns the values held after edges of switches; no step branches on a value."""
    for edge in edges:
        held = {**held, **_after(edge.kind, edge.mount, held, q, clock)}
    return held


def after_turns(turns: Sequence[Turn], held: Held, clock: Clock) -> Held:
    """Returns the values held after brakes opened, closed, or began to wait until they close."""
    brakes = clock.system.brakes if clock.brakes is None else clock.brakes
    for brake, closed, waits in turns:
        own, waiting, time = of_brake(brake)
        held = {**held, own: float(closed), waiting: float(waits), time: clock.t + brakes[brake].delay}
    return held


def of_brake(name: str) -> tuple[str, str, str]:
    """Returns the names in `held` of whether a brake is closed, whether it waits to close, and of the time for that."""
    return f"brake {name}", f"brake {name} waits", f"{DUE}brake {name}"


def from_now_on(held: Held, t: Any) -> dict[str, Any]:
    """Returns the held values with all times counted from the end of a phase."""
    return {name: value - t if name.startswith(DUE) else value for name, value in held.items()}


def _after(kind: str, mount: Mount, held: Held, q: Sequence[Any], clock: Clock) -> Held:
    assert mount.on is not None and isinstance(mount.rest, str) and mount.taut is not None
    spring, path = number_spring(mount, clock.system, clock.springs)
    clutch, on = spring.clutch, held.get(mount.on, 0.0)
    assert clutch is not None
    now = values_along(mount.along, clock.system.robot, q)
    rest = _mixed(on, held.get(mount.rest, now), now)
    slack = mount.tooth is not None or bool(mount.spring.clutch and mount.spring.clutch.play)
    found = {mount.rest: rest, mount.taut: on * held.get(mount.taut, 0.0) + (1.0 - on) * (1.0 - slack)}
    if mount.tooth is not None:
        length = value_of(path.length(mechanism_of(clock.system.robot).posed([*map(value_of, q)], ARRAYS)))
        tooth = np.ceil((length - value_of(clutch.tooth)) / value_of(clutch.pitch) - ON_TOOTH)
        found[mount.tooth] = on * held.get(mount.tooth, 0.0) + (1.0 - on) * tooth
    if mount.slips is not None:
        as_it_was = _mixed(on, held.get(mount.slips, GRIPPED), GRIPPED)
        found[mount.slips] = {SLIPS: (1.0, 1.0), GRIPS: (0.0, 1.0)}.get(kind, as_it_was)
    if kind in (SLIPS, GRIPS):
        return {**found, mount.rest: now} if kind == GRIPS else found
    if kind == KEEPS:
        waits, ends = held.get(waiting(mount), 0.0), held.get(due(mount), clock.t)
        return {**found, mount.on: on, waiting(mount): waits, due(mount): ends}
    if kind in (TOUCHES, LEAVES):
        delay, waits = (clutch.on_delay, 1.0 - on) if kind == TOUCHES else (clutch.off_delay, on)
        return {**found, mount.on: on, waiting(mount): waits, due(mount): clock.t + delay}
    if kind == HOLDS:
        return {**found, mount.on: 1.0, waiting(mount): 1.0, due(mount): clock.t + clutch.hold}
    to = {ENGAGES: 1.0, RELEASES: 0.0, ACTS: 1.0 - on}[kind]
    return {**found, mount.on: to, waiting(mount): 0.0, due(mount): clock.t}


def due(mount: Mount) -> str:
    """Returns the name in `held` of the time at which a switch acts, on the phase's clock."""
    return f"{DUE}{mount.name}"


def waiting(mount: Mount) -> str:
    """Returns the name in `held` of a value that is 1 while a switch waits to act, else 0."""
    return f"{mount.name}_waits"


def _mixed(on: Any, old: Any, new: Any) -> Any:
    if isinstance(new, tuple):
        return tuple(_mixed(on, *pair) for pair in zip(old, new, strict=True))
    return on * old + (1.0 - on) * new


def make_delay_event(mount: Mount) -> Guard:
    """Returns the event at which a delayed switch acts."""
    time, waits = due(mount), waiting(mount)

    def left(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return held[waits] * (held[time] - t) + (1.0 - held[waits])

    return Guard(f"switch:{mount.name}", left, Reset(edges=(Edge(ACTS, mount),)))


def make_slip_events(mount: Mount) -> tuple[Guard, ...]:
    """Returns the events at which a clutch begins to slip, and grips again as the path grows no more."""
    if mount.on is None or mount.slips is None:
        return ()
    name, on, slips = mount.name, mount.on, mount.slips

    def spare(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        pull, holds = dyn.pull(name), held[on] * (1.0 - held[slips][0])
        return holds * (pull.spring.at_slip - pull.stretch) + (1.0 - holds)

    def growth(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        gives = held[on] * held[slips][0]
        return gives * dyn.pull(name).rate + (1.0 - gives)

    begins, ends = (Reset(edges=(Edge(kind, mount),)) for kind in (SLIPS, GRIPS))
    return Guard(f"slips:{name}", spare, begins), Guard(f"grips:{name}", growth, ends)
