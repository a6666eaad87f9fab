"""Minima that are known in closed form, with multipliers, in regions where there are no values."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from spear_pin.gaits.codesign.step import Local
from spear_pin.gaits.codesign.trust_region import CONVERGED, NO_VALUE, STUCK, UNSOLVED, find_minimum


def problem(f, g, c=lambda x: np.empty(0), A=lambda x: np.empty((0, 2)), inside=lambda x: True):
    calls = []

    def value(x, best=None):
        calls.append(x)
        return Local(x, f(x), c(x), lambda: (g(x), A(x)), None) if inside(x) else None

    return value, calls


def rosenbrock(**more):
    return problem(lambda x: scipy.optimize.rosen(x), lambda x: scipy.optimize.rosen_der(x), **more)


def found(value, start, lower=(-2.0, -2.0), upper=(2.0, 2.0), **options):
    return find_minimum(value, value(np.array(start)), (np.array(lower), np.array(upper)), tolerance=1e-9, **options)


def test_rosenbrock_without_constraints():
    value, calls = rosenbrock()
    end = found(value, (-1.2, 1.0))
    assert end.reason == CONVERGED and len(calls) < 80
    assert end.local.x == pytest.approx([1.0, 1.0], abs=1e-4)


def test_directions_of_unequal_steepness():
    """A first curvature that fits the steep direction hides the other."""
    value, _ = problem(
        lambda x: 0.5 * 1e-3 * float((x[0] - 0.3) ** 2) + float(x[1] ** 2),
        lambda x: np.array([1e-3 * (x[0] - 0.3), 2.0 * x[1]]),
    )
    end = found(value, (-1.9, 1.0))
    assert end.local.f < 1e-6 and end.local.x[1] == pytest.approx(0.0, abs=1e-4)


def test_multiplier_of_a_circle():
    """The nearest point of a disc to (2, 1): x = (2, 1)/√5, and λ = (√5 - 1) / 2 for 1 - x·x >= 0."""
    value, _ = problem(
        lambda x: 0.5 * float((x - [2.0, 1.0]) @ (x - [2.0, 1.0])),
        lambda x: x - [2.0, 1.0],
        lambda x: np.array([1.0 - x @ x]),
        lambda x: -2.0 * x[None],
    )
    end = found(value, (0.0, 0.0))
    assert end.converged and end.local.x == pytest.approx(np.array([2.0, 1.0]) / 5**0.5, abs=1e-6)
    assert end.multipliers == pytest.approx([(5**0.5 - 1.0) / 2.0], abs=1e-5)
    assert not end.at_bounds.any() and end.stationarity < 1e-5


@pytest.mark.parametrize(
    ("stationarity", "reason", "balanced"),
    [(1e-4, STUCK, True), (1.0, STUCK, False), (1.0, CONVERGED, True), (np.inf, CONVERGED, False)],
)
def test_multipliers_are_prices_where_they_balance_the_gradient(stationarity, reason, balanced):
    """An infinite rest says that no multipliers were found."""
    end = found(problem(lambda x: float(x @ x), lambda x: 2.0 * x)[0], (0.0, 0.0))
    assert replace(end, stationarity=stationarity, reason=reason).balanced == balanced


def test_a_curved_border_is_followed_by_long_steps():
    """Of Maratos: by the linear border alone long steps along the circle leave it, and are no better."""
    value, calls = problem(
        lambda x: float(30.0 * (x @ x - 1.0) - x[0]),
        lambda x: 60.0 * x - [1.0, 0.0],
        lambda x: np.array([x @ x - 1.0]),
        lambda x: 2.0 * x[None],
    )
    end = found(value, (np.cos(1.0), np.sin(1.0)))
    assert end.converged and end.local.x == pytest.approx([1.0, 0.0], abs=1e-4)
    assert end.multipliers == pytest.approx([29.5], abs=1e-3)
    assert len(calls) < 50  # more than a hundred, and no end, with short steps alone


def test_multiplier_of_a_bound():
    value, _ = problem(lambda x: float(3.0 * x[0] + x[1] ** 2), lambda x: np.array([3.0, 2.0 * x[1]]))
    end = found(value, (0.5, 1.0))
    assert end.local.x == pytest.approx([-2.0, 0.0], abs=1e-6)
    assert end.at_bounds[0] == pytest.approx([3.0, 0.0], abs=1e-6) and not end.at_bounds[1].any()


def test_begins_where_a_constraint_is_missed():
    value, _ = rosenbrock(c=lambda x: np.array([0.5 - x[0]]), A=lambda x: np.array([[-1.0, 0.0]]))
    end = found(value, (1.8, 1.8))
    assert end.converged and end.local.x == pytest.approx([0.5, 0.25], abs=1e-5)
    assert end.multipliers == pytest.approx([1.0], abs=1e-3)  # of f' along the valley, 2 (1 - x)


def test_constraints_that_cannot_be_met_are_missed_least():
    value, _ = problem(
        lambda x: float(x @ x),
        lambda x: 2.0 * x,
        lambda x: np.array([x[0] - 1.0, -x[0] - 1.0, x[1] - 1.0]),
        lambda x: np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0]]),
    )
    end = found(value, (0.3, 0.0))
    assert end.reason == STUCK and end.local.violation == pytest.approx(2.0, abs=1e-6)
    assert end.local.x[1] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("edge", [0.2, 0.9])
def test_says_where_values_end(edge):
    """The minimum lies where there is no value: it comes as near the edge as it can, and says why it ends."""
    value, calls = problem(
        lambda x: float((x - 1.0) @ (x - 1.0)), lambda x: 2.0 * (x - 1.0), inside=lambda x: x[0] < edge
    )
    end = found(value, (0.0, 0.0))
    assert end.reason == NO_VALUE and edge - 1e-6 < end.local.x[0] < edge
    assert len(calls) < 100


def test_goes_round_a_hole_in_which_there_is_no_value():
    value, _ = problem(
        lambda x: float((x - 1.0) @ (x - 1.0)),
        lambda x: 2.0 * (x - 1.0),
        inside=lambda x: np.hypot(x[0] - 0.3, x[1] - 0.25) > 0.15,
    )
    end = found(value, (-1.0, -1.0))
    assert end.converged and end.local.x == pytest.approx([1.0, 1.0], abs=1e-5)


def test_a_minimum_on_a_kink():
    """Of the larger of two paraboloids, where their gradients are opposite: in shares of 0.477 and 0.523."""
    sides = [
        (lambda x: (x[0] - 1.0) ** 2 + x[1] ** 2 + x[1], lambda x: np.array([2.0 * (x[0] - 1.0), 2.0 * x[1] + 1.0])),
        (lambda x: (x[0] + 1.0) ** 2 + 2.0 * x[1] ** 2, lambda x: np.array([2.0 * (x[0] + 1.0), 4.0 * x[1]])),
    ]
    value, calls = problem(
        lambda x: max(f(x) for f, _ in sides), lambda x: max(sides, key=lambda side: side[0](x))[1](x)
    )
    end = found(value, (-1.2, 1.0))
    assert end.converged and end.local.x == pytest.approx([-0.045328, -0.156744], abs=2e-5) and len(calls) < 60
    assert end.stationarity < 1e-3
    share = sum(price for price, cut in end.kinks if cut.constraint is None)
    assert min(share, 1.0 - share) == pytest.approx(0.4773, abs=1e-3)


def test_a_constraint_with_a_kink():
    """The point of a wedge |x₁| <= 1 - x₀ that is nearest to (2, 0): its edge, by both sides, each at a price of 1."""
    value, _ = problem(
        lambda x: float((x[0] - 2.0) ** 2 + x[1] ** 2),
        lambda x: np.array([2.0 * (x[0] - 2.0), 2.0 * x[1]]),
        lambda x: np.array([1.0 - x[0] - abs(x[1])]),
        lambda x: np.array([[-1.0, -np.sign(x[1])]]),
    )
    end = found(value, (0.2, 0.3))
    assert end.local.x == pytest.approx([1.0, 0.0], abs=1e-6) and end.local.violation < 1e-7
    assert end.multipliers == pytest.approx([2.0], abs=1e-3) and end.stationarity < 1e-3
    assert [cut.constraint for price, cut in end.kinks if price > 1e-3] == [0]


def test_a_share_of_a_kink_that_is_more_than_all_is_given_up():
    """Across the kink the function falls: it is no valley."""
    value, _ = problem(
        lambda x: max(-x[0], -3.0 * x[0]) + float(x[1] ** 2),
        lambda x: np.array([-3.0 if x[0] < 0.0 else -1.0, 2.0 * x[1]]),
    )
    end = found(value, (-1.0, 0.5))
    assert end.converged and end.local.x == pytest.approx([2.0, 0.0], abs=1e-5)


@pytest.mark.parametrize("n", [2, 3, 4])
def test_the_largest_of_random_paraboloids(n):
    """The minimum by linear programming's relative: an epigraph, whose constraints are smooth."""
    random, ended = np.random.default_rng(n), []
    for _ in range(8):
        centres, scales = random.uniform(-1.0, 1.0, (3, n)), random.uniform(0.5, 3.0, (3, n))

        def pieces(x, centres=centres, scales=scales):
            return (scales * (x - centres) ** 2).sum(axis=1)

        def slope(x, centres=centres, scales=scales, pieces=pieces):
            i = int(pieces(x).argmax())
            return 2.0 * scales[i] * (x - centres[i])

        value, _ = problem(lambda x, pieces=pieces: float(pieces(x).max()), slope, A=lambda x: np.empty((0, n)))
        end = found(value, [1.5] * n, [-2.0] * n, [2.0] * n)
        top = scipy.optimize.minimize(
            lambda z: z[-1],
            [1.5] * n + [60.0],
            constraints={"type": "ineq", "fun": lambda z, pieces=pieces: z[-1] - pieces(z[:-1])},
            method="SLSQP",
            options={"ftol": 1e-12},
        )
        ended.append(end.reason)
        assert end.local.f == pytest.approx(top.fun, rel=1e-4)
    assert UNSOLVED not in ended and CONVERGED in ended
