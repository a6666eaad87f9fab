"""Residuals of a played leg's motion over all arcs of a log, and their Jacobian, by variational equations."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from scipy.interpolate import CubicHermiteSpline

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number
from spear_pin.studies.logs.arcs import RATE, LogArc, fit_rates
from spear_pin.studies.logs.measured import FLIGHT, Measured
from spear_pin.studies.logs.played import FRICTION, find_number, played_with
from spear_pin.studies.logs.shooting import Shooter, Shot

ZERO, LAG, HYSTERESIS = "_zero", "lag", "hysteresis"
HEIGHT = "boom_z"  # the coordinate that a sensor beside those of the joints may show, with a lag of its own
HEIGHT_SENSOR = f"{HEIGHT}{ZERO}", f"{HEIGHT}_{LAG}"
PARTS = 4  # of each phase, by which what the model misses in every hop is told
LEAST = 1e-3  # of the joints' residuals: those of what is beside do not count as less
STEP = 1e-5  # rad or m, by which a start is differentiated
LOST = 1e3  # rad or m: residuals of a motion that cannot be integrated, so that a search takes a shorter step


@dataclass(frozen=True)
class Residuals:
    """Residuals of all arcs, with their Jacobian by the fitted values, then by where each arc sets out.

    Attributes:
        system: the user's system.
        leg: the leg as it is shot, see `make_played`.
        joints: its measured joints.
        arcs: the arcs.
        over: names of the fitted values.
        own: those of them that are numbers of the leg, and not of sensors.
        sensors: values of sensors, by name: zeros, and the lag.
        beside: names of measured coordinates of the base: the height, or none.
        steps: by how much steps are shorter than need be, where friction makes the equations stiff.
        trust: factor of the weights of what is beside.
    """

    system: HybridSystem
    leg: HybridSystem
    joints: Measured
    arcs: tuple[LogArc, ...]
    over: tuple[str, ...]
    own: tuple[str, ...]
    sensors: Mapping[str, float]
    beside: tuple[str, ...] = ()
    steps: int = 1
    trust: float = 1.0

    @property
    def names(self) -> tuple[str, ...]:
        """Names of all that was measured, (m + o)."""
        return *self.joints.joints, *self.beside

    @cached_property
    def places(self) -> list[slice]:
        """Places of the unknowns of each arc's start."""
        sizes = [len(each) for each in self._starts]
        ends = len(self.over) + np.cumsum([0, *sizes])
        return [slice(int(i), int(j)) for i, j in zip(ends[:-1], ends[1:], strict=True)]

    @cached_property
    def weights(self) -> Array:
        """Weights of all that was measured, (m + o,): lengths in m count as angles of a leg so long do."""
        length = max(self.joints.length(arc.near) for arc in self.arcs)
        units = [self.leg.robot.units[self.leg.robot.index(name)] for name in self.names]
        own = np.array([1.0 if unit == "rad" else 1.0 / length for unit in units])
        return own * np.where(np.arange(len(own)) < len(self.joints.rows), 1.0, self.trust)

    @cached_property
    def parts(self) -> Array:
        """Number of the part of the motion that each residual belongs to, (N,): a quarter of all stances or flights."""
        found = []
        for arc in self.arcs:
            quarters = PARTS * ((arc.phase.name == FLIGHT) + np.arange(len(arc.t)) / len(arc.t)) // 1.0
            found.append(np.broadcast_to(quarters[:, None], arc.seen.shape)[np.isfinite(arc.seen)])
        return np.concatenate(found)

    def number(self, name: str) -> float:
        """Returns a number of the leg, by its name for users."""
        key, offset = find_number(self.system, name)
        return number(self.leg, key) + offset

    def first(self) -> Array:
        """Returns the values from which the search begins."""
        values = [self.sensors[name] if name in self.sensors else self.number(name) for name in self.over]
        return np.concatenate([values, *self._starts])

    @cached_property
    def _starts(self) -> list[Array]:
        """Where arcs set out: positions, leading rates, and in flight how far off the base is if it is measured."""
        some, found = slice(0, RATE), []
        for arc in self.arcs:
            rates = fit_rates(self.joints, arc.phase.name, arc.t[some], arc.positions[some], 0)
            base = np.zeros(2 * len(self.beside) if arc.phase.name == FLIGHT else 0)
            found.append(np.concatenate([arc.positions[0], rates, base]))
        return found

    def balanced(self, x: Array) -> Residuals:
        """Returns the same with what is beside weighted by its own noise, as it is at x."""
        m = len(self.joints.rows)
        residual = self.weights * np.vstack([residual for _, residual, _ in self.shots(x)])
        sizes = [float(np.sqrt(np.nanmean(each**2))) for each in (residual[:, :m], residual[:, m:])]
        return replace(self, trust=self.trust * sizes[0] / max(sizes[1], LEAST * sizes[0]))

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
        """Returns, of each arc, the shot, the residuals, (n, m + o), and their Jacobian, (n, m + o, unknowns)."""
        k, keys = len(self.over), tuple(find_number(self.system, name)[0] for name in self.own)
        shooter = Shooter(self.leg_with(x), keys)
        values = dict(self.sensors) | dict(zip(self.over, x[:k].tolist(), strict=True))
        zeros, nv = np.array([values[f"{joint}{ZERO}"] for joint in self.joints.joints]), self.leg.robot.nv
        found = []
        for mine, arc in zip(self.places, self.arcs, strict=True):
            y, slope = self._begin(x[mine], arc)
            c, d = len(self.own) + slope.shape[1], len(self.joints.joints)
            dy = np.hstack([np.zeros((len(y), len(self.own))), slope, np.zeros((len(y), d))])
            latched, turns = self._latched(arc, zeros)
            dlatched = np.hstack([np.zeros((len(turns), c)), turns])
            shot = shooter.shoot(arc.phase.name, arc.t, arc.torques, y, dy, latched, dlatched, self.steps)
            residual = -arc.seen
            jacobian = np.zeros((*residual.shape, len(x)))
            if not shot.bounded:
                found.append((shot, np.where(np.isfinite(residual), LOST, np.nan), jacobian))
                continue
            for i, name in enumerate(self.names):
                row, zero = self.leg.robot.index(name), f"{name}{ZERO}"
                lag = f"{name}_{LAG}" if name in self.beside else LAG
                late = arc.t - values[lag]
                positions = CubicHermiteSpline(arc.t, shot.y[:, row], shot.y[:, nv + row])
                residual[:, i] += positions(late) + values[zero]
                whole = CubicHermiteSpline(arc.t, shot.dy[:, row], shot.dy[:, nv + row])(late)
                jacobian[:, i, [self.over.index(each) for each in self.own]] = whole[:, : len(self.own)]
                jacobian[:, i, mine] = whole[:, len(self.own) : c]
                for j, joint in enumerate(self.joints.joints):
                    if f"{joint}{ZERO}" in self.over:
                        jacobian[:, i, self.over.index(f"{joint}{ZERO}")] = whole[:, c + j]
                if zero in self.over:
                    jacobian[:, i, self.over.index(zero)] += 1.0
                if lag in self.over:
                    jacobian[:, i, self.over.index(lag)] = -positions(late, 1)
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
        m, robot = len(self.joints.rows), self.leg.robot
        ends = m + len(self.joints.leading[arc.phase.name])
        base = [first + robot.index(name) for first in (0, robot.nv) for name in self.beside]

        def state(at: Array) -> Array:
            y = self.joints.state(arc.phase.name, at[:m], at[m:ends], arc.near, arc.base)
            y[base[: len(at) - ends]] += at[ends:]
            return y

        steps = STEP * np.eye(len(at))
        return state(at), np.array([(state(at + h) - state(at - h)) / (2.0 * STEP) for h in steps]).T

    def joined(self, x: Array) -> tuple[Array, Array]:
        """Returns all residuals, (N,), weighted, and their Jacobian, (N, unknowns)."""
        try:
            shots = self.shots(x)
        except BadValue:  # a search tries what no number can be
            return np.full(len(self.parts), LOST), np.zeros((len(self.parts), len(x)))
        there = [np.isfinite(residual) for _, residual, _ in shots]
        residuals = [(self.weights * shot[1])[each] for shot, each in zip(shots, there, strict=True)]
        jacobians = [(self.weights[:, None] * shot[2])[each] for shot, each in zip(shots, there, strict=True)]
        return np.concatenate(residuals), np.vstack(jacobians)
