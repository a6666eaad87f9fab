"""A bound of Q-SPEAR, written out by hand: a second opinion on the closed loop.

Dynamics from the symbolic Lagrangian, SciPy's `solve_ivp` between events, every law, reset and guard
typed here again; torques and forces come from one linear system with the accelerations. Nothing is
shared with the package but the gait's numbers. It is meant for the neighbourhood of a gait whose
stances end with the knee back at its rest angle: feet stick, and land and lift in the nominal order.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from tests.lagrangian import quadruped

FINEST = {"method": "DOP853", "rtol": 1e-11, "atol": 1e-12}
POSTERIOR, ANTERIOR = 0, 1
HIPS, KNEES, SIDES = (3, 5), (4, 6), (1.0, -1.0)
X = np.eye(7)[0]


def leg_angle(leg):
    """Row of γ = pitch + hip - knee / 2."""
    row = np.zeros(7)
    row[2], row[HIPS[leg]], row[KNEES[leg]] = 1.0, 1.0, -0.5
    return row


def rows_of(leg):
    return [leg_angle(leg), np.eye(7)[KNEES[leg]]]


def de_casteljau(coefficients, s):
    """Value and first two derivatives of a Bézier polynomial."""
    n, points = len(coefficients) - 1, np.array(coefficients, float)
    stages = [points]
    while len(stages[-1]) > 1:
        stages.append((1.0 - s) * stages[-1][:-1] + s * stages[-1][1:])
    (a, b, c), (left, right) = stages[-3], stages[-2]
    return stages[-1][0], n * (right - left), n * (n - 1) * (c - 2.0 * b + a)


@dataclass(frozen=True)
class Swing:
    """What the swinging legs shall do: coefficients for each row, along c q from `origin` on."""

    rows: list
    coefficients: list
    along: np.ndarray
    origin: float
    span: float

    @classmethod
    def beginning(cls, rows, ends, along, span, q, v):
        """With outputs and their rates zero at (q, v)."""
        coefficients = []
        for row, end in zip(rows, ends, strict=True):
            slope = (row @ v) / (along @ v) * span  # of the output in s
            coefficients.append([row @ q, row @ q + slope / (len(end) + 1), *end])
        return cls(rows, coefficients, along, along @ q, span)

    def wanted(self, q, v, epsilon):
        """Rows and right-hand sides that v̇ has to satisfy for ÿ + 2 ẏ/ε + y/ε² = 0."""
        s, rate = (self.along @ q - self.origin) / self.span, self.along @ v / self.span
        left, right = [], []
        for row, coefficients in zip(self.rows, self.coefficients, strict=True):
            value, slope, curvature = de_casteljau(coefficients, min(s, 1.0))
            if s > 1.0:
                value, curvature = value + slope * (s - 1.0), 0.0
            y, dy = row @ q - value, row @ v - slope * rate
            left.append(row - slope * self.along / self.span)
            right.append(curvature * rate**2 - 2.0 * dy / epsilon - y / epsilon**2)
        return np.array(left), np.array(right)


@dataclass(frozen=True)
class Bounder:
    """The closed loop with the parameters of a law."""

    law: object

    def stride(self, state):
        """From a state (q, v) just after anterior touchdown to just after the next one."""
        state = self.fly(*self.stand(ANTERIOR, *state), ANTERIOR)
        return self.fly(*self.stand(POSTERIOR, *state), POSTERIOR)

    def stand(self, leg, q, v):
        """To lift-off."""
        name = ("posterior", "anterior")[leg]
        hip = getattr(self.law, f"{name}_hip_torque")
        hip += self.law.speed_gain[leg] * (v[0] - self.law.speed_nominal[leg])
        push = getattr(self.law, f"{name}_knee_torque")
        ends = getattr(self.law, f"{name}_stance_swing")
        span = getattr(self.law, f"{name}_stance_span")
        swing = Swing.beginning(rows_of(1 - leg), ends, leg_angle(leg), span, q, v)
        motors = [HIPS[1 - leg], KNEES[1 - leg]]

        def acceleration(q, v):
            torques = np.zeros(7)
            flexed = SIDES[leg] * q[KNEES[leg]] - self.law.knee_rest
            torques[HIPS[leg]] = hip
            torques[KNEES[leg]] = -SIDES[leg] * (push + self.law.virtual_stiffness * flexed)
            return self.solve(q, v, torques, swing, motors, leg)

        def knee(t, y):
            return SIDES[leg] * y[KNEES[leg]] - self.law.knee_rest

        return advance(acceleration, q, v, knee)

    def fly(self, q, v, lifted):
        """To just after the other leg's touchdown, where its toe sticks."""
        number, landing = (1, 2)[lifted], 1 - lifted
        name = ("posterior", "anterior")[landing]
        target = getattr(self.law, f"{name}_leg_touchdown")
        angle, knee = getattr(self.law, f"flight_{number}_landing")
        bent = SIDES[landing] * self.law.knee_touchdown
        ends = [[angle, target, target, target], [knee, bent, bent, bent]]
        ends = [*getattr(self.law, f"flight_{number}_trailing"), *ends]
        span = getattr(self.law, f"flight_{number}_span")
        swing = Swing.beginning([*rows_of(lifted), *rows_of(landing)], ends, X, span, q, v)
        motors = [HIPS[lifted], KNEES[lifted], HIPS[landing], KNEES[landing]]

        def height(t, y):
            gamma = y[2] + y[HIPS[landing]]
            ahead = (-0.35, 0.35)[landing] * np.sin(y[2])
            return y[1] + ahead - 0.318 * np.cos(gamma) - 0.318 * np.cos(gamma - y[KNEES[landing]])

        q, v = advance(lambda q, v: self.solve(q, v, np.zeros(7), swing, motors), q, v, height)
        D, _, J, _ = terms(q, v, landing)
        impulse = -np.linalg.solve(J @ np.linalg.solve(D, J.T), J @ v)
        assert impulse[1] > 0.0 and abs(impulse[0]) < 0.8 * impulse[1], "the toe slides at touchdown"
        return q, v + np.linalg.solve(D, J.T @ impulse)

    def solve(self, q, v, torques, swing, motors, standing=None):
        """Accelerations, the swinging legs' torques and the ground's force, all at once."""
        D, bias, J, drift = terms(q, v, standing)
        left, right = swing.wanted(q, v, self.law.epsilon)
        B = np.eye(7)[:, motors]
        zero = np.zeros((len(J) + len(left), B.shape[1] + len(J)))
        matrix = np.block([[D, -B, -J.T], [np.vstack([J, left]), zero]])
        return np.linalg.solve(matrix, np.concatenate([torques - bias, -drift, right]))[:7]


def terms(q, v, leg=None):
    """D, C v + G, and J and J̇v of a toe (none in the air)."""
    D, coriolis, gravity, _, _, jacobians, drifts = quadruped().evaluate(*q.tolist(), *v.tolist())
    chosen = slice(0, 0) if leg is None else slice(2 * leg, 2 * leg + 2)
    return np.array(D), np.ravel(coriolis) + np.ravel(gravity), np.array(jacobians)[chosen], np.ravel(drifts)[chosen]


def advance(acceleration, q, v, guard):
    """To the guard's fall through zero."""
    guard.terminal, guard.direction = True, -1.0

    def derivative(t, y):
        return np.concatenate([y[7:], acceleration(y[:7], y[7:])])

    result = solve_ivp(derivative, (0.0, 1.0), np.concatenate([q, v]), events=guard, **FINEST)
    assert result.status == 1, "the phase does not end"
    (y,) = result.y_events[0]
    return y[:7], y[7:]
