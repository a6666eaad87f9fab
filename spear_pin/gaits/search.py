"""Find periodic gaits: any parameters varied, any measures of the cycle as targets."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import BadValue, NoGait, SpearError, UnknownName
from spear_pin.gaits.diagnosis import Reached, explained
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.targets import check_wanted
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.newton import CONVERGED, NO_NEIGHBOUR, NO_PROGRESS, NO_START, TOO_LONG, Lanes
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import (
    EVALUATIONS,
    chart,
    displacement,
    eigenvalues,
    multipliers,
    one_by_one,
    return_map,
)
from spear_pin.hybrid.result import Moment, Options, Run, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.section import Chart
from spear_pin.hybrid.shooting import Shooting
from spear_pin.hybrid.translation import translations, without
from spear_pin.kinds import typed

if TYPE_CHECKING:
    from spear_pin.gaits.tangent_cycles import TangentCycles

Array = NDArray[np.float64]
Measure = Callable[[Run], float]

SETTLE = 12  # cycles of simulation before Newton's method
SETTLING = Options(rtol=1e-7, max_evaluations=EVALUATIONS)  # of each of these
STRAINED = 2  # cycles with more evaluations than any gait's, after which a search is given up
ENOUGH = 200_000  # evaluations after which no continuation is begun or refined
TOLERANCE = 1e-10  # of Newton's method, or the integrator's where that is finer
ROUGH_RTOL, ROUGH_TOLERANCE = 1e-8, 1e-6  # of the integrator and of Newton's method until a solution is near
RESIDUAL = 1e-9
FACTORS = (1.0, 0.9, 1.1, 0.8, 1.2)  # of the varied parameters' starting values, tried in turn
A_CYCLE = 2000  # evaluations that one with derivatives is counted as
SHORTEST_STEP = 1.0 / 16.0  # of the way to the targets: the first one, and the last where steps have to shrink
WHY: Mapping[str, str] = {
    NO_START: "the cycle does not close at the starting point",
    NO_NEIGHBOUR: "the cycle does not close near an iterate",
    NO_PROGRESS: "Newton's method makes no progress",
    TOO_LONG: "Newton's method did not converge in {n} iterations",
}


@typed
def find_gait(
    system: HybridSystem,
    vary: Sequence[str] = (),
    target: Mapping[str | Measure, float] | None = None,
    *,
    guess: State | None = None,
    rtol: float = 1e-10,
    on_iteration: Callable[[int, float], object] = lambda n, norm: None,
) -> Gait:
    """Solve x = P(x) of (4.12) together with the targets, by Newton's method on the return map.

    Cycles come with exact derivatives where the fast engine runs them (in the plane, without hardware, heyoka being
    installed, all targets measures by name); elsewhere they are the reference engine's, and differenced. That one has
    the last word on every gait: its residual is of `rtol`.

    Where that fails, the same is tried from other starting values of the parameters, and then the
    fixed point of each start is carried to the targets step by step.

    Args:
        system: robot, law, spring and ground; its parameters are the starting values.
        vary: parameters to solve for, named as fields of the law, spring or contact.
        target: wanted values of measures of the cycle; a measure is a name among
            `system.measures`, or a function of the one-cycle `Run`.
        guess: a state (q, v) on the section; by default the system's own, run for a few cycles.
        rtol: relative tolerance of the integrator.
        on_iteration: called with the iteration and the residual.

    Raises:
        UnknownName: unknown parameter or measure.
        BadValue: not as many targets as parameters, or a target that no cycle has: no finite number, or a flight that
            closes none, see `HybridSystem.shortest_flight`.
        NoGait: no periodic gait was found from here; the text says why, and of a hop what is likely to be the cause and
            what to try.

    Example:
        >>> from spear_pin import find_gait, hopping, load
        >>> system = hopping(load("spear_ii", locked=["boom_x"]))
        >>> gait = find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2})
        >>> round(gait.parameters["stance_torque"], 2), gait.stable  # N·m
        (7.83, True)
    """
    target = dict(target or {})
    if len(vary) != len(target):
        raise BadValue("target", target, f"as many targets as parameters to vary, {len(vary)}")
    for name in target:
        if not callable(name) and name not in system.measures:
            raise UnknownName("target", name, system.measures)
    check_wanted(system, target)
    measures = tuple(name if callable(name) else system.measures[name] for name in target)
    wanted = np.array(list(target.values()), dtype=float)
    search = _Search(tuple(vary), measures, wanted, rtol, on_iteration, _compiled(system, vary, tuple(target)))
    start = np.array([parameter(system, name) for name in vary])
    factors = FACTORS if vary else FACTORS[:1]
    begun = [with_parameters(system, dict(zip(vary, (k * start).tolist(), strict=True))) for k in factors]
    attempts = [(search.directly, i) for i in range(len(begun))]
    attempts += [(search.by_continuation, i) for i in range(2)] if vary else []
    settled: list[State] = []
    failures: list[NoGait] = []
    try:
        for approach, i in attempts:
            if len(settled) == i:
                settled.append(guess if guess is not None else search.settled(begun[i]))
            try:
                return search.gait(*approach(begun[i], settled[i]))
            except NoGait as failure:
                failures.append(failure)
            tried = len(failures) >= len(begun)
            if search.effort.reached or (tried and search.effort.evaluations > ENOUGH):
                break  # a path to the targets ends where it did, begun anywhere
    except _Hopeless:
        residual = min((failure.residual for failure in failures), default=np.inf)
        failures = [NoGait(f"cycles take more than {EVALUATIONS} evaluations each, which no gait's does", residual)]
    nearest = min(failures, key=lambda each: each.residual)
    raise explained(nearest, system, vary, target, search.effort.reached) from None


def gait_beside(
    system: HybridSystem, state: State, vary: Sequence[str], target: Mapping[str, float], rtol: float = 1e-10
) -> Gait:
    """The fixed point beside a state that all but is one: Newton's method from there, and nothing else.

    Args:
        system: as of `find_gait`.
        state: (q, v) on the section.
        vary: names of the parameters to solve for.
        target: wanted values of as many measures, by name.
        rtol: relative tolerance of the integrator.

    Raises:
        NoGait: Newton's method does not end in one.
    """
    measures = tuple(system.measures[name] for name in target)
    wanted = np.array(list(target.values()), dtype=float)
    exact = _compiled(system, vary, tuple(target))
    search = _Search(tuple(vary), measures, wanted, rtol, lambda n, norm: None, exact)
    try:
        return search.gait(*search.newton(system, state, search.wanted, rtol, min(TOLERANCE, rtol)))
    except _Hopeless:
        raise NoGait(f"cycles take more than {EVALUATIONS} evaluations each", np.inf) from None


def _compiled(system: HybridSystem, vary: Sequence[str], target: Sequence[str | Measure]) -> TangentCycles | None:
    """Cycles with exact derivatives, of systems with any values of what varies; None where nothing compiles them."""
    from spear_pin.gaits.tangent_cycles import tangent_cycles  # which imports heyoka: only who searches waits for that

    return tangent_cycles(system, vary, target)


@dataclass
class _Effort:
    """What a search has done so far.

    Attributes:
        evaluations: right-hand sides of its cycles.
        strained: cycles that ran into the cap on evaluations.
        reached: the farthest that a continuation came.
    """

    evaluations: int = 0
    strained: int = 0
    reached: Reached | None = None


@dataclass(frozen=True)
class _Search:
    """Search for the gait: what is varied, measured and wanted, and cycles with derivatives, if there are any."""

    vary: tuple[str, ...]
    measures: tuple[Measure, ...]
    wanted: Array
    rtol: float
    on_iteration: Callable[[int, float], object]
    exact: TangentCycles | None
    effort: _Effort = field(default_factory=_Effort)

    def directly(self, system: HybridSystem, state: State) -> tuple[HybridSystem, State]:
        """The system and state that meet the targets, by Newton's method."""
        return self.newton(*self.roughly(system, state, self.wanted), self.wanted, self.rtol, min(TOLERANCE, self.rtol))

    def by_continuation(self, system: HybridSystem, state: State) -> tuple[HybridSystem, State]:
        """The system and state, from the fixed point of the system as it is, the targets moved step by step."""
        exact = None if self.exact is None else _compiled(system, (), ())
        unasked = _Search((), (), self.wanted[:0], self.rtol, self.on_iteration, exact, self.effort)
        system, state = unasked.roughly(system, state, self.wanted[:0])
        begin = self.measure(return_map(system, state, self.rtol))
        done, step, growth = 0.0, SHORTEST_STEP, 2.0
        while done < 1.0:
            reach = min(1.0, done + step)
            try:
                system, state = self.roughly(system, state, begin + reach * (self.wanted - begin))
                done, step, growth = reach, growth * step, 2.0
                self.effort.reached = Reached(done, system, state)
            except NoGait:
                step, growth = 0.5 * step, 1.0
                if step < SHORTEST_STEP or self.effort.evaluations > ENOUGH:
                    raise
        return self.directly(system, state)

    def roughly(self, system: HybridSystem, state: State, wanted: Array) -> tuple[HybridSystem, State]:
        """The system and state that meet the targets to a few digits, at less than half the cost."""
        return self.newton(system, state, wanted, max(ROUGH_RTOL, self.rtol), ROUGH_TOLERANCE)

    def newton(
        self, system: HybridSystem, state: State, wanted: Array, rtol: float, tolerance: float
    ) -> tuple[HybridSystem, State]:
        """Newton's method from a state on the section and the system's own parameters."""
        local, before = chart(system, state), self._cycles
        shooting = self._shooting(local, system, wanted, rtol)
        roots = shooting.solve(self._values(system)[None], tolerance, on_iterates=self._tell)
        self.effort.evaluations += A_CYCLE * (self._cycles - before)
        if roots.end[0] != CONVERGED:
            raise NoGait(WHY[roots.end[0]].format(n=roots.iteration[0]), float(roots.norm[0]))
        q, v = shooting.states(np.zeros(1, dtype=np.int64), roots.x)
        return with_parameters(system, self.named(roots.x[0, local.dimension :])), (q[0], v[0])

    def _shooting(self, local: Chart, system: HybridSystem, wanted: Array, rtol: float) -> Shooting:
        """The equations about a state, with derivatives where there are some."""

        def cycle(begun: State, values: Array) -> tuple[Run, Array] | str:
            try:
                result = return_map(with_parameters(system, self.named(values)), begun, rtol)
                self._look_after(result)
                return result, self.measure(result) if result.cycles else np.empty(0)
            except SpearError as error:  # a parameter out of range, a toe below ground, an event that did not happen
                return str(error)

        cycles = one_by_one(cycle, len(self.measures))
        if self.exact is None:
            return Shooting(local.lane, cycles, self.vary, wanted[None])
        return Shooting(local.lane, self.exact.otherwise(cycles), self.vary, wanted[None], self.exact.slopes)

    @property
    def _cycles(self) -> int:
        """How many there were with derivatives."""
        return 0 if self.exact is None else self.exact.count

    def named(self, values: Array) -> dict[str, float]:
        """Values of what varies, by name."""
        return dict(zip(self.vary, values.tolist(), strict=True))

    def _tell(self, lanes: Lanes, iteration: Lanes, norm: Array) -> None:
        for n, residual in zip(iteration.tolist(), norm.tolist(), strict=True):
            self.on_iteration(n, residual)

    def _look_after(self, result: Run) -> None:
        """Count, and give the search up when too many cycles took more evaluations than any gait's."""
        self.effort.evaluations += result.evaluations
        if result.reason == "evaluation_cap":
            self.effort.strained += 1
            if self.effort.strained == STRAINED:
                raise _Hopeless

    def measure(self, result: Run) -> Array:
        """The measures of a one-cycle run."""
        return np.array([measure(result) for measure in self.measures], dtype=float)

    def gait(self, system: HybridSystem, state: State) -> Gait:
        """The gait at a solution, checked on the whole state, and on the cycle after it."""
        result = return_map(system, state, self.rtol)
        error = float(np.abs(displacement(system, state, result.state)).max())
        allowed = max(RESIDUAL, 10.0 * self.rtol)
        if not error <= allowed:
            raise NoGait(f"the cycle that was found closes no better at rtol {self.rtol:g}", error)
        values = self._multipliers(system, state)
        _check_memory(system, result, allowed * max(1.0, float(np.abs(values).max())), self.rtol)
        return Gait(
            system=system,
            state=state,
            parameters={name: parameter(system, name) for name in self.vary},
            residual=error,
            multipliers=values,
            durations=result.durations,
        )

    def _multipliers(self, system: HybridSystem, state: State) -> NDArray[np.complex128]:
        """Floquet multipliers, exact where derivatives are."""
        if self.exact is not None:
            local = chart(system, state)
            d, here = local.dimension, np.concatenate([np.zeros(local.dimension), self._values(system)])
            shooting = self._shooting(local, system, self.wanted, self.rtol)
            found = shooting.jacobians(np.zeros(1, dtype=np.int64), here[None])[0]
            if np.isfinite(found).all():
                return eigenvalues(found[:d, :d] + np.eye(d))
        return multipliers(system, state, self.rtol)

    def settled(self, system: HybridSystem) -> State:
        """The system's guess, followed for a few cycles towards a stable gait; where that breaks off, the guess.

        Raises:
            _Hopeless: one cycle takes more evaluations than any gait's.
        """
        guess, values = system.guess(), self._values(system)
        result = run(system, guess, 1, SETTLING)
        moment = _reached(system, result)
        for _ in range(SETTLE - 1):
            if moment is None:
                break
            after = None if self.exact is None else self.exact.follow(moment, values)
            if after is None:
                try:
                    result = run(system, moment, 1, SETTLING)
                except BadValue:  # so roughly integrated that a toe is below the ground: that is as near as it gets
                    break
                after = _reached(system, result)
            moment = after
        if result.reason == "evaluation_cap":
            raise _Hopeless
        if moment is None:
            return guess
        along = translations(system)
        return without(along, moment.q) + (guess[0] - without(along, guess[0])), moment.v  # back to where it began

    def _values(self, system: HybridSystem) -> Array:
        """What varies, in a system, (k,)."""
        return np.array([parameter(system, name) for name in self.vary])


def _reached(system: HybridSystem, result: Run) -> Moment | None:
    """Where a cycle led to, None if it did not close."""
    return Moment(*result.state, system.section_phase, result.held) if result.cycles else None


def _check_memory(system: HybridSystem, cycle: Run, allowed: float, rtol: float) -> None:
    """The next cycle, which remembers the first, closes as well.

    Raises:
        NoGait: something latched before the section acts after it, so that (q, v) is not all that a cycle depends on.
    """
    moment = Moment(*cycle.state, cycle.domain.phase, cycle.held)
    again = run(system, moment, 1, Options(rtol=rtol, max_evaluations=EVALUATIONS))
    error = float(np.abs(displacement(system, cycle.state, again.state)).max()) if again.cycles else np.inf
    if not error <= allowed:
        raise NoGait("the next cycle differs: something latched before the section acts after it", error)


class _Hopeless(Exception):
    """Cycles take more evaluations than any gait's."""
