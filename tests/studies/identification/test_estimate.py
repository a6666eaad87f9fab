"""Estimates from synthetic releases: the truth without noise, its scatter with it, and the source's biases."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin.errors import BadValue, UnknownName
from spear_pin.studies.identification import MovingAverage, Record, cut_releases, identify, smooth_trial
from spear_pin.studies.laboratory import Instrument, synthesize, synthetic_trial
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, PassiveKnee, equilibrium, spear_ii

LEGS = {ratio: spear_ii(ratio) for ratio in (None, 15.0, 66.0)}
LEG = LEGS[15.0]
VISCOUS = PassiveKnee(48.0, 0.9, 0.0, 1.0)
DRY = PassiveKnee(48.0, 0.6, 0.5, 1.0)
SOFT = PassiveKnee(50.0, 1.2, 0.0, 0.8)
ALL = ("stiffness", "damping", "coulomb", "rest_angle")


def trial(knee=VISCOUS, depth=0.05, noise=0.0, seed=0, leg=LEG, **options):
    return synthetic_trial(leg, knee, depth, noise, np.random.default_rng(seed), **options)


def found(estimate):
    """The knee's values by name."""
    return {p.name: p.value for p in estimate.parameters if p.name not in ("initial_angle", "release_time")}


def warned(estimate, text):
    return any(text in warning for warning in estimate.warnings)


class TestTruth:
    """Without noise, what went in comes out."""

    @pytest.mark.slow
    @pytest.mark.parametrize("static", [False, True])
    @pytest.mark.parametrize("ratio", [None, 15.0])
    def test_three_depths(self, ratio, static):
        leg = LEGS[ratio]
        estimate = identify(leg, [trial(depth=depth, leg=leg) for depth in DEPTHS], static_rest=static)
        rest = equilibrium(leg, VISCOUS) if static else 1.0
        assert found(estimate) == pytest.approx({"stiffness": 48.0, "damping": 0.9, "rest_angle": rest}, rel=1e-6)
        assert estimate.knees[2].zero == pytest.approx(1.0, abs=1e-6) and estimate.rotors == (leg.rotor,) * 3
        assert estimate.converged and estimate.noise < 1e-6 and estimate.whiteness is None
        assert min(*estimate.fits, estimate.fit) > 99.999
        times = [p.value for p in estimate.parameters if p.name == "release_time"]
        np.testing.assert_allclose(times, 0.0, atol=1e-7)

    def test_fit_of_all_trials(self):
        estimate = identify(LEG, [trial(noise=5e-3), trial(depth=0.1, noise=0.03)])
        missed = [t.angle - y for t, y in zip(estimate.trials, estimate.predicted, strict=True)]
        spread = np.concatenate([t.angle - t.angle.mean() for t in estimate.trials])
        expected = 100 * (1 - np.linalg.norm(np.concatenate(missed)) / np.linalg.norm(spread))
        assert estimate.fit == pytest.approx(expected) and min(estimate.fits) < expected < max(estimate.fits)

    @pytest.mark.slow
    def test_a_knee_of_its_own_for_every_trial(self):
        knees = [replace(VISCOUS, damping=0.7), replace(VISCOUS, damping=1.4)]
        estimate = identify(LEG, [trial(knee) for knee in knees], per_trial=["damping"])
        own = [p for p in estimate.parameters if p.name == "damping"]
        assert [p.label for p in own] == ["damping of release 1", "damping of release 2"]
        assert [p.value for p in own] == pytest.approx([0.7, 1.4], rel=1e-6)
        assert [knee.damping for knee in estimate.knees] == [p.value for p in own]
        assert estimate["stiffness"].value == pytest.approx(48.0, rel=1e-6)
        with pytest.raises(UnknownName, match="'damping'; valid: stiffness, rest_angle"):
            estimate["damping"]

    @pytest.mark.slow
    def test_dry_friction(self):
        estimate = identify(LEG, [trial(DRY, 0.05), trial(DRY, 0.1)], ALL)
        expected = {"stiffness": 48.0, "damping": 0.6, "coulomb": 0.5, "rest_angle": 1.0}
        assert found(estimate) == pytest.approx(expected, rel=1e-6)

    def test_known_values(self):
        estimate = identify(LEG, [trial(DRY)], ["stiffness"], known={"damping": 0.6, "coulomb": 0.5, "rest_angle": 1.0})
        assert found(estimate) == pytest.approx({"stiffness": 48.0}, rel=1e-6)

    @pytest.mark.parametrize("clock", [7.0, 1.7e9])
    def test_late_release(self, clock):
        shifted = trial()
        shifted = replace(shifted, t=shifted.t + (clock + 0.012), let_go=clock)
        estimate = identify(LEG, [shifted])
        assert estimate["release_time"].value == pytest.approx(clock + 0.012, rel=0, abs=1e-6)
        assert estimate["stiffness"].value == pytest.approx(48.0, rel=1e-5)
        assert estimate.fit > 99.99


class TestSmoothed:
    """What smoothing the data and not the model does to the source's estimates."""

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("kind", "stiffness", "damping", "rest"), [("centred", 0.0, 0.08, 0.0), ("causal", -0.23, 0.12, -0.05)]
    )
    def test_bias(self, kind, stiffness, damping, rest):
        smooth = smooth_trial(trial(SOFT), MovingAverage(100, kind))
        biased = identify(LEG, [smooth], nuisances=(), smooth_model=False)
        assert biased["stiffness"].value / 50.0 - 1 == pytest.approx(stiffness, abs=0.02)
        assert biased["damping"].value / 1.2 - 1 == pytest.approx(damping, abs=0.02)
        assert biased["rest_angle"].value - 0.8 == pytest.approx(rest, abs=0.02)
        assert warned(biased, "the estimates are biased")
        right = identify(LEG, [smooth], nuisances=())
        alone = identify(LEG, [replace(smooth, raw=None)], nuisances=())  # smoothed by somebody else
        assert found(alone) == pytest.approx(found(right), rel=1e-6) and alone.whiteness is None
        assert found(right) == pytest.approx({"stiffness": 50.0, "damping": 1.2, "rest_angle": 0.8}, rel=1e-4)
        assert not warned(right, "biased")
        np.testing.assert_allclose(right.predicted[0], smooth.angle, rtol=0, atol=1e-6)


class TestScatter:
    @pytest.mark.slow
    @pytest.mark.parametrize("smoothing", [None, MovingAverage(25)])
    def test_covers_the_truth(self, smoothing):
        trials = [trial(VISCOUS, 0.05, 3e-3, seed, rate=250.0, hold=0.2, duration=0.8) for seed in range(20)]
        estimates = [identify(LEG, [smooth_trial(each, smoothing)]) for each in trials]
        for name, truth in (("stiffness", 48.0), ("damping", 0.9), ("rest_angle", 1.0), ("release_time", 0.0)):
            values = np.array([estimate[name].value for estimate in estimates])
            deviations = np.array([estimate[name].deviation for estimate in estimates])
            assert (np.abs(values - truth) < 2 * deviations).mean() >= 0.85
            assert deviations.mean() == pytest.approx(values.std(ddof=1), rel=0.35)
        assert np.mean([estimate.noise for estimate in estimates]) == pytest.approx(3e-3, rel=0.05)
        assert np.mean([warned(estimate, "not white") for estimate in estimates]) < 0.2
        correlation = estimates[0].correlation
        np.testing.assert_allclose(np.diag(correlation), 1.0)
        assert np.abs(correlation).max() < 1 + 1e-12

    @pytest.mark.slow
    def test_more_releases_tell_more(self):
        one = identify(LEG, [trial(noise=3e-3)])
        four = identify(LEG, [trial(noise=3e-3, seed=seed) for seed in range(4)])
        for name in ("stiffness", "damping", "rest_angle"):
            assert four[name].deviation == pytest.approx(one[name].deviation / 2, rel=0.25)


class TestRounded:
    """Angles in counts of an encoder, nothing else amiss."""

    STEP = 2 * np.pi / 2048

    def rounded(self, made, place=0.0, step=STEP):
        """The trial as an encoder shows it whose counts lie somewhere."""
        return replace(made, angle=step * (np.round(made.angle / step + place) - place))

    @pytest.mark.slow
    @pytest.mark.parametrize("knee", [VISCOUS, SOFT, replace(VISCOUS, damping=2.0)])
    def test_error_bars_hold_and_those_of_white_noise_did_not(self, knee):
        worst = 0.0
        for place in (0.1, 0.45, 0.8):
            estimate = identify(LEG, [self.rounded(trial(knee), place)])
            assert estimate.roundings[0].step == pytest.approx(self.STEP) and estimate.roundings[0].noise == 0.0
            assert warned(estimate, "rounded to steps of 3.07 mrad, more than its noise") and estimate.inflation > 2
            assert not warned(estimate, "misses something")
            for name, truth in (("stiffness", knee.stiffness), ("damping", knee.damping), ("rest_angle", knee.zero)):
                off = abs(estimate[name].value - truth) / estimate[name].deviation
                assert off < 3.0
                worst = max(worst, off * estimate[name].inflation)
        assert worst > 3.0  # deviations of white noise

    @pytest.mark.slow
    @pytest.mark.parametrize(("noise", "smoothing"), [(0.0, None), (0.1, MovingAverage(25))])  # of a step
    def test_covers_the_truth(self, noise, smoothing):
        rng, z = np.random.default_rng(11), []
        for seed in range(12):
            knee = PassiveKnee(rng.uniform(35, 90), rng.uniform(0.4, 2.5), 0.0, rng.uniform(0.8, 1.1))
            step = 2 * np.pi / rng.choice([512, 2048, 8192])
            made = trial(knee, rng.uniform(0.05, 0.1), noise * step, seed, rate=250.0, hold=0.2, duration=1.0)
            estimate = identify(LEG, [smooth_trial(self.rounded(made, rng.uniform(), step), smoothing)])
            pairs = (("stiffness", knee.stiffness), ("damping", knee.damping), ("rest_angle", knee.zero))
            z += [(estimate[name].value - truth) / estimate[name].deviation for name, truth in pairs]
        assert (np.abs(z) < 2).mean() >= 0.9 and np.abs(z).max() < 3.5
        assert 0.65 < np.sqrt(np.mean(np.square(z))) < 1.35  # neither too small nor needlessly large

    @pytest.mark.slow
    def test_noise_of_more_than_a_step_leaves_them_as_they_were(self):
        made = trial(noise=self.STEP)
        fine, coarse = identify(LEG, [made]), identify(LEG, [self.rounded(made)])
        assert fine.inflation == 1.0 and coarse.inflation == pytest.approx(1.0, abs=1e-9)
        assert coarse.roundings[0].noise == pytest.approx(self.STEP, rel=0.05) and coarse.warnings == fine.warnings
        for one, other in zip(coarse.parameters, fine.parameters, strict=True):
            assert one.deviation == pytest.approx(np.sqrt(13 / 12) * other.deviation, rel=0.05)

    @pytest.mark.slow
    def test_a_sample_between_two_counts_changes_nothing(self):
        made = self.rounded(trial(SOFT), 0.45)
        angle = made.angle.copy()
        angle[700] = 0.5 * (angle[700] + angle[701]) + 0.3 * self.STEP
        plain, patched = identify(LEG, [made]), identify(LEG, [replace(made, angle=angle)])
        assert warned(patched, "rounded to steps of 3.07 mrad, more than its noise")
        for one, other in zip(patched.parameters, plain.parameters, strict=True):
            assert one.deviation == pytest.approx(other.deviation, rel=0.05)

    @pytest.mark.slow
    def test_a_model_that_misses_something_is_not_excused(self):
        made = trial(PassiveKnee(48.0, 0.3, 1.5, 1.0))
        assert warned(identify(LEG, [self.rounded(made)]), "the model misses something")


class TestWarnings:
    @pytest.mark.slow
    def test_dry_friction_that_is_taken_for_viscous(self):
        knee = PassiveKnee(48.0, 0.3, 1.5, 1.0)
        estimates = [identify(LEG, [trial(knee, depth, 1e-3)]) for depth in DEPTHS]
        damping = [estimate["damping"].value for estimate in estimates]
        assert damping[0] > damping[1] > damping[2] > 0.3  # as in Table 4.1
        assert all(warned(estimate, "the residuals are not white") for estimate in estimates)
        assert all(estimate.whiteness < 1e-6 for estimate in estimates)

    def test_rotor_and_stiffness(self):
        estimate = identify(LEG, [trial(SOFT, 0.1, 1e-3)], ("stiffness", "damping", "rest_angle", "rotor_inertia"))
        assert warned(estimate, "stiffness and rotor_inertia are hardly told apart (correlation 0.99")
        for name, truth in (("stiffness", 50.0), ("rotor_inertia", LEG.rotor)):
            assert abs(estimate[name].value - truth) < 3 * estimate[name].deviation

    @pytest.mark.slow
    def test_toe_that_pulls(self):
        estimate = identify(LEG, [trial(SOFT, 0.1, 1e-3)])
        assert warned(estimate, "in release the pinned toe pulls on the ground, -10.5 N after 0.196 s")
        assert estimate.warnings == (estimate.warnings[0],)
        assert identify(LEG, [trial(SOFT, 0.05, 1e-3)]).warnings == ()

    def test_bound(self):
        estimate = identify(LEG, [trial(noise=1e-3)], bounds={"stiffness": (30.0, 45.0), "damping": (0.1, 9.0)})
        assert estimate["stiffness"].value == pytest.approx(45.0, abs=1e-6)
        assert warned(estimate, "stiffness is at its bound, 45") and not warned(estimate, "damping is at its bound")

    def test_what_the_data_do_not_tell(self):
        stuck = {"coulomb": 100.0}  # nothing moves, whatever the spring
        with pytest.raises(BadValue, match="vary is .*the data say nothing of stiffness and damping and release_time"):
            identify(LEG, [trial(noise=1e-3)], ("stiffness", "damping"), known=stuck)

    def test_model_that_does_not_describe(self):
        noise = np.random.default_rng(0).normal(size=trial().t.size)
        wild = replace(trial(), angle=np.clip(1.2 + 0.1 * noise, 0.2, 2.0), label="release 4")
        assert warned(identify(LEG, [wild]), "the model does not describe release 4: fit ")


class TestRobust:
    @pytest.mark.slow
    @pytest.mark.parametrize("loss", ["soft_l1", "huber", "cauchy"])
    def test_outliers(self, loss):
        clean = trial(noise=1e-3, rate=500.0)
        angle, rng = clean.angle.copy(), np.random.default_rng(5)
        angle[rng.choice(angle.size, angle.size // 20, replace=False)] -= 0.15
        outlying = replace(clean, angle=angle)
        off, deviation = {}, {"clean": identify(LEG, [clean])["stiffness"].deviation}
        for name in ("linear", loss):
            estimate = identify(LEG, [outlying], loss=name)
            deviation[name] = estimate["stiffness"].deviation
            off[name] = abs(estimate["rest_angle"].value - 1.0) + abs(estimate["stiffness"].value / 48.0 - 1)
        assert off[loss] < min(0.25 * off["linear"], 0.012)
        assert deviation["clean"] < deviation[loss] < 0.5 * deviation["linear"]

    def test_unknown(self):
        with pytest.raises(UnknownName, match="unknown loss 'l1'; valid: linear, soft_l1, huber, cauchy"):
            identify(LEG, [trial()], loss="l1")


class TestSearch:
    @pytest.mark.slow
    def test_integrations(self):
        counts = []
        for ratio, stiffness, damping, depth, noise in (
            (None, 30.0, 0.2, 0.1, 5e-3),
            (None, 100.0, 3.0, 0.05, 0.0),
            (15.0, 60.0, 0.2, 0.05, 1e-3),
            (15.0, 30.0, 3.0, 0.1, 5e-3),
            (15.0, 100.0, 1.2, 0.05, 5e-3),
            (66.0, 60.0, 1.2, 0.1, 1e-3),
            (66.0, 30.0, 3.0, 0.05, 5e-3),
        ):
            leg = LEGS[ratio]
            estimate = identify(leg, [trial(PassiveKnee(stiffness, damping, 0.0, 1.0), depth, noise, leg=leg)])
            assert estimate.converged
            counts.append(estimate.integrations)
        assert max(counts) <= 60 and min(counts) >= 5

    def test_progress(self):
        calls = []
        estimate = identify(LEG, [trial(noise=1e-3)], on_iteration=lambda *call: calls.append(call))
        assert [number for number, _ in calls] == list(range(1, len(calls) + 1)) and len(calls) > 2
        assert calls[-1][1] <= calls[0][1] and min(rms for _, rms in calls) == pytest.approx(1e-3, rel=0.1)
        assert estimate.integrations >= len(calls)

    @pytest.mark.parametrize("name", ["trials", "vary"])
    def test_nothing(self, name):
        with pytest.raises(BadValue, match=f"^{name} is "):
            identify(LEG, **{"trials": [trial()], "vary": ["damping"]} | {name: []})

    def test_item(self):
        estimate = identify(LEG, [trial()], ["stiffness"], known={"damping": 0.9, "rest_angle": 1.0}, nuisances=())
        assert estimate["stiffness"] is estimate.parameters[0] and estimate["stiffness"].trial is None
        for name in ("damping", "stifness"):
            with pytest.raises(UnknownName, match=f"unknown shared parameter '{name}'; valid: stiffness"):
                estimate[name]


class TestSmoothedBefore:
    """A record smoothed before it was cut: its last half window saw what was cut off."""

    @pytest.mark.slow
    @pytest.mark.parametrize("after", [0.5, 1.5])
    def test_short_cuts_are_not_biased(self, after):
        made = synthesize(LEG, WITH_MOTOR, 0.1, repeats=3, instrument=Instrument(noise=0.003, quantum=0.0), seed=5)
        angle = MovingAverage(100)((made.voltage - 0.4) / 1.06)
        trials, _ = cut_releases(Record("x", made.t, angle), after=after)
        found = identify(LEG, [replace(each, smoothing=MovingAverage(100)) for each in trials])
        for name, truth in (("stiffness", 48.25), ("damping", 1.03), ("rest_angle", 1.0)):
            assert abs(found[name].value - truth) < 3 * found[name].deviation
        assert found.whiteness is None
