"""A hundred hops of legs with closed loops, beside eliminated equations: `python -m benchmarks.loops`, Markdown.

The eliminated equations are Lagrange's in independent coordinates, which SymPy derives with the loop solved in closed
form and SciPy integrates. It takes two minutes, most of them for these.
"""

from __future__ import annotations

import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks.markdown import table
from spear_pin import Contact, Robot, simulate
from spear_pin.hybrid.batch import simulate_many
from tests.hybrid.eliminated import hop
from tests.hybrid.looped_hops import looped_hopping
from tests.model.looped import crank_leg, five_bar

CYCLES = 100
HEADS = (
    f"{CYCLES} hops of a leg with a loop",
    "loop open by at most, m",
    f"touchdown {CYCLES}, beside eliminated equations, s",
    "last state, compiled, beside them",
    "energy ledger, J a hop",
    "reference, s",
    "compiled, s",
)


def main() -> None:
    """Print a row for each leg."""
    table(HEADS, [row(name, make) for name, make in (("crank and rod", crank_leg), ("five bars", five_bar))])


def row(name: str, make: Callable[[Path], Robot]) -> tuple[str, ...]:
    """Returns a leg's figures."""
    with tempfile.TemporaryDirectory() as folder:
        robot = make(Path(folder))
    system = looped_hopping(robot, contact=Contact(5.0))
    (q, v), own = system.guess(), [robot.index(joint) for joint in robot.independent]
    times, last = hop(robot.name, np.concatenate([q[own], v[own]]), CYCLES)
    hops, reference = timed(lambda: simulate(system, (q, v), cycles=CYCLES, progress=False))
    simulate_many(system, q[None], v[None], cycles=1)  # compiles
    many, compiled = timed(lambda: simulate_many(system, q[None], v[None], cycles=CYCLES))
    touchdowns = [event.time for event in hops.named("touchdown")]
    figures = (
        max(np.abs(robot.loop_gap(each)).max() for each in hops.q),
        abs(touchdowns[-1] - times[-1]),
        np.abs(np.concatenate([many.q[0][own], many.v[0][own]]) - last).max(),
        np.abs(hops.ledger.residual).max(),
        reference,
        compiled,
    )
    return name, *(f"{figure:.1g}" for figure in figures[:-2]), *(f"{seconds:.2g}" for seconds in figures[-2:])


def timed(call: Callable[[], Any]) -> tuple[Any, float]:
    """Returns what a call returns, and how long it takes, in s."""
    began = time.perf_counter()
    return call(), time.perf_counter() - began


if __name__ == "__main__":
    main()
