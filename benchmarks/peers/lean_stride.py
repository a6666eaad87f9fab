"""The yardstick of the bound: `solve_ivp` on lean right-hand sides with Pinocchio, law and order of phases built in.

Posterior stance, flight, anterior stance, flight, touchdown. The virtual knee spring hides the physical one, which is
left out; the polynomials are in powers of s; what the torques of the swing legs need is one solve of the dynamics for
all motors. Sliding and a foot too early are looked for, and refused.
"""

from __future__ import annotations

from math import comb

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from benchmarks.peers.task import STATES, Lane, Task
from spear_pin.arrays import Array

ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED
RTOLS = (1e-9,)
POWERS = np.array([[(-1) ** (k - i) * comb(5, k) * comb(k, i) if i <= k else 0 for i in range(6)] for k in range(6)])
HIPS, KNEES, SIDES = (3, 5), (4, 6), (1.0, -1.0)


def rows(leg: int) -> Array:
    """γ = pitch + hip - knee / 2 and the knee, as rows over the coordinates."""
    angles = np.zeros((2, 7))
    angles[0, [2, HIPS[leg], KNEES[leg]]] = 1.0, 1.0, -0.5
    angles[1, KNEES[leg]] = 1.0
    return angles


class Strider:
    """One stride from a state to the next."""

    def __init__(self, task: Task, rtol: float) -> None:
        system = task.gait.system
        self.model, self.law, self.rtol = system.robot.model, system.law, rtol
        self.data = self.model.createData()
        self.toes = [self.model.getFrameId(f"{name}_toe") for name in ("posterior", "anterior")]
        self.friction = system.contact.friction
        self.zero = np.zeros(7)
        self.single, self.pair = np.zeros((7, 5)), np.zeros((9, 5))
        self.single[3:, 1:] = self.pair[3:7, 1:] = np.eye(4)
        self.closed = np.zeros((9, 9))

    def begin(self, H: Array, c: Array, shapes: Array, q: Array, v: Array, span: float) -> None:
        """Constraints that begin with y = ẏ = 0."""
        rate = c @ v / span
        alpha = np.column_stack([H @ q, H @ q + H @ v / rate / 5.0, shapes])
        value = alpha @ POWERS.T
        slope, curvature = np.zeros_like(value), np.zeros_like(value)
        slope[:, :5] = value[:, 1:] * np.arange(1.0, 6.0)
        curvature[:, :4] = slope[:, 1:5] * np.arange(1.0, 5.0)
        self.curves = np.concatenate([value, slope, curvature])
        self.H, self.c, self.span, self.origin, self.past = H, c, span, c @ q, False

    def progress(self, t: float, y: Array) -> float:
        return 1.0 - (self.c @ y[:7] - self.origin) / self.span

    def swing(self, q: Array, v: Array, free: Array, gains: Array) -> Array:
        """Torques that keep the outputs at zero."""
        s, rate, n = (self.c @ q - self.origin) / self.span, self.c @ v / self.span, len(self.H)
        inside = 1.0 if self.past else s
        h, slope, curvature = (self.curves @ inside ** np.arange(6.0)).reshape(3, n)
        if self.past:
            h, curvature = h + slope * (s - 1.0), 0.0 * curvature
        y, dy = self.H @ q - h, self.H @ v - slope * rate
        gradient = self.H - np.outer(slope / self.span, self.c)
        epsilon = self.law.epsilon
        wanted = curvature * rate * rate - y / epsilon**2 - 2.0 * dy / epsilon - gradient @ free
        return np.linalg.solve(gradient @ gains, wanted)

    def fly(self, t: float, y: Array) -> Array:
        q, v = y[:7], y[7:]
        pin.crba(self.model, self.data, q)
        self.single[:, 0] = -pin.rnea(self.model, self.data, q, v, self.zero)
        mass_matrix = self.data.M
        response = np.linalg.solve(np.triu(mass_matrix) + np.triu(mass_matrix, 1).T, self.single)
        free, gains = response[:, 0], response[:, 1:]
        return np.concatenate([v, free + gains @ self.swing(q, v, free, gains)])

    def stand(self, y: Array) -> Array:
        """Acceleration and ground force."""
        q, v = y[:7], y[7:]
        model, data, leg = self.model, self.data, self.leg
        pin.computeAllTerms(model, data, q, v)
        pin.forwardKinematics(model, data, q, v, self.zero)
        J = pin.getFrameJacobian(model, data, self.toes[leg], ALIGNED)[0:3:2]
        drift = pin.getFrameClassicalAcceleration(model, data, self.toes[leg], ALIGNED).linear[0:3:2]
        self.closed[:7, :7], self.closed[:7, 7:], self.closed[7:, :7] = data.M, -J.T, J
        self.pair[:7, 0], self.pair[7:, 0] = -data.nle, -drift
        response = np.linalg.solve(self.closed, self.pair)
        flexed = SIDES[leg] * q[KNEES[leg]] - self.law.knee_rest
        own, other = slice(2 * leg, 2 * leg + 2), slice(2 - 2 * leg, 4 - 2 * leg)
        u = np.zeros(4)
        u[own] = self.hip, -SIDES[leg] * (self.knee + self.law.virtual_stiffness * flexed)
        both, gains = response[:, 0] + response[:, 1:] @ u, response[:7, 1:]
        u[other] = self.swing(q, v, both[:7], gains[:, other])
        return both + response[:, 1 + other.start : 1 + other.stop] @ u[other]

    def support(self, t: float, y: Array) -> Array:
        return np.concatenate([y[7:], self.stand(y)[:7]])

    def cone(self, t: float, y: Array) -> float:
        tangential, normal = self.stand(y)[7:]
        return self.friction * normal - abs(tangential)

    def height(self, leg: int, y: Array) -> float:
        pin.forwardKinematics(self.model, self.data, y[:7])
        return pin.updateFramePlacement(self.model, self.data, self.toes[leg]).translation[2]

    def advance(self, motion, y: Array, guards) -> Array:
        """To the fall of the first guard; s may pass 1 on the way, and nothing else may happen."""
        t, watched = 0.0, [self.progress, *guards]
        while True:
            events = [falling(guard) for guard in watched]
            tolerances = {"rtol": self.rtol, "atol": 0.01 * self.rtol}
            result = solve_ivp(motion, (t, 2.0), y, method="DOP853", events=events, **tolerances)
            t, y = result.t[-1], result.y[:, -1]
            happened = watched[next(i for i, times in enumerate(result.t_events) if len(times))]
            if happened is guards[0]:
                return y
            assert happened == self.progress, "the order of phases is another"
            self.past, watched = True, list(guards)

    def stance(self, leg: int, y: Array) -> Array:
        law, name = self.law, ("posterior", "anterior")[leg]
        self.leg, self.hip, self.knee = leg, getattr(law, f"{name}_hip_torque"), getattr(law, f"{name}_knee_torque")
        shapes, span = getattr(law, f"{name}_stance_swing"), getattr(law, f"{name}_stance_span")
        self.begin(rows(1 - leg), rows(leg)[0], np.array(shapes), y[:7], y[7:], span)

        def returned(t: float, y: Array) -> float:
            return SIDES[leg] * y[KNEES[leg]] - law.knee_rest

        y = self.advance(self.support, y, [returned, self.cone, lambda t, y: self.height(1 - leg, y)])
        return self.flight(leg, y)

    def flight(self, lifted: int, y: Array) -> Array:
        law, number, landing = self.law, lifted + 1, 1 - lifted
        angle, knee = getattr(law, f"flight_{number}_landing")
        target = getattr(law, f"{('posterior', 'anterior')[landing]}_leg_touchdown")
        comes = [[angle, *3 * [target]], [knee, *3 * [SIDES[landing] * law.knee_touchdown]]]
        trails = [list(shape) for shape in getattr(law, f"flight_{number}_trailing")]
        shapes = np.array([*trails, *comes] if lifted == 0 else [*comes, *trails])
        c = np.eye(7)[0]
        self.begin(np.concatenate([rows(0), rows(1)]), c, shapes, y[:7], y[7:], getattr(law, f"flight_{number}_span"))
        y = self.advance(self.fly, y, [lambda t, y: self.height(landing, y)])
        mass_matrix = np.triu(pin.crba(self.model, self.data, y[:7]))
        mass_matrix += np.triu(mass_matrix, 1).T
        J = pin.computeFrameJacobian(self.model, self.data, y[:7], self.toes[landing], ALIGNED)[0:3:2]
        response = np.linalg.solve(mass_matrix, J.T)
        return np.concatenate([y[:7], y[7:] - response @ np.linalg.solve(J @ response, J @ y[7:])])

    def stride(self, y: Array) -> Array:
        return self.stance(1, self.stance(0, y))


def falling(guard):
    def event(t: float, y: Array) -> float:
        return guard(t, y)

    event.terminal, event.direction = True, -1.0
    return event


def lanes(task: Task) -> list[Lane]:
    """One for each tolerance."""
    starts = np.concatenate([task.q, task.v], axis=1)[:STATES]

    def lane(rtol: float) -> Lane:
        strider = Strider(task, rtol)
        name = "the lean loop, SciPy and Pinocchio"
        return Lane(name, f"DOP853, rtol {rtol:.0e}", lambda: np.array([strider.stride(y) for y in starts]))

    return [lane(rtol) for rtol in RTOLS]
