"""Derivatives of a hop against Richardson's extrapolation of differences."""

import numpy as np
import pytest

from spear_pin import find_gait, hopping, load
from spear_pin.hybrid.tangent.record import Recorder
from tests.hybrid.tangent.oracle import by_coordinate, by_parameter, derivative, found

pytestmark = pytest.mark.extra("heyoka")
NAMES = ("stance_torque", "stiffness", "damping", "knee_touchdown", "frequency", "hip_gain", "friction", "knee_gain")


@pytest.fixture(scope="module")
def gait():
    return find_gait(hopping(load("spear_ii", locked=["boom_x"])), vary=["stance_torque"], target={"flight_time": 0.2})


@pytest.fixture(scope="module")
def exact(gait):
    return derivative(gait.system, np.concatenate(gait.state), NAMES)


def test_columns_are_those_of_differences(gait, exact):
    result, around, _ = exact
    for j in range(around.dimension):
        expected = by_coordinate(gait.system, around, j, 2e-3)
        assert found(result, j) == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())


@pytest.mark.parametrize("name", NAMES)
def test_columns_of_parameters_are_those_of_differences(gait, exact, name):
    result, around, _ = exact
    expected = by_parameter(gait.system, np.concatenate(gait.state), name, 2e-4)
    off = 3e-6 if name == "friction" else 2e-8  # of a column that is so small that differences have few digits
    column = around.dimension + NAMES.index(name)
    assert found(result, column) == pytest.approx(expected, abs=off * np.abs(expected).max())


def test_multipliers_are_those_of_the_gait(gait, exact):
    result, around, _ = exact
    nv, d = 3, around.dimension
    M = np.concatenate([around.q_basis.T @ result.dy[:nv, :d], around.v_basis.T @ result.dy[nv:, :d]])
    moduli = np.sort(np.abs(np.linalg.eigvals(M)))
    assert moduli == pytest.approx(np.sort(np.abs(gait.multipliers)), abs=1e-7)


def test_without_compiled_functions_derivatives_are_the_same(gait):
    recorder = Recorder(gait.system)
    random = np.random.default_rng(3)
    for arc in recorder.lap(np.concatenate(gait.state)).arcs:
        field = recorder.field(arc.domain, arc.held)
        raw = np.concatenate([recorder.numbers, np.array([*arc.held.values()], dtype=float)])
        times, states = np.array([arc.t, arc.end]), np.column_stack([arc.y, arc.after])
        dy, dnumbers = random.normal(size=(6, 2, 4)), random.normal(size=(len(raw), 4)) * raw[:, None]
        pairs = zip(
            field.at(times, states, raw, 0.5, dy, dnumbers),
            field._interpreted(times, states, raw, 0.5, dy, dnumbers),
            strict=True,
        )
        for compiled, interpreted in pairs:
            for one, other in zip(compiled, interpreted, strict=True):
                assert other == pytest.approx(one, rel=1e-11, abs=1e-11 * np.abs(one).max(initial=0.0))
