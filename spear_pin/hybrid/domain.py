"""Parts of an automaton, as data: domains, guards, resets. Engines assemble right-hand sides from them.

Control laws and guards share one signature, `f(t, q, v, held, p, dyn, ops)`.

Args:
    t: time since the phase began, in s.
    q, v: configuration and velocity, sequences of scalars.
    held: values latched at events, by name: numbers, or tuples of numbers.
    p: the law's parameters, a frozen dataclass.
    dyn: the dynamics at (q, v), see `spear_pin.hybrid.dynamics.Dynamics`; vectors at toes have components along the
        ground and normal to it.
    ops: elementary functions for the scalars in use, see `spear_pin.hybrid.dynamics.Operations`.

Laws and guards are pure and never branch on a value: every switch is a change of domain or of a held value.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, reduce
from operator import and_
from typing import Any, NamedTuple

from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.model.path import Joints, Path
from spear_pin.model.spring import Spring

Held = Mapping[str, Any]
Law = Callable[[Any, Any, Any, Held, Any, Dynamics, Operations], Sequence[Any]]
GuardValue = Callable[[Any, Any, Any, Held, Any, Dynamics, Operations], Any]
Latch = Callable[[Sequence[float], Sequence[float], Held, Any], Held]
Jump = Callable[[Any, Any, Held, Any, Operations], tuple[Sequence[Any], Sequence[Any]]]


@dataclass(frozen=True)
class Mount:
    """A spring on a path, while the spring is engaged.

    Attributes:
        name: name of the mount, of which a domain has one only.
        spring: the spring's law.
        rest: length of the path at which the spring rests, or name in `held` of the values at which it rests: those of
            the coordinates on which the path's length depends, a tuple if they are several.
        taut: name in `held` of a value that is 1 while the spring pulls and 0 while it is slack; None if it pulls and
            pushes.
        path: the path, which grows as the spring is stretched; None for the joint of the mount's name.
        of: name of the system's spring whose numbers it has; none means the first.
        on: name in `held` of a value that is 1 while the spring is engaged and 0 while it is not; None if it always is.
        tooth: name in `held` of the number of the tooth in which it rests, of a switch with teeth.
        slips: name in `held` of two values, of a switch whose clutch slips: 1 while it slips, else 0, and 1 if it has
            slipped since the spring was engaged, else 0.
        way: name in `held` of the sign of the path's rate, of a spring with hysteresis.
    """

    name: str
    spring: Spring
    rest: str | float
    taut: str | None = None
    path: Path | None = None
    of: str = ""
    on: str | None = None
    tooth: str | None = None
    slips: str | None = None
    way: str | None = None

    @cached_property
    def along(self) -> Path:
        """The path."""
        return Joints({self.name: 1.0}) if self.path is None else self.path

    def slipping(self, held: Held) -> Any:
        """Returns 1 while its clutch slips, else 0."""
        return 0.0 if self.slips is None else held[self.slips][0]

    def stretch(self, spring: Spring, length: Any, rest: Any, held: Held) -> Any:
        """Returns how much longer the path is than at rest, in rad or m; while the clutch slips this does not change.

        Args:
            spring: the spring's law, with scalars of any kind.
            length: length of the path.
            rest: its length at rest.
            held: held values.
        """
        if self.slips is None:
            return length - rest
        slipping = self.slipping(held)
        return slipping * spring.at_slip + (1.0 - slipping) * (length - rest)

    def pull(self, spring: Spring, stretch: Any, held: Held, ops: Any) -> Any:
        """Returns the force along the path, without the damper's, in N, or N·m on a path of angles.

        Args:
            spring: the spring's law, with scalars of any kind.
            stretch: how much longer the path is than at rest.
            held: held values.
            ops: elementary functions.
        """
        return self._if_acting(spring.torque(stretch, ops), held)

    def lost(self, spring: Spring, force: Any, held: Held, ops: Any) -> Any:
        """Returns what hysteresis adds to the force along the path; a unilateral spring then pulls at least with 0.

        Args:
            spring: the spring's law, with scalars of any kind.
            force: its `pull`.
            held: held values.
            ops: elementary functions.
        """
        if self.way is None:
            return 0.0
        against = held[self.way] * spring.hysteresis
        return -self._if_acting(ops.maximum(against, force) if spring.unilateral else against, held)

    def drag(self, spring: Spring, rate: Any, held: Held) -> Any:
        """Returns the damper's force along the path, for scalars of any kind."""
        return spring.drag(rate) if self.on is None else held[self.on] * spring.drag(rate)

    def idle(self, spring: Spring, length: Any, held: Held) -> Any:
        """Returns the force along the path of the chain while its switch is open: both springs in series."""
        clutch: Any = spring.clutch
        if self.on is None or not spring.chained:
            return 0.0
        return -(1.0 - held[self.on]) * spring.in_series * (length - clutch.slack)

    def energy(self, length: Any, rest: Any, held: Held) -> Any:
        """Returns the energy that the spring stores where its path has a length, in J."""
        energy = self._if_acting(self.spring.energy(self.stretch(self.spring, length, rest, held)), held)
        clutch: Any = self.spring.clutch
        if self.on is None or not self.spring.chained:
            return energy
        both, bridged = (length - clutch.slack) ** 2 * self.spring.in_series, (rest - clutch.slack) ** 2 * clutch.second
        return energy + 0.5 * ((1.0 - held[self.on]) * both + held[self.on] * bridged)

    def _if_acting(self, value: Any, held: Held) -> Any:
        value = value if self.taut is None else held[self.taut] * value
        return value if self.on is None else held[self.on] * value


TOUCHES, LEAVES, ENGAGES, RELEASES, ACTS = "touches", "leaves", "engages", "releases", "acts"
HOLDS, KEEPS, SLIPS, GRIPS = "holds", "keeps", "slips", "grips"
DUE = "due:"  # begins the names of held times, on the phase's clock


class Edge(NamedTuple):
    """What happens to a spring's switch.

    Attributes:
        kind: `TOUCHES` or `LEAVES`, after which the switch acts late; `ENGAGES` or `RELEASES` at once; `HOLDS`, which
            engages at once and releases after a time; `KEEPS`, which leaves it as it is, open if that is not known
            yet; `ACTS`; `SLIPS` or `GRIPS`, for its clutch.
        mount: the spring.
    """

    kind: str
    mount: Mount


class Turn(NamedTuple):
    """What happens to a brake that opens and closes within phases.

    Attributes:
        brake: its name.
        closed: whether it is closed from now on.
        waits: whether it is to close later, after its delay.
    """

    brake: str
    closed: bool = False
    waits: bool = False


@dataclass(frozen=True)
class Rub:
    """Dry friction of a joint, or of a path over joints, in one mode of its motion.

    Attributes:
        joint: the coordinate, or the name of the path.
        force: Coulomb's force, in N or N·m.
        sign: sign of the rate, +1 or -1; 0 where the joint is held at rest.
        path: the path; None for the joint.
    """

    joint: str
    force: float
    sign: float
    path: Joints | None = None

    @cached_property
    def along(self) -> Joints:
        """The path."""
        return Joints({self.joint: 1.0}) if self.path is None else self.path


@dataclass(frozen=True)
class Reset:
    """Effects of an event on the state, in this order.

    Attributes:
        impact: toes that strike the ground, plastically.
        release: names of engaged springs that release; the energy that they still store is lost.
        latch: function that returns newly held values, from (q, v, held, p) after the impact.
        phase: the phase entered; None stays in the present phase, whose clock continues.
        stop: toes in space whose sliding has almost ended, and is stopped.
        adjust: function like `latch`, called before it where a cycle begins, that returns what is added to numbers of
            the law from then on, each held by its name after `fields.ADDED`.
        edges: what happens to switches of springs, before the latch.
        jump: function of (q, v, held, p, ops) that returns the state (q, v) after it. It acts after the impact and
            before the latch, and its change of energy counts as the impact's.
        grips: paths over joints that brakes bring to rest, plastically and together with toes that strike.
        turns: what happens to brakes, before the latch.
    """

    impact: tuple[str, ...] = ()
    release: tuple[str, ...] = ()
    latch: Latch | None = None
    phase: str | None = None
    stop: tuple[str, ...] = ()
    adjust: Latch | None = None
    edges: tuple[Edge, ...] = ()
    jump: Jump | None = None
    grips: tuple[Joints, ...] = ()
    turns: tuple[Turn, ...] = ()

    @property
    def holds(self) -> bool:
        """Tells whether it changes held values."""
        return self.latch is not None or bool(self.edges or self.turns)


@dataclass(frozen=True)
class Guard:
    """An event that happens when `value` falls through zero.

    If it leads back into its own phase, its latch has to make `value` positive; else it happens again at once.

    Attributes:
        name: name of the event.
        value: the watched function.
        reset: effect of the event; None with no `ends` only records the event.
        ends: reason for which the run ends at the event, if it does.
        tolerance: values this close to zero count as zero when a domain is entered.
        patience: how far `value` may fall before it is an event, if it is zero or less when a domain is entered.
    """

    name: str
    value: GuardValue
    reset: Reset | None = None
    ends: str | None = None
    tolerance: float = 1e-9
    patience: float = 0.0

    @property
    def waits(self) -> bool:
        """Tells whether the guard may be on zero without an event when the domain is entered."""
        return self.patience > 0.0 or self.observes

    @property
    def observes(self) -> bool:
        """Tells whether the event is only recorded."""
        return self.reset is None and self.ends is None

    @property
    def leaves(self) -> bool:
        """Tells whether the event ends the phase."""
        return self.ends is not None or (self.reset is not None and self.reset.phase is not None)


@dataclass(frozen=True)
class Switch:
    """A scheduled event: the n-th happens `time(n, p)` after the phase began, n = 1, 2, ...

    Attributes:
        name: name of the event.
        time: the schedule, increasing in n; infinite if there is no further event.
        reset: effect of the event.
    """

    name: str
    time: Callable[[int, Any], float]
    reset: Reset


@dataclass(frozen=True)
class Domain:
    """One mode of continuous motion.

    Attributes:
        name: its name.
        phase: the phase to which it belongs; phases have clocks and durations, and slip is part of stance.
        contacts: for each toe of the robot, "open", "stick", "slip+" or "slip-", in space "slip", or "pinned", which
            keeps the toe at rest under any force.
        law: motor torques, one per actuated joint.
        mounts: the springs that are engaged.
        rubs: dry friction of joints, see `spear_pin.hybrid.dry_friction`.
        guards: the events that can happen; the first wins a tie.
        switch: the scheduled event, if there is one.
        between: the two domains, for motion on the switching surface between them.
        crossing: the two switching surfaces, for motion on both at once.
        bouncing: toes of bearing legs that leave the ground and strike it again within the phase.
        brakes: held value of each brake that opens and closes within the phase, and whether it is closed here.
    """

    name: str
    phase: str
    contacts: tuple[str, ...]
    law: Law
    mounts: tuple[Mount, ...] = ()
    rubs: tuple[Rub, ...] = ()
    guards: tuple[Guard, ...] = ()
    switch: Switch | None = None
    between: Alternation | None = None
    crossing: Crossing | None = None
    bouncing: tuple[str, ...] = ()
    brakes: tuple[tuple[str, bool], ...] = ()

    def suits(self, held: Held) -> Any:
        """Tells whether brakes are open and closed in it as they are, in each lane where these differ."""
        return reduce(and_, ((held.get(name, 0.0) != 0.0) == closed for name, closed in self.brakes), True)

    @property
    def key(self) -> tuple[Any, ...]:
        """Phase, name and modes of friction, by which a system with other numbers has the same domain."""
        return self.phase, self.name, *((rub.joint, rub.sign) for rub in self.rubs)

    @property
    def alternating(self) -> tuple[str, ...]:
        """The toes that stay on the ground while their domains alternate."""
        if self.crossing is not None:
            return self.crossing.toes
        return () if self.between is None else (self.between.toe,)

    @cached_property
    def on_ground(self) -> list[int]:
        """Indices of the toes on the ground, with or without force on them."""
        also = (self._touching or self).contacts
        modes = enumerate(zip(self.contacts, also, strict=True))
        return [i for i, pair in modes if pair != (OPEN, OPEN)]

    @property
    def spent_in(self) -> str:
        """The phase to which its time counts; while two phases alternate the toe is on the ground, not in flight."""
        return (self._touching or self).phase

    @property
    def _touching(self) -> Domain | None:
        """The alternating domain with all toes on the ground."""
        if self.crossing is not None:
            return self.crossing.surfaces[0][1].grounded
        return None if self.between is None else self.between.grounded


@dataclass(frozen=True)
class Alternation:
    """Two domains that alternate infinitely fast, because each drives the toe into the other.

    Attributes:
        grounded: the domain with the toe on the ground, whose law unloads the toe.
        airborne: the domain with the toe in the air, whose law presses it down.
        touch: the reset into `grounded`.
        leave: the reset into `airborne`.
        toe: the toe.
        follow: resets of `grounded` that happen immediately after `touch`, such as the limit on a torque.
    """

    grounded: Domain
    airborne: Domain
    touch: Reset
    leave: Reset
    toe: str
    follow: tuple[Reset, ...] = ()

    @property
    def touching(self) -> tuple[Reset, ...]:
        """All resets that happen at a touch."""
        return self.touch, *self.follow


@dataclass(frozen=True)
class Crossing:
    """Two toes that alternate infinitely fast, each by itself.

    Attributes:
        toes: the two toes.
        surfaces: alternations of each toe, while the other toe is in the air and while it is on the ground.
    """

    toes: tuple[str, str]
    surfaces: tuple[tuple[Alternation, Alternation], tuple[Alternation, Alternation]]
