"""Newton's method and differences alone, on functions whose roots are known."""

import math

import numpy as np
import pytest

from spear_pin.hybrid.newton import (
    CONVERGED,
    NO_NEIGHBOUR,
    NO_PROGRESS,
    NO_START,
    STEP,
    TOO_LONG,
    broyden,
    jacobian,
    newton,
    root,
)


class Asked:
    """An evaluator of functions, one for each lane, that counts its calls; NaN is no value."""

    def __init__(self, *functions):
        self.functions, self.calls, self.rows = functions, [], 0

    def __call__(self, lanes, x):
        self.calls.append(np.asarray(lanes).tolist())
        self.rows += len(x)
        values = np.array([self.functions[lane](row) for lane, row in zip(lanes, x, strict=True)]).reshape(x.shape)
        return values, np.where(np.isnan(values).any(axis=1), "nothing", "").astype(object)


def solve(functions, start, tolerance=1e-12, **options):
    start = np.array(start, dtype=float).reshape(len(functions), -1)
    asked = Asked(*functions)
    return newton(asked, start, np.ones_like(start), tolerance, **options), asked


def logarithm(x):
    return np.log(x) if x > 0 else np.full(1, math.nan)


def hyperbola(x):
    return np.array([x[0] ** 2 - 2.0, x[0] * x[1] - 1.0])


@pytest.mark.parametrize("shear", [0.0, 300.0])
def test_a_stretched_residual_takes_hardly_more_steps(shear):
    """Newton's steps do not depend on linear combinations of the equations; how they are judged should not, either."""
    matrix = np.array([[1.0, shear], [0.0, 1.0]])

    def function(x):
        return matrix @ [np.exp(x[0]) - 2.0 + x[1] ** 2, x[1] + 0.5 * x[0] ** 2 - 0.1]

    def slopes(lanes, x):
        return np.array([matrix @ [[np.exp(a), 2.0 * b], [a, 1.0]] for a, b in x])

    roots, _ = solve([function], [1.5, 1.0], 1e-10, slopes=slopes)
    assert roots.end[0] == CONVERGED and roots.iteration[0] <= 7


class TestExactJacobians:
    @staticmethod
    def slopes(lanes, x):
        return np.array([[[2.0 * a, 0.0], [b, a]] for a, b in x])

    def test_no_function_is_differenced(self):
        """A value for each iterate, of which the errors are squares of those before."""
        told = []
        roots, asked = solve(
            [hyperbola], [1.2, 1.0], slopes=self.slopes, on_iterates=lambda lanes, n, norm: told.append(norm[0])
        )
        np.testing.assert_allclose(roots.x, [[math.sqrt(2), math.sqrt(0.5)]], rtol=1e-14)
        assert asked.rows == len(told) == roots.iteration[0] + 1
        assert all(after < before**2 + 1e-14 for before, after in zip(told, told[1:], strict=False))

    def test_they_are_of_scaled_unknowns(self):
        start, scale = np.array([[1.2, 1.0]]), np.array([[1e3, 1e-2]])
        asked = Asked(hyperbola)
        roots = newton(asked, start, scale, 1e-12, slopes=self.slopes)
        np.testing.assert_allclose(roots.x, [[math.sqrt(2), math.sqrt(0.5)]], rtol=1e-12)
        assert asked.rows == roots.iteration[0] + 1

    def test_those_that_are_not_known_are_differenced(self):
        """In one lane of two: each goes as it would alone."""

        def slopes(lanes, x):
            found = self.slopes(lanes, x)
            found[lanes == 1] = math.nan
            return found

        roots, asked = solve([hyperbola] * 2, [[1.2, 1.0]] * 2, slopes=slopes)
        alone, own = solve([hyperbola], [[1.2, 1.0]])
        assert roots.end.tolist() == [CONVERGED] * 2
        assert roots.x[1].tolist() == alone.x[0].tolist() and roots.iteration[1] == alone.iteration[0]
        assert asked.rows == own.rows + roots.iteration[0] + 1


class TestOneLane:
    def test_finds_a_root(self):
        roots, _ = solve([hyperbola], [1.0, 1.0])
        np.testing.assert_allclose(roots.x, [[math.sqrt(2), math.sqrt(0.5)]], rtol=1e-12)
        assert roots.end.tolist() == [CONVERGED] and roots.norm[0] <= 1e-12 and roots.reason.tolist() == [""]

    def test_steps_back_from_where_the_function_has_no_value(self):
        seen = []
        roots, _ = solve([lambda x: seen.append(x[0]) or logarithm(x)], [5.0])
        assert roots.x[0, 0] == pytest.approx(1.0, abs=1e-12)
        assert min(seen) < 0.0

    def test_tells_of_its_iterates(self):
        told = []
        options = {"on_iterates": lambda *at: told.append([part.tolist() for part in at])}
        roots, _ = solve([lambda x: x - 1.0], [0.0], 1e-9, **options)
        assert [iteration for _, iteration, _ in told] == [[i] for i in range(roots.iteration[0] + 1)]
        assert told[0] == [[0], [0], [1.0]] and told[-1][2] == [roots.norm[0]]

    @pytest.mark.parametrize(
        ("function", "end", "reason"),
        [
            (lambda x: np.full(1, math.nan), NO_START, "nothing"),
            (lambda x: x if x == 1.0 else np.full(1, math.nan), NO_NEIGHBOUR, "nothing"),
            (lambda x: 1.0 + x**2, NO_PROGRESS, ""),
            (lambda x: x**9, TOO_LONG, ""),
        ],
    )
    def test_failures(self, function, end, reason):
        roots, _ = solve([function], [1.0])
        assert (roots.end.tolist(), roots.reason.tolist()) == ([end], [reason])

    def test_gives_up_where_the_residual_is_not_halved_in_seven_steps(self):
        roots, _ = solve([lambda x: x**-0.02], [1.0])
        assert roots.iteration.tolist() == [7] and 0.5 < roots.norm[0] < 0.7

    def test_the_last_iteration_counts(self):
        for iterations, end in ((1, CONVERGED), (0, TOO_LONG)):
            roots, _ = solve([lambda x: x - 1.0], [0.0], 1e-6, iterations=iterations)
            assert roots.end.tolist() == [end] and roots.iteration.tolist() == [iterations]

    def test_is_content_with_what_noise_allows(self):
        """No step lessens the residual below a floor; within ten tolerances that is the root."""
        for floor, end in ((5e-9, CONVERGED), (2e-8, NO_PROGRESS)):
            roots, _ = solve([lambda x, floor=floor: np.maximum(np.abs(x), floor)], [0.3], 1e-9)
            assert roots.end.tolist() == [end] and roots.norm[0] == floor

    def test_unknowns_are_scaled(self):
        """Differences are STEP of the scale of each."""
        seen = []

        def evaluate(lanes, x):
            seen.append(x.copy())
            return x - [[1e6, 1e-3]], np.full(len(x), "", dtype=object)

        roots = newton(evaluate, np.array([[2e6, 0.0]]), np.array([[1e6, 1e-3]]), 1e-6)
        np.testing.assert_allclose(roots.x, [[1e6, 1e-3]], rtol=1e-9)
        np.testing.assert_allclose(seen[1] - seen[0], STEP * np.diag([1e6, 1e-3]), rtol=1e-4)

    def test_converges_quadratically_with_fresh_jacobians(self):
        norms = []
        function = lambda x: np.array([x[0] ** 2 - 2.0, math.exp(x[1]) - 3.0 * x[0]])  # noqa: E731
        solve([function], [1.8, 1.2], 1e-11, quick=0.0, on_iterates=lambda n, i, norm: norms.append(norm.tolist()))
        norms = [norm for (norm,) in norms]
        # forward differences are off by 1e-5, which adds that much of the last residual
        assert len(norms) >= 4
        assert all(after < before**2 + 1e-4 * before for before, after in zip(norms[:-1], norms[1:], strict=True))

    def test_updates_save_evaluations(self):
        """Broyden's method takes more steps, each of which is one evaluation."""

        def function(x):
            return x**3 + np.roll(x, 1) - 2.0 - 0.1 * np.arange(6)

        (updated, few), (fresh, many) = (solve([function], np.full(6, 1.1), quick=quick) for quick in (0.2, 0.0))
        np.testing.assert_allclose(updated.x, fresh.x, rtol=0, atol=1e-11)
        assert updated.iteration[0] > fresh.iteration[0] and few.rows < 0.7 * many.rows


class TestLanes:
    FUNCTIONS = (
        lambda x: x**2 - 2.0,
        lambda x: x - 1.0,  # at the root from the start
        logarithm,
        lambda x: np.full(1, math.nan),
        lambda x: 1.0 + x**2,
        lambda x: x if x == 1.0 else np.full(1, math.nan),
    )
    START = np.array([[1.0], [1.0], [5.0], [1.0], [1.0], [1.0]])
    ENDS = (CONVERGED, CONVERGED, CONVERGED, NO_START, NO_PROGRESS, NO_NEIGHBOUR)

    def test_each_ends_for_itself(self):
        roots, _ = solve(self.FUNCTIONS, self.START)
        assert roots.end.tolist() == list(self.ENDS)
        np.testing.assert_allclose(roots.x[:3, 0], [math.sqrt(2), 1.0, 1.0], rtol=1e-12)
        assert roots.iteration[1] == 0 and np.isinf(roots.norm[3])
        assert roots.reason.tolist() == ["", "", "", "nothing", "", "nothing"]

    @pytest.mark.parametrize("n", [1, 64])
    def test_has_the_digits_that_it_has_alone(self, n):
        lanes = np.arange(n) % len(self.FUNCTIONS)
        together, _ = solve([self.FUNCTIONS[i] for i in lanes], self.START[lanes])
        for i in range(n):
            alone, _ = solve([self.FUNCTIONS[lanes[i]]], self.START[lanes[i]])
            for name in ("x", "norm", "iteration", "end", "reason"):
                np.testing.assert_array_equal(getattr(together, name)[i], getattr(alone, name)[0])

    def test_trial_steps_and_differences_share_calls(self):
        """As many as the lane takes that takes longest."""
        together, asked = solve(self.FUNCTIONS[:3], self.START[:3])
        alone = [
            solve([function], start)[1] for function, start in zip(self.FUNCTIONS[:3], self.START[:3], strict=True)
        ]
        assert len(asked.calls) == max(len(each.calls) for each in alone)
        assert asked.rows == sum(each.rows for each in alone)
        assert asked.calls[0] == [0, 1, 2] and 1 not in sum(asked.calls[1:], [])

    def test_within_a_number_of_calls(self):
        roots, asked = solve(self.FUNCTIONS[:2], self.START[:2], calls=2)
        assert len(asked.calls) == 2 and roots.end.tolist() == [TOO_LONG, CONVERGED]

    def test_of_none(self):
        roots = newton(Asked(), np.empty((0, 3)), np.empty((0, 3)), 1e-9)
        assert roots.x.shape == (0, 3) and roots.end.shape == (0,)


class TestDifferences:
    def test_are_of_second_order(self):
        asked = Asked(lambda x: np.array([x[0] ** 2 * x[1], x[1] ** 3]))
        found, why = jacobian(asked, np.array([2.0, 3.0]), 1e-2)
        np.testing.assert_allclose(found - [[12.0, 4.0], [0.0, 27.0]], [[0, 0], [0, 1e-4]], rtol=0, atol=1e-10)
        assert why == "" and asked.rows == 4

    def test_say_why_there_are_none(self):
        _, why = jacobian(Asked(lambda x: np.log(x) if x > 1.0 else x * math.nan), np.ones(1))
        assert why == "nothing"

    def test_broyden_meets_the_last_step_and_changes_nothing_across_it(self):
        before, step, change = np.diag([2.0, 3.0])[None], np.array([[0.1, 0.0]]), np.array([[0.3, 0.1]])
        after = broyden(before, step, change)[0]
        np.testing.assert_allclose(after @ step[0], change[0], rtol=1e-14)
        np.testing.assert_array_equal(after[:, 1], before[0, :, 1])


class TestMoreUnknownsThanEquations:
    """A circle of radius 2, from outside: each step is the shortest that solves the linear equation."""

    START = np.array([[6.0, 8.0]])

    @staticmethod
    def circle(lanes, x):
        return (x * x).sum(axis=1, keepdims=True) - 4.0, np.full(len(x), "", dtype=object)

    @staticmethod
    def slopes(lanes, x):
        return 2.0 * x[:, None, :]

    @pytest.mark.parametrize("slopes", [None, "exact"])
    def test_the_nearest_root_is_found(self, slopes):
        given = {"slopes": self.slopes} if slopes else {}
        found = newton(self.circle, self.START, np.ones((1, 2)), 1e-12, equations=1, **given)
        assert found.end[0] == CONVERGED
        np.testing.assert_allclose(found.x, [[1.2, 1.6]], rtol=0, atol=1e-6 if slopes is None else 1e-12)

    def test_steps_are_no_longer_than_allowed(self):
        seen = []

        def circle(lanes, x):
            seen.extend(x.tolist())
            return self.circle(lanes, x)

        found = newton(
            circle, self.START, np.ones((1, 2)), 1e-12, slopes=self.slopes, equations=1, longest=0.5, iterations=40
        )
        assert found.end[0] == CONVERGED
        assert np.abs(np.diff(np.array(seen), axis=0)).max() == pytest.approx(0.5)

    def test_jacobians_are_updated_while_steps_reduce_the_residual_a_lot(self):
        """Where it need not always be asked for."""
        counts = {}
        for always in (True, False):
            asked = []

            def slopes(lanes, x, asked=asked):
                asked.append(x)
                return self.slopes(lanes, x)

            start = np.array([[1.3, 1.65]])
            found = newton(self.circle, start, np.ones((1, 2)), 1e-12, slopes=slopes, equations=1, always=always)
            assert found.end[0] == CONVERGED
            counts[always] = len(asked)
        assert counts[False] < counts[True]


def test_points_of_any_kind_have_coordinates_of_their_own():
    """A point of the unit circle with a given height; beyond half of it the angle about a point counts twice."""

    def about(z):
        return np.array([z.imag - 0.6]), np.array([[0.5 * z.real] * 2 if z.imag > 0.5 else [z.real]])

    def ahead(z, step):
        return z * np.exp(1j * (step[0] if len(step) == 1 else step.mean()))

    found, off = root(about, ahead, 1.0 + 0.0j, 1e-14, size=3, calls=8)
    assert off <= 1e-14 and found == pytest.approx(0.8 + 0.6j, abs=1e-12)
    nearer, off = root(about, ahead, 1.0 + 0.0j, 1e-14, size=3, calls=2)
    assert 1e-3 < off == abs(nearer.imag - 0.6) < 0.1


def test_a_point_without_a_derivative_ends_where_it_began():
    found, off = root(lambda x: (x - 1.0, np.full((1, 1), np.nan)), np.add, np.zeros(1), 1e-9, size=1, calls=3)
    assert off == np.inf and found == 0.0
