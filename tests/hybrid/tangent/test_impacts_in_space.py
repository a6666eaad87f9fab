"""Derivatives of impacts in space against differences, for toes that stick, slide and leave, alone and overlapping."""

import numpy as np
import pytest

from spear_pin.hybrid.rules.guards import rise, struck
from spear_pin.hybrid.rules.spatial_impact import find_impulses, spatial_impact
from spear_pin.hybrid.strikes import Overlap
from spear_pin.hybrid.tangent.fields import ToeNumbers
from spear_pin.hybrid.tangent.resets import NotDifferentiable, differentiate_stop, differentiate_strike_in_space

NV, H = 9, 1e-6
TOES = ("left", "right")


def randomly(seed, friction):
    """A mechanism with two toes, as a function of a number on which everything depends."""
    rng = np.random.default_rng(seed)
    roots, jacobians, speeds = rng.normal(size=(2, NV, NV)), rng.normal(size=(2, 6, NV)), rng.normal(size=(2, NV))
    earlier = np.abs(rng.normal(size=(2, 2, 3))) * [0.02, 0.02, 0.1]

    def at(s):
        root, J, v = (one + s * other for one, other in (roots, jacobians, speeds))
        v = v - np.linalg.pinv(J[[2, 5]]) @ (J[[2, 5]] @ v + 1.0 + s * np.array([0.3, -0.2]))  # both toes come down
        return root @ root.T + np.eye(NV), J, v, friction * (1.0 + s), earlier[0] + s * earlier[1]

    return at


def numbers(at, s):
    D, J, v, friction, _ = at(s)
    responses = np.linalg.solve(D, J.T).T
    return [np.array(friction), np.zeros(2), J.reshape(2, 3, NV), responses.reshape(2, 3, NV), J @ responses.T, J @ v]


def slope(of):
    return (np.asarray(of(H)) - np.asarray(of(-H))) / (2.0 * H)


def toes(at):
    """Numbers of the toes, and their derivatives along one direction."""
    columns = [slope(lambda s, i=i: numbers(at, s)[i])[..., None] for i in range(6)]
    return ToeNumbers(*numbers(at, 0.0)), ToeNumbers(*columns)


@pytest.mark.parametrize("overlaps", [False, True])
@pytest.mark.parametrize("friction", [0.05, 0.6, 5.0])
def test_against_differences(friction, overlaps):
    modes = set()
    for seed in range(12):
        at = randomly(seed, friction)

        def impact(s, at=at):
            D, J, v, mu, before = at(s)
            return spatial_impact(D, J, v, mu, before if overlaps else None)

        feet, slopes = toes(at)
        received = np.stack([at(0.0)[4], slope(lambda s, at=at: at(s)[4])], axis=-1) * overlaps
        found = differentiate_strike_in_space(feet, slopes, TOES, ("left",), ("right",), received)
        v = at(0.0)[2]
        np.testing.assert_allclose(v + found.v, impact(0.0).v, rtol=0, atol=1e-10)
        wanted = slope(lambda s, at=at: impact(s).v - at(s)[2])
        np.testing.assert_allclose(found.dv[:, 0], wanted, rtol=0, atol=2e-6 * max(1.0, np.abs(wanted).max()))
        wanted = slope(lambda s: impact(s).impulse)
        np.testing.assert_allclose(found.impulse[..., 1], wanted, rtol=0, atol=2e-6 * max(1.0, np.abs(wanted).max()))
        assert (found.held[struck("left")], found.held[struck("right")]) == (0.0, 1.0)
        answer = find_impulses(feet.inverse_inertia, feet.speeds, friction, received[..., 0])
        modes |= {*answer.modes}
        for toe, mode, leaves in zip(TOES, answer.modes, impact(0.0).leaves, strict=True):
            assert leaves == (mode == "open") and (leaves or found.held[rise(toe)] == 0.0)
    assert {0.05: "slip", 0.6: "slip", 5.0: "stick"}[friction] in modes


def test_a_toe_that_leaves_rises_by_its_derivative():
    for seed in range(40):
        at = randomly(seed, 0.6)
        feet, slopes = toes(at)
        found = differentiate_strike_in_space(feet, slopes, TOES, TOES, (), np.zeros((2, 3, 2)))
        leaves = spatial_impact(*at(0.0)[:4]).leaves
        if any(leaves):
            break
    i = leaves.index(True)

    def rising(s):
        D, J, v, mu, _ = at(s)
        return (J @ spatial_impact(D, J, v, mu).v)[3 * i + 2]

    assert found.held[rise(TOES[i])].d[0] == pytest.approx(slope(rising), abs=1e-5)


def test_the_end_of_sliding_against_differences():
    at = randomly(3, 0.6)
    feet, slopes = toes(at)
    rows = [0, 1, 2, 5]

    def after(s):
        D, J, v, _, _ = at(s)
        J = J[rows]
        response = np.linalg.solve(D, J.T)
        return -response @ np.linalg.solve(J @ response, J @ v)

    change, slope_of_it = differentiate_stop(feet, slopes, rows)
    np.testing.assert_allclose(change, after(0.0), rtol=0, atol=1e-12)
    np.testing.assert_allclose(slope_of_it[:, 0], slope(after), rtol=0, atol=1e-6)


def test_what_toes_receive_until_their_impact_is_over():
    """Values, and derivatives along one direction, are added up alike while an impact lasts."""
    nothing, (first, second, third) = np.zeros((3, 2)), np.random.default_rng(5).normal(size=(3, 2, 3, 2))
    found = Overlap(0.01, nothing)
    found.add(TOES, {"left"}, first, 0.0)
    np.testing.assert_array_equal(found.received(TOES, 0.005), [first[0], nothing])
    found.add(TOES, {"right"}, second, 0.004)
    np.testing.assert_array_equal(found.received(TOES, 0.009), [first[0] + second[0], second[1]])
    np.testing.assert_array_equal(found.received(TOES, 0.012), [nothing, second[1]])
    found.add(TOES, set(), third, 0.012)
    np.testing.assert_array_equal(found.received(TOES, 0.013), [nothing, second[1] + third[1]])
    assert not found.received(TOES, 1.0).any()


class TestRefused:
    def test_an_impact_on_the_border(self):
        for seed in range(40):
            feet, slopes = toes(randomly(seed, 5.0))
            impulse, modes, _ = find_impulses(feet.inverse_inertia, feet.speeds, 5.0)
            if modes == ("stick", "stick"):
                break
        friction = max(np.hypot(x, y) / z for x, y, z in impulse)
        edge = feet._replace(friction=np.array(friction * (1.0 + 1e-13)))
        with pytest.raises(NotDifferentiable, match="border"):
            differentiate_strike_in_space(edge, slopes, TOES, TOES, (), np.zeros((2, 3, 2)))

    def test_toes_that_depend_on_each_other(self):
        feet, slopes = toes(randomly(1, 5.0))
        twice = feet._replace(inverse_inertia=np.tile(feet.inverse_inertia[:3, :3], (2, 2)))
        with pytest.raises(NotDifferentiable, match="independently"):
            differentiate_strike_in_space(twice, slopes, TOES, TOES, (), np.zeros((2, 3, 2)))

    def test_a_slide_whose_direction_turns_in_the_impact(self):
        feet, slopes = toes(randomly(1, 0.05))
        one = ToeNumbers(
            feet.friction, feet.heights[:1], feet.rows[:1], feet.responses[:1], feet.inverse_inertia[:3, :3],
            feet.speeds[:3],
        )  # fmt: skip
        with pytest.raises(NotDifferentiable, match="Keller"):
            differentiate_strike_in_space(one, slopes, ("left",), ("left",), (), None)
