"""Toes in space that set out to slide: their velocity turns to the direction of sliding almost at once.

While a toe sets out, the reference engine computes friction against the direction in which the toe accelerates. The
velocity lags behind by a small angle. Derivatives divide it by the speed, so the velocity is turned first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import SETTING_OUT, SLIP
from spear_pin.hybrid.rules.footing import closed_toes, still

SLOW = 2.0 * SETTING_OUT  # m/s: a faster toe has turned


def find_setting_out(system: HybridSystem, arc: Arc) -> list[str]:
    """Returns the toes in space that begin to slide as an arc begins, where they have no direction."""
    q, v = np.split(arc.y, 2)
    slips = [toe for toe, mode in zip(system.robot.toes, arc.domain.contacts, strict=True) if mode == SLIP]
    return [toe for toe in slips if still(float(np.linalg.norm(_jacobian(system, q, toe)[:2] @ v)))]


def turn_velocities(system: HybridSystem, arc: Arc, toes: Sequence[str], y: Array, a: Array, slopes: Array) -> Array:
    """Turns the velocities of slow toes to their directions of sliding, and returns the states, (2 nv, n).

    A toe slides along d if friction against d accelerates it along d. One step of Newton's method finds d.

    Args:
        system: the system.
        arc: the arc.
        toes: toes that set out in it.
        y: states, (2 nv, n).
        a: accelerations there, (nv, n).
        slopes: their derivatives with respect to the velocity, (nv, n, nv).
    """
    found, grounded = y.copy(), [toe for toe, _ in closed_toes(system.robot.toes, arc.domain)]
    for i, state in enumerate(y.T):
        q, v = np.split(state, 2)
        rows = {toe: _jacobian(system, q, toe) for toe in grounded}
        slow = [toe for toe in toes if np.linalg.norm(rows[toe][:2] @ v) <= SLOW]
        if not slow:
            continue
        along = np.array([rows[toe][:2] @ v for toe in slow])
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        # each column of `turning` turns one toe by one radian, and moves no other
        aims = np.zeros((len(grounded), 3, len(slow)))
        for k, toe in enumerate(slow):
            aims[grounded.index(toe), :2, k] = across[k]
        turning = np.linalg.pinv(np.concatenate([*rows.values()])) @ aims.reshape(-1, len(slow))
        drifts = [np.array(system.ground.seen_in(system.robot.toe_drift(q, v, toe))) for toe in slow]
        off = np.array([(rows[toe] @ a[:, i] + drift)[:2] for toe, drift in zip(slow, drifts, strict=True)])
        by = np.array([across[k] @ rows[toe][:2] @ slopes[:, i] @ turning for k, toe in enumerate(slow)])
        by -= np.diag(np.sum(along * off, axis=1))
        found[len(v) :, i] -= turning @ np.linalg.solve(by, np.sum(across * off, axis=1))
    return found


def _jacobian(system: HybridSystem, q: Array, toe: str) -> Array:
    return system.ground.foot(system.robot, q, toe)[1]
