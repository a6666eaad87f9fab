"""A system as a controller on a robot sees it: the torques of each phase, and the events that change what it holds."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count
from typing import Any, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.arc import states_over
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.domain import Domain, Held, Reset
from spear_pin.hybrid.dual import NUMBERS, Dual, derivative_of, value_of
from spear_pin.hybrid.engines.structure import Scalars
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.filippov import flow_of
from spear_pin.hybrid.flow_names import flow_names
from spear_pin.hybrid.result import Options, Segment, State
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.rules.start import start
from spear_pin.hybrid.run import run
from spear_pin.model.equations import mechanism_of
from spear_pin.model.round_feet import refuse_ends

ALONG = 20  # samples of a segment in a record


@dataclass(frozen=True)
class Happening:
    """An event that changes what a controller holds, or its phase.

    Attributes:
        name: its name.
        guards: indices of the guards of the phase's first domain that tell of it; none for a scheduled event.
        reset: its effect.
    """

    name: str
    guards: tuple[int, ...]
    reset: Reset


class Row(NamedTuple):
    """A sample of a recorded motion.

    Attributes:
        event: name of the event just before it; "" for none.
        t: time, in s.
        q: configuration, (nq,).
        v: velocity, (nv,).
        u: the law's torques, in N·m, (nu,).
    """

    event: str
    t: float
    q: Array
    v: Array
    u: Array


class Command(NamedTuple):
    """What a gait asks of the motors at an instant.

    Attributes:
        t: time since the cycle began, in s.
        q: positions of the joints with motors, (nu,).
        v: their rates, (nu,).
        u: torques, in N·m, (nu,).
        contacts: whether each toe is on the ground.
        stiffness: -∂u/∂q of the law, in N·m/rad, (nu, nu).
        damping: -∂u/∂v of the law, in N·m·s/rad, (nu, nu).
    """

    t: float
    q: Array
    v: Array
    u: Array
    contacts: tuple[bool, ...]
    stiffness: Array
    damping: Array


def happenings(domain: Domain) -> tuple[Happening, ...]:
    """Returns the events of a domain that a controller has to see; of slip it does not know."""
    events: list[tuple[str, tuple[int, ...], Reset]] = []
    for i, guard in enumerate(domain.guards):
        reset = guard.reset
        if reset is None or not (reset.holds or reset.phase is not None):
            continue
        same = next((k for k, (name, _, other) in enumerate(events) if name == guard.name and other is reset), None)
        if same is None:
            events.append((guard.name, (i,), reset))
        else:
            events[same] = guard.name, (*events[same][1], i), reset
    if domain.switch is not None:
        events.append((domain.switch.name, (), domain.switch.reset))
    names = [name for name, _, _ in events]
    counts = [names[:i].count(name) for i, name in enumerate(names)]  # each leg's spring has an event of its own
    return tuple(
        Happening(f"{name}_{count + 1}" if count else name, guards, reset)
        for count, (name, guards, reset) in zip(counts, events, strict=True)
    )


def beginnings(system: HybridSystem) -> tuple[Happening, Happening]:
    """Returns how a controller begins: in the flight before the section, and on the section; both lead into a phase."""
    found = []
    for standing in (False, True):
        phase, resets = start(system, standing)

        def latch(q: Any, v: Any, held: Held, p: Any, resets: Sequence[Reset] = resets) -> Held:
            return latch_values({}, resets, q, v, p, begins=True)

        found.append(Happening("standing" if standing else "aloft", (), Reset(latch=latch, phase=phase)))
    return found[0], found[1]


def motion(
    system: HybridSystem, phase: str, t: Any, q: Sequence[Any], v: Sequence[Any], held: Held, ops: Any
) -> Motion:
    """Returns the motion in a phase as its controller assumes it, toes at rest, for scalars of any kind.

    Args:
        system: the system, whose numbers are kept.
        phase: the phase.
        t: time since the phase began.
        q: configuration.
        v: velocity.
        held: held values.
        ops: elementary functions.
    """
    numbers = Scalars(system.law, system.springs, system.ground, [*map(float, system.robot.model.damping)])
    return Motion(system, system.of_phase(phase)[0], mechanism_of(system.robot), t, q, v, held, numbers, ops)


def after(system: HybridSystem, happening: Happening, t: Any, q: Sequence[Any], v: Sequence[Any], held: Held) -> Held:
    """Returns the values held after an event, for scalars of any kind."""
    clock = Clock(t, system.springs, system)
    return latch_values(held, [happening.reset], q, v, system.law, system.place_of, clock=clock)


def check_controllable(system: HybridSystem, kinds: Sequence[str]) -> None:
    """Refuses a system whose law cannot be written as a controller.

    Raises:
        BadValue: its kind is another, or it has event feedback, dry friction, a brake, a switch that is
            not ideal, a fixed spring, or a round foot whose arc has ends.
    """
    if system.kind not in kinds:
        raise BadValue("gait", system.kind, f"a gait of {' or '.join(kinds)}, whose law can run on a controller")
    resets = [happening.reset for domain in system.domains for happening in happenings(domain)]
    if any(reset.adjust is not None for reset in resets):
        raise BadValue("gait.system", "one with event feedback", "one without, to write its law as a controller")
    if any(domain.rubs for domain in system.domains):
        raise BadValue(
            "gait.system", "one with dry friction or brakes", "one without, to write its law as a controller"
        )
    refuse_ends(system.robot, "a law that is written as a controller")
    for name, spring in system.springs.items():
        if spring.clutch is not None or spring.rest is not None:
            expected = "one that touchdown engages and lift-off releases, to write the law as a controller"
            raise BadValue(f"the spring {name!r}", spring, expected)


def record_samples(system: HybridSystem, state: State, samples: int = ALONG) -> list[Row]:
    """Returns samples of one cycle, on both sides of every event.

    Raises:
        BadValue: the cycle is not whole.
    """
    nv, rows, event = system.robot.nv, list[Row](), ""
    for segment in _cycle(system, state):
        flow, (begin, end) = flow_of(system, segment.domain, segment.held), _ends(segment)
        times = np.linspace(begin, end, samples if end > begin else 1)
        for t, x in zip(times, states_over(segment.pieces, 2 * nv)(times).T, strict=True):
            flow(t, np.concatenate([x, np.zeros(len(flow_names(system)))]))
            rows.append(Row(event, segment.began + t, x[:nv], x[nv:], np.array(flow.u)))
            event = ""
        ended = None if segment.ended is None else segment.ended.reset
        event = next((each.name for each in happenings(segment.domain) if each.reset is ended), event)
    return rows


def commands(system: HybridSystem, state: State, rate: float) -> list[Command]:
    """Returns what one cycle asks of the motors, at a rate in Hz from the beginning of the cycle.

    Raises:
        BadValue: the cycle is not whole.
    """
    robot = system.robot
    nv, found, times, unit = robot.nv, list[Command](), count(), np.eye(2 * robot.nv)
    motors, time = [robot.index(joint) for joint in robot.actuated], next(times) / rate
    for segment in _cycle(system, state):
        states, end = states_over(segment.pieces, 2 * nv), segment.began + _ends(segment)[1]
        while time < end:
            (x,) = states(np.array([time - segment.began])).T
            duals = [Dual(value, slope) for value, slope in zip(x.tolist(), unit, strict=True)]
            own = time - segment.began, duals[:nv], duals[nv:], segment.held
            u = motion(system, segment.domain.phase, *own, NUMBERS).u
            slopes = np.array([np.zeros(2 * nv) + derivative_of(torque) for torque in u])
            contacts = tuple(i in segment.domain.on_ground for i in range(len(robot.toes)))
            gains = 0.0 - slopes[:, motors], 0.0 - slopes[:, [nv + i for i in motors]]
            torques = np.array([value_of(torque) for torque in u])
            found.append(Command(time, x[motors], x[nv:][motors], torques, contacts, *gains))
            time = next(times) / rate
    return found


def _cycle(system: HybridSystem, state: State) -> list[Segment]:
    found = run(system, state, 1, Options(keep=True))
    if found.reason != "complete":
        raise BadValue("gait", found.message, "a gait whose cycle is whole")
    return found.segments


def _ends(segment: Segment) -> tuple[float, float]:
    return segment.pieces[0].begin, segment.pieces[-1].end
