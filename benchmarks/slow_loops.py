"""SPEAR-II's hop under a law that is sampled and late: `python -m benchmarks.slow_loops`, Markdown, ten minutes.

A free clock and touchdown fall together differently in each hop, so the return map of a sampled law jumps a little
from state to state. Its multipliers are those of the linear map that fits the hops from many states best.
"""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from typing import Any

import numpy as np

from benchmarks.markdown import table
from spear_pin import Gait, find_gait, hopping, load
from spear_pin.arrays import Array
from spear_pin.hybrid.result import Options, Run
from spear_pin.hybrid.run import run

LOOPS = (  # sample time and latency, in ms
    *((0, 0), (1, 0), (1, 1), (1, 2), (1, 4), (1, 6), (1, 8), (1, 10), (1, 11)),
    *((2, 2), (5, 0), (5, 5), (10, 0), (20, 0), (30, 0)),
)
HOPS, LAST, STARTS, AROUND = 20, 10, 20, np.array([0.01, 0.01, 0.2])  # rad, rad, rad/s: hip, knee, rate of the knee
NEAR = 3.0  # times as far from the steady hop a hop may begin and end that counts for its multipliers
STEADY = 0.1  # of the flight time: what varies by more is no steady hop
HEADS = (
    "sample time [ms]",
    "latency [ms]",
    "flight [s]",
    f"shortest to longest of the last {LAST} flights [s]",
    "largest multiplier, modulus",
    "the others",
    "steps again a hop",
    f"of {HOPS} hops",
)


def main() -> None:
    """Print a row for each loop."""
    with ProcessPoolExecutor() as pool:
        table(HEADS, pool.map(row, LOOPS))


def row(loop: tuple[float, float]) -> tuple[str, ...]:
    """Returns a loop's figures."""
    sample_time, latency = (1e-3 * each for each in loop)
    options = Options(1e-8, sample_time=sample_time or None, latency=latency)
    hops = run(gait().system, gait().state, HOPS, options)
    named = [f"{each:g}" if sample_time else "continuous" for each in loop]
    if hops.reason != "complete":
        return *named, "", "", "", "", "", f"lost after {hops.cycles}"
    flights = np.array(list(durations(hops)))[-LAST:]
    if np.ptp(flights) > STEADY * flights.mean():
        found = ["", ""]
    else:
        largest, *others = np.abs(multipliers(touchdowns(hops)[-1], options))
        found = [f"{largest:.2f}", ", ".join(f"{each:.2f}" for each in others)]
    spread = f"{flights.min():.4f} to {flights.max():.4f}"
    again = [event.name for event in hops.events].count("retouch") / HOPS
    return *named, f"{flights.mean():.4f}", spread, *found, f"{again:.1f}", "all" if found[0] else "all, irregular"


@cache
def gait() -> Gait:
    """Returns the hop with a flight of 0.2 s."""
    robot = load("spear_ii", locked=["boom_x"])
    return find_gait(hopping(robot), vary=["stance_torque"], target={"flight_time": 0.2})


def durations(hops: Run) -> Iterator[float]:
    """Yields the duration of each flight, from lift-off to touchdown."""
    left = None
    for event in hops.events:
        if event.name == "lift_off":
            left = event.time
        elif event.name == "touchdown" and left is not None:
            yield event.time - left


def touchdowns(hops: Run) -> Array:
    """Returns hip, knee and rate of the knee just after each touchdown, (n, 3), which determine the state there."""
    return np.array([[*event.q[1:], event.v[2]] for event in hops.events if event.name == "touchdown"])


def standing(x: Array) -> Any:
    """Returns the state with these numbers whose toe rests on the ground."""
    system = gait().system
    q = np.array([0.0, x[0], x[1]])
    height, jacobian = system.ground.foot(system.robot, q, "toe")
    q[0] = -height
    rates = np.linalg.svd(jacobian)[2][-1]
    return q, rates * x[2] / rates[2]


def multipliers(x: Array, options: Options) -> Array:
    """Returns the eigenvalues of the linear map from touchdown to touchdown that fits hops from around x best.

    The first hop of each start is left out, as no torques are on their way at its beginning.
    """
    random, before, after = np.random.default_rng(0), list[Array](), list[Array]()
    for _ in range(STARTS):
        hops = touchdowns(run(gait().system, standing(x + random.uniform(-1, 1, 3) * AROUND), 3, options))
        before += list(hops[:-1])
        after += list(hops[1:])
    pairs = np.array([before, after])
    near = (abs(pairs - x) < NEAR * AROUND).all(axis=(0, 2))
    columns = np.column_stack([pairs[0, near], np.ones(near.sum())])
    matrix = np.linalg.lstsq(columns, pairs[1, near], rcond=None)[0][:3].T
    found = np.linalg.eigvals(matrix)
    return found[np.argsort(-np.abs(found))]


if __name__ == "__main__":
    main()
