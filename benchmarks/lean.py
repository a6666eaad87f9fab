"""A lean hop: bare `solve_ivp` on hand-written closed-loop right-hand sides, as one writes it for a single robot.

The yardstick for what the package's generality and its energy ledger cost. It integrates (q, v) only,
and knows one robot, one law and one order of events: stance to the torque switch, stance to slip,
slip to lift-off, flight to touchdown, impact.
"""

from __future__ import annotations

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from spear_pin.gaits.gait import Gait

ALIGNED = pin.ReferenceFrame.LOCAL_WORLD_ALIGNED


def lean_hop(gait: Gait, rtol: float):
    """A function of no arguments that runs one hop from the gait's state and returns the next (q, v)."""
    robot, law, spring = gait.system.robot, gait.system.law, gait.system.spring
    model, data, toe = robot.model, robot.model.createData(), robot.model.getFrameId("toe")
    friction = gait.system.contact.friction
    zero, tau = np.zeros(3), np.zeros(3)
    knee_touchdown, sign = 0.0, 1.0
    hip_desired = 0.5 * law.knee_touchdown if law.hip_touchdown is None else law.hip_touchdown
    atol = 0.01 * rtol

    def contact(q, v):
        pin.computeAllTerms(model, data, q, v)
        pin.forwardKinematics(model, data, q, v, zero)
        jacobian = pin.getFrameJacobian(model, data, toe, ALIGNED)[0:3:2]
        drift = pin.getFrameClassicalAcceleration(model, data, toe, ALIGNED).linear[0:3:2]
        deflection = q[2] - knee_touchdown
        tau[1] = law.hip_stance_torque
        tau[2] = sign * law.stance_torque - spring.damping * v[2]
        if deflection > 0.0:
            tau[2] -= spring.stiffness * deflection
        return jacobian, drift

    def stick(t, y):
        q, v = y[:3], y[3:]
        jacobian, drift = contact(q, v)
        out = np.empty(6)
        out[:3], out[3:] = v, pin.forwardDynamics(model, data, tau, jacobian, drift)
        return out

    def slip(t, y, side):
        q, v = y[:3], y[3:]
        jacobian, drift = contact(q, v)
        push = jacobian[1] - friction * side * jacobian[0]
        both = np.linalg.solve(data.M, np.array([tau - data.nle, push]).T)
        normal = -(drift[1] + jacobian[1] @ both[:, 0]) / (jacobian[1] @ both[:, 1])
        out = np.empty(6)
        out[:3], out[3:] = v, both[:, 0] + normal * both[:, 1]
        return out, normal

    def flight(t, y):
        q, v = y[:3], y[3:]
        tau[1] = law.hip_gain * (hip_desired - q[1]) - law.hip_damping * v[1]
        tau[2] = law.knee_gain * (law.knee_touchdown - q[2]) - law.knee_damping * v[2]
        out = np.empty(6)
        out[:3], out[3:] = v, pin.aba(model, data, q, v, tau)
        return out

    def cone(t, y, side):
        stick(t, y)
        tangential, normal = data.lambda_c
        return friction * normal + side * tangential

    def height(t, y):
        pin.forwardKinematics(model, data, y[:3])
        return pin.updateFramePlacement(model, data, toe).translation[2]

    def event(function, direction=-1.0):
        function.terminal, function.direction = True, direction
        return function

    guards = [event(lambda t, y: cone(t, y, 1.0)), event(lambda t, y: cone(t, y, -1.0))]
    lift_off = [event(lambda t, y: slip(t, y, 1.0)[1]), event(lambda t, y: slip(t, y, -1.0)[1])]
    touchdown = event(height)

    def integrate(function, begin, end, y, events):
        return solve_ivp(function, (begin, end), y, method="DOP853", rtol=rtol, atol=atol, events=events)

    def hop():
        nonlocal knee_touchdown, sign
        y = np.concatenate(gait.state)
        knee_touchdown, sign, half = y[2], 1.0, 0.5 / law.frequency
        y = integrate(stick, 0.0, half, y, guards).y[:, -1]
        sign = -1.0
        result = integrate(stick, half, 2.0 * half, y, guards)
        which = 0 if len(result.t_events[0]) else 1
        side, y = (1.0, -1.0)[which], result.y[:, -1]
        result = integrate(lambda t, y: slip(t, y, side)[0], result.t[-1], 2.0 * half, y, lift_off[which])
        # the toe leaves the ground from zero height: start looking for touchdown at the apex
        y = integrate(flight, 0.0, 5.0, result.y[:, -1], event(lambda t, y: y[3])).y[:, -1]
        y = integrate(flight, 0.0, 5.0, y, touchdown).y[:, -1]
        q, v = y[:3], y[3:]
        mass_matrix = pin.crba(model, data, q)
        jacobian = pin.computeFrameJacobian(model, data, q, toe, ALIGNED)[0:3:2]
        response = np.linalg.solve(mass_matrix, jacobian.T)
        return q, v - response @ np.linalg.solve(jacobian @ response, jacobian @ v)

    return hop
