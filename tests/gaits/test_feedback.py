"""Event feedback: it stabilises the gaits, leaves their orbits alone, and rests on the right derivatives."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy

from spear_pin import Gait, find_gait, load
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits import feedback
from spear_pin.gaits.bounding_law import INPUTS
from spear_pin.gaits.feedback import add_feedback, regulate, speed_regulated, without_feedback
from spear_pin.gaits.linear import linearize
from spear_pin.gaits.parity import ALONG, LATERAL
from spear_pin.gaits.round_hopping import round_hopping
from spear_pin.gaits.series_hopping import series_hopping
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.hybrid.periodic import chart, differentiate_return_map, displacement, eigenvalues, return_map
from tests.gaits.feeding import idle
from tests.gaits.orbits.test_embedding import planar, spatial
from tests.slow import slow_but
from tests.solve.gaits import fastest_upright, least_effort_upright

RADIUS = {"least_effort": 0.9, "force_lift_off": 0.9}  # beside long_stride


@pytest.fixture(scope="module")
def series_hop() -> Gait:
    return find_gait(series_hopping(load("spear_ii_series", locked=["boom_x"])))


@pytest.fixture(scope="module")
def hoppy() -> Gait:
    return find_gait(round_hopping(load("hoppy")))


@pytest.fixture(scope="module")
def gait() -> Gait:
    return Gait.load("long_stride")


@pytest.fixture(scope="module")
def derivatives(gait: Gait) -> tuple[np.ndarray, np.ndarray]:
    return linearize(gait, INPUTS, rtol=1e-9)


@pytest.mark.slow
def test_the_solved_gait_is_what_is_found(gait: Gait, stabilised: Gait) -> None:
    """The file is that of `add_feedback(Gait.load("long_stride"), rtol=1e-9)`, which differences round a little."""
    found = add_feedback(gait, rtol=1e-9)
    ours, kept = feedback_of(found.system), feedback_of(stabilised.system)
    assert np.array(ours.gains) == pytest.approx(np.array(kept.gains), rel=1e-3, abs=1e-3)
    assert ours.nominal == pytest.approx(kept.nominal, abs=1e-12)
    assert replace(ours, gains=(), nominal=()) == replace(kept, gains=(), nominal=())
    assert found.system.law == stabilised.system.law
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
    assert abs(add_feedback(found, rtol=1e-9).multipliers[0]) <= RADIUS[name]


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
def test_multipliers_are_those_of_the_linear_closed_loop(
    gait: Gait, stabilised: Gait, derivatives: tuple[np.ndarray, np.ndarray]
) -> None:
    A, B = derivatives
    local = chart(gait.system, gait.state)
    basis = scipy.linalg.block_diag(local.q_basis, local.v_basis)
    closed = np.linalg.eigvals(A + B @ np.array(feedback_of(stabilised.system).gains) @ basis)
    assert abs(stabilised.multipliers[0]) < abs(gait.multipliers[0])
    largest = sorted(np.abs(closed), reverse=True)[:3]
    assert np.abs(stabilised.multipliers[:3]) == pytest.approx(largest, abs=2e-3)


def test_a_saved_gait_keeps_its_feedback(stabilised: Gait, tmp_path) -> None:
    again = Gait.load(stabilised.save(tmp_path / "gait.json"))
    assert feedback_of(again.system) == feedback_of(stabilised.system) is not None
    assert again.system.law == stabilised.system.law
    assert np.array_equal(again.multipliers, stabilised.multipliers)


def test_speed_feedback_adds_to_both_hips_and_nothing_on_the_orbit(gait: Gait, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(feedback, "linearize", lambda *_: (np.eye(1), np.empty((1, 0))))  # which takes long
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
    with pytest.raises(UnknownName, match="stiffness"):
        add_feedback(gait, ("posterior_hip_torque", "stiffness"))
    for inputs in ((), 2 * ("posterior_hip_torque",)):
        with pytest.raises(BadValue, match="inputs"):
            add_feedback(gait, inputs)
    for weight in (0.0, -1.0, math.nan):
        with pytest.raises(BadValue, match="weight"):
            add_feedback(gait, weight=weight)
    with pytest.raises(BadValue, match="heading"):
        add_feedback(gait, heading=1.0)
    for build in (add_feedback, speed_regulated):
        with pytest.raises(BadValue, match="event feedback"):
            build(stabilised)


@pytest.mark.slow
def test_a_hop_has_no_feedback_of_its_speed(hop: Gait) -> None:
    with pytest.raises(BadValue, match="bounding"):
        speed_regulated(hop)


class TestAnyGait:
    """A hop in place and with boom_x free, a hop with a series spring, HOPPY's, a law of one's own."""

    @pytest.mark.parametrize("name", slow_but(["hop", "free_hop", "series_hop", "hoppy"], "hop"))
    def test_multipliers_are_those_of_the_closed_loop(self, request, name):
        """They follow from A and B; the derivatives of the closed loop itself share nothing with K."""
        gait = request.getfixturevalue(name)
        found = regulate(gait)
        simulated = eigenvalues(differentiate_return_map(found.gait.system, gait.state))
        assert np.abs(found.held.values) == pytest.approx(np.abs(simulated), abs=1e-6)
        assert np.abs(found.without.values) == pytest.approx(
            np.abs(eigenvalues(differentiate_return_map(gait.system, gait.state))), abs=1e-6
        )
        once = return_map(found.gait.system, gait.state, 1e-12)
        assert np.abs(displacement(gait.system, gait.state, once.state)).max() < 1e-8

    def test_a_hop_that_drifts_away_comes_back(self, free_hop: Gait) -> None:
        held = add_feedback(free_hop)
        assert abs(free_hop.multipliers[0]) > 1.0 > 0.5 > abs(held.multipliers[0])
        local = chart(held.system, held.state)
        xi = np.array([0.01, -0.01, 0.02, 0.02])
        state = local.state(xi)
        for _ in range(8):
            state = return_map(held.system, state).state
        assert np.abs(local.coordinates(state)).max() < 0.01 * np.abs(xi).max()

    def test_what_a_law_does_not_list_is_named(self, hop: Gait) -> None:
        found = add_feedback(hop, ("knee_gain", "frequency"))
        assert feedback_of(found.system).limits == pytest.approx((0.5 * 63.25, 0.5 * 2.56))

    def test_what_grows_and_is_not_reached(self, free_hop: Gait) -> None:
        with pytest.raises(BadValue, match="numbers on which the next state depends"):
            add_feedback(free_hop.with_law(speed=1.0), ("speed",))  # with no gain of its own


@pytest.mark.slow
def test_a_gait_without_feedback_again(gait: Gait, stabilised: Gait) -> None:
    bare = without_feedback(stabilised)
    assert feedback_of(bare.system) is None and bare.system.law == stabilised.system.law
    assert abs(bare.multipliers[0]) == pytest.approx(abs(gait.multipliers[0]), abs=1e-3)
    assert without_feedback(gait) is gait
    for ours, its in zip(
        return_map(bare.system, gait.state).state, return_map(gait.system, gait.state).state, strict=True
    ):
        assert np.array_equal(ours, its)


@pytest.mark.slow
def test_the_multipliers_are_those_of_the_simulated_cycles(stabilised: Gait) -> None:
    """They come from the derivatives of the gait without feedback, by the chain rule."""
    simulated = eigenvalues(differentiate_return_map(stabilised.system, stabilised.state, 1e-10))
    assert np.abs(stabilised.multipliers) == pytest.approx(np.abs(simulated), abs=2e-4)


@cache
def in_space(name: str = "long_stride") -> Gait:
    """The gait in space; its multipliers are not looked at."""
    system, state = spatial(name)
    return Gait(system, state, {}, 1e-11, np.array([np.nan + 0j]), {})


class TestInSpace:
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
        found, along_it = regulate(in_space("least_effort")), np.abs(planar("least_effort").multipliers[:4])
        for of in (found.without, found.held):
            kinds = np.array(of.kinds)
            assert len(of.values) == len(kinds) == 32 and (kinds == LATERAL).sum() == 16
            np.testing.assert_allclose(np.abs(of.values[kinds == ALONG][:4]), along_it, rtol=0, atol=1e-5)
            assert (np.diff(np.abs(of.values)) <= 1e-9).all()
        lateral = [np.abs(of.values[np.array(of.kinds) == LATERAL]).max() for of in (found.without, found.held)]
        assert lateral[1] <= 0.55 < 1.0 < lateral[0]
        np.testing.assert_array_equal(found.gait.multipliers, found.held.values)

    def test_inputs_that_act_on_both_parities(self, monkeypatch):
        """Each gets gains for one parity; the multipliers are those of all motion, by the gains that the gait has."""
        gait, names = in_space(), ("posterior_adduction", "posterior_hip_torque")
        local = chart(gait.system, gait.state)
        i, j = np.flatnonzero(~local.even)[0], np.flatnonzero(local.even)[0]
        A, B = np.zeros((33, 32)), np.zeros((33, 2))
        A[i, i], A[j, j] = 1.5, 1.4
        B[[i, j]] = np.array([[1.0, 0.9], [0.9, 1.0]]) / [0.05, 50.0]
        monkeypatch.setattr(feedback, "linearize", lambda *_: (A, B))
        found = regulate(gait, names)
        gains = np.array(feedback_of(found.gait.system).gains) @ scipy.linalg.block_diag(local.q_basis, local.v_basis)
        wanted = np.linalg.eigvals(A[:32] + B[:32] @ gains)
        assert np.abs(found.held.values[:2]) == pytest.approx(sorted(np.abs(wanted), reverse=True)[:2], abs=1e-9)
        assert abs(found.held.values[0]) > 1.0 and not found.gait.stable


class TestRefusedInSpace:
    @pytest.mark.slow
    def test_feedback_of_the_speed_in_the_law_of_the_plane(self):
        law = in_space().system.law
        gait = in_space().with_law(plane=replace(law.plane, speed_gain=(5.0, 0.0)))
        with pytest.raises(BadValue, match="without_feedback"):
            add_feedback(gait)
        assert without_feedback(gait).system.law == law

    def test_inputs_that_are_none(self):
        with pytest.raises(UnknownName, match="input"):
            add_feedback(in_space(), ("hip_torque",))

    @pytest.mark.parametrize("inputs", [(), 2 * ("posterior_adduction",)])
    def test_no_inputs_and_one_twice(self, inputs):
        with pytest.raises(BadValue, match="inputs"):
            add_feedback(in_space(), inputs)

    def test_weights(self):
        with pytest.raises(BadValue, match="weight"):
            add_feedback(in_space(), weight=0.0)
        with pytest.raises(BadValue, match="heading"):
            add_feedback(in_space(), heading=-1.0)

    def test_feedback_twice(self):
        with pytest.raises(BadValue, match="without"):
            add_feedback(idle(in_space()))
