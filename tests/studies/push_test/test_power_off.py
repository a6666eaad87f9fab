"""The power-off experiment: a motor without command, by its bridge."""

import numpy as np
import pytest

from spear_pin.model.bridge import STATES, Battery, Bridge, idle_current
from spear_pin.model.catalogue import motor
from spear_pin.studies.push_test import WITH_MOTOR, PassiveKnee, find_pushed_angle, release, spear_ii
from spear_pin.studies.push_test.motion import move
from spear_pin.studies.push_test.power_off import add_braking, power_off

MOTOR = motor("spear_ii_knee")
CONSTANT = 15.0 * MOTOR.torque_constant


@pytest.fixture(scope="module")
def cases():
    return {row.label: row for row in power_off(static_rest=True)}


@pytest.mark.parametrize("state", STATES)
def test_braking_torque_is_that_of_the_current(state):
    """N kt i, at rates on both sides of the threshold."""
    battery, bridge = Battery(24.0, 0.1), Bridge(0.7)
    knee = add_braking(PassiveKnee(), state, MOTOR, 15.0, battery, bridge)
    rates = np.linspace(-40, 40, 81)
    current = idle_current(state, CONSTANT * rates, MOTOR.resistance, battery, bridge)
    np.testing.assert_allclose(knee.braking_torque(rates), CONSTANT * current, rtol=1e-12, atol=1e-12)


def test_supply_on_or_off_makes_no_difference(cases):
    """The back-EMF stays far below the battery: what Fig. 4.7 shows."""
    on = cases["motor, supply on"]
    assert on.apart == 0.0
    assert on.peak_emf == pytest.approx(10.0, abs=0.1) and on.threshold == pytest.approx(25.4)


def test_the_others_differ(cases):
    assert 0.01 < cases["belt taken off"].apart < 0.02
    assert cases["motor, phases shorted"].apart > 0.03
    assert cases["motor, supply off"].apart == 0.0


def test_shorted_is_viscous_damping(cases):
    leg, shorted = spear_ii(), add_braking(WITH_MOTOR, "short", MOTOR, 15.0, Battery(), Bridge())
    viscous = PassiveKnee(WITH_MOTOR.stiffness, WITH_MOTOR.damping + CONSTANT**2 / MOTOR.resistance, 0.0, 1.0)
    np.testing.assert_allclose(release(leg, shorted).angle, release(leg, viscous).angle, atol=1e-9)


def test_a_small_battery_is_charged():
    """With a battery of 4 V the diodes conduct at the fastest, and the swing is braked a little."""
    rows = {row.label: row for row in power_off(static_rest=True, battery=Battery(4.0))}
    on, off = rows["motor, supply on"], rows["motor, supply off"]
    assert on.peak_emf > on.threshold and on.apart > 1e-4
    assert np.abs(on.release.rate).max() < np.abs(off.release.rate).max()


def test_energy_of_a_charging_motor():
    """What the swing loses to the motor is the braking torque's work."""
    leg = spear_ii()
    knee = add_braking(PassiveKnee(zero=0.8), "coast", MOTOR, 15.0, Battery(3.0), Bridge())
    t = np.linspace(0, 1.0, 20_001)
    motion = move(leg, knee, find_pushed_angle(leg, knee, 0.1), t)
    kinetic = 0.5 * leg.effective_inertia(motion.angle) * motion.rate**2
    spring = 0.5 * knee.stiffness * (motion.angle - knee.zero) ** 2
    weight = np.array([leg.robot.potential_energy(q) for q in leg.configuration(motion.angle[[0, -1]]).T])
    change = (kinetic + spring)[-1] - (kinetic + spring)[0] + weight[1] - weight[0]
    power = knee.braking_torque(motion.rate) * motion.rate - knee.damping * motion.rate**2
    assert change == pytest.approx(np.trapezoid(power, t), abs=1e-6)


def test_sensitivities_beyond_the_threshold():
    leg, t, step = spear_ii(), np.linspace(0.01, 1, 100), 1e-6
    knee = add_braking(PassiveKnee(zero=0.8), "coast", MOTOR, 15.0, Battery(3.0), Bridge())
    exact = move(leg, knee, 1.5, t, ("initial_angle",)).sensitivity[:, 0]
    low, high = (move(leg, knee, 1.5 + side * step, t).angle for side in (-1, 1))
    np.testing.assert_allclose(exact, (high - low) / (2 * step), atol=2e-5)  # the slope jumps at the threshold
