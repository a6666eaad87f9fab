"""A pace: the automaton of the trot with lateral pairs."""

from functools import cache

import numpy as np
import pytest

from spear_pin import Gait, pacing
from spear_pin.hybrid.periodic import residual, return_map
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import head_state, mirror_of
from tests.solve.gaits import pace_steady


@cache
def pace():
    return Gait.load("pace")


class TestOrbit:
    @pytest.mark.slow
    def test_residual_and_speed(self):
        assert residual(pace().system, pace().state) <= 1e-9
        half = return_map(pace().system, pace().state)
        assert pace().system.measures["mean_speed"](half) == pytest.approx(2.0, abs=1e-6)
        assert abs(half.change[0] - half.work[0].sum()) <= 1e-9

    def test_half_a_stride_is_the_mirror_image_of_the_other(self):
        mirror = mirror_of(pace().system.robot)
        half = return_map(pace().system, pace().state, 1e-11)
        for part, own in zip(head_state(*half.state), head_state(*pace().state), strict=True):
            np.testing.assert_allclose(part, mirror(own), rtol=0, atol=1e-8)

    def test_legs_of_a_side_bear_together(self):
        events = [event.name for event in run(pace().system, pace().state, 2, Options(rtol=1e-9)).events]
        struck = [name.removesuffix("_touchdown") for name in events if name.endswith("_touchdown")]
        assert struck[:2] == ["anterior_left", "posterior_left"]
        assert struck[3:5] == ["anterior_right", "posterior_right"]
        assert "slip" not in events

    def test_its_system_is_built_from_its_parts(self):
        system = pacing(pace().system.robot, pace().system.law, pace().system.spring)
        assert system.kind == "pacing" and system.section == "lateral_touchdown"
        assert system.phases == pace().system.phases


@pytest.mark.slow
def test_balanced():
    """By feedback twice a stride; pushed to the side it goes on, on another heading."""
    steady = pace_steady()
    assert abs(steady.multipliers[0]) <= 0.65
    q, v = (part.copy() for part in steady.state)
    v[1] += 0.2
    assert run(steady.system, (q, v), 20, Options(rtol=1e-9)).cycles == 20
