"""The hybrid automaton as data: domains, guards, resets. Engines assemble right-hand sides from it.

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
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, Any

from spear_pin.errors import UnknownName
from spear_pin.hybrid.contact import OPEN as OPEN
from spear_pin.hybrid.contact import SLIP_BACKWARD as SLIP_BACKWARD
from spear_pin.hybrid.contact import SLIP_FORWARD as SLIP_FORWARD
from spear_pin.hybrid.contact import STICK as STICK
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground
from spear_pin.hybrid.soundness import check
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

if TYPE_CHECKING:
    from spear_pin.hybrid.hardware import Hardware

Held = Mapping[str, Any]
Law = Callable[[Any, Any, Any, Held, Any, Dynamics, Operations], Sequence[Any]]
GuardValue = Callable[[Any, Any, Any, Held, Any, Dynamics, Operations], Any]
Latch = Callable[[Sequence[float], Sequence[float], Held, Any], Held]
REPLACED = ("kind", "domains", "section", "cyclic", "measures", "guess", "phase_limit", "shortest_flight", "hardware")
SHORTEST_FLIGHT = 0.05  # s: in free fall a rise of 3 mm, a two-hundredth of a leg of 0.6 m


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
    """

    impact: tuple[str, ...] = ()
    release: tuple[str, ...] = ()
    latch: Latch | None = None
    phase: str | None = None


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
    """

    name: str
    value: GuardValue
    reset: Reset | None = None
    ends: str | None = None
    tolerance: float = 1e-9

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
        contacts: for each toe of the robot, "open", "stick", "slip+", "slip-", or "pinned": at rest whatever it takes.
        law: motor torques, one per actuated joint.
        mounts: the springs that are engaged.
        rubs: dry friction of joints, see `spear_pin.hybrid.dry_friction`.
        guards: the events that can happen, the first winning a tie.
        switch: the scheduled event, if there is one.
        between: for motion on the switching surface between two domains, those two.
        crossing: for motion on two switching surfaces at once, those two.
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


@dataclass(frozen=True)
class HybridSystem:
    """A robot, its domains, and the numbers in them; what does not fit together is refused, see `soundness`.

    Attributes:
        kind: name of the gait's automaton.
        robot: the robot.
        law: parameters of the control law.
        spring: parameters of the springs.
        contact: parameters of the ground, a `Ground` or the `Contact` of a level one.
        domains: those of one phase together, sticking before slipping.
        section: name of the event that closes a cycle, see `shortest_flight`; empty for none:
            such a system runs from a moment until it ends.
        cyclic: coordinates on which nothing depends: translation along x; where the ground is sloped, along it, see
            `spear_pin.hybrid.translation`.
        build: makes the same system from other (robot, law, spring, contact).
        guess: a state (q, v) on the section to search from.
        measures: quantities of one cycle that a gait can be asked for.
        phase_limit: longest a phase may last, in s.
        shortest_flight: in s; a toe that comes down sooner after it left the ground re-touches and closes no cycle, see
            `spear_pin.hybrid.rules.cycles`.
        hardware: between law and joints, see `spear_pin.hybrid.hardware`; None: ideal motors.
        changes: what was made of the system that `build` makes of other numbers, too; see `parameters.changed`.
        made: fields as they were when it was made, by which those are known that were replaced in it; and by whom,
            `builder`, before all changes.
    """

    kind: str
    robot: Robot
    law: Any
    spring: Spring
    contact: Contact
    domains: tuple[Domain, ...]
    section: str
    cyclic: tuple[str, ...]
    build: Callable[..., HybridSystem] = field(repr=False)
    guess: Callable[[], tuple[Any, Any]] = field(repr=False)
    measures: Mapping[str, Callable[[Any], float]] = field(default_factory=dict, repr=False)
    phase_limit: float = 5.0
    shortest_flight: float = SHORTEST_FLIGHT
    hardware: Hardware | None = None
    changes: tuple[Callable[[HybridSystem], HybridSystem], ...] = field(default=(), repr=False)
    made: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.made.get("build") is not self.build:  # what has another builder is as that one makes it
            made = {name: getattr(self, name) for name in REPLACED} | {"build": self.build, "builder": self.build}
            object.__setattr__(self, "made", made)
        check(self)

    @cached_property
    def ground(self) -> Ground:
        """The ground."""
        return as_ground(self.contact)

    @cached_property
    def phases(self) -> tuple[str, ...]:
        """Names of the phases, in the order of the domains."""
        return tuple(dict.fromkeys(domain.phase for domain in self.domains))

    def of_phase(self, phase: str) -> tuple[Domain, ...]:
        """Domains of a phase."""
        return tuple(domain for domain in self.domains if domain.phase == phase)

    def reset_into(self, phase: str) -> Reset:
        """The reset that leads into a phase."""
        for domain in self.domains:
            for guard in domain.guards:
                if guard.reset is not None and guard.reset.phase == phase:
                    return guard.reset
        raise UnknownName("phase", phase, self.phases)

    @cached_property
    def landing(self) -> tuple[str, Reset]:
        """The flight phase that ends at the section, and the reset there."""
        for domain in self.domains:
            if all(mode == OPEN for mode in domain.contacts):
                for guard in domain.guards:
                    if guard.name == self.section and guard.reset is not None:
                        return domain.phase, guard.reset
        raise UnknownName("section", self.section, [g.name for d in self.domains for g in d.guards])

    @property
    def section_phase(self) -> str:
        """The phase that begins at the section."""
        flight, reset = self.landing
        return reset.phase or flight
