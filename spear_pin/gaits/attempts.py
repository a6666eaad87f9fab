"""Attempts to find a gait: Newton's method from a state, from a settled state, or from target to target."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, NoGait, list_names
from spear_pin.gaits.diagnosis import Reached
from spear_pin.gaits.family import Family
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.leading import lead_along
from spear_pin.gaits.tangent_cycles import TangentCycles, tangent_cycles
from spear_pin.gaits.tolerances import RESIDUAL, SETTLE, TOLERANCE
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.charts import Chart
from spear_pin.hybrid.clutch import waiting
from spear_pin.hybrid.modes import starting_phase
from spear_pin.hybrid.newton import CONVERGED, NO_NEIGHBOUR, NO_PROGRESS, NO_START, TOO_LONG, Lanes
from spear_pin.hybrid.parameters import parameter
from spear_pin.hybrid.periodic import chart, displacement, multipliers, return_map
from spear_pin.hybrid.result import EVALUATIONS, Moment, Options, Run, State
from spear_pin.hybrid.run import run
from spear_pin.hybrid.shooting import Shooting
from spear_pin.hybrid.translation import translations, without

MeasureOfRun = Callable[[Run], float]

SETTLING = Options(rtol=1e-7, max_evaluations=EVALUATIONS)  # of each of these
STRAINED = 2  # a search ends after so many cycles with more evaluations than any gait's
ENOUGH = 200_000  # no continuation begins or is refined after so many evaluations
ROUGH_RTOL, ROUGH_TOLERANCE = 1e-8, 1e-6  # for the integrator and Newton's method until a solution is near
A_CYCLE = 2000  # a cycle with derivatives counts as so many evaluations
MEANT = 1e-6  # relative to a measure or its unit: a larger difference means another quantity
SHORTEST_STEP = 1.0 / 16.0  # share of the way to the targets: first and shortest step
WHY: Mapping[str, str] = {
    NO_START: "the cycle does not close at the starting point",
    NO_NEIGHBOUR: "the cycle does not close near an iterate",
    NO_PROGRESS: "Newton's method makes no progress",
    TOO_LONG: "Newton's method did not converge in {n} iterations",
}


def search_gait(
    system: HybridSystem,
    vary: Sequence[str],
    target: Mapping[Any, float],
    rtol: float,
    on_iteration: Callable[[int, float], object] = lambda n, norm: None,
) -> Search:
    """Searches for a gait; see `find_gait` for the arguments. Uses derivatives where an engine compiles the cycles."""
    own = tuple(callable(name) or name in system.measures for name in target)
    exact, effort = tangent_cycles(system, vary, tuple(target)), Effort()
    family = Family(system, tuple(vary), tuple(target), rtol, effort.look_after)
    return Search(family, np.array([*target.values()], dtype=float), on_iteration, exact, own, effort)


@dataclass
class Effort:
    """How much work a search has done so far.

    Attributes:
        evaluations: evaluations of the right-hand side in its cycles.
        strained: cycles that reached the cap on evaluations.
        reached: the farthest point of a continuation.
    """

    evaluations: int = 0
    strained: int = 0
    reached: Reached | None = None

    def look_after(self, result: Run) -> None:
        """Counts evaluations, and gives the search up when too many cycles took more than any gait's."""
        self.evaluations += result.evaluations
        if result.reason == "evaluation_cap":
            self.strained += 1
            if self.strained == STRAINED:
                raise Hopeless


@dataclass(frozen=True)
class Search:
    """Search for the gait.

    Attributes:
        family: the systems with any values of the varied parameters, and the measures that have targets.
        wanted: the targets, (k,).
        on_iteration: called with the iteration and the residual.
        exact: cycles with derivatives, if there are any.
        own: which of the measures the system defines itself, so that a name might mean something else there.
        effort: how much work was done.
    """

    family: Family
    wanted: Array
    on_iteration: Callable[[int, float], object]
    exact: TangentCycles | None
    own: tuple[bool, ...]
    effort: Effort

    def directly(self, system: HybridSystem, state: State) -> tuple[HybridSystem, State]:
        """Finds the system and state that meet the targets by Newton's method."""
        start = self.roughly(system, state, self.wanted)
        return self.newton(*start, self.wanted, self.family.rtol, min(TOLERANCE, self.family.rtol))

    def by_continuation(self, system: HybridSystem, state: State) -> tuple[HybridSystem, State]:
        """Finds the system and state from the fixed point of the system as it is; moves the targets step by step."""
        alone, exact = replace(self.family, system=system, names=(), measures=()), tangent_cycles(system, (), ())
        unasked = replace(self, family=alone, wanted=self.wanted[:0], exact=exact, own=())
        system, state = unasked.roughly(system, state, self.wanted[:0])
        cycle = return_map(system, state, self.family.rtol)
        if not cycle.cycles:
            why = f"the cycle of the system as it is ends early: {cycle.message}"
            raise NoGait(f"{why}; expected a guess that is nearer to a gait", np.inf)
        begin = np.array([measure(system, cycle) for measure in self.family.of_runs], dtype=float)

        def solve(share: float, near: tuple[HybridSystem, State]) -> tuple[HybridSystem, State]:
            found = self.roughly(*near, begin + share * (self.wanted - begin))
            self.effort.reached = Reached(share, *found)
            return found

        steps = {"first": SHORTEST_STEP, "shortest": SHORTEST_STEP}
        way = lead_along(solve, (system, state), **steps, enough=lambda: self.effort.evaluations > ENOUGH)
        if way.failure is not None:
            raise way.failure
        return self.directly(*way.end)

    def roughly(self, system: HybridSystem, state: State, wanted: Array) -> tuple[HybridSystem, State]:
        """Finds the system and state that meet the targets to a few digits, at less than half the cost."""
        return self.newton(system, state, wanted, max(ROUGH_RTOL, self.family.rtol), ROUGH_TOLERANCE)

    def newton(
        self, system: HybridSystem, state: State, wanted: Array, rtol: float, tolerance: float
    ) -> tuple[HybridSystem, State]:
        """Runs Newton's method from a state on the section and the system's own parameters."""
        local, before = chart(system, state), self._cycles
        shooting = self._shooting(local, wanted, rtol)
        roots = shooting.solve(self._values(system)[None], tolerance, on_iterates=self._tell)
        self.effort.evaluations += A_CYCLE * (self._cycles - before)
        if roots.end[0] != CONVERGED:
            why = WHY[roots.end[0]].format(n=roots.iteration[0])
            if roots.end[0] == NO_START and (broken := return_map(system, state, rtol)).reason != "complete":
                why += f": {broken.message}"
            raise NoGait(why, float(roots.norm[0]))
        q, v = shooting.states(np.zeros(1, dtype=np.int64), roots.x)
        return self.family.member(roots.x[0, local.dimension :].tolist()), (q[0], v[0])

    def _shooting(self, local: Chart, wanted: Array, rtol: float) -> Shooting:
        """Returns the equations about a state, with derivatives where there are some."""
        cycles, vary = replace(self.family, rtol=rtol).by_reference, self.family.names
        if self.exact is None:
            return Shooting(local.lane, cycles, vary, wanted[None])
        return Shooting(local.lane, self.exact.otherwise(cycles), vary, wanted[None], self.exact.slopes)

    @property
    def _cycles(self) -> int:
        """Number of cycles that had derivatives."""
        return 0 if self.exact is None else self.exact.count

    def _tell(self, lanes: Lanes, iteration: Lanes, norm: Array) -> None:
        for n, residual in zip(iteration.tolist(), norm.tolist(), strict=True):
            self.on_iteration(n, residual)

    def gait(self, system: HybridSystem, state: State) -> Gait:
        """Returns the gait at a solution, checked on the whole state and on the cycle after it."""
        result = return_map(system, state, self.family.rtol)
        error = float(np.abs(displacement(system, state, result.state)).max())
        allowed = max(RESIDUAL, 10.0 * self.family.rtol)
        if not error <= allowed:
            reason = f"the cycle that was found does not close to {allowed:.1g} at rtol {self.family.rtol:g}"
            raise NoGait(reason, error, remedy="a smaller rtol")
        pairs = zip(self.family.of_runs, self.wanted, self.own, strict=True)
        meant = [(measure(system, result), wanted) for measure, wanted, own in pairs if own]
        if self.exact is not None and not all(np.isclose(*each, rtol=MEANT, atol=MEANT) for each in meant):
            differenced = replace(self, exact=None)  # the system means something else by a name
            return differenced.gait(*differenced.directly(system, state))
        values = multipliers(system, state, self.family.rtol)
        _check_memory(system, result, allowed * max(1.0, float(np.abs(values).max())), self.family.rtol)
        return Gait(
            system=system,
            state=state,
            parameters={name: parameter(system, name) for name in self.family.names},
            residual=error,
            multipliers=values,
            durations=result.durations,
        )

    def settled(self, system: HybridSystem) -> State:
        """Follows the system's guess for a few cycles towards a stable gait; returns the guess if that breaks off.

        Raises:
            Hopeless: one cycle takes more evaluations than any gait's.
        """
        guess, values = system.guess(), self._values(system)
        moment = Moment(*guess, *starting_phase(system, guess))
        for _ in range(SETTLE):
            exact = None if system.section_toes else self.exact
            after = None if exact is None else exact.follow(moment, values)
            if after is None:
                try:
                    result = run(system, moment, 1, SETTLING)
                except BadValue:  # rough integration put a toe below the ground; keep the nearest state so far
                    break
                if result.reason == "evaluation_cap":
                    raise Hopeless
                if not result.cycles:
                    return guess
                after = Moment(*result.state, system.section_phase, result.held)
            moment = after
        along = translations(system)
        return without(along, moment.q) + (guess[0] - without(along, guess[0])), moment.v  # back to where it began

    def _values(self, system: HybridSystem) -> Array:
        """Returns the values of the varied parameters in a system, (k,)."""
        return np.array([parameter(system, name) for name in self.family.names])


def _check_memory(system: HybridSystem, cycle: Run, allowed: float, rtol: float) -> None:
    """Checks that the next cycle, which remembers the first, closes as well, with all switches open at its end.

    Raises:
        NoGait: a value latched before the section acts after it, so that a cycle depends on more than (q, v).
    """
    moment = Moment(*cycle.state, cycle.domain.phase, cycle.held)
    again = run(system, moment, 1, Options(rtol=rtol, max_evaluations=EVALUATIONS, keep=True))
    error = float(np.abs(displacement(system, cycle.state, again.state)).max()) if again.cycles else np.inf
    if not error <= allowed:
        reason = "the next cycle differs: a value latched before the section is used after it"
        raise NoGait(reason, error, remedy="to latch that value again after the section")
    held = again.segments[-1].held
    switched = {mount.name: mount for domain in system.domains for mount in domain.mounts if waiting(mount) in held}
    late = [name for name, each in switched.items() if each.on and held[each.on] or held[waiting(each)]]
    if late:
        reason = (
            f"the switch of {list_names(late)} is not open at the {system.section}, so that the first cycle differs"
        )
        raise NoGait(reason, error, remedy="a shorter off_delay, or hold")


class Hopeless(Exception):
    """Raised when cycles take more evaluations than any gait's."""
