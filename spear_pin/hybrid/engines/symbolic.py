"""Closed-loop motion in one domain, for scalars of any kind: what the reference engine computes with numbers.

`Motion` is the `dyn` of laws and guards as `pinocchio.Flow` is, built from `model.planar`. Scalars are whatever has +,
-, * and /, with elementary functions in `ops`: heyoka's expressions, SymPy's, or NumPy arrays of many states.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass, replace
from functools import cached_property
from typing import Any

from spear_pin.hybrid.automaton import OPEN, STICK, Domain, HybridSystem, Reset
from spear_pin.hybrid.engines.elimination import Matrix, dot, factorize, negated, solve, substitute, times
from spear_pin.hybrid.phases import SIGN
from spear_pin.model.planar import Planar


@dataclass(frozen=True)
class Numbers:
    """What a system's numbers are, as scalars.

    Attributes:
        law: parameters of the control law.
        stiffness: of the springs, in N·m/rad.
        damping: of the springs, in N·m·s/rad.
        friction: of the ground.
        joints: viscous friction of each joint, in N·s/m or N·m·s/rad.
    """

    law: Any
    stiffness: Any
    damping: Any
    friction: Any
    joints: Sequence[Any]


def with_fields(instance: Any, values: Mapping[str, Any]) -> Any:
    """A dataclass with other values in some fields, which need not be valid numbers."""
    assert is_dataclass(instance)
    other = object.__new__(type(instance))
    for field in fields(instance):
        object.__setattr__(other, field.name, values.get(field.name, getattr(instance, field.name)))
    return other


class Motion:
    """Motion in one domain at one state.

    Args:
        system: the system, of which the structure counts and not the numbers.
        domain: the domain.
        planar: the robot's dynamics.
        t: time since the phase began.
        q: configuration.
        v: velocity.
        held: what is held.
        numbers: the system's numbers.
        ops: elementary functions, and `solve`.
        at_rest: toes that the controller takes to be at rest on the ground; by default those that are on it.
    """

    def __init__(
        self,
        system: HybridSystem,
        domain: Domain,
        planar: Planar,
        t: Any,
        q: Sequence[Any],
        v: Sequence[Any],
        held: Mapping[str, Any],
        numbers: Numbers,
        ops: Any,
        at_rest: Sequence[str] | None = None,
    ) -> None:
        self.system, self.domain, self.planar = system, domain, planar
        self.t, self.q, self.v, self.held, self.numbers, self.ops = t, q, v, held, numbers, ops
        robot = system.robot
        self._index = {name: i for i, name in enumerate(robot.coordinates)}
        self._terms = planar.terms(q, v, ops)
        self._factors = factorize(self._terms.mass_matrix)
        self._closed = [(toe, mode) for toe, mode in zip(robot.toes, domain.contacts, strict=True) if mode != OPEN]
        self._taken = [toe for toe, _ in self._closed] if at_rest is None else list(at_rest)
        self._motors = [self._index[joint] for joint in robot.actuated]

    # what the domain asks for

    @cached_property
    def u(self) -> list[Any]:
        """Torques of the motors."""
        return list(self.domain.law(self.t, self.q, self.v, self.held, self.numbers.law, self, self.ops))

    @cached_property
    def guards(self) -> list[Any]:
        """Values of the domain's guards."""
        arguments = self.t, self.q, self.v, self.held, self.numbers.law, self, self.ops
        return [guard.value(*arguments) for guard in self.domain.guards]

    @property
    def a(self) -> list[Any]:
        """Acceleration, nv."""
        return self._solution[0]

    @cached_property
    def _solution(self) -> tuple[list[Any], dict[str, tuple[Any, Any]], dict[str, Any]]:
        """Acceleration, ground force on each closed toe, pivot of each slipping one."""
        applied = list(self._passive)
        for index, torque in zip(self._motors, self.u, strict=True):
            applied[index] = applied[index] + torque
        rows, directions, drift = self._constraint()
        a, multipliers, schur = self._constrained(applied, rows, directions, drift)
        forces: dict[str, tuple[Any, Any]] = {}
        pivots: dict[str, Any] = {}
        row = 0
        for toe, mode in self._closed:
            if mode == STICK:
                forces[toe] = multipliers[row], multipliers[row + 1]
                row += 2
                continue
            forces[toe] = -SIGN[mode] * self.numbers.friction * multipliers[row], multipliers[row]
            others = [i for i in range(len(schur)) if i != row]
            pivots[toe] = _complement(schur, row, others)
            row += 1
        return a, forces, pivots

    # what laws and guards may ask for

    @property
    def friction_coefficient(self) -> Any:
        """μ of the ground."""
        return self.numbers.friction

    @property
    def mass_matrix(self) -> Matrix:
        """D, nv rows of nv."""
        return self._terms.mass_matrix

    @property
    def bias(self) -> list[Any]:
        """C v + G, nv."""
        return self._terms.bias

    def jacobian(self, toe: str) -> Matrix:
        """J of a toe, rows x and z."""
        return self._terms.jacobians[toe]

    def toe_velocity(self, toe: str) -> tuple[Any, Any]:
        """Velocity of a toe, x and z, in m/s."""
        x, z = self.jacobian(toe)
        return dot(x, self.v), dot(z, self.v)

    def toe_acceleration(self, toe: str) -> tuple[Any, Any]:
        """Acceleration of a toe, x and z, in m/s²."""
        (x, z), drift = self.jacobian(toe), self._terms.drifts[toe]
        return dot(x, self.a) + drift[0], dot(z, self.a) + drift[1]

    def height(self, frame: str) -> Any:
        """Height of a frame above the ground, in m."""
        if frame in self._terms.positions:
            return self._terms.positions[frame][1]
        return self.planar.position(frame, self.q, self.ops)[1]

    def force(self, toe: str) -> tuple[Any, Any]:
        """Ground force on a toe, F_x and F_z, in N."""
        return self._solution[1].get(toe, (0.0, 0.0))

    def pivot(self, toe: str) -> Any:
        """Effective inverse mass of the normal force of a slipping toe, in 1/kg."""
        return self._solution[2][toe]

    def spring_torque(self, joint: str) -> Any:
        """Torque of the joint's spring, in N·m; 0 where none is engaged."""
        return self._springs.get(joint, 0.0)

    def normal_force(self, toe: str, u: Sequence[Any]) -> Any:
        """F_z that the motor torques `u` would give with the toes on the ground at rest, in N."""
        applied = list(self._passive)
        for index, torque in zip(self._motors, u, strict=True):
            applied[index] = applied[index] + torque
        rows, drift = self._at_rest()
        _, multipliers, _ = self._constrained(applied, rows, rows, drift)
        return multipliers[2 * self._taken.index(toe) + 1]

    def response(self) -> tuple[list[Any], Matrix]:
        """(a, A) with v̇ = a + A u with the toes on the ground at rest: nv, and nv rows of nu."""
        rows, drift = self._at_rest()
        free, _, _ = self._constrained(self._passive, rows, rows, drift)
        columns = []
        for index in self._motors:
            unit = [1.0 if i == index else 0.0 for i in range(self.planar.nv)]
            columns.append(self._constrained(unit, rows, rows, [0.0] * len(rows), moving=False)[0])
        return free, [list(row) for row in zip(*columns, strict=True)]

    # parts

    @cached_property
    def _springs(self) -> dict[str, Any]:
        torques = {}
        for mount in self.domain.mounts:
            stiffness = self._own(mount.spring.stiffness, self.system.spring.stiffness, self.numbers.stiffness)
            stiffness = stiffness * self.held[mount.taut]
            torques[mount.joint] = stiffness * (self.held[mount.rest] - self.q[self._index[mount.joint]])
        return torques

    @cached_property
    def _passive(self) -> list[Any]:
        """Springs, dampers and friction of the joints."""
        forces = [negated(times(b, rate)) for b, rate in zip(self.numbers.joints, self.v, strict=True)]
        for mount in self.domain.mounts:
            i = self._index[mount.joint]
            damper = self._own(mount.spring.damping, self.system.spring.damping, self.numbers.damping)
            forces[i] = forces[i] + self._springs[mount.joint] - damper * self.v[i]
        return forces

    @staticmethod
    def _own(value: float, of_system: float, symbol: Any) -> Any:
        """A number of a mount's spring: the system's, whatever that is, or one of its own, which does not vary."""
        return symbol if value == of_system else value

    def _at_rest(self) -> tuple[Matrix, list[Any]]:
        rows: Matrix = []
        drift: list[Any] = []
        for toe in self._taken:
            rows += self.jacobian(toe)
            drift += self._terms.drifts[toe]
        return rows, drift

    def _constraint(self) -> tuple[Matrix, Matrix, list[Any]]:
        rows: Matrix = []
        directions: Matrix = []
        drift: list[Any] = []
        for toe, mode in self._closed:
            (x, z), own = self.jacobian(toe), self._terms.drifts[toe]
            if mode == STICK:
                rows += [x, z]
                directions += [x, z]
                drift += own
            else:
                slope = SIGN[mode] * self.numbers.friction
                rows.append(z)
                directions.append([down - slope * along for along, down in zip(x, z, strict=True)])
                drift.append(own[1])
        return rows, directions, drift

    def _constrained(
        self, applied: Sequence[Any], rows: Matrix, directions: Matrix, drift: Sequence[Any], moving: bool = True
    ) -> tuple[list[Any], list[Any], Matrix]:
        """Solve D a = applied - bias + G λ under A a + drift = 0, as `contact.constrained`; `moving` has bias."""
        force = [f - h for f, h in zip(applied, self.bias, strict=True)] if moving else list(applied)
        free = substitute(self._factors, force)
        if not rows:
            return free, [], []
        responses = [substitute(self._factors, direction) for direction in directions]
        schur = [[dot(row, response) for response in responses] for row in rows]
        wanted = [-(dot(row, free) + d) for row, d in zip(rows, drift, strict=True)]
        multipliers = solve(schur, wanted)
        a = [
            value + sum((m * response[i] for m, response in zip(multipliers, responses, strict=True)), 0.0)
            for i, value in enumerate(free)
        ]
        return a, multipliers, schur


class Alternating:
    """Motion on the switching surface between two domains, as `filippov.Sliding`.

    Both laws act as if their phase had just begun, so that what they hold is latched anew at every instant.

    Args:
        system: the system.
        domain: as of `filippov.chatter`.
        planar: the robot's dynamics.
        q: configuration.
        v: velocity.
        held: what is held.
        numbers: the system's numbers.
        ops: elementary functions, and `solve`.

    Raises:
        TypeError: a latch branches on a value, which symbols do not have.
    """

    def __init__(
        self,
        system: HybridSystem,
        domain: Domain,
        planar: Planar,
        q: Sequence[Any],
        v: Sequence[Any],
        held: Mapping[str, Any],
        numbers: Numbers,
        ops: Any,
    ) -> None:
        between = domain.between
        assert between is not None

        def latched(*resets: Reset) -> Mapping[str, Any]:
            now = held
            for reset in resets:
                if reset.latch is not None:
                    now = {**now, **reset.latch(q, v, now, numbers.law)}
            return now

        unloaded = replace(between.grounded, contacts=between.airborne.contacts)
        bearing = [toe for toe, mode in zip(system.robot.toes, between.grounded.contacts, strict=True) if mode != OPEN]
        leaves, touches = latched(between.leave), latched(between.touch, *between.follow)
        self._flight = Motion(system, between.airborne, planar, 0.0, q, v, leaves, numbers, ops)
        self._stance = Motion(system, unloaded, planar, 0.0, q, v, touches, numbers, ops, bearing)
        self._domain, self._arguments = domain, (0.0, q, v, leaves, numbers.law, self, ops)
        fall, rise = (motion.toe_acceleration(between.toe)[1] for motion in (self._flight, self._stance))
        self.share = fall / (fall - rise)
        self.a = self._blend(self._stance.a, self._flight.a)
        self.u = self._blend(self._stance.u, self._flight.u)

    @cached_property
    def guards(self) -> list[Any]:
        """Values of the domain's guards."""
        return [guard.value(*self._arguments) for guard in self._domain.guards]

    def height(self, frame: str) -> Any:
        """Height of a frame above the ground, in m."""
        return self._flight.height(frame)

    def toe_velocity(self, toe: str) -> tuple[Any, Any]:
        """Velocity of a toe, x and z, in m/s."""
        return self._flight.toe_velocity(toe)

    def toe_acceleration(self, toe: str) -> tuple[Any, Any]:
        """Acceleration of a toe, x and z, in m/s²."""
        x, z = self._blend(self._stance.toe_acceleration(toe), self._flight.toe_acceleration(toe))
        return x, z

    def force(self, toe: str) -> tuple[Any, Any]:
        """Ground force on a toe, F_x and F_z, in N."""
        x, z = self._blend(self._stance.force(toe), self._flight.force(toe))
        return x, z

    def pivot(self, toe: str) -> Any:
        """Effective inverse mass of the normal force of a slipping toe, in 1/kg."""
        return self._flight.pivot(toe)

    def _blend(self, stance: Sequence[Any], flight: Sequence[Any]) -> list[Any]:
        return [self.share * s + (1.0 - self.share) * f for s, f in zip(stance, flight, strict=True)]


def _complement(schur: Matrix, row: int, others: Sequence[int]) -> Any:
    """A diagonal entry's Schur complement: what is left of it when the others are eliminated."""
    if not others:
        return schur[row][row]
    block = [[schur[i][j] for j in others] for i in others]
    return schur[row][row] - dot([schur[row][j] for j in others], solve(block, [schur[i][row] for i in others]))
