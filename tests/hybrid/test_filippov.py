"""Motion on the switching surface: its constraints, its energy, and the fast switching it is the limit of."""

import numpy as np
import pinocchio as pin
import pytest
from scipy.integrate import solve_ivp

from spear_pin import HoppingLaw, hopping, load, simulate
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.hybrid.run import run

KNEE, TORQUE = 1.2, 8.0


@pytest.fixture(scope="module")
def system():
    """A hop whose stance outlasts 1/f: the motor flexes again, and the flight law presses the toe down."""
    return hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(knee_touchdown=KNEE, stance_torque=TORQUE))


@pytest.fixture(scope="module")
def settled(system):
    return run(system, system.guess(), 20, Options(1e-8)).state


@pytest.fixture(scope="module")
def trajectory(system, settled):
    return simulate(system, settled, 3, rtol=1e-10, progress=False)


def test_toe_stays_on_the_ground_without_force(system, trajectory):
    rows = np.flatnonzero(trajectory.domain == CHATTER)
    assert len(rows) >= 6 and trajectory.cycles == 3
    for i in rows:
        q, v, a = trajectory.q[i], trajectory.v[i], trajectory.a[i]
        jacobian, drift = system.robot.toe_jacobian(q, "toe"), system.robot.toe_drift(q, v, "toe")
        assert abs(system.robot.toe_position(q, "toe")[1]) < 1e-8
        assert abs(jacobian[1] @ v) < 1e-7
        assert abs(jacobian[1] @ a + drift[1]) < 1e-8
    assert not trajectory.force[rows].any() and not trajectory.engaged[rows].any()


def test_it_belongs_to_flight_and_ends_in_flight(trajectory):
    rows = trajectory.domain == CHATTER
    assert set(trajectory.phase[rows]) == {"flight"}
    ends = [event for event in trajectory.events if event.domain == CHATTER]
    assert [event.name for event in ends] == ["lift_off"] * 3
    assert len(trajectory.named("touchdown")) == 3, "a touch without time passing closes no cycle"


def test_ledger_closes(trajectory):
    assert np.abs(trajectory.ledger.residual).max() < 1e-8


def test_motor_torque_lies_between_the_two_laws(trajectory):
    law = HoppingLaw(knee_touchdown=KNEE, stance_torque=TORQUE)
    for i in np.flatnonzero(trajectory.domain == CHATTER)[:-1]:
        hip, knee = trajectory.q[i][1:]
        flight = law.hip_gain * (KNEE / 2 - hip) - law.hip_damping * trajectory.v[i][1]
        share = 1.0 - trajectory.u[i][0] / flight  # the stance law gives the hip no torque
        assert 0.0 < share < 1.0
        flight = law.knee_gain * (KNEE - knee) - law.knee_damping * trajectory.v[i][2]
        assert trajectory.u[i][1] == pytest.approx(share * TORQUE + (1.0 - share) * flight, abs=1e-9)


def test_it_is_the_limit_of_a_steep_blend(system, trajectory):
    """Laws blended continuously over a layer of toe speeds follow the same motion as the layer gets thin."""
    rows = np.flatnonzero((trajectory.domain == CHATTER) & (trajectory.cycle == 1))
    start, end = rows[0], rows[-1]
    duration = trajectory.t[end] - trajectory.t[start]
    errors = []
    for layer in (1e-3, 1e-4, 1e-5):
        q, v = blended(system, trajectory.q[start], trajectory.v[start], duration, layer)
        errors.append(max(np.abs(q - trajectory.q[end]).max(), np.abs(v - trajectory.v[end]).max()))
    assert errors[2] < 1e-4
    assert errors[1] == pytest.approx(errors[0] / 10, rel=0.2) and errors[2] == pytest.approx(errors[1] / 10, rel=0.2)


def blended(system, q, v, duration, layer):
    """Plain integration in free air, the stance law's share falling from 1 to 0 as the toe's speed goes ±layer."""
    model, law, spring = system.robot.model, system.law, system.spring
    data, toe = model.createData(), model.getFrameId("toe")

    def slope(t, y):
        q, v = y[:3], y[3:]
        pin.forwardKinematics(model, data, q, v)
        rise = pin.getFrameVelocity(model, data, toe, pin.LOCAL_WORLD_ALIGNED).linear[2]
        share = np.clip(0.5 - 0.5 * rise / layer, 0.0, 1.0)
        hip = law.hip_gain * (law.knee_touchdown / 2 - q[1]) - law.hip_damping * v[1]
        knee = law.knee_gain * (law.knee_touchdown - q[2]) - law.knee_damping * v[2]
        stance = law.stance_torque - spring.damping * v[2]
        tau = np.array([0.0, (1.0 - share) * hip, share * stance + (1.0 - share) * knee])
        return np.concatenate([v, pin.aba(model, data, q, v, tau)])

    step = solve_ivp(slope, (0.0, duration), np.concatenate([q, v]), method="Radau", rtol=1e-9, atol=1e-11)
    return step.y[:3, -1], step.y[3:, -1]
