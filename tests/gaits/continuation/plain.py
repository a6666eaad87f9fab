"""A plain return map as equations that can be continued."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from spear_pin.gaits.continuation.differences import differentiate_values
from spear_pin.gaits.continuation.follow import Way, follow
from spear_pin.gaits.continuation.problem import Local, NoValue
from spear_pin.gaits.continuation.stepping import orient_tangent
from spear_pin.hybrid.orders import Order
from spear_pin.hybrid.periodic import eigenvalues


@dataclass(frozen=True)
class Plain:
    """Fixed points of `returned(x, parameter)`, which is the state after a cycle and the order of events."""

    returned: Callable[[np.ndarray, float], tuple[np.ndarray, Order]]
    scale: np.ndarray

    def local(self, u):
        x, n = u * self.scale, len(u)
        _, jacobian, order = differentiate_values(self._values, u)
        residual = self._values(u[None])[0][0]
        state = jacobian[:, :-1] / self.scale[:-1]
        return Local(u, residual, jacobian, np.eye(n), eigenvalues(state + np.eye(n - 1)), order, x)

    def glance(self, u):
        values, why, orders = self._values(u[None])
        if why[0]:
            raise NoValue(why[0], orders[0])
        return values[0], orders[0]

    def moved(self, local, step):
        return local.u + step

    def _values(self, points):
        found, why, orders = [], [], []
        for u in points * self.scale:
            try:
                after, order = self.returned(u[:-1], float(u[-1]))
                found.append(after - u[:-1])
                why.append("")
            except NoValue as nothing:
                found.append(np.full(len(u) - 1, np.nan))
                why.append(nothing.reason)
                order = nothing.order
            orders.append(order)
        return np.array(found), why, orders

    def both_ways(self, x, parameter: float, bounds, longest: float = 0.1) -> tuple[Way, Way]:
        """The branch from a fixed point to lesser and to greater parameters at first."""
        u = np.append(x, parameter) / self.scale
        row = np.eye(len(u))[-1]
        local = self.local(u)
        assert np.abs(local.residual).max() < 1e-9
        span = bounds[0] / self.scale[-1], bounds[1] / self.scale[-1]
        return tuple(follow(self, orient_tangent(local, sign * row), span, longest, 500) for sign in (-1.0, 1.0))


def kinds(way: Way) -> list[str]:
    """What was met, by kind."""
    return [met.kind for _, met in way.met]
