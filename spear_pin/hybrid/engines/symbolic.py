"""Closed-loop motion in one domain, for scalars of any kind; the reference engine computes the same with numbers.

`Motion` is the `dyn` of laws and guards, like `pinocchio.Flow`, built from `model.mechanism`, with two
tangential directions of a toe in space and one in the plane. A scalar is any object with +, -, * and /, with elementary
functions in `ops`: heyoka's expressions, SymPy's, or NumPy arrays of many states.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, partial
from typing import Any

from spear_pin.errors import BadFunction, NotSymbolic
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import RESTS, SIGN, SLIP
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.dynamics import Row
from spear_pin.hybrid.elimination import Matrix, factorize, solve, substitute
from spear_pin.hybrid.engines.structure import Scalars
from spear_pin.hybrid.engines.trial import find_mistake
from spear_pin.hybrid.fields import adjust_law
from spear_pin.hybrid.ground import refuse_slopes
from spear_pin.hybrid.own import FOR_SYMBOLS, is_own, mistake, not_symbolic, refuse_in_law, scalar, torques
from spear_pin.hybrid.pull import Pull
from spear_pin.hybrid.rules.footing import Bound, closed_toes, of_foot, shared, size
from spear_pin.hybrid.springs import number_spring, pull_of, rest_length, torque_on
from spear_pin.model.mechanism import Feet, Mechanism
from spear_pin.model.robot_posture import lever_along, row_along
from spear_pin.model.round_feet import parts_of
from spear_pin.model.scalars import dot, negate, plus, times


@dataclass(frozen=True)
class Imposed:
    """Acceleration, forces and torques that result where motors impose accelerations.

    Attributes:
        a: acceleration, nv.
        forces: force on each toe, along the ground and normal to it, in N.
        torques: torques of all motors, with their columns.
    """

    a: list[Any]
    forces: dict[str, tuple[Any, ...]]
    torques: list[tuple[int, Any]]


class Motion:
    """Motion in one domain at one state.

    Args:
        system: the system; only its structure is used, not its numbers.
        domain: the domain.
        mechanism: the robot's dynamics.
        t: time since the phase began.
        q: configuration.
        v: velocity.
        held: held values.
        numbers: the system's numbers.
        ops: elementary functions, and `solve`.
        at_rest: toes that the controller assumes at rest on the ground; by default those on the ground or bouncing.
    """

    def __init__(
        self,
        system: HybridSystem,
        domain: Domain,
        mechanism: Mechanism,
        t: Any,
        q: Sequence[Any],
        v: Sequence[Any],
        held: Mapping[str, Any],
        numbers: Scalars,
        ops: Any,
        at_rest: Sequence[str] | None = None,
    ) -> None:
        self.system, self.domain, self.mechanism = system, domain, mechanism
        self.t, self.q, self.v, self.held, self.numbers, self.ops = t, q, v, held, numbers, ops
        self._p = adjust_law(numbers.law, held)
        robot = system.robot
        self._index = {name: i for i, name in enumerate(robot.coordinates)}
        self._closed = closed_toes(robot.toes, domain)
        bearing = {*domain.bouncing, *(toe for toe, _ in self._closed)}
        ends = {toe: held[parts_of(toe)] for toe in robot.arcs if toe in bearing}
        self._terms = mechanism.terms(q, v, ops, ends)
        ground = numbers.ground
        refuse_slopes(robot, ground)
        self._feet: Feet = self._asked("the ground", ground.above, ground.seen, (self._terms, ops))
        self._taken = [toe for toe in robot.toes if toe in bearing] if at_rest is None else list(at_rest)
        self._k = robot.dimension
        self._bound = Bound(robot)
        self._first = self._bound.first([toe for toe, _ in self._closed])
        self._motors = [self._index[joint] for joint in robot.actuated]
        self._imposed: Imposed | None = None  # by the law, if it imposes accelerations
        self._in_law = False

    # what the domain needs

    @cached_property
    def u(self) -> list[Any]:
        """Torques of the motors."""
        return self._controlled[0]

    @cached_property
    def _controlled(self) -> tuple[list[Any], Imposed | None]:
        """Returns the motor torques, and the motion that they impose if it was found together with them."""
        arguments = self.t, self.q, self.v, self.held, self._p, self, self.ops
        what, law = f"law of domain {self.domain.name!r}", self.domain.law
        self._in_law = True
        try:
            answer = self._asked(what, law, law, arguments)
        finally:
            self._in_law = False
        u = torques(what, law, answer, self.system.robot.actuated) if is_own(law) else list(answer)
        imposed = self._imposed
        if imposed is None or self.domain.rubs or {j for j, _ in imposed.torques} != set(range(len(u))):
            return u, None
        return u, imposed if all(torque is u[j] for j, torque in imposed.torques) else None

    @cached_property
    def guards(self) -> list[Any]:
        """Values of the domain's guards."""
        arguments = self.t, self.q, self.v, self.held, self._p, self, self.ops
        found = []
        for guard in self.domain.guards:
            what, value = f"guard {guard.name!r} of domain {self.domain.name!r}", guard.value
            found.append(scalar(what, value, self._asked(what, value, value, arguments)))
        return found

    @property
    def a(self) -> list[Any]:
        """Acceleration, nv."""
        return self._solution[0]

    @cached_property
    def _solution(self) -> tuple[list[Any], dict[str, tuple[Any, ...]], dict[str, Any], dict[str, Any]]:
        """Acceleration, ground force on each closed toe, pivot of each slipping toe, force on each held joint."""
        imposed = self._controlled[1]
        if imposed is not None:
            return imposed.a, imposed.forces, {}, {}
        applied = self._rubbed(self._applied(zip(self._motors, self.u, strict=True)))
        rows, directions, drift = self._constraint()
        a, multipliers, schur = self._constrained(applied, rows, directions, drift)
        forces: dict[str, tuple[Any, ...]] = {}
        pivots: dict[str, Any] = {}
        row = 0
        for (toe, mode), first in zip(self._closed, self._first, strict=True):
            if mode in RESTS:
                forces[toe], row = self._bound.force(first, multipliers, row)
                continue
            friction, normal = self.numbers.ground.friction, multipliers[row]
            forces[toe] = *(-way * friction * normal for way in self._ways[toe]), normal
            others = [i for i in range(len(schur)) if i != row]
            pivots[toe] = _complement(schur, row, others)
            row += 1
        held = [rub.joint for rub in self.domain.rubs if rub.sign == 0]
        return a, forces, pivots, dict(zip(held, multipliers[len(multipliers) - len(held) :], strict=True))

    # what laws and guards may use

    @property
    def friction_coefficient(self) -> Any:
        """μ of the ground."""
        return self.numbers.ground.friction

    @property
    def mass_matrix(self) -> Matrix:
        """D, nv rows of nv."""
        return self._terms.mass_matrix

    @property
    def bias(self) -> list[Any]:
        """C v + G, nv."""
        return self._terms.bias

    def jacobian(self, toe: str) -> Matrix:
        """Returns J of a toe, with rows along the ground and normal to it."""
        return self._feet.jacobians[toe]

    @property
    def loop_jacobian(self) -> Matrix:
        """A of the closed loops, rows of nv."""
        return self._terms.loop_rows

    def direction(self, toe: str) -> tuple[Any, ...]:
        """Returns the unit vector along the ground in which a toe slides; it has none where it begins to slide."""
        return self._ways[toe]

    @cached_property
    def _ways(self) -> dict[str, tuple[Any, ...]]:
        """Directions of the toes that slide: by the mode in the plane, along the velocity in space."""
        ways: dict[str, tuple[Any, ...]] = {}
        for toe, mode in self._closed:
            if mode in SIGN:
                ways[toe] = (SIGN[mode],)
            elif mode == SLIP:
                tangential = self.toe_velocity(toe)[:-1]
                speed = size(tangential, self.ops)
                ways[toe] = tuple(each / speed for each in tangential)
        return ways

    def toe_velocity(self, toe: str) -> tuple[Any, ...]:
        """Returns the velocity of a toe, along the ground and normal to it, in m/s."""
        return tuple(dot(row, self.v) for row in self.jacobian(toe))

    def toe_acceleration(self, toe: str) -> tuple[Any, ...]:
        """Returns the acceleration of a toe, along the ground and normal to it, in m/s²."""
        rows = zip(self.jacobian(toe), self._feet.drifts[toe], strict=True)
        return tuple(dot(row, self.a) + drift for row, drift in rows)

    def height(self, frame: str) -> Any:
        """Returns the distance of a frame from the ground, along its normal, in m."""
        if frame in self._feet.positions:
            return self._feet.positions[frame][-1]
        x, *_, z = self._terms.position(frame)
        return self.numbers.ground.above(x, z, self.ops)

    def force(self, toe: str) -> tuple[Any, ...]:
        """Returns the ground force on a toe, along the ground and normal to it, in N; not for laws."""
        if self._in_law:
            refuse_in_law("force")
        forces = self._solution[1]
        return shared(self.system.robot, toe, forces) if toe in forces else self._k * (0.0,)

    def foot_force(self, toe: str) -> tuple[Any, ...]:
        """Returns the ground force on all toes of a toe's body, as `force` does; not for laws."""
        if self._in_law:
            refuse_in_law("foot_force")
        forces = self._solution[1]
        return of_foot(self.system.robot, toe, forces) if toe in forces else self._k * (0.0,)

    def pivot(self, toe: str) -> Any:
        """Returns the effective inverse mass of the normal force of a slipping toe, in 1/kg; not for laws."""
        if self._in_law:
            refuse_in_law("pivot")
        return self._solution[2][toe]

    def holding(self, joint: str) -> Any:
        """Returns the force of the dry friction that holds a joint, or a path, at rest, in N or N·m; not for laws."""
        if self._in_law:
            refuse_in_law("holding")
        return self._solution[3][joint]

    def most(self, joint: str) -> Any:
        """Returns the force of a brake, the most that it holds, in N or N·m."""
        return self.numbers.brakes[joint].force

    def spring_torque(self, joint: str) -> Any:
        """Returns the torque of all engaged springs on a joint, in N·m; 0 where none is engaged."""
        return torque_on(self._pulls, self._index[joint])

    def stretch(self, name: str) -> Any:
        """Returns how much longer an engaged spring's path is than at rest, in rad or m."""
        return self.pull(name).stretch

    def pull(self, name: str) -> Pull:
        """Returns what an engaged spring does, by the name of its mount."""
        return pull_of(self._pulls, name)

    def normal_force(self, toe: str, u: Sequence[Any]) -> Any:
        """Returns the normal force that the motor torques `u` would give with the toes on the ground at rest, in N."""
        applied = self._applied(zip(self._motors, u, strict=True))
        rows, drift = self._at_rest()
        _, multipliers, _ = self._constrained(applied, rows, rows, drift)
        return self._bound.forces(self._taken, multipliers)[toe][-1]

    def imposing(
        self, rows: Sequence[Row], wanted: Sequence[Any], motors: Sequence[int], others: Sequence[tuple[int, Any]]
    ) -> Sequence[Any]:
        """Finds torques of some motors that make rows · v̇ = wanted with the toes on the ground at rest.

        The rows replace the motors' equations of motion. Thus v̇ and the forces are computed first, with half the
        operations, and the torques follow from the replaced equations. This is the motion if the toes are at rest and
        the law returns exactly these torques; `others` has all other motors.
        """
        n, (contacts, drift) = self.mechanism.nv, self._at_rest()
        applied = self._applied((self._motors[j], torque) for j, torque in others)
        force = [f - h for f, h in zip(applied, self.bias, strict=True)]
        system, right = self._bordered(force, contacts, drift)
        for row, a, j in zip(rows, wanted, motors, strict=True):
            i = self._motors[j]
            system[i], right[i] = [0.0] * (n + len(contacts)), a
            for k, weight in row:
                system[i][k] = plus(system[i][k], weight)
        solution = self.ops.solve(system, right)
        a, pushes = solution[:n], solution[n:]
        pulls = [dot([row[i] for row in contacts], pushes) for i in range(n)]
        torques = [dot(self.mass_matrix[i], a) - force[i] - pulls[i] for i in (self._motors[j] for j in motors)]
        forces = self._bound.forces(self._taken, pushes)
        if [(toe, True) for toe in self._taken] == [(toe, mode in RESTS) for toe, mode in self._closed]:
            self._imposed = Imposed(a, forces, [*others, *zip(motors, torques, strict=True)])
        return torques

    # parts

    def _asked(self, what: str, function: Any, call: Callable[..., Any], arguments: tuple[Any, ...]) -> Any:
        """Calls a law, a guard or the ground, and returns its answer.

        Raises:
            NotSymbolic: the function does not take such scalars.
            BadFunction: there is a mistake in the function, which shows with numbers as well.
        """
        try:
            return call(*arguments)
        except (BadFunction, NotSymbolic):
            raise
        except Exception as error:
            if is_own(function) and not isinstance(error, FOR_SYMBOLS):
                raise mistake(what, function, error) from error
            if not isinstance(error, FOR_SYMBOLS):
                raise
            found = find_mistake(self.system, self.domain, self.held)
            if found is not None and type(found.__cause__) in (type(error), type(None)):
                raise found from found.__cause__
            raise not_symbolic(what, function, error) from error

    @cached_property
    def _pulls(self) -> list[Pull]:
        posed, robot = partial(self.mechanism.posed, ops=self.ops), self.system.robot
        here, found = posed(self.q), list[Pull]()
        for mount in self.domain.mounts:
            what = f"spring of {mount.name!r} in domain {self.domain.name!r}"
            spring, path = number_spring(mount, self.system, self.numbers.springs)
            length, slope = path.length(here), path.slope(here)
            rest = rest_length(mount, spring, path, robot, self.held, posed)
            stretch = mount.stretch(spring, length, rest, self.held)
            force = self._asked(what, spring.torque, mount.pull, (spring, stretch, self.held, self.ops))
            lost = mount.lost(spring, force, self.held, self.ops)
            force = plus(plus(force, mount.idle(spring, length, self.held)), lost)
            rate = slope.rate(self.v)
            drag = self._asked(what, spring.drag, mount.drag, (spring, rate, self.held))
            slipping = mount.slipping(self.held)
            found.append(Pull(mount.name, spring, stretch, rate, force, lost, drag, slope, slipping))
        return found

    @cached_property
    def _passive(self) -> list[Any]:
        """Returns the forces of the joints' springs, dampers and friction."""
        forces = [negate(times(b, rate)) for b, rate in zip(self.numbers.joints, self.v, strict=True)]
        for pull in self._pulls:
            for i, lever in pull.slope.items():
                forces[i] = forces[i] + times(lever, pull.force + pull.drag)
        return forces

    def _applied(self, torques: Iterable[tuple[int, Any]]) -> list[Any]:
        """Returns the forces on the joints if motors give these torques, each with the index of its joint."""
        forces = list(self._passive)
        for i, torque in torques:
            forces[i] = forces[i] + torque
        return forces

    def _rubbed(self, forces: Sequence[Any]) -> list[Any]:
        """Returns forces on the joints with those of dry friction, against the motion."""
        found = list(forces)
        for rub in self.domain.rubs:
            for i, lever in lever_along(rub.along, self.system.robot) if rub.sign else ():
                found[i] = found[i] - rub.sign * lever * self.most(rub.joint)
        return found

    @cached_property
    def _factors(self) -> tuple[Matrix, list[Any]]:
        return factorize(self.mass_matrix)

    def _at_rest(self) -> tuple[Matrix, list[Any]]:
        rows: Matrix = []
        drift: list[Any] = []
        for toe, first in zip(self._taken, self._bound.first(self._taken), strict=True):
            rows += self.jacobian(toe)[first:]
            drift += self._feet.drifts[toe][first:]
        return [*rows, *self._terms.loop_rows], [*drift, *self._terms.loop_drifts]

    def _constraint(self) -> tuple[Matrix, Matrix, list[Any]]:
        rows: Matrix = []
        directions: Matrix = []
        drift: list[Any] = []
        for (toe, mode), first in zip(self._closed, self._first, strict=True):
            (*tangential, z), own = self.jacobian(toe), self._feet.drifts[toe]
            if mode in RESTS:
                rows += [*tangential, z][first:]
                directions += [*tangential, z][first:]
                drift += own[first:]
            else:
                slopes = [way * self.numbers.ground.friction for way in self._ways[toe]]
                rows.append(z)
                columns = zip(z, *tangential, strict=True)
                directions.append([plus(down, negate(dot(slopes, along))) for down, *along in columns])
                drift.append(own[-1])
        robot, rests = self.system.robot, all(mode in RESTS for _, mode in self._closed)
        held = [row_along(rub.along, robot).tolist() for rub in self.domain.rubs if rub.sign == 0]
        beside: Matrix = [*self._terms.loop_rows, *held]
        rows, directions = [*rows, *beside], [*directions, *beside]
        return rows, rows if rests else directions, [*drift, *self._terms.loop_drifts, *len(held) * (0.0,)]

    def _bordered(self, force: Sequence[Any], rows: Matrix, drift: Sequence[Any]) -> tuple[Matrix, list[Any]]:
        """Returns matrix and right-hand side of D a = force + Aᵀ λ, A a + drift = 0, for (a, λ)."""
        system = [[*row, *map(negate, column)] for row, *column in zip(self.mass_matrix, *rows, strict=True)]
        system += [[*row, *[0.0] * len(rows)] for row in rows]
        return system, [*force, *map(negate, drift)]

    def _constrained(
        self, applied: Sequence[Any], rows: Matrix, directions: Matrix, drift: Sequence[Any]
    ) -> tuple[list[Any], list[Any], Matrix]:
        """Solves D a = applied - bias + G λ under A a + drift = 0."""
        force = [f - h for f, h in zip(applied, self.bias, strict=True)]
        if directions is rows and rows:
            solution = self.ops.solve(*self._bordered(force, rows, drift))
            return solution[: len(force)], solution[len(force) :], []
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


def _complement(schur: Matrix, row: int, others: Sequence[int]) -> Any:
    """Returns the Schur complement of a diagonal entry, its rest after eliminating the others."""
    if not others:
        return schur[row][row]
    block = [[schur[i][j] for j in others] for i in others]
    return schur[row][row] - dot([schur[row][j] for j in others], solve(block, [schur[i][row] for i in others]))
