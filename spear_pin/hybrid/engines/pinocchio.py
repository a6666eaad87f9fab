"""The reference engine: Pinocchio's dynamics, one domain at a time, with the energy ledger in the state.

The state is y = (q, v, x, w). x is the hardware's state, w the work done so far by each flow of the ledger.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import SLIPS, impose_rows, solve, solve_constrained
from spear_pin.hybrid.domain import Domain, Guard, Held
from spear_pin.hybrid.dynamics import FLOATS, Row
from spear_pin.hybrid.engines.binding import Binding
from spear_pin.hybrid.engines.own_functions import OwnFunctions
from spear_pin.hybrid.engines.sliding import GLANCE, Grounded, Sliding, Ways
from spear_pin.hybrid.engines.sprung import Sprung
from spear_pin.hybrid.fields import adjust_law
from spear_pin.hybrid.flow_names import DAMPING, by_spring, flow_names, flow_of_mount, gives
from spear_pin.hybrid.hardware import Driven, drive
from spear_pin.hybrid.own import refuse_in_law
from spear_pin.hybrid.pull import Pull
from spear_pin.hybrid.rules.footing import along, closed_toes, of_foot, shared
from spear_pin.hybrid.soundness import Latched
from spear_pin.hybrid.springs import pull_of, torque_on
from spear_pin.model.directions import WORLD_ALIGNED
from spear_pin.model.frames import frame_id
from spear_pin.model.robot_posture import row_along
from spear_pin.model.round_feet import parts_of


class Flow:
    """Motion in one domain: `flow(t, y)` is dy/dt, where t is the time since the phase began.

    It is also the `dyn` of laws and guards. After a call, `u`, `tau`, `friction`, `a`, `force(toe)` and `pulls`, of
    the springs, are those of the state it was called with; they are overwritten by the next call.
    `own` asks the functions that are not of this package. `directions` are those of the contact of toes.
    """

    def __init__(self, system: HybridSystem, domain: Domain, held: Held) -> None:
        robot = system.robot
        self.system, self.domain = system, domain
        self.evaluations = 0
        self._model, self._data, self._nv = robot.model, pin.Data(robot.model), robot.nv
        self._law = domain.law
        self.own = OwnFunctions(domain)
        self._actuated = [robot.index(joint) for joint in robot.actuated]
        self._sprung, self.pulls = Sprung(robot, domain.mounts, self.own), list[Pull]()
        self._binding = Binding(robot, system.ground, self._data)
        self._closed = closed_toes(robot.toes, domain)
        bearing = {*domain.bouncing, *(toe for toe, _ in self._closed)}
        self._at_rest = [toe for toe in robot.toes if toe in bearing]  # as the controller assumes
        self.hold(held)
        self._added, self._closure = robot.added, robot.closure
        self._joint_damping = np.array(robot.model.damping)
        self._has_friction = bool(self._joint_damping.any() or domain.rubs)
        self._zeros = np.zeros(robot.nv)
        self._dry = self._zeros.copy()
        for rub in domain.rubs:
            if rub.sign:
                self._dry -= rub.sign * rub.force * row_along(rub.along, robot)
        self._stuck = [rub.joint for rub in domain.rubs if rub.sign == 0]
        rows = [row_along(rub.along, robot) for rub in domain.rubs if rub.sign == 0]
        self._locks = np.array(rows).reshape(-1, robot.nv)  # of the constraint that paths held by friction do not move
        self._holding = np.zeros(len(self._stuck))
        self._applied = np.zeros(robot.nv)
        self._motors = robot.actuation_matrix
        self._nowhere = np.empty((0, robot.nv)), np.empty(0)
        self._hardware = system.hardware
        self._nx = len(system.hardware.names) if system.hardware is not None else 0
        self._nw, dampings, self._gives = len(flow_names(system)), by_spring(DAMPING, system), gives(system)
        self._undamped = [0.0 for _ in dampings]
        self._dampers = [dampings.index(flow_of_mount(DAMPING, system, mount)) for mount in domain.mounts]
        self._ground = system.ground
        self._level, self._plain = self._ground.level, self._ground.plain
        self._toe_ids = {toe: robot.toe_id(toe) for toe in robot.toes}
        self._frame_ids: dict[str, int] = {}
        self._slips = [(toe, mode) for toe, mode in self._closed if mode in SLIPS]
        self._k = robot.dimension
        self._sliding = Sliding(dict(self._slips))
        self._ways: Ways = {}
        self._in_law = False  # whether a user's law is being called
        self._unloaded = self._k * (0.0,)
        self._forces: dict[str, tuple[float, ...]] = {toe: self._unloaded for toe, _ in self._closed}
        self._pivots = dict.fromkeys(robot.toes, math.nan)
        self._accelerate: Callable[[Array], Array] = (
            self._slip if self._slips else self._stick if self._closed or self._stuck or self._closure else self._open
        )
        self.q = self.v = self.a = self.friction = self._viscous = self._zeros
        self.u: Sequence[float] = ()
        self.driven: Driven | None = None

    def hold(self, held: Held) -> None:
        """Replaces the held values."""
        self.held: Held = Latched(held)
        self.p = adjust_law(self.system.law, held)
        self._at: tuple[float, Array] | None = None
        self._sprung.hold(self.held)
        robot = self.system.robot
        parts = {robot.toe_id(toe): held[parts_of(toe)] for toe in self._at_rest if toe in robot.arcs}
        self.directions = self._binding.directions = robot.directions.standing(parts)

    @property
    def knots(self) -> list[Callable[[Array], float]]:
        """Functions of the configuration, (nv,); the motion is less smooth where one passes zero."""
        return self._sprung.knots

    def __call__(self, t: float, y: Array) -> Array:
        """Returns dy/dt; NaN where a law or the dynamics has no value."""
        self.evaluations += 1
        self._at = t, y
        try:
            return self._derivative(t, y)
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return np.full_like(y, np.nan)

    def visit(self, t: float, y: Array) -> None:
        """Evaluates `u`, `a` and the other results at a state, unless the last call was at that state."""
        if self._at is None or self._at[0] != t or self._at[1] is not y:
            self(t, y)

    @property
    def sets_out(self) -> bool:
        """Tells whether some toe begins to slide."""
        return self._sliding.sets_out

    @property
    def longest(self) -> float:
        """Longest step from the state that the motion has reached, in s."""
        return self._sliding.left

    def arrive(self, t: float, y: Array) -> None:
        """Records that the motion has reached a state, rather than only tried it; the results may be of one beyond."""
        self.own.fault = None
        if not self.sets_out:
            return
        slope = self(t, y)
        if not np.isfinite(slope).all():
            return
        speeds, gains = self._along_ways()
        self._sliding.arrive(speeds, gains, self._ways)
        if self.sets_out and np.isfinite(self(t + GLANCE, y + GLANCE * slope)).all():
            self._sliding.look_ahead(speeds, gains, self._along_ways()[1])

    def _along_ways(self) -> tuple[dict[str, float], dict[str, float]]:
        """Returns the speeds of sliding toes along their directions, in m/s, and their accelerations, in m/s²."""
        pairs = [(toe, self._ways[toe]) for toe, _ in self._slips]
        speeds = {toe: along(way, self.toe_velocity(toe)[:-1]) for toe, way in pairs}
        return speeds, {toe: along(way, self.toe_acceleration(toe)[:-1]) for toe, way in pairs}

    def _derivative(self, t: float, y: Array) -> Array:
        nv = self._nv
        self.q, self.v = q, v = y[:nv], y[nv : 2 * nv]
        self._binding.at(q, v)
        pin.computeAllTerms(self._model, self._data, q, v)
        if self._added is not None:
            try:
                row, inertia, bend = self._added(q)
            except BadValue as error:
                raise ValueError(str(error)) from None  # there is no derivative at this state
            self._data.M[row, row] += inertia
            self._data.nle[row] += 0.5 * bend * v[row] ** 2
        angles, rates = q.tolist(), v.tolist()
        rubbed = 0.0
        if self._has_friction:  # before the law, which may use forces
            self._viscous = -self._joint_damping * v
            self.friction = self._dry + self._viscous
            rubbed = float(self.friction @ v)
        damped, taken = self._undamped.copy(), 0.0
        self.pulls, self._passive = self._sprung.at(q, angles, rates), self._zeros.copy()
        for damper, pull in zip(self._dampers, self.pulls, strict=True):
            for index, lever in pull.slope.items():
                self._passive[index] += lever * (pull.force + pull.drag)
            damped[damper] += (pull.drag + pull.lost) * pull.rate
            taken += pull.slipping * pull.force * pull.rate
        slopes: list[float] = []
        electrical: list[float] = []
        if self._hardware is None:
            self.u = u = self._commanded(t, angles, rates)
        else:
            x = y[2 * nv : 2 * nv + self._nx].tolist()
            read = self._hardware.read(x, self._actuated, angles, rates)
            commands = self._commanded(t, *read)
            self.driven = drive(self._hardware, x, commands, [rates[index] for index in self._actuated])
            self.u, slopes, electrical = self.driven.torques, self.driven.slopes, self.driven.powers
            u = self.u
        applied, powers = self._passive.copy(), []
        for index, torque in zip(self._actuated, u, strict=True):
            applied[index] += torque
            powers.append(torque * rates[index])
        self._applied = applied
        self.a = a = self._accelerate(applied + self.friction if self._has_friction else applied)
        if self._stuck:
            self.friction += self._holding @ self._locks
            a -= np.linalg.solve(self._locks @ self._locks.T, self._locks @ a) @ self._locks  # exactly zero along them
        slipped = 0.0
        for toe, _ in self._slips:
            for force, speed in zip(self._forces[toe][:-1], self.toe_velocity(toe)[:-1], strict=True):
                slipped += force * speed
        derivative = np.empty(2 * nv + self._nx + self._nw)
        derivative[:nv] = v
        derivative[nv : 2 * nv] = a
        derivative[2 * nv :] = (*slopes, *powers, *damped, rubbed, slipped, *(taken,) * self._gives, *electrical)
        return derivative

    def _commanded(self, t: float, angles: Sequence[float], rates: Sequence[float]) -> Sequence[float]:
        """Returns the torques that the law commands."""
        arguments = t, angles, rates, self.held, self.p, self, FLOATS
        if not self.own.law:
            return self._law(*arguments)
        self._in_law = True
        try:
            return self.own.torques(self.system.robot.actuated, arguments)
        finally:
            self._in_law = False

    @property
    def tau(self) -> list[float]:
        """Total torque at each actuated joint in the last call: motor, spring and damping."""
        return [float(self._applied[index]) for index in self._actuated]

    def spring_torque(self, joint: str) -> float:
        """Returns the torque of all engaged springs on a joint in the last call, in N·m; 0 where none is engaged."""
        return float(torque_on(self.pulls, self.system.robot.index(joint)))

    def stretch(self, name: str) -> float:
        """Returns how much longer an engaged spring's path was than at rest in the last call, in rad or m."""
        return float(self.pull(name).stretch)

    def pull(self, name: str) -> Pull:
        """Returns what an engaged spring did in the last call, by the name of its mount."""
        return pull_of(self.pulls, name)

    def holding(self, joint: str) -> float:
        """Returns the force of the dry friction that held a joint at rest in the last call, in N or N·m."""
        return float(self._holding[self._stuck.index(joint)])

    def most(self, joint: str) -> float:
        """Returns Coulomb's force on a joint with dry friction, in N or N·m."""
        return next(rub.force for rub in self.domain.rubs if rub.joint == joint)

    def value(self, guard: Guard, t: float, y: Array, dyn: Any = None) -> float:
        """Returns a guard's value, NaN where it has none; call the flow with the same (t, y) first."""
        nv = self._nv
        arguments = t, y[:nv], y[nv : 2 * nv], self.held, self.p, dyn or self, FLOATS
        try:
            return self.own.value(guard, arguments) if id(guard) in self.own.guards else float(guard.value(*arguments))
        except (ArithmeticError, ValueError, np.linalg.LinAlgError):
            return math.nan

    # what laws and guards may use

    @property
    def friction_coefficient(self) -> float:
        """μ of the ground."""
        return self.system.contact.friction

    @property
    def mass_matrix(self) -> Array:
        """D, (nv, nv)."""
        return np.array(self._data.M)

    @property
    def bias(self) -> Array:
        """C v + G, (nv,)."""
        return np.array(self._data.nle)

    def jacobian(self, toe: str) -> Array:
        """Returns J of a toe, with rows along the ground and normal to it, (2, nv) or (3, nv)."""
        index = self._toe_ids[toe]
        whole = pin.getFrameJacobian(self._model, self._data, index, WORLD_ALIGNED)
        jacobian = self.directions.along(self._model, self._data, index, whole)
        return np.array(jacobian if self._level else self._ground.seen_in(jacobian))

    @property
    def loop_jacobian(self) -> Array:
        """A of the closed loops, (m, nv)."""
        return self._nowhere[0] if self._closure is None else self._closure.rows(self._data)

    def toe_velocity(self, toe: str) -> tuple[float, ...]:
        """Returns the velocity of a toe, along the ground and normal to it, in m/s."""
        index = self._toe_ids[toe]
        motion = pin.getFrameVelocity(self._model, self._data, index, WORLD_ALIGNED).vector
        velocity = self.directions.along(self._model, self._data, index, motion).tolist()
        return tuple(velocity) if self._level else self._ground.seen_in(velocity)

    def toe_acceleration(self, toe: str) -> tuple[float, ...]:
        """Returns the acceleration of a toe under the last call's `a`, along the ground and normal to it, in m/s²."""
        pin.forwardKinematics(self._model, self._data, self.q, self.v, self.a)
        index = self._toe_ids[toe]
        motion = pin.getFrameClassicalAcceleration(self._model, self._data, index, WORLD_ALIGNED).vector
        acceleration = self.directions.accelerated(self._model, self._data, index, motion).tolist()
        return tuple(acceleration) if self._level else self._ground.seen_in(acceleration)

    def direction(self, toe: str) -> tuple[float, ...]:
        """Returns the unit vector along the ground in which a toe slides, in the last call."""
        return self._ways.get(toe, (math.nan,) * (self._k - 1))

    def height(self, frame: str) -> float:
        """Returns the distance of a frame, or of a round foot about it, from the ground, along its normal, in m."""
        x, _, z = self.directions.place(self._model, self._data, self.frame(frame)).tolist()
        if self._plain:
            return float(z)
        return float(self._ground.above(x, z, FLOATS)) if self._ground.plane else self.own.above(self._ground, x, z)

    def frame(self, frame: str) -> int:
        """Returns the number of a frame in the model."""
        if frame not in self._frame_ids:
            self._frame_ids[frame] = frame_id(self._model, frame)
        return self._frame_ids[frame]

    def force(self, toe: str) -> tuple[float, ...]:
        """Returns the ground force on a toe in the last call, along the ground and normal to it, in N; not for laws."""
        if self._in_law:
            refuse_in_law("force")
        return shared(self.system.robot, toe, self._forces) if toe in self._forces else self._unloaded

    def foot_force(self, toe: str) -> tuple[float, ...]:
        """Returns the ground force on all toes of a toe's body in the last call, as `force` does; not for laws."""
        if self._in_law:
            refuse_in_law("foot_force")
        return of_foot(self.system.robot, toe, self._forces) if toe in self._forces else self._unloaded

    def pivot(self, toe: str) -> float:
        """Returns the pivot of a slipping toe in the last call, in 1/kg; not for laws.

        The pivot is the effective inverse mass of the toe's normal force.
        """
        if self._in_law:
            refuse_in_law("pivot")
        return self._pivots[toe]

    def normal_force(self, toe: str, u: Sequence[float]) -> float:
        """Returns the normal force that the motor torques `u` would give with the toes on the ground at rest, in N.

        The force is affine in `u`.

        A controller does not know that its foot slips. A torque that jumped at the onset of slip might be consistent
        with neither mode. A controller does not know of dry friction either.
        """
        applied = self._passive + self._motors @ np.asarray(u, dtype=float)
        if self._has_friction:
            applied += self._viscous
        _, multipliers = self._resting(self._at_rest, applied)
        return float(self._binding.bound.forces(self._at_rest, multipliers)[toe][-1])

    def imposing(
        self, rows: Sequence[Row], wanted: Sequence[float], motors: Sequence[int], others: Sequence[tuple[int, float]]
    ) -> Sequence[float]:
        """Finds torques of as many motors as rows that make rows · v̇ = wanted; see `Dynamics.imposing`.

        Raises:
            numpy.linalg.LinAlgError: the decoupling matrix is singular.
        """
        if not rows:
            return []
        force = self._passive - self._data.nle
        if self._has_friction:
            force += self._viscous
        for column, torque in others:
            force[self._actuated[column]] += torque
        weights = [[0.0] * self._nv for _ in rows]
        for weight, row, _ in zip(weights, rows, motors, strict=True):
            for index, value in row:
                weight[index] += value
        jacobian, drift = self._nowhere
        if self._at_rest or self._closure:
            jacobian, drift = (np.concatenate(parts) for parts in self._binding.resting(self._at_rest))
        driven = [self._actuated[column] for column in motors]
        torques: list[float] = impose_rows(self._data.M, force, jacobian, drift, weights, wanted, driven).tolist()
        return torques

    # accelerations for each kind of contact

    def _open(self, applied: Array) -> Array:
        a: Array
        if self._added is None:
            a = pin.aba(self._model, self._data, self.q, self.v, applied)
        else:
            a = solve(self._data.M, applied - self._data.nle)
        return a

    def _stick(self, applied: Array) -> Array:
        toes = [toe for toe, _ in self._closed]
        a, multipliers = self._resting(toes, applied, self._locks)
        self._forces |= self._binding.bound.forces(toes, multipliers)
        if self._stuck:
            self._holding = np.array(multipliers[-len(self._stuck) :])
        return a

    def _resting(self, toes: Sequence[str], applied: Array, locks: Array | None = None) -> tuple[Array, list[float]]:
        """Returns the acceleration with toes at rest and joints held, and the forces on toes, loops and joints."""
        rows, drifts = self._binding.resting(toes)
        if locks is not None and len(locks):
            rows, drifts = [*rows, locks], [*drifts, np.zeros(len(locks))]
        if len(rows) == 1:
            jacobian, drift = rows[0], drifts[0]
        else:
            jacobian, drift = np.concatenate(rows), np.concatenate(drifts)
        a: Array = pin.forwardDynamics(self._model, self._data, applied, jacobian, drift)
        return a, self._data.lambda_c.tolist()

    def _slip(self, applied: Array) -> Array:
        friction, net = self.system.contact.friction, applied - self._data.nle
        toes, sliding = [toe for toe, _ in self._closed], {toe for toe, _ in self._slips}
        rows, drifts = self._binding.resting(toes, sliding)
        jacobians, own_drifts = (dict(zip(toes, parts[: len(toes)], strict=True)) for parts in (rows, drifts))
        bound = np.concatenate([*rows[len(toes) :], self._locks])
        bound_drift = np.concatenate([*drifts[len(toes) :], np.zeros(len(self._locks))])
        grounded = Grounded(self._data.M, net, jacobians, own_drifts, bound, bound_drift, friction)
        self._ways = ways = self._sliding(grounded, self.toe_velocity)
        a, multiplier, schur = solve_constrained(self._data.M, net, *grounded.constraint(toes, ways))
        inverse_pivots, multipliers = np.diag(np.linalg.inv(schur)), multiplier.tolist()
        row = 0
        for toe, first in zip(toes, self._binding.bound.first(toes), strict=True):
            if toe not in ways:
                self._forces[toe], row = self._binding.bound.force(first, multipliers, row)
            else:
                normal = multipliers[row]
                self._forces[toe] = *(-friction * way * normal for way in ways[toe]), normal
                self._pivots[toe] = 1.0 / float(inverse_pivots[row])
                row += 1
        self._holding = multiplier[len(multiplier) - len(self._stuck) :]
        return a
