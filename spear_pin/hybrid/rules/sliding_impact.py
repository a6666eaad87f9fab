"""Plastic impact of one toe in space whose sliding changes direction: Keller's law, Routh's in three dimensions."""

from __future__ import annotations

import math

import numpy as np
import scipy

from spear_pin.arrays import Array
from spear_pin.hybrid.rules.cone import foothold
from spear_pin.hybrid.rules.impact import RESTING, JointImpact

ACCURACY = 1e-12  # of the integration
STOPPED = math.log(1e-13)  # logarithm of the speed, relative to the initial speed, at which sliding is over
LONGEST = 1e4  # s, times the largest entry of A


def sliding_impact(D: Array, J: Array, v: Array, friction: float) -> JointImpact:
    """Computes a plastic impact of one toe in space, with friction against the sliding at every instant.

    The law is Keller's, J. Appl. Mech. 53 (1986). The normal impulse l grows until the toe no longer approaches. The
    toe slides along the unit vector d, which may turn, with du/dl = A (e_z - μ d), its velocity u and A = J D⁻¹ Jᵀ. If
    sliding stops before the end, the toe sticks if |A_tt⁻¹ A_tz| ≤ μ, or else slides on along a constant d. Moreau's
    law, `spatial_impact`, compares only the velocities before and after. Both agree if the toe sticks by both laws, or
    if d does not turn.

    Args:
        D: mass matrix, (nv, nv).
        J: Jacobian of the toe, rows x, y and z, (3, nv).
        v: velocity before, (nv,).
        friction: coefficient of friction.

    Raises:
        ArithmeticError: the sliding cannot be followed to its end.
    """
    response = np.linalg.solve(D, J.T)
    A, before = J @ response, J @ v
    impulse, slid = _impulse(A, before, friction) if before[2] < -RESTING else (np.zeros(3), False)
    loss = -0.5 * float(impulse @ (2.0 * before + A @ impulse))
    return JointImpact(v + response @ impulse, impulse[None], loss, (slid,), (not impulse.any(),))


def _impulse(A: Array, before: Array, friction: float) -> tuple[Array, bool]:
    """Returns the impulse, and whether the toe slides after the impact."""
    slid = np.zeros(3)
    if math.hypot(before[0], before[1]) > RESTING:
        slid, over = _while_it_slides(A, before, friction)
        if over:
            return slid, True
    rest = foothold(A, np.array([0.0, 0.0, float(before[2] + A[2] @ slid)]), friction)
    return slid + rest.force, rest.mode == "slip"


def _while_it_slides(A: Array, before: Array, friction: float) -> tuple[Array, bool]:
    """Returns the impulse until sliding stops or the toe no longer approaches, and whether the latter came first.

    It integrates in polar coordinates of the sliding velocity over s with dl = r ds, so that the equations are regular
    where r vanishes. The direction follows its own equation, along which r falls or grows exponentially.
    """
    first = math.hypot(before[0], before[1])

    def slope(_: float, y: Array) -> Array:
        r, (c, d) = first * math.exp(y[1]), (math.cos(y[0]), math.sin(y[0]))
        rate = A[:2, 2] - friction * A[:2, :2] @ (c, d)
        return np.array(
            [d * -rate[0] + c * rate[1], c * rate[0] + d * rate[1], -friction * c * r, -friction * d * r, r]
        )

    def approach(_: float, y: Array) -> float:
        return float(before[2] + A[2] @ y[2:])

    def stops(_: float, y: Array) -> float:
        return float(y[1]) - STOPPED

    approach.terminal = stops.terminal = True  # type: ignore[attr-defined]
    start, until = np.array([math.atan2(before[1], before[0]), 0.0, 0.0, 0.0, 0.0]), LONGEST / float(np.abs(A).max())
    found = scipy.integrate.solve_ivp(
        slope, (0.0, until), start, "DOP853", events=(approach, stops), rtol=ACCURACY, atol=ACCURACY
    )
    if found.status != 1:
        raise ArithmeticError("sliding in an impact neither stops nor ends it")  # conservation of energy rules this out
    end: Array = found.y[2:, -1]
    return end, bool(len(found.t_events[0]))
