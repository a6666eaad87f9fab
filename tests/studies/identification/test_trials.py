"""Releases found in records: when, how many, and none where there is none."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin.errors import BadFile, BadValue, SpearError
from spear_pin.studies.identification import MovingAverage, Record, Trial, cut_releases, read_record, smooth_trial
from spear_pin.studies.push_test import PassiveKnee, equilibrium, find_pushed_angle, spear_ii
from spear_pin.studies.push_test.motion import move
from tests.slow import slow_but
from tests.studies.identification.files import written

KNEE = PassiveKnee()
LEGS = {ratio: spear_ii(ratio) for ratio in (None, 15.0, 66.0)}
PUSH, SWING = 1.5, 3.0


def pushed(leg, depths, hold=3.0, rate=1000.0, knee=KNEE, lead=1.0, t=None):
    """A record without noise, and when the leg is let go in it."""
    cycle = PUSH + hold + SWING
    t = np.arange(round((lead + cycle * len(depths)) * rate)) / rate if t is None else t
    level = equilibrium(leg, knee)
    angle, moments = np.full(t.size, level), lead + cycle * np.arange(len(depths)) + PUSH + hold + 0.3 / rate
    for moment, depth in zip(moments, depths, strict=True):
        bottom = find_pushed_angle(leg, knee, depth)
        part = np.clip((t - (moment - hold - PUSH)) / PUSH, 0, 1)
        pushing, after = (part > 0) & (t <= moment), t > moment
        angle[pushing] = level + (bottom - level) * (3 - 2 * part[pushing]) * part[pushing] ** 2
        motion = move(leg, knee, bottom, t[after] - moment, rtol=1e-8)
        angle[after], level = motion.angle, motion.angle[-1]
    return Record("here.csv", t, angle), moments


def noisy(record, noise, seed=0):
    return Record("here.csv", record.t, record.angle + noise * np.random.default_rng(seed).normal(size=record.t.size))


class TestFound:
    @pytest.mark.parametrize("depth", [0.05, 0.1])
    @pytest.mark.parametrize("hold", slow_but([0.5, 1.0, 5.0], 1.0))
    @pytest.mark.parametrize("ratio", LEGS)
    def test_when(self, ratio, hold, depth):
        record, moments = pushed(LEGS[ratio], [depth, depth], hold)
        for noise, within in ((0.0, 3e-3), (1e-3, 3e-3), (5e-3, 6e-3), (30e-3, 40e-3)):
            trials, _ = cut_releases(noisy(record, noise))
            np.testing.assert_allclose([trial.let_go for trial in trials], moments, rtol=0, atol=within)

    @pytest.mark.parametrize("rate", [200.0, 5000.0])
    def test_rates(self, rate):
        record, moments = pushed(LEGS[15.0], [0.05, 0.1], 1.0, rate)
        for noise, within in ((0.0, 3e-3), (1e-3, 3e-3), (5e-3, 8e-3)):
            trials, _ = cut_releases(noisy(record, noise))
            np.testing.assert_allclose([trial.let_go for trial in trials], moments, rtol=0, atol=within)

    def test_depths_in_one_record(self):
        record, moments = pushed(LEGS[15.0], [0.10, 0.05, 0.075])
        trials, remarks = cut_releases(noisy(record, 1e-3))
        assert remarks == [] and [trial.label for trial in trials] == ["release 1", "release 2", "release 3"]
        np.testing.assert_allclose([trial.let_go for trial in trials], moments, rtol=0, atol=3e-3)

    @pytest.mark.parametrize("drift", [-0.004, 0.004])
    def test_drift_and_steps_of_the_converter(self, drift):
        record, moments = pushed(LEGS[15.0], [0.05] * 3)
        angle = noisy(record, 1e-3).angle + drift * record.t
        trials, _ = cut_releases(Record("here.csv", record.t, np.round(angle / 5e-3) * 5e-3))
        np.testing.assert_allclose([trial.let_go for trial in trials], moments, rtol=0, atol=6e-3)

    def test_irregular_samples(self):
        steps = np.random.default_rng(0).uniform(0.3e-3, 1.7e-3, 9000)
        record, moments = pushed(LEGS[15.0], [0.1], t=np.cumsum(steps))
        (trial,), _ = cut_releases(noisy(record, 1e-3))
        assert trial.let_go == pytest.approx(moments[0], abs=5e-3)

    def test_record_that_begins_in_a_swing(self):
        record, moments = pushed(LEGS[15.0], [0.1, 0.1])
        rest = record.t > moments[0] + 0.04
        (trial,), _ = cut_releases(Record("here.csv", record.t[rest], record.angle[rest]))
        assert trial.let_go == pytest.approx(moments[1], abs=3e-3)

    def test_slow_swing_is_one_release(self):
        knee = PassiveKnee(damping=0.2)  # it swings for seconds
        record, moments = pushed(LEGS[15.0], [0.1], knee=knee)
        (trial,), _ = cut_releases(noisy(record, 1e-3))
        assert trial.let_go == pytest.approx(moments[0], abs=5e-3)


@cache
def twice():
    """Two releases."""
    return pushed(LEGS[15.0], [0.1, 0.1], 1.0)


class TestCut:
    @pytest.mark.parametrize(("before", "after"), [(0.5, 1.5), (0.05, 0.1), (0.2, 2.0), (0.06, 0.5)])
    def test_what_is_kept(self, before, after):
        record, _ = twice()
        trials, remarks = cut_releases(record, before, after)
        assert len(trials) == 2 and remarks == []
        for trial in trials:
            assert trial.t[0] == pytest.approx(trial.let_go - before, abs=1.1e-3)
            assert trial.t[-1] == pytest.approx(trial.let_go + after, abs=1.1e-3)
            first = np.searchsorted(record.t, trial.t[0])
            np.testing.assert_array_equal(trial.angle, record.angle[first : first + trial.t.size])

    def test_hold_ends_where_the_push_does(self):
        record, moments = twice()
        trials, _ = cut_releases(record, before=30.0)
        for trial, moment in zip(trials, moments, strict=True):
            assert moment - 1.35 < trial.t[0] < moment - 0.9

    def test_next_push_shortens(self):
        record, moments = twice()
        trials, remarks = cut_releases(record, after=4.0)
        assert trials[0].t[-1] < moments[0] + SWING + PUSH
        assert (
            "release 1 is followed for" in remarks[0] and "release 2 is followed for 3.00 s, not for 4 s" in remarks[1]
        )

    def test_next_release_is_not_taken_for_a_swing(self):
        record, moments = twice()
        trials, remarks = cut_releases(record, after=30.0)
        assert [trial.let_go for trial in trials] == pytest.approx(moments, abs=3e-3)
        assert trials[0].t[-1] < moments[0] + SWING + PUSH and len(remarks) == 2

    def test_swings_are_not_told(self):
        record, _ = pushed(LEGS[15.0], [0.1], knee=PassiveKnee(damping=0.1))
        trials, remarks = cut_releases(record, after=0.5)
        assert len(trials) == 1 and remarks == []

    def test_caught_at_once(self):
        t = np.arange(6000) / 1000
        angle = np.where(t < 2, 1.5, np.where(t < 3.2, 1.5, 1.2))
        fall = np.clip((t - 2.0) / 0.1, 0, 1) - np.clip((t - 2.35) / 0.1, 0, 1)
        angle = angle - 0.3 * fall * (t < 3.2)
        trials, remarks = cut_releases(Record("here.csv", t, angle), after=0.5)
        assert all(trial.t[-1] >= trial.let_go + 0.09 for trial in trials)
        assert all("here.csv: " in remark for remark in remarks)

    @pytest.mark.parametrize("name", ["before", "after"])
    @pytest.mark.parametrize("value", [-1, 0.0, 61, float("nan"), float("inf"), "long"])
    def test_bad_values(self, name, value):
        with pytest.raises(BadValue, match=f"^{name} is "):
            cut_releases(twice()[0], **{name: value})

    def test_synthetic_stays_so(self):
        record = replace(twice()[0], synthetic=True)
        assert all(trial.synthetic for trial in cut_releases(record)[0])


T = np.arange(10_000) / 1000
NONE = {
    "constant": np.ones_like(T),
    "ramp down": 1.5 - 0.05 * T,
    "ramp up": 1.0 + 0.05 * T,
    "noise": 1.0 + 0.03 * np.random.default_rng(0).normal(size=T.size),
    "quantised noise": np.round(1.0 + 0.03 * np.random.default_rng(0).normal(size=T.size), 2),
    "push and slow return": 1.0 + 0.5 * np.sin(np.pi * T / 10) ** 2,
    "wiggles": 1.2 + 0.2 * np.sin(2 * np.pi * 1.5 * T),
    "push only": 1.0 + 0.5 * np.clip((T - 3) / 0.2, 0, 1),
    "spike": 1.0 + 0.6 * (np.abs(T - 5) < 0.004),
    "tiny": 1.0 - 0.02 * (T > 5),
    "release at once": 1.2 + 0.3 * np.exp(-5 * T) * np.cos(12 * T),
}


class TestRefused:
    @pytest.mark.parametrize("name", NONE)
    def test_no_release(self, name):
        with pytest.raises(BadFile, match="^here.csv: ") as caught:
            cut_releases(Record("here.csv", T, NONE[name]))
        assert "\n" not in str(caught.value)

    def test_wiggles_beside_a_release(self):
        record, moments = pushed(LEGS[15.0], [0.1], lead=6.0)
        wiggling = (record.t > 1.0) & (record.t < 5.0)
        record.angle[wiggling] += 0.3 * np.sin(2 * np.pi * 1.0 * (record.t[wiggling] - 1.0))
        trials, remarks = cut_releases(record)
        assert [trial.let_go for trial in trials] == pytest.approx(moments, abs=3e-3)
        assert remarks and all("is no release: " in remark for remark in remarks)

    def test_anything(self):
        rng = np.random.default_rng(1)
        base, _ = pushed(LEGS[15.0], [0.1, 0.05], 0.8, 250.0)
        for _ in range(150):
            t, angle = base.t.copy(), base.angle.copy()
            for _ in range(rng.integers(1, 6)):
                first = int(rng.integers(t.size))
                some = slice(first, first + int(rng.integers(1, 300)))
                match rng.integers(4):
                    case 0:
                        angle[some] = rng.uniform(0, 2)
                    case 1:
                        angle[some] += rng.normal(size=angle[some].size) * rng.uniform(0, 0.3)
                    case 2 if t.size > 500:
                        t, angle = np.delete(t, some), np.delete(angle, some)
                    case _:
                        t[first:] += rng.uniform(0, 2)
            try:
                trials, _ = cut_releases(Record("here.csv", t, angle), rng.uniform(0.05, 1), rng.uniform(0.1, 3))
            except SpearError as error:
                assert str(error).startswith("here.csv: ")
                continue
            for trial in trials:
                assert trial.t[0] <= trial.let_go < trial.t[-1]

    def test_damaged_files(self, tmp_path):
        record, moments = pushed(LEGS[15.0], [0.1], 0.8, 250.0)
        lines = [f"{t:.3f},{a:.4f}" for t, a in zip(record.t, record.angle, strict=True)]
        text = "\n".join(["time_s,knee_rad", *lines, ""]).encode()
        rng, found = np.random.default_rng(2), 0
        for _ in range(150):
            content = bytearray(text)
            for i in rng.integers(0, len(content), rng.integers(1, 4)):
                content[i] = b'0123456789.,-\n#x"'[rng.integers(17)]
            path = written(tmp_path, bytes(content))
            try:
                trials, _ = cut_releases(read_record(path))
            except SpearError as error:
                assert str(path) in str(error) and "\n" not in str(error)
                continue
            found += 1
            assert [trial.let_go for trial in trials] == pytest.approx(moments, abs=0.02)
        assert found > 50


class TestTrial:
    @pytest.mark.parametrize(
        ("t", "angle", "let_go", "name"),
        [
            (T[:9], T[:9], 0.0, "trial"),
            (T[:50], T[:49], 0.0, "trial"),
            (T[:50].reshape(5, 10), T[:50].reshape(5, 10), 0.0, "trial"),
            (T[:50], np.where(T[:50] > 0.02, np.nan, 1.0), 0.0, "trial"),
            (T[:50][::-1], T[:50], 0.0, "trial"),
            (np.zeros(50), T[:50], 0.0, "trial"),
            (T[:50], T[:50], -0.001, "let_go"),
            (T[:50], T[:50], 0.049, "let_go"),
            (T[:50], T[:50], float("nan"), "let_go"),
        ],
    )
    def test_refused(self, t, angle, let_go, name):
        with pytest.raises(BadValue, match=f"^{name} is "):
            Trial(t, angle, let_go)

    def test_smoothed(self):
        trial, window = Trial(T[:50], np.sin(T[:50]), 0.01), MovingAverage(5)
        assert smooth_trial(trial, None) is trial and trial.unsmoothed is trial.angle
        smooth = smooth_trial(trial, window)
        np.testing.assert_array_equal(smooth.angle, window(trial.angle))
        assert smooth.unsmoothed is trial.angle and smooth.smoothing == window
        assert smooth.used.all() and trial.used.all()
        with pytest.raises(BadValue, match="window is 51; expected at most the 50 samples of release"):
            smooth_trial(trial, MovingAverage(51))
        with pytest.raises(BadValue, match="smoothed already"):
            smooth_trial(smooth, window)

    @pytest.mark.parametrize(("kind", "lost"), [("centred", 2), ("causal", 0)])
    def test_smoothed_before_it_was_cut(self, kind, lost):
        window = MovingAverage(5, kind)
        trial = Trial(T[:50], window(T[:100])[:50], 0.01, smoothing=window)
        assert trial.unsmoothed is None and trial.used.sum() == 50 - lost and trial.used[: 50 - lost].all()
        right = np.isclose(trial.angle, window(T[:50]), rtol=0, atol=1e-12)
        assert right.tolist() == trial.used.tolist()
