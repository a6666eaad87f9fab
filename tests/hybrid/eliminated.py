"""Hops of legs with loops in independent coordinates alone, from Lagrangians whose loops are solved in closed form."""

import math
from functools import lru_cache

import numpy as np
import sympy as sp
from scipy.integrate import solve_ivp

from tests.hybrid.looped_hops import FOLDS, LAWS, SPRINGS
from tests.model.looped import CRANK, LOWER, ROD, UPPER

G = 9.81
LENGTH, HEIGHT = 5, 6  # places of the path's length and of the toe's height among the terms


class Leg:
    """Equations of motion of a leg whose toe may be held, as functions of numbers.

    Args:
        q: the coordinates; the first is the height of the motors.
        lagrangian: of the coordinates and their rates.
        toe: x and z of the toe.
        length: length of the spring's path.
    """

    def __init__(self, q, v, kinetic, potential, toe, length):
        D = sp.hessian(kinetic, v)
        Dv = D * sp.Matrix(v)
        bias = Dv.jacobian(q) * sp.Matrix(v) - sp.Matrix([sp.diff(kinetic - potential, each) for each in q])
        J = sp.Matrix(toe).jacobian(q)
        J = J if any(J[0, :]) else J[1:, :]
        drift = (J * sp.Matrix(v)).jacobian(q) * sp.Matrix(v)
        slope = sp.Matrix([length]).jacobian(q)
        self.terms = sp.lambdify([q, v], [D, bias, J, drift, slope, length, toe[1]], "numpy", cse=True)
        self.n = len(q)


@lru_cache
def leg(name):
    """The leg of this name, as `tests.model.looped` describes it."""
    if name == "crank_leg":
        (z, x), (w, u) = q, v = sp.symbols("z x"), sp.symbols("w u")
        y = -CRANK * sp.sin(x) + sp.sqrt(ROD**2 - (CRANK * sp.cos(x)) ** 2)
        pin, foot = (CRANK * sp.cos(x), z + CRANK * sp.sin(x)), (sp.Integer(0), z - y)
        rods, toe, rotors = [((sp.Integer(0), z), pin, 0.10), (pin, foot, 0.08)], foot, 0.002 * u**2 / 2
        kinetic, potential = 0.15 * moving(foot[1:], q, v), 0.15 * G * foot[1]
        length = 0.3 - y
    else:
        (z, a, b), (w, *rates) = q, v = sp.symbols("z a b"), sp.symbols("w u p")
        knees = [(UPPER * sp.sin(each), z - UPPER * sp.cos(each)) for each in (a, b)]
        across = [one - other for one, other in zip(*knees, strict=True)]
        half = sp.sqrt(across[0] ** 2 + across[1] ** 2) / 2
        down = sp.sqrt(LOWER**2 - half**2) / (2 * half)
        toe = (sum(x for x, _ in knees) / 2 + down * across[1], sum(y for _, y in knees) / 2 - down * across[0])
        rods = [((sp.Integer(0), z), knee, 0.06) for knee in knees] + [(knee, toe, 0.04) for knee in knees]
        rotors = sum(1.2e-4 * rate**2 / 2 for rate in rates)
        kinetic, potential, length = sp.Integer(0), sp.Integer(0), a - b
    kinetic += rotors + 2.0 * w**2 / 2
    potential += 2.0 * G * z
    for start, end, mass in rods:
        middle = [(one + other) / 2 for one, other in zip(start, end, strict=True)]
        along = [other - one for one, other in zip(start, end, strict=True)]
        # a slender rod's own turning is a twelfth of what its ends' difference moves
        kinetic += mass * (moving(middle, q, v) + moving(along, q, v) / 12)
        potential += mass * G * middle[1]
    return Leg(q, v, kinetic, potential, toe, length)


def moving(point, q, v):
    """Half the square of a point's velocity."""
    return sum((sp.Matrix([each]).jacobian(q) * sp.Matrix(v))[0] ** 2 for each in point) / 2


def hop(name, y, cycles, rtol=1e-11):
    """Returns the times of touchdown, and the last state, from a state (q, v) just after a touchdown."""
    own, law, spring = leg(name), LAWS[name], SPRINGS[name]
    signs = FOLDS[: own.n - 1]
    now, times = 0.0, []

    def acceleration(t, y, phase, rest, taut):
        q, v = y[: own.n], y[own.n :]
        D, bias, J, drift, slope, length, _ = own.terms(q, v)
        force, slope = -np.ravel(bias), np.ravel(slope)
        if phase == "flight":
            force[1:] += [
                law.gain * (s * law.landing - a) - law.damping * r for s, a, r in zip(signs, q[1:], v[1:], strict=True)
            ]
            return np.linalg.solve(D, force), 0.0
        force -= slope * (taut * spring.stiffness * (length - rest) + spring.damping * (slope @ v))
        if phase == "extension":
            force[1:] -= np.array(signs) * law.push * math.tanh(t / law.rise_time)
        m = len(J)
        found = np.linalg.solve(np.block([[D, -J.T], [J, np.zeros((m, m))]]), np.concatenate([force, -np.ravel(drift)]))
        return found[: own.n], found[-1]

    def run(y, phase, rest, taut, event, t=0.0):
        """Moves on to an event, a function of (t, y) that falls through zero."""
        event.terminal, event.direction = True, -1
        slope = lambda t, y: np.concatenate([y[own.n :], acceleration(t, y, phase, rest, taut)[0]])  # noqa: E731
        found = solve_ivp(slope, (t, 2.0), y, "DOP853", rtol=rtol, atol=1e-13, events=event)
        return found.t[-1], found.y[:, -1]

    def part(y, which):
        return float(own.terms(y[: own.n], y[own.n :])[which])

    def cycle(y, rest):
        """Moves on to just before the next touchdown; returns the time it takes, and the state."""
        down, y = run(y, "compression", rest, 1.0, lambda t, y: -y[own.n])
        t, y = run(y, "extension", rest, 1.0, lambda t, y: part(y, LENGTH) - rest)
        up, y = run(y, "extension", rest, 0.0, lambda t, y: acceleration(t, y, "extension", rest, 0.0)[1], t)
        aloft, y = run(y, "flight", rest, 0.0, lambda t, y: part(y, HEIGHT))
        return down + up + aloft, y

    for _ in range(cycles):
        period, y = cycle(y, part(y, LENGTH))
        now += period
        times.append(now)
        D, _, J, *_ = own.terms(y[: own.n], y[own.n :])
        response = np.linalg.solve(D, J.T)
        y[own.n :] -= response @ np.linalg.solve(J @ response, J @ y[own.n :])
    return np.array(times), y
