"""Random starts of the hop, and random drops of Q-SPEAR in space: how their runs end.

From the repository: `python -m tests.random_starts --starts 2000`, with `--space` of drops. It prints one line a
reason, or one JSON object with `--json`, and ends with status 1 if a run raises or gives a number that is none.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from functools import cache

import numpy as np
from tqdm import tqdm

from spear_pin import Contact, Gait, SpatialLaw, bounding_in_space, hopping, load, simulate
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.reasons import NUMERICAL

CYCLES, RTOL, CAP = 11, 1e-8, 2_000_000
STRIDES = 1  # of a drop in space
NUMBERS = ("t", "q", "v", "a", "u", "tau", "friction", "force", "spring")
RAISED = "raised"


@dataclass(frozen=True)
class Start:
    """A start in the air.

    Attributes:
        seed: what it was drawn with; every other one has boom_x free.
        q: configuration.
        v: velocity.
        friction: coefficient of friction.
    """

    seed: int
    q: tuple[float, ...]
    v: tuple[float, ...]
    friction: float

    @property
    def free(self) -> bool:
        """Whether the robot can move forward."""
        return bool(self.seed % 2)


@dataclass(frozen=True)
class Outcome:
    """How the run from a start ended.

    Attributes:
        seed: the start's.
        reason: the trajectory's, or `RAISED`.
        message: the trajectory's, or the exception's.
        finite: whether every number of the trajectory is finite.
        evaluations: right-hand sides evaluated.
        residual: of the energy ledger, the largest of the whole cycles.
    """

    seed: int
    reason: str
    message: str
    finite: bool = False
    evaluations: int = 0
    residual: float = 0.0


@cache
def robot(free: bool):
    return load("spear_ii", locked=[] if free else ["boom_x"])


def draw(seed: int) -> Start:
    """The start of a seed: toe up to 0.3 m high, leg anywhere, everything moving."""
    rng = np.random.default_rng(seed)
    free = bool(seed % 2)
    height, knee, lean = rng.uniform(0.0, 0.3), rng.uniform(0.1, 2.0), rng.uniform(-0.3, 0.3)
    q = np.array([0.0, 0.0, 0.5 * knee + lean, knee])[0 if free else 1 :]
    q[-3] = height - robot(free).toe_position(q, "toe")[1]
    base, joints = rng.uniform(-2.0, 2.0, 2), rng.uniform(-10.0, 10.0, 2)
    v = np.concatenate([base if free else base[1:], joints])
    return Start(seed, tuple(q.tolist()), tuple(v.tolist()), float(rng.uniform(0.1, 2.0)))


@cache
def quadruped():
    return load("q_spear_full", base="chain")


def draw_in_space(seed: int) -> Start:
    """The start of a seed in space: lowest toe up to 0.3 m high, base and legs anywhere near upright, all moving."""
    rng = np.random.default_rng(seed)
    q, v = np.zeros(18), rng.uniform(-5.0, 5.0, 18)
    q[3:6] = rng.uniform(-3.0, 3.0), *rng.uniform(-0.3, 0.3, 2)
    for leg in range(6, 18, 3):
        knee = rng.uniform(0.3, 1.6)
        q[leg : leg + 3] = rng.uniform(-0.3, 0.3), 0.5 * knee + rng.uniform(-0.3, 0.3), knee
    v[:3], v[3:6] = rng.uniform(-1.5, 1.5, 3), rng.uniform(-2.0, 2.0, 3)
    v[0] += 2.5 * np.cos(q[3])
    v[1] += 2.5 * np.sin(q[3])
    q[2] = rng.uniform(0.0, 0.3) - min(quadruped().toe_position(q, toe)[2] for toe in quadruped().toes)
    return Start(seed, tuple(q.tolist()), tuple(v.tolist()), float(rng.uniform(0.2, 1.2)))


def outcome(seed: int) -> Outcome:
    """Run the hop from the start of a seed."""
    start = draw(seed)
    return _ended(start, lambda: hopping(robot(start.free), contact=Contact(start.friction)), CYCLES)


@cache
def drop(seed: int) -> Outcome:
    """Run Q-SPEAR in space from the start of a seed."""
    start, law = draw_in_space(seed), SpatialLaw(Gait.load("long_stride").system.law)
    return _ended(start, lambda: bounding_in_space(quadruped(), law, contact=Contact(start.friction)), STRIDES)


def _ended(start: Start, build: Callable[[], HybridSystem], cycles: int) -> Outcome:
    seed = start.seed
    try:
        state = np.array(start.q), np.array(start.v)
        trajectory = simulate(build(), state, cycles, RTOL, max_evaluations=CAP, progress=False)
    except Exception as error:  # whatever it is, it is a result to count
        return Outcome(seed, RAISED, f"{type(error).__name__}: {error}")
    finite = all(np.isfinite(getattr(trajectory, name)).all() for name in NUMBERS)
    residual = float(np.abs(trajectory.ledger.residual).max(initial=0.0))
    return Outcome(seed, trajectory.reason, trajectory.message, finite, trajectory.evaluations, residual)


def outcomes(
    starts: int, processes: int = 1, first: int = 0, run: Callable[[int], Outcome] = outcome
) -> Iterator[Outcome]:
    """Outcomes of as many seeds, in order."""
    seeds = range(first, first + starts)
    if processes == 1:
        yield from map(run, seeds)
        return
    with multiprocessing.get_context("spawn").Pool(processes) as pool:
        yield from pool.imap(run, seeds, chunksize=8)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m tests.random_starts", description=__doc__.splitlines()[0])
    parser.add_argument("--starts", type=int, default=2000, metavar="N", help="how many (default: 2000)")
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="at the same time (default: 2)")
    parser.add_argument("--space", action="store_true", help="drop Q-SPEAR in space")
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    arguments = parser.parse_args()
    runs = outcomes(arguments.starts, arguments.processes, run=drop if arguments.space else outcome)
    found = list(tqdm(runs, total=arguments.starts, unit="start"))
    counts = Counter(one.reason for one in found)
    numerical = sum(counts[reason] for reason in NUMERICAL)
    broken = [one for one in found if one.reason == RAISED or not one.finite]
    if arguments.json:
        summary = {
            "starts": arguments.starts,
            "reasons": dict(counts.most_common()),
            "numerical": numerical,
            "largest_residual": max(one.residual for one in found),
            "most_evaluations": max(one.evaluations for one in found),
            "broken": [asdict(one) for one in broken],
            "seeds_of_numerical": [one.seed for one in found if one.reason in NUMERICAL],
        }
        print(json.dumps(summary))
    else:
        for reason, count in counts.most_common():
            print(f"{reason:<16}{count:>6}{100 * count / len(found):>8.2f} %")
        print(f"numerical reasons: {100 * numerical / len(found):.2f} %")
        for one in broken:
            print(f"seed {one.seed}: {one.message}")
    return 1 if broken else 0


if __name__ == "__main__":
    raise SystemExit(main())
