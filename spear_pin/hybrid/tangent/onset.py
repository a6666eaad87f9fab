"""Toes in space that set out to slide: their velocity turns to the direction of sliding almost at once.

While a toe sets out, the reference engine computes friction against the direction in which the toe accelerates. The
velocity lags behind by a small angle. Derivatives divide it by the speed, so the velocity is turned first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import SETTING_OUT, SLIP
from spear_pin.hybrid.rules.footing import closed_toes

SLOW = 2.0 * SETTING_OUT  # m/s: a faster toe has turned


def find_setting_out(system: HybridSystem, arc: Arc, y: Array) -> list[str]:
    """Returns the toes in space that slide slowly as an arc begins, and faster at the first of states y in it."""
    slips = [toe for toe, mode in zip(system.robot.toes, arc.domain.contacts, strict=True) if mode == SLIP]
    slow = [toe for toe in slips if _speed(system, arc.y, toe) <= SLOW]
    return [toe for toe in slow if _speed(system, arc.y, toe) < _speed(system, y[:, 0], toe)]


def turn_velocities(
    system: HybridSystem, arc: Arc, toes: Sequence[str], t: Array, y: Array, a: Array, slopes: Array
) -> Array:
    """Turns the velocities of slow toes to those that friction turns them to, and returns the states, (2 nv, n).

    A toe slides along d if friction against d accelerates it along d. One step of Newton's method finds d. As d turns,
    the velocity lags behind: its acceleration across itself is its length times the rate at which it turns.

    Args:
        system: the system.
        arc: the arc.
        toes: toes that set out in it.
        t: times, in s, (n,).
        y: states, (2 nv, n).
        a: accelerations there, (nv, n).
        slopes: their derivatives with respect to the velocity, (nv, n, nv).
    """
    found, slow, still_slow = y.copy(), list[_Slow](), toes
    for i, state in enumerate(y.T):
        still_slow = [toe for toe in still_slow if _speed(system, state, toe) <= SLOW]  # one that was faster has turned
        if not still_slow:
            break
        slow.append(_Slow.find(system, arc, still_slow, state, a[:, i], slopes[:, i]))
    for i, each in enumerate(slow):
        rates = [_rate(t, [other.angles[toe] for other in slow if toe in other.angles]) for toe in each.angles]
        found[len(y) // 2 :, i] -= each.turning @ np.linalg.solve(each.by, each.across - each.squares * rates)
    return found


@dataclass(frozen=True)
class _Slow:
    """The k toes that are slow at one state.

    Attributes:
        angles: angles of the directions in which they would slide without a lag, in rad.
        squares: squares of their speeds, in m²/s², (k,).
        across: products of the parts of their accelerations across their velocities with their speeds, in m²/s³, (k,).
        by: derivatives of these, along velocities that turn, with respect to the angles, in m²/s³, (k, k).
        turning: changes of the generalised velocity that turn one toe by one radian and move no other, (nv, k).
    """

    angles: dict[str, float]
    squares: Array
    across: Array
    by: Array
    turning: Array

    @classmethod
    def find(cls, system: HybridSystem, arc: Arc, toes: Sequence[str], state: Array, a: Array, slopes: Array) -> _Slow:
        """Finds them at a state, with its acceleration, (nv,), and its derivatives by the velocity, (nv, nv)."""
        q, v = np.split(state, 2)
        rows = {toe: _jacobian(system, q, toe) for toe, _ in closed_toes(system.robot.toes, arc.domain)}
        along = np.array([rows[toe][:2] @ v for toe in toes])
        across = np.stack([-along[:, 1], along[:, 0]], axis=1)
        aims = np.zeros((len(rows), 3, len(toes)))
        for k, toe in enumerate(toes):
            aims[[*rows].index(toe), :2, k] = across[k]
        turning = np.linalg.pinv(np.concatenate([*rows.values()])) @ aims.reshape(-1, len(toes))
        drifts = [np.array(system.ground.seen_in(system.robot.toe_drift(q, v, toe))) for toe in toes]
        off = np.array([(rows[toe] @ a + drift)[:2] for toe, drift in zip(toes, drifts, strict=True)])
        by = np.array([across[k] @ rows[toe][:2] @ slopes @ turning for k, toe in enumerate(toes)])
        by -= np.diag(np.sum(along * off, axis=1))
        beside = np.sum(across * off, axis=1)
        angles = np.arctan2(along[:, 1], along[:, 0]) - np.linalg.solve(by, beside)
        return cls(dict(zip(toes, angles, strict=True)), np.sum(along**2, axis=1), beside, by, turning)


def _rate(t: Array, angles: Sequence[float]) -> float:
    """Returns the rate at which a direction turns, in rad/s: of a line through its first angles."""
    since = t[: len(angles)] - t[: len(angles)].mean()
    spread = float(since @ since)
    return float(since @ np.unwrap(angles)) / spread if spread > 0.0 else 0.0


def _speed(system: HybridSystem, state: Array, toe: str) -> float:
    q, v = np.split(state, 2)
    return float(np.linalg.norm(_jacobian(system, q, toe)[:2] @ v))


def _jacobian(system: HybridSystem, q: Array, toe: str) -> Array:
    return system.ground.foot(system.robot, q, toe)[1]
