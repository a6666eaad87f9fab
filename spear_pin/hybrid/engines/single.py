"""The Taylor engine for one lane: what `taylor.Compiled` does for many, without their arrays."""

from __future__ import annotations

import math
from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from spear_pin.hybrid.automaton import STICK
from spear_pin.hybrid.contact import RESTING, routh
from spear_pin.hybrid.engines.elimination import dot, factorize, substitute
from spear_pin.hybrid.engines.layout import Structure, symbols
from spear_pin.hybrid.engines.taylor import BENT, FAILED, MOST, STEPS, TIME_LIMIT, Ready, require
from spear_pin.hybrid.modes import STARTS_TO_SLIDE
from spear_pin.hybrid.phases import AT_REST, SIGN, UNLOADED

Array = NDArray[np.float64]
AHEAD = 1e-6  # s: a step of third order, whose error is below rounding, takes guards off zero


class Look(NamedTuple):
    """A domain at one state.

    Attributes:
        t: time since the phase began, in s.
        y: the state, (2 nv,).
        slopes: dy/dt.
        guards: their values.
        fits: whether the domain does.
        waiting: indices of guards on zero, or beyond, that are more than observed.
        lost: whether one of them is beyond.
        bent: whether something is on a kink.
        clear: whether every guard that is more than observed is positive, and nothing at a kink.
    """

    t: float
    y: Array
    slopes: Array
    guards: list[float]
    fits: bool
    waiting: list[int]
    lost: bool
    bent: bool
    clear: bool


class Single:
    """A compiled domain at one state at a time.

    Args:
        ready: the domain, compiled.
    """

    def __init__(self, ready: Ready) -> None:
        self.domain, code = ready.domain, ready.compiled
        self._meaning: list[int] = code.meaning.tolist()
        self._n, self._integrator, self._function = 2 * code.nv, code.alone, code.function
        self._state, self._parameters = self._integrator.state, self._integrator.pars  # views
        self._counts = code.guards, code.kinks
        self._closed = [mode for _, mode in code.closed]
        self._pars, self._timed = code.function.nparams, code.function.is_time_dependent
        self._limit = int(require().taylor_outcome.time_limit)
        self._happening = [(i, guard.tolerance) for i, guard in enumerate(self.domain.guards) if not guard.observes]

    def look(self, t: float, y: Array, parameters: Array, friction: float) -> Look:
        """What there is to see at a state."""
        values = self._at(t, y, parameters)
        rest, guards = values[self._n :].tolist(), self._counts[0]
        kinks, toes = rest[guards : guards + self._counts[1]], rest[guards + self._counts[1] :]
        return Look(
            t,
            y,
            values[: self._n],
            rest[:guards],
            all(map(math.isfinite, values.tolist())) and self._fits(toes, friction),
            [i for i, tolerance in self._happening if rest[i] <= tolerance],
            any(rest[i] < -tolerance for i, tolerance in self._happening),
            any(abs(kink) <= BENT for kink in kinks),
            all(rest[i] > 0.0 for i, _ in self._happening) and all(kinks),
        )

    def ahead(self, here: Look, parameters: Array, friction: float) -> Look:
        """The same a step of Kutta's third order later."""
        n, t, y, k1 = self._n, here.t, here.y, here.slopes
        k2 = self._at(t + 0.5 * AHEAD, y + 0.5 * AHEAD * k1, parameters)[:n]
        k3 = self._at(t + AHEAD, y + AHEAD * (2.0 * k2 - k1), parameters)[:n]
        return self.look(t + AHEAD, y + AHEAD / 6.0 * (k1 + 4.0 * k2 + k3), parameters, friction)

    def _at(self, t: float, y: Array, parameters: Array) -> Array:
        values: Array
        if not self._pars:
            values = self._function(y, time=t) if self._timed else self._function(y)
        elif self._timed:
            values = self._function(y, pars=parameters[: self._pars], time=t)
        else:
            values = self._function(y, pars=parameters[: self._pars])
        return values

    def _fits(self, toes: list[float], friction: float) -> bool:
        """Whether every closed toe moves as its mode says and is kept there by its forces."""
        for i, mode in enumerate(self._closed):
            sliding, tangential, normal, acceleration, pivot = toes[5 * i : 5 * i + 5]
            at_rest = abs(sliding) <= AT_REST
            if mode == STICK:
                fits = at_rest and abs(tangential) < friction * normal - UNLOADED
            elif at_rest:
                fits = acceleration * SIGN[mode] > -STARTS_TO_SLIDE
            else:
                fits = sliding * SIGN[mode] > 0.0
            if not (fits and normal > 0.0 and pivot > 0.0):
                return False
        return True

    def run(self, t: float, y: Array, until: float, parameters: Array) -> tuple[float, Array, int]:
        """Integrate up to the first event, or a time, as `Compiled.run`."""
        self._integrator.time = t
        self._state[:] = y
        self._parameters[:] = parameters[: len(self._parameters)]
        self._integrator.reset_cooldowns()
        outcome = int(self._integrator.propagate_until(until, max_steps=STEPS)[0])
        end = TIME_LIMIT if outcome == self._limit else FAILED
        if -len(self._meaning) <= outcome < 0:
            end = self._meaning[-outcome - 1]
        return float(self._integrator.time), self._state.copy(), end


class Impact:
    """The plastic impact of one toe, compiled.

    Args:
        structure: the system's.
        toe: the toe that strikes.
    """

    def __init__(self, structure: Structure, toe: str) -> None:
        hy, system = require(), structure.system
        nv = system.robot.nv
        state = hy.make_vars(*[f"{kind}_{name}" for kind in "qv" for name in system.robot.coordinates])
        planar, _, _ = symbols(system, structure.planar, {}, hy.par)
        terms = planar.terms(state[:nv], state[nv:], hy)
        rows, factors = terms.jacobians[toe], factorize(terms.mass_matrix)
        responses = [substitute(factors, row) for row in rows]
        (x, z), v = rows, state[nv:]
        outputs = [dot(x, responses[0]), dot(x, responses[1]), dot(z, responses[1]), dot(x, v), dot(z, v)]
        outputs += [value for response in responses for value in response]
        self._function, self._nv = hy.cfunc([hy.expression(0.0) + value for value in outputs], state), nv

    def __call__(self, y: Array, parameters: Array, friction: float) -> Array:
        """The state afterwards, by Routh's method as in `contact.plastic_impact`."""
        values = self._function(y, pars=parameters[: self._function.nparams])
        a_tt, a_tn, a_nn, slide, approach = values[:5].tolist()
        if _sticks(a_tt, a_tn, a_nn, slide, approach, friction):
            determinant = a_tt * a_nn - a_tn * a_tn
            tangential = (a_tn * approach - a_nn * slide) / determinant
            normal = (a_tn * slide - a_tt * approach) / determinant
        else:
            matrix = np.array([[a_tt, a_tn], [a_tn, a_nn]])[..., None]
            tangential, normal = routh(matrix, np.array([[slide], [approach]]), friction)[0][:, 0].tolist()
        after, nv = y.copy(), self._nv
        after[nv:] += tangential * values[5 : 5 + nv] + normal * values[5 + nv :]
        return after


@lru_cache(MOST)
def impact(structure: Structure, toe: str) -> Impact:
    """An impact compiled, once for each structure."""
    return Impact(structure, toe)


def _sticks(a_tt: float, a_tn: float, a_nn: float, slide: float, approach: float, friction: float) -> bool:
    """Whether sliding stops before the impact ends, and the toe then sticks: J v⁺ = 0."""
    if approach >= -RESTING or slide == 0.0 or abs(a_tn) > friction * a_tt:
        return False
    ratio = -friction if slide > 0.0 else friction
    slide_rate, approach_rate = a_tn + a_tt * ratio, a_nn + a_tn * ratio
    stops = slide * slide_rate < 0.0
    return stops and (approach_rate <= 0.0 or -slide / slide_rate <= -approach / approach_rate)
