"""The springs of a leg: where they act in stance and in flight, and what their switches latch and release."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Protocol

from spear_pin.hybrid.domain import Guard, Held, Mount
from spear_pin.hybrid.rules.guards import spring_switches
from spear_pin.hybrid.springs import values_along
from spear_pin.hybrid.tangent.dual import ARRAYS
from spear_pin.model.equations import mechanism_of
from spear_pin.model.path import Joints, Path
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring
from spear_pin.model.springs import Springs

KNEE = "knee"


@dataclass(frozen=True)
class Springing:
    """Springs that are latched at touchdown and released at lift-off, or that are fixed and never switched.

    Attributes:
        robot: the robot.
        springs: the springs by name.
        mounts: the mount of each in stance.
    """

    robot: Robot
    springs: Springs
    mounts: tuple[Mount, ...]

    @property
    def fixed(self) -> tuple[Mount, ...]:
        """The mounts in flight: those of fixed springs, whose dampers act in stance only."""
        springs = zip(self.mounts, self.springs.values(), strict=True)
        return tuple(
            replace(mount, spring=replace(spring, damping=0.0)) for mount, spring in springs if spring.rest is not None
        )

    @property
    def released(self) -> tuple[str, ...]:
        """The names of the mounts that lift-off releases."""
        springs = zip(self.mounts, self.springs.values(), strict=True)
        return tuple(mount.name for mount, spring in springs if spring.rest is None)

    def switches(self, mounts: Sequence[Mount]) -> tuple[Guard, ...]:
        """Returns the events at which springs go slack, or taut again."""
        first = next(iter(self.springs))
        named = [(mount, "" if mount.of == first else f":{mount.of}") for mount in mounts]
        return tuple(guard for mount, after in named for guard in spring_switches(mount, f"spring_switch{after}"))

    def engage(self, q: Sequence[Any], held: Held) -> Held:
        """Returns what touchdown latches: where each switched spring rests, and whether fixed ones are taut."""
        found: dict[str, Any] = {}
        for mount, spring in zip(self.mounts, self.springs.values(), strict=True):
            if spring.rest is None:
                found |= {str(mount.rest): values_along(mount.along, self.robot, q), str(mount.taut): 1.0}
            else:
                found |= self._settle(mount, spring, q, held)
        return found

    def keep(self, q: Sequence[Any], held: Held) -> Held:
        """Returns what lift-off latches: whether fixed springs are taut, if that is not known yet."""
        found: dict[str, Any] = {}
        for mount, spring in zip(self.mounts, self.springs.values(), strict=True):
            if spring.rest is not None:
                found |= self._settle(mount, spring, q, held)
        return found

    def _settle(self, mount: Mount, spring: Spring, q: Sequence[Any], held: Held) -> Held:
        if str(mount.taut) in held:  # as it was
            return {}
        assert spring.rest is not None
        length = mount.along.length(mechanism_of(self.robot).posed(q, ARRAYS))
        rests = {mount.rest: spring.rest} if isinstance(mount.rest, str) else {}
        return {**rests, str(mount.taut): float(length > spring.rest or not spring.unilateral)}


class Kneed(Protocol):
    """A leg: its name, the names of its joints and of its toe, and the side to which its knee flexes."""

    @property
    def name(self) -> str: ...  # noqa: D102
    @property
    def above(self) -> str: ...  # noqa: D102
    @property
    def joint(self) -> str: ...  # noqa: D102
    @property
    def toe(self) -> str: ...  # noqa: D102
    @property
    def side(self) -> float: ...  # noqa: D102


def springing(robot: Robot, springs: Springs) -> Springing:
    """Returns how the springs of a robot with one leg act; one without a path acts on the joint of its name.

    Raises:
        UnknownName: there is no joint, or no frame, of a name.
    """
    return Springing(robot, springs, tuple(_mounted(name, name, path, springs) for name, path in _paths(springs)))


def springing_of(robot: Robot, springs: Springs, leg: Kneed) -> Springing:
    """Returns how the springs of one leg of several act, whose paths name parts such as `knee`, `hip` and `shank`.

    Raises:
        UnknownName: there is no joint, or no frame, of a name.
    """
    parts = [*robot.coordinates, *(frame.name for frame in robot.model.frames)]
    names = {part.removeprefix(f"{leg.name}_"): part for part in parts if part.startswith(f"{leg.name}_")}
    names |= {"hip": leg.above, KNEE: leg.joint, "toe": leg.toe}
    mounts = [
        _mounted(leg.joint if name == KNEE else f"{leg.name}_{name}", name, path.on(names, leg.side), springs)
        for name, path in _paths(springs)
    ]
    return Springing(robot, springs, tuple(mounts))


def _paths(springs: Springs) -> list[tuple[str, Path]]:
    return [(name, spring.path or Joints({name: 1.0})) for name, spring in springs.items()]


def _mounted(mount: str, name: str, path: Path, springs: Springs) -> Mount:
    spring = springs[name]
    if path == Joints({KNEE: 1.0}):  # the motor of a single leg may imitate it
        return Mount(mount, spring, "knee_touchdown", "taut", path, of=name)
    rest = f"{mount}_rest" if spring.rest is None else spring.rest
    return Mount(mount, spring, rest, f"{mount}_taut", path, of=name)
