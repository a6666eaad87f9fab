"""A problem of the references, as data, and its automaton: a phase for each set of feet that stand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from itertools import product
from typing import Any, NamedTuple

import numpy as np

from spear_pin.gaits.springing import Springing, springing
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.contact import OPEN, STICK, WAYS
from spear_pin.hybrid.domain import Domain, Held, Law, Reset
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.phases import contact_domains, touchdown
from spear_pin.hybrid.result import Moment
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring

LANDS = "touchdown"
LONGEST = 2.0  # s: a phase
Feet = frozenset[str]


class Torque(NamedTuple):
    """A motor's torque, polynomial(t) + stiffness (angle - θ) - damping θ̇, in N·m; of a slider its force, in N.

    Attributes:
        polynomial: coefficients of the powers of the time since the phase began, in N·m/sⁿ.
        stiffness: in N·m/rad.
        angle: in rad.
        damping: in N·m·s/rad.
    """

    polynomial: tuple[float, ...] = ()
    stiffness: float = 0.0
    angle: float = 0.0
    damping: float = 0.0

    def __call__(self, t: Any, angle: Any, rate: Any) -> Any:
        """Returns the torque at a time, an angle and its rate, scalars of any kind."""
        power, found = 1.0, self.stiffness * (self.angle - angle) - self.damping * rate
        for number in self.polynomial:
            found, power = found + number * power, power * t
        return found


@dataclass(frozen=True)
class Fixed:
    """Parameters of a law that has none, as its numbers are the problem's."""


@dataclass(frozen=True)
class Problem:
    """A motion from a start until feet have landed so many times after a flight.

    Attributes:
        name: its name.
        words: what happens, in a sentence.
        robot: the robot.
        q: configuration at the start, (nq,); in space on the chain of `spear_pin.to_chain`.
        v: velocity at the start, (nv,).
        aloft: torques by joint while the leg's own foot is in the air; a motor without an entry does nothing.
        standing: torques by joint while it is on the ground.
        springs: springs by toe and name: the toe's touchdown engages them, its lift-off releases them.
        ground: the ground.
        stands: feet on the ground at the start; their springs engage there.
        landings: number of touchdowns after flights, of which the last is the end.
        periodic: whether it ends as it began, so that it has multipliers.
        strikes: feet that all strike at the start, if the question is only what this impact does.
    """

    name: str
    words: str
    robot: Robot
    q: Sequence[float]
    v: Sequence[float]
    aloft: Mapping[str, Torque] = field(default_factory=dict)
    standing: Mapping[str, Torque] = field(default_factory=dict)
    springs: Mapping[str, Mapping[str, Spring]] = field(default_factory=dict)
    ground: Ground = Ground(0.8)
    stands: tuple[str, ...] = ()
    landings: int = 1
    periodic: bool = False
    strikes: tuple[str, ...] = ()

    @property
    def start(self) -> Moment:
        """The start, with what is latched there."""
        q, v = (np.array(part, dtype=float) for part in (self.q, self.v))
        system, resets = self.system, [self._step(frozenset(), toe, toe in self.stands) for toe in self.robot.toes]
        clock = Clock(0.0, system.springs, system)
        held = latch_values({}, resets, q.tolist(), v.tolist(), system.law, begins=True, clock=clock)
        return Moment(q, v, self._phase(frozenset(self.stands)), held)

    @cached_property
    def system(self) -> HybridSystem:
        """The automaton; its section is a touchdown after a flight."""
        return self._built(self.robot, Fixed(), None, self.ground)

    def _built(self, robot: Robot, law: Any, spring: Any, contact: Any) -> HybridSystem:
        toes = robot.toes
        every = product((True, False), repeat=len(toes))
        sets = [frozenset(toe for toe, stands in zip(toes, each, strict=True) if stands) for each in every]
        return HybridSystem(
            kind=self.name,
            robot=robot,
            law=law,
            springs={name: each for own in self._springing.values() for name, each in own.springs.items()},
            contact=contact,
            domains=tuple(domain for feet in sets for domain in self._domains(feet)),
            section=LANDS,
            cyclic=(),
            build=self._built,
            guess=lambda: (np.array(self.q, dtype=float), np.array(self.v, dtype=float)),
            phase_limit=LONGEST,
            shortest_flight=0.0,
        )

    @cached_property
    def _springing(self) -> dict[str, Springing]:
        return {toe: springing(self.robot, self.springs.get(toe, {})) for toe in self.robot.toes}

    def _phase(self, feet: Feet) -> str:
        return "+".join(toe for toe in self.robot.toes if toe in feet) or "air"

    def _domains(self, feet: Feet) -> tuple[Domain, ...]:
        """Returns the domains of the phase in which some feet stand."""
        toes, mounts, guards = self.robot.toes, [], []
        for toe, own in self._springing.items():
            acting = own.standing if toe in feet else own.aloft
            mounts += acting
            guards += own.switches(acting)
            if toe not in feet:
                guards.append(touchdown(toe, self._step(feet, toe, True), f"{toe}_{LANDS}" if feet else LANDS))
        contacts = tuple(STICK if toe in feet else OPEN for toe in toes)
        name = self._phase(feet)
        domain = Domain(name, name, contacts, self._law(feet), tuple(mounts), guards=tuple(guards))
        leave = {toe: self._step(feet, toe, False) for toe in feet}
        return contact_domains(domain, toes, leave, (), WAYS[self.robot.dimension]) if feet else (domain,)

    def _step(self, feet: Feet, toe: str, lands: bool) -> Reset:
        """Returns what a foot's touchdown, or its lift-off, does."""
        own = self._springing[toe]
        staying = [edge for other, each in self._springing.items() if other != toe for edge in each.staying]

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
            return own.engage(q, held) if lands else own.keep(q, held)

        edges = (*(own.touching if lands else own.leaving), *staying)
        phase = self._phase(feet | {toe} if lands else feet - {toe})
        return Reset((toe,) if lands else (), () if lands else own.released, latch, phase, edges=edges)

    def foot_of(self, joint: str) -> str:
        """Returns the foot of a joint's leg, by its name, as of "front_knee" and "front_toe"; or the only foot."""
        toes = self.robot.toes
        return next((toe for toe in toes if joint.startswith(toe.removesuffix("toe"))), toes[0])

    def _law(self, feet: Feet) -> Law:
        joints = self.robot.actuated
        tables = [self.standing if self.foot_of(joint) in feet else self.aloft for joint in joints]
        asked = [table.get(joint, Torque()) for joint, table in zip(joints, tables, strict=True)]
        motors = [(torque, self.robot.index(joint)) for torque, joint in zip(asked, joints, strict=True)]

        def law(t: Any, q: Any, v: Any, held: Held, p: Fixed, dyn: Any, ops: Any) -> list[Any]:
            return [torque(t, q[i], v[i]) for torque, i in motors]

        return law
