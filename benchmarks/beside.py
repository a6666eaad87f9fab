"""SPEAR-II's hop here, in MuJoCo and in Drake, in five rows: `python -m benchmarks.beside`, Markdown on stdout.

MuJoCo is taken as it comes, with its soft contact, stepped from Python at the settings of `peers/mujoco_native.py`;
Drake with the exact foot and the witness functions of `peers/drake_system.py`. What is measured is how far a hop ends
from that of the reference engine at an rtol of 1e-12, over its fixed point and four states beside it. Multipliers are
those of central differences through the peer's own hop, with that step of `STEPS` which comes nearest. Ranges are over
settings. It takes half a minute.
"""

from __future__ import annotations

import inspect
import time
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from benchmarks.engines import one_core
from benchmarks.markdown import table
from benchmarks.peers import drake_hop, drake_system, mujoco_native
from benchmarks.peers.task import FINEST, STATES, Array, Task, taylor
from benchmarks.peers.task import hop as hopping_task
from spear_pin import Spring, simulate
from spear_pin.hybrid.engines.taylor import available
from spear_pin.hybrid.periodic import chart, differentiate_return_map, eigenvalues

STEPS = (1e-2, 1e-3, 1e-4, 1e-5)  # of differences
ROUNDS = 5
LANES = 4096
OURS = "spear-pin"
ROWS = (
    "energy after a hop, off by",
    "touchdown, off by",
    "Floquet multipliers, off by",
    "a spring that engages",
    "a hop, on one core",
)
Hop = Callable[[Array], tuple[float, Array]]  # from (q, v): when the next touchdown is, in s, and (q, v) after it


@dataclass(frozen=True)
class Found:
    """What one setting of a program comes to: errors of energy, in J, of time, in s, of multipliers; seconds a hop."""

    energy: float
    touchdown: float
    multipliers: float
    seconds: float


def here(task: Task, rtol: float) -> Hop:
    """The hop by `simulate`."""

    def run(y: Array) -> tuple[float, Array]:
        landed = simulate(task.gait.system, (y[:3], y[3:]), 1, rtol, progress=False).named("touchdown")[-1]
        return landed.time, np.concatenate([landed.q, landed.v])

    return run


def programs(task: Task) -> dict[str, list[Hop]]:
    """Hops by the program that runs them, one for each of its settings."""
    found = {OURS: [here(task, 1e-9)]}
    if mujoco_native.mujoco is not None:
        found["MuJoCo"] = [mujoco_native.make(task, *setting) for setting in mujoco_native.SETTINGS]
    if drake_hop.LeafSystem is not None:
        made = [drake_system.make(task) for _ in drake_hop.ACCURACIES]
        found["Drake"] = [drake_hop.simulated(*each) for each in zip(made, drake_hop.ACCURACIES, strict=True)]
    return found


def measured(task: Task, hop: Hop, rounds: int = ROUNDS) -> Found:
    """Errors of a hop, and what it costs."""
    robot, exact = task.gait.system.robot, here(task, FINEST)
    starts = np.concatenate([task.q, task.v], axis=1)[:STATES]
    ours, theirs = [exact(y) for y in starts], [hop(y) for y in starts]

    def energy(y: Array) -> float:
        return robot.kinetic_energy(y[:3], y[3:]) + robot.potential_energy(y[:3])

    pairs = list(zip(ours, theirs, strict=True))
    return Found(
        max(abs(energy(end) - energy(other)) for (_, end), (_, other) in pairs),
        max(abs(landed - other) for (landed, _), (other, _) in pairs),
        min(by_differences(task, hop, step) for step in STEPS),
        min(seconds(hop, starts) for _ in range(rounds)),
    )


def by_differences(task: Task, hop: Hop, step: float) -> float:
    """How far the multipliers of differences through a hop are from the gait's, the farthest of them."""
    gait = task.gait
    local = chart(gait.system, gait.state)

    def mapped(xi: Array) -> Array:
        _, end = hop(np.concatenate(local.state(xi)))
        return local.coordinates((end[:3], end[3:]))

    shifts = step * np.eye(local.dimension)
    jacobian = np.array([mapped(xi) - mapped(-xi) for xi in shifts]).T / (2.0 * step)
    return float(
        np.abs(eigenvalues(jacobian) - eigenvalues(differentiate_return_map(gait.system, gait.state, FINEST))).max()
    )


def seconds(hop: Hop, starts: Array) -> float:
    """CPU seconds a hop."""
    begin = time.process_time()
    for y in starts:
        hop(y)
    return (time.process_time() - begin) / len(starts)


def span(values: list[float], unit: str = "") -> str:
    """The least and the greatest to a digit, or one of them where both read the same."""
    least, most = (f"{float(f'{value:.1g}'):g}" for value in (min(values), max(values)))
    return (least if least == most else f"{least} to {most}") + unit


def lines(*functions: Callable[..., object]) -> int:
    """How long programs are."""
    return sum(len(inspect.getsource(function).splitlines()) for function in functions)


def cells(name: str, found: list[Found], batch: float | None) -> tuple[str, ...]:
    """A column of the table, from above."""
    written = {"MuJoCo": mujoco_native.make, "Drake": drake_system.make}
    own = f"part of your own program ({lines(written[name])} lines for this hop)" if name in written else ""
    spring = own or f"`{Spring.__name__}`"
    many = f"; {1e3 * batch:.1g} ms each in a batch of {LANES}" if batch is not None else ""
    return (
        span([each.energy for each in found], " J"),
        span([each.touchdown for each in found], " s"),
        span([each.multipliers for each in found]),
        spring,
        span([1e3 * each.seconds for each in found], " ms") + many,
    )


def main() -> None:
    """Measure and print the table."""
    task = hopping_task(LANES)
    with one_core():
        found = {name: [measured(task, hop) for hop in hops] for name, hops in programs(task).items()}
        batch = None
        if available():
            lane = taylor(task, LANES, 1e-9)
            lane.call()
            batch = min(lane.seconds(1) for _ in range(ROUNDS)) / LANES
    columns = [cells(name, each, batch if name == OURS else None) for name, each in found.items()]
    table(("", *found), list(zip(ROWS, *columns, strict=True)))


if __name__ == "__main__":
    main()
