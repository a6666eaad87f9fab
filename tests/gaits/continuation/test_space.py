"""Families in space: the equations' Jacobian against differences of cycles."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue
from spear_pin.gaits.continuation.continuing import _equations
from spear_pin.gaits.continuation.stepping import orient_tangent, step_along
from spear_pin.hybrid.parameters import number
from spear_pin.hybrid.periodic import residual

STEP = 1e-5
CASES = {
    "trot": ("trot", "posterior_hip_torque", (), {}),
    "trot over a number of the robot": ("trot", "hip_spacing", (), {}),
    "trot with a target": ("trot", "posterior_hip_torque", ("anterior_hip_torque",), {"mean_speed": 2.0}),
    "pronk": ("pronk", "posterior_hip_torque", (), {}),
}


@pytest.mark.slow
@pytest.mark.parametrize(("name", "over", "vary", "target"), CASES.values(), ids=CASES)
def test_jacobian(name, over, vary, target, monkeypatch):
    gait = Gait.load(name)
    value = number(gait.system, over)
    within = sorted([0.99 * value, 1.01 * value])
    problem, state, values = _equations(gait, over, tuple(within), vary, target, 1e-12)
    monkeypatch.setattr(type(problem), "_differenced", None)  # not by differences
    local = problem.local(problem.point(state, values))
    charts, n = local.more.charts, local.jacobian.shape[1]
    assert charts.dimension + len(values) == n
    mixed = np.random.default_rng(0).normal(size=n)
    for direction in (mixed / np.linalg.norm(mixed), *np.eye(n)[charts.dimension :]):
        points = np.outer([STEP, -STEP], direction)
        shifted = values + points[:, charts.dimension :] * problem.scale
        found, cycles = problem._residuals(charts, points[:, : charts.dimension], shifted)
        assert list(cycles.reason) == ["", ""]
        slope, ours = (found[0] - found[1]) / (2.0 * STEP), local.jacobian @ direction
        assert np.abs(ours).max() > 1e-4
        # beside a symmetric gait differences cross from one foot first to the other
        np.testing.assert_allclose(slope, ours, rtol=0.0, atol=3e-5 if name == "pronk" else 5e-7)


@pytest.mark.slow
def test_directions():
    """What the exact equations say of how points move is what the charts say."""
    gait = Gait.load("trot")
    value = number(gait.system, "hip_spacing")
    problem, state, values = _equations(gait, "hip_spacing", (0.99 * value, 1.01 * value), (), {}, 1e-9)
    local = problem.local(problem.point(state, values))
    np.testing.assert_allclose(local.directions, problem._directions(local.more.charts, values), rtol=0.0, atol=1e-8)


def test_half_a_stride_stays_half_a_stride():
    gait = Gait.load("trot")
    value = number(gait.system, "posterior_left_hip_mass")
    with pytest.raises(BadValue, match="keeps left and right alike"):
        _equations(gait, "posterior_left_hip_mass", (0.9 * value, 1.1 * value), (), {}, 1e-9)


@pytest.mark.slow
def test_a_number_of_a_body():
    """Two points beside a gait, over a number that no law has, and how the multipliers change between them."""
    gait, name = Gait.load("trot"), "roll_inertia_xx"
    value = number(gait.system, name)
    problem, state, values = _equations(gait, name, (0.98 * value, 1.02 * value), (), {}, 1e-9)
    u = problem.point(state, values)
    start = orient_tangent(problem.local(u), np.eye(len(u))[-1])
    points = [step_along(problem, start, length) for length in (-0.05, 0.05)]
    assert [point.local.order for point in points] == [start.local.order] * 2
    inertias, largest = [], []
    for point in points:
        (q, v), found = problem.read(point.local.u)
        system = problem.family.member(found.tolist())
        assert number(system, name) == found[-1] and residual(system, (q, v)) < 1e-8
        inertias.append(found[-1])
        largest.append(abs(point.local.multipliers[0]))
    assert inertias[1] - inertias[0] > 3e-3 * value
    told = gait.sensitivity([name])
    slope = (told.multipliers[0].conj() * told.multiplier_derivatives[0, 0]).real / abs(told.multipliers[0])
    assert (largest[1] - largest[0]) / (inertias[1] - inertias[0]) == pytest.approx(slope, rel=1e-3)
