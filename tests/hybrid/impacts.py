"""Impacts at random: toes that approach the ground; and a slender rod that strikes it."""

import math

import numpy as np
from hypothesis import settings
from hypothesis import strategies as st

many = settings(max_examples=100, derandomize=True, deadline=None)
MODERATE = 2.0  # of velocities, in m/s and rad/s


@st.composite
def impacts(draw):
    """D, J, v with an approaching toe, and a coefficient of friction."""
    rng = np.random.default_rng(draw(st.integers(0, 2**32 - 1)))
    n = draw(st.integers(2, 5))
    friction = draw(st.sampled_from([0.0, 0.1, 0.5, 0.8, 1.5, 3.0]))
    rotation, _ = np.linalg.qr(rng.normal(size=(n, n)))
    D = rotation @ np.diag(rng.uniform(0.1, 3.0, n)) @ rotation.T
    J = rng.normal(size=(2, n))
    v = rng.uniform(-MODERATE, MODERATE, n)
    v *= -np.sign((J @ v)[1])
    return 0.5 * (D + D.T), J, v, friction


def inverse_mass(D, J):
    """J D⁻¹ Jᵀ, tangential and normal."""
    return J @ np.linalg.inv(D) @ J.T


def rod(angle, mass=2.0, half_length=0.5):
    """A slender rod at an angle to the ground, its lower end the toe: D and J in (x, z, rotation) of its centre."""
    D = np.diag([mass, mass, mass * half_length**2 / 3.0])
    lever = half_length * np.array([-math.cos(angle), -math.sin(angle)])  # from the centre to the toe
    return D, np.array([[1.0, 0.0, -lever[1]], [0.0, 1.0, lever[0]]])
