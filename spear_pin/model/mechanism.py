"""The equations of motion for scalars of any kind: what the plane and space have in common."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Mapping, Sequence
from copy import copy
from dataclasses import dataclass, field
from functools import cached_property, partial
from itertools import islice
from operator import add, mul
from typing import Any, NamedTuple, Self

from spear_pin.errors import UnknownName
from spear_pin.model.directions import Round
from spear_pin.model.path import Point
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import ANYWHERE, FootArc, Parts
from spear_pin.model.vectors import Rows

NO_FORCES: Mapping[str, Sequence[Any]] = {}


class Feet(NamedTuple):
    """Kinematics of the toes at a state, in two dimensions or in three.

    Attributes:
        positions: x, in space y, and z of each toe.
        jacobians: J of each toe, as many rows of nv.
        drifts: J̇ v of each toe.
    """

    positions: dict[str, tuple[Any, ...]]
    jacobians: dict[str, list[list[Any]]]
    drifts: dict[str, tuple[Any, ...]]


class Toe(NamedTuple):
    """Motion of a toe in the world, in two dimensions or in three.

    Attributes:
        position: position, in m.
        velocity: J v, in m/s.
        acceleration: J v̇ + J̇ v, in m/s².
    """

    position: tuple[Any, ...]
    velocity: tuple[Any, ...]
    acceleration: tuple[Any, ...]


@dataclass(frozen=True)
class Terms:
    """The equations of motion at a state: D v̇ + bias = B u + Σ Jᵀ F, (3.16).

    Attributes:
        mass_matrix: D, nv rows of nv.
        bias: C v + G, nv.
        positions, jacobians, drifts: position, J and J̇ v of each toe, as `Feet` has them.
        position: returns the position of any frame of the robot's model, see `Mechanism.position`.
        loop_gaps, loop_rows, loop_drifts: φ, m, A, m rows of nv, and Ȧ v, m, of the robot's loops, see `loops`.
    """

    mass_matrix: list[list[Any]]
    bias: list[Any]
    positions: dict[str, tuple[Any, ...]]
    jacobians: dict[str, list[list[Any]]]
    drifts: dict[str, tuple[Any, ...]]
    position: Callable[[str], tuple[Any, ...]]
    loop_gaps: list[Any] = field(default_factory=list)
    loop_rows: list[list[Any]] = field(default_factory=list)
    loop_drifts: list[Any] = field(default_factory=list)


class Posed:
    """A robot at a configuration of scalars of any kind, as `path.Posture` describes it.

    Args:
        mechanism: the robot.
        q: the configuration.
        ops: elementary functions.
    """

    def __init__(self, mechanism: Mechanism, q: Sequence[Any], ops: Any) -> None:
        self._mechanism, self._q, self.ops = mechanism, q, ops

    def index(self, joint: str) -> int:
        """Returns the index of a coordinate."""
        return self._mechanism.coordinates.index(joint)

    def angle(self, joint: str) -> Any:
        """Returns the value of a coordinate, in rad or m."""
        return self._q[self.index(joint)]

    def point(self, frame: str, at: Sequence[Any]) -> Point:
        """Returns a point that a frame carries, given in the frame's axes, in m."""
        return self._points(frame, at)

    @cached_property
    def _points(self) -> Callable[[str, Sequence[Any]], Point]:
        return self._mechanism.points(self._q, self.ops)


class Mechanism(ABC):
    """Bodies on joints of one coordinate each, whose numbers and states may be scalars of any kind.

    Args:
        robot: the robot.
        bodies: its bodies.
        lift: acceleration of the ground.
        places: of each frame of the robot's model its place on its body, in m, and its axes there.

    Attributes:
        coordinates: names of the coordinates.
        nv: number of coordinates.
        bodies: the bodies, each after the one that it hangs on.
        frames: of each frame the number of its body, -1 for the world, and its place there, in m.
        axes: of each frame its axes in those of its body, the rows of a matrix.
        toes: body and place of each toe.
        lift: acceleration of the ground, which does what gravity does, in m/s²; a vector of two or three.
        circle: directions of contact, if it goes round a post.
        loops: the loops that it closes.
        marks: body and place of each toe, and of each end of a loop.
        radii: radius of each round foot, in m, by its toe.
        arcs: their arcs, if these have ends.
        guided: toes that move up and down only.
    """

    circle: Round | None = None

    def __init__(self, robot: Robot, bodies: Iterable[Any], lift: Any, places: Iterable[Any]) -> None:
        self.coordinates, self.nv = robot.coordinates, robot.nv
        self.bodies, self.lift = tuple(bodies), lift
        self.frames: dict[str, tuple[int, Any]] = {}
        self.axes: dict[str, Rows] = {}
        for frame, (place, axes) in zip(robot.model.frames, places, strict=True):
            # of several of a name the first, as Pinocchio finds it
            self.frames.setdefault(frame.name, (int(frame.parentJoint) - 1, place))
            self.axes.setdefault(frame.name, axes)
        self.toes, self.loops = {toe: self.frames[toe] for toe in robot.toes}, robot.loops
        self.marks = self.toes | {end: self.frames[end] for loop in robot.loops for end in loop.ends}
        self.radii: Mapping[str, Any] = robot.radii
        self.arcs: Mapping[str, FootArc] = robot.arcs
        self.guided = robot.guided

    @abstractmethod
    def terms(self, q: Sequence[Any], v: Sequence[Any], ops: Any, ends: Parts = ANYWHERE) -> Terms:
        """Returns the equations of motion at (q, v), (3.16).

        Args:
            q: nv scalars.
            v: nv scalars.
            ops: has `sin` and `cos` for them, and `atan2` and `maximum` for feet whose arcs have ends.
            ends: says on which part of its arc a round foot stands; without it the pitch of the foot says.
        """

    @abstractmethod
    def feet(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Feet:
        """Returns the kinematics of the toes alone, for the arguments of `terms`."""

    def _joints(self, q: Sequence[Any], v: Sequence[Any], ops: Any) -> Sequence[Any]:
        """Returns the motion of each body, then that of the world, of which the number is -1."""
        raise NotImplementedError

    def position(self, frame: str, q: Sequence[Any], ops: Any) -> tuple[Any, ...]:
        """Returns the position of any frame of the robot's model, x, in space y, and z, in m.

        Raises:
            UnknownName: there is no such frame.
        """
        return self._place(self._joints(q, [0.0] * self.nv, ops), frame)

    def _place(self, joints: Sequence[Any], frame: str) -> tuple[Any, ...]:
        i, offset = self._frame(frame)
        place: tuple[Any, ...] = joints[i].at(offset)
        return place

    def _frame(self, frame: str) -> tuple[int, Any]:
        """Returns a frame's body and its place there.

        Raises:
            UnknownName: there is no such frame.
        """
        if frame not in self.frames:
            raise UnknownName("frame", frame, self.frames)
        return self.frames[frame]

    def posed(self, q: Sequence[Any], ops: Any) -> Posed:
        """Returns the robot at a configuration, for the arguments of `position`."""
        return Posed(self, q, ops)

    def points(self, q: Sequence[Any], ops: Any) -> Callable[[str, Sequence[Any]], Point]:
        """Returns a function that gives a point by its frame and by its place in the frame's axes.

        It raises `UnknownName` for a frame that does not exist.
        """
        return partial(self._point, self._joints(q, [0.0] * self.nv, ops))

    def _point(self, joints: Sequence[Any], frame: str, at: Sequence[Any]) -> Point:
        """Returns a point of a frame."""
        raise NotImplementedError

    def forces(
        self,
        q: Sequence[Any],
        v: Sequence[Any],
        a: Sequence[Any],
        ops: Any,
        pushes: Mapping[str, Sequence[Any]] = NO_FORCES,
        *,
        gravity: bool = True,
    ) -> list[Any]:
        """Returns the forces along the coordinates that a motion needs, (nv,): D v̇ + C v + G - Σ Jᵀ F.

        Without gravity and at v = 0 these are the impulses that a change `a` of the velocity needs; `pushes` then are
        impulses at the toes.

        Args:
            q: nv scalars.
            v: nv scalars.
            a: v̇, nv scalars.
            ops: has `sin` and `cos` for them.
            pushes: forces of the ground on toes by name, in the world, in N.
            gravity: whether gravity acts.
        """
        terms = self.terms(q, v, ops)
        needed = [sum(map(mul, row, a), 0.0) for row in terms.mass_matrix]
        if gravity:
            needed = list(map(add, needed, terms.bias))
        for toe, push in pushes.items():
            for row, force in zip(terms.jacobians[toe], push, strict=True):
                needed = [own - column * force for own, column in zip(needed, row, strict=True)]
        return needed

    def moving_feet(self, q: Sequence[Any], v: Sequence[Any], a: Sequence[Any], ops: Any) -> dict[str, Toe]:
        """Returns the motion of the toes.

        Args:
            q: nv scalars.
            v: nv scalars.
            a: v̇, nv scalars.
            ops: has `sin` and `cos` for them.
        """
        feet = self.feet(q, v, ops)
        return {
            toe: Toe(
                feet.positions[toe],
                tuple(sum(map(mul, row, v), 0.0) for row in rows),
                tuple(sum(map(mul, row, a), drift) for row, drift in zip(rows, feet.drifts[toe], strict=True)),
            )
            for toe, rows in feet.jacobians.items()
        }

    @property
    def numbers(self) -> tuple[Any, ...]:
        """The numbers of each body, as its `numbers` lists them, places of toes and of ends of loops, and radii."""
        of_bodies = (number for body in self.bodies for number in body.numbers)
        return *of_bodies, *(number for _, offset in self.marks.values() for number in offset), *self.radii.values()

    def with_numbers(self, numbers: Sequence[Any]) -> Self:
        """Returns this mechanism with other numbers, in the order of `numbers`; they may be symbols."""
        left, other = iter(numbers), copy(self)
        other.bodies = tuple(body.with_numbers(left) for body in self.bodies)
        other.marks = {name: (i, tuple(islice(left, len(offset)))) for name, (i, offset) in self.marks.items()}
        other.radii = dict(zip(self.radii, left, strict=True))
        other.toes = {toe: other.marks[toe] for toe in self.toes}
        other.frames = {**self.frames, **other.marks}
        return other

    @property
    def shape(self) -> Any:
        """All of it but its numbers, and which of these are zero."""
        other = self.with_numbers([float(number != 0.0) for number in self.numbers])
        return (
            other.bodies,
            tuple(other.toes.items()),
            tuple(sorted(other.frames.items())),
            self.lift,
            self.circle,
            self.loops,
            tuple(self.radii),
            tuple(self.arcs.items()),
            self.guided,
        )
