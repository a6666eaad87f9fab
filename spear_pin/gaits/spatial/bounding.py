"""Bounding in space: the automaton of the plane leg by leg, a phase for each set of legs that bear."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from typing import Any

import numpy as np

from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_guards import knee_back, mount, overload
from spear_pin.gaits.bounding_law import BoundingLaw
from spear_pin.gaits.spatial.latches import bears, landing, lands, swings, trails, waits
from spear_pin.gaits.spatial.law import ADJUSTED, SpatialLaw, law_of
from spear_pin.gaits.spatial.legs import Leg, Pair, Z, pairs_of, placed
from spear_pin.gaits.virtual_constraints import progress
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK, WAYS, Contact
from spear_pin.hybrid.domain import Domain, Guard, Held, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.ground import Ground, as_ground, given
from spear_pin.hybrid.phases import contact_domains, fall, height, spring_switches
from spear_pin.hybrid.result import Run
from spear_pin.hybrid.rules.guards import ON_GROUND, struck_together, touchdown
from spear_pin.kinds import typed
from spear_pin.model.robot import Robot
from spear_pin.model.spring import PAIR_STIFFNESS, Spring

LONGEST = 2.0  # s: a phase
OVERLAP = 0.010  # s: how long an impact lasts (assumption; not in the source)
SECTION = "posterior_touchdown"


@typed
def bounding_in_space(
    robot: Robot,
    law: SpatialLaw,
    spring: Spring | None = None,
    contact: Contact | None = None,
    *,
    ground: Ground | None = None,
) -> HybridSystem:
    """The bounding automaton in space: each leg touches down and lifts off for itself.

    The section lies just before the first posterior touchdown, both posterior legs at their touchdown angles.

    Args:
        robot: a quadruped on a chain, such as `load("q_spear_full", base="chain")`.
        law: parameters of the controller.
        spring: the knee springs, of one leg; by default 56 N·m/rad (source: Table 5.1), without damping.
        contact: friction of level ground; by default 0.8 (assumption).
        ground: the ground, in place of `contact`.

    Raises:
        BadValue: the robot is no such quadruped, both contact and ground are given, the ground is not level at height
            zero, the spring is never switched, or the plane's law has event feedback.

    Example:
        >>> from spear_pin import Gait, SpatialLaw, bounding_in_space, load
        >>> law = SpatialLaw(Gait.load("long_stride").system.law)
        >>> bounding_in_space(load("q_spear_full", base="chain"), law).section
        'posterior_touchdown'
    """
    spring, contact = spring or Spring(PAIR_STIFFNESS / 2.0, damping=0.0), given(contact, ground)
    if spring.rest is not None:
        raise BadValue("Spring.rest", spring.rest, "None: in space springs are switched")
    if not as_ground(contact).plain:
        raise BadValue("ground", contact, "level at height zero: in space there is no other yet")
    if law.plane.feedback:
        raise BadValue("SpatialLaw.plane.feedback", "event feedback", "none of the plane's in space")
    pairs = pairs_of(robot)
    return HybridSystem(
        kind="bounding_in_space",
        robot=robot,
        law=law,
        spring=spring,
        contact=contact,
        domains=tuple(_Automaton(robot, law.plane, spring, pairs).domains()),
        section=SECTION,
        section_toes=tuple(leg.toe for leg in pairs[0]),
        cyclic=("torso_x", "torso_y", "yaw"),
        build=bounding_in_space,
        guess=lambda: _guess(robot, law, pairs, as_ground(contact)),
        measures=_MEASURES,
        phase_limit=LONGEST,
        overlap=OVERLAP,
    )


@dataclass(frozen=True)
class _Automaton:
    """What its domains are made of.

    Attributes:
        robot: the robot.
        plane: the sagittal controller, for what is not a number in it.
        spring: of each knee.
        pairs: the posterior and the anterior legs.
    """

    robot: Robot
    plane: BoundingLaw
    spring: Spring
    pairs: tuple[Pair, Pair]

    @property
    def legs(self) -> tuple[Leg, ...]:
        """All four, in the order of the toes."""
        return *self.pairs[0], *self.pairs[1]

    def domains(self) -> Iterator[Domain]:
        """Those of all sets of legs that bear; before a posterior touchdown that closes a stride there is one more."""
        for down in product((True, False), repeat=len(self.legs)):
            bearing = tuple(leg for leg, bears in zip(self.legs, down, strict=True) if bears)
            phases = [self.phase(bearing)] if bearing else ["flight_1", "flight_2"]
            for phase in phases:
                yield from self._of_phase(phase, bearing, self._touchdowns(phase, bearing))
                if self._closes(phase, bearing):
                    strikes = self._strikes(bearing, self.pairs[0], "touchdown", anew=True)
                    yield from self._of_phase(_before(phase), bearing, [*strikes, *self._others(phase, bearing)])

    def phase(self, bearing: Sequence[Leg]) -> str:
        """Name of the phase in which some legs bear: of both of a pair "posterior_stance", of one "posterior_left"."""
        parts = []
        for pair in self.pairs:
            own = [leg for leg in pair if leg in bearing]
            parts += [pair[0].pair] if len(own) == 2 else [leg.name for leg in own]
        return f"{'+'.join(parts)}_stance" if len(parts) > 1 or len(bearing) == 2 else parts[0]

    def _closes(self, phase: str, bearing: Sequence[Leg]) -> bool:
        """Whether a posterior touchdown closes a stride: of a pair in the air that is not just back."""
        return phase != "flight_1" and not set(bearing) & set(self.pairs[0])

    def _of_phase(self, phase: str, bearing: tuple[Leg, ...], touchdowns: list[Guard]) -> tuple[Domain, ...]:
        airborne = [(leg, self._others_of(leg)) for leg in self.legs if leg not in bearing]
        mounts = tuple(mount(leg, self.spring) for leg in bearing)
        switches = [
            guard for mount, leg in zip(mounts, bearing, strict=True) for guard in spring_switches(mount, leg.knee)
        ]
        ends = [_passing(leg, others) for leg, others in airborne]
        fallen = fall([f"{leg.name}_{part}" for leg in self.legs for part in ("hip", "knee")])
        domain = Domain(
            name=phase,
            phase=phase,
            contacts=tuple(STICK if leg in bearing else OPEN for leg in self.legs),
            law=law_of(bearing, airborne),
            mounts=mounts,
            guards=(*touchdowns, *switches, *ends, overload(), *fallen),
        )
        if not bearing:
            return (domain,)
        resets = {leg.toe: self._lifts(leg, bearing) for leg in bearing}
        backs = [guard for leg in bearing for guard in knee_back(leg, resets[leg.toe])]
        first = tuple(backs) if self.plane.lift_off == "knee" else ()
        bounces = self.plane.lift_off == "knee"
        return contact_domains(domain, self.robot.toes, resets, first, WAYS[3], bounces=bounces)

    # touchdown

    def _touchdowns(self, phase: str, bearing: tuple[Leg, ...]) -> list[Guard]:
        if self._closes(phase, bearing):
            return [*self._closing(phase), *self._others(phase, bearing)]
        back = "return" if phase == "flight_1" else "touchdown"
        return [*self._strikes(bearing, self.pairs[0], back, anew=phase != "flight_1"), *self._others(phase, bearing)]

    def _others(self, phase: str, bearing: tuple[Leg, ...]) -> list[Guard]:
        """Touchdowns of the anterior legs."""
        back = "return" if phase == "flight_2" else "touchdown"
        return self._strikes(bearing, self.pairs[1], back, anew=phase != "flight_2")

    def _closing(self, phase: str) -> list[Guard]:
        """The section, just before a posterior touchdown: from there on all depends on (q, v) alone."""
        posterior, anterior = self.pairs

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: SpatialLaw) -> Held:
            waiting = {name: each for leg in posterior for name, each in waits(leg, anterior, q, p).items()}
            return waiting | {ADJUSTED: p.adjustment(q, v)}

        reset = Reset(latch=latch, phase=_before(phase))
        return [Guard(SECTION, height(leg.toe), reset, tolerance=ON_GROUND) for leg in posterior]

    def _strikes(self, bearing: tuple[Leg, ...], pair: Pair, name: str, *, anew: bool) -> list[Guard]:
        guards: list[Guard] = []
        for leg in pair:
            if leg not in bearing:
                reset = self._touches(leg, bearing, anew and not set(pair) & set(bearing))
                event = f"{leg.name}_{name}"
                guards += [struck_together(leg.toe, event, reset), touchdown(leg.toe, reset, event)]
        return guards

    def _touches(self, leg: Leg, bearing: tuple[Leg, ...], anew: bool) -> Reset:
        own, others = self._own(leg), self._others_of(leg)
        swinging = [other for other in others if other not in bearing]

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: SpatialLaw) -> Held:
            latched = bears(leg, own, q, v, held, p, anew)
            for other in swinging:
                latched |= swings(other, own, q, v, {**held, **latched}, p)
            return latched

        return Reset(impact=(leg.toe,), latch=latch, phase=self.phase(self._with(bearing, leg)))

    # lift-off

    def _lifts(self, leg: Leg, bearing: tuple[Leg, ...]) -> Reset:
        own, others = self._own(leg), self._others_of(leg)
        left = tuple(each for each in bearing if each != leg)
        supported = bool(set(left) & set(others))
        last = not set(left) & set(own)
        aloft = [other for other in others if other not in left]

        def latch(q: Sequence[float], v: Sequence[float], held: Held, p: SpatialLaw) -> Held:
            latched = swings(leg, others, q, v, held, p) if supported else trails(leg, others, q, v, held, p)
            for other in own:
                if other != leg and other not in left and f"{other.name}_alpha" not in held:  # where a run begins
                    latched |= trails(other, others, q, v, held, p)
            for other in landing(aloft, held) if last else ():
                latched |= lands(other, own, q, v, held, p)
            return latched

        phase = self.phase(left) if left else "flight_1" if leg.pair == "posterior" else "flight_2"
        return Reset(release=(leg.joint,), latch=latch, phase=phase)

    def _own(self, leg: Leg) -> Pair:
        return self.pairs[0] if leg in self.pairs[0] else self.pairs[1]

    def _others_of(self, leg: Leg) -> Pair:
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


def _guess(robot: Robot, law: SpatialLaw, pairs: tuple[Pair, Pair], ground: Ground) -> tuple[Any, Any]:
    if not law.plane.nominal:
        raise BadValue("SpatialLaw.plane.nominal", law.plane.nominal, "the numbers of a section state, or give a state")
    q, v = np.array([0.0, *law.plane.nominal[:6]]), np.array(law.plane.nominal[6:])
    q, v = placed(robot, pairs, q), placed(robot, pairs, v)
    q[Z] -= min(ground.foot(robot, q, leg.toe)[0] for leg in pairs[0])
    return q, v


def _forward(run: Run) -> float:
    yaw = run.start[0][3]
    dx, dy = run.state[0][:2] - run.start[0][:2]
    return float(math.cos(yaw) * dx + math.sin(yaw) * dy)


_MEASURES: Mapping[str, Any] = {
    "mean_speed": lambda run: _forward(run) / sum(run.durations.values()),
    "period": lambda run: sum(run.durations.values()),
    "stride": _forward,
    "turn": lambda run: float(run.state[0][3] - run.start[0][3]),
}
