"""Event feedback: it stabilises the gaits, leaves their orbits alone, and rests on the right derivatives."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits import feedback
from spear_pin.gaits.bounding_law import INPUTS
from spear_pin.gaits.feedback import SCALES, linearized, regulated, speed_regulated
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, displacement, multipliers, return_map

RADIUS = {"least_effort": 0.9, "force_lift_off": 0.9}  # beside long_stride


@pytest.fixture(scope="module")
def gait() -> Gait:
    return Gait.load("long_stride")


@pytest.fixture(scope="module")
def derivatives(gait: Gait) -> tuple[np.ndarray, np.ndarray]:
    return linearized(gait, INPUTS, rtol=1e-9)


@pytest.mark.slow
def test_the_solved_gait_is_what_is_found(gait: Gait, stabilised: Gait) -> None:
    """The file is that of `regulated(Gait.load("long_stride"), rtol=1e-9)`, which differences round a little."""
    found = regulated(gait, rtol=1e-9)
    assert np.array(found.system.law.feedback) == pytest.approx(
        np.array(stabilised.system.law.feedback), rel=1e-3, abs=1e-3
    )
    assert replace(found.system.law, feedback=()) == replace(stabilised.system.law, feedback=())
    assert np.abs(found.multipliers) == pytest.approx(np.abs(stabilised.multipliers), abs=1e-4)


def test_the_long_stride_becomes_stable(gait: Gait, stabilised: Gait) -> None:
    assert abs(gait.multipliers[0]) > 1.0
    assert abs(stabilised.multipliers[0]) <= 0.85
    assert stabilised.stable


@pytest.mark.slow
@pytest.mark.parametrize("name", RADIUS)
def test_every_shipped_gait_becomes_stable(name: str) -> None:
    found = Gait.load(name)
    assert abs(found.multipliers[0]) > 1.0
    assert abs(regulated(found, rtol=1e-9).multipliers[0]) <= RADIUS[name]


@pytest.mark.slow
def test_the_orbit_stays_as_it_is(gait: Gait, stabilised: Gait) -> None:
    for state, given in zip(stabilised.state, gait.state, strict=True):
        assert np.array_equal(state, given)
    once = return_map(stabilised.system, stabilised.state, 1e-12)
    assert np.abs(displacement(gait.system, gait.state, once.state)).max() < 1e-8
    for one, other in zip(once.state, return_map(gait.system, gait.state, 1e-12).state, strict=True):
        assert one == pytest.approx(other, abs=1e-9)
    assert stabilised.durations == gait.durations


@pytest.mark.slow
@pytest.mark.parametrize("name", ["long_stride", "least_effort"])
def test_derivatives_against_differences_extrapolated_to_no_step(name: str) -> None:
    """Along directions that mix every coordinate and every input, from two steps much larger than those taken.

    In the one events meet, so that it is differenced; in the other none do.
    """
    gait = Gait.load(name)
    A, B = linearized(gait, INPUTS, rtol=1e-9)
    local = chart(gait.system, gait.state)
    n, scales = local.dimension, np.array([SCALES[name] for name in INPUTS])
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


@pytest.mark.slow
def test_multipliers_are_those_of_the_linear_closed_loop(
    gait: Gait, stabilised: Gait, derivatives: tuple[np.ndarray, np.ndarray]
) -> None:
    A, B = derivatives
    local = chart(gait.system, gait.state)
    dq = local.q_basis.shape[1]
    basis = np.zeros((local.q_basis.shape[0] - 1 + local.v_basis.shape[0], local.dimension))
    basis[: len(local.q_basis) - 1, :dq], basis[len(local.q_basis) - 1 :, dq:] = local.q_basis[1:], local.v_basis
    closed = np.linalg.eigvals(A + B @ np.array(stabilised.system.law.feedback) @ basis)
    assert abs(stabilised.multipliers[0]) < abs(gait.multipliers[0])
    largest = sorted(np.abs(closed), reverse=True)[:3]
    assert np.abs(stabilised.multipliers[:3]) == pytest.approx(largest, abs=2e-3)


def test_a_saved_gait_keeps_its_feedback(stabilised: Gait, tmp_path) -> None:
    again = Gait.load(stabilised.save(tmp_path / "gait.json"))
    assert again.system.law == stabilised.system.law
    assert again.system.law.feedback
    assert np.array_equal(again.multipliers, stabilised.multipliers)


def test_speed_feedback_adds_to_both_hips_and_nothing_on_the_orbit(gait: Gait, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(feedback, "_multiplied", lambda closed, rtol: closed)  # which takes long
    law = (quick := speed_regulated(gait, gain=20.0)).system.law
    assert law.speed_gain == (20.0, 20.0)
    assert law.speed_nominal[0] == gait.state[1][0]
    once = return_map(quick.system, quick.state, 1e-12)
    assert np.abs(displacement(gait.system, gait.state, once.state)).max() < 1e-8


@pytest.mark.slow
def test_the_gain_of_speed_feedback_that_is_found_beats_those_beside_it(gait: Gait) -> None:
    """By the multipliers of the simulation itself, at gains that the search does not simulate."""
    best = speed_regulated(gait)
    (gain, same), largest = best.system.law.speed_gain, abs(best.multipliers[0])
    assert gain == same
    assert largest < 0.75
    for other in (gain - 5.0, gain + 5.0):
        assert abs(speed_regulated(gait, other).multipliers[0]) > largest


def test_what_cannot_be_asked_for(gait: Gait, stabilised: Gait) -> None:
    with pytest.raises(UnknownName, match="epsilon"):
        regulated(gait, ("posterior_hip_torque", "epsilon"))
    for weight in (0.0, -1.0, math.nan):
        with pytest.raises(BadValue, match="weight"):
            regulated(gait, weight=weight)
    for build in (regulated, speed_regulated):
        with pytest.raises(BadValue, match="event feedback"):
            build(stabilised)


@pytest.mark.slow
def test_a_hop_has_no_such_feedback(hop: Gait) -> None:
    for build in (regulated, speed_regulated):
        with pytest.raises(BadValue, match="bounding"):
            build(hop)


@pytest.mark.slow
def test_the_multipliers_are_those_of_the_simulated_cycles(stabilised: Gait) -> None:
    """They come from the derivatives of the gait without feedback, by the chain rule."""
    simulated = multipliers(stabilised.system, stabilised.state, 1e-10)
    assert np.abs(stabilised.multipliers) == pytest.approx(np.abs(simulated), abs=2e-4)
