"""Drives that payoff takes from a robot's file, or assumes."""

import pytest

from spear_pin import load, monopod
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.studies.payoff import Motors
from spear_pin.studies.payoff.motors import assume_motor, fit_motors, known
from tests.model import small_leg


@pytest.mark.parametrize("ratio", [9.0, 1.0, 0.5])
def test_a_ratio_that_the_file_says_stays(ratio, tmp_path):
    path = small_leg.write(tmp_path)
    path.with_suffix(".toml").write_text(f"[motors.all]\nratio = {ratio}\nrotor_inertia = 3.3e-5\n", encoding="utf-8")
    leg = monopod(load(path, base="fixed", motors="all"), "leg", locked=["boom_x"])
    assert assume_motor(leg, "knee", 5.0, 15.0).gearbox.ratio == ratio


def test_a_given_motor_brings_its_mass():
    robot = load("spear_ii", locked=["boom_x"])
    hip, _ = known(robot, "hip")
    given = Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), 48.0)
    assert fit_motors(robot, Motors(given, hip, own=("hip",))).mass == pytest.approx(robot.mass + 1.0 - 0.470)
    assert fit_motors(robot, Motors(given, hip, own=("knee", "hip"))).mass == robot.mass
    assert fit_motors(robot, Motors(given, hip, {"knee": "assumed"}, ("hip",))).mass == robot.mass
