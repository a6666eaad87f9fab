"""Hops of least electricity beside CMA-ES: `python -m benchmarks.payoff [--hops 2000] [--only POINT ...]`, Markdown.

SPEAR-II's hop of 0.2 s of flight: with a switchable and with a fixed spring of a given stiffness, and with a fixed one
whose stiffness is free. Beside the search of `spear payoff` from many starts stands CMA-ES (package `cma`) from the
same first hop, which tries as many hops as are asked for. It takes some 10 minutes a point.
"""

from __future__ import annotations

import argparse
from dataclasses import replace
from time import process_time

import numpy as np

from benchmarks.codesign import NO_GAIT, PENALTY, Followed
from benchmarks.markdown import begin, row
from spear_pin import load
from spear_pin.studies.payoff.grid import FIXED, SWITCHED, Point
from spear_pin.studies.payoff.hop_search import MISSED, best_hop, first_hops, lead_hop, problem
from spear_pin.studies.payoff.hopping import HOPS, task_of, work
from spear_pin.studies.payoff.knee import tie_springs
from spear_pin.studies.payoff.motors import PARTS, Motors, fit_motors, known
from spear_pin.studies.payoff.searches import Search

FLIGHT, SPREAD, SEED = 0.2, 0.2, 1
POINTS = {
    "switched": Point(SWITCHED, FLIGHT, 48.84),
    "fixed": Point(FIXED, FLIGHT, 48.84),
    "fixed, free": Point(FIXED, FLIGHT, None),
}


def main() -> None:
    """Print a row for each point."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--hops", type=int, default=2000, help="hops that CMA-ES tries at a point")
    parser.add_argument("--only", nargs="+", choices=POINTS, default=list(POINTS), help="some points")
    arguments = parser.parse_args()
    begin("point", "descents: cost", "starts that agree", "s", "CMA-ES: cost", "hops", "of them within limits", "s")
    for name in arguments.only:
        row(name, *beside(POINTS[name], arguments.hops))


def beside(point: Point, hops: int) -> tuple[object, ...]:
    """The best of the descents from many starts, and of CMA-ES."""
    robot = load("spear_ii", locked=["boom_x"])
    drives = {part: found[0] for part in PARTS if (found := known(robot, part)) is not None}
    motors = Motors(**drives)
    robot = fit_motors(robot, motors)
    task = task_of(robot, motors, "electricity", Search(point, None, HOPS.meshes))
    first = lead_hop(point, SWITCHED, next(first_hops(HOPS.system(robot), (FLIGHT,))))
    begun = process_time()
    best = best_hop(task, [first])
    unit, between = work(robot, FLIGHT), process_time()
    costs, tried = evolved(
        Followed(replace(first, system=tie_springs(first.system)), problem(task, first.system)), hops
    )
    found = (f"{best.design.objective / unit:.4f}", best.starts, f"{between - begun:.0f}")
    return *found, f"{min(costs, default=np.inf) / unit:.4f}", tried, len(costs), f"{process_time() - between:.0f}"


def evolved(followed: Followed, hops: int) -> tuple[list[float], int]:
    """Costs of the hops within limits that CMA-ES tried, and how many it tried.

    Where it stops it begins again, nearer to the first hop if it has found none.
    """
    import cma

    costs, tried, spread, seed = list[float](), 0, SPREAD, SEED
    (x0,) = followed.known

    def cost(x: np.ndarray) -> float:
        orbit = followed.gait(np.asarray(x))
        if orbit is None:
            return NO_GAIT
        value, missed = followed.cost(orbit)
        if missed <= MISSED:
            costs.append(value)
        return value + PENALTY * missed

    while tried < hops:
        search = cma.CMAEvolutionStrategy(list(x0), spread, {"bounds": [0.0, 1.0], "seed": seed, "verbose": -9})
        while not search.stop() and tried < hops:
            points = search.ask()
            search.tell(points, [cost(x) for x in points])
            tried += len(points)
        spread, seed = spread if costs else 0.5 * spread, seed + 1
    return costs, tried


if __name__ == "__main__":
    main()
