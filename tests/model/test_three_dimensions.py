"""Robots in three dimensions: an arm by hand, and the same arm on a floating joint, by differences."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin.errors import BadValue
from spear_pin.model.loading import load
from tests.model.queries import QUERIES, each_query, refusal, state
from tests.model.spatial_arm import ARM, FLYING


@pytest.fixture
def flying(write):
    """The arm on a body that flies, its foot a toe."""
    return load(write(FLYING), toes=["foot"])


class TestThreeDimensions:
    """The arm by hand: yaw turns about z, a positive pitch lowers the boom."""

    yaw, pitch = 0.7, -0.4
    q, v = np.array([yaw, pitch]), np.array([1.5, -2.0])

    def test_shapes(self, arm):
        assert not arm.planar
        assert arm.toe_position(self.q, "foot").shape == arm.toe_drift(self.q, self.v, "foot").shape == (3,)
        assert arm.toe_jacobian(self.q, "foot").shape == (3, 2)
        assert arm.mass_matrix(self.q).shape == arm.coriolis_matrix(self.q, self.v).shape == (2, 2)
        assert arm.gravity(self.q).shape == arm.bias(self.q, self.v).shape == (2,)
        assert arm.actuation_matrix.shape == (2, 1)

    def test_position(self, arm):
        reach, height = 0.5 * np.cos(self.pitch), 0.2 - 0.5 * np.sin(self.pitch)
        expected = [reach * np.cos(self.yaw), reach * np.sin(self.yaw), height]
        np.testing.assert_allclose(arm.toe_position(self.q, "foot"), expected, atol=1e-15)

    def test_jacobian(self, arm):
        sy, cy, sp, cp = np.sin(self.yaw), np.cos(self.yaw), np.sin(self.pitch), np.cos(self.pitch)
        expected = 0.5 * np.array([[-cp * sy, -sp * cy], [cp * cy, -sp * sy], [0, -cp]])
        np.testing.assert_allclose(arm.toe_jacobian(self.q, "foot"), expected, atol=1e-15)

    def test_drift(self, arm):
        reach = 0.5 * np.cos(self.pitch)
        out, side = (
            np.array([np.cos(self.yaw), np.sin(self.yaw), 0]),
            np.array([-np.sin(self.yaw), np.cos(self.yaw), 0]),
        )
        lowering = 0.5 * np.sin(self.pitch)
        yaw_rate, pitch_rate = self.v
        expected = (
            -reach * (yaw_rate**2 + pitch_rate**2) * out
            - 2 * yaw_rate * pitch_rate * lowering * side
            + lowering * pitch_rate**2 * np.array([0, 0, 1])
        )
        np.testing.assert_allclose(arm.toe_drift(self.q, self.v, "foot"), expected, atol=1e-14)

    def test_mass_matrix(self, arm):
        s, c = np.sin(self.pitch), np.cos(self.pitch)
        about_z = 0.2 + 0.01 * s**2 + 0.04 * c**2 + 2 * (0.25 * c) ** 2
        expected = np.diag([about_z, 0.03 + 2 * 0.25**2])
        np.testing.assert_allclose(arm.mass_matrix(self.q), expected, atol=1e-14)
        assert arm.kinetic_energy(self.q, self.v) == pytest.approx(self.v @ expected @ self.v / 2)

    def test_gravity(self, arm):
        np.testing.assert_allclose(arm.gravity(self.q), [0, -2 * 9.81 * 0.25 * np.cos(self.pitch)], atol=1e-14)
        height = 0.2 - 0.25 * np.sin(self.pitch)
        assert arm.potential_energy(self.q) == pytest.approx(2 * 9.81 * height)

    @each_query
    def test_flying(self, flying, query):
        """A floating joint has one coordinate more than it has rates."""
        assert (flying.nq, flying.nv, flying.nu, flying.planar) == (8, 7, 1, False)
        assert flying.coordinates == (*(f"yaw_{part}" for part in ("vx", "vy", "vz", "wx", "wy", "wz")), "pitch")
        shapes = {
            "mass_matrix": (7, 7),
            "coriolis_matrix": (7, 7),
            "gravity": (7,),
            "bias": (7,),
            "actuation_matrix": (7, 1),
            "toe_jacobian": (3, 7),
            "toe_position": (3,),
            "frame_position": (3,),
            "toe_drift": (3,),
        }
        answer = QUERIES[query](flying, *state(flying))
        assert np.shape(answer) == shapes.get(query, ()) and np.isfinite(answer).all()

    def test_flying_foot(self, flying):
        """Its velocity and drift are the derivatives of its position at constant rates."""
        q, v = state(flying)
        step = 1e-4
        behind, here, ahead = (
            flying.toe_position(pin.integrate(flying.model, q, t * v), "foot") for t in (-step, 0.0, step)
        )
        np.testing.assert_allclose(flying.toe_jacobian(q, "foot") @ v, (ahead - behind) / (2 * step), atol=1e-6)
        np.testing.assert_allclose(flying.toe_drift(q, v, "foot"), (ahead - 2 * here + behind) / step**2, atol=1e-6)

    @pytest.mark.parametrize("length", [0.0, 0.999, 1.001, 2.0])
    def test_quaternion_that_is_no_rotation(self, flying, length):
        q, _ = state(flying)
        q[3:7] *= length
        error = refusal(BadValue, lambda: flying.toe_position(q, "foot"))
        assert error.name == "q" and "of length 1" in error.expected

    def test_rounded_quaternion(self, flying):
        q, _ = state(flying)
        np.testing.assert_allclose(flying.mass_matrix(q.round(5)), flying.mass_matrix(q), atol=1e-4)

    def test_configuration_is_named(self, write):
        error = refusal(BadValue, lambda: load(write(FLYING)).mass_matrix(np.zeros(7)))
        assert "8 numbers (yaw_x, yaw_y, yaw_z, yaw_qx, yaw_qy, yaw_qz, yaw_qw, pitch)" in error.expected

    def test_continuous_joint(self, write):
        """Pinocchio stores it as cosine and sine."""
        robot = load(write(FLYING.replace("floating", "continuous")), toes=["foot"])
        assert (robot.nq, robot.nv) == (3, 2)
        q = [np.cos(self.yaw), np.sin(self.yaw), self.pitch]
        np.testing.assert_allclose(robot.mass_matrix(q), load(write(ARM)).mass_matrix(self.q), atol=1e-14)
        error = refusal(BadValue, lambda: robot.mass_matrix([0.5, 0.5, self.pitch]))
        assert error.name == "q" and "a cosine and a sine, of length 1" in error.expected
