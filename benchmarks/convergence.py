"""Convergence with the integrator's tolerance: `python -m benchmarks.convergence`, a Markdown table on stdout.

The hop in place at the stance torque that gives 0.2 s of flight. Each row solves the fixed point anew at
its tolerance, simulates one hop from it, and compares with the fixed point at the finest tolerance.
"""

from __future__ import annotations

import numpy as np

from benchmarks import markdown
from spear_pin import Gait, find_gait, hopping, load, simulate
from spear_pin.errors import NoGait

TOLERANCES = [10.0**-k for k in range(6, 13)]
FINEST = 1e-13


def row(gait: Gait, rtol: float, reference: Gait) -> list[str]:
    robot = gait.system.robot
    hop = simulate(gait.system, gait.state, 1, rtol, progress=False)
    exact = simulate(reference.system, reference.state, 1, FINEST, progress=False)
    errors = [np.abs(a - b).max() for a, b in zip(gait.state, reference.state, strict=True)]
    events = {name: abs(hop.named(name)[-1].time - exact.named(name)[-1].time) for name in ("lift_off", "touchdown")}
    return [
        f"{rtol:.0e}",
        f"{errors[0]:.1e}",
        f"{errors[1]:.1e}",
        f"{events['lift_off']:.1e}",
        f"{events['touchdown']:.1e}",
        f"{abs(gait.multipliers - reference.multipliers).max():.1e}",
        f"{abs(hop.ledger.residual[0]):.1e}",
        f"{max(abs(robot.toe_position(q, 'toe')[1]) for q in hop.q[hop.phase == 'stance']):.1e}",
        f"{hop.evaluations}",
    ]


def main() -> None:
    system = hopping(load("spear_ii", locked=["boom_x"]))
    solved = find_gait(system, ["stance_torque"], {"flight_time": 0.2}, rtol=FINEST)
    coarse = find_gait(solved.system, guess=solved.state, rtol=TOLERANCES[0])  # every row begins here
    reference = find_gait(solved.system, guess=coarse.state, rtol=FINEST)
    head = [
        "rtol",
        "q [m, rad]",
        "v [m/s, rad/s]",
        "lift-off [s]",
        "touchdown [s]",
        "multipliers",
        "ledger [J]",
        "toe [m]",
        "evaluations",
    ]
    markdown.begin(*head)
    for rtol in TOLERANCES:
        try:
            gait = find_gait(reference.system, guess=coarse.state, rtol=rtol)
            markdown.row(*row(gait, rtol, reference))
        except NoGait as error:
            markdown.row(f"{rtol:.0e}", error, *[""] * (len(head) - 2))


if __name__ == "__main__":
    main()
