"""Whether lanes agree: `python -m benchmarks.agreement`, many together, one by one, and by the reference engine.

Hops: plain, with limited flexion, with a spring that is never switched, on slippery ground, on a slope, with boom_x
free; friction and stiffness are drawn for each lane, and a third of them starts far off. Strides: the gaits that ship,
around their fixed points, in the plane and in space. Of each lane the reason and the number of cycles are compared, and
the state where it ended; what differs is listed, states that are apart with how far each is from the reference engine's
at its finest tolerance.
"""

from __future__ import annotations

import argparse
import multiprocessing
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cache, partial

import numpy as np
from tqdm import tqdm

from spear_pin import Gait, Ground, Spring, find_gait, hopping, load, simulate_many
from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.orbits.embedding import embed
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.lanes.runner import FEW
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import FINEST, Options
from spear_pin.hybrid.run import run

State = tuple[Array, Array]
RTOL = 1e-11
SAME = 1e-8  # m, rad, m/s, rad/s
SLOPE = 0.08  # rad
NEAR, FAR = 0.02, 0.3  # of the section's coordinates: how far from a gait lanes start
SHIPPED = ("long_stride", "force_lift_off", "least_effort")


@dataclass(frozen=True)
class Case:
    """A system of which many lanes are run.

    Attributes:
        make: the system, and a state on its section to start around.
        cycles: that each lane runs.
        draws: numbers that differ from lane to lane, by name the least and the largest.
        far: how far off a third of the lanes starts.
    """

    make: Callable[[], tuple[HybridSystem, State]]
    cycles: int
    draws: Mapping[str, tuple[float, float]]
    far: float = FAR


@cache
def hop(free: bool = False) -> Gait:
    """A hop in place."""
    robot = load("spear_ii", locked=() if free else ("boom_x",))
    return find_gait(hopping(robot), ["stance_torque"], {"flight_time": 0.2})


def hopping_with(spring: Spring | None = None, **law: float) -> tuple[HybridSystem, State]:
    """The hop with another spring or law, from where it was periodic."""
    system, state = hop().system, hop().state
    return hopping(system.robot, replace(system.law, **law), spring or system.spring, system.contact), state


def sloped_hop() -> tuple[HybridSystem, State]:
    """The hop on a slope."""
    found = find_gait(hopping(hop().system.robot, ground=Ground(slope=SLOPE)), ["stance_torque"], {"flight_time": 0.2})
    return found.system, found.state


def gait(name: str) -> tuple[HybridSystem, State]:
    """A gait that ships."""
    found = Gait.load(name)
    return found.system, found.state


def free_hop() -> tuple[HybridSystem, State]:
    """The hop with boom_x free."""
    return hop(free=True).system, hop(free=True).state


GROUND, SLIPPERY, STIFF = (0.4, 1.2), (0.05, 0.4), (40.0, 60.0)
HOPS = {
    "plain": Case(hopping_with, 3, {"friction": GROUND, "stiffness": STIFF}),
    "limited flexion": Case(partial(hopping_with, minimum_force=20.0), 3, {"friction": GROUND, "stiffness": STIFF}),
    "fixed spring": Case(partial(hopping_with, Spring(rest=1.0)), 3, {"friction": GROUND}),
    "slippery": Case(hopping_with, 3, {"friction": SLIPPERY, "stiffness": STIFF}),
    "sloped": Case(sloped_hop, 3, {"friction": GROUND, "stiffness": STIFF}),
    "x free": Case(free_hop, 3, {"friction": GROUND, "stiffness": STIFF}),
}
BOUNDS = {name: Case(partial(gait, name), 2, {"friction": (0.3, 1.2)}, far=0.05) for name in SHIPPED}


def bound_in_space() -> tuple[HybridSystem, State]:
    """`long_stride` in space."""
    return embed(Gait.load("long_stride"))


SPACE = {
    "trot": Case(partial(gait, "trot"), 1, {"friction": (0.5, 1.2)}, far=0.1),
    "turn_9": Case(partial(gait, "turn_9"), 1, {"friction": (0.5, 1.2)}, far=0.1),
    "bound in space": Case(bound_in_space, 1, {"friction": (0.5, 1.2)}, far=0.1),
}


@dataclass(frozen=True)
class End:
    """How a lane ended."""

    reason: str
    cycles: int
    state: Array

    def off(self, other: End) -> float:
        """Largest difference of the states, infinite if reasons or cycles differ."""
        if (self.reason, self.cycles) != (other.reason, other.cycles):
            return np.inf
        return float(np.abs(self.state - other.state).max()) if self.reason == "complete" else 0.0


def starts(system: HybridSystem, state: State, case: Case, n: int, seed: int) -> tuple[Array, Array, dict[str, Array]]:
    """States and numbers of n lanes."""
    rng, local = np.random.default_rng(seed), chart(system, state)
    spread = np.where(np.arange(n) % 3 == 0, case.far, NEAR)
    states = [local.state(size * rng.normal(size=local.dimension)) for size in spread]
    numbers = {name: rng.uniform(*ends, n) for name, ends in case.draws.items()}
    q, v = (np.array(part) for part in zip(*states, strict=True))
    return q, v, numbers


def lanes(
    system: HybridSystem, q: Array, v: Array, numbers: Mapping[str, Array], cycles: int, at_a_time: int
) -> list[End]:
    """The lanes by the Taylor engine, so many at a time."""
    ends: list[End] = []
    for first in range(0, len(q), at_a_time):
        some = slice(first, first + at_a_time)
        own = {name: column[some] for name, column in numbers.items()}
        found = simulate_many(system, q[some], v[some], cycles, RTOL, parameters=own)
        states = np.concatenate([found.q, found.v], axis=1)
        ends += map(End, found.reason.tolist(), found.cycles.tolist(), states)
    return ends


def by_reference(lane: tuple[HybridSystem, Array, Array, dict[str, float], int], rtol: float = RTOL) -> End:
    """A lane by the reference engine."""
    system, q, v, numbers, cycles = lane
    try:
        result = run(with_parameters(system, numbers), (q, v), cycles, Options(rtol))
    except BadValue:  # a toe below the ground, which lanes give as a reason
        return End("below_ground", 0, np.concatenate([q, v]))
    return End(result.reason, result.cycles, np.concatenate(result.state))


class _Made:
    """The case's system, made once in every process."""

    system: HybridSystem

    @classmethod
    def begin(cls, case: Case) -> None:
        cls.system = case.make()[0]

    @classmethod
    def lane(cls, lane: tuple[Array, Array, dict[str, float], int]) -> End:
        return by_reference((cls.system, *lane))


def compare(name: str, case: Case, n: int, seed: int, processes: int) -> Iterator[str]:
    """Lines of a case's table."""
    system, state = case.make()
    q, v, numbers = starts(system, state, case, n, seed)
    together = lanes(system, q, v, numbers, case.cycles, n)
    alone = lanes(system, q, v, numbers, case.cycles, FEW)
    each = [{key: float(column[i]) for key, column in numbers.items()} for i in range(n)]
    asked = [(q[i], v[i], each[i], case.cycles) for i in range(n)]
    with multiprocessing.get_context("fork").Pool(processes, _Made.begin, (case,)) as pool:
        reference = list(tqdm(pool.imap(_Made.lane, asked, 16), name, total=n, leave=False, disable=None))
    reasons = ", ".join(f"{count} {reason}" for reason, count in Counter(end.reason for end in reference).most_common())
    yield f"{name}: {n} lanes ({reasons})"
    for title, one, other in (("few, many", alone, together), ("few, reference", alone, reference)):
        off = np.array([a.off(b) for a, b in zip(one, other, strict=True)])
        differ, apart = np.flatnonzero(np.isinf(off)), np.flatnonzero((off > SAME) & np.isfinite(off))
        same = off[np.isfinite(off)]
        yield f"  {title}: {len(differ)} differ, {len(apart)} apart by more than {SAME:g}, median {np.median(same):.1e}"
        for i in differ:
            yield f"    lane {i}: {one[i].reason} after {one[i].cycles}, {other[i].reason} after {other[i].cycles}"
        for i in sorted(apart, key=lambda i: -off[i])[:10]:
            finest = by_reference((system, *asked[i]), FINEST)
            errors = f"{one[i].off(finest):.1e} and {other[i].off(finest):.1e}"
            yield f"    lane {i}: apart by {off[i]:.1e}, from the finest by {errors}"


def main() -> None:
    """Compare, and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hops", type=int, default=12_000, help="lanes that hop")
    parser.add_argument("--strides", type=int, default=1_400, help="lanes that bound")
    parser.add_argument("--space", type=int, default=1_500, help="lanes in space")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=2)
    asked = parser.parse_args()
    for cases, n in ((HOPS, asked.hops), (BOUNDS, asked.strides), (SPACE, asked.space)):
        for seed, (name, case) in enumerate(cases.items()):
            if n:
                for line in compare(name, case, n // len(cases), asked.seed + seed, asked.processes):
                    print(line, flush=True)


if __name__ == "__main__":
    main()
