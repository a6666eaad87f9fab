"""Slopes of many lanes at once, of each its own, against the reference engine."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import (
    Gait,
    HoppingLaw,
    find_gait,
    hopping,
    load,
    simulate_many,
)
from spear_pin.errors import BadValue
from spear_pin.gaits.many import find_many
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues, residual
from tests.hybrid.lanes import assert_agree, compiles

HEIGHT = 0.3
LAW = HoppingLaw(hip_touchdown=0.5, stance_torque=8.0)


@compiles
class TestLanes:
    @pytest.mark.parametrize("locked", [[], ["boom_x"]])
    @pytest.mark.parametrize("n", [1, 64])
    def test_agree_with_the_reference(self, n, locked):
        """Slope, height and friction differ, among them level and slippery ground; begun on it, and above it."""
        rng = np.random.default_rng(n)
        parameters = {
            "slope": np.append(rng.uniform(-0.1, 0.1, n)[1:], 0.0 if n > 1 else 0.08),
            "height": rng.uniform(-0.3, 0.3, n),
            "friction": rng.choice([0.12, 0.3, 0.8], n),
        }
        system = hopping(load("spear_ii", locked=locked), LAW)
        own = [with_parameters(system, {name: each[i] for name, each in parameters.items()}) for i in range(n)]
        q, v = (np.array(part) for part in zip(*(each.guess() for each in own), strict=True))
        high = np.arange(n) % 3 == 2
        q[high, system.robot.index("boom_z")] += 0.05
        found = simulate_many(system, q, v, 2, parameters=parameters)
        assert found.repeated.mean() < 0.3
        few = slice(None, None, max(1, n // 8))
        some = {name: getattr(found, name)[few] for name in ("q", "v", "cycles", "reason")}
        some["durations"] = {name: each[few] for name, each in found.durations.items()}
        given = {name: each[few] for name, each in parameters.items()}
        assert_agree(system, q[few], v[few], replace(found, **some), 2, parameters=given)

    def test_gaits(self, free_robot):
        """Fixed points on a ground of each lane's own, by the reference engine's residual and multipliers."""
        system = hopping(free_robot, LAW)
        begun = find_gait(system, ["hip_touchdown"], {"mean_speed": 0.0})
        own = {"slope": np.array([-0.05, 0.0, 0.04]), "height": np.array([0.1, 0.0, -0.2])}
        table = find_many(begun.system, own, ["hip_touchdown"], {"mean_speed": 0.0}, guess=begun.state)
        assert table.converged.all() and table.residual.max() < 1e-9
        for i in range(3):
            numbers = {name: float(each[i]) for name, each in table.parameters.items()}
            there, state = with_parameters(begun.system, numbers), (table.q[i], table.v[i])
            assert abs(there.ground.foot(free_robot, state[0], "toe")[0]) < 1e-14
            assert residual(there, state) < 1e-8
            np.testing.assert_allclose(
                table.multipliers[i], eigenvalues(differentiate_return_map(there, state)), rtol=0, atol=1e-5
            )
        with pytest.raises(BadValue, match="vary is 'slope'; expected a parameter that does not move the ground"):
            find_many(system, {"friction": [0.5]}, ["slope"], {"mean_speed": 0.0})

    def test_bound(self):
        """Two legs; one stride, from the shipped gait's state lifted onto slopes."""
        gait, n = Gait.load("least_effort"), 5
        parameters = {"slope": np.linspace(-0.01, 0.02, n), "friction": np.linspace(0.6, 0.9, n)}
        own = [with_parameters(gait.system, {name: each[i] for name, each in parameters.items()}) for i in range(n)]
        q, v = (np.array(part) for part in zip(*(each.guess() for each in own), strict=True))
        found = simulate_many(gait.system, q, v, parameters=parameters)
        assert (found.reason == "complete").all() and not found.repeated.any()
        assert_agree(gait.system, q, v, found, parameters=parameters)
