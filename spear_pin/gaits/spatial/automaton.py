"""Automaton of a quadruped in space whose legs land in groups: one phase for each set of legs on the ground.

Which legs make a group is data: the posterior and the anterior pair for a bound, diagonal pairs for a trot, all four
legs for a pronk.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from itertools import product
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_guards import knee_back, overload
from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.legs import Leg
from spear_pin.gaits.spatial.latches import bears, find_landing_legs, flies, swings, waits
from spear_pin.gaits.spatial.legs import YAW, Group, Groups
from spear_pin.gaits.spatial.torques import LegLaw, law_of, nominal_start
from spear_pin.gaits.springing import Springing, springing_in_space
from spear_pin.gaits.virtual_constraints import progress
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK, WAYS, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, choose_ground
from spear_pin.hybrid.phases import contact_domains, fall, height
from spear_pin.hybrid.result import Run, State
from spear_pin.hybrid.rules.guards import ON_GROUND, struck_together, touchdown
from spear_pin.hybrid.symmetry import X, Y
from spear_pin.model.robot import Robot
from spear_pin.model.scale import scale_in_space
from spear_pin.model.spring import PAIR_STIFFNESS, Spring
from spear_pin.model.springs import Springs, springs_by_name

LONGEST = 2.0  # s: a phase of Q-SPEAR
CLEAR = 5e-3  # m: a standing toe of Q-SPEAR that rises less has not lifted off (assumption)
OVERLAP = 0.010  # s: how long an impact of Q-SPEAR lasts (assumption; not in the source)


def in_groups(
    kind: str,
    automaton: Automaton,
    law: Any,
    spring: Spring | Mapping[str, Spring] | None,
    contact: Contact | None,
    ground: Ground | None,
    *,
    build: Callable[..., HybridSystem],
    guess: Callable[[], State] | None = None,
) -> HybridSystem:
    """Returns the system of an automaton; see `bounding_in_space` for spring, contact and ground.

    Args:
        kind: the system's kind.
        automaton: the automaton.
        law: parameters of the controller.
        spring: the knee spring of one leg, or several by name.
        contact: friction of level ground.
        ground: the ground, instead of `contact`.
        build: returns such a system for a robot, a law, a spring and a contact.
        guess: returns a section state to start from; by default the one that the law holds.

    Raises:
        BadValue: both contact and ground are given, the ground is not level at height zero, or the spring never
            releases.
    """
    robot, scale = automaton.robot, scale_in_space(automaton.robot)
    usual = Spring(PAIR_STIFFNESS / PAIR * scale.torque, damping=0.0)
    springs = springs_by_name(usual if spring is None else spring, "knee")
    contact = choose_ground(contact, ground)
    for each in springs.values():
        if each.rest is not None:
            raise BadValue("Spring.rest", each.rest, "None: in space springs are latched at touchdown")
    if not as_ground(contact).plain:
        raise BadValue("ground", contact, "level at height zero: in space there is no other yet")
    first, *second = (tuple(leg.toe for leg in group) for group in automaton.closing)
    mirrored = len(set(automaton.sections)) < len(automaton.sections)
    return HybridSystem(
        kind=kind,
        robot=robot,
        law=law,
        springs=springs,
        contact=contact,
        domains=tuple(automaton.domains(springs)),
        section=automaton.sections[0],
        section_toes=first,
        mirrored_toes=second[0] if mirrored else (),
        cyclic=("torso_x", "torso_y", "yaw"),
        build=build,
        guess=guess or (lambda: nominal_start(robot, law, automaton.closing[0])),
        measures=OF_HALVES if mirrored else MEASURES,
        phase_limit=LONGEST * scale.time,
        overlap=OVERLAP * scale.time,
        sprung=True,
    )


@dataclass(frozen=True)
class Automaton:
    """Data from which the domains are made.

    Attributes:
        robot: the robot.
        groups: the legs that are on the ground together, in the order in which they land.
        sections: names of the events just before the touchdown of the groups in `closing`. The first event closes a
            cycle. A second one with the same name closes a cycle too: half a stride is then the mirror image of the
            other half.
        closing: one group, or both; the first is the group that lands in the first flight.
        lift_off: rule for lift-off in the law, "knee" or "force".
    """

    robot: Robot
    groups: Groups
    sections: Sequence[str]
    closing: Sequence[Group]
    lift_off: str

    @property
    def legs(self) -> tuple[Leg, ...]:
        """All four legs."""
        return tuple(leg for group in self.groups for leg in group)

    def domains(self, springs: Springs) -> Iterator[Domain]:
        """Returns the domains of all sets of legs, and one more before each touchdown of a group in `closing`.

        Args:
            springs: the springs of each leg.
        """
        springing = {leg: springing_in_space(self.robot, springs, leg) for leg in self.legs}
        for down in product((True, False), repeat=len(self.legs)):
            bearing = tuple(leg for leg, bears in zip(self.legs, down, strict=True) if bears)
            for phase in [self.phase(bearing)] if bearing else [group.flight for group in self.groups]:
                closing = self._closed_by(phase, bearing)
                touchdowns = self._touchdowns(self.groups, phase, bearing, closing, springing)
                yield from self._of_phase(phase, bearing, springing, touchdowns)
                if closing is not None:
                    order = sorted(self.groups, key=lambda group: group is not closing)
                    touchdowns = self._touchdowns(order, phase, bearing, None, springing)
                    yield from self._of_phase(_before(phase), bearing, springing, touchdowns)

    def phase(self, bearing: Sequence[Leg]) -> str:
        """Returns the name of the phase with some legs on the ground: "posterior_stance", or "posterior_left"."""
        parts = []
        for group in self.groups:
            own = [leg for leg in group if leg in bearing]
            parts += [group.name] if len(own) == len(group.legs) else [leg.name for leg in own]
        return f"{'+'.join(parts)}_stance" if len(bearing) > 1 else parts[0]

    def _closed_by(self, phase: str, bearing: Sequence[Leg]) -> Group | None:
        """Returns the group whose touchdown closes a cycle: the only one in the air that has not just lifted off."""
        for group in self.closing:
            if not self._back(group, phase) and not set(bearing) & set(group):
                return group
        return None

    def _back(self, group: Group, phase: str) -> bool:
        """Tells whether landing legs of a group are just back: the group stood last, and another group is next."""
        return phase == group.flight and self._next(group) is not group

    def _of_phase(
        self, phase: str, bearing: tuple[Leg, ...], springing: Mapping[Leg, Springing], touchdowns: list[Guard]
    ) -> tuple[Domain, ...]:
        airborne = [(leg, self._others(self._own(leg))) for leg in self.legs if leg not in bearing]
        own = [springing[leg] for leg in bearing]
        mounts = tuple(mount for each in own for mount in each.standing)
        switches = [guard for each in own for guard in each.switches(each.standing)]
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
        resets = {leg.toe: self._lifts(leg, bearing, springing[leg].released) for leg in bearing}
        backs = [guard for leg in bearing for guard in knee_back(leg, resets[leg.toe])]
        if self.lift_off != "knee":
            return contact_domains(domain, self.robot.toes, resets, (), WAYS[3])
        clear = CLEAR * scale_in_space(self.robot).length
        return contact_domains(domain, self.robot.toes, resets, tuple(backs), WAYS[3], clear=clear)

    # touchdown

    def _touchdowns(
        self,
        groups: Sequence[Group],
        phase: str,
        bearing: tuple[Leg, ...],
        closing: Group | None,
        springing: Mapping[Leg, Springing],
    ) -> list[Guard]:
        """Returns touchdowns of legs in the air, by group; those of a closing group lead to just before it."""
        guards: list[Guard] = []
        for group in groups:
            if group is closing:
                guards += self._closing(group, phase)
                continue
            back = self._back(group, phase)
            for leg in group:
                if leg not in bearing:
                    anew = not back and not set(group) & set(bearing)
                    reset = self._touches(leg, bearing, anew, springing[leg])
                    event = f"{leg.name}_{'return' if back else 'touchdown'}"
                    guards += [struck_together(leg.toe, event, reset), touchdown(leg.toe, reset, event)]
        return guards

    def _closing(self, group: Group, phase: str) -> list[Guard]:
        """Returns the event just before a group's touchdown; from there on all depends on (q, v) alone."""
        last = self.groups[self.groups.index(group) - 1]
        others, halfway = self._others(group), group is not self.closing[0]

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: LegLaw) -> Held:
            return {name: each for leg in group for name, each in waits(leg, last, others, q, p).items()}

        reset = Reset(latch=latch, phase=_before(phase))
        return [Guard(self.sections[halfway], height(leg.toe), reset, tolerance=ON_GROUND) for leg in group]

    def _touches(self, leg: Leg, bearing: tuple[Leg, ...], anew: bool, springing: Springing) -> Reset:
        own = self._own(leg)
        swinging = [other for other in self._others(own) if other not in bearing]

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: LegLaw) -> Held:
            latched = {**springing.engage(q, held), **bears(leg, own, q, v, p, anew)}
            for other in swinging:
                latched |= swings(other, own, q, v, {**held, **latched}, p)
            return latched

        return Reset(impact=(leg.toe,), latch=latch, phase=self.phase(self._with(bearing, leg)))

    # lift-off

    def _lifts(self, leg: Leg, bearing: tuple[Leg, ...], released: tuple[str, ...]) -> Reset:
        own = self._own(leg)
        follows, others = self._next(own), self._others(own)
        left = tuple(each for each in bearing if each != leg)
        supported = bool(set(left) & set(others))
        last = not set(left) & set(own)
        aloft = [other for other in others if other not in left]
        leaves = partial(flies, lands=follows is own)

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: LegLaw) -> Held:
            latched = swings(leg, follows, q, v, held, p) if supported else leaves(leg, own, others, q, v, p)
            for other in own:
                if other != leg and other not in left and f"{other.name}_alpha" not in held:  # where a run begins
                    latched |= leaves(other, own, others, q, v, p)
            for other in find_landing_legs(aloft, held) if last else ():
                latched |= flies(other, own, own.legs, q, v, p, lands=True)
            return latched

        phase = self.phase(left) if left else own.flight
        return Reset(release=released, latch=latch, phase=phase)

    @cached_property
    def _overload(self) -> Guard:
        return overload(scale_in_space(self.robot).torque, share=True)

    def _own(self, leg: Leg) -> Group:
        return next(group for group in self.groups if leg in group)

    def _next(self, group: Group) -> Group:
        """Returns the group that lands after a group; a single group follows itself."""
        return self.groups[(self.groups.index(group) + 1) % len(self.groups)]

    def _others(self, group: Group) -> tuple[Leg, ...]:
        """Returns the legs that are not in a group."""
        return tuple(leg for leg in self.legs if leg not in group)

    def _with(self, bearing: Sequence[Leg], leg: Leg) -> list[Leg]:
        return [each for each in self.legs if each in bearing or each == leg]


def _before(phase: str) -> str:
    """Returns the name of the phase with which a stride begins, and which the touchdown ends at once."""
    return f"{phase}_ends"


def _passing(leg: Leg, others: Sequence[Leg]) -> Guard:
    """Returns guards for a leg's phase variable passing 1, either way."""
    past = f"{leg.name}_past"

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        outputs = leg.outputs(others, held[f"{leg.name}_weights"])
        return (1.0 - 2.0 * held[past]) * (1.0 - progress(outputs, leg.evolution(held), q, ops))

    return Guard("end_of_constraint", value, Reset(latch=lambda q, v, held, p: {past: 1.0 - held[past]}))


def forward_speed(run: Run) -> float:
    """Returns the mean speed of a cycle along the heading with which it begins, in m/s."""
    return float(speed_ahead(run.start[0], run.state[0], sum(run.durations.values())))


def speed_ahead(begin: Array, end: Any, period: Any) -> Any:
    """Returns the mean speed along the first heading, in m/s.

    Args:
        begin: configuration at the beginning, (nq,).
        end: configuration at the end, of any scalars; the state may follow it.
        period: the time between them, in s, of the same scalars.
    """
    yaw = begin[YAW]
    return (math.cos(yaw) * (end[X] - begin[X]) + math.sin(yaw) * (end[Y] - begin[Y])) / period


def _stride(run: Run) -> float:
    return float(np.linalg.norm(run.state[0][:2] - run.start[0][:2]))


MEASURES: Mapping[str, Any] = {
    "mean_speed": lambda run: _stride(run) / sum(run.durations.values()),
    "period": lambda run: sum(run.durations.values()),
    "stride": _stride,
    "turn": lambda run: float(run.state[0][YAW] - run.start[0][YAW]),
}
OF_HALVES: Mapping[str, Any] = {
    **MEASURES,
    "mean_speed": forward_speed,
    "stride": lambda run: forward_speed(run) * sum(run.durations.values()),
}
"""Of cycles that are half a stride: what they go aside, the other half undoes."""
