"""The springs of a leg: where they act in stance and in flight, and what their switches latch and release."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from spear_pin.errors import BadValue
from spear_pin.gaits.legs import Leg
from spear_pin.hybrid.clutch import make_delay_event, make_slip_events
from spear_pin.hybrid.conditions import make_condition_events
from spear_pin.hybrid.domain import ENGAGES, HOLDS, KEEPS, LEAVES, RELEASES, TOUCHES, Edge, Guard, Held, Mount
from spear_pin.hybrid.dual import ARRAYS
from spear_pin.hybrid.rules.guards import make_turning_event, spring_switches
from spear_pin.hybrid.springs import values_along
from spear_pin.model.clutch import JOINT, TOUCHDOWN, Clutch
from spear_pin.model.equations import mechanism_of
from spear_pin.model.path import Joints, Path
from spear_pin.model.robot import Robot
from spear_pin.model.spring import Spring, refuse_unusual
from spear_pin.model.springs import Springs

KNEE = "knee"


@dataclass(frozen=True)
class Springing:
    """Springs that are latched at touchdown and released at lift-off, or that are fixed and never switched.

    Attributes:
        robot: the robot.
        springs: the springs by name.
        mounts: the mount of each.
    """

    robot: Robot
    springs: Springs
    mounts: tuple[Mount, ...]

    @property
    def standing(self) -> tuple[Mount, ...]:
        """The mounts in stance."""
        return tuple(each for mount in self.mounts for each in self._standing(mount))

    @property
    def aloft(self) -> tuple[Mount, ...]:
        """The mounts in flight: fixed springs, whose dampers act in stance only, and springs that are released late."""
        found = []
        for mount in self.mounts:
            spring = self.springs[mount.of]
            if spring.rest is not None:
                found.append(replace(mount, spring=replace(spring, damping=0.0)))
            elif spring.clutch is not None:
                found.append(self._standing(mount)[0])
        return tuple(found)

    def _standing(self, mount: Mount) -> list[Mount]:
        """Returns a mount in stance, with its damper's if that is of the joint."""
        spring = self.springs[mount.of]
        if spring.clutch is None or spring.clutch.damper != JOINT:
            return [mount]
        damper = Spring(0.0, damping=spring.damping, unilateral=False, path=spring.path)
        beside = Mount(f"{mount.name}_damper", damper, rest=0.0, path=mount.along, of=mount.of)
        return [replace(mount, spring=replace(spring, damping=0.0)), beside]

    @property
    def released(self) -> tuple[str, ...]:
        """The names of the mounts that lift-off releases at once."""
        return tuple(mount.name for mount in self._plain if self.springs[mount.of].rest is None)

    @property
    def touching(self) -> tuple[Edge, ...]:
        """What touchdown does to switches."""
        return tuple(Edge(_at_touchdown(clutch), mount) for mount, clutch in self._clutched)

    @property
    def leaving(self) -> tuple[Edge, ...]:
        """What lift-off does to switches."""
        return tuple(Edge(_at_lift_off(clutch), mount) for mount, clutch in self._clutched)

    @property
    def staying(self) -> tuple[Edge, ...]:
        """What events of other legs do to switches."""
        return tuple(Edge(KEEPS, mount) for mount, _ in self._clutched)

    def switches(self, mounts: Sequence[Mount]) -> tuple[Guard, ...]:
        """Returns the events at which springs go slack, taut or turn, and those at which late switches act."""
        first, found = next(iter(self.springs), ""), list[Guard]()
        for mount in mounts:
            found += spring_switches(mount, "spring_switch" if mount.of == first else f"spring_switch:{mount.of}")
            clutch = self.springs[mount.of].clutch if mount.on is not None else None
            if clutch is not None and (clutch.on_delay or clutch.off_delay or clutch.hold):
                found.append(make_delay_event(mount))
            found += make_slip_events(mount)
            found += make_turning_event(mount)
        return tuple(found)

    def conditions(self, toe: str) -> tuple[Guard, ...]:
        """Returns the events of stance at which switches meet conditions of their own."""
        return tuple(guard for mount, clutch in self._clutched for guard in make_condition_events(mount, clutch, toe))

    def engage(self, q: Sequence[Any], held: Held) -> Held:
        """Returns what touchdown latches: where each switched spring rests, and whether fixed ones are taut.

        Paths are taken to grow; one that shrinks turns at once.
        """
        found = {**self.keep(q, held), **self._ways}
        for mount in self._plain:
            if self.springs[mount.of].rest is None:
                found |= {str(mount.rest): values_along(mount.along, self.robot, q), str(mount.taut): 1.0}
        return found

    def keep(self, q: Sequence[Any], held: Held) -> dict[str, Any]:
        """Returns what lift-off latches: whether fixed springs are taut, if that is not known yet."""
        found = {way: held.get(way, grows) for way, grows in self._ways.items()}
        for mount in self._plain:
            spring = self.springs[mount.of]
            if spring.rest is None or str(mount.taut) in held:  # as it was
                continue
            length = mount.along.length(mechanism_of(self.robot).posed(q, ARRAYS))
            found |= {mount.rest: spring.rest} if isinstance(mount.rest, str) else {}
            found[str(mount.taut)] = float(length > spring.rest or not spring.unilateral)
        return found

    @property
    def _ways(self) -> dict[str, Any]:
        return {mount.way: 1.0 for mount in self.mounts if mount.way is not None}

    @property
    def _plain(self) -> list[Mount]:
        return [mount for mount in self.mounts if self.springs[mount.of].clutch is None]

    @property
    def _clutched(self) -> list[tuple[Mount, Clutch]]:
        return [(mount, clutch) for mount in self.mounts if (clutch := self.springs[mount.of].clutch) is not None]


def _at_touchdown(clutch: Clutch) -> str:
    """Returns what touchdown does to a switch; one with a condition is open until it is met."""
    if clutch.engage != TOUCHDOWN:
        return RELEASES
    return TOUCHES if clutch.on_delay else HOLDS if clutch.hold else ENGAGES


def _at_lift_off(clutch: Clutch) -> str:
    """Returns what lift-off does to a switch; one that releases after a time goes on."""
    return LEAVES if clutch.off_delay else KEEPS if clutch.hold else RELEASES


def springing(robot: Robot, springs: Springs) -> Springing:
    """Returns how the springs of a robot with one leg act; one without a path acts on the joint of its name.

    Raises:
        UnknownName: there is no joint, or no frame, of a name.
    """
    return Springing(robot, springs, tuple(_mounted(name, name, path, springs) for name, path in paths_of(springs)))


def springing_in_space(robot: Robot, springs: Springs, leg: Leg) -> Springing:
    """Returns how the springs of a leg in space act: at the knee, or on another joint if they pull and push.

    Raises:
        UnknownName: there is no joint of a name.
        BadValue: a spring is on a path, which its left and right would not have alike, or a switch is not ideal.
    """
    for name, spring in springs.items():
        refuse_unusual(spring)
        if name != KNEE and spring.unilateral:
            raise BadValue(f"unilateral of the spring {name!r}", True, "False in space, for a spring not at the knee")
    return springing_of(robot, springs, leg)


def springing_of(robot: Robot, springs: Springs, leg: Leg) -> Springing:
    """Returns how the springs of one leg of several act, whose paths name parts such as `knee`, `hip` and `shank`.

    Raises:
        UnknownName: there is no joint, or no frame, of a name.
    """
    parts = [*robot.coordinates, *(frame.name for frame in robot.model.frames)]
    names = {part.removeprefix(f"{leg.name}_"): part for part in parts if part.startswith(f"{leg.name}_")}
    names |= {"hip": leg.above, KNEE: leg.joint, "toe": leg.toe}
    mounts = [
        _mounted(leg.joint if name == KNEE else f"{leg.name}_{name}", name, path.on(names, leg.side), springs)
        for name, path in paths_of(springs)
    ]
    return Springing(robot, springs, tuple(mounts))


def paths_of(springs: Springs) -> list[tuple[str, Path]]:
    """Returns name and path of each spring; one without a path acts on the joint of its name."""
    return [(name, spring.path or Joints({name: 1.0})) for name, spring in springs.items()]


def _mounted(mount: str, name: str, path: Path, springs: Springs) -> Mount:
    spring = springs[name]
    way = f"{mount}_way" if spring.hysteresis else None
    if (clutch := spring.clutch) is not None:
        tooth = f"{mount}_tooth" if clutch.pitch else None
        held = f"{mount}_rest", f"{mount}_taut"
        slips = f"{mount}_slips" if clutch.slip else None
        return Mount(mount, spring, *held, path, of=name, on=f"{mount}_on", tooth=tooth, slips=slips, way=way)
    if mount == name == KNEE and path == Joints({KNEE: 1.0}):  # the motor of a single leg may imitate it
        return Mount(mount, spring, "knee_touchdown", "taut", path, of=name, way=way)
    rest = f"{mount}_rest" if spring.rest is None else spring.rest
    return Mount(mount, spring, rest, f"{mount}_taut", path, of=name, way=way)
