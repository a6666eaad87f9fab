"""Brakes, which hold a joint, or a path over joints, in some phases of a motion.

As such a phase begins, its brake brings the path to rest in an impact, together with toes that strike then. Afterwards
it holds the path as dry friction does, up to a force beyond which it slips.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from spear_pin.errors import BadValue, UnknownName, listed, require
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Reset, Rub
from spear_pin.hybrid.dry_friction import left_free, modes_of
from spear_pin.hybrid.parameters import changed
from spear_pin.kinds import typed
from spear_pin.model.path import Joints
from spear_pin.model.robot_posture import row_along, spanned


@typed
@dataclass(frozen=True)
class Brake:
    """A brake that is closed in some phases.

    Attributes:
        force: the most that it holds, in N or N·m; beyond it slips, with this force. No impact makes it slip.
        phases: names of the phases in which it is closed; an event that leads into another phase opens it first.
        path: the path that it holds; None for the joint of its name.
    """

    force: float
    phases: tuple[str, ...]
    path: Joints | None = None

    def __post_init__(self) -> None:
        """Checks the force."""
        require("Brake.force", self.force, lambda force: force > 0, "a number > 0, in N or N·m")


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
    return changed(system, Braking(dict(brakes)))


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
            if tied := [joint for joint in spanned(rub.along, robot) if joint not in robot.independent]:
                expected = f"joints that loops do not tie, or {listed(robot.independent)}"
                raise BadValue(f"joints of the brake {name!r}", tied, expected)
            for phase in self.brakes[name].phases:
                if phase not in system.phases:
                    raise UnknownName(f"phase of the brake {name!r}", phase, system.phases)
                if system.section and phase == system.section_phase:
                    expected = f"phases other than {phase!r}, with which a cycle begins"
                    raise BadValue(f"phases of the brake {name!r}", self.brakes[name].phases, expected)
        closed = {
            phase: [rub for name, rub in rubs.items() if phase in self.brakes[name].phases] for phase in system.phases
        }
        made = dict[int, Reset]()
        return replace(
            system,
            domains=tuple(
                mode
                for domain in system.domains
                for mode in modes_of(
                    _closing(domain, closed, made), robot, _checked(domain, closed[domain.phase], system)
                )
            ),
        )


def _checked(domain: Domain, closed: list[Rub], system: HybridSystem) -> list[Rub]:
    """Returns the brakes that are closed in a domain, of which all rows have to be independent."""
    rows = [row_along(rub.along, system.robot) for rub in (*domain.rubs, *closed)]
    most = left_free(domain, system.robot)
    if closed and (np.linalg.matrix_rank(rows) < len(rows) or len(rows) > most):
        expected = f"at most {most} in {domain.name!r}, none a combination of others or of dry friction"
        raise BadValue("brakes", [rub.joint for rub in closed], expected)
    return closed


def _closing(domain: Domain, closed: Mapping[str, list[Rub]], made: dict[int, Reset]) -> Domain:
    """Returns the domain with events that close brakes; equal resets of several domains stay one."""

    def closes(reset: Reset | None) -> Reset | None:
        if reset is None:
            return None
        after, before = (
            tuple(rub.along for rub in closed[phase]) for phase in (reset.phase or domain.phase, domain.phase)
        )
        if not {*after} - {*before} and not reset.impact:
            return reset
        return made.setdefault(id(reset), replace(reset, grips=after))

    guards = tuple(replace(guard, reset=closes(guard.reset)) for guard in domain.guards)
    switch = domain.switch
    if switch is not None:
        reset = closes(switch.reset)
        assert reset is not None
        switch = replace(switch, reset=reset)
    return replace(domain, guards=guards, switch=switch)
