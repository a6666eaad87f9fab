"""The return map to first order: exact or by differences, of all motion or of one parity."""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import INPUTS
from spear_pin.gaits.inputs import inputs_of
from spear_pin.gaits.linear import linear, linearize
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, eigenvalues, return_map
from spear_pin.hybrid.symmetry import YAW
from tests.gaits.orbits.test_embedding import planar, spatial


@cache
def gait(name="long_stride"):
    """The gait in space; its multipliers are not looked at."""
    system, state = spatial(name)
    return Gait(system, state, {}, 1e-11, np.array([np.nan + 0j]), {})


@pytest.mark.slow
@pytest.mark.parametrize("name", ["long_stride", "least_effort"])
def test_derivatives_against_differences_extrapolated_to_no_step(name: str) -> None:
    """Along directions that mix every coordinate and every input, from two steps much larger than those taken.

    In the one events meet, so that it is differenced; in the other none do.
    """
    gait = Gait.load(name)
    A, B = linearize(gait, INPUTS, rtol=1e-9)
    local = chart(gait.system, gait.state)
    n, scales = local.dimension, np.array([each.one for each in inputs_of(gait.system, INPUTS)])
    nominal = np.array([parameter(gait.system, name) for name in INPUTS])
    random = np.random.default_rng(0)

    def mapped(xi: np.ndarray, w: np.ndarray) -> np.ndarray:
        trial = with_parameters(gait.system, dict(zip(INPUTS, (nominal + w).tolist(), strict=True)))
        return local.coordinates(return_map(trial, local.state(xi), 1e-11).state)

    for _ in range(3):
        along = random.normal(size=n + len(INPUTS))
        along /= np.linalg.norm(along)
        xi, w = along[:n], scales * along[n:]
        wide, narrow = ((mapped(h * xi, h * w) - mapped(-h * xi, -h * w)) / (2.0 * h) for h in (1e-4, 5e-5))
        assert A @ xi + B @ w == pytest.approx((4.0 * narrow - wide) / 3.0, abs=2e-4 * np.abs(A).max())


class TestInSpace:
    @pytest.mark.slow
    def test_falls_sideways(self):
        found = linear(gait(), (), lateral=True, heading=True)
        values = eigenvalues(found.A)
        assert values[0].real == pytest.approx(1.569, abs=5e-3) and values[1].real == pytest.approx(1.0, abs=1e-6)
        assert abs(values[2]) < 0.35

    @pytest.mark.slow
    def test_along_is_the_planes(self):
        found = eigenvalues(linear(gait(), (), lateral=False).A)
        wanted = planar("long_stride").multipliers
        np.testing.assert_allclose(np.abs(found[:4]), np.abs(wanted[:4]), rtol=0, atol=1e-5)

    @pytest.mark.slow
    def test_what_an_input_does_is_what_differences_say(self):
        """An input that tells left from right, where two feet land at once: the mean of both sides, heading and all."""
        system, state, name = gait().system, gait().state, "posterior_adduction"
        local = chart(system, state)

        def after(change):
            q, v = return_map(with_parameters(system, {name: parameter(system, name) + change}), state, 1e-12).state
            return np.append(local.coordinates((q, v))[~local.even], q[YAW])

        wide, narrow = (
            (after(h) - after(-h)) / (2.0 * h) for h in (2e-4, 1e-4)
        )  # errors fall by two, as another foot lands first
        whole = linearize(gait(), (name,))
        moved = whole[1][:-1, 0]
        assert np.abs(moved[local.even]).max() < 1e-9 * np.abs(moved).max()  # the mean of both sides
        found = linear(gait(), (name,), lateral=True, heading=True, whole=whole).B[:, 0]
        np.testing.assert_allclose(found, 2.0 * narrow - wide, rtol=0, atol=2e-6 * np.abs(found).max())

    def test_gaits_of_the_plane_have_no_parities(self):
        with pytest.raises(BadValue, match="space"):
            linear(planar("long_stride"), (), lateral=True)
