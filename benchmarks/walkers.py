"""Textbook walkers beside their published numbers: `python -m benchmarks.walkers`, Markdown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks.markdown import table
from spear_pin import find_gait, simulate
from spear_pin.hybrid.periodic import multipliers, residual
from tests.walkers import HOPPERS, LONG, ROUND, SHORT, example, forward_differences, hopper, round_state


def main() -> None:
    """Print a table of the walker, one of the walker on round feet, and one of the runner."""
    heads = "step", "angle and rate found", "published, apart by", "exact", "by forward differences", "published"
    table(heads, [walk(name, *published) for name, published in (("long", LONG), ("short", SHORT))])
    table(("after heelstrike", "published", "a step later", "gait"), walk_on_round_feet())
    heads = "runner", "apex, m/s and m, published", "after a step, apart by", "multipliers"
    table(heads, [run(name) for name in HOPPERS])


def walk(name: str, state: tuple[float, float], published: Sequence[complex]) -> tuple[str, ...]:
    """Returns a row of the walker's table."""
    gait = find_gait(example().simplest_walker(state))
    found = np.array([gait.state[0][0], gait.state[1][0]])
    differences = forward_differences(gait.system, state)
    rows = [said(gait.multipliers[:2]), said(differences), said(published, 14 if np.iscomplex(published[0]) else 3)]
    return name, f"{found[0]:.12f}, {found[1]:.12f}", f"{np.abs(found - state).max():.1g}", *rows


def walk_on_round_feet() -> list[tuple[str, ...]]:
    """Returns the rows of the table of the walker on round feet: the leg that has landed, and the other's."""
    system = example().round_walker()
    strike = simulate(system, round_state(system, ROUND), cycles=1, rtol=1e-12).named("right_strike")[0]
    q, v = find_gait(system).state
    angle, rate, _, opening = ROUND
    rows = (
        ("stance leg's angle", angle, strike.q[3], q[2]),
        ("stance leg's rate", rate, strike.v[3], v[2]),
        ("other leg's rate", rate - opening, strike.v[2], v[3]),
    )
    return [(name, *(f"{number:.12f}" for number in numbers)) for name, *numbers in rows]


def run(name: str) -> tuple[str, ...]:
    """Returns a row of the runner's table."""
    system = hopper(name)
    law, found = system.law, multipliers(system, system.guess())
    apex = f"{law.speed:.12f}, {law.height:.12f}"
    return name, apex, f"{residual(system, system.guess()):.1g}", ", ".join(f"{abs(each):.6f}" for each in found)


def said(numbers: Sequence[Any] | np.ndarray, digits: int = 6) -> str:
    """Writes two multipliers, a conjugate pair as one."""
    one, other = complex(numbers[0]), complex(numbers[1])
    rest = f" ± {abs(one.imag):.{digits}f}i" if one.imag else f", {other.real:.{digits}f}"
    return f"{one.real:.{digits}f}{rest}"


if __name__ == "__main__":
    main()
