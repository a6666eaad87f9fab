"""What drives a joint, as far as files say it: "not said" is neither 1 nor 0."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import load
from spear_pin.model.gears import Gear, set_gears
from tests.cases.legs import DRIVE_OF_KNEE, leg, mjcf, put


def one_joint():
    """A model of one hinge, of which Pinocchio says the ratio 1."""
    model = pin.Model()
    joint = model.addJoint(0, pin.JointModelRY(), pin.SE3.Identity(), "knee")
    model.appendBodyToJoint(joint, pin.Inertia.Random(), pin.SE3.Identity())
    return model


@pytest.mark.parametrize(
    ("gear", "reflected"),
    [
        (Gear(), None),
        (Gear(9.0), None),
        (Gear(None, 2e-4), 2e-4),
        (Gear(9.0, 2e-4), 81 * 2e-4),
        (Gear(-9.0, 2e-4), 81 * 2e-4),
        (Gear(9.0, 0.0), 0.0),
        (Gear(9.0, armature=0.03), 0.03),
    ],
)
def test_reflected(gear, reflected):
    assert gear.reflected == (None if reflected is None else pytest.approx(reflected, rel=1e-15))


@pytest.mark.parametrize(
    ("own", "other", "both", "differ"),
    [
        (Gear(), Gear(9.0, 1e-4), Gear(9.0, 1e-4), ()),
        (Gear(9.0), Gear(None, 1e-4), Gear(9.0, 1e-4), ()),
        (Gear(9.0, 0.0), Gear(9.0, 1e-4), Gear(9.0, 0.0), ("rotor",)),
        (Gear(1.0), Gear(9.0), Gear(1.0), ("ratio",)),
        (Gear(9.0, 1e-4), Gear(9.0, 1e-4), Gear(9.0, 1e-4), ()),
    ],
)
def test_two_sources(own, other, both, differ):
    assert own.completed(other) == (both, differ)


@pytest.mark.parametrize(
    ("gear", "armature", "ratio", "rotor", "lines"),
    [
        (Gear(9.0, 1e-4), 81e-4, 9.0, 1e-4, 0),
        (Gear(9.0, armature=81e-4), 81e-4, 9.0, 1e-4, 0),
        (Gear(None, 1e-4), 1e-4, 0.0, 1e-4, 1),
        (Gear(9.0), 0.0, 9.0, 0.0, 0),
        (Gear(), 0.0, 0.0, 0.0, 0),
    ],
)
def test_model(gear, armature, ratio, rotor, lines):
    model = one_joint()
    assert len(set_gears(model, {"knee": gear})) == lines
    found = [float(each[0]) for each in (model.armature, model.rotorGearRatio, model.rotorInertia)]
    np.testing.assert_allclose(found, [armature, ratio, rotor], rtol=1e-14)


class TestSources:
    """What a URDF or an MJCF file, an SRDF and a TOML file say of one gear."""

    SRDF = '<robot name="leg"><rotor_params><joint name="knee" mass="1e-5" gear_ratio="30"/></rotor_params></robot>'

    def loaded(self, tmp_path, **files):
        return load(put(tmp_path, **files), base="fixed", motors=["knee"])

    def test_toml_beside_the_srdf(self, tmp_path):
        robot = self.loaded(tmp_path, urdf=leg(), srdf=self.SRDF, toml="[motors.knee]\nefficiency = 0.9\n")
        assert robot.gear_ratio("knee") == 30.0 and robot.model.armature[1] == pytest.approx(9e-3, rel=1e-12)

    def test_srdf_that_differs(self, tmp_path):
        urdf = leg(DRIVE_OF_KNEE.format("<mechanicalReduction>6</mechanicalReduction>"))
        with pytest.warns(match="its SRDF says another ratio of 'knee' than the URDF, whose is taken"):
            robot = self.loaded(tmp_path, urdf=urdf, srdf=self.SRDF)
        assert robot.gear_ratio("knee") == 6.0 and robot.model.armature[1] == pytest.approx(36e-5, rel=1e-12)

    def test_rotor_of_an_armature(self, tmp_path):
        """A TOML ratio splits what an MJCF file gives reflected."""
        robot = self.loaded(tmp_path, xml=mjcf(knee='armature="0.02"'), toml="[motors.all]\nratio = 10.0\n")
        assert robot.model.rotorInertia[1] == pytest.approx(2e-4, rel=1e-12) and robot.model.armature[1] == 0.02

    def test_nothing_is_said(self, tmp_path):
        """A motor without a gear drives its joint directly, and its armature is the rotor's."""
        robot = self.loaded(tmp_path, xml=mjcf(knee='armature="0.02"'))
        assert robot.gear_ratio("knee") == 1.0 and robot.model.rotorInertia[1] == 0.02
