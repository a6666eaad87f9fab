"""Q-SPEAR in three dimensions: against its sagittal model, against its mirror image, and by what mechanics demands."""

from itertools import product

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import hopping
from spear_pin.errors import BadValue
from spear_pin.model.loading import ROBOTS, load
from spear_pin.model.urdf import read_urdf

FULL, SAGITTAL = load("q_spear_full"), load("q_spear")
LEGS = ("posterior_left", "posterior_right", "anterior_left", "anterior_right")
JOINTS = tuple(f"{leg}_{joint}" for leg, joint in product(LEGS, ("adduction", "hip", "knee")))
STATES = 200

# v of the mirror image, left for right: v of the base, then of the legs
MIRROR = np.zeros((18, 18))
MIRROR[:6, :6] = np.diag([1, -1, 1, -1, 1, -1])
for joint in JOINTS:
    other = joint.replace("left", "*").replace("right", "left").replace("*", "right")
    MIRROR[FULL.index(joint), FULL.index(other)] = -1.0 if joint.endswith("adduction") else 1.0
ACROSS = np.diag([1.0, -1.0, 1.0])


def random_states():
    """States anywhere: the base moved and turned, every joint up to 2 rad."""
    rng = np.random.default_rng(3)
    states = [(rng.uniform(-2, 2, FULL.nv), rng.uniform(-5, 5, FULL.nv)) for _ in range(STATES)]
    return [(pin.integrate(FULL.model, pin.neutral(FULL.model), away), v) for away, v in states]


def sagittal_states():
    """States of the sagittal robot, and what embeds them.

    Yields (q, v, full q, S, Ṡ v), where S v is the velocity of the full robot: the base's in the
    torso's own axes, and the same for left and right.
    """
    rng = np.random.default_rng(4)
    for _ in range(STATES):
        q, v = rng.uniform(-2, 2, SAGITTAL.nv), rng.uniform(-5, 5, SAGITTAL.nv)
        x, z, pitch = q[:3]
        sine, cosine = np.sin(pitch), np.cos(pitch)
        full_q = np.zeros(FULL.nq)
        full_q[:7] = x, 0, z, 0, -np.sin(pitch / 2), 0, np.cos(pitch / 2)
        embedding, rate = np.zeros((FULL.nv, SAGITTAL.nv)), np.zeros(FULL.nv)
        embedding[[0, 2], :2] = [[cosine, sine], [-sine, cosine]]
        embedding[4, 2] = -1.0
        rate[[0, 2]] = v[2] * np.array([[-sine, cosine], [-cosine, -sine]]) @ v[:2]
        for joint in JOINTS:
            pair = joint.replace("_left", "").replace("_right", "")
            if pair in SAGITTAL.coordinates:
                embedding[FULL.index(joint), SAGITTAL.index(pair)] = 1.0
                full_q[FULL.index(joint) + 1] = q[SAGITTAL.index(pair)]
        yield q, v, full_q, embedding, rate


def assert_close(actual, expected):
    """To 1e-12 of the largest."""
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-12 * max(1.0, np.abs(expected).max()))


class TestRobot:
    def test_coordinates(self):
        assert FULL.coordinates == (*(f"base_{part}" for part in ("vx", "vy", "vz", "wx", "wy", "wz")), *JOINTS)
        assert (FULL.nq, FULL.nv, FULL.nu) == (19, 18, 12)
        assert FULL.toes == tuple(f"{leg}_toe" for leg in LEGS)
        assert not FULL.planar and FULL.actuated == JOINTS

    def test_actuation(self):
        np.testing.assert_array_equal(FULL.actuation_matrix, np.eye(18)[:, 6:])

    def test_mass(self):
        assert FULL.mass == pytest.approx(43.76, abs=1e-12)
        q, _ = random_states()[0]
        np.testing.assert_allclose(FULL.mass_matrix(q)[:3, :3], 43.76 * np.eye(3), atol=1e-12)

    def test_motors(self):
        expected = {"adduction": (60, 0.047), "hip": (60, 0.047), "knee": (15, 0.027)}
        transmissions = read_urdf(ROBOTS["q_spear_full"].path).transmissions
        assert tuple(transmissions) == JOINTS
        for joint, gear in transmissions.items():
            ratio, reflected = expected[joint.rpartition("_")[2]]
            assert gear.ratio == ratio and gear.reflected == pytest.approx(reflected, rel=1e-12)

    @pytest.mark.parametrize("leg", LEGS)
    def test_leg_hangs_below_its_hip(self, leg):
        q = pin.neutral(FULL.model)
        x, y = 0.35 if "anterior" in leg else -0.35, 0.16 if "left" in leg else -0.16
        np.testing.assert_allclose(FULL.frame_position(q, f"{leg}_thigh"), [x, y, 0], atol=1e-15)
        np.testing.assert_allclose(FULL.toe_position(q, f"{leg}_toe"), [x, y, -0.636], atol=1e-15)

    @pytest.mark.parametrize("leg", LEGS)
    def test_signs(self, leg):
        """Adduction swings the leg to the left, the hip forward, the knee the shank backward."""
        rates = FULL.toe_jacobian(pin.neutral(FULL.model), f"{leg}_toe")
        columns = [FULL.index(f"{leg}_{joint}") for joint in ("adduction", "hip", "knee")]
        np.testing.assert_allclose(rates[:, columns], [[0, 0.636, -0.318], [0.636, 0, 0], [0, 0, 0]], atol=1e-15)
        assert rates[:, 6:].any(axis=0).sum() == 3

    def test_limits(self):
        lower, upper = FULL.model.lowerPositionLimit, FULL.model.upperPositionLimit
        for joint in JOINTS:
            limit = {"adduction": 0.8, "hip": 3.14, "knee": 2.8}[joint.rpartition("_")[2]]
            row = FULL.index(joint) + 1
            assert (lower[row], upper[row]) == (-limit, limit)

    def test_held_torso(self):
        held = load("q_spear_full", locked=["base"])
        q, _ = random_states()[0]
        q[:7] = pin.neutral(FULL.model)[:7]
        assert held.coordinates == JOINTS and held.mass == pytest.approx(43.76)
        assert_close(held.mass_matrix(q[7:]), FULL.mass_matrix(q)[6:, 6:])

    def test_no_planar_gait(self):
        with pytest.raises(BadValue, match="^robot is .*planar"):
            hopping(FULL)


class TestSagittalPlane:
    """What is symmetric, and moves only in the plane, moves as the pairs of legs do."""

    def test_mass_matrix(self):
        for q, _, full_q, embedding, _ in sagittal_states():
            assert_close(embedding.T @ FULL.mass_matrix(full_q) @ embedding, SAGITTAL.mass_matrix(q))

    def test_bias(self):
        for q, v, full_q, embedding, rate in sagittal_states():
            force = FULL.bias(full_q, embedding @ v) + FULL.mass_matrix(full_q) @ rate
            assert_close(embedding.T @ force, SAGITTAL.bias(q, v))

    def test_coriolis(self):
        for q, v, full_q, embedding, rate in sagittal_states():
            rates = embedding @ v
            force = FULL.coriolis_matrix(full_q, rates) @ rates + FULL.mass_matrix(full_q) @ rate
            assert_close(embedding.T @ force, SAGITTAL.coriolis_matrix(q, v) @ v)

    def test_gravity(self):
        for q, _, full_q, embedding, _ in sagittal_states():
            assert_close(embedding.T @ FULL.gravity(full_q), SAGITTAL.gravity(q))

    def test_motors(self):
        """A motor of a pair is one of each leg's."""
        _, _, _, embedding, _ = next(sagittal_states())
        for motor in SAGITTAL.actuated:
            both = [FULL.actuated.index(motor.replace("_", f"_{side}_")) for side in ("left", "right")]
            pair = SAGITTAL.actuation_matrix[:, SAGITTAL.actuated.index(motor)]
            np.testing.assert_array_equal(embedding.T @ FULL.actuation_matrix[:, both].sum(axis=1), 2 * pair)

    def test_energies(self):
        for q, v, full_q, embedding, _ in sagittal_states():
            assert_close(FULL.kinetic_energy(full_q, embedding @ v), SAGITTAL.kinetic_energy(q, v))
            assert_close(FULL.potential_energy(full_q), SAGITTAL.potential_energy(q))

    @pytest.mark.parametrize("leg", LEGS)
    def test_toes(self, leg):
        end, side = leg.split("_")
        toe, pair, y = f"{leg}_toe", f"{end}_toe", 0.16 if side == "left" else -0.16
        for q, v, full_q, embedding, rate in sagittal_states():
            rates = embedding @ v
            x, z = SAGITTAL.toe_position(q, pair)
            assert_close(FULL.toe_position(full_q, toe), [x, y, z])
            jacobian = FULL.toe_jacobian(full_q, toe)
            assert_close((jacobian @ embedding)[[0, 2]], SAGITTAL.toe_jacobian(q, pair))
            assert_close((jacobian @ embedding)[1], np.zeros(7))
            drift = FULL.toe_drift(full_q, rates, toe) + jacobian @ rate
            assert_close(drift[[0, 2]], SAGITTAL.toe_drift(q, v, pair))
            assert_close(drift[1], 0.0)

    @pytest.mark.parametrize("end", ["posterior", "anterior"])
    def test_forces_on_a_pair_of_toes(self, end):
        """Half of the pair's force on each toe is the pair's force."""
        for q, _, full_q, embedding, _ in sagittal_states():
            both = sum(FULL.toe_jacobian(full_q, f"{end}_{side}_toe") for side in ("left", "right"))
            assert_close((both @ embedding)[[0, 2]] / 2, SAGITTAL.toe_jacobian(q, f"{end}_toe"))


class TestMirrorImage:
    """Left for right, every answer is the mirror image."""

    @staticmethod
    def mirrored(q):
        image = np.empty(FULL.nq)
        image[:7] = q[:7] * [1, -1, 1, -1, 1, -1, 1]
        image[7:] = MIRROR[6:, 6:] @ q[7:]
        return image

    def test_dynamics(self):
        for q, v in random_states():
            image, rates = self.mirrored(q), MIRROR @ v
            assert_close(FULL.mass_matrix(image), MIRROR @ FULL.mass_matrix(q) @ MIRROR.T)
            assert_close(FULL.bias(image, rates), MIRROR @ FULL.bias(q, v))
            assert_close(FULL.gravity(image), MIRROR @ FULL.gravity(q))

    @pytest.mark.parametrize("end", ["posterior", "anterior"])
    def test_toes(self, end):
        left, right = f"{end}_left_toe", f"{end}_right_toe"
        for q, v in random_states():
            image, rates = self.mirrored(q), MIRROR @ v
            assert_close(FULL.toe_position(image, right), ACROSS @ FULL.toe_position(q, left))
            assert_close(FULL.toe_jacobian(image, right), ACROSS @ FULL.toe_jacobian(q, left) @ MIRROR.T)
            assert_close(FULL.toe_drift(image, rates, right), ACROSS @ FULL.toe_drift(q, v, left))


def rate(function, q, v, step=1e-3):
    """Of a function of q and t where q moves at v, at t = 0, by five points."""
    near, far = (
        np.subtract(*(function(pin.integrate(FULL.model, q, t * v), t) for t in (n * step, -n * step))) for n in (1, 2)
    )
    return (8 * near - far) / (12 * step)


class TestMechanics:
    def test_mass_matrix_is_positive_definite(self):
        for q, _ in random_states():
            assert np.linalg.eigvalsh(FULL.mass_matrix(q))[0] > 1e-3

    def test_rate_of_mass_matrix_minus_twice_coriolis_is_skew(self):
        for q, v in random_states():
            skew = rate(lambda there, _: FULL.mass_matrix(there), q, v) - 2 * FULL.coriolis_matrix(q, v)
            np.testing.assert_allclose(skew, -skew.T, rtol=0, atol=1e-6)

    def test_gravity_is_gradient_of_potential_energy(self):
        for q, v in random_states():
            power = rate(lambda there, _: FULL.potential_energy(there), q, v)
            assert FULL.gravity(q) @ v == pytest.approx(power, abs=1e-6)

    def test_toes_move_as_their_jacobians_and_drifts_say(self):
        for q, v in random_states():
            for toe in FULL.toes:
                velocity = rate(lambda there, _, toe=toe: FULL.toe_position(there, toe), q, v)
                np.testing.assert_allclose(FULL.toe_jacobian(q, toe) @ v, velocity, rtol=0, atol=1e-7)
                drift = rate(lambda there, _, toe=toe, v=v: FULL.toe_jacobian(there, toe) @ v, q, v)
                np.testing.assert_allclose(FULL.toe_drift(q, v, toe), drift, rtol=0, atol=1e-6)

    def test_energy_changes_by_the_power_of_the_motors(self):
        u = np.linspace(-20, 30, FULL.nu)
        for q, v in random_states():
            a = np.linalg.solve(FULL.mass_matrix(q), FULL.actuation_matrix @ u - FULL.bias(q, v))

            def energy(there, t, v=v, a=a):
                return FULL.kinetic_energy(there, v + t * a) + FULL.potential_energy(there)

            assert rate(energy, q, v, 1e-4) == pytest.approx(u @ v[6:], rel=1e-5, abs=1e-4)
