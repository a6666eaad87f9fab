"""The hop of SPEAR-II with boom_x locked, written out by hand: a second opinion on the closed loop.

Dynamics from the symbolic Lagrangian, SciPy's `solve_ivp` between events, every law, reset and
guard typed here again. Nothing is shared with the package. It is meant for the neighbourhood of the
nominal gait: a motion that does not stick, slip and fly in this order is refused.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from tests.lagrangian import monopod

FINEST = {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}


def terms(y):
    """D, C v + G, J and J̇v at a state (z, hip, knee, and their rates)."""
    mass_matrix, coriolis, gravity, _, _, jacobian, drift = monopod(("boom_z", "hip", "knee")).evaluate(*y)
    return np.array(mass_matrix), np.ravel(coriolis) + np.ravel(gravity), np.array(jacobian), np.ravel(drift)


@dataclass(frozen=True)
class Hopper:
    """The closed loop.

    Attributes:
        torque: of the square wave, in N·m.
    """

    torque: float
    hip: float = 0.5
    knee: float = 1.0
    frequency: float = 2.56
    friction: float = 0.8

    def hop(self, y):
        """From just after touchdown to just after the next one."""
        return self.to_touchdown(self.to_apex(self.to_lift_off(y)))

    def from_apex_to_apex(self, y):
        return self.to_apex(self.to_lift_off(self.to_touchdown(y)))

    def to_lift_off(self, y):
        latched = y[2]

        def extending(t, y):
            return self.sticking(y, latched, -1.0)[0]

        def margin(side):
            def value(t, y):
                tangential, normal = self.sticking(y, latched, -1.0)[1]
                return self.friction * normal + side * tangential

            return value

        half_period = 0.5 / self.frequency
        y = advance(lambda t, y: self.sticking(y, latched, 1.0)[0], y, half_period)
        y, edge = advance_to_first(extending, y, half_period, [margin(1.0), margin(-1.0)])
        side = (1.0, -1.0)[edge]  # pushed back by the ground it slides forward, and the other way round
        return advance_to_first(
            lambda t, y: self.slipping(y, latched, -1.0, side)[0],
            y,
            half_period,
            [lambda t, y: self.slipping(y, latched, -1.0, side)[1][1]],
        )[0]

    def to_apex(self, y):
        return advance_to_first(self.flying, y, 1.0, [lambda t, y: y[3]])[0]

    def to_touchdown(self, y):
        """To just after touchdown, where the toe sticks."""
        y, _ = advance_to_first(
            self.flying, y, 1.0, [lambda t, y: y[0] - 0.318 * np.cos(y[1]) - 0.318 * np.cos(y[1] - y[2])]
        )
        D, _, J, _ = terms(y)
        impulse = -np.linalg.solve(J @ np.linalg.solve(D, J.T), J @ y[3:])
        assert impulse[1] > 0 and abs(impulse[0]) < self.friction * impulse[1], "the toe slides at touchdown"
        return np.concatenate([y[:3], y[3:] + np.linalg.solve(D, J.T @ impulse)])

    def sticking(self, y, latched, sign):
        """Acceleration and ground force with the toe at rest."""
        D, bias, J, drift = terms(y)
        matrix = np.block([[D, -J.T], [J, np.zeros((2, 2))]])
        solution = np.linalg.solve(matrix, np.concatenate([self.pushing(y, latched, sign) - bias, -drift]))
        return solution[:3], solution[3:]

    def slipping(self, y, latched, sign, side):
        """Acceleration and ground force with the toe sliding to one side."""
        D, bias, J, drift = terms(y)
        direction = J[1] - side * self.friction * J[0]
        matrix = np.block([[D, -direction[:, None]], [J[1], np.zeros(1)]])
        solution = np.linalg.solve(matrix, np.append(self.pushing(y, latched, sign) - bias, -drift[1]))
        return solution[:3], np.array([-side * self.friction, 1.0]) * solution[3]

    def pushing(self, y, latched, sign):
        """Motor, spring and damper in stance."""
        return np.array([0.0, 0.0, sign * self.torque - 48.84 * max(0.0, y[2] - latched) - 1.3 * y[5]])

    def flying(self, t, y):
        """Acceleration in the air."""
        D, bias, _, _ = terms(y)
        motors = np.array([0.0, 54.77 * (self.hip - y[1]) - 1.37 * y[4], 63.25 * (self.knee - y[2]) - 0.52 * y[5]])
        return np.linalg.solve(D, motors - bias)


def advance(acceleration, y, duration):
    return solve_ivp(lambda t, y: [*y[3:], *acceleration(t, y)], (0.0, duration), y, **FINEST).y[:, -1]


def advance_to_first(acceleration, y, longest, guards):
    """To the first fall of a guard through zero, and which guard it is."""
    for guard in guards:
        guard.terminal, guard.direction = True, -1.0
    result = solve_ivp(lambda t, y: [*y[3:], *acceleration(t, y)], (0.0, longest), y, events=guards, **FINEST)
    assert result.status == 1, "the phase does not end"
    which = next(i for i, times in enumerate(result.t_events) if len(times))
    return result.y_events[which][0], which
