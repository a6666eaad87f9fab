"""Round feet in the plane, whose arcs may have ends: where such a foot touches, and beyond which pitch on an end.

With the foot's pitch θ, which turns x towards z, an arc from θ₀ to θ₁ of radius r touches straight below its centre.
Where the foot is turned beyond an end by β it stands on that end, at r (sin β, -cos β) from the centre.

Position and velocity of the touching point are continuous there, its acceleration is not. So where a toe is on the
ground, two held values say on which part it stands, and an event changes them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue

Parts = Mapping[str, Sequence[Any]]
"""For toes two values: 1 if the foot stands on the first, or on the last, end of its arc, else 0."""
ANYWHERE: Parts = {}
ON_END = 1e-9  # rad: this near to an end, the foot's rate decides
NEAR_END = 2e-5  # rad: this near to an end, the foot may be on either side of it


@dataclass(frozen=True)
class FootArc:
    """The range of pitch in which a foot rolls.

    Attributes:
        start: θ₀, in rad; with every joint at zero the pitch is zero.
        stop: θ₁, in rad.
        turns: how the pitch changes with each coordinate, (nv,): 1, 0 or -1.
    """

    start: float
    stop: float
    turns: tuple[float, ...]

    @property
    def middle(self) -> float:
        """The pitch halfway between the ends, in rad."""
        return 0.5 * (self.start + self.stop)

    def excess(self, sine: Any, cosine: Any, ops: Any) -> Any:
        """Returns β, in rad: positive beyond the stop, negative beyond the start, 0 between.

        Args:
            sine: sine of the pitch.
            cosine: cosine of the pitch.
            ops: has `atan2` and `maximum` for them.
        """
        turned, half = turned_from(self.middle, sine, cosine, ops), self.stop - self.middle
        return ops.maximum(turned - half, 0.0) - ops.maximum(-turned - half, 0.0)

    def pitch(self, q: Sequence[Any]) -> Any:
        """Returns the pitch at a configuration, nv scalars, or its rate at a velocity."""
        return sum((turn * angle for turn, angle in zip(self.turns, q, strict=True) if turn), 0.0)

    def parts(self, q: Sequence[Any], v: Sequence[Any]) -> tuple[Any, Any]:
        """Returns on which end the foot stands or is about to, see `Parts`, of numbers or arrays."""
        rate = self.pitch(v)
        first, last = self._beyond(q)
        return _there(first, -rate), _there(last, rate)

    def contradicts(self, parts: Any, q: Sequence[float]) -> bool:
        """Tells whether a foot at a configuration cannot stand on these parts, see `Parts`, by its pitch."""
        both = np.array(parts, float)
        beyond = np.array(self._beyond(q))
        return both.shape != (2,) or bool(((both != (beyond > 0.0)) & (np.abs(beyond) > NEAR_END)).any())

    def _beyond(self, q: Sequence[Any]) -> tuple[Any, Any]:
        """Returns how far the foot is turned beyond the first and the last end, in rad."""
        angle, half = self.pitch(q), self.stop - self.middle
        turned = turned_from(self.middle, np.sin(angle), np.cos(angle), np)
        return -turned - half, turned - half


@dataclass(frozen=True)
class RoundFoot:
    """A round foot about a frame.

    Attributes:
        radius: radius, in m.
        arc: its arc, if that has ends.
        neutral: axes of the frame with every joint at zero, (3, 3).
        ends: on which part of its arc it stands, see `Parts`; None where its pitch says.
    """

    radius: float
    arc: FootArc | None = None
    neutral: Array = field(default_factory=lambda: np.eye(3))
    ends: Sequence[float] | None = None

    def lever(self, model: pin.Model, data: pin.Data, frame: int) -> tuple[Array, bool]:
        """Returns where it touches from its centre, x and z in m, and whether that is an end of its arc."""
        if self.arc is None or (self.ends is not None and not any(self.ends)):
            return np.array([0.0, -self.radius]), False
        turned = pin.updateFramePlacement(model, data, frame).rotation @ self.neutral.T
        sine, cosine = float(turned[2, 0]), float(turned[0, 0])
        if self.ends is None:
            beyond = self.arc.excess(sine, cosine, np)
            return self.radius * np.array([np.sin(beyond), -np.cos(beyond)]), bool(beyond)
        x, z = end_of(self.arc.stop if self.ends[1] else self.arc.start, self.radius)
        return np.array([cosine * x - sine * z, sine * x + cosine * z]), True


def round_feet(
    model: pin.Model, frames: Mapping[str, int], radii: Mapping[str, float], ends: Mapping[str, tuple[float, float]]
) -> dict[str, RoundFoot]:
    """Returns the round feet of a robot by their toes.

    Args:
        model: the robot's model.
        frames: number of each toe's frame.
        radii: radius of each round foot, in m.
        ends: first and last pitch of the arcs that have ends, in rad.
    """
    if not radii:  # data of many joints take much memory
        return {}
    data, found = pin.Data(model), {}
    pin.computeJointJacobians(model, data, pin.neutral(model))
    for toe, radius in radii.items():
        jacobian = pin.getFrameJacobian(model, data, frames[toe], pin.ReferenceFrame.LOCAL_WORLD_ALIGNED)
        turns = tuple((0.0 - np.round(jacobian.reshape(6, model.nv)[4])).tolist())
        neutral = np.array(pin.updateFramePlacement(model, data, frames[toe]).rotation)
        found[toe] = RoundFoot(radius, FootArc(*ends[toe], turns) if toe in ends else None, neutral)
    return found


def turned_from(pitch: float, sine: Any, cosine: Any, ops: Any) -> Any:
    """Returns how far a foot is turned from a pitch, in (-π, π] rad, by sine and cosine of its own pitch."""
    s, c = float(np.sin(pitch)), float(np.cos(pitch))
    return ops.atan2(sine * c - cosine * s, cosine * c + sine * s)


def end_of(pitch: float, radius: Any) -> tuple[Any, Any]:
    """Returns where the end of an arc at a pitch is from its centre, x and z with every joint at zero, in m."""
    return -radius * float(np.sin(pitch)), -radius * float(np.cos(pitch))


def refuse_ends(robot: Any, what: str) -> None:
    """Refuses a robot with a round foot whose arc has ends, for what does not keep these, in words.

    Raises:
        BadValue: it has such a foot.
    """
    if robot.arcs:
        raise BadValue("robot", robot, f"one whose round feet have no ends (from, to), which {what} does not keep")


def parts_of(toe: str) -> str:
    """Returns the name in `held` of the values that say on which part of its arc a toe stands."""
    return f"{toe}_ends"


def _there(beyond: Any, rate: Any) -> Any:
    return 1.0 * ((beyond > ON_END) | ((beyond > -ON_END) & (rate > 0.0)))
