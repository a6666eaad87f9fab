"""Error bars against a linear problem whose estimates are computed many times over, and by dense matrices."""

import numpy as np
import pytest
import scipy

from spear_pin.studies.identification import MovingAverage
from spear_pin.studies.identification.uncertainty import nrmse_fit, scatter, whiteness

RNG = np.random.default_rng(7)
SIZES = (150, 90)
T = [np.linspace(0, 1, n) for n in SIZES]
MODELS = [np.column_stack([np.exp(-3 * t) * np.cos(15 * t), 100 * t * np.exp(-3 * t), np.ones_like(t)]) for t in T]
NOISE = 0.02
SMOOTHINGS = {
    "none": (None, None),
    "centred": (MovingAverage(20), MovingAverage(20)),
    "causal": (MovingAverage(20, "causal"), MovingAverage(11, "causal")),
    "one of two": (None, MovingAverage(30)),
}
each_smoothing = pytest.mark.parametrize("name", SMOOTHINGS)


def dense(smoothings):
    """F for all records as one matrix."""
    matrix = np.zeros((sum(SIZES), sum(SIZES)))
    ends = np.cumsum(SIZES)
    for smoothing, n, end in zip(smoothings, SIZES, ends, strict=True):
        matrix[end - n : end, end - n : end] = np.eye(n) if smoothing is None else smoothing(np.eye(n))
    return matrix


def problem(name, smooth_model=True):
    """F, its records' smoothings, Jacobians as they are fitted, and the estimator's matrix."""
    smoothings = SMOOTHINGS[name]
    jacobians = [m if f is None or not smooth_model else f(m) for f, m in zip(smoothings, MODELS, strict=True)]
    jacobian = np.vstack(jacobians)
    return dense(smoothings), smoothings, jacobians, np.linalg.solve(jacobian.T @ jacobian, jacobian.T)


def split(values):
    return np.split(values, [SIZES[0]])


class TestScatter:
    @pytest.mark.parametrize("smooth_model", [True, False])
    @each_smoothing
    def test_formula(self, name, smooth_model):
        f, smoothings, jacobians, estimator = problem(name, smooth_model)
        residuals = RNG.normal(size=sum(SIZES))
        found = scatter(split(residuals), jacobians, smoothings)
        rest = (np.eye(sum(SIZES)) - np.vstack(jacobians) @ estimator) @ f
        # tr FFᵀ - tr PFFᵀ = tr (1 - P) FFᵀ
        variance = residuals @ residuals / np.trace(rest @ f.T)
        expected = variance * estimator @ f @ f.T @ estimator.T
        assert found.noise == pytest.approx(np.sqrt(variance), rel=1e-10)
        deviation = np.sqrt(np.diag(expected))
        np.testing.assert_allclose(
            found.covariance / np.outer(deviation, deviation),
            expected / np.outer(deviation, deviation),
            rtol=0,
            atol=1e-10,
        )
        lengths = np.linalg.norm(np.vstack(jacobians), axis=0)
        assert found.condition == pytest.approx(np.linalg.cond(np.vstack(jacobians) / lengths), rel=1e-10)

    @pytest.mark.slow
    @pytest.mark.parametrize("known", [False, True])
    @each_smoothing
    def test_many_times_over(self, name, known):
        f, smoothings, jacobians, estimator = problem(name)
        count = 4000
        noise = NOISE * np.random.default_rng(1).normal(size=(sum(SIZES), count))
        estimates = estimator @ f @ noise  # of the truth 0
        residuals = np.vstack(jacobians) @ estimates - f @ noise
        before = np.vstack(MODELS) @ estimates - noise
        found = [
            scatter(split(residuals[:, i]), jacobians, smoothings, unsmoothed=split(before[:, i]) if known else None)
            for i in range(400)
        ]
        variances = np.array([each.noise**2 for each in found])
        # within four standard errors of the mean, and a per cent for the parameters that smoothing blurs
        error = 4 * variances.std() / np.sqrt(variances.size) / NOISE**2
        assert variances.mean() / NOISE**2 == pytest.approx(1.0, abs=error + 0.01)
        covariance = np.mean([each.covariance for each in found], axis=0)
        deviation = np.sqrt(np.diag(covariance))
        relative = np.outer(deviation, deviation)
        np.testing.assert_allclose(covariance / relative, np.cov(estimates) / relative, rtol=0, atol=0.08)

    def test_smoothing_that_is_not_counted_would_be_far_off(self):
        f, smoothings, jacobians, estimator = problem("centred")
        residuals = f @ RNG.normal(size=sum(SIZES))
        right, wrong = (scatter(split(residuals), jacobians, each) for each in (smoothings, (None, None)))
        assert (np.sqrt(np.diag(right.covariance)) > 2.5 * np.sqrt(np.diag(wrong.covariance))).all()

    @pytest.mark.parametrize("kind", ["centred", "causal"])
    def test_some_samples_only(self, kind):
        smoothings = (MovingAverage(20, kind), None)
        used = [np.arange(n) < n - 25 for n in SIZES]
        keep = np.diag(np.concatenate(used).astype(float))
        f, jacobian = dense(smoothings), np.vstack(MODELS)
        j = keep @ f @ jacobian
        estimator = np.linalg.solve(j.T @ j, j.T)
        residuals = keep @ RNG.normal(size=sum(SIZES))
        found = scatter(split(residuals), split(j), smoothings, used=used)
        rest = keep @ f - j @ estimator @ keep @ f
        variance = residuals @ residuals / np.trace(rest @ rest.T)
        assert found.noise == pytest.approx(np.sqrt(variance), rel=1e-10)
        expected = variance * estimator @ f @ f.T @ estimator.T
        np.testing.assert_allclose(np.diag(found.covariance), np.diag(expected), rtol=1e-9)

    @each_smoothing
    def test_correlated_errors(self, name):
        f, smoothings, jacobians, estimator = problem(name)
        residuals, factors = split(RNG.normal(size=sum(SIZES))), [RNG.normal(size=(sum(SIZES), n)) for n in (1, 3)]
        alone, found = (scatter(residuals, jacobians, smoothings, correlated=each) for each in ((), factors))
        through = estimator @ f @ np.hstack(factors)
        np.testing.assert_allclose(found.covariance, alone.covariance + through @ through.T, rtol=1e-9, atol=1e-12)
        expected = np.sqrt(np.diag(found.covariance) / np.diag(alone.covariance))
        np.testing.assert_allclose(found.inflation, expected, rtol=1e-12)
        assert found.noise == alone.noise and (alone.inflation == 1.0).all()

    def test_units_do_not_matter(self):
        _, smoothings, jacobians, _ = problem("centred")
        residuals = split(RNG.normal(size=sum(SIZES)))
        scale = np.array([1e6, 1e-7, 3.0])
        one, other = (scatter(residuals, [j * s for j in jacobians], smoothings) for s in (np.ones(3), scale))
        np.testing.assert_allclose(other.covariance * np.outer(scale, scale), one.covariance, rtol=1e-9)
        assert other.condition == pytest.approx(one.condition, rel=1e-9)

    def test_robust(self):
        jacobians, size = MODELS, sum(SIZES)
        residuals = RNG.normal(size=size)
        weight = 1 / np.sqrt(np.maximum((residuals / 1.345) ** 2, 1.0))
        slope = (np.abs(residuals) <= 1.345).astype(float)
        found = scatter(split(residuals), jacobians, (None, None), influence=(weight * residuals, slope))
        jacobian = np.vstack(jacobians)
        psi = weight * residuals
        variance = psi @ psi / slope.mean() ** 2 / (size - 3)  # Huber
        np.testing.assert_allclose(found.covariance, variance * np.linalg.inv(jacobian.T @ jacobian), rtol=1e-9)


class TestWhiteness:
    def test_uniform_for_white_noise(self):
        rng = np.random.default_rng(2)
        found = [whiteness([rng.normal(size=400), rng.normal(size=600) * 3 + 1]) for _ in range(400)]
        assert scipy.stats.kstest(found, "uniform").pvalue > 0.01

    @pytest.mark.parametrize("share", [0.3, -0.3, 0.9])
    def test_small_for_correlated_noise(self, share):
        noise = np.random.default_rng(3).normal(size=1000)
        for i in range(1, noise.size):
            noise[i] += share * noise[i - 1]
        assert whiteness([noise]) < 1e-6
        assert whiteness([noise, np.random.default_rng(4).normal(size=1000)]) < 1e-3

    def test_one_record_after_another_is_not_mixed(self):
        noise = np.random.default_rng(5).normal(size=500)
        assert whiteness([noise, noise]) > 1e-3

    def test_by_hand(self):
        r = np.array([1.0, -2.0, 0.5, 3.0, -1.0, 0.0, 2.0, -2.5, 1.0, 0.3])
        c = r - r.mean()
        statistic = 10 * 12 * sum((c[k:] @ c[:-k] / (c @ c)) ** 2 / (10 - k) for k in (1, 2))
        assert whiteness([r]) == pytest.approx(np.exp(-statistic / 2))  # of χ² with two degrees

    def test_nothing(self):
        assert whiteness([np.zeros(100)]) == 1.0 and whiteness([]) == 1.0


class TestFit:
    def test_as_matlab_defines_it(self):
        measured, predicted = np.array([1.0, 2.0, 3.0, 6.0]), np.array([1.5, 2.0, 2.0, 6.0])
        missed, spread = np.sqrt(0.25 + 1.0), np.sqrt(4 + 1 + 0 + 9)
        assert nrmse_fit(measured, predicted) == pytest.approx(100 * (1 - missed / spread))

    def test_ends(self):
        measured = np.arange(5.0)
        assert nrmse_fit(measured, measured) == 100.0
        assert nrmse_fit(measured, np.full(5, 2.0)) == pytest.approx(0.0)
        assert nrmse_fit(measured, -measured) < 0
        assert nrmse_fit(np.ones(5), measured) == -np.inf
