"""Balance in space: one number a stride keeps the bound upright, and pushes are recovered from, slip simulated."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, SpatialLaw
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.feedback import linearized
from spear_pin.gaits.orbits.balance import across, along, balance, balanced
from spear_pin.gaits.orbits.embedding import embedded
from spear_pin.gaits.orbits.parity import ALONG, LATERAL
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, eigenvalues, return_map
from spear_pin.hybrid.symmetry import YAW
from tests.gaits.orbits.test_embedding import planar, spatial
from tests.solve.gaits import fastest_upright, least_effort_upright


@cache
def gait(name="long_stride"):
    """The gait in space; its multipliers are not looked at."""
    system, state = spatial(name)
    return Gait(system, state, {}, 1e-11, np.array([np.nan + 0j]), {})


class TestLinear:
    @pytest.mark.slow
    def test_falls_sideways(self):
        found = across(gait(), (), heading=True)
        values = eigenvalues(found.A)
        assert values[0].real == pytest.approx(1.569, abs=5e-3) and values[1].real == pytest.approx(1.0, abs=1e-6)
        assert abs(values[2]) < 0.35

    @pytest.mark.slow
    def test_along_is_the_planes(self):
        found = eigenvalues(along(gait(), ()).A)
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
        whole = linearized(gait(), (name,))[1][:-1, 0]
        assert np.abs(whole[local.even]).max() < 1e-9 * np.abs(whole).max()  # the mean of both sides
        found = across(gait(), (name,), heading=True).B[:, 0]
        np.testing.assert_allclose(found, 2.0 * narrow - wide, rtol=0, atol=2e-6 * np.abs(found).max())


class TestBalanced:
    @pytest.mark.parametrize(
        ("name", "kept"), [("least_effort", least_effort_upright), ("long_stride_3.50", fastest_upright)]
    )
    def test_one_number_a_stride_suffices(self, name, kept):
        """Sideways: what is left above is the plane's, along."""
        plane, found = planar(name).multipliers, kept().multipliers
        lateral = [each for each in found if abs(plane - each).min() > 1e-5]
        assert len(found) == 32 and max(map(abs, lateral)) <= 0.55

    @pytest.mark.slow
    def test_all_multipliers_are_told_without_feedback_and_with_it(self):
        found, along_it = balance(gait("least_effort")), np.abs(planar("least_effort").multipliers[:4])
        for of in (found.without, found.held):
            kinds = np.array(of.kinds)
            assert len(of.values) == len(kinds) == 32 and (kinds == LATERAL).sum() == 16
            np.testing.assert_allclose(np.abs(of.values[kinds == ALONG][:4]), along_it, rtol=0, atol=1e-5)
            assert (np.diff(np.abs(of.values)) <= 1e-9).all()
        lateral = [np.abs(of.values[np.array(of.kinds) == LATERAL]).max() for of in (found.without, found.held)]
        assert lateral[1] <= 0.55 < 1.0 < lateral[0]
        np.testing.assert_array_equal(found.gait.multipliers, found.held.values)


class TestRefused:
    def test_inputs_that_are_none(self):
        with pytest.raises(UnknownName, match="input"):
            balanced(gait(), ("hip_torque",))
        with pytest.raises(UnknownName, match="input"):
            across(gait(), ("posterior_hip_torque",))

    @pytest.mark.parametrize("inputs", [(), 2 * ("posterior_adduction",)])
    def test_no_inputs_and_one_twice(self, inputs):
        with pytest.raises(BadValue, match="inputs"):
            balanced(gait(), inputs)

    def test_gaits_of_the_plane(self):
        with pytest.raises(BadValue, match="space"):
            across(planar("long_stride"), ())

    def test_weights(self):
        with pytest.raises(BadValue, match="weight"):
            balanced(gait(), weight=0.0)
        with pytest.raises(BadValue, match="heading"):
            balanced(gait(), heading=-1.0)

    def test_feedback_twice(self):
        system, state = gait().system, gait().state
        law = SpatialLaw(system.law.plane, nominal=36 * (0.0,), feedback=16 * (36 * (0.0,),))
        with pytest.raises(BadValue, match="without"):
            balanced(Gait(*embedded(planar("long_stride"), law), {}, 0.0, np.ones(1, complex), {}))
        assert state is gait().state

    def test_shapes_of_feedback(self):
        plane = planar("long_stride").system.law
        with pytest.raises(BadValue, match="feedback"):
            SpatialLaw(plane, nominal=(0.0,), feedback=((0.0,),))
        with pytest.raises(BadValue, match="feedback_limits"):
            SpatialLaw(plane, feedback_limits=(1.0,))
        with pytest.raises(BadValue, match="adduction_epsilon"):
            SpatialLaw(plane, adduction_epsilon=0.0)
        with pytest.raises(BadValue, match="plane.feedback"):
            SpatialLaw(replace(plane, feedback=6 * (len(plane.nominal) * (0.0,),)))
