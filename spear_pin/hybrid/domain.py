"""Parts of an automaton, as data: domains, guards, resets. Engines assemble right-hand sides from it.

Control laws and guards share one signature, `f(t, q, v, held, p, dyn, ops)`.

Args:
    t: time since the phase began, in s.
    q, v: configuration and velocity, sequences of scalars.
    held: what was latched at events, by name: numbers, or tuples of numbers.
    p: the law's parameters, a frozen dataclass.
    dyn: the dynamics at (q, v), see `spear_pin.hybrid.dynamics.Dynamics`; what it says of toes is along the ground and
        normal to it.
    ops: elementary functions for whatever scalars are used, see `spear_pin.hybrid.dynamics.Operations`.

They are pure and never branch on a value: what switches is a domain or something held.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.model.spring import Spring

Held = Mapping[str, Any]
Law = Callable[[Any, Any, Any, Held, Any, Dynamics, Operations], Sequence[Any]]
GuardValue = Callable[[Any, Any, Any, Held, Any, Dynamics, Operations], Any]
Latch = Callable[[Sequence[float], Sequence[float], Held, Any], Held]


@dataclass(frozen=True)
class Mount:
    """A spring on a joint, while engaged.

    Attributes:
        joint: the joint it spans.
        spring: its law.
        rest: name in `held` of the latched angle.
        taut: name in `held` of 1 where it pulls and 0 where it is slack.
        side: +1 if flexion is positive, -1 if negative.
    """

    joint: str
    spring: Spring
    rest: str
    taut: str
    side: float = 1.0

    def torque(self, spring: Spring, angle: Any, held: Held, ops: Any) -> Any:
        """Torque on the joint at an angle, without the damper's, in N·m.

        Args:
            spring: its law, of whatever scalars.
            angle: of the joint, in rad.
            held: what is held.
            ops: elementary functions.
        """
        return held[self.taut] * (self.side * spring.torque(self._deflection(angle, held), ops))

    def energy(self, angle: Any, held: Held) -> Any:
        """Energy that its spring stores, in J."""
        return held[self.taut] * self.spring.energy(self._deflection(angle, held))

    def knots(self, held: Held) -> list[float]:
        """Angles of the joint at which the law of its spring has no second derivative, in rad."""
        return [held[self.rest] + self.side * knot for knot in self.spring.knots]

    def _deflection(self, angle: Any, held: Held) -> Any:
        return self.side * (angle - held[self.rest])


@dataclass(frozen=True)
class Rub:
    """Dry friction of a joint, in one mode of its motion.

    Attributes:
        joint: the coordinate.
        force: Coulomb's, in N or N·m.
        sign: of the rate, +1 or -1; 0 where the joint is held at rest.
    """

    joint: str
    force: float
    sign: float


@dataclass(frozen=True)
class Reset:
    """Effects of an event on the state, in this order.

    Attributes:
        impact: toes that strike the ground, plastically.
        release: engaged joints whose springs let go; what they still store is lost.
        latch: what is newly held, from (q, v, held, p) after the impact.
        phase: the phase entered; None stays in the present one, its clock running on.
        stop: toes in space whose sliding has all but ended, and ends.
    """

    impact: tuple[str, ...] = ()
    release: tuple[str, ...] = ()
    latch: Latch | None = None
    phase: str | None = None
    stop: tuple[str, ...] = ()


@dataclass(frozen=True)
class Guard:
    """An event, when `value` falls through zero.

    If it leads back into its own phase, what it latches has to make `value` positive, or it happens again at once.

    Attributes:
        name: name of the event.
        value: the function watched.
        reset: what happens; None with no `ends` only records the event.
        ends: reason for which the run ends here, if it does.
        tolerance: values this close to zero count as on the guard when a domain is entered.
        patience: how far `value` may fall, if it is zero or less where a domain is entered, before it is an event.
    """

    name: str
    value: GuardValue
    reset: Reset | None = None
    ends: str | None = None
    tolerance: float = 1e-9
    patience: float = 0.0

    @property
    def waits(self) -> bool:
        """Whether it is no event as the domain is entered."""
        return self.patience > 0.0 or self.observes

    @property
    def observes(self) -> bool:
        """Whether the event is only recorded."""
        return self.reset is None and self.ends is None

    @property
    def leaves(self) -> bool:
        """Whether the event ends the phase."""
        return self.ends is not None or (self.reset is not None and self.reset.phase is not None)


@dataclass(frozen=True)
class Switch:
    """A scheduled event: the n-th happens `time(n, p)` after the phase began, n = 1, 2, ...

    Attributes:
        name: name of the event.
        time: the schedule, increasing in n; infinite for no further one.
        reset: what happens.
    """

    name: str
    time: Callable[[int, Any], float]
    reset: Reset


@dataclass(frozen=True)
class Domain:
    """One mode of continuous motion.

    Attributes:
        name: its name.
        phase: the phase it belongs to; phases have clocks and durations, slip being part of stance.
        contacts: for each toe of the robot, "open", "stick", "slip+" or "slip-", in space "slip", or "pinned": at rest
            whatever it takes.
        law: motor torques, one per actuated joint.
        mounts: the springs that are engaged.
        rubs: dry friction of joints, see `spear_pin.hybrid.dry_friction`.
        guards: the events that can happen, the first winning a tie.
        switch: the scheduled event, if there is one.
        between: for motion on the switching surface between two domains, those two.
        crossing: for motion on two switching surfaces at once, those two.
        bouncing: toes of legs that bear, which leave the ground and strike it again within the phase.
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
        """The phase to which its time counts: while two phases alternate the toe is on the ground, it does not fly."""
        return (self._touching or self).phase

    @property
    def _touching(self) -> Domain | None:
        """Of domains that alternate the one with all toes on the ground."""
        if self.crossing is not None:
            return self.crossing.surfaces[0][1].grounded
        return None if self.between is None else self.between.grounded


@dataclass(frozen=True)
class Alternation:
    """Two domains that alternate infinitely fast, because each drives the toe into the other.

    Attributes:
        grounded: the one with the toe on the ground, whose law unloads it.
        airborne: the one with the toe in the air, whose law presses it down.
        touch: the reset into `grounded`.
        leave: the reset into `airborne`.
        toe: the toe.
        follow: resets of `grounded` that happen at once after `touch`, such as the limit on a torque.
    """

    grounded: Domain
    airborne: Domain
    touch: Reset
    leave: Reset
    toe: str
    follow: tuple[Reset, ...] = ()

    @property
    def touching(self) -> tuple[Reset, ...]:
        """All that happens at a touch."""
        return self.touch, *self.follow


@dataclass(frozen=True)
class Crossing:
    """Two toes that alternate infinitely fast, each by itself.

    Attributes:
        toes: the two.
        surfaces: of each, its alternation while the other is in the air, and while the other is on the ground.
    """

    toes: tuple[str, str]
    surfaces: tuple[tuple[Alternation, Alternation], tuple[Alternation, Alternation]]
