"""The hopping experiment on hardware: what drives the joints, seeded runs, and friction of the slider."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import HoppingLaw, Spring, find_gait, hopping, load, simulate, vary
from spear_pin.errors import BadValue
from spear_pin.hybrid.hardware import Sensing
from spear_pin.model.bridge import Battery
from spear_pin.studies.hardware import Outcome, Rig, on_rig, outcome, reasons

ROUGH = Rig(hip_efficiency=1.0, knee_efficiency=1.0, sensing=Sensing(0.005, 0.2, losses=5.0))


@pytest.fixture(scope="module")
def gait(hop):
    return hop


def test_rig_is_the_sources():
    """Ratios, K_v and the battery; hip first."""
    hip, knee = Rig().on(load("spear_ii")).actuators
    assert (hip.gearbox.ratio, knee.gearbox.ratio) == (60.0, 15.0)
    assert knee.motor.torque_constant == 0.115 and hip.battery == knee.battery == Battery(24.0)


def test_a_motor_at_another_joint_is_refused():
    with pytest.raises(BadValue, match="left_hip.*Actuator"):
        Rig().on(load("biped"))


def test_one_ratio_for_all():
    """Changed in the robot it changes the reflected inertia and the actuator, so the envelope too."""
    robot = vary(load("spear_ii"), knee_ratio=30.0)
    assert Rig().on(robot).actuators[1].constant == pytest.approx(30 * 0.115)
    assert robot.mass_matrix([0, 0, 0.5, 1])[3, 3] - load("spear_ii").mass_matrix([0, 0, 0.5, 1])[
        3, 3
    ] == pytest.approx(3 * 0.027)


def test_ideal_rig_changes_nothing(gait):
    ideal = replace(ROUGH, sensing=None, current_limit=1e6, battery=Battery(1e5))
    clean, driven = simulate(gait.system, gait.state, 2), on_rig(gait, ideal, 2)
    np.testing.assert_allclose(driven.q[-1], clean.q[-1], atol=1e-8)


def test_gears_lower_the_hop(gait):
    lossy = on_rig(gait, Rig(), 2)
    assert lossy.named("apex")[-1].q[0] < 0.60 < simulate(gait.system, gait.state).named("apex")[0].q[0]


@pytest.mark.slow
def test_a_seed_is_a_run(gait):
    first, again, other = (outcome(gait, ROUGH, seed, 2) for seed in (3, 3, 4))
    assert first == again and first.apexes != other.apexes
    assert (first.seed, first.hops, first.reason) == (3, 2, "complete")


def test_reasons():
    runs = [
        Outcome(i, 0, reason, "", ()) for i, reason in enumerate(("fall", "complete", "complete", "zeno", "complete"))
    ]
    assert reasons(runs) == {"complete": 3, "fall": 1, "zeno": 1} and list(reasons(runs))[0] == "complete"


@pytest.mark.slow
def test_friction_of_the_slider():
    """It needs a limit on the flexion at touchdown, nearly twice the torque, and makes low and high hops alternate."""
    robot = vary(load("spear_ii", locked=["boom_x"]), boom_damping=45.0)
    system = hopping(robot, HoppingLaw(stance_torque=12.0, minimum_force=10.0), Spring(damping=0.26))
    rubbed = find_gait(system, ["stance_torque"], {"flight_time": 0.2})
    assert rubbed.parameters["stance_torque"] == pytest.approx(13.01, abs=0.01)
    assert rubbed.multipliers[0] == pytest.approx(-1.884, abs=0.005)
    run = simulate(rubbed.system, rubbed.state)
    assert -run.ledger["friction"][0] > 0.8 * run.ledger["motor_knee"][0] > -5 * run.ledger["damping"][0]
    assert np.abs(run.ledger.residual).max() < 1e-7
