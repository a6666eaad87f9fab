"""Springs of a hop: one that never releases rests where the law lets the leg land.

The first spring of a hop is studied. Beside one that is not at the knee, a knee spring without stiffness has the damper
and the latch of the virtual spring.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.reaching import pose_leg
from spear_pin.gaits.springing import paths_of
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Guard, Held, Mount, Reset
from spear_pin.hybrid.dual import ARRAYS
from spear_pin.hybrid.parameters import change_system, rebuilt, with_numbers
from spear_pin.hybrid.springs import values_along
from spear_pin.model.equations import mechanism_of
from spear_pin.model.path import Path, Posture
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.studies.payoff.grid import FIXED


@dataclass(frozen=True)
class AtTouchdown:
    """A change that puts the rests of fixed springs where the law lets the leg land."""

    def __call__(self, system: HybridSystem) -> HybridSystem:
        """Returns the system with such springs."""
        mounts = {mount.name: mount for domain in system.domains for mount in domain.mounts}
        fixed = [mount for mount in mounts.values() if system.springs[mount.of].rest is not None]
        rests = {_held(mount): mount.along for mount in fixed}
        domains = (self._domain(domain, rests, system.robot) for domain in system.domains)
        return replace(system, domains=tuple(domains))

    def _domain(self, domain: Domain, rests: Mapping[str, Path], robot: Robot) -> Domain:
        mounts = [replace(mount, rest=_held(mount)) if _held(mount) in rests else mount for mount in domain.mounts]
        guards = tuple(self._guard(guard, rests, robot) for guard in domain.guards)
        return replace(domain, mounts=tuple(mounts), guards=guards)

    def _guard(self, guard: Guard, rests: Mapping[str, Path], robot: Robot) -> Guard:
        return guard if guard.reset is None else replace(guard, reset=self._reset(guard.reset, rests, robot))

    def _reset(self, reset: Reset, rests: Mapping[str, Path], robot: Robot) -> Reset:
        latch = reset.latch
        if latch is None or reset.phase != "stance":
            return reset

        def landed(q: Sequence[float], v: Sequence[float], held: Held, p: Any) -> Held:
            at = {"hip": p.hip_commanded, "knee": p.knee_touchdown}
            there = [at.get(name, q[i]) for i, name in enumerate(robot.coordinates)]
            return {**latch(q, v, held, p), **{rest: values_along(path, robot, there) for rest, path in rests.items()}}

        return replace(reset, latch=landed)


def _held(mount: Mount) -> str:
    """Returns the name under which a mount's rest is held."""
    return mount.rest if isinstance(mount.rest, str) else f"{mount.name}_rest"


def tie_springs(system: HybridSystem) -> HybridSystem:
    """Returns the system whose fixed springs, if it has any, move with the law's angles of touchdown."""
    return system if system.spring.rest is None else change_system(system, AtTouchdown())


def with_values(system: HybridSystem, values: Mapping[str, float]) -> HybridSystem:
    """Returns the system with other numbers; springs that never release rest where the leg lands."""
    other = with_numbers(system, values)
    return other if other.spring.rest is None else _resting(other)


def with_knee(system: HybridSystem, kind: str, stiffness: float) -> HybridSystem:
    """Returns the system with another spring: a virtual one replaces the part at the knee that the new one lacks.

    The damper stays, without a spring too, because it belongs to the knee.

    Args:
        system: the hop of a leg.
        kind: one of `KINDS` of `grid`.
        stiffness: stiffness of its first spring, in N·m/rad, or N/m. It acts both ways, see `release_springs`.
    """
    law, lacking = system.law, system.spring.stiffness - stiffness
    law = replace(law, virtual_stiffness=max(law.virtual_stiffness + lacking * float(levers(system)[-1]) ** 2, 0.0))
    first, *_ = system.springs
    plain = {name: _plain(spring, stiffness if name == first else 0.0) for name, spring in system.springs.items()}
    other = rebuilt(system, law=law, spring=plain)
    return _resting(other) if kind == FIXED else other


def _plain(spring: Spring, stiffness: float) -> Spring:
    """Returns a spring of a stiffness that acts both ways, with its damper and its path."""
    return Spring(stiffness=stiffness, damping=spring.damping, unilateral=False, path=spring.path)


def _resting(system: HybridSystem) -> HybridSystem:
    """Returns the system whose springs rest where the law lets the leg land."""
    there, paths = _lands(system), dict(paths_of(system.springs))
    springs = {name: replace(spring, rest=float(paths[name].length(there))) for name, spring in system.springs.items()}
    return rebuilt(system, spring=springs)


def _lands(system: HybridSystem) -> Posture:
    """Returns the posture in which the law lets the leg land."""
    robot, law = system.robot, system.law
    return mechanism_of(robot).posed(pose_leg(robot, law.hip_commanded, law.knee_touchdown).tolist(), ARRAYS)


def levers(system: HybridSystem) -> Array:
    """Returns how far the first spring stretches with hip and knee where the leg lands, (2,), in 1 or m/rad."""
    _, path = paths_of(system.springs)[0]
    slope = path.slope(_lands(system))
    return np.array([slope.get(system.robot.index(joint), 0.0) for joint in ("hip", "knee")])


def release_springs(system: HybridSystem) -> HybridSystem:
    """Returns the system whose springs, unless they are fixed, are let go where they would push."""
    if system.spring.rest is not None:
        return system
    return rebuilt(system, spring={name: replace(spring, unilateral=True) for name, spring in system.springs.items()})
