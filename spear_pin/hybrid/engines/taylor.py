"""The Taylor engine: one domain's closed loop compiled by heyoka, for several lanes at a time.

The vector field is `symbolic.Motion` on heyoka's expressions. Every number of law, springs and ground, and what is
held, is a run-time parameter, so that lanes may differ in them; the robot's numbers are compiled in.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import MissingExtra
from spear_pin.hybrid.automaton import OPEN, STICK, Domain, HybridSystem
from spear_pin.hybrid.engines.elimination import solve
from spear_pin.hybrid.engines.symbolic import Alternating, Motion, Numbers, with_fields
from spear_pin.model.planar import Planar

try:
    import heyoka as hy
except ImportError:  # pragma: no cover
    hy = None

Array = NDArray[np.float64]
Values = Mapping[str, Any]
TIME_LIMIT = -1  # ends of an arc that no guard ended
FAILED = -2
KINK = -3
CACHE = 2**28  # bytes of compiled code that heyoka may keep on disk
UNROLLED = 4  # coordinates: with more, code that is not unrolled is built ten times faster and runs half as fast
STEPS = 5000  # an arc takes some tens


def available() -> bool:
    """Whether heyoka is installed."""
    return hy is not None


def width() -> int:
    """Lanes that are integrated at a time: the doubles of a vector register."""
    return int(require().recommended_simd_size())


@dataclass(frozen=True)
class Point:
    """A domain at many states: what its choice and its events depend on.

    Attributes:
        slopes: dy/dt, (2 nv, n).
        guards: their values, (g, n).
        kinks: what changes sign where a law is not smooth, (k, n).
        sliding: forward speed of each closed toe, (c, n).
        forces: F_x and F_z on each closed toe, (c, 2, n).
        accelerations: forward acceleration of each closed toe, (c, n).
        pivots: of each closed toe, (c, n); 1 where it sticks.
    """

    slopes: Array
    guards: Array
    kinks: Array
    sliding: Array
    forces: Array
    accelerations: Array
    pivots: Array

    def take(self, chosen: Any) -> Point:
        """At some of the states."""
        return Point(*(getattr(self, field.name)[..., chosen] for field in fields(self)))


class Compiled:
    """A domain with held values of one shape, ready to run.

    Args:
        system: the system; of its law, springs and ground the structure counts, not the numbers.
        domain: one of its domains.
        held: what is held there, for its shape.
        tol: tolerance of the integration.
    """

    def __init__(self, system: HybridSystem, domain: Domain, held: Values, tol: float) -> None:
        hy = require()
        self.domain, self.nv = domain, system.robot.nv
        self.closed = [
            (toe, mode) for toe, mode in zip(system.robot.toes, domain.contacts, strict=True) if mode != OPEN
        ]
        names = [f"{kind}_{name}" for kind in "qv" for name in system.robot.coordinates]
        state = hy.make_vars(*names)
        q, v = state[: self.nv], state[self.nv :]
        counter = _Counter(hy.par)
        law = with_fields(system.law, {f.name: counter.number(getattr(system.law, f.name)) for f in fields(system.law)})
        spring, friction = system.spring, system.contact.friction
        numbers = Numbers(law, *map(counter.number, (spring.stiffness, spring.damping, friction)))
        kept = {name: counter.number(value) for name, value in held.items()}
        kinks: list[Any] = []
        planar, ops = Planar(system.robot), _operations(kinks)
        motion = (
            Motion(system, domain, planar, hy.time, q, v, kept, numbers, ops)
            if domain.between is None
            else Alternating(system, domain, planar, q, v, kept, numbers, ops)
        )
        slopes = [*v, *map(_expression, motion.a)]
        guards = [_expression(value) for value in motion.guards]
        self._kinks = len(kinks)
        outputs = [*slopes, *guards, *kinks]
        for toe, mode in self.closed:
            outputs += [motion.toe_velocity(toe)[0], *motion.force(toe), motion.toe_acceleration(toe)[0]]
            outputs.append(_expression(1.0 if mode == STICK else motion.pivot(toe)))
        self._function = hy.cfunc([_expression(output) for output in outputs], state)
        falling = hy.event_direction.negative
        # what is only observed changes nothing
        self._watched = [i for i, guard in enumerate(domain.guards) if not guard.observes]
        events = [hy.t_event_batch(guards[i], direction=falling) for i in self._watched]
        events += [hy.t_event_batch(kink) for kink in kinks]  # a polynomial does not bend
        self.width = width()
        start = np.full((2 * self.nv, self.width), 0.1)
        motion_of = list(zip(state, slopes, strict=True))
        compact = self.nv > UNROLLED
        self._integrator = hy.taylor_adaptive_batch(motion_of, start, tol=tol, t_events=events, compact_mode=compact)

    def at(self, t: Array, y: Array, parameters: Array) -> Point:
        """Evaluate at states y, (2 nv, n), and times t, (n,), with parameters (p, n)."""
        function, n = self._function, y.shape[1]
        given: dict[str, Array] = {}
        if function.nparams:
            given["pars"] = np.ascontiguousarray(parameters[: function.nparams])
        if function.is_time_dependent:
            given["time"] = np.ascontiguousarray(t)
        values = function(np.ascontiguousarray(y), **given)
        counts = 2 * self.nv, len(self.domain.guards), self._kinks
        slopes, guards, kinks, toes = np.split(values, np.cumsum(counts))
        toes = toes.reshape(len(self.closed), 5, n)
        return Point(slopes, guards, kinks, toes[:, 0], toes[:, 1:3], toes[:, 3], toes[:, 4])

    def run(self, t: Array, y: Array, until: Array, parameters: Array) -> tuple[Array, Array, NDArray[np.int64]]:
        """Integrate up to the first guard that falls through zero, or a time.

        Args:
            t: times, (n,).
            y: states there, (2 nv, n), at which every guard that is watched is positive.
            until: times at which to stop, (n,).
            parameters: (p, n).

        Returns:
            times, states and the guards' indices, or `TIME_LIMIT`, `KINK` or `FAILED`.
        """
        n = len(t)
        times, ends = np.empty(n), np.empty(n, np.int64)
        states = np.empty_like(y)
        for first in range(0, n, self.width):
            lanes = slice(first, min(first + self.width, n))
            count = lanes.stop - first
            padded = np.minimum(np.arange(first, first + self.width), n - 1)
            own = self._run(t[padded], y[:, padded], until[padded], parameters[:, padded])
            times[lanes], states[:, lanes], ends[lanes] = own[0][:count], own[1][:, :count], own[2][:count]
        return times, states, ends

    def _run(self, t: Array, y: Array, until: Array, parameters: Array) -> tuple[Array, Array, list[int]]:
        """The same for as many lanes as are integrated at a time."""
        integrator = self._integrator
        integrator.set_time(t)
        integrator.state[:] = y
        integrator.pars[:] = parameters[: len(integrator.pars)]
        integrator.reset_cooldowns()
        ends: list[int | None] = [None] * self.width
        until = until.copy()
        times, states = np.empty(self.width), np.empty_like(y)
        while True:
            integrator.propagate_until(until, max_steps=STEPS)
            for lane, (outcome, *_) in enumerate(integrator.propagate_res):
                if ends[lane] is not None:
                    continue
                code = int(outcome)
                if code == _LIMIT:
                    ends[lane] = TIME_LIMIT
                elif -len(self._watched) <= code < 0:
                    ends[lane] = self._watched[-code - 1]
                elif -len(self._watched) - self._kinks <= code < 0:
                    ends[lane] = KINK
                elif code != _SUCCESS:
                    ends[lane] = FAILED
                else:
                    continue
                # it stays where it is while the others go on
                times[lane], states[:, lane] = integrator.time[lane], integrator.state[:, lane]
            running = [lane for lane, end in enumerate(ends) if end is None]
            if not running:
                return times, states, [end for end in ends if end is not None]
            for lane, end in enumerate(ends):
                if end is not None:
                    integrator.state[:, lane] = y[:, lane]
                    until[lane] = integrator.time[lane]


def compiled(system: HybridSystem, domain: Domain, held: Values, tol: float) -> Compiled:
    """A domain compiled, once for each structure."""
    shape = tuple((name, _shape(value)) for name, value in held.items())
    structure = tuple((f.name, _shape(getattr(system.law, f.name))) for f in fields(system.law))
    key = (_key(system), _functions(domain), shape, structure, tol)
    if key not in _CACHE:
        _CACHE[key] = Compiled(system, domain, held, tol)
    return _CACHE[key]


def parameters(system: HybridSystem, law: Any, others: Sequence[Any], held: Values, n: int) -> Array:
    """Run-time parameters of n lanes, (p, n), in the order in which `Compiled` counts them.

    Args:
        system: the system.
        law: parameters of the law, numbers or arrays of n.
        others: stiffness, damping and friction, numbers or arrays of n.
        held: what is held, numbers or arrays of n.
        n: number of lanes.
    """
    flat: list[Any] = []
    for value in (*(getattr(law, f.name) for f in fields(system.law)), *others, *held.values()):
        _flatten(value, flat)
    rows = np.empty((len(flat), n))
    for i, value in enumerate(flat):
        rows[i] = value
    return rows


class _Counter:
    """Numbers become the next run-time parameters; what is no number is structure."""

    def __init__(self, par: Any) -> None:
        self._par, self._count = par, 0

    def number(self, value: Any) -> Any:
        if isinstance(value, tuple):
            return tuple(self.number(item) for item in value)
        if not _is_number(value):
            return value
        self._count += 1
        return self._par[self._count - 1]


def _flatten(value: Any, flat: list[Any]) -> None:
    if isinstance(value, tuple):
        for item in value:
            _flatten(item, flat)
    elif _is_number(value):
        flat.append(value)


def _is_number(value: Any) -> bool:
    return not (value is None or isinstance(value, (bool, str)))


def _shape(value: Any) -> Any:
    if isinstance(value, tuple):
        return tuple(_shape(item) for item in value)
    return float if _is_number(value) else value


def _key(system: HybridSystem) -> Any:
    """What is compiled in: the robot, and which springs there are."""
    robot, spring = system.robot, system.spring
    return system.kind, robot.source, robot.locked, tuple(sorted(robot.varied.items())), spring.unilateral, spring.rest


def _functions(domain: Domain) -> Any:
    """What tells a domain's functions from another's: they are made anew with every system."""
    between = domain.between
    functions: list[Any] = [domain.law, *(guard.value for guard in domain.guards)]
    others: tuple[str, ...] = ()
    if between is not None:
        functions += [reset.latch for reset in (between.leave, between.touch, *between.follow) if reset.latch]
        others = between.grounded.name, between.airborne.name
    return domain.name, others, tuple(map(_identity, functions))


def _identity(function: Any) -> Any:
    cells = [cell.cell_contents for cell in function.__closure__ or ()]
    plain = tuple(value for value in cells if isinstance(value, (str, int, float)))
    return function.__module__, function.__qualname__, plain


_CACHE: dict[Any, Compiled] = {}


def _operations(kinks: list[Any]) -> SimpleNamespace:
    """Elementary functions of expressions; where they are not smooth is added to `kinks`."""
    hy = require()

    def maximum(a: Any, b: Any) -> Any:
        kinks.append(a - b)
        return b + hy.relu(a - b)

    functions = {name: getattr(hy, name) for name in ("sin", "cos", "tan", "tanh", "sqrt", "exp")}
    return SimpleNamespace(**functions, maximum=maximum, solve=solve)


def _expression(value: Any) -> Any:
    return hy.expression(value) if isinstance(value, (int, float)) else value


def require() -> Any:
    """heyoka, its cache on disk bounded.

    Raises:
        MissingExtra: it is not installed.
    """
    if hy is None:
        raise MissingExtra("heyoka", "fast", "the Taylor engine")
    hy.llvm_state.set_diskcache_limit(CACHE)
    return hy


_LIMIT = int(hy.taylor_outcome.time_limit) if hy is not None else 0
_SUCCESS = int(hy.taylor_outcome.success) if hy is not None else 0
