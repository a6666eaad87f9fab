"""The Taylor engine: heyoka compiles one domain's closed loop for several lanes at a time.

The vector field is `symbolic.Motion` on heyoka's expressions. Every number of law, springs and ground, and every held
value, is a run-time parameter, so that lanes may differ in them; the robot's numbers are compiled in.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cache, cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.errors import MissingExtra, brief, import_extra
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Guard
from spear_pin.hybrid.dynamics import Operations
from spear_pin.hybrid.elimination import solve_sparse
from spear_pin.hybrid.engines.alternating import Alternating
from spear_pin.hybrid.engines.structure import Structure, symbols
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.own import is_own, mistake
from spear_pin.hybrid.rules.entry import AWAY
from spear_pin.hybrid.rules.footing import Footing, Rubbing, closed_toes, fitness, make_footing, make_rubbing
from spear_pin.model.equations import mechanism_of

Values = Mapping[str, Any]
TIME_LIMIT = -1  # marks the end of an arc that no guard ended
FAILED = -2
KINK = -3
CACHE = 2**28  # bytes of compiled code that heyoka may keep on disk
LEVEL = 3  # of LLVM's optimisation; code compiled with level 0 runs half as fast, and compiles in a sixth of the time
MOST = 64  # number of compiled domains that are kept, about 10 MB each, in space 50
UNROLLED = 4  # most coordinates that are unrolled by default; with more, compiling takes too long
AHEAD = AWAY[0]  # s: how far guards on zero are followed where a lane runs alone
STEPS = 5000  # most steps of an arc, which takes some tens


def available() -> bool:
    """Tells whether heyoka is installed."""
    try:
        require()
    except MissingExtra:
        return False
    return True


def width() -> int:
    """Returns the number of lanes integrated at a time, which is the number of doubles in a vector register."""
    return int(require().recommended_simd_size())


@dataclass(frozen=True)
class Point:
    """Values of a domain at many states, on which its choice and its events depend.

    Attributes:
        slopes: dy/dt, (2 nv, n).
        guards: values of the guards, (g, n).
        kinks: values that change sign where a law is not smooth, (k, n).
        feet: numbers of `rules.footing.Footing` for each closed toe, (c, 6, n).
        joints: numbers of `rules.footing.Rubbing` for each joint with a brake on it, (b, 4, n).
    """

    slopes: Array
    guards: Array
    kinks: Array
    feet: Array
    joints: Array

    def take(self, chosen: Any) -> Point:
        """Returns the values at some of the states."""
        return Point(*(getattr(self, field.name)[..., chosen] for field in fields(self)))


@dataclass(frozen=True)
class Code:
    """How domains are compiled.

    Attributes:
        tol: tolerance of the integration.
        observing: whether events that are only observed stop the integration, too.
        unrolled: whether loops are unrolled; code then runs two to three times as fast and compiles ten times as long.
        level: level of LLVM's optimisation, from 0 to 3.
    """

    tol: float
    observing: bool = False
    unrolled: bool = True
    level: int = field(default_factory=lambda: LEVEL)


class Field(NamedTuple):
    """A domain at a symbolic state: dy/dt, guard values, kinks, and the motion that gave them."""

    slopes: list[Any]
    guards: list[Any]
    kinks: list[Any]
    motion: Any


class Compiled:
    """Motion and guards of a domain with held values of one shape; `Ready` adds the effects of its events.

    Args:
        system: the system; only the structure of its law, springs and ground is used, not the numbers.
        domain: one of its domains.
        held: values held in the domain, of which only the shape is used.
        code: how the domain is compiled.

    Attributes:
        closed: toes on the ground, with their modes.
        rubs: brakes on joints, with their modes.
        state: symbols of q and v.
        numbers: the system's numbers, as symbols.
        here: the domain at `state`.
        kinks: number of kinks.
        level: level of LLVM's optimisation.
        meaning: the guard's index, or `KINK`, for each event of the integrators.
    """

    def __init__(self, system: HybridSystem, domain: Domain, held: Values, code: Code) -> None:
        hy = require()
        self.nv, self.guards = system.robot.nv, len(domain.guards)
        self.closed, self.rubs = closed_toes(system.robot.toes, domain), domain.rubs
        self.state = hy.make_vars(*[f"{kind}_{name}" for kind in "qv" for name in system.robot.coordinates])
        mechanism, self.numbers, kept = symbols(system, mechanism_of(system.robot), held, hy.par)

        flat: list[Any] = []
        kinks: list[Any] = []
        q, v, ops = self.state[: self.nv], self.state[self.nv :], operations(kinks, flat)
        motion = (
            Motion(system, domain, mechanism, hy.time, q, v, kept, self.numbers, ops)
            if domain.between is None
            else Alternating(system, domain, mechanism, q, v, kept, self.numbers, ops)
        )
        slopes, guards = [*v, *map(_expression, motion.a)], list(map(_expression, motion.guards))
        for guard, value in zip(domain.guards, guards, strict=True):
            if not isinstance(value, hy.expression):
                what = f"guard {guard.name!r} of domain {domain.name!r}"
                raise mistake(what, guard.value, f"it gives {brief(value)}; expected a number")
        self.here = Field(slopes, guards, kinks, motion)
        self.kinks = len(kinks)
        moving = [_changes(value) for value in guards]  # others never fall
        watched = [i for i, guard in enumerate(domain.guards) if moving[i] and (code.observing or not guard.observes)]
        self._motion = list(zip(self.state, slopes, strict=True))
        falling, either = hy.event_direction.negative, hy.event_direction.any
        # a polynomial does not bend
        self._events = [*((guards[i], falling) for i in watched), *((kink, either) for kink in kinks)]
        self.meaning = np.array([*watched, *[KINK] * len(kinks)], dtype=np.int64)  # of its events
        # steps resolve these though they are no events: far from the steep part of exp and tanh their series fail
        own = not system.ground.plane or any(is_own(guard.value) for guard in domain.guards)
        self._resolved = [2.0 + hy.sin(2.0 * (1.0 + argument**2.0) ** 0.25) for argument in flat] if own else []
        self.level = code.level
        self._settings = {"tol": code.tol, "compact_mode": not code.unrolled, "opt_level": code.level}
        self.width = width()
        self._somewhere = np.full((2 * self.nv, 1), 0.1)  # a finite state

    @cached_property
    def function(self) -> Any:
        """Compiles a function that returns all of `Point`."""
        slopes, guards, kinks, motion = self.here
        feet = [number for toe, mode in self.closed for number in make_footing(motion, toe, mode, operations([]))]
        joints = [number for rub in self.rubs for number in make_rubbing(motion, rub)]
        outputs = [*slopes, *guards, *kinks, *feet, *joints]
        return require().cfunc([_expression(output) for output in outputs], self.state, opt_level=self.level)

    @cached_property
    def _integrator(self) -> Any:
        events = [require().t_event_batch(value, direction=direction) for value, direction in self._events]
        start = np.repeat(self._somewhere, self.width, axis=1)
        beside = [require().nt_event_batch(value, _nothing) for value in self._resolved]
        return require().taylor_adaptive_batch(self._motion, start, t_events=events, nt_events=beside, **self._settings)

    @cached_property
    def alone(self) -> Any:
        """Makes the integrator of one lane."""
        events = [require().t_event(value, direction=direction) for value, direction in self._events]
        beside = [require().nt_event(value, _nothing) for value in self._resolved]
        start = self._somewhere[:, 0]
        return require().taylor_adaptive(self._motion, start, t_events=events, nt_events=beside, **self._settings)

    def at(self, t: Array, y: Array, parameters: Array) -> Point:
        """Evaluates the domain at states y, (2 nv, n), and times t, (n,), with parameters (p, n)."""
        function, n = self.function, y.shape[1]
        given: dict[str, Array] = {}
        if function.nparams:
            given["pars"] = np.ascontiguousarray(parameters[: function.nparams])
        if function.is_time_dependent:
            given["time"] = np.ascontiguousarray(t)
        values = function(np.ascontiguousarray(y), **given)
        of_foot, of_joint = len(Footing._fields), len(Rubbing._fields)
        counts = 2 * self.nv, self.guards, self.kinks, of_foot * len(self.closed)
        slopes, guards, kinks, feet, joints = np.split(values, np.cumsum(counts))
        toes, rubs = feet.reshape(len(self.closed), of_foot, n), joints.reshape(len(self.rubs), of_joint, n)
        return Point(slopes, guards, kinks, toes, rubs)

    def run(
        self, t: Array, y: Array, until: Array, parameters: Array, longest: float = math.inf
    ) -> tuple[Array, Array, NDArray[np.int64]]:
        """Integrates up to the first guard that falls through zero, or up to a time.

        Args:
            t: initial times, in s, (n,).
            y: initial states, (2 nv, n), at which every watched guard is positive.
            until: times at which to stop, in s, (n,).
            parameters: run-time parameters, (p, n).
            longest: longest step, in s.

        Returns:
            final times, states, and the guards' indices, or `TIME_LIMIT`, `KINK` or `FAILED`.
        """
        n, width = len(t), self.width
        padded = np.arange(-(-n // width) * width)
        padded[n:] = n - 1

        def blocks(rows: Array) -> Array:
            return np.ascontiguousarray(rows[:, padded].reshape(len(rows), -1, width).transpose(1, 0, 2))

        times, stops = (blocks(each[None])[:, 0] for each in (t, until))
        states, numbers = blocks(y), blocks(parameters[: len(self._integrator.pars)])
        codes = np.empty(times.shape, np.int64)
        for block in zip(times, states, stops, numbers, codes, strict=True):
            self._run(*block, longest)
        codes = codes.ravel()[:n]
        ends = np.where(codes == int(require().taylor_outcome.time_limit), TIME_LIMIT, FAILED)
        events = (codes < 0) & (codes >= -len(self.meaning))  # the first is -1
        ends[events] = self.meaning[-codes[events] - 1]
        return times.ravel()[:n], states.transpose(1, 0, 2).reshape(len(y), -1)[:, :n].copy(), ends

    def _run(
        self, t: Array, y: Array, until: Array, parameters: Array, codes: NDArray[np.int64], longest: float
    ) -> None:
        """Integrates one register of lanes; sets times, states and heyoka's outcomes in place."""
        bounds = steps(float(np.max(until - t)), longest)
        integrator, success = self._integrator, int(require().taylor_outcome.success)
        integrator.set_time(t)
        integrator.state[:] = y
        integrator.pars[:] = parameters
        integrator.reset_cooldowns()
        codes[:] = success
        while True:
            integrator.propagate_until(until, **bounds)
            outcomes = np.array([int(result[0]) for result in integrator.propagate_res])
            done = (codes == success) & (outcomes != success)
            times = np.where(np.isfinite(integrator.time), integrator.time, t)  # a lane that diverges may have none
            t[done], y[:, done], codes[done] = times[done], integrator.state[:, done], outcomes[done]
            if success not in codes:
                return
            # lanes that are done keep their states while the others continue
            ready = codes != success
            integrator.state[:, ready] = self._somewhere
            if not np.array_equal(times, integrator.time):
                integrator.set_time(times)
            until = np.where(ready, times, until)


@dataclass(frozen=True, eq=False)
class Ready:
    """A domain of a system with its compiled code, which other systems may share.

    Attributes:
        domain: the domain, with the events of this system.
        compiled: its compiled motion and guards.
    """

    domain: Domain
    compiled: Compiled

    def fitness(self, point: Point) -> Array:
        """Returns how well the domain fits each evaluated state, (n,), by `rules.footing.fitness`."""
        feet = [(mode, foot) for (_, mode), foot in zip(self.compiled.closed, point.feet, strict=True)]
        joints = [(rub, Rubbing(*each)) for rub, each in zip(self.compiled.rubs, point.joints, strict=True)]
        return np.broadcast_to(np.asarray(fitness(feet, joints), np.float64), point.slopes.shape[1:])

    def run(
        self, t: Array, y: Array, until: Array, parameters: Array, longest: float = math.inf
    ) -> tuple[Array, Array, NDArray[np.int64]]:
        """Integrates up to the first guard that falls through zero, or up to a time; see `Compiled.run`."""
        at, found = self.compiled.at, self.compiled.run(t, y, until, parameters, longest)
        found[2][self._unseen(at(t, y, parameters), at(*found[:2], parameters), found[2])] = FAILED
        return found

    def _unseen(self, before: Point, after: Point, ends: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Tells in which lanes a guard that is no event fell through zero: by rounding, heyoka may find no root."""
        watched = self.compiled.meaning[self.compiled.meaning >= 0]
        least = np.array(lowest(self.domain.guards, watched))[:, None]
        fell = (before.guards[watched] >= least) & (after.guards[watched] < least) & (watched[:, None] != ends)
        return np.asarray(fell.any(axis=0))


@lru_cache(MOST)
def compile_domain(structure: Structure, code: Code) -> Compiled:
    """Compiles a domain, once for each structure."""
    return Compiled(structure.system, structure.domain, structure.held, code)


def lowest(guards: Sequence[Guard], watched: Iterable[int]) -> list[float]:
    """Returns below which values of some guards are only after their events; what is observed goes on below zero."""
    return [-math.inf if guards[i].observes else -max(guards[i].tolerance, guards[i].patience) for i in watched]


def steps(duration: float, longest: float) -> dict[str, Any]:
    """Returns heyoka's bounds on steps for a duration in s: their number, and the longest in s."""
    if longest == math.inf:
        return {"max_steps": STEPS}
    return {"max_steps": STEPS + math.ceil(duration / longest), "max_delta_t": longest}


def operations(kinks: list[Any], flat: list[Any] | None = None) -> Operations:
    """Returns the elementary functions of expressions.

    Args:
        kinks: list that receives the values that change sign where a function is not smooth.
        flat: list that receives the arguments of functions that are almost constant far from zero.
    """
    hy, arguments = require(), [] if flat is None else flat

    def maximum(a: Any, b: Any) -> Any:
        kinks.append(a - b)
        return b + hy.relu(a - b)

    def tanh(a: Any) -> Any:
        arguments.append(_expression(a))
        return hy.tanh(a)

    def exp(a: Any) -> Any:
        arguments.append(_expression(a))
        return hy.exp(a)

    functions = {name: getattr(hy, name) for name in ("sin", "cos", "tan", "sqrt", "atan2")}
    return Operations(**functions, tanh=tanh, exp=exp, maximum=maximum, solve=solve_sparse)


def _changes(value: Any) -> bool:
    """Tells whether an expression depends on the state or on time, not on parameters alone."""
    hy = require()
    return bool(hy.get_variables(hy.subs(value, {hy.time: hy.expression("time")})))


def _nothing(*_: Any) -> None:
    """Does nothing where a guard is only resolved."""


def _expression(value: Any) -> Any:
    return require().expression(value) if isinstance(value, (int, float)) else value


def require() -> Any:
    """Returns heyoka, set to work on its caller's thread in the whole process; the first call waits for it to load.

    Raises:
        MissingExtra: heyoka is not installed.
    """
    heyoka = import_extra("heyoka", "fast", "the Taylor engine")
    _settle(heyoka)
    return heyoka


@cache
def _settle(heyoka: Any) -> None:
    """Bounds heyoka's cache on disk, and keeps it to its caller's thread, as idle threads would wait busily."""
    try:
        heyoka.llvm_state.set_diskcache_limit(CACHE)
    except RuntimeError:  # the cache is damaged, or cannot be written: all is compiled anew
        heyoka.llvm_state.set_diskcache_enabled(False)
    heyoka.set_nthreads(1)
