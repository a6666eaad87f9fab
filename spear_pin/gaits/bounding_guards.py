"""Parts of a bounding leg that are the same in the plane and in space: lift-off by the knee, and overload."""

from __future__ import annotations

import math
from typing import Any

from spear_pin.gaits.legs import Leg
from spear_pin.hybrid.domain import Guard, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations

OVERLOAD = 1e4  # N·m: a hundred times what Q-SPEAR's gaits take
BEYOND = 1e-3  # rad: a knee must flex so far beyond θ̄ before its return lifts the leg
SHORTEST_SPAN = 0.2  # share of a stance's span that remains at least when a swing begins late


def knee_back(leg: Leg, reset: Reset) -> tuple[Guard, Guard]:
    """Returns guards for the knee passing θ̄ of (5.5)-(5.6), the law's `knee_rest`, as it flexes and comes back."""
    name = f"{leg.name}_flexed"

    def flexes(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return held[name] + (1.0 - held[name]) * (p.knee_rest + BEYOND - leg.flexion(q))

    def returns(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return held[name] * (leg.flexion(q) - p.knee_rest) + (1.0 - held[name])

    flexed = Reset(latch=lambda q, v, held, p: {name: 1.0})
    return Guard(name, flexes, flexed), Guard(f"{leg.name}_lift_off", returns, reset)


def overload(scale: float, *, share: bool) -> Guard:
    """Returns the guard that ends a run at torques far too large: the decoupling matrix is nearly singular.

    Args:
        scale: torques of the robot over Q-SPEAR's. The limit is `OVERLOAD` times the nearest power of ten, since code
            is compiled for each limit.
        share: whether the guard is a share of the limit's square, else it is in N²·m². The Taylor engine is only as
            exact as its greatest guard needs: as a share, its steps are longer, and less exact.
    """
    most = OVERLOAD * 10.0 ** round(math.log10(scale))
    unit = most if share else 1.0

    def value(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        return (most**2 - sum(torque * torque for torque in dyn.u)) / unit**2

    return Guard("overload", value, ends="overload")
