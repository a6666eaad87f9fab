"""The synthetic laboratory: its instrument, its protocol, its files."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin.errors import BadFile, BadValue
from spear_pin.studies.identification import Calibration, cut_releases, read_record
from spear_pin.studies.laboratory import HOLD, PUSH, SWING, Instrument, synthesize, synthetic_trial, write_csv
from spear_pin.studies.push_test import PassiveKnee, equilibrium, find_pushed_angle, spear_ii
from spear_pin.studies.push_test.motion import move

LEG, KNEE = spear_ii(), PassiveKnee(48.0, 1.2, 0.3, 1.02)
T = np.arange(20_000) / 1000


@pytest.fixture(scope="module")
def record():
    return synthesize(LEG, KNEE, 0.075)


class TestInstrument:
    def test_voltage(self):
        instrument = Instrument(Calibration(-2.0, 4.0), noise=0.01, quantum=0.0, drift=0.005)
        angle = 1.0 + 0.1 * np.sin(T)
        off = instrument.voltage(T, angle, np.random.default_rng(0)) - (-2.0 * angle + 4.0 + 0.005 * T)
        assert off.std() == pytest.approx(0.01, rel=0.02)
        assert abs(off.mean()) < 4 * 0.01 / np.sqrt(T.size)
        assert abs(np.polyfit(T, off, 1)[0]) < 1e-4
        assert abs(np.corrcoef(off[1:], off[:-1])[0, 1]) < 0.03

    def test_quantised(self):
        instrument = Instrument(noise=0.0, quantum=0.01)
        exact = 1.06 * np.sin(T) + 0.4
        read = instrument.voltage(T, np.sin(T), np.random.default_rng(0))
        np.testing.assert_allclose(read / 0.01, np.round(read / 0.01), rtol=0, atol=1e-9)
        assert np.abs(read - exact).max() <= 0.005 + 1e-12
        assert np.abs(read - exact).max() > 0.004

    def test_exact(self):
        read = Instrument(noise=0.0, quantum=0.0).voltage(T, T, np.random.default_rng(0))
        np.testing.assert_allclose(read, 1.06 * T + 0.4, rtol=1e-15)

    @pytest.mark.parametrize("name", ["noise", "quantum", "drift"])
    @pytest.mark.parametrize("value", [float("nan"), float("inf"), "much"])
    def test_bad_values(self, name, value):
        with pytest.raises(BadValue, match=rf"^Instrument\.{name} is "):
            Instrument(**{name: value})

    @pytest.mark.parametrize("name", ["noise", "quantum"])
    def test_negative(self, name):
        with pytest.raises(BadValue, match=rf"^Instrument\.{name} is -1"):
            Instrument(**{name: -1})


class TestProtocol:
    def test_five_releases_held_for_three_seconds(self, record):
        pushed = find_pushed_angle(LEG, KNEE, 0.075)
        assert record.let_go.size == 5 and HOLD == 3.0
        cycle = PUSH + HOLD + SWING
        np.testing.assert_allclose(np.diff(record.let_go), cycle, rtol=0, atol=1e-3)
        for moment in record.let_go:
            held = (record.t > moment - HOLD) & (record.t <= moment)
            np.testing.assert_allclose(record.angle[held], pushed, rtol=0, atol=1e-12)
            assert not np.isclose(record.angle[record.t < moment - HOLD - 0.2][-1], pushed, atol=1e-3)

    def test_motion_is_the_release(self, record):
        moment = record.let_go[2]
        after = (record.t > moment) & (record.t < moment + SWING)
        motion = move(LEG, KNEE, find_pushed_angle(LEG, KNEE, 0.075), record.t[after] - moment)
        np.testing.assert_allclose(record.angle[after], motion.angle, rtol=0, atol=1e-8)

    def test_is_continuous(self, record):
        assert np.abs(np.diff(record.angle)).max() < 0.012
        assert record.angle[0] == equilibrium(LEG, KNEE)

    def test_no_release_is_followed_beyond_the_next_push(self, monkeypatch):
        """Which would take the square of their number."""
        lengths = []
        monkeypatch.setattr(
            "spear_pin.studies.laboratory.move", lambda *given: lengths.append(given[-1][-1]) or move(*given)
        )
        synthesize(LEG, KNEE, repeats=3, rate=100)
        assert len(lengths) == 3 and max(lengths) < SWING + 0.05

    def test_seed(self):
        one, same, other = (synthesize(LEG, KNEE, repeats=1, rate=200, seed=seed) for seed in (3, 3, 4))
        np.testing.assert_array_equal(one.voltage, same.voltage)
        assert (one.voltage != other.voltage).any() and one.let_go != other.let_go

    @pytest.mark.parametrize(
        ("name", "value"),
        [
            *(("repeats", value) for value in (0, -1, 1.5, float("nan"), float("inf"), "two", None)),
            *(("rate", value) for value in (0, -1, 49, 1e9, float("nan"), float("inf"), "fast")),
            *(("seed", value) for value in (-1, 0.5, float("inf"), "x", None)),
            *(("depth", value) for value in (-0.01, 1.0, float("nan"), "deep")),
        ],
    )
    def test_bad_values(self, name, value):
        with pytest.raises(BadValue, match=f"^{name} is "):
            synthesize(LEG, KNEE, **{name: value})

    def test_leg_that_does_not_rest(self):
        with pytest.raises(BadValue, match="^knee is "):
            synthesize(LEG, replace(KNEE, stiffness=0.0))


class TestFile:
    def test_round_trip(self, tmp_path):
        instrument = Instrument(Calibration(-1.3, 4.2))
        record = synthesize(LEG, KNEE, repeats=2, instrument=instrument, rate=500)
        path = write_csv(record, tmp_path / "record.csv")
        assert path == tmp_path / "record.csv"
        first, *rest = path.read_text(encoding="utf-8").splitlines()
        assert first.startswith("# SYNTHETIC") and "not measured" in first
        head = "\n".join(line for line in rest if line.startswith("#"))
        assert all(
            text in head for text in ("48 N·m/rad", "1.2 N·m·s/rad", "0.3 N·m", "1.02 rad", "-1.3 V/rad", "seed 0")
        )
        back = read_record(path, calibration=instrument.calibration)
        assert back.synthetic and back.remarks == ()
        np.testing.assert_allclose(back.t, record.t, rtol=0, atol=5.1e-7)
        np.testing.assert_allclose(back.angle, (record.voltage - 4.2) / -1.3, rtol=0, atol=1e-6)
        trials, remarks = cut_releases(back)
        assert remarks == [] and all(trial.synthetic for trial in trials)
        np.testing.assert_allclose([trial.let_go for trial in trials], record.let_go, rtol=0, atol=4e-3)

    def test_whole_or_not_at_all(self, tmp_path, monkeypatch):
        record = synthesize(LEG, KNEE, repeats=1, rate=100)
        path = tmp_path / "record.csv"
        path.write_text("what was there before")

        def full(*_, **__):
            raise OSError(28, "No space left on device")

        monkeypatch.setattr(np, "savetxt", full)
        with pytest.raises(BadFile, match="record.csv: cannot be written: No space"):
            write_csv(record, path)
        assert path.read_text() == "what was there before" and list(tmp_path.iterdir()) == [path]

    def test_folder_that_is_none(self, tmp_path):
        with pytest.raises(BadFile, match="cannot be written"):
            write_csv(synthesize(LEG, KNEE, repeats=1, rate=100), tmp_path / "none" / "record.csv")


class TestSyntheticTrial:
    def test_hold_and_motion(self):
        trial = synthetic_trial(LEG, KNEE, 0.1, 0.0, np.random.default_rng(0), hold=0.3, duration=0.8, rate=500)
        assert trial.synthetic and trial.let_go == 0.0
        assert (trial.t[0], trial.t[-1], trial.t.size) == (-0.3, 0.8, 551)
        pushed = find_pushed_angle(LEG, KNEE, 0.1)
        np.testing.assert_allclose(trial.angle[trial.t <= 0], pushed, rtol=0, atol=1e-15)
        motion = move(LEG, KNEE, pushed, trial.t[trial.t >= 0])
        np.testing.assert_allclose(trial.angle[trial.t >= 0], motion.angle, rtol=0, atol=1e-12)

    def test_noise(self):
        noisy, clean = (synthetic_trial(LEG, KNEE, 0.1, s, np.random.default_rng(1)) for s in (2e-3, 0.0))
        assert (noisy.angle - clean.angle).std() == pytest.approx(2e-3, rel=0.05)
