"""The Taylor engine for one lane: does the work of `taylor.Compiled` for a single lane, without its arrays."""

from __future__ import annotations

import math
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.elimination import responses
from spear_pin.hybrid.engines.polynomials import Polynomials
from spear_pin.hybrid.engines.structure import Structure, symbols
from spear_pin.hybrid.engines.taylor import (
    AHEAD,
    FAILED,
    MOST,
    STEPS,
    TIME_LIMIT,
    Ready,
    lowest,
    operations,
    require,
    steps,
)
from spear_pin.hybrid.rules.entry import GLIMPSES, NONE, clear, falls, is_bent, stays_on_zero, thresholds
from spear_pin.hybrid.rules.footing import LEAVES, Footing, Rubbing, fitness
from spear_pin.hybrid.rules.impact import rises, routh
from spear_pin.model.scalars import dot

UNCLEAR = -2  # marks an event on entering a domain that happens, or may happen, later than a motion is followed
OF_TOE, OF_JOINT = len(Footing._fields), len(Rubbing._fields)
FURTHER = [h for h in GLIMPSES if h > AHEAD]


class Entry(NamedTuple):
    """A domain that a state may enter.

    Attributes:
        fitness: how well it fits, by `rules.footing.fitness`; `LEAVES` at least.
        t: time at which the motion begins, in s.
        y: state at that time.
        event: the guard that falls at once, `NONE` or `UNCLEAR`.
    """

    fitness: float
    t: float
    y: Array
    event: int


class Single:
    """A compiled domain at one state at a time.

    Args:
        ready: the domain, compiled.
    """

    def __init__(self, ready: Ready) -> None:
        self.ready, self.domain, self._code = ready, ready.domain, ready.compiled
        code = self._code
        self._function = code.function
        self._count, self._timed = self._function.nparams, self._function.is_time_dependent
        outcomes = require().taylor_outcome
        self._limit, self._success = int(outcomes.time_limit), int(outcomes.success)
        self._meaning = code.meaning.tolist()
        # places of the values in the function's output
        self._slopes, kinks = 2 * code.nv, 2 * code.nv + len(self.domain.guards)
        happening = enumerate(thresholds(self.domain.guards), self._slopes)
        self._thresholds = [each for each in happening if each[1] > -math.inf]
        watched = [i for i in self._meaning if i >= 0]
        least = lowest(self.domain.guards, watched)
        self._watched = [(self._slopes + i, low) for i, low in zip(watched, least, strict=True)]
        patient = enumerate(self.domain.guards, self._slopes)
        self._patient = [(i, guard.tolerance) for i, guard in patient if 0.0 < guard.patience < math.inf]
        self._kinks, self._bends = slice(kinks, kinks + code.kinks), code.kinks > 0
        self._entered: tuple[float, Array | None, list[float]] = (0.0, None, [])  # where the domain was entered last
        toes = kinks + code.kinks
        self._toes = [(mode, toes + OF_TOE * i) for i, (_, mode) in enumerate(code.closed)]
        joints = toes + OF_TOE * len(code.closed)
        self._joints = [(rub, joints + OF_JOINT * i) for i, rub in enumerate(code.rubs)]

    @cached_property
    def _integrator(self) -> Any:
        """The integrator, made where a motion goes on: many domains of robots in space only last for an instant."""
        alone = self._code.alone
        self._state, self._parameters, self._coefficients = alone.state, alone.pars, alone.tc  # views
        return alone

    def enter(self, t: float, y: Array, parameters: Array) -> Entry | None:
        """Finds where the motion that enters the domain at a state begins; None if the domain's modes do not fit.

        The motion begins at that state or, if guards rise from zero, a moment later.

        Args:
            t: time since the phase began.
            y: the state, (2 nv,).
            parameters: run-time parameters.
        """
        here = self._values(t, y, parameters)
        values = here.tolist()
        self._entered = t, y, values
        if not math.isfinite(sum(values)):
            return Entry(math.inf, t, y, UNCLEAR)
        fits = math.inf
        if self._toes or self._joints:
            toes = ((mode, values[i : i + OF_TOE]) for mode, i in self._toes)
            fits = fitness(toes, ((rub, Rubbing(*values[i : i + OF_JOINT])) for rub, i in self._joints))
        if not fits >= LEAVES:
            return None
        waiting = [i for i, threshold in self._thresholds if values[i] <= threshold]
        on_kink = self._bends and any(map(is_bent, values[self._kinks]))
        below = [i for i, tolerance in self._patient if values[i] <= tolerance]
        if not (waiting or on_kink or below):
            return Entry(fits, t, y, NONE)
        state, later = self._later(t, y, parameters, here[: self._slopes])
        if any(later[i] <= 0.0 for i in below):  # it falls from zero, which no step would show
            return Entry(fits, t, y, UNCLEAR)
        if not (waiting or on_kink):
            return Entry(fits, t, y, NONE)
        guards, seen = self.domain.guards, later
        for h in FURTHER:
            if not any(stays_on_zero(guards[i - self._slopes], values[i], seen[i] - values[i]) for i in waiting):
                break
            seen = self._later(t, y, parameters, here[: self._slopes], h)[1]
        for i in waiting:
            guard, change = guards[i - self._slopes], seen[i] - values[i]
            if stays_on_zero(guard, values[i], change):
                return Entry(fits, t, y, UNCLEAR)
            if falls(guard, values[i], change):
                return Entry(fits, t, y, i - self._slopes)
        if not self._is_clear(later):
            rises = all(seen[i] > values[i] for i in waiting)
            # where another guard falls so soon, motion begins here: guards that rise are no events
            return Entry(fits, t, y, NONE if waiting and rises and not on_kink else UNCLEAR)
        self._entered = t + AHEAD, state, later
        return Entry(fits, t + AHEAD, state, NONE)

    def moment_later(self, t: float, y: Array, parameters: Array) -> tuple[float, Array] | None:
        """Returns time and state a moment later; None where an event is as near."""
        state, later = self._later(t, y, parameters, self._values(t, y, parameters)[: self._slopes])
        return (t + AHEAD, state) if self._is_clear(later) else None

    def passes_another(
        self, event: int, begin: tuple[float, Array], end: tuple[float, Array], parameters: Array
    ) -> bool:
        """Tells whether another event that is only observed happens within a moment of one.

        Args:
            event: index of the guard that ended a motion.
            begin: time and state at which the motion began.
            end: time and state at which it ended.
            parameters: run-time parameters.
        """
        others = [i for i, guard in enumerate(self.domain.guards, self._slopes) if guard.observes]
        others = [i for i in others if i != self._slopes + event]
        if not others:
            return False
        before = self._values(*begin, parameters)
        _, later = self._later(*end, parameters, self._values(*end, parameters)[: self._slopes])
        return any(before[i] > 0.0 >= later[i] for i in others)

    def _later(self, t: float, y: Array, parameters: Array, k1: Array, h: float = AHEAD) -> tuple[Array, list[float]]:
        """Returns the state h seconds later and the domain's values there, by Kutta's third order; k1 is dy/dt now.

        Second order is too coarse where toes begin to slide.
        """
        n = self._slopes
        k2 = self._values(t + 0.5 * h, y + 0.5 * h * k1, parameters)[:n]
        k3 = self._values(t + h, y + h * (2.0 * k2 - k1), parameters)[:n]
        state = y + h / 6.0 * (k1 + 4.0 * k2 + k3)
        return state, self._values(t + h, state, parameters).tolist()

    def _is_clear(self, later: list[float]) -> bool:
        return bool(clear([later[i] for i, _ in self._thresholds], later[self._kinks]))

    def _values(self, t: float, y: Array, parameters: Array) -> Array:
        """Returns dy/dt, guards, kinks and the numbers of toes and joints at a time and a state."""
        pars = parameters[: self._count]
        found: Array = self._function(y, pars=pars, time=t) if self._timed else self._function(y, pars=pars)
        return found

    def run(
        self,
        t: float,
        y: Array,
        until: float,
        parameters: Array,
        longest: float = math.inf,
        *,
        keep: bool = False,
    ) -> tuple[float, Array, int, Polynomials | None]:
        """Integrates up to the first event, or up to a time, as `Compiled.run` does for many lanes.

        Returns also the motion, if it is kept; its steps are not bounded by `longest`.
        """
        at, there, before = self._entered
        if at != t or there is not y:
            before = self._values(t, y, parameters).tolist()
        self._integrator.time = t
        self._state[:] = y
        self._parameters[:] = parameters[: len(self._parameters)]
        self._integrator.reset_cooldowns()
        motion = None
        if keep:
            outcome, motion = self._followed(t, until)
        else:
            outcome = int(self._integrator.propagate_until(until, **steps(until - t, longest))[0])
        t, y, end = self._integrator.time, self._state.copy(), self._end(outcome)
        after = self._values(t, y, parameters).tolist()
        for i, least in self._watched:
            if after[i] < least <= before[i] and i - self._slopes != end:  # by rounding, heyoka may find no root
                return t, y, FAILED, motion
        return t, y, end, motion

    def _followed(self, t: float, until: float) -> tuple[int, Polynomials]:
        """Integrates step by step; returns heyoka's outcome, and the motion."""
        integrator, outcome = self._integrator, self._success
        begins, coefficients = list[float](), list[Array]()
        while outcome == self._success and len(begins) < STEPS:
            begins.append(t)
            outcome = int(integrator.step(until - t, True)[0])  # named arguments would cost half a step
            t = integrator.time
            coefficients.append(self._coefficients.copy())
        return outcome, Polynomials(np.array(begins), np.array(coefficients))

    def _end(self, outcome: int) -> int:
        """Translates heyoka's outcome into the end of a motion."""
        if -len(self._meaning) <= outcome < 0:
            end: int = self._meaning[-outcome - 1]
            return end
        return TIME_LIMIT if outcome == self._limit else FAILED


class CompiledImpact:
    """The plastic impact of one toe, compiled.

    Args:
        structure: structure of the system.
        toe: the toe that strikes.
        level: level of LLVM's optimisation.
    """

    def __init__(self, structure: Structure, toe: str, level: int) -> None:
        hy, system = require(), structure.system
        self._nv = nv = system.robot.nv
        state = hy.make_vars(*[f"{kind}_{name}" for kind in "qv" for name in system.robot.coordinates])
        mechanism, numbers, _ = symbols(system, structure.mechanism, {}, hy.par)
        terms = mechanism.terms(state[:nv], state[nv:], operations([]))
        (x, z), v = numbers.ground.seen(terms, operations([])).jacobians[toe], state[nv:]
        along, up = responses(terms, [x, z])
        a_tt, a_tn, a_nn, slide, approach = dot(x, along), dot(x, up), dot(z, up), dot(x, v), dot(z, v)
        outputs = [a_tt, a_tn, a_nn, slide, approach, numbers.ground.friction, *along, *up]
        self._function = hy.cfunc([hy.expression(0.0) + value for value in outputs], state, opt_level=level)

    def __call__(self, y: Array, parameters: Array) -> Array | None:
        """Returns the state after the impact, by Routh's method; None where the toe rises."""
        nv, after = self._nv, y.copy()
        numbers = self._function(y, pars=parameters[: self._function.nparams]).tolist()
        a_tt, a_tn, a_nn, slide, approach, friction, *responses = numbers
        if rises(approach):
            return None
        (x, z), _ = routh(((a_tt, a_tn), (a_tn, a_nn)), (slide, approach), friction)
        parts = zip(y[nv:].tolist(), responses[:nv], responses[nv:], strict=True)
        after[nv:] = [rate + x * along + z * up for rate, along, up in parts]
        return after


@lru_cache(MOST)
def impact(structure: Structure, toe: str, level: int) -> CompiledImpact:
    """Compiles an impact, once for each structure."""
    return CompiledImpact(structure, toe, level)
