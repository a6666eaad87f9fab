"""Integrates a run's motion in one domain by compiled code; events, impacts and energies stay those of the run."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import LOCK, TIMES_FINER, check_equations
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.engines.polynomials import Polynomials
from spear_pin.hybrid.engines.taylor import AHEAD, FAILED, KINK, TIME_LIMIT
from spear_pin.hybrid.events import Watch
from spear_pin.hybrid.fields import flatten
from spear_pin.hybrid.integration import DUE, KNOT, Accuracy, Motion, integrate_motion
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.result import Piece
from spear_pin.hybrid.rules.entry import NONE

NODES, WEIGHTS = np.polynomial.legendre.leggauss(6)  # of the work done in a step of the integrator
ENDS = {TIME_LIMIT: DUE, KINK: KNOT}


class CompiledMotion:
    """Integrates as `integrate_motion` does, up to a motion's first event.

    What is rare is left to `integrate_motion`: motion on switching surfaces, toes in space that begin to slide, guards
    that are on zero as a motion begins.

    Args:
        system: the system.
        rtol: relative tolerance of the run; compiled code integrates a thousand times finer.

    Raises:
        BadValue: the system has no equations that can be compiled.
        MissingExtra: heyoka is not installed.
    """

    def __init__(self, system: HybridSystem, rtol: float) -> None:
        check_equations(system)
        taylor.require()
        unrolled = system.robot.nv <= taylor.UNROLLED
        self._numbers = Numbers(system, {}, taylor.Code(rtol / TIMES_FINER, observing=True, unrolled=unrolled))
        self._constants = self._numbers.constants(0)
        self._own = {id(domain) for domain in system.domains}

    def __call__(
        self, flow: Flow, watch: Watch, t: float, y: Array, until: float, how: Accuracy, *, keep: bool, most: int
    ) -> Motion:
        """Integrates a motion up to its first event, or up to a time; see `integrate_motion` for the arguments."""
        if id(flow.domain) in self._own and not flow.sets_out:
            with LOCK:
                found = self._integrate(flow, t, y, until)
            if found is not None:
                flow.arrive(found.t, found.y)
                if flow.evaluations > most:
                    found.event, found.why = None, "evaluation_cap"
                return found
        return integrate_motion(flow, watch, t, y, until, how, keep=keep, most=most)

    def _integrate(self, flow: Flow, t: float, y: Array, until: float) -> Motion | None:
        """Returns the motion; None where compiled code is not sure of it."""
        domain, n = flow.domain, 2 * flow.system.robot.nv
        single = self._numbers.compilation.single(domain, flow.held)
        parameters = np.array(self._constants + flatten(flow.held.values()))
        entered = single.enter(t, y[:n], parameters)
        if entered is None or entered.event != NONE:
            return None
        motion, seen, begin = Motion(entered.t, y), -1, t
        state, work = entered.y, y[n:].copy()
        while True:
            at, before = motion.t, state
            motion.t, state, end, solution = single.run(at, state, until, parameters, keep=True)
            if end == seen and motion.t - at < AHEAD:  # by rounding the event that was observed has not passed
                later = single.moment_later(at, state, parameters)
                if later is None:
                    return None
                motion.t, state = later
                continue
            if end == FAILED or solution is None:
                return None
            ends = np.array([begin, *solution.begins[1:], motion.t])
            work += self._work(flow, ends, solution, len(work))
            motion.pieces.append(Piece(begin, motion.t, _padded(solution, len(work))))
            motion.y, begin, seen = np.concatenate([state, work]), motion.t, end
            if end in ENDS:
                motion.why = ENDS[end]
                return motion
            guard = domain.guards[end]
            if not guard.observes:
                motion.event = guard
                return motion
            if single.passes_another(end, (at, before), (motion.t, state), parameters):
                return None  # two observed events within a moment
            motion.observed.append((guard.name, motion.t, motion.y))

    def _work(self, flow: Flow, ends: Array, solution: Polynomials, rows: int) -> Array:
        """Returns the energy that each flow has brought in during all steps, (rows,), by Gauss's quadrature."""
        half = 0.5 * np.diff(ends)
        times = (0.5 * (ends[:-1] + ends[1:])[:, None] + half[:, None] * NODES).ravel()
        states = _padded(solution, rows)(times).T
        powers = np.array([flow(at, y)[-rows:] for at, y in zip(times.tolist(), states, strict=True)])
        return np.asarray((half[:, None] * WEIGHTS).ravel() @ powers)


def _padded(solution: Polynomials, rows: int) -> Callable[[Array], Array]:
    """Returns the states at some times with rows of zeros below, (n + rows, times), as `Piece.state` returns them."""
    return lambda times: np.pad(solution(np.atleast_1d(times)), ((0, rows), (0, 0)))
