"""Residuals of a played leg's motion over all arcs of a log, and their Jacobian, by variational equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number
from spear_pin.studies.logs.arcs import RATE, LogArc, rates_of
from spear_pin.studies.logs.measured import FLIGHT, Measured
from spear_pin.studies.logs.played import FRICTION, number_of, played_with
from spear_pin.studies.logs.shooting import Shooter, Shot

ZERO, LAG, HYSTERESIS = "_zero", "lag", "hysteresis"
PARTS = 4  # of each phase, by which what the model misses in every hop is told
STEP = 1e-5  # rad or m, by which a start is differentiated


@dataclass(frozen=True)
class Residuals:
    """Residuals of all arcs, with their Jacobian by the fitted values, then by where each arc sets out.

    Attributes:
        system: the user's system.
        leg: the leg as it is shot, see `played`.
        joints: its measured joints.
        arcs: the arcs.
        over: names of the fitted values.
        own: those of them that are numbers of the leg, and not of sensors.
        sensors: values of sensors, by name: zeros, and the lag.
        steps: by how much steps are shorter than need be, where friction makes the equations stiff.
    """

    system: HybridSystem
    leg: HybridSystem
    joints: Measured
    arcs: tuple[LogArc, ...]
    over: tuple[str, ...]
    own: tuple[str, ...]
    sensors: Mapping[str, float]
    steps: int = 1

    @cached_property
    def places(self) -> list[slice]:
        """Places of the unknowns of each arc's start."""
        sizes = [len(self.joints.rows) + len(self.joints.leading[arc.phase.name]) for arc in self.arcs]
        ends = len(self.over) + np.cumsum([0, *sizes])
        return [slice(int(i), int(j)) for i, j in zip(ends[:-1], ends[1:], strict=True)]

    @cached_property
    def weights(self) -> Array:
        """Weights of the measured joints, (m,): those of a length in m count as angles of its leg do."""
        length = max(self.joints.length(arc.near) for arc in self.arcs)
        units = [self.leg.robot.units[row] for row in self.joints.rows]
        return np.array([1.0 if unit == "rad" else 1.0 / length for unit in units])

    @cached_property
    def parts(self) -> Array:
        """Number of the part of the motion that each residual belongs to, (N,): a quarter of all stances or flights."""
        sizes = [(FLIGHT == arc.phase.name, arc.positions.shape) for arc in self.arcs]
        return np.concatenate([np.repeat(PARTS * (flies + np.arange(n) / n) // 1.0, m) for flies, (n, m) in sizes])

    def number(self, name: str) -> float:
        """Returns a number of the leg, by its name for users."""
        key, offset = number_of(self.system, name)
        return number(self.leg, key) + offset

    def first(self) -> Array:
        """Returns the values from which the search begins."""
        values = [self.sensors[name] if name in self.sensors else self.number(name) for name in self.over]
        some = slice(0, RATE)
        rates = [rates_of(self.joints, arc.phase.name, arc.t[some], arc.positions[some], 0) for arc in self.arcs]
        starts = [np.concatenate([arc.positions[0], own]) for arc, own in zip(self.arcs, rates, strict=True)]
        return np.concatenate([values, *starts])

    def bounds(self, first: Array) -> tuple[Array, Array]:
        """Returns least and largest values: what is positive stays so, and friction may vanish."""
        lower = np.full(len(first), -np.inf)
        for i, (name, value) in enumerate(zip(self.over, first, strict=False)):
            if name.endswith((FRICTION, HYSTERESIS)):
                lower[i] = 0.0
            elif name in self.own and value > 0.0 and not ("_com_" in name or "." in name or name.endswith("rest")):
                lower[i] = 1e-6 * value
        return lower, np.full(len(first), np.inf)

    def leg_with(self, x: Array) -> HybridSystem:
        """Returns the leg with the fitted values among x."""
        values = dict(zip(self.over, x[: len(self.over)].tolist(), strict=True))
        return played_with(self.leg, self.system, {name: values[name] for name in self.own})

    def shots(self, x: Array) -> list[tuple[Shot, Array, Array]]:
        """Returns, of each arc, the shot, the residuals, (n, m), and their Jacobian, (n, m, unknowns)."""
        k, keys = len(self.over), tuple(number_of(self.system, name)[0] for name in self.own)
        shooter = Shooter(self.leg_with(x), keys)
        values = dict(self.sensors) | dict(zip(self.over, x[:k].tolist(), strict=True))
        zeros = np.array([values[f"{joint}{ZERO}"] for joint in self.joints.joints])
        rows = self.joints.rows
        rate_rows = [self.leg.robot.nv + row for row in rows]
        found = []
        for mine, arc in zip(self.places, self.arcs, strict=True):
            y, slope = self._begin(x[mine], arc)
            c, d = len(self.own) + slope.shape[1], len(self.joints.joints)
            dy = np.hstack([np.zeros((len(y), len(self.own))), slope, np.zeros((len(y), d))])
            latched, turns = self._latched(arc, zeros)
            dlatched = np.hstack([np.zeros((len(turns), c)), turns])
            shot = shooter.shoot(arc.phase.name, arc.t, arc.torques, y, dy, latched, dlatched, self.steps)
            late = values[LAG]
            positions = CubicHermiteSpline(arc.t, shot.y[:, rows], shot.y[:, rate_rows])
            residual = positions(arc.t - late) + zeros - arc.positions
            jacobian = np.zeros((*residual.shape, len(x)))
            whole = CubicHermiteSpline(arc.t, shot.dy[:, rows], shot.dy[:, rate_rows])(arc.t - late)
            jacobian[:, :, [self.over.index(name) for name in self.own]] = whole[:, :, : len(self.own)]
            jacobian[:, :, mine] = whole[:, :, len(self.own) : c]
            for j, joint in enumerate(self.joints.joints):
                if f"{joint}{ZERO}" in self.over:
                    jacobian[:, :, self.over.index(f"{joint}{ZERO}")] = whole[:, :, c + j]
                    jacobian[:, j, self.over.index(f"{joint}{ZERO}")] += 1.0
            if LAG in self.over:
                jacobian[:, :, self.over.index(LAG)] = -positions(arc.t - late, 1)
            found.append((shot, residual, jacobian))
        return found

    def _latched(self, arc: LogArc, zeros: Array) -> tuple[Array, Array]:
        """Returns the configuration at touchdown, (nv,), and its derivatives by the joints' zeros, (nv, m)."""
        at = arc.touchdown - zeros
        steps = STEP * np.eye(len(at))
        found = [self.joints.configuration(each, arc.near) for each in (at, *(at - steps), *(at + steps))]
        m = len(at)
        return found[0], (np.array(found[1 : 1 + m]) - np.array(found[1 + m :])).T / (2.0 * STEP)

    def _begin(self, at: Array, arc: LogArc) -> tuple[Array, Array]:
        """Returns the state at which an arc sets out, (2 nv,), and its derivatives, (2 nv, d), by differences."""
        m = len(self.joints.rows)

        def state(at: Array) -> Array:
            return self.joints.state(arc.phase.name, at[:m], at[m:], arc.near, arc.base)

        steps = STEP * np.eye(len(at))
        return state(at), np.array([(state(at + h) - state(at - h)) / (2.0 * STEP) for h in steps]).T

    def joined(self, x: Array) -> tuple[Array, Array]:
        """Returns all residuals, (N,), weighted, and their Jacobian, (N, unknowns)."""
        shots = self.shots(x)
        residuals = [(self.weights * residual).ravel() for _, residual, _ in shots]
        jacobians = [(self.weights[:, None] * jacobian).reshape(-1, len(x)) for _, _, jacobian in shots]
        return np.concatenate(residuals), np.vstack(jacobians)
