"""Events that are over within one step of the integrator: curbs across the way of a flying toe."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin import Ground, hopping, load, simulate
from spear_pin.hybrid.dynamics import FLOATS
from tests.cases.case import Case

SPEED, FALL, HIGH, AT, RISE, GRAVITY = 2.5, 0.1, 0.01, 0.04, 0.015, 9.81  # m/s, m, m/s²
TIME = AT / SPEED  # s: when the toe is at the curb's face


@dataclass(frozen=True)
class Curb(Ground):
    """Level ground with a curb across it."""

    at: float = AT
    wide: float = 0.02
    rise: float = RISE

    def above(self, x: Any, z: Any, ops: Any = FLOATS) -> Any:
        """Distance of a point from it."""
        beside = ops.maximum(self.at - x, x - self.at - self.wide)
        return -ops.maximum(-z, -ops.maximum(z - self.rise, beside))


def struck(wide: float) -> tuple[float, float, float]:
    """When the toe of SPEAR-II, thrown forward and down, strikes a curb, and where, x and z, at the default `rtol`."""
    robot = load("spear_ii")
    q = np.array([0.0, 0.0, 0.5, 1.0])
    x, z = robot.toe_position(q, "toe")
    q[0] -= x
    q[1] -= z - HIGH
    system = hopping(robot, ground=Curb(wide=wide))
    event = simulate(system, (q, np.array([SPEED, -FALL, 0.0, 0.0])), progress=False).events[0]
    x, z = robot.toe_position(event.q, "toe")
    return event.time, float(x), float(z)


def _case(wide: float) -> Case:
    def now(_: Path) -> tuple[float, float, float]:
        return struck(wide)

    return Case(
        f"a curb of {100 * wide:g} cm",
        "event between two steps",
        (TIME, AT, HIGH - FALL * TIME - 0.5 * GRAVITY * TIME**2),
        "by hand: the joints are where their law wants them, so that the whole robot falls freely",
        now,
        tolerance=1e-6,
    )


CASES = tuple(map(_case, (0.02, 0.01, 0.005)))
