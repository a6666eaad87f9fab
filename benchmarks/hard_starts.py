"""How runs from hard starts end: `python -m benchmarks.hard_starts`.

Bounding starts whose lower foot is 1 to 30 mm above the ground: the 300 of `bounding_starts.json`, with what ended them
before toes at rest could alternate both at once, and as many drawn here; then the hop starts of `tests.random_starts`.
Besides the reasons it counts runs in which a sticking toe is torn off the ground, and says what became of each start
that used to end as `zeno`.
"""

from __future__ import annotations

import argparse
import json
import multiprocessing
from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache, partial
from pathlib import Path

import numpy as np
from tqdm import tqdm

from spear_pin import Contact, Gait
from spear_pin.gaits.bounding import bounding
from spear_pin.hybrid.automaton import SHORTEST_FLIGHT
from spear_pin.hybrid.result import Options, Run
from spear_pin.hybrid.run import run
from tests.random_starts import outcomes

GAITS = ("long_stride", "force_lift_off", "least_effort")
STRIDES, RTOL = 4, 1e-8
LOWEST, HIGHEST = 1e-3, 0.03  # m: of the lower foot
ANGLES, RATES = 0.2, np.array([1.0, 0.6, 2.0, 6.0, 6.0, 6.0, 6.0])  # how far from a gait's, in rad, m/s and rad/s


@dataclass(frozen=True)
class Start:
    """A start in the air.

    Attributes:
        seed: its number.
        gait: name of the shipped gait whose law it is.
        friction: coefficient of friction.
        q: configuration.
        v: velocity.
        formerly: why its run used to end, if that is known.
    """

    seed: int
    gait: str
    friction: float
    q: tuple[float, ...]
    v: tuple[float, ...]
    formerly: str = ""


@cache
def gait_of(name: str) -> Gait:
    """A shipped gait, read once."""
    return Gait.load(name)


def recorded() -> list[Start]:
    """The starts that are kept."""
    rows = json.loads(Path(__file__).with_name("bounding_starts.json").read_text(encoding="utf-8"))
    return [Start(**{**row, "q": tuple(row["q"]), "v": tuple(row["v"])}) for row in rows]


def drawn(seed: int) -> Start:
    """A start around the section of a gait."""
    chance, name = np.random.default_rng(seed), GAITS[seed % len(GAITS)]
    system = gait_of(name).system
    q, v = system.guess()
    size = chance.uniform(0.25, 1.0)
    q[2:] += size * ANGLES * chance.uniform(-1.0, 1.0, 5)
    v += size * RATES * chance.uniform(-1.0, 1.0, 7)
    lower = min(system.robot.toe_position(q, toe)[1] for toe in system.robot.toes)
    q[1] += chance.uniform(LOWEST, HIGHEST) - lower
    return Start(seed, name, float(chance.uniform(0.2, 1.2)), tuple(q.tolist()), tuple(v.tolist()))


def followed(start: Start, shortest_flight: float = SHORTEST_FLIGHT) -> Run:
    """The run from a start; a stride whose flight is shorter than so many seconds is none."""
    system = gait_of(start.gait).system
    system = bounding(system.robot, system.law, system.spring, Contact(start.friction))
    system = replace(system, shortest_flight=shortest_flight)
    return run(system, (np.array(start.q), np.array(start.v)), STRIDES, Options(RTOL))


def ending(start: Start, shortest_flight: float) -> tuple[Start, str, str, bool]:
    """Why the run from a start ended, where, and whether a toe was torn off the ground in it."""
    result = followed(start, shortest_flight)
    return start, result.reason, result.detail, any(event.name.startswith("painleve:") for event in result.events)


def table(title: str, reasons: Iterable[str]) -> None:
    """Print how often each reason occurs."""
    counts = Counter(reasons)
    print(f"\n{title}")
    for reason, count in counts.most_common():
        print(f"{reason:<16}{count:>6}{100 * count / counts.total():>8.2f} %")


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks.hard_starts", description=__doc__.splitlines()[0])
    parser.add_argument("--own", type=int, default=300, metavar="N", help="bounding starts drawn here (default: 300)")
    parser.add_argument("--hops", type=int, default=2000, metavar="N", help="hop starts (default: 2000)")
    parser.add_argument(
        "--shortest-flight",
        type=float,
        default=SHORTEST_FLIGHT,
        metavar="S",
        help=f"of a bound's toe, in s; 0: strides of which the toe hardly left the ground count, too, so that runs end "
        f"sooner (default: {SHORTEST_FLIGHT})",
    )
    parser.add_argument("--processes", type=int, default=2, metavar="N", help="at the same time (default: 2)")
    given = parser.parse_args()
    kept, own = recorded(), [drawn(seed) for seed in range(given.own)]
    with multiprocessing.get_context("spawn").Pool(given.processes) as pool:
        ended = pool.imap(partial(ending, shortest_flight=given.shortest_flight), [*kept, *own], chunksize=4)
        found = list(tqdm(ended, total=len(kept) + len(own), unit="start"))
    for title, part in (("bounding, kept", found[: len(kept)]), ("bounding, drawn", found[len(kept) :])):
        if part:
            table(title, [reason for _, reason, _, _ in part])
            print(f"a sticking toe torn off the ground in {sum(torn for *_, torn in part)}")
    if given.hops:
        hops = tqdm(outcomes(given.hops, given.processes), total=given.hops, unit="start")
        table("hops", [one.reason for one in hops])
    print("\nformerly zeno")
    for start, reason, detail, torn in found:
        if start.formerly == "zeno":
            print(f"{start.seed:>4} {start.gait:<16}{reason:<10}{'torn off ' if torn else ''}{detail}")


if __name__ == "__main__":
    main()
