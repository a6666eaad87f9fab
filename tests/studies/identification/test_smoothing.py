"""The moving average: against sums by hand, NumPy and SciPy, and against its own adjoint."""

import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d

from spear_pin.errors import BadValue, UnknownName
from spear_pin.studies.identification import MovingAverage

KINDS = ("centred", "causal")
CASES = [(n, window, kind) for n in (1, 2, 7, 60) for window in (1, 2, 5, 8, 60, 200) for kind in KINDS]
each_case = pytest.mark.parametrize(("n", "window", "kind"), CASES)


def by_hand(x, window, kind):
    """Means one after the other."""
    past = window // 2 if kind == "centred" else window - 1
    return np.array([x[max(i - past, 0) : i - past + window].mean(axis=0) for i in range(len(x))])


def dense(n, window, kind):
    """F as a matrix."""
    return by_hand(np.eye(n), window, kind)


class TestMean:
    @each_case
    def test_by_hand(self, n, window, kind):
        x = np.random.default_rng(n).normal(size=(n, 3))
        smooth = MovingAverage(window, kind)
        np.testing.assert_allclose(smooth(x), by_hand(x, window, kind), rtol=0, atol=1e-14)
        np.testing.assert_allclose(smooth(x[:, 0]), smooth(x)[:, 0], rtol=0, atol=1e-15)

    @pytest.mark.parametrize("window", [3, 4, 100, 101])
    def test_numpy_and_scipy_inside(self, window):
        x = np.random.default_rng(1).normal(size=1000)
        inside = slice(window, -window)
        centred, causal = (MovingAverage(window, kind)(x) for kind in KINDS)
        # scipy's even window reaches one sample further into the past, too
        np.testing.assert_allclose(centred[inside], uniform_filter1d(x, window)[inside], rtol=0, atol=1e-13)
        np.testing.assert_allclose(
            causal[window - 1 :], np.convolve(x, np.full(window, 1 / window), "valid"), rtol=0, atol=1e-13
        )

    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("value", [0.0, 0.1, -7.3, 1e12, 1 / 3])
    def test_constants_stay(self, value, kind):
        np.testing.assert_allclose(MovingAverage(100, kind)(np.full(777, value)), value, rtol=3e-16, atol=0)

    @pytest.mark.parametrize("kind", KINDS)
    def test_large_offsets_lose_no_digits(self, kind):
        x = np.random.default_rng(2).integers(-1000, 1000, 5000) / 1024.0
        offset = 2.0**20
        shifted = MovingAverage(100, kind)(x + offset) - offset
        np.testing.assert_allclose(shifted, by_hand(x, 100, kind), rtol=0, atol=3e-10)

    def test_impulse(self):
        x = np.zeros(21)
        x[10] = 1.0
        assert np.flatnonzero(MovingAverage(4)(x) > 0.1).tolist() == [9, 10, 11, 12]
        assert np.flatnonzero(MovingAverage(5)(x) > 0.1).tolist() == [8, 9, 10, 11, 12]
        assert np.flatnonzero(MovingAverage(4, "causal")(x) > 0.1).tolist() == [10, 11, 12, 13]

    @pytest.mark.parametrize("kind", KINDS)
    @pytest.mark.parametrize("window", [1, 4, 5, 100])
    def test_ahead(self, window, kind):
        x = np.zeros(300)
        x[200] = 1.0
        first = np.flatnonzero(MovingAverage(window, kind)(x) > 0.5 / window)[0]
        assert MovingAverage(window, kind).ahead == 200 - first

    @pytest.mark.parametrize(
        ("window", "kind", "delay"),
        [(5, "centred", 0.0), (100, "centred", 0.5), (5, "causal", 2.0), (100, "causal", 49.5)],
    )
    def test_delay(self, window, kind, delay):
        line = np.arange(500.0)
        np.testing.assert_allclose((line - MovingAverage(window, kind)(line))[150:-150], delay, rtol=0, atol=1e-10)


class TestAdjoint:
    @each_case
    def test_is_the_transpose(self, n, window, kind):
        smooth, matrix = MovingAverage(window, kind), dense(n, window, kind)
        x = np.random.default_rng(n).normal(size=(n, 2))
        np.testing.assert_allclose(smooth.adjoint(x), matrix.T @ x, rtol=0, atol=1e-13)
        np.testing.assert_allclose(smooth.gain(n), np.diag(matrix @ matrix.T), rtol=1e-13)

    @pytest.mark.parametrize("kind", KINDS)
    def test_identity(self, kind):
        x, y = np.random.default_rng(3).normal(size=(2, 3001))
        smooth = MovingAverage(100, kind)
        assert smooth(x) @ y == pytest.approx(x @ smooth.adjoint(y), rel=1e-12)

    @pytest.mark.parametrize("kind", KINDS)
    def test_gain_is_the_power_that_noise_keeps(self, kind):
        smooth = MovingAverage(10, kind)
        noise = np.random.default_rng(4).normal(size=(200, 4000))
        assert (smooth(noise) ** 2).sum(axis=0).mean() == pytest.approx(smooth.gain(200).sum(), rel=0.03)


class TestArguments:
    @pytest.mark.parametrize("window", [0, -1, 1.5, 10**6 + 1, True, "100", None, float("nan")])
    def test_window(self, window):
        with pytest.raises(BadValue, match="window is"):
            MovingAverage(window)

    def test_kind(self):
        with pytest.raises(UnknownName, match="'median'; valid: centred, causal"):
            MovingAverage(100, "median")

    def test_default_is_that_of_the_source(self):
        assert MovingAverage() == MovingAverage(100, "centred")

    def test_input_is_left_alone(self):
        x = np.arange(10)
        MovingAverage(3)(x)
        MovingAverage(3).adjoint(x)
        assert x.tolist() == list(range(10))
