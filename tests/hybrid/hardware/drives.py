"""Motors, gears and batteries of the hop, and what its motions are compared by."""

from dataclasses import replace

import numpy as np

from spear_pin.hybrid.hardware import Sensing
from spear_pin.model.actuator import Actuator, Thermal
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Gearbox

MOTOR = motor("spear_ii_knee")
R, CONSTANT = MOTOR.resistance, 15.0 * MOTOR.torque_constant
HUGE = Battery(1e6)
IDEAL = Actuator(MOTOR, Gearbox(15.0), HUGE)
REAL = replace(IDEAL, battery=Battery(24.0))
NOISE = Sensing(angle_noise=2e-3, rate_noise=2e-2, cutoff=50.0)
LOSSES = Sensing(losses=5.0, loss_duration=0.02, seed=3)
LOSSY = replace(REAL, gearbox=Gearbox(15.0, 0.83), battery=Battery(24.0, 0.3))
SAME = 1e-8
CONFIGURATIONS = {
    "ideal": (IDEAL, None),
    "saturated": (replace(IDEAL, battery=Battery(12.0)), None),
    "gearbox": (replace(IDEAL, gearbox=Gearbox(15.0, 0.83)), None),
    "loop": (replace(REAL, bandwidth=200.0), None),
    "battery": (replace(REAL, battery=Battery(24.0, 0.3)), None),
    "stiff battery": (replace(IDEAL, battery=Battery(1e6, 0.3)), None),
    "thermal": (replace(REAL, current_limit=8.0, thermal=Thermal(3.0, 0.1)), None),
    "noise": (REAL, NOISE),
    "losses": (REAL, LOSSES),
    "all": (
        replace(LOSSY, current_limit=8.0, thermal=Thermal(4.0, 0.3), bandwidth=200.0),
        replace(NOISE, losses=5.0, loss_duration=0.02),
    ),
}


def landings(trajectory):
    """Time, configuration and velocity at each touchdown."""
    return np.array([[e.time, *e.q, *e.v_before, *e.v] for e in trajectory.named("touchdown")])


def apex(trajectory):
    return trajectory.named("apex")[0].q[-3]


def assert_same_motion(trajectory, expected):
    assert [e.name for e in trajectory.events] == [e.name for e in expected.events]
    for ours, theirs in zip(trajectory.events, expected.events, strict=True):
        np.testing.assert_allclose([ours.time, *ours.q, *ours.v], [theirs.time, *theirs.q, *theirs.v], atol=SAME)
    assert trajectory.ledger.flows == expected.ledger.flows
    np.testing.assert_allclose(trajectory.ledger.work, expected.ledger.work, atol=SAME)
    np.testing.assert_allclose(trajectory.ledger.change, expected.ledger.change, atol=SAME)


def total(trajectory, flow):
    """Energy of a flow of all joints, in J."""
    return sum(trajectory.electrical[f"{flow}_{joint}"].sum() for joint in trajectory.actuated)
