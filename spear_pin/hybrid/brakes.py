"""Brakes, which hold a joint, or a path over joints, in some phases of a motion.

As such a phase begins, or at an event in it, its brake brings the path to rest in an impact, together with toes that
strike then. Afterwards it holds the path as dry friction does, up to a force beyond which it slips.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from typing import Any

import numpy as np

from spear_pin.errors import BadValue, UnknownName, list_names, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.clutch import of_brake
from spear_pin.hybrid.domain import Domain, Guard, GuardValue, Held, Reset, Rub, Turn
from spear_pin.hybrid.dry_friction import count_free, modes_of
from spear_pin.hybrid.dynamics import Dynamics
from spear_pin.hybrid.parameters import change_system
from spear_pin.kinds import typed
from spear_pin.model.clutch import LONGEST
from spear_pin.model.path import Joints
from spear_pin.model.robot_posture import find_spanned, row_along

Made = dict[tuple[int, tuple[str, ...]], Reset]  # by the reset that was changed, and the brakes that then grip


@typed
@dataclass(frozen=True)
class Brake:
    """A brake that closes in some phases.

    Attributes:
        force: the most that it holds, in N or N·m; beyond it slips, with this force. No impact makes it slip.
        phases: names of the phases in which it closes; an event that leads into another phase opens it first.
        path: the path that it holds; None for the joint of its name.
        when: a function as of a `Guard`, such as a rate, or a toe's force less a threshold. The brake closes within the
            phase where its value falls through zero, or is below; None: it closes as the phase begins.
        delay: time from then until it closes, in s.
        until: a function as of a `Guard`; the closed brake opens where its value falls through zero, or is below. While
            `when` asks to close it too, it opens and closes without end (`zeno`).
    """

    force: float
    phases: tuple[str, ...]
    path: Joints | None = None
    when: GuardValue | None = None
    delay: float = 0.0
    until: GuardValue | None = None

    def __post_init__(self) -> None:
        """Checks the numbers."""
        require("Brake.force", self.force, lambda force: force > 0, "a number > 0, in N or N·m")
        within = f"a number from 0 to {LONGEST:g}, in s"
        require("Brake.delay", self.delay, lambda delay: (delay >= 0) & (delay <= LONGEST), within)

    @property
    def at_once(self) -> bool:
        """Tells whether it closes in the instant in which its phases begin."""
        return self.when is None and self.delay == 0.0

    @property
    def switches(self) -> bool:
        """Tells whether it opens or closes within its phases."""
        return not self.at_once or self.until is not None


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
class Braking:
    """The change of a system that adds brakes.

    Attributes:
        brakes: the brakes by name.
    """

    brakes: Mapping[str, Brake]

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with brakes added."""
        robot, rubs = system.robot, {name: Rub(name, each.force, 0.0, each.path) for name, each in self.brakes.items()}
        if not robot.planar or system.pins:
            raise BadValue("system", system.kind, "one in the plane, without pinned toes")
        for name, rub in rubs.items():
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
                for variant, closed in self._variants(domain, rubs, made)
                for mode in modes_of(variant, robot, _checked(domain, closed, system))
            ),
        )

    def _variants(self, domain: Domain, rubs: Mapping[str, Rub], made: Made) -> Iterator[tuple[Domain, list[Rub]]]:
        """Yields the domain, for each way in which brakes may be closed in it, with the closed ones."""
        own = self._of(domain.phase)
        switching = [name for name in own if self.brakes[name].switches]
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
        brake = self.brakes[name]
        grips = tuple(rubs[each].along for each in rubs if each in (*closed, name))
        closes = Reset(grips=grips, turns=(Turn(name, closed=True),))
        if way:
            if brake.until is not None:
                yield Guard(f"opens:{name}", brake.until, Reset(turns=(Turn(name),)))
            return
        if brake.delay:
            yield Guard(f"closes:{name}", partial(_left, of_brake(name)), closes)
        if brake.when is not None:
            waits = Reset(turns=(Turn(name, waits=True, delay=brake.delay),))
            value = partial(_unless, of_brake(name), brake.when) if brake.delay else brake.when
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
                after = [name for name in entered if self.brakes[name].at_once]
                turns = tuple(self._turn(name, name in entered) for name, each in self.brakes.items() if each.switches)
            grips = () if not {*after} - {*closed} and not reset.impact else after
            changed = replace(reset, grips=tuple(rubs[name].along for name in grips), turns=turns)
            return made.setdefault((id(reset), tuple(grips)), changed) if changed != reset else reset

        guards = tuple(replace(guard, reset=closes(guard.reset)) for guard in domain.guards)
        switch = domain.switch
        if switch is not None:
            reset = closes(switch.reset)
            assert reset is not None
            switch = replace(switch, reset=reset)
        return replace(domain, guards=guards, switch=switch)

    def _turn(self, name: str, begins: bool) -> Turn:
        """Returns what the beginning of a phase does to a brake, if it is one of those in which that closes."""
        brake = self.brakes[name]
        begins = begins and brake.when is None
        return Turn(name, closed=begins and brake.at_once, waits=begins and not brake.at_once, delay=brake.delay)


def _left(names: tuple[str, str, str], t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Any) -> Any:
    """Returns the time until a brake closes, if it waits for that."""
    _, waiting, time = names
    return held[time] - t if held.get(waiting) else 1.0


def _unless(
    names: tuple[str, str, str], when: GuardValue, t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Any
) -> Any:
    """Returns the value of a condition, unless a brake waits to close already."""
    return 1.0 if held.get(names[1]) else when(t, q, v, held, p, dyn, ops)


def _checked(domain: Domain, closed: list[Rub], system: HybridSystem) -> list[Rub]:
    """Returns the brakes that are closed in a domain, of which all rows have to be independent."""
    rows = [row_along(rub.along, system.robot) for rub in (*domain.rubs, *closed)]
    most = count_free(domain, system.robot)
    if closed and (np.linalg.matrix_rank(rows) < len(rows) or len(rows) > most):
        expected = f"at most {most} in {domain.name!r}, none a combination of others or of dry friction"
        raise BadValue("brakes", [rub.joint for rub in closed], expected)
    return closed
