"""The search of least squares, what it refuses, and its doubts, on problems that are solved by hand."""

from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin.errors import BadValue
from spear_pin.studies.fitting import doubt, search, tell_apart

T = np.linspace(0.0, 1.0, 200)


def test_the_search_asks_once_for_residuals_and_slopes():
    jacobian, calls, told = np.column_stack([T, np.ones(200)]), [], []

    def linearized(x):
        calls.append(x.copy())
        return jacobian @ (x - (2.0, -1.0)), jacobian

    bounds = np.array([-9.0, -9.0]), np.array([1.5, 9.0])
    found = search(linearized, np.zeros(2), bounds, 1e-12, 50, lambda n, rms: told.append((n, rms)))
    held = np.linalg.lstsq(jacobian[:, 1:], jacobian @ (0.5, 1.0), rcond=None)[0] - 2.0  # with the first at its bound
    assert found.x == pytest.approx([1.5, held[0]], abs=1e-6) and found.active_mask.tolist() == [1, 0]
    assert len({each.tobytes() for each in calls}) == len(calls) == len(told)
    assert [count for count, _ in told] == [*range(1, len(told) + 1)]
    assert told[0] == (1, pytest.approx(np.sqrt(np.mean((jacobian @ (2.0, -1.0)) ** 2))))


def test_what_others_explain_is_taken_off():
    scaled, lengths = tell_apart("over", ["a"], np.column_stack([T + 3.0, np.ones(200)]))
    assert lengths == pytest.approx(np.linalg.norm(T - T.mean())) and scaled[:, 0] @ np.ones(200) == pytest.approx(0.0)


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ([T, 0.0 * T, T**2], "the data say nothing of b; hold one"),
        ([T, T**2, 3.0 * T], "the data do not tell a and c apart; hold one"),
    ],
)
def test_what_the_data_do_not_tell_is_refused(columns, said):
    with pytest.raises(BadValue, match=f"over is .'a', 'b', 'c'.; expected fewer of them: {said}"):
        tell_apart("over", ["a", "b", "c"], np.column_stack(columns))


def test_fewer_samples_than_values_are_refused():
    with pytest.raises(BadValue, match="vary is"):
        tell_apart("vary", ["a", "b", "c"], np.eye(3)[:2])


def test_doubts():
    solution = SimpleNamespace(success=False, nfev=60, x=np.array([1.0, 45.0, 0.0]), active_mask=[0, 1, 0])
    correlation = np.array([[1.0, -0.99], [-0.99, 1.0]])
    assert [*doubt(solution, dict(zip(["a", "b", "start"], solution.x, strict=True)), correlation)] == [
        "the search did not converge in 60 evaluations",
        "b is at its bound, 45: its deviation means nothing",
        "a and b are hardly told apart (correlation -0.9900): with one held, the other's deviation would be 7 times"
        " less",
    ]


def test_what_others_explain_wholly_is_refused_by_name():
    """But for rounding nothing is left of it."""
    with pytest.raises(BadValue, match="say nothing of a;"):
        tell_apart("over", ["a"], np.column_stack([3.0 * T + 0.1, T, np.ones(200)]))


def test_others_that_are_one_take_nothing_more_off():
    _, once = tell_apart("over", ["a"], np.column_stack([T, np.ones(200)]))
    _, twice = tell_apart("over", ["a"], np.column_stack([T, np.ones(200), np.ones(200), np.zeros(200)]))
    assert twice == pytest.approx(once, rel=1e-12)
