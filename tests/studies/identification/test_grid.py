"""The grid of a record's samples: found where there is one, whatever a few of them do, and none where there is none."""

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from spear_pin.studies.identification.grid import grid_step

often = settings(max_examples=60, derandomize=True, deadline=None)
seeds = st.integers(0, 2**32 - 1)


def motion(seed):
    """A hold, a release and a swing, in rad, and what draws at random."""
    rng = np.random.default_rng(seed)
    t = np.arange(-rng.uniform(0.1, 1.0), rng.uniform(1.0, 3.0), 1 / rng.choice([250.0, 500.0, 1000.0]))
    after, decay = np.maximum(t, 0.0), rng.uniform(1.0, 8.0)
    return 1.24 + rng.uniform(0.1, 0.4) * np.exp(-decay * after) * np.cos(rng.uniform(10.0, 16.0) * after), rng


@st.composite
def motions(draw):
    return motion(draw(seeds))


def counted(angle, rng):
    """The angle in counts of an encoder with little noise or none, and their step."""
    step = 2 * np.pi / rng.integers(400, 6000)
    noise = rng.choice([0.0, 0.1, 1.0]) * step * rng.normal(size=angle.size)
    return step * (np.round((angle + noise) / step) + rng.uniform()), step


@often
@given(motions())
def test_counts(drawn):
    angle, step = counted(*drawn)
    assert grid_step(angle) == pytest.approx(step, rel=1e-6)


@often
@given(seeds, st.floats(0.0, 0.01))
@example(498, 0.01)  # on a grid of few points, some samples between them
@example(2936, 0.01)
@example(3333, 0.01)
def test_counts_of_which_some_are_off(seed, share):
    """Interpolated, disturbed or far out, up to one in a hundred; of few samples one."""
    drawn = motion(seed)
    (angle, step), rng = counted(*drawn), drawn[1]
    chosen = rng.choice(angle.size, max(1, int(share * angle.size)), replace=False)
    angle[chosen] += step * rng.uniform(-1.0, 1.0, chosen.size)
    angle[chosen[0]] += rng.choice([0.0, 0.1, -3.0, 1e6])
    assert grid_step(angle) == pytest.approx(step, rel=1e-2)


@often
@given(motions(), st.sampled_from([0.01, 0.001, np.radians(0.1)]))
def test_decimal_digits(drawn, step):
    """Of radians or degrees."""
    assert grid_step(np.round(drawn[0] / step) * step) == pytest.approx(step, rel=1e-6)


@pytest.mark.slow
@often
@given(motions(), st.sampled_from([0.0, 1e-5, 1e-4, 1e-3, 1e-2]))
def test_what_was_not_rounded(drawn, noise):
    angle, rng = drawn
    assert grid_step(angle + noise * rng.normal(size=angle.size)) == 0.0


def test_numbers_that_are_no_angles():
    """It takes no more memory than others do."""
    assert grid_step(1e9 * np.random.default_rng(0).normal(size=20_000)) == 0.0


@pytest.mark.parametrize("n", [10, 11, 50])
def test_few_samples(n):
    """Rests have no step; two values that alternate do."""
    assert grid_step(np.full(n, 1.2)) == 0.0
    assert grid_step(np.where(np.arange(n) % 2, 1.2, 1.203)) == pytest.approx(0.003)
    assert grid_step(0.003 * np.arange(n)) == pytest.approx(0.003)
