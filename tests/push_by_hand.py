"""The push test by hand: one leg on a pinned toe, derived from positions as functions of the knee's angle alone.

No constraint is solved here: the toe is the origin, the hip above it, and every position a closed-form
function of θ, with (4.1)-(4.4) in them. The equation of motion is Lagrange's. The ground's vertical force
is Newton's law for all masses together; the horizontal one, since the slider bears some too, is from the
balance of moments about the hip. Nothing is shared with the package.
"""

from __future__ import annotations

import itertools
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from spear_pin.arrays import Array
from tests.lagrangian import BOOM_MASS, GRAVITY, SPEAR_II_LEG, Leg

FINEST = {"method": "LSODA", "rtol": 1e-12, "atol": 1e-14}
NODES, WEIGHTS = np.polynomial.legendre.leggauss(60)


@dataclass(frozen=True)
class Quantities:
    """Functions of θ, each given as a derivative with respect to it where it says "slope" or "bend".

    Attributes:
        inertia: kinetic energy is half of it, times θ̇², in kg·m².
        half_slope: half of its slope.
        potential: of gravity, in J.
        gravity: its slope.
        height: of the hip.
        height_slope: its slope.
        height_bend: the slope of that.
        thigh: absolute angle of the thigh, positive with the knee forward.
        thigh_slope: its slope.
        thigh_bend: the slope of that.
        forces: of the ground, x and z, per θ̈, per θ̇² and at rest, in N.
    """

    inertia: float
    half_slope: float
    potential: float
    gravity: float
    height: float
    height_slope: float
    height_bend: float
    thigh: float
    thigh_slope: float
    thigh_bend: float
    forces: Array


@cache
def derive(leg: Leg, hip_mass: float) -> Callable[[float], list]:
    """Everything in `Quantities` by differentiating positions."""
    th = sp.Symbol("theta", real=True)
    (upper, lower), (m1, m2), (d1, d2) = leg.lengths, leg.masses, leg.coms
    height = sp.sqrt(upper**2 + lower**2 + 2 * upper * lower * sp.cos(th))  # law of cosines
    thigh = sp.atan2(lower * sp.sin(th), upper + lower * sp.cos(th))
    shank = thigh - th
    hip = sp.Matrix([0, height])
    along_thigh, along_shank = (sp.Matrix([sp.sin(a), -sp.cos(a)]) for a in (thigh, shank))
    places = [(hip_mass, hip), (m1, hip + d1 * along_thigh), (m2, hip + upper * along_thigh + d2 * along_shank)]
    kinetic = sum((m * p.diff(th).dot(p.diff(th)) for m, p in places), sp.Integer(0))
    kinetic += leg.inertias[0] * thigh.diff(th) ** 2 + leg.inertias[1] * shank.diff(th) ** 2
    kinetic += leg.rotors[0] * thigh.diff(th) ** 2 + leg.rotors[1]  # hip and knee turn by the thigh's angle and θ
    potential = sum((m * GRAVITY * p[1] for m, p in places), sp.Integer(0))
    spins = [(leg.inertias[0] + leg.rotors[0], thigh), (leg.inertias[1], shank)]  # the hip's rotor turns as the thigh
    turned = [sp.Matrix([-(p - hip)[1], (p - hip)[0]]) for _, p in places]  # all as one about the hip
    forces = []
    for order in (1, 2):
        moment = sum((m * p.diff(th, order).dot(t) for (m, p), t in zip(places, turned, strict=True)), sp.Integer(0))
        moment += sum((inertia * angle.diff(th, order) for inertia, angle in spins), sp.Integer(0))
        forces += [moment / height, sum((m * p[1].diff(th, order) for m, p in places), sp.Integer(0))]
    weights = [m * GRAVITY for m, _ in places]
    forces += [sum(w * t[1] for w, t in zip(weights, turned, strict=True)) / height, sum(weights)]
    outputs = [kinetic, kinetic.diff(th) / 2, potential, potential.diff(th)]
    outputs += [height, height.diff(th), height.diff(th, 2), thigh, thigh.diff(th), thigh.diff(th, 2)]
    outputs += forces
    return sp.lambdify(th, outputs, "math", cse=True)


@dataclass(frozen=True)
class Push:
    """The leg with what acts on its knee: -k (θ - θ₀) - b θ̇ - τ_c sign θ̇."""

    stiffness: float = 48.25
    damping: float = 1.03
    coulomb: float = 0.0
    zero: float = 1.0
    unilateral: bool = False
    rotor: float = 0.027
    leg: Leg = SPEAR_II_LEG
    hip_mass: float = BOOM_MASS

    def at(self, angle: float) -> Quantities:
        """Positions and terms of the equation of motion at an angle."""
        leg = self.leg
        geared = Leg(leg.masses, leg.coms, leg.inertias, leg.lengths, (leg.rotors[0], self.rotor))
        values = derive(geared, self.hip_mass)(float(angle))
        return Quantities(*values[:-6], np.reshape(values[-6:], (3, 2)))

    def spring(self, angle: float) -> float:
        stretch = angle - self.zero
        return -self.stiffness * (max(stretch, 0.0) if self.unilateral else stretch)

    def acceleration(self, angle: float, rate: float, sign: float) -> float:
        """Of the knee, with the dry friction of a motion in the direction of a sign."""
        q = self.at(angle)
        torque = self.spring(angle) - self.damping * rate - self.coulomb * sign
        return (torque - q.gravity - q.half_slope * rate**2) / q.inertia

    def ground_force(self, angle: float, rate: float, acceleration: float) -> Array:
        """On the toe, x and z, in N."""
        return np.array([acceleration, rate**2, 1.0]) @ self.at(angle).forces

    def energy(self, angle: float, rate: float = 0.0) -> float:
        """Kinetic, of gravity and of the spring, in J."""
        q, stretch = self.at(angle), angle - self.zero
        stored = 0.5 * self.stiffness * (max(stretch, 0.0) if self.unilateral else stretch) ** 2
        return 0.5 * q.inertia * rate**2 + q.potential + stored

    def rest(self) -> float:
        """Where the weight and the spring balance."""
        return brentq(lambda a: self.spring(a) - self.at(a).gravity, 0.3, 2.8, xtol=1e-15)

    def pushed(self, depth: float) -> float:
        """The angle with the hip a depth below its height at rest: law of cosines, the other way round."""
        upper, lower = self.leg.lengths
        height = self.at(self.rest()).height - depth
        return float(np.arccos((height**2 - upper**2 - lower**2) / (2 * upper * lower)))

    def swings(self, start: float, times: Array) -> tuple[Array, Array, list[tuple[float, float]]]:
        """Angle and rate at times, and each turn (time, angle): one half swing after the other.

        Dry friction has one sign within a half swing; the motion ends where it can hold the leg.
        """
        times = np.asarray(times, float)
        angles, rates, turns = np.full(times.size, start), np.zeros(times.size), []
        now, here = 0.0, float(start)
        while now < times[-1]:
            push = self.spring(here) - self.at(here).gravity
            if abs(push) <= self.coulomb:
                break
            sign = 1.0 if push > 0 else -1.0

            def stands(t, y, sign=sign):
                return sign * y[1] if t > 1e-3 else 1.0  # not at the start of the swing

            stands.terminal, stands.direction = True, -1.0
            result = solve_ivp(
                lambda t, y, sign=sign: [y[1], self.acceleration(*y, sign)],
                (0.0, max(times[-1] - now, 2e-3)),
                [here, 0.0],
                events=stands,
                dense_output=True,
                max_step=0.02,
                **FINEST,
            )
            during = (times >= now) & (times <= now + result.t[-1])
            angles[during], rates[during] = result.sol(times[during] - now)
            now, here = now + result.t[-1], float(result.y[0, -1])
            if result.status == 1:
                turns.append((now, here))
            angles[times > now], rates[times > now] = here, 0.0
        return angles, rates, turns

    def turns_by_energy(self, start: float, count: int = 50) -> list[tuple[float, float]]:
        """Turns (time, angle) without viscous damping, from the balance of energy alone.

        On a half swing E + τ_c |θ - start| is constant, so its end is a root; the time is an integral over
        θ = middle - reach cos s, in which the rate's zeros at both ends cancel. A spring that only pulls
        begins or ceases to within it: the integral is taken in two parts.
        """
        assert self.damping == 0.0
        turns, now, here = [], 0.0, float(start)
        while len(turns) < count:
            push = self.spring(here) - self.at(here).gravity
            if abs(push) <= self.coulomb:
                break
            sign = 1.0 if push > 0 else -1.0

            def kinetic(angle, here=here, sign=sign):
                return self.energy(here) - self.energy(angle) - self.coulomb * sign * (angle - here)

            steps = here + sign * np.linspace(0.0, 3.0, 601)[1:]
            first = next(a for a in steps if kinetic(a) < 0.0)
            end = brentq(kinetic, first - sign * 0.005, first, xtol=1e-15)
            middle, reach = 0.5 * (here + end), 0.5 * (end - here)
            kink = [np.arccos((middle - self.zero) / reach)] if abs(self.zero - middle) < abs(reach) else []
            for low, high in itertools.pairwise([0.0, *kink, np.pi]):
                s = 0.5 * (low + high) + 0.5 * (high - low) * NODES
                slowness = [np.sqrt(0.5 * self.at(a).inertia / kinetic(a)) for a in middle - reach * np.cos(s)]
                now += 0.5 * (high - low) * WEIGHTS @ (abs(reach) * np.sin(s) * slowness)
            here = end
            turns.append((now, here))
        return turns
