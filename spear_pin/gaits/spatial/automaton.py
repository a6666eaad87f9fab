"""The automaton of a quadruped in space whose legs bear in pairs, leg by leg: a phase for each set of legs that bear.

Which legs make a pair is data: the posterior and the anterior ones bound, diagonal ones trot.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import product
from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_guards import OVERLOAD, knee_back, mount, overload
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.spatial.latches import bears, landing, lands, swings, trails, waits
from spear_pin.gaits.spatial.legs import FLIGHTS, YAW, Leg, Pair, Pairs
from spear_pin.gaits.spatial.torques import ADJUSTED, LegLaw, law_of
from spear_pin.gaits.virtual_constraints import progress
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK, WAYS, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, given
from spear_pin.hybrid.phases import contact_domains, fall, height, spring_switches
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.rules.guards import ON_GROUND, struck_together, touchdown
from spear_pin.hybrid.symmetry import mirror_of
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_in_space
from spear_pin.model.spring import PAIR_STIFFNESS, Spring

LONGEST = 2.0  # s: a phase of Q-SPEAR
CLEAR = 5e-3  # m: up to where a toe of Q-SPEAR that bears bounces, and has not lifted off (assumption)
OVERLAP = 0.010  # s: how long an impact of Q-SPEAR lasts (assumption; not in the source)


def in_pairs(
    kind: str,
    automaton: Automaton,
    law: Any,
    spring: Spring | None,
    contact: Contact | None,
    ground: Ground | None,
    *,
    build: Callable[..., HybridSystem],
    guess: Callable[[], State],
) -> HybridSystem:
    """The system of an automaton; spring, contact and ground as of `bounding_in_space`.

    Raises:
        BadValue: both contact and ground are given, the ground is not level at height zero, or the spring is never
            switched.
    """
    robot, scale = automaton.robot, scale_in_space(automaton.robot)
    spring = spring or Spring(PAIR_STIFFNESS / PAIR * scale.torque, damping=0.0)
    contact = given(contact, ground)
    if spring.rest is not None:
        raise BadValue("Spring.rest", spring.rest, "None: in space springs are switched")
    if not as_ground(contact).plain:
        raise BadValue("ground", contact, "level at height zero: in space there is no other yet")
    first, *second = (tuple(leg.toe for leg in pair) for pair in automaton.closing)
    return HybridSystem(
        kind=kind,
        robot=robot,
        law=law,
        spring=spring,
        contact=contact,
        domains=tuple(automaton.domains(spring)),
        section=automaton.sections[0],
        section_toes=first,
        mirrored_toes=second[0] if len(set(automaton.sections)) < len(automaton.sections) else (),
        cyclic=("torso_x", "torso_y", "yaw"),
        build=build,
        guess=guess,
        measures=MEASURES,
        phase_limit=LONGEST * scale.time,
        overlap=OVERLAP * scale.time,
    )


@dataclass(frozen=True)
class Automaton:
    """What its domains are made of.

    Attributes:
        robot: the robot.
        pairs: the legs that bear together.
        sections: names of the events just before the touchdown of the pairs in `closing`. The first closes a cycle; so
            does the second where it has the same name, half a stride being the other's mirror image.
        closing: one pair, or both, first the one that lands in the first flight.
        lift_off: as of the law, "knee" or "force".
    """

    robot: Robot
    pairs: Pairs
    sections: Sequence[str]
    closing: Sequence[Pair]
    lift_off: str

    @property
    def legs(self) -> tuple[Leg, ...]:
        """All four."""
        return *self.pairs[0], *self.pairs[1]

    def domains(self, spring: Spring) -> Iterator[Domain]:
        """Those of all sets of legs that bear; before a touchdown of a pair in `closing` there is one more.

        Args:
            spring: of each knee.
        """
        for down in product((True, False), repeat=len(self.legs)):
            bearing = tuple(leg for leg, bears in zip(self.legs, down, strict=True) if bears)
            for phase in [self.phase(bearing)] if bearing else FLIGHTS:
                closing = self._closed_by(phase, bearing)
                touchdowns = [self._touchdowns(pair, phase, bearing, pair is closing) for pair in self.pairs]
                yield from self._of_phase(phase, bearing, spring, [*touchdowns[0], *touchdowns[1]])
                if closing is not None:
                    pairs = closing, self._others(closing.legs[0])
                    touchdowns = [self._touchdowns(pair, phase, bearing, False) for pair in pairs]
                    yield from self._of_phase(_before(phase), bearing, spring, [*touchdowns[0], *touchdowns[1]])

    def phase(self, bearing: Sequence[Leg]) -> str:
        """Name of the phase in which some legs bear: of both of a pair "posterior_stance", of one "posterior_left"."""
        parts = []
        for pair in self.pairs:
            own = [leg for leg in pair if leg in bearing]
            parts += [pair.name] if len(own) == 2 else [leg.name for leg in own]
        return f"{'+'.join(parts)}_stance" if len(parts) > 1 or len(bearing) == 2 else parts[0]

    def _closed_by(self, phase: str, bearing: Sequence[Leg]) -> Pair | None:
        """The pair whose touchdown closes a cycle: one in the air that is not just back, while no other such is."""
        for pair in self.closing:
            if phase != pair.flight and not set(bearing) & set(pair):
                return pair
        return None

    def _of_phase(
        self, phase: str, bearing: tuple[Leg, ...], spring: Spring, touchdowns: list[Guard]
    ) -> tuple[Domain, ...]:
        airborne = [(leg, self._others(leg)) for leg in self.legs if leg not in bearing]
        mounts = tuple(mount(leg, spring) for leg in bearing)
        switches = [
            guard for mount, leg in zip(mounts, bearing, strict=True) for guard in spring_switches(mount, leg.knee)
        ]
        ends = [_passing(leg, others) for leg, others in airborne]
        fallen = fall([joint for leg in self.legs for joint in (leg.above, leg.joint)])
        domain = Domain(
            name=phase,
            phase=phase,
            contacts=tuple(STICK if toe in {leg.toe for leg in bearing} else OPEN for toe in self.robot.toes),
            law=law_of(bearing, airborne),
            mounts=mounts,
            guards=(*touchdowns, *switches, *ends, self._overload, *fallen),
        )
        if not bearing:
            return (domain,)
        resets = {leg.toe: self._lifts(leg, bearing) for leg in bearing}
        backs = [guard for leg in bearing for guard in knee_back(leg, resets[leg.toe])]
        if self.lift_off != "knee":
            return contact_domains(domain, self.robot.toes, resets, (), WAYS[3])
        clear = CLEAR * scale_in_space(self.robot).length
        return contact_domains(domain, self.robot.toes, resets, tuple(backs), WAYS[3], clear=clear)

    # touchdown

    def _touchdowns(self, pair: Pair, phase: str, bearing: tuple[Leg, ...], closes: bool) -> list[Guard]:
        """Those of a pair's legs in the air."""
        if closes:
            return self._closing(pair, phase)
        back = phase == pair.flight
        guards: list[Guard] = []
        for leg in pair:
            if leg not in bearing:
                reset = self._touches(leg, bearing, not back and not set(pair) & set(bearing))
                event = f"{leg.name}_{'return' if back else 'touchdown'}"
                guards += [struck_together(leg.toe, event, reset), touchdown(leg.toe, reset, event)]
        return guards

    def _closing(self, pair: Pair, phase: str) -> list[Guard]:
        """Just before a pair's touchdown: from there on all depends on (q, v) alone."""
        others, halfway = self._others(pair.legs[0]), pair is not self.closing[0]
        mirror = mirror_of(self.robot)

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: LegLaw) -> Held:
            waiting = {name: each for leg in pair for name, each in waits(leg, others, q, p).items()}
            seen: Any = (mirror(np.array(q)), mirror(np.array(v))) if halfway else (q, v)
            return waiting | {ADJUSTED: (p.adjustment_halfway if halfway else p.adjustment)(*seen)}

        reset = Reset(latch=latch, phase=_before(phase))
        return [Guard(self.sections[halfway], height(leg.toe), reset, tolerance=ON_GROUND) for leg in pair]

    def _touches(self, leg: Leg, bearing: tuple[Leg, ...], anew: bool) -> Reset:
        own, others = self._own(leg), self._others(leg)
        swinging = [other for other in others if other not in bearing]

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: LegLaw) -> Held:
            latched = bears(leg, own, q, v, held, p, anew)
            for other in swinging:
                latched |= swings(other, own, q, v, {**held, **latched}, p)
            return latched

        return Reset(impact=(leg.toe,), latch=latch, phase=self.phase(self._with(bearing, leg)))

    # lift-off

    def _lifts(self, leg: Leg, bearing: tuple[Leg, ...]) -> Reset:
        own, others = self._own(leg), self._others(leg)
        left = tuple(each for each in bearing if each != leg)
        supported = bool(set(left) & set(others))
        last = not set(left) & set(own)
        aloft = [other for other in others if other not in left]

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: LegLaw) -> Held:
            latched = swings(leg, others, q, v, held, p) if supported else trails(leg, own, others, q, v, held, p)
            for other in own:
                if other != leg and other not in left and f"{other.name}_alpha" not in held:  # where a run begins
                    latched |= trails(other, own, others, q, v, held, p)
            for other in landing(aloft, held) if last else ():
                latched |= lands(other, own, q, v, held, p)
            return latched

        phase = self.phase(left) if left else own.flight
        return Reset(release=(leg.joint,), latch=latch, phase=phase)

    @cached_property
    def _overload(self) -> Guard:
        return overload(OVERLOAD * scale_in_space(self.robot).torque)

    def _own(self, leg: Leg) -> Pair:
        return self.pairs[0] if leg in self.pairs[0] else self.pairs[1]

    def _others(self, leg: Leg) -> Pair:
        return self.pairs[1] if leg in self.pairs[0] else self.pairs[0]

    def _with(self, bearing: Sequence[Leg], leg: Leg) -> list[Leg]:
        return [each for each in self.legs if each in bearing or each == leg]


def _before(phase: str) -> str:
    """Name of the phase that a stride begins with, which the touchdown ends at once."""
    return f"{phase}_ends"


def _passing(leg: Leg, others: Pair) -> Guard:
    """A leg's phase variable passes 1, either way."""
    past = f"{leg.name}_past"

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        outputs = leg.outputs(others, held[f"{leg.name}_weights"])
        return (1.0 - 2.0 * held[past]) * (1.0 - progress(outputs, leg.evolution(held), q, ops))

    return Guard("end_of_constraint", value, Reset(latch=lambda q, v, held, p: {past: 1.0 - held[past]}))


def _forward(run: Run) -> float:
    yaw = run.start[0][YAW]
    dx, dy = run.state[0][:2] - run.start[0][:2]
    return float(math.cos(yaw) * dx + math.sin(yaw) * dy)


MEASURES: Mapping[str, Any] = {
    "mean_speed": lambda run: _forward(run) / sum(run.durations.values()),
    "period": lambda run: sum(run.durations.values()),
    "stride": _forward,
    "turn": lambda run: float(run.state[0][YAW] - run.start[0][YAW]),
}
