"""The hop of least cost among fixed points: every iterate is a hop with the wanted flight time.

The four or five chosen numbers of law and spring are unknowns of COBYQA, which takes no derivatives: where toes bounce,
or do not leave the ground, the cost jumps, or there is no hop. For each of its trial points Newton's method gives the
state and the stance torque, from the nearest known hop. The result is made a fixed point to the last digits, and
`descent` goes on from there.
"""

from __future__ import annotations

import numpy as np
import scipy

from spear_pin.arrays import Array
from spear_pin.errors import NoGait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.simulate import simulate
from spear_pin.studies.payoff.cycles import OVER, Cycles, Task
from spear_pin.studies.payoff.hop_family import HopFamily
from spear_pin.studies.payoff.leading import Place, let_go

TORQUE = "stance_torque"  # what is solved for the flight time
ROUNDS, GAIN = 2, 3e-3  # of the optimiser, each from the best that is known, until one saves less of the cost
RADIUS = 1.0  # units: of the trust region that a round begins with
TRIALS = 120  # of a round
KEPT = -2 * OVER  # of limits, left of a hop that keeps them
MISSED = 0.02  # of limits, by which they are taken to be exceeded where there is no hop


def best_hop(task: Task, place: Place) -> Gait:
    """Finds the hop of least cost from a place near a hop.

    Raises:
        NoGait: no hop was found.
    """
    cycles = Cycles(task, place.system, place.state, chart(place.system, place.state))
    hops = HopFamily(cycles)
    explore(hops, task.tolerance)
    failures = []
    for hop in hops.cheapest():
        try:
            system, state = cycles.begun(hop.x)
            gait = gait_beside(let_go(system), state, [TORQUE], {"flight_time": task.flight_time})
        except NoGait as error:  # on the brink of hops whose toe does not leave the ground
            failures.append(error)
            continue
        _, left = judged(task, gait)
        if left >= KEPT:
            return gait
        failures.append(NoGait(f"the gait near it exceeds a limit by {-100 * left:.2g} %", gait.residual))
    raise failures[0]


def judged(task: Task, gait: Gait) -> tuple[float, float]:
    """Returns the cost of a hop, and what remains of its most used limit, as a share of the limit."""
    cycle = simulate(gait.system, gait.state, samples=task.samples, progress=False)
    return task.cost(gait.system, cycle), float(task.spare(gait.system, cycle).min(initial=0.0))


def explore(hops: HopFamily, tolerance: float) -> None:
    """Searches a family for its cheapest hop, again from the best known hop until that saves little.

    Args:
        hops: the family; it stores the hops that are found.
        tolerance: tolerance in units.

    Raises:
        NoGait: no hop of the family keeps to its limits.
    """
    best = hops.nearest(hops.start)
    for _ in range(ROUNDS):
        before = best.cycle.cost
        _minimise(hops, best.x[hops.cycles.solved :], tolerance)
        best = hops.cheapest()[0]
        if best.cycle.cost > (1.0 - GAIN) * before:
            return


def _minimise(hops: HopFamily, y: Array, tolerance: float) -> None:
    """Searches the family around one of its hops; the family stores the hops that are found.

    Args:
        hops: the family.
        y: chosen numbers of the hop.
        tolerance: radius of the last trust region, in units.
    """
    bounds, unit = hops.cycles.bounds[hops.cycles.solved :], hops.nearest(y).cycle.cost or 1.0

    def cost(y: Array) -> float:
        return (hops.at(y) or hops.nearest(y)).cycle.cost / unit

    def spare(y: Array) -> Array:
        hop = hops.at(y)
        return np.minimum(hops.nearest(y).cycle.spare, -MISSED) if hop is None else hop.cycle.spare

    scipy.optimize.minimize(
        cost,
        y,
        method="COBYQA",
        bounds=scipy.optimize.Bounds(*bounds.T),
        constraints=scipy.optimize.NonlinearConstraint(spare, 0.0, np.inf),
        options={"initial_tr_radius": RADIUS, "final_tr_radius": tolerance, "maxfev": TRIALS},
    )
