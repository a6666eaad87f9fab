"""Settings of a robot beyond its file and the arguments of `load`: legs, pairs, springs and motors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from spear_pin.errors import BadValue
from spear_pin.model.cut import Turn
from spear_pin.model.gears import Gear
from spear_pin.model.loops import Loop
from spear_pin.model.motor import Motor
from spear_pin.model.named_legs import NamedLeg
from spear_pin.model.reach import Reach


@dataclass(frozen=True)
class Settings:
    """Settings of a robot, by its own joints.

    Attributes:
        path: path of the file that has the settings; "" without a file.
        sides: +1 or -1 for each leg by its name, by the side to which its knee flexes, see `Leg`; 0 if not known.
        legs: the legs, if they are given joint by joint.
        pairs: names of the left and the right leg of each pair, if they are given.
        springs: a `Spring` for each knee that has one, by its joint, and springs on paths by name: of each leg, whose
            parts have the names `hip`, `knee`, `thigh`, `shank` and `toe`.
        motors: motors of joints, by name, where they are known.
        efficiencies: efficiencies of joints' gearboxes, in (0, 1].
        gears: ratios and rotors that the file itself gives, by joint.
        post: position, x and y in m, of the post about which the robot goes, if any.
        loops: closed loops, between frames of the model or among its joints.
        independent: names of tied joints that determine the others; by default those with a motor in the file.
        reach: hip's and knee's angle of a leg with loops.
        radii: radius of each round foot, in m, by its toe.
        arcs: pitches, in rad, between which round feet roll whose arcs have ends, by their toes.
    """

    path: str = ""
    sides: Mapping[str, int] = field(default_factory=dict)
    legs: tuple[NamedLeg, ...] = ()
    pairs: tuple[tuple[str, ...], ...] = ()
    springs: Mapping[str, Any] = field(default_factory=dict)
    motors: Mapping[str, Motor] = field(default_factory=dict)
    efficiencies: Mapping[str, float] = field(default_factory=dict)
    gears: Mapping[str, Gear] = field(default_factory=dict)
    post: tuple[float, float] | None = None
    loops: tuple[Loop, ...] = ()
    independent: tuple[str, ...] = ()
    reach: Reach | None = None
    radii: Mapping[str, float] = field(default_factory=dict)
    arcs: Mapping[str, tuple[float, float]] = field(default_factory=dict)

    def of_cut(self, angles: Mapping[str, Sequence[Turn]]) -> Settings:
        """Returns the settings of a robot that is cut out of this one, by the cut's joints.

        A pair has the springs of both legs and the motor of one if both are alike, else none.

        Args:
            angles: for each turning joint of the cut, the joints of this robot that turn with it.
        """
        springs = {name: _together(spring, len(angles[name])) for name, spring in _alike(self.springs, angles).items()}
        count = max((len(turns) for name, turns in angles.items() if name.endswith("knee")), default=1)
        springs |= {name: _together(spring, count) for name, spring in self.springs.items() if spring.path is not None}
        motors, efficiencies, gears = (_alike(each, angles) for each in (self.motors, self.efficiencies, self.gears))
        return Settings(self.path, springs=springs, motors=motors, efficiencies=efficiencies, gears=gears)


NONE_GIVEN = Settings()


def refuse_special(robot: Any, what: str) -> None:
    """Refuses a robot whose file gives it springs on paths, with hysteresis, or with switches that are not ideal.

    Args:
        robot: the robot.
        what: what does not take them, in words.

    Raises:
        BadValue: it has such a spring.
    """
    springs = robot.settings.springs.items()
    unusual = {name: spring.path or spring.clutch or spring.hysteresis for name, spring in springs}
    special = [name for name, reason in unusual.items() if reason]
    if special:
        expected = f"only springs at knees that switch at once, without hysteresis, which {what}"
        raise BadValue("springs of the file", ", ".join(special), expected)


def _alike(of_joints: Mapping[str, Any], angles: Mapping[str, Sequence[Turn]]) -> dict[str, Any]:
    """Returns, for each joint of a cut, the value that all joints for which it stands have in common."""
    each = {name: [of_joints.get(turn.joint) for turn in turns] for name, turns in angles.items()}
    return {name: own[0] for name, own in each.items() if own[0] is not None and own.count(own[0]) == len(own)}


def _together(spring: Any, count: int) -> Any:
    """Returns one spring in place of `count` equal springs."""
    if count == 1:
        return spring
    numbers = {name: count * getattr(spring, name) for name in spring.units}
    return replace(spring, **numbers, table=tuple((angle, count * torque) for angle, torque in spring.table))
