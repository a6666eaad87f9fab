"""Gaits as equations for continuation: x = P(x), and targets, over one number or over the value of one target.

Derivatives are exact where a cycle has some; else they are differences of cycles. Only `Gaits.local` makes that choice.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.gaits.continuation.differences import differentiate_values as differenced
from spear_pin.gaits.continuation.problem import Local, NoValue
from spear_pin.gaits.family import Family
from spear_pin.gaits.tangent_cycles import differentiate_measured
from spear_pin.hybrid.batch import LOCK
from spear_pin.hybrid.charts import Chart, Charts
from spear_pin.hybrid.newton import differentiate_stencil as differences
from spear_pin.hybrid.newton import stencil
from spear_pin.hybrid.orders import Order
from spear_pin.hybrid.parameters import left_out_at_zero
from spear_pin.hybrid.periodic import chart, eigenvalues
from spear_pin.hybrid.result import State
from spear_pin.hybrid.section import section
from spear_pin.hybrid.shooting import SHORT_CYCLE, SHORTEST_CYCLE, Cycles
from spear_pin.hybrid.tangent.resets import REFUSALS
from spear_pin.hybrid.tangent.section import columns, on_section


@dataclass(frozen=True)
class About:
    """Data about a cycle besides its equations.

    Attributes:
        charts: the chart of the section around its state, ξ = 0.
        durations: seconds in each phase.
        residual: the largest component of P(x) - x in the section's coordinates.
    """

    charts: Charts
    durations: Mapping[str, float]
    residual: float


@dataclass(frozen=True)
class Gaits:
    """The equations. Points are (q, v, solved parameters, parameter), the last two scaled.

    Attributes:
        family: the systems; their numbers are the solved ones and, unless the parameter is a target, the parameter.
        wanted: the targets.
        over_target: whether the parameter is the value of one more target, the last.
        scale: scales of the solved parameters and the parameter, (k + 1,).
    """

    family: Family
    wanted: Array
    over_target: bool
    scale: Array

    def point(self, state: State, values: Array) -> Array:
        """Returns the point for a state with values of the solved parameters and the parameter, (k + 1,)."""
        return np.concatenate([*state, values / self.scale])

    def read(self, u: Array) -> tuple[State, Array]:
        """Returns the state, the solved parameters and the parameter at a point."""
        nq, nv = self.family.system.robot.nq, self.family.system.robot.nv
        return (u[:nq], u[nq : nq + nv]), u[nq + nv :] * self.scale

    def numbers(self, values: Array) -> Array:
        """Returns the family's numbers for solved parameters and parameter, (..., k + 1)."""
        return values[..., :-1] if self.over_target else values

    def local(self, u: Array) -> Local:
        """Returns the equations about a point; see `Problem`."""
        state, values = self.read(u)
        charts = self._charts(state, values)
        local, slides = self._local(charts, values)
        if slides is not None:  # the section's toes slide differently after landing
            local, _ = self._local(self._charts(state, values, slides), values)
        return local

    def _local(self, charts: Charts, values: Array) -> tuple[Local, NDArray[np.bool_] | None]:
        """Returns the equations about a chart's origin, and which toes slide after the cycle, if these are others."""
        d, exact = charts.dimension, self._exact(charts, values)
        residual, jacobian, directions, cycle = exact or self._differenced(charts, values)
        durations = {phase: float(seconds[0]) for phase, seconds in cycle.durations.items()}
        multipliers = eigenvalues(jacobian[:d, :d] + np.eye(d))
        about = About(charts, durations, float(np.abs(residual[:d]).max()))
        (q,), (v,) = charts.states(np.zeros((1, d)))
        local = Local(self.point((q, v), values), residual, jacobian, directions, multipliers, cycle.orders[0], about)
        after = charts.sliding(cycle.q, cycle.v)
        return local, None if (after == charts.slides).all() else after

    def _exact(self, charts: Charts, values: Array) -> tuple[Array, Array, Array, Cycles] | None:
        """Returns what `_differenced` does, with exact derivatives; None where there are none."""
        family, local, numbers = self.family, Chart(charts), self.numbers(values)
        named = zip(family.names, numbers, strict=True)
        vanishing = any(value == 0.0 and left_out_at_zero(name) for name, value in named)
        if not family.differentiable or vanishing:  # what is zero is not in the equations
            return None
        d, k = local.dimension, len(values)
        names, (q, v) = [str(name) for name in family.measures], local.state(np.zeros(d))
        try:
            system, own = family.member(numbers.tolist()), family.seeds(numbers)
            along, weight = np.pad(own.numbers, ((0, 0), (d, 0))), np.pad(own.weight, (d, 0))
            start, y = on_section(system, local, along), np.concatenate([q, v])
            found = differentiate_measured(family.recorder(numbers), y, start, along, weight, names)
            if found is None:
                return None
            with LOCK:
                moves = columns(system, local, found.cycle)
        except REFUSALS:
            return None
        begins, measured = charts.coordinates(q[None], v[None]), found.measured
        (residual,), cycles = self._compared(charts, begins, values[None], found.values)
        if cycles.reason[0]:
            raise NoValue(cycles.reason[0], cycles.orders[0])
        of_numbers = np.concatenate([np.ones(d), self.scale[: len(numbers)]])
        rows, wide = np.array([each.derivative for each in measured]).reshape(len(measured), moves.shape[1]), d + k
        jacobian = np.zeros((len(residual), wide))
        jacobian[:, : len(of_numbers)] = np.concatenate([moves - np.eye(*moves.shape), rows]) * of_numbers
        if self.over_target:
            jacobian[-1, -1] -= self.scale[-1]
        directions = np.concatenate([np.zeros((len(start), wide)), np.eye(k, wide, d)])
        directions[: len(start), : len(of_numbers)] = start * of_numbers
        return residual, jacobian, directions, cycles

    def _differenced(self, charts: Charts, values: Array) -> tuple[Array, Array, Array, Cycles]:
        """Returns F, its Jacobian by differences, the directions of `Local` and the cycle about a chart's origin."""
        d, seen = charts.dimension, list[Cycles]()

        def around(points: Array) -> tuple[Array, list[str], list[Order]]:
            found, cycles = self._residuals(charts, points[:, :d], points[:, d:] * self.scale)
            seen.append(cycles)
            return found, list(cycles.reason), list(cycles.orders)

        residual, jacobian, _ = differenced(around, np.concatenate([np.zeros(d), values / self.scale]))
        return residual, jacobian, self._directions(charts, values), seen[0]

    def glance(self, u: Array) -> tuple[Array, Order]:
        """Returns F at a point, and the order of events; see `Problem`."""
        state, values = self.read(u)
        charts = self._charts(state, values)
        found, cycles = self._residuals(charts, np.zeros((1, charts.dimension)), values[None])
        if cycles.reason[0]:
            raise NoValue(cycles.reason[0], cycles.orders[0])
        return found[0], cycles.orders[0]

    def moved(self, local: Local, step: Array) -> Array:
        """Returns the point that local coordinates lead to; see `Problem`."""
        _, values = self.read(local.u)
        charts = local.more.charts
        values = values + step[charts.dimension :] * self.scale
        q, v = self._on(charts, values[None]).states(step[None, : charts.dimension])
        return self.point((q[0], v[0]), values)

    def _charts(self, state: State, values: Array, slides: NDArray[np.bool_] | None = None) -> Charts:
        """Returns the chart around a state, with the toes that slide there, or with other sliding toes, (ntoes,)."""
        if not all(np.isfinite(part).all() for part in state):
            raise NoValue("not_finite")
        return chart(self.family.member(self.numbers(values).tolist()), state, slides).lane

    def _on(self, charts: Charts, values: Array) -> Charts:
        """Returns charts with the same directions for the sections with values of solved parameters and parameter."""
        numbers = self.numbers(values)
        if self.family.of_robot:
            charts = replace(charts, section=section(self.family.member(numbers[0].tolist())))
        return charts.on(dict(zip(self.family.names, numbers.T, strict=True)))

    def _placed(self, charts: Charts, xi: Array, values: Array) -> tuple[Array, Array, Array]:
        """Places lanes on the section by coordinates ξ and values of the parameters; returns states and their ξ."""
        robot = self.family.system.robot
        begins, q, v = np.empty_like(xi), np.empty((len(xi), robot.nq)), np.empty((len(xi), robot.nv))
        last = values[:, -1] if self.family.of_robot else np.zeros(len(xi))
        for value in np.unique(last):
            lanes = np.flatnonzero(last == value)
            here = self._on(charts.take(np.zeros(len(lanes), dtype=np.int64)), values[lanes])
            q[lanes], v[lanes] = here.states(xi[lanes])
            begins[lanes] = here.coordinates(q[lanes], v[lanes])
        return q, v, begins

    def _residuals(self, charts: Charts, xi: Array, values: Array) -> tuple[Array, Cycles]:
        """Returns F of lanes with coordinates ξ and values of the solved parameters and the parameter."""
        q, v, begins = self._placed(charts, xi, values)
        return self._compared(charts, begins, values, self.family.run(q, v, self.numbers(values)))

    def _compared(self, charts: Charts, begins: Array, values: Array, after: Cycles) -> tuple[Array, Cycles]:
        """Returns F of cycles that began at coordinates ξ, with a reason that also names cycles that no gait has."""
        whole = charts.take(np.zeros(len(begins), dtype=np.int64))
        ends = whole.coordinates(after.q, after.v)
        wanted = np.broadcast_to(self.wanted, (len(begins), len(self.wanted)))
        if self.over_target:
            wanted = np.column_stack([wanted, values[:, -1]])
        found = np.concatenate([ends - begins, after.measured - wanted], axis=1)
        reason = after.reason.copy()
        reason[(reason == "") & (sum(after.durations.values()) < SHORTEST_CYCLE)] = SHORT_CYCLE
        reason[(reason == "") & ~np.isfinite(found).all(axis=1)] = "not_finite"
        return found, replace(after, reason=reason)

    def _directions(self, charts: Charts, values: Array) -> Array:
        """Returns how a point moves on the section with ξ, the solved parameters and the parameter."""
        d = charts.dimension
        offsets = stencil(d + len(values))
        q, v, _ = self._placed(charts, offsets[:, :d], values + offsets[:, d:] * self.scale)
        points = np.concatenate([q, v, values / self.scale + offsets[:, d:]], axis=1)
        return np.asarray(differences(points[None])[0])
