"""Brakes, which hold a joint, or a path over joints, in some phases of a motion.

As such a phase begins, or at an event in it, its brake brings the path to rest in an impact, together with toes on the
ground. A toe that this lifts leaves the ground. Afterwards the brake holds the path as dry friction does, up to a force
beyond which it slips.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, UnknownName, list_names
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.brake import Brake as Brake
from spear_pin.hybrid.brake import Braked
from spear_pin.hybrid.clutch import of_brake
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Guard, GuardValue, Held, Reset, Rub, Turn
from spear_pin.hybrid.dry_friction import count_free, modes_of
from spear_pin.hybrid.dynamics import Dynamics
from spear_pin.hybrid.parameters import change_system
from spear_pin.hybrid.rules.footing import AT_REST
from spear_pin.hybrid.rules.guards import stays
from spear_pin.kinds import typed
from spear_pin.model.robot_posture import find_spanned, row_along

Names = tuple[str, str, str]
Made = dict[tuple[int, tuple[str, ...], tuple[Turn, ...]], Reset]  # by the reset that was changed, and how


@typed
def with_brakes(system: HybridSystem, brakes: Mapping[str, Brake]) -> HybridSystem:
    """Returns the system with brakes; rebuilt systems keep them.

    A domain in which a brake holds names it, as in "flight knee held". A gait with brakes cannot be saved.

    Args:
        system: a system in the plane.
        brakes: brakes by the joint that they hold, or by any name if they have a path.

    Raises:
        UnknownName: there is no such joint or phase.
        BadValue: a joint is tied by a loop, a brake is closed in the phase with which a cycle begins, paths are not
            independent of each other or of toes on the ground, or the system is in space or has pinned toes.

    Example:
        >>> from spear_pin import hopping, load, simulate
        >>> from spear_pin.hybrid.brakes import Brake, with_brakes
        >>> system = with_brakes(hopping(load("spear_ii", locked=["boom_x"])), {"knee": Brake(50.0, ("flight",))})
        >>> [domain.name for domain in system.of_phase("flight")]
        ['flight knee held', 'flight', 'flight']
    """
    return change_system(system, Braking(dict(brakes)))


@dataclass(frozen=True)
class Braking(Braked):
    """The change of a system that adds brakes, as a function."""

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with brakes added."""
        robot, rubs = system.robot, {name: Rub(name, each.force, 0.0, each.path) for name, each in self.brakes.items()}
        if not robot.planar or system.pins:
            raise BadValue("system", system.kind, "one in the plane, without pinned toes")
        for name, rub in rubs.items():
            if any(name == each.joint for domain in system.domains for each in domain.rubs):
                raise BadValue("name of a brake", name, "one that no other brake and no joint with dry friction has")
            if tied := [joint for joint in find_spanned(rub.along, robot) if joint not in robot.independent]:
                expected = f"joints that loops do not tie, or {list_names(robot.independent)}"
                raise BadValue(f"joints of the brake {name!r}", tied, expected)
            for phase in self.brakes[name].phases:
                if phase not in system.phases:
                    raise UnknownName(f"phase of the brake {name!r}", phase, system.phases)
                if system.section and phase == system.section_phase and self.brakes[name].at_once:
                    expected = f"phases other than {phase!r}, with which a cycle begins"
                    raise BadValue(f"phases of the brake {name!r}", self.brakes[name].phases, expected)
        made = Made()
        return replace(
            system,
            domains=tuple(
                mode
                for domain in system.domains
                for variant, closed in self._variants(_let_rise(domain, system), rubs, made)
                for mode in modes_of(variant, robot, _checked(domain, closed, system))
            ),
        )

    def _variants(self, domain: Domain, rubs: Mapping[str, Rub], made: Made) -> Iterator[tuple[Domain, list[Rub]]]:
        """Yields the domain, for each way in which brakes may be closed in it, with the closed ones."""
        own = self._of(domain.phase)
        switching = [name for name in own if not self.brakes[name].at_once]
        for ways in product((False, True), repeat=len(switching)):
            states = dict(zip(switching, ways, strict=True))
            closed = [name for name in own if states.get(name, True)]
            variant = self._closing(domain, closed, rubs, made)
            guards = [guard for name, way in states.items() for guard in self._switches(name, way, closed, rubs)]
            brakes = tuple((of_brake(name)[0], way) for name, way in states.items())
            yield replace(variant, guards=(*variant.guards, *guards), brakes=brakes), [rubs[name] for name in closed]

    def _of(self, phase: str) -> list[str]:
        """Returns the names of the brakes that close in a phase."""
        return [name for name, each in self.brakes.items() if phase in each.phases]

    def _switches(self, name: str, way: bool, closed: Sequence[str], rubs: Mapping[str, Rub]) -> Iterator[Guard]:
        """Yields the events at which a brake opens, if it is closed, and those at which it closes."""
        brake, own = self.brakes[name], of_brake(name)
        grips = tuple(rubs[each].along for each in rubs if each in (*closed, name))
        closes = Reset(grips=grips, turns=(Turn(name, closed=True),))
        if way:
            if brake.until is not None:
                yield Guard(f"opens:{name}", brake.until, Reset(turns=(Turn(name),)))
            return
        if brake.begins and brake.until is not None:  # of both, the first happens
            yield Guard(f"opens:{name}", partial(_while_waiting, own, brake.until), Reset(turns=(Turn(name),)))
            yield Guard(f"closes:{name}", partial(_at_once, own), closes)
        if brake.delay:
            yield Guard(f"closes:{name}", partial(_left, own), closes)
        if brake.when is not None:
            waits = Reset(turns=(Turn(name, waits=True),))
            value = partial(_unless, own, brake.when) if brake.delay else brake.when
            yield Guard(f"{'waits' if brake.delay else 'closes'}:{name}", value, waits if brake.delay else closes)

    def _closing(
        self,
        domain: Domain,
        closed: Sequence[str],
        rubs: Mapping[str, Rub],
        made: Made,
    ) -> Domain:
        """Returns the domain with events that close and open brakes; equal resets of several domains stay one."""

        def closes(reset: Reset | None) -> Reset | None:
            if reset is None:
                return None
            after, turns = list(closed), tuple[Turn, ...]()
            if reset.phase is not None:
                entered = self._of(reset.phase)
                stay = [name for name in entered if name in closed and self.brakes[name].begins]
                after = [name for name in entered if self.brakes[name].at_once or name in stay]
                turning = [name for name, each in self.brakes.items() if not each.at_once]
                turns = tuple(self._turn(name, name in entered, name in stay) for name in turning)
            grips = () if not {*after} - {*closed} and not reset.impact else after
            changed = replace(reset, grips=tuple(rubs[name].along for name in grips), turns=turns)
            return made.setdefault((id(reset), tuple(grips), turns), changed) if changed != reset else reset

        guards = tuple(replace(guard, reset=closes(guard.reset)) for guard in domain.guards)
        switch = domain.switch
        if switch is not None:
            reset = closes(switch.reset)
            assert reset is not None
            switch = replace(switch, reset=reset)
        return replace(domain, guards=guards, switch=switch)

    def _turn(self, name: str, entered: bool, stays: bool) -> Turn:
        """Returns what the beginning of a phase does to a brake that may close in that phase, or stay closed."""
        return Turn(name, closed=stays, waits=entered and not stays and self.brakes[name].when is None)


def _let_rise(domain: Domain, system: HybridSystem) -> Domain:
    """Returns the domain with immediate events by which toes leave that a brake lifts.

    Each is the first event without an impact after which the toe is in the air and the fewest others are. If there is
    none, the run ends.
    """
    resets = ((guard, guard.reset) for guard in domain.guards if guard.reset is not None and not guard.reset.impact)
    ways = [(guard, system.of_phase(reset.phase)[0].contacts) for guard, reset in resets if reset.phase is not None]
    leaving = list[Guard]()
    for i, (toe, mode) in enumerate(zip(system.robot.toes, domain.contacts, strict=True)):
        if mode != OPEN:
            own = [way for way in ways if way[1][i] == OPEN]
            ends = Guard(f"lifts:{toe}", stays(toe), ends="lifted"), ()
            event, _ = min(own, key=lambda way: way[1].count(OPEN), default=ends)
            leaving.append(replace(event, value=stays(toe), tolerance=AT_REST))
    return replace(domain, guards=(*leaving, *domain.guards))


def _at_once(names: Names, t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Any) -> Any:
    """Returns a value below zero if a brake waits to close."""
    return 1.0 - 2.0 * held.get(names[1], 0.0)


def _left(names: Names, t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Any) -> Any:
    """Returns the time until a brake closes, if it waits for that."""
    _, waiting, time = names
    waits = held.get(waiting, 0.0)
    return waits * (held.get(time, 0.0) - t) + (1.0 - waits)


def _while_waiting(
    names: Names, until: GuardValue, t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Any
) -> Any:
    """Returns the value of a condition, if a brake waits to close."""
    waits = held.get(names[1], 0.0)
    return waits * until(t, q, v, held, p, dyn, ops) + (1.0 - waits)


def _unless(names: Names, when: GuardValue, t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Any) -> Any:
    """Returns the value of a condition, unless a brake waits to close already."""
    waits = held.get(names[1], 0.0)
    return waits + (1.0 - waits) * when(t, q, v, held, p, dyn, ops)


def _checked(domain: Domain, closed: list[Rub], system: HybridSystem) -> list[Rub]:
    """Returns the brakes that are closed in a domain, of which all rows have to be independent."""
    rows = [row_along(rub.along, system.robot) for rub in (*domain.rubs, *closed)]
    most = count_free(domain, system.robot)
    if closed and (np.linalg.matrix_rank(rows) < len(rows) or len(rows) > most):
        expected = f"at most {most} in {domain.name!r}, none a combination of others or of dry friction"
        raise BadValue("brakes", [rub.joint for rub in closed], expected)
    return closed
