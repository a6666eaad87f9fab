"""Signals of a cycle with their derivatives, and its measures by name."""

from __future__ import annotations

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.measures.catalogue import CATALOGUE, Measure, match_pattern, unit_in
from spear_pin.gaits.measures.signals import Signals
from spear_pin.gaits.sensitivity.along_arcs import (
    along,
    coordinate,
    evaluate_guard,
    find_closed_toes,
    find_powered,
    forces,
    long,
    with_partner,
)
from spear_pin.gaits.sensitivity.drives import Behind, DrivenJoints
from spear_pin.gaits.sensitivity.electricity import find_drawn, find_reserve
from spear_pin.gaits.sensitivity.measure import DualMeasure
from spear_pin.gaits.sensitivity.signals import Pieces, integral, largest_ratio, peak, positive, where_it_falls
from spear_pin.hybrid.column_names import motors_at
from spear_pin.hybrid.domain import ACTS, RELEASES, Guard, Held, Switch
from spear_pin.hybrid.dual import Dual, derivative_of, value_of
from spear_pin.hybrid.tangent.derivative import BEGIN, END, Derivative, Stretch
from spear_pin.hybrid.tangent.heights import Heights, dual_heights
from spear_pin.hybrid.tangent.stretched import measure_stretch

OF_ENDS = (".*_time|period", "stride|mean_speed|turn", ".*_at_.*")


class Measures(Mapping[str, DualMeasure]):
    """Measures of a cycle by name: reading one finds it, with the others of its entry of the catalogue.

    Args:
        signals: signals of the cycle.
        entries: entries of the catalogue; see `spear_pin.gaits.measures.catalogue`.
    """

    def __init__(self, signals: Differentiated, entries: Sequence[Measure]) -> None:
        self._signals, self._entries, self._found = signals, tuple(entries), dict[int, dict[str, DualMeasure]]()

    def __getitem__(self, name: str) -> DualMeasure:
        for i, entry in enumerate(self._entries):
            if re.fullmatch(match_pattern(entry), name) and name in self._of(i):
                return self._of(i)[name]
        raise KeyError(name)

    def __iter__(self) -> Iterator[str]:
        return (name for i in range(len(self._entries)) for name in self._of(i))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _of(self, i: int) -> dict[str, DualMeasure]:
        if i not in self._found:
            entry, system, still = self._entries[i], self._signals.cycle.system, np.zeros(self._signals.start.shape[1])
            self._found[i] = {
                name: DualMeasure(float(value_of(x)), derivative_of(x) + still, unit_in(system, entry, name))
                for name, x in entry.values(self._signals).items()
            }
        return self._found[i]


def differentiate_measures(
    cycle: Derivative, start: Array, weight: Array, driven: DrivenJoints | None = None
) -> Measures:
    """Returns all named measures of a cycle, each found when it is asked for.

    Args:
        cycle: the cycle.
        start: derivatives of the state in which it begins, (2 nv, c).
        weight: derivatives of the robot's weight, (c,).
        driven: motors and drives of joints, for their heat, electricity and reserve.
    """
    return Measures(Differentiated(cycle, start, weight, driven), CATALOGUE)


@dataclass(frozen=True)
class Signal:
    """A signal along the arcs of a cycle; of half a stride also what a partner does in it, as in the other half.

    Attributes:
        pieces: the signal along each arc.
        halves: 2 with a partner, else 1.
    """

    pieces: Sequence[Pieces]
    halves: int = 1

    def __mul__(self, other: Signal | Dual | float) -> Signal:
        if isinstance(other, Signal):
            if [each.stretch for each in self.pieces] != [each.stretch for each in other.pieces]:
                raise TypeError("forces and heights are known on some arcs only: multiply them with no other signal")
            return Signal([a.times(b) for a, b in zip(self.pieces, other.pieces, strict=True)], self.halves)
        number, change = (other.x, other.d) if isinstance(other, Dual) else (other, 0.0)
        return Signal([each.times(float(number), change) for each in self.pieces], self.halves)

    __rmul__ = __mul__


class Differentiated(Signals):
    """Signals of a cycle with derivatives; numbers are dual.

    Args:
        cycle: the cycle.
        start: derivatives of the state in which it begins, (2 nv, c).
        weight: derivatives of the robot's weight, (c,).
        driven: motors and drives of joints.
    """

    def __init__(self, cycle: Derivative, start: Array, weight: Array, driven: DrivenJoints | None = None) -> None:
        self.cycle, self.start, self._weight = cycle, start, weight
        self._driven = driven or DrivenJoints(cycle.system, {}, (), 0)
        self.robot, self.section, self.stretches = cycle.system.robot, cycle.system.section, cycle.stretches

    @property
    def weight(self) -> Any:
        """The robot's weight, in N."""
        return Dual(self.robot.weight, self._weight)

    @cached_property
    def durations(self) -> dict[str, Any]:
        """Duration of each phase, in s."""
        return {phase: Dual(float(each.x), np.asarray(each.d)) for phase, each in self.cycle.durations.items()}

    @cached_property
    def period(self) -> Any:
        """Duration of the cycle, in s."""
        return sum(self.durations.values())

    @cached_property
    def _round(self) -> list[int]:
        """Coordinates that turn about the vertical without end."""
        names = self.cycle.system.cyclic
        return [self.robot.index(name) for name in names if self.robot.arm is not None or name == "yaw"]

    @cached_property
    def turn(self) -> Any:
        """Change of the heading, to the left, in rad."""
        for yaw in self._round:
            turn = float(self.cycle.y[yaw]) - float(self.stretches[0].arc.y[yaw])
            return Dual(turn, self.cycle.dy[yaw] - self.start[yaw])
        return None

    @cached_property
    def stride(self) -> Any:
        """Distance covered, in m: along the way, for half a stride along its first heading; None where it stays."""
        if self.robot.arm is not None:
            return None if self.turn is None else self.turn * self.robot.arm
        along = [i for name in self.cycle.system.cyclic if (i := self.robot.index(name)) not in self._round]
        if not along:
            return None
        begun = self.stretches[0].arc.y
        way, ways = self.cycle.y[along] - begun[along], self.cycle.dy[along] - self.start[along]
        ahead = np.ones(1) if len(way) == 1 else way / max(float(np.linalg.norm(way)), 1e-300)
        if self.cycle.system.mirrored_toes:
            yaw = float(begun[self.robot.index("yaw")])
            ahead = np.array([math.cos(yaw), math.sin(yaw)])
        return Dual(float(ahead @ way), ahead @ ways)

    @cached_property
    def observed(self) -> dict[str, Any]:
        """Height of the base at events that are only observed, in m."""
        found = dict[str, Any]()
        for stretch in long(self.stretches) if "boom_z" in self.robot.coordinates else ():
            for g, guard in enumerate(stretch.arc.domain.guards):
                if guard.observes:
                    fallen = where_it_falls(evaluate_guard(stretch, g), along(stretch, self.robot.index("boom_z")))
                    if fallen is not None:
                        found.setdefault(guard.name, Dual(*fallen))
        return found

    @cached_property
    def closing(self) -> dict[str, tuple[Any, Any]]:
        """Angle and speed of each joint just before the cycle closes, in rad and rad/s."""
        last, nv = self.stretches[-1], self.robot.nv
        dy = last.dstate + last.end.slopes[:, None] * last.tau

        def at(i: int) -> Dual:
            return Dual(float(last.arc.after[i]), dy[i])

        return {joint: (at(self.robot.index(joint)), at(nv + self.robot.index(joint))) for joint in self.robot.actuated}

    @cached_property
    def released(self) -> dict[str, Any]:
        """Deflection of springs as they release, in rad or m; of several releases the least."""
        found, system = dict[str, Any](), self.cycle.system
        for stretch in self.stretches:
            event = stretch.arc.event
            let_go = _released(event, stretch.held)
            for mount in stretch.arc.domain.mounts:
                if mount.name in let_go:
                    left = measure_stretch(system, mount, stretch, self.cycle.numbers, self.cycle.dnumbers)
                    for name, _ in with_partner(system, mount.name):
                        if name not in found or left.x < found[name].x:
                            found[name] = left
        return found

    def _signals(self, of: Callable[[str], Sequence[Pieces]], share: Callable[[str], float]) -> dict[str, Signal]:
        """Returns a signal of each joint with motors, times a share, with what its partner does in half a stride."""
        found = {}
        for joint in self.robot.actuated:
            halves = with_partner(self.cycle.system, joint)
            pieces = [each.times(sign * share(joint)) for name, sign in halves for each in of(name)]
            found[joint] = Signal(pieces, len(halves))
        return found

    @cached_property
    def torques(self) -> dict[str, Signal]:
        """Torque of one motor of each joint, in N·m."""
        return self._signals(
            lambda name: find_powered(self.stretches, self.robot, name)[0], lambda joint: 1.0 / motors_at(joint)
        )

    @cached_property
    def speeds(self) -> dict[str, Signal]:
        """Speed of each joint with motors, in rad/s."""
        nv = self.robot.nv
        return self._signals(lambda name: coordinate(self.stretches, nv + self.robot.index(name)), lambda _: 1.0)

    @cached_property
    def angles(self) -> dict[str, Signal]:
        """Angle of each joint with motors, in rad."""
        return self._signals(lambda name: coordinate(self.stretches, self.robot.index(name)), lambda _: 1.0)

    @cached_property
    def forces(self) -> dict[str, tuple[Signal, Signal]]:
        """Force along the ground, and normal to it, in N, on each toe that is on the ground."""
        found, toes = {}, self.robot.toes
        for toe in toes:
            halves = with_partner(self.cycle.system, toe)
            pairs = [each for own, _ in halves for each in forces(self.stretches, own, toes)]
            if pairs:
                found[toe] = Signal([a for a, _ in pairs], len(halves)), Signal([b for _, b in pairs], len(halves))
        return found

    @cached_property
    def heights(self) -> dict[str, Signal]:
        """Height of each toe while it is in the air, in m."""
        found, toes = {}, self.robot.toes
        heights = dual_heights(self.cycle.system, self.cycle.numbers, np.pad(self.cycle.dnumbers, ((0, 0), (0, 1))))
        for toe in toes:
            aloft = [
                _height(heights, own, each)
                for own, _ in with_partner(self.cycle.system, toe)
                for each in long(self.stretches)
                if own not in find_closed_toes(each, toes)
            ]
            if aloft:
                found[toe] = Signal(aloft, len(with_partner(self.cycle.system, toe)))
        return found

    @cached_property
    def _taken(self) -> dict[str, Any]:
        return {joint: Dual(*find_drawn(*each)) for joint in self.robot.actuated if (each := self._powered(joint))}

    def electricity(self, joint: str) -> Any:
        """Returns what all motors of a joint take from their supply, in J, and that they give nothing back."""
        return (self._taken[joint], 0.0) if joint in self._taken else None

    def reserve(self, joint: str) -> Any:
        """Returns the least torque that a motor has in reserve, at the joint, in N·m."""
        powered = self._powered(joint)
        return powered and Dual(*find_reserve(*powered))

    def _powered(self, joint: str) -> tuple[list[Pieces], list[Pieces], Behind] | None:
        """Returns the torque of a joint's motors, its speed, and the drive behind it, if there is one."""
        behind = self._driven.behind(joint)
        return behind and (*find_powered(self.stretches, self.robot, joint), behind)

    def heating(self, joint: str) -> Any:
        """Returns the heat of a joint's windings per squared torque of a motor, in W/(N·m)²."""
        return self._driven.heat(joint)

    def continuous(self, joint: str) -> Any:
        """Returns the continuous torque of a motor behind its gears, in N·m."""
        return self._driven.continuous(joint)

    def integral(self, signal: Signal) -> Any:
        """Returns ∫ of a signal over the cycle."""
        return Dual(*integral(signal.pieces)) / signal.halves

    def positive(self, signal: Signal) -> Any:
        """Returns ∫ of the positive part of a signal over the cycle."""
        return Dual(*positive(signal.pieces)) / signal.halves

    def peak(self, signal: Signal) -> Any:
        """Returns the largest value of a signal."""
        return Dual(*peak(signal.pieces))

    def amount(self, signal: Signal) -> Any:
        """Returns the largest modulus of a signal."""
        return Dual(*peak([*signal.pieces, *(signal * -1.0).pieces]))

    def ratio(self, above: Signal, below: Signal, least: Any) -> Any:
        """Returns the largest |above / below| where the signal below is at least `least`; 0 if it never is."""
        found, change = largest_ratio([*zip(above.pieces, below.pieces, strict=True)], least.x, least.d)
        return Dual(max(found, 0.0), change)


def _released(event: Guard | Switch | None, held: Held) -> set[str]:
    """Returns the names of the springs that an event releases."""
    if event is None or event.reset is None:
        return set()
    acts = [edge.mount for edge in event.reset.edges if edge.kind in (RELEASES, ACTS)]
    return {*event.reset.release, *(mount.name for mount in acts if held[str(mount.on)] == 1.0)}


def _height(heights: Heights, toe: str, stretch: Stretch) -> Pieces:
    """Returns the height of a toe along an arc; the last direction is the motion's own."""
    nv = len(stretch.y) // 2
    values, derivatives = heights.along(
        toe, stretch.y[:nv], np.concatenate([stretch.dy[:nv], stretch.y[nv:, :, None]], axis=2)
    )
    return Pieces(stretch, values, derivatives[:, :-1], derivatives[[BEGIN, END], -1])


def of_ends(names: Iterable[str]) -> bool:
    """Tells whether measures depend only on times and states of events, not on the inside of arcs."""
    return all(re.fullmatch("|".join(OF_ENDS), name) for name in names)
