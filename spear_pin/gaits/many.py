"""Very many gaits at once: fixed points and Floquet multipliers of lanes with different parameters.

Newton's method works on the section's chart, with a damping for each lane. One call of `simulate_many` gives the
residuals for all lanes, and the next columns of the Jacobians where exact ones take longer. Lanes that fail from the
common guess begin again from the solution of their nearest neighbour.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.gait_table import NO_CONVERGENCE, GaitTable
from spear_pin.gaits.lane_cycles import NOT_VALID, LaneCycles, multipliers, valid
from spear_pin.gaits.lane_measures import MEASURES
from spear_pin.gaits.targets import check_wanted, measures_of
from spear_pin.gaits.tolerances import RESIDUAL, SETTLE, TOLERANCE
from spear_pin.hybrid import batch
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.charts import Charts
from spear_pin.hybrid.ground import PLACE
from spear_pin.hybrid.newton import CONVERGED, Roots, Words
from spear_pin.hybrid.parameters import parameter
from spear_pin.hybrid.result import State
from spear_pin.hybrid.section import section
from spear_pin.hybrid.shooting import Shooting
from spear_pin.kinds import typed

ROUNDS = 6  # largest number of starts of a lane from a neighbour
CALLS = 30  # largest number of engine calls in which a lane has to converge


@typed
def find_many(
    system: HybridSystem,
    parameters: Mapping[str, ArrayLike],
    vary: Sequence[str] = (),
    target: Mapping[str, ArrayLike] | None = None,
    *,
    guess: State | None = None,
    rtol: float = 1e-9,
    on_lanes: Callable[[int], object] = lambda n: None,
) -> GaitTable:
    """Solves x = P(x) of (4.12) together with the targets, in every lane.

    The rows do not depend on the order of the lanes, to the last digit. With other lanes in the batch, a lane may begin
    from another neighbour. It then ends a rounding error away, or at another gait where there are several.

    Args:
        system: robot, law and ground; its parameters hold where none are given.
        parameters: numbers with a value for each lane, (n,) each, named as fields of law, spring or contact.
        vary: parameters to solve for, except slope and height of the ground; if `parameters` has one of them too, its
            value there is the start.
        target: wanted values of measures of the cycle, each a key of `MEASURES`, for all lanes or (n,).
        guess: a state (q, v) on the section to begin from, or one for each lane, (n, nq) and (n, nv); by default the
            system's own.
        rtol: relative tolerance; see `simulate_many`.
        on_lanes: called with the number of lanes solved since the last call.

    Raises:
        MissingExtra: heyoka is not installed.
        UnknownName: unknown parameter or measure.
        BadValue: shapes do not fit, a number is not finite, a measure is of an event that lanes do not record, a varied
            parameter moves the ground, no cycle has a target (a flight too short to close a cycle), or the engine
            cannot compile a part of the system.

    Example:
        >>> from spear_pin import find_many, hopping, load
        >>> system = hopping(load("spear_ii", locked=["boom_x"]))
        >>> table = find_many(system, {"stiffness": [45.0, 48.84]}, ["stance_torque"], {"flight_time": 0.2})
        >>> table.converged.all()
        np.True_
    """
    batch.require()
    target = dict(target or {})
    given = {name: np.array(values, dtype=float) for name, values in parameters.items()}
    n = len(next(iter(given.values()))) if given and next(iter(given.values())).ndim else 0
    for name, values in given.items():
        if values.shape != (n,) or not n or not np.isfinite(values).all():
            raise BadValue(f"parameters[{name!r}]", values, "finite numbers, equally many for each parameter")
    for name in vary:
        if name in PLACE:
            raise BadValue(
                "vary", name, "a parameter that does not move the ground: the sections of the lanes lie on it"
            )
    if not given:
        raise BadValue("parameters", parameters, "at least one, with a number for each lane")
    wanted = _wanted(system, vary, target, n)
    start = {name: given.get(name, np.full(n, parameter(system, name))) for name in vary}
    fixed = {name: values for name, values in given.items() if name not in vary}
    state = _repeated(guess if guess is not None else system.guess(), n)
    simulate_many(system, state[0][:1], state[1][:1], rtol=rtol)  # it says what cannot be compiled
    lanes = _Lanes(system, fixed, start, tuple(target), wanted, rtol, on_lanes)
    lanes.run(state)
    return lanes.table()


def _wanted(system: HybridSystem, vary: Sequence[str], target: Mapping[str, ArrayLike], n: int) -> Array:
    """Returns the targets, (n, k)."""
    if len(vary) != len(target):
        raise BadValue("target", target, f"as many targets as parameters to vary, {len(vary)}")
    known = [name for name in system.measures if name in MEASURES]
    for name, value in target.items():
        if name not in measures_of(system):
            raise UnknownName("target", name, known)
        if name not in known:
            raise BadValue("target", name, f"one of {', '.join(known)}: lanes do not measure more; find_gait does")
        if np.shape(value) not in ((), (n,)):
            raise BadValue(f"target {name}", value, f"a finite number, or {n} of them")
    check_wanted(system, target)
    columns = [np.broadcast_to(np.asarray(value, dtype=float), n) for value in target.values()]
    return np.column_stack(columns or [np.empty((n, 0))])


class _Lanes:
    """The lanes, as far as they are solved: fixed and varied parameters, targets, and what was found."""

    def __init__(
        self,
        system: HybridSystem,
        fixed: Mapping[str, Array],
        start: Mapping[str, Array],
        target: Sequence[str],
        wanted: Array,
        rtol: float,
        on_lanes: Callable[[int], object],
    ) -> None:
        n, robot = len(wanted), system.robot
        self.cycles = LaneCycles(system, fixed, tuple(start), tuple(target), rtol)
        self.start, self.wanted, self.on_lanes = np.column_stack([*start.values(), np.empty((n, 0))]), wanted, on_lanes
        self.section = section(system, fixed)
        self.q, self.v = np.full((n, robot.nq), np.nan), np.full((n, robot.nv), np.nan)
        self.solved = np.full(self.start.shape, np.nan)
        self.residual, self.norm = np.full(n, np.nan), np.full(n, np.inf)
        self.multipliers = np.full((n, 2 * robot.nv), np.nan + 0j)
        self.durations = {phase: np.full(n, np.nan) for phase in system.phases}
        self.reason = np.full(n, "", dtype=object)
        self.reason[~valid(system, {**fixed, **start}, n)] = NOT_VALID

    def run(self, guess: State) -> None:
        """Solves from the guess, from neighbours, from where the simulated guess leads, and from neighbours again."""
        todo = np.flatnonzero(self.reason == "")
        self.solve(todo, guess[0][todo], guess[1][todo], self.start[todo])
        self.from_neighbours()
        self.settle(guess)
        self.from_neighbours()
        self.on_lanes(int((self.reason != CONVERGED).sum()))

    @property
    def failed(self) -> NDArray[np.int64]:
        """Lanes that may still be found."""
        return np.flatnonzero((self.reason != CONVERGED) & (self.reason != NOT_VALID))

    def from_neighbours(self) -> None:
        """Begins from the nearest lane that converged, in parameters that are scaled to their spans."""
        features, used = np.column_stack([*self.cycles.fixed.values(), self.wanted]), np.full(len(self.q), -1)
        span = np.ptp(features, axis=0)
        scaled = features / np.where(span > 0.0, span, 1.0)
        for _ in range(ROUNDS):
            found, todo = np.flatnonzero(self.reason == CONVERGED), self.failed
            if not len(found) or not len(todo):
                return
            found = found[np.lexsort(scaled[found].T)]  # so that a tie does not depend on the order of the lanes
            nearest = found[scipy.spatial.cKDTree(scaled[found]).query(scaled[todo])[1]]
            fresh = nearest != used[todo]
            todo, nearest = todo[fresh], nearest[fresh]
            if not len(todo):
                return
            used[todo] = nearest
            self.solve(todo, self.q[nearest], self.v[nearest], self.solved[nearest])

    def settle(self, guess: State) -> None:
        """Begins from where some cycles of simulation lead."""
        todo = self.failed
        if not len(todo):
            return
        own = {**self.cycles.take(todo).fixed, **dict(zip(self.cycles.vary, self.start[todo].T, strict=True))}
        batch = simulate_many(self.cycles.system, guess[0][todo], guess[1][todo], SETTLE, 1e-7, parameters=own)
        there = batch.reason == "complete"
        self.solve(todo[there], batch.q[there], batch.v[there], self.start[todo[there]])

    def group_alike(
        self, lanes: NDArray[np.int64], q: Array, v: Array
    ) -> Iterator[tuple[NDArray[np.bool_], NDArray[np.int64], Charts, LaneCycles]]:
        """Groups lanes with the same sliding toes: which they are, their numbers, their charts and their cycles."""
        slides = self.section.take(lanes).sliding(q, v)
        for pattern in np.unique(slides, axis=0):
            chosen = (slides == pattern).all(axis=1)
            own = lanes[chosen]
            yield chosen, own, self.section.take(own).charts(q[chosen], v[chosen], pattern), self.cycles.take(own)

    def solve(self, lanes: NDArray[np.int64], q: Array, v: Array, start: Array) -> None:
        """Runs Newton's method and finds multipliers, for lanes with the same sliding toes together."""
        for chosen, own, charts, cycles in self.group_alike(lanes, q, v):
            shooting = Shooting(charts, cycles, cycles.vary, self.wanted[own], cycles.slopes)
            roots = shooting.solve(start[chosen], TOLERANCE, calls=CALLS, always=False)
            self.fail(own, _why(roots), roots.norm)
            there = np.flatnonzero(roots.end == CONVERGED)
            self.finish(own[there], *shooting.states(there, roots.x[there]), roots.x[there, charts.dimension :])

    def fail(self, lanes: NDArray[np.int64], reason: NDArray[np.object_], norm: Array) -> None:
        """Notes why lanes failed; of several attempts it keeps the nearest to a gait."""
        better = (reason != CONVERGED) & ((norm < self.norm[lanes]) | (self.reason[lanes] == ""))
        self.reason[lanes[better]], self.norm[lanes[better]] = reason[better], norm[better]

    def finish(self, lanes: NDArray[np.int64], q: Array, v: Array, values: Array) -> None:
        """Checks the fixed points on the whole state, and finds their multipliers."""
        for chosen, own, charts, cycles in self.group_alike(lanes, q, v):
            found = multipliers(cycles, charts, values[chosen])
            closes = found.residual <= max(RESIDUAL, 10.0 * cycles.rtol)
            reason = np.where(closes, found.reason, NO_CONVERGENCE).astype(object)
            self.fail(own, reason, found.residual)
            good = reason == CONVERGED
            own = own[good]
            self.q[own], self.v[own], self.solved[own] = q[chosen][good], v[chosen][good], values[chosen][good]
            self.multipliers[own, : charts.dimension] = found.multipliers[good]
            self.residual[own] = found.residual[good]
            for phase, seconds in found.durations.items():
                self.durations[phase][own] = seconds[good]
            self.reason[own] = CONVERGED
            self.on_lanes(len(own))

    def table(self) -> GaitTable:
        """Returns the rows."""
        parameters = {**self.cycles.fixed, **dict(zip(self.cycles.vary, self.solved.T.copy(), strict=True))}
        width = int(np.isfinite(self.multipliers).any(axis=0).sum()) or 1
        values, reason = self.multipliers[:, :width], self.reason.astype(str)
        return GaitTable(self.q, self.v, parameters, self.residual, values, self.durations, reason)


def _why(roots: Roots) -> Words:
    """Returns a key of `REASONS` for each lane: why it has no value, else whether it converged."""
    ended = np.where(roots.end == CONVERGED, CONVERGED, NO_CONVERGENCE)
    return np.where(roots.reason == "", ended, roots.reason).astype(object)


def _repeated(state: State, n: int) -> tuple[Array, Array]:
    """Returns a state for each lane."""
    try:
        q, v = (np.broadcast_to(part, (n, np.shape(part)[-1])) for part in state)
    except (ValueError, IndexError):
        raise BadValue("guess", [np.shape(part) for part in state], f"a state (q, v), or {n} of them") from None
    return q, v
