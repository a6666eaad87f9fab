"""Basins of attraction from tens of thousands of states: which states reach a gait, and how the others end."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, require
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.section import section
from spear_pin.kinds import typed

NEAR = 0.01  # m, rad, m/s, rad/s
ELSEWHERE = "elsewhere"  # still going, but not near the gait


@dataclass(frozen=True)
class Attraction:
    """Outcome of each state.

    Attributes:
        cycles: whole cycles until the state was near the gait, (n,); NaN where it never was.
        reason: "reached", "elsewhere", or why the run ended, (n,).
    """

    cycles: Array
    reason: NDArray[np.str_]

    @property
    def share(self) -> float:
        """Share of the states that reach the gait."""
        return float(np.isfinite(self.cycles).mean()) if len(self.cycles) else float("nan")


@typed
def attraction(
    gait: Gait,
    q: ArrayLike,
    v: ArrayLike,
    cycles: int = 15,
    near: float = NEAR,
    on_cycle: Callable[[int, int], object] = lambda cycle, left: None,
) -> Attraction:
    """Simulates many states until they are near the gait at the section.

    Args:
        gait: the gait.
        q: configurations, (n, nq), on the section or in the air.
        v: velocities, (n, nv).
        cycles: number of whole cycles after which a state counts as lost.
        near: largest difference of a coordinate or velocity, without translation along the ground, in m, rad, m/s,
            rad/s.
        on_cycle: called with the cycle and the number of states that have not ended.

    Raises:
        BadValue: an argument of `simulate_many` is not valid.
        MissingExtra: heyoka is not installed.
    """
    require("near", near, lambda distance: distance > 0, "a number > 0")
    system = gait.system
    q, v = np.array(q, dtype=float), np.array(v, dtype=float)
    n = len(q)
    taken, reason = np.full(n, np.nan), np.full(n, ELSEWHERE, dtype=object)
    left = np.arange(n)
    whole, begins = section(system), (gait.state[0][None], gait.state[1][None])
    for cycle in range(1, cycles + 1):
        if not len(left):
            break
        on_cycle(cycle, len(left))
        found = simulate_many(system, q[left], v[left])
        q[left], v[left] = found.q, found.v
        goes_on = found.reason == "complete"
        reason[left[~goes_on]] = found.reason[~goes_on]
        away = np.abs(whole.displacement(begins, (found.q, found.v))).max(axis=1)
        reached = goes_on & (away < near)
        taken[left[reached]], reason[left[reached]] = cycle, "reached"
        left = left[goes_on & ~reached]
    return Attraction(taken, reason.astype(str))


@typed
def make_drops(gait: Gait, clearances: ArrayLike, knees: ArrayLike) -> tuple[Array, Array]:
    """Returns a grid of states from which SPEAR-II is dropped at rest, with its toe below the hip.

    Args:
        gait: a hop in place.
        clearances: heights of the toe above the ground, in m, (m,).
        knees: angles of the knee, in rad, (k,).

    Returns:
        configurations, (m k, nq), the knee varying fastest, and velocities, zero.

    Raises:
        BadValue: the gait is not a hop.
    """
    robot = gait.system.robot
    if robot.coordinates[-2:] != ("hip", "knee"):
        raise BadValue("gait", gait.system.kind, "a hop of SPEAR-II")
    height, knee = (part.ravel() for part in np.meshgrid(clearances, knees, indexing="ij"))
    q = np.zeros((len(height), robot.nq))
    q[:, robot.index("hip")], q[:, robot.index("knee")] = 0.5 * knee, knee
    reach = {
        float(angle): robot.toe_position([*[0.0] * (robot.nq - 2), 0.5 * angle, angle], "toe")[1] for angle in knee
    }
    q[:, robot.index("boom_z")] = (
        height - np.array([reach[float(angle)] for angle in knee]) + gait.system.ground.under(0.0)
    )
    return q, np.zeros((len(height), robot.nv))
