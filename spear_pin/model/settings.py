"""What is known of a robot beside its file and the arguments of `load`: legs, pairs, springs and motors."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from spear_pin.model.cut import Turn
from spear_pin.model.gears import Gear
from spear_pin.model.motor import Motor
from spear_pin.model.named_legs import NamedLeg


@dataclass(frozen=True)
class Settings:
    """Settings of a robot, by its own joints.

    Attributes:
        path: of the file that says them.
        sides: +1 or -1 for each leg by its name, as of `Leg`; 0 where it is not known.
        legs: where they are given joint by joint.
        pairs: names of the left and the right leg of each pair, if they are given.
        springs: a `Spring` for each knee that has one, by its joint.
        motors: of joints by name, where they are known.
        efficiencies: of joints' gearboxes, in (0, 1].
        gears: ratios and rotors that the file itself says, by joint.
        post: place, x and y in m, of the post about which it goes, if it does.
    """

    path: str
    sides: Mapping[str, int] = field(default_factory=dict)
    legs: tuple[NamedLeg, ...] = ()
    pairs: tuple[tuple[str, ...], ...] = ()
    springs: Mapping[str, Any] = field(default_factory=dict)
    motors: Mapping[str, Motor] = field(default_factory=dict)
    efficiencies: Mapping[str, float] = field(default_factory=dict)
    gears: Mapping[str, Gear] = field(default_factory=dict)
    post: tuple[float, float] | None = None

    def of_cut(self, angles: Mapping[str, Sequence[Turn]]) -> Settings:
        """Those of a robot that is cut out of this one, by the cut's joints.

        A pair has the springs of both legs and the motor of one, where both are alike, else none.

        Args:
            angles: as of `Cut`.
        """
        springs = {name: _together(spring, len(angles[name])) for name, spring in _alike(self.springs, angles).items()}
        motors, efficiencies, gears = (_alike(each, angles) for each in (self.motors, self.efficiencies, self.gears))
        return Settings(self.path, springs=springs, motors=motors, efficiencies=efficiencies, gears=gears)


def _alike(of_joints: Mapping[str, Any], angles: Mapping[str, Sequence[Turn]]) -> dict[str, Any]:
    """For each joint of a cut what the joints that it stands for have, all of them."""
    each = {name: [of_joints.get(turn.joint) for turn in turns] for name, turns in angles.items()}
    return {name: own[0] for name, own in each.items() if own[0] is not None and own.count(own[0]) == len(own)}


def _together(spring: Any, count: int) -> Any:
    """So many springs as one."""
    if count == 1:
        return spring
    numbers = {name: count * getattr(spring, name) for name in ("stiffness", "damping", "hardening", "preload")}
    return replace(spring, **numbers, table=tuple((angle, count * torque) for angle, torque in spring.table))
