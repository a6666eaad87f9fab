"""The hybrid automaton: a robot with its domains, see `spear_pin.hybrid.domain`, and their numbers.

This module also offers the parts of automata to authors.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from spear_pin.errors import BadValue, UnknownName, require
from spear_pin.hybrid.arc_ends import on_arcs
from spear_pin.hybrid.brake import Brake, brakes_of
from spear_pin.hybrid.contact import OPEN as OPEN
from spear_pin.hybrid.contact import PINNED, Contact
from spear_pin.hybrid.contact import SLIP_BACKWARD as SLIP_BACKWARD
from spear_pin.hybrid.contact import SLIP_FORWARD as SLIP_FORWARD
from spear_pin.hybrid.contact import STICK as STICK
from spear_pin.hybrid.domain import Domain as Domain
from spear_pin.hybrid.domain import Guard as Guard
from spear_pin.hybrid.domain import Mount as Mount
from spear_pin.hybrid.domain import Reset as Reset
from spear_pin.hybrid.domain import Switch as Switch
from spear_pin.hybrid.ground import Ground, as_ground, refuse_slopes
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.soundness import check, moves_as_one
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

REPLACED = (
    "kind",
    "domains",
    "section",
    "cyclic",
    "measures",
    "guess",
    "phase_limit",
    "shortest_flight",
    "overlap",
    "impact_law",
    "hardware",
)
MOREAU, KELLER = "moreau", "keller"
SHORTEST_FLIGHT = 0.05  # s: corresponds to a rise of 3 mm in free flight, 1/200 of a leg of 0.6 m


@dataclass(frozen=True)
class HybridSystem:
    """A robot, its domains, and their numbers; parts that do not fit together are refused, see `soundness`.

    Attributes:
        kind: name of the gait's automaton.
        robot: the robot.
        law: parameters of the control law.
        springs: the springs by name; of several mounts of the same kind, as those of two legs, the one that they share.
        contact: parameters of the ground, a `Ground` or the `Contact` of a level one.
        domains: the domains, sorted by phase, sticking before slipping; those in which toes of one body would slide
            differently are left out.
        section: name of the event that closes a cycle, see `shortest_flight`. A system without a section has an empty
            name, and runs from a moment until it ends.
        cyclic: coordinates on which the dynamics do not depend: translation along x or, on a slope, along the ground,
            see `spear_pin.hybrid.translation`.
        build: makes the same system from other (robot, law, spring, contact).
        guess: returns an initial guess (q, v) on the section.
        measures: measures of one cycle, which can be targets for a gait.
        phase_limit: longest a phase may last, in s.
        shortest_flight: shortest flight of a toe, in s. A toe that lands sooner re-touches and closes no cycle, see
            `spear_pin.hybrid.rules.cycles`.
        overlap: duration of an impact in space, in s; overlapping impacts of several toes count as one, see
            `spear_pin.hybrid.rules.spatial_impact`.
        impact_law: law of impacts in space: `MOREAU`, or `KELLER` for impacts of one toe, see
            `spear_pin.hybrid.rules.sliding_impact`.
        section_toes: toes whose first touchdown is the section, if the section lies before the impact.
        mirrored_toes: toes whose first touchdown is the section between the halves, if a cycle is half a stride and
            the other half its mirror image.
        hardware: hardware between law and joints, see `spear_pin.hybrid.hardware`; None means ideal motors.
        changes: changes to the system that `build` repeats with other numbers, see `parameters.changed`.
        made: fields as they were when the system was made, which reveals replaced fields, and `builder`, which made
            the system before all changes.
        sprung: whether `build` takes springs by name, and not one spring only.
    """

    kind: str
    robot: Robot
    law: Any
    springs: Mapping[str, Spring]
    contact: Contact
    domains: tuple[Domain, ...]
    section: str
    cyclic: tuple[str, ...]
    build: Callable[..., HybridSystem] = field(repr=False)
    guess: Callable[[], tuple[Any, Any]] = field(repr=False)
    measures: Mapping[str, Callable[[Any], float]] = field(default_factory=dict, repr=False)
    phase_limit: float = 5.0
    shortest_flight: float = SHORTEST_FLIGHT
    overlap: float = 0.0
    impact_law: str = MOREAU
    section_toes: tuple[str, ...] = ()
    mirrored_toes: tuple[str, ...] = ()
    hardware: Hardware | None = None
    changes: tuple[Callable[[HybridSystem], HybridSystem], ...] = field(default=(), repr=False)
    made: Mapping[str, Any] = field(default_factory=dict, repr=False, compare=False)
    sprung: bool = False

    def __post_init__(self) -> None:
        object.__setattr__(self, "domains", tuple(each for each in self.domains if moves_as_one(self.robot, each)))
        if self.robot.arcs:
            object.__setattr__(self, "domains", tuple(on_arcs(domain, self.robot) for domain in self.domains))
        if self.made.get("build") is not self.build:  # a system with another builder is as that builder makes it
            made = {name: getattr(self, name) for name in REPLACED} | {"build": self.build, "builder": self.build}
            object.__setattr__(self, "made", made)
        require("HybridSystem.overlap", self.overlap, lambda seconds: seconds >= 0, "a number >= 0, in s")
        if self.impact_law not in (MOREAU, KELLER):
            raise BadValue("HybridSystem.impact_law", self.impact_law, f"{MOREAU!r} or {KELLER!r}")
        refuse_slopes(self.robot, self.ground)
        if self.robot.post is not None and not self.ground.level:
            raise BadValue("ground", self.contact, "level ground, for a robot that goes round a post")
        gravity = tuple(self.robot.model.gravity.linear.tolist())
        if not self.robot.planar and any(gravity[:2]):  # a rotation about z would change the motion
            raise BadValue("gravity", gravity, "gravity along z, for a robot that is not planar")
        check(self.robot, self.domains, self.law, self.guess, self.springs)
        if self.section:
            _ = self.landing  # its error says what is valid

    @property
    def spring(self) -> Spring:
        """The first of the springs.

        Raises:
            BadValue: the system has none.
        """
        if not self.springs:
            raise BadValue("HybridSystem.springs", self.springs, "a spring at least")
        return next(iter(self.springs.values()))

    @property
    def parts(self) -> dict[str, Any]:
        """The arguments of the builder besides the robot: law, spring or springs by name, and contact."""
        springs: Any = self.springs if self.sprung else next(iter(self.springs.values()), None)
        return {"law": self.law, "spring": springs, "contact": self.contact}

    @cached_property
    def brakes(self) -> dict[str, Brake]:
        """The brakes by name."""
        return brakes_of(self.changes)

    @cached_property
    def ground(self) -> Ground:
        """The ground."""
        return as_ground(self.contact)

    @cached_property
    def pins(self) -> bool:
        """Whether it pins toes where they strike, which only the reference engine does."""
        return any(PINNED in domain.contacts for domain in self.domains)

    @cached_property
    def phases(self) -> tuple[str, ...]:
        """Names of the phases, in the order of the domains."""
        return tuple(dict.fromkeys(domain.phase for domain in self.domains))

    def of_phase(self, phase: str) -> tuple[Domain, ...]:
        """Returns the domains of a phase."""
        return self._by_phase.get(phase, ())

    @cached_property
    def _by_phase(self) -> Mapping[str, tuple[Domain, ...]]:
        return {phase: tuple(each for each in self.domains if each.phase == phase) for phase in self.phases}

    def reset_into(self, phase: str) -> Reset:
        """Returns the reset of a guard that leads into a phase, the first if there are several."""
        if phase not in self._into:
            raise UnknownName("phase", phase, self.phases)
        return self._into[phase]

    @cached_property
    def _into(self) -> Mapping[str, Reset]:
        resets = [guard.reset for domain in self.domains for guard in domain.guards if guard.reset is not None]
        return {reset.phase: reset for reset in reversed(resets) if reset.phase is not None}

    def place_of(self, reset: Reset) -> str:
        """Returns in words the event and the domain of a reset, the first if there are several."""
        for domain in self.domains:
            events: list[Guard | Switch] = [*domain.guards, *([] if domain.switch is None else [domain.switch])]
            for event in events:
                if event.reset is reset:
                    return f"{event.name!r} in domain {domain.name!r}"
        return f"an event into phase {reset.phase!r}"

    @property
    def landing(self) -> tuple[str, Reset]:
        """The phase that ends at the section, of several a flight, and its reset; for mirrored halves the first's."""
        return self._landings[0]

    @cached_property
    def _landings(self) -> list[tuple[str, Reset]]:
        ends = [
            (domain, guard.reset)
            for domain in self.domains
            for guard in domain.guards
            if guard.name == self.section and guard.reset is not None
        ]
        flights = [end for end in ends if all(mode == OPEN for mode in end[0].contacts) and not end[0].bouncing]
        found = [(domain.phase, reset) for domain, reset in flights or ends]  # who walks has no flight
        if not found:
            raise UnknownName("section", self.section, [g.name for d in self.domains for g in d.guards])
        return found

    @property
    def section_phase(self) -> str:
        """The phase that begins at the section."""
        flight, reset = self.landing
        return reset.phase or flight

    @cached_property
    def section_phases(self) -> frozenset[str]:
        """The phases that begin at the section; there are several if the halves of a stride are mirror images."""
        return frozenset(reset.phase or flight for flight, reset in self._landings)
