"""Figures of a gait with its motors, and motors that are assumed."""

import numpy as np
import pytest

from spear_pin import load, sagittal, vary
from spear_pin.model.catalogue import motor
from spear_pin.studies.design import electrical_cost
from spear_pin.studies.payoff import Motors, Point, assume_motor, fit_motors, of_file
from spear_pin.studies.payoff.bounding import figures_of, request
from spear_pin.studies.payoff.grid import FIXED, NONE, SWITCHED
from spear_pin.studies.payoff.motors import KIND, RATIO, SPARE
from spear_pin.studies.payoff.searches import rebuilt, write_gait
from tests.gaits.bounding_gaits import gait, trajectory
from tests.studies.payoff.stub import DRIVES, MOTORS

NAME = "long_stride"
ADDUCTIONS = [f"{pair}_{side}_adduction" for pair in ("posterior", "anterior") for side in ("left", "right")]


@pytest.fixture(scope="module")
def found():
    robot = gait(NAME).system.robot
    return figures_of(gait(NAME), MOTORS, request(robot, Point(SWITCHED, 2.5, 56.0), MOTORS))


class TestFigures:
    @pytest.mark.slow
    def test_cost_is_what_both_motors_of_each_joint_draw(self, found):
        """By i² R + e i with the current of each instant, summed over intervals of the samples."""
        stride, drive = trajectory(NAME), DRIVES["knee"]
        robot = gait(NAME).system.robot
        rate = stride.v[:, [robot.index(joint) for joint in robot.actuated]]
        torque = stride.u / 2
        geared = drive.constant * drive.gearbox.efficiency ** np.where(torque * rate < 0, -1.0, 1.0)
        current = torque / geared
        power = np.maximum(drive.motor.resistance * current**2 + drive.constant * rate * current, 0.0)
        energy = 2 * np.sum(0.5 * (power[1:] + power[:-1]) * np.diff(stride.t)[:, None])
        assert found.cost == pytest.approx(energy / (robot.weight * np.ptp(stride.q[:, 0])), rel=1e-3)
        assert sum(found.shares.values()) == pytest.approx(found.cost)

    @pytest.mark.slow
    def test_the_knees_share_is_that_of_the_design_studies(self, found):
        positive = electrical_cost(gait(NAME), DRIVES["knee"]) - found.shares["knee"]
        assert 0.0 < positive < found.shares["hip"]  # of hips that study counts positive work alone

    def test_joints(self, found):
        stride = trajectory(NAME)
        for i, joint in enumerate(("posterior_hip", "posterior_knee", "anterior_hip", "anterior_knee")):
            torque = stride.u[:, i] / 2
            assert found.peak[joint] == pytest.approx(np.abs(torque).max(), rel=1e-3)
            rms = np.sqrt(np.trapezoid(torque**2, stride.t) / np.ptp(stride.t))
            assert found.rms[joint] == pytest.approx(rms, rel=1e-3)
            assert found.heat[joint] == pytest.approx(rms / DRIVES["knee"].continuous_torque, rel=1e-3)
            assert found.torque_used[joint] == pytest.approx(np.abs(stride.u[:, i]).max() / 240.0, rel=1e-3)
        assert found.stiffness == 56.0 and found.speed == pytest.approx(2.5, abs=1e-6) and found.ledger < 1e-6

    def test_bounds_that_hold_it_are_named(self, found):
        robot = gait(NAME).system.robot
        tight = request(robot, Point(NONE, 2.5), MOTORS)
        shortest = min(gait(NAME).durations[f"{leg}_stance"] for leg in ("posterior", "anterior"))
        held = figures_of(gait(NAME), MOTORS, type(tight)(**vars(tight) | {"minimum_stance": shortest})).held
        assert any("as short as it may be" in each for each in held)

    def test_written_and_rebuilt(self):
        own = gait(NAME)
        again = rebuilt("bounding", own.system.robot, write_gait(own))
        assert again.system.law == own.system.law and again.system.spring == own.system.spring
        assert (again.state[0] == own.state[0]).all() and again.residual == own.residual
        assert (again.multipliers == own.multipliers).all()


class TestRequest:
    def test_kinds(self):
        robot = load("q_spear")
        none, fixed, switched = (
            request(robot, Point(kind, 2.0, 40.0 if kind != NONE else 0.0), MOTORS) for kind in (NONE, FIXED, SWITCHED)
        )
        assert (none.stiffness, fixed.stiffness, switched.stiffness) == (0.0, 80.0, 80.0)
        assert fixed.rest == fixed.knee_touchdown and switched.rest is None
        assert {each.virtual_stiffness for each in (none, fixed, switched)} == {None}
        assert request(robot, Point(SWITCHED, 2.0, None), MOTORS).stiffness is None


class TestMotors:
    def test_an_assumed_motor_bears_and_turns_as_it_must(self, made_quadruped):
        drive = assume_motor(made_quadruped, "knee", 2.0, 15.0)
        assert drive.continuous_torque == pytest.approx(2.0 * SPARE, rel=0.01)
        assert drive.gearbox.ratio == RATIO and drive.bus == motor(KIND).nominal_voltage
        assert assume_motor(made_quadruped, "knee", 2.0, 200.0).no_load_speed == pytest.approx(200.0 * SPARE, rel=0.01)

    def test_its_rotors_are_put_in(self, made_quadruped):
        drive = assume_motor(made_quadruped, "knee", 2.0, 15.0)
        with_rotors = fit_motors(made_quadruped, Motors(drive, drive))
        added = with_rotors.model.armature - made_quadruped.model.armature
        np.testing.assert_allclose(added[3:], 2 * drive.reflected_inertia)

    def test_rotors_of_the_file_stay(self):
        robot = load("q_spear")
        drive = assume_motor(robot, "knee", 20.0, 15.0)
        assert drive.gearbox.ratio == 15.0
        kept = fit_motors(robot, Motors(drive, drive, own=("knee", "hip")))
        assert (kept.model.armature == robot.model.armature).all()

    def test_of_a_file(self, tmp_path):
        path = tmp_path / "own.toml"
        motors = '[motors.knee]\nmotor = "spear_ii_knee"\nefficiency = 0.8\n[motors.hip]\nratio = 60.0\n'
        path.write_text(f'robot = "q_spear_full"\nlocked = {ADDUCTIONS}\n{motors}')
        robot = sagittal(load(path))
        drive = of_file(robot, "knee", 24.0)
        assert drive.motor.torque_constant == 0.115 and drive.gearbox.ratio == 15.0 and drive.gearbox.efficiency == 0.8
        assert of_file(robot, "hip") is None and of_file(load("q_spear"), "knee") is None


@pytest.fixture(scope="module")
def made_quadruped():
    """Q-SPEAR as if its file knew no rotors."""
    return vary(sagittal(load("q_spear_full", locked=ADDUCTIONS)), knee_rotor=0.0, hip_rotor=0.0)
