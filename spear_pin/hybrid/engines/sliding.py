"""Toes that slide: the constraint of the toes on the ground at a state, and the sliding directions of toes in space.

A toe in space slides along its velocity. A toe that begins to slide has no velocity yet. It takes the direction in
which it would accelerate under friction against that direction, computed anew at every state while it sets out. Its
velocity would turn to that direction almost at once, which an explicit integrator could follow only at great cost.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.contact import SETTING_OUT, SIGN, SLOW, solve, solve_constrained
from spear_pin.hybrid.rules.cone import slides
from spear_pin.hybrid.rules.footing import AT_REST, STARTS_TO_SLIDE, along

Ways = Mapping[str, tuple[float, ...]]
"""Of toes that slide, the unit vectors along the ground in which they do."""
LONGEST, GLANCE = 1e-4, 1e-6  # s: longest step of toes that set out, and a short time to see how much faster they get
AIM = 1.05 * SETTING_OUT  # m/s: speed that the last of these steps is to reach
SWEEPS, SETTLED = 100, 1e-12  # iterations and tolerance for the directions in which several toes begin to slide


@dataclass(frozen=True)
class Grounded:
    """Toes on the ground at a state, and what else binds the robot.

    Attributes:
        D: mass matrix, (nv, nv).
        net: generalised force minus bias, (nv,).
        jacobians: Jacobian of each toe, along the ground and normal to it, (2, nv) or (3, nv); of a guided toe that
            rests only normal to it, (1, nv).
        drifts: J̇ v of each toe, of as many numbers.
        bound: rows of closed loops, and of joints that are held, (m, nv).
        bound_drift: their drift, (m,).
        friction: coefficient of friction.
    """

    D: Array
    net: Array
    jacobians: Mapping[str, Array]
    drifts: Mapping[str, Array]
    bound: Array
    bound_drift: Array
    friction: float

    def constraint(self, toes: Sequence[str], ways: Ways) -> tuple[Array, Array, Array]:
        """Returns rows A, directions G and drift of some toes and of `bound`, as `solve_constrained` takes them."""
        A, G, drift = [], [], []
        for toe in toes:
            jacobian, toe_drift = self.jacobians[toe], self.drifts[toe]
            if toe not in ways:
                A += [*jacobian]
                G += [*jacobian]
                drift += toe_drift.tolist()
            else:
                A.append(jacobian[-1])
                G.append(jacobian[-1] - self.friction * along(ways[toe], jacobian[:-1]))
                drift.append(toe_drift[-1])
        return np.array([*A, *self.bound]), np.array([*G, *self.bound]).T, np.array([*drift, *self.bound_drift])

    def alone(self, toe: str, ways: Ways) -> tuple[Array, Array]:
        """Returns A and b of a toe, see `rules.cone`, while all other toes keep to their modes."""
        others = [each for each in self.jacobians if each != toe]
        forces = np.column_stack([self.net, self.jacobians[toe].T])
        if others or len(self.bound):
            a = solve_constrained(self.D, forces, *self.constraint(others, ways))[0]
        else:
            a = solve(self.D, forces)
        seen = self.jacobians[toe] @ a
        return seen[:, 1:], seen[:, 0] + self.drifts[toe]

    def against(self, begin: Sequence[str], ways: Ways) -> dict[str, tuple[float, ...]]:
        """Returns the directions against the forces that would hold some toes at rest."""
        toes = [*self.jacobians]
        _, multiplier, _ = solve_constrained(self.D, self.net, *self.constraint(toes, ways))
        found, row = dict[str, tuple[float, ...]](), 0
        for toe in toes:
            k = len(self.drifts[toe])
            if toe in begin:
                held = multiplier[row : row + k - 1].tolist()
                size = math.hypot(*held)
                found[toe] = tuple(-force / size for force in held) if size > 0.0 else (1.0, 0.0)
            row += 1 if toe in ways else k
        return found


class Sliding:
    """Directions in which the toes of one domain slide, including toes that set out.

    A toe sets out if it is at rest at the first call, and does so until it has reached `SETTING_OUT`, or slows down. If
    it slows down before it has reached `SLOW`, it keeps its direction, along which it then moves back. States that are
    only tried, such as those of a step that an integrator rejects, change nothing: the motion is smooth in a step.

    Args:
        modes: modes of the toes that slide.

    Attributes:
        left: longest step in which no toe gets much faster than `SETTING_OUT` while it sets out, in s.
    """

    def __init__(self, modes: Mapping[str, str]) -> None:
        self._fixed = {toe: (SIGN[mode],) for toe, mode in modes.items() if mode in SIGN}
        self._free = [toe for toe in modes if toe not in self._fixed]
        self._begun: dict[str, tuple[float, ...]] | None = None
        self.left = math.inf

    def __call__(self, grounded: Grounded, velocity: Callable[[str], tuple[float, ...]]) -> Ways:
        """Returns the directions at a state.

        Args:
            grounded: the toes at that state.
            velocity: returns the velocity of a toe, along the ground and normal to it, in m/s.
        """
        ways: dict[str, tuple[float, ...]] = {**self._fixed}
        slow = []
        for toe in self._free:
            tangential = velocity(toe)[:-1]
            speed = math.hypot(*tangential)
            if speed <= self._slow(toe):
                slow.append(toe)
            else:
                ways[toe] = tuple(each / speed for each in tangential)
        found = self._onset(grounded, slow, ways) if slow else {}
        if self._begun is None:
            self._begun = found
        return ways | found

    def arrive(self, speeds: Mapping[str, float], accelerations: Mapping[str, float], ways: Ways) -> None:
        """Updates the toes that set out, and their directions, after the motion has reached a state.

        Args:
            speeds: speed of each toe along its direction, in m/s.
            accelerations: acceleration of each toe along its direction, in m/s².
            ways: the directions at that state.
        """
        going = (toe for toe in self._begun or () if abs(speeds[toe]) <= SETTING_OUT)
        keeps = (toe for toe in going if accelerations[toe] >= -STARTS_TO_SLIDE or speeds[toe] <= SLOW)
        self._begun = {toe: ways[toe] for toe in keeps}
        self.left = LONGEST if self._begun else math.inf

    def look_ahead(self, speeds: Mapping[str, float], now: Mapping[str, float], soon: Mapping[str, float]) -> None:
        """Shortens the next step so that no toe that sets out gets much faster than `SETTING_OUT` in it.

        Args:
            speeds: speed of each toe along its direction, in m/s.
            now: acceleration of each toe along its direction, in m/s².
            soon: the accelerations after `GLANCE`.
        """
        for toe in self._begun or ():
            more, gain, jerk = AIM - speeds[toe], max(now[toe], 0.0), max((soon[toe] - now[toe]) / GLANCE, 0.0)
            if gain + jerk > 0.0:  # more = gain * left + 0.5 * jerk * left ** 2
                self.left = min(self.left, 2.0 * more / (gain + math.sqrt(gain**2 + 2.0 * jerk * more)))

    @property
    def sets_out(self) -> bool:
        """Tells whether some toe sets out."""
        return bool(self._begun)

    def _slow(self, toe: str) -> float:
        """Returns the speed up to which a toe's velocity does not define its direction."""
        if self._begun is None:
            return AT_REST
        return math.inf if toe in self._begun else 0.0

    def _onset(self, grounded: Grounded, slow: Sequence[str], moving: Ways) -> dict[str, tuple[float, ...]]:
        """Finds the directions of toes that set out, near the earlier ones or against the force that would hold them.

        The directions of several toes depend on each other; each is found in turn until none changes. One is found at
        once.
        """
        begun = self._begun or {}
        ways = {**moving, **{toe: begun[toe] for toe in slow if toe in begun}}
        if new := [toe for toe in slow if toe not in ways]:
            ways |= grounded.against(new, ways)
        for _ in range(SWEEPS if len(slow) > 1 else 1):
            before = dict(ways)
            for toe in slow:
                A, b = grounded.alone(toe, ways)
                found = slides(A, b, grounded.friction, -STARTS_TO_SLIDE)
                if found:
                    ways[toe] = min((each.direction for each in found), key=partial(math.dist, ways[toe]))
            if all(math.dist(ways[toe], before[toe]) < SETTLED for toe in slow):
                break
        return {toe: ways[toe] for toe in slow}
