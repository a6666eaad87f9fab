"""The hop of least cost, sought among fixed points: every iterate is a hop, as long in the air as is wanted.

The numbers of law and spring that are chosen are unknowns of SLSQP; for each of its trial points Newton's method gives
the state and the stance torque, from the nearest hop that is known along its tangent. Derivatives are differences of
cycles and the implicit function theorem. What comes out is made a fixed point to the last digits.
"""

from __future__ import annotations

import scipy

from spear_pin.errors import NoGait
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.simulate import simulate
from spear_pin.studies.payoff.cycles import OVER, Cycles, Task
from spear_pin.studies.payoff.hop_family import HopFamily
from spear_pin.studies.payoff.leading import Place

TORQUE = "stance_torque"  # what is solved for the flight time
ITERATIONS = 40  # of the optimiser


def best_hop(task: Task, place: Place) -> Gait:
    """The hop of least cost that is found from a place which is near a hop.

    Raises:
        NoGait: none was found.
    """
    cycles = Cycles(task, place.system, place.state, chart(place.system, place.state))
    hops = HopFamily(cycles, cycles.first())
    y = hops.start
    scipy.optimize.minimize(
        lambda y: hops.at(y).cost,
        y,
        jac=lambda y: hops.slopes(y)[0],
        bounds=cycles.bounds[cycles.solved :],
        constraints=[{"type": "ineq", "fun": lambda y: hops.at(y).spare, "jac": lambda y: hops.slopes(y)[1]}],
        method="SLSQP",
        options={"ftol": task.tolerance, "maxiter": ITERATIONS},
    )
    failures = []
    for x in hops.cheapest():
        try:
            gait = gait_beside(*cycles.begun(x), [TORQUE], {"flight_time": task.flight_time})
        except NoGait as error:  # on the brink of hops whose toe does not leave the ground
            failures.append(error)
            continue
        cycle = simulate(gait.system, gait.state, samples=task.samples, progress=False)
        left = task.spare(gait.system, cycle).min(initial=0.0)
        if left >= -2 * OVER:
            return gait
        failures.append(NoGait(f"beside it a limit is exceeded by {-100 * left:.2g} %", gait.residual))
    raise failures[0]
