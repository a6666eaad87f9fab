"""The least-squares problem: its Jacobian against finite differences, its model by hand, what it refuses."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin.errors import BadValue, UnknownName
from spear_pin.studies.identification import NUISANCES, MovingAverage, smooth_trial
from spear_pin.studies.identification.least_squares import pose
from spear_pin.studies.identification.quantities import KNEE, QUANTITIES
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import PassiveKnee, equilibrium, find_pushed_angle, spear_ii
from spear_pin.studies.push_test.motion import move
from tests.slow import slow_but

LEG = spear_ii()
TRUTH = PassiveKnee(48.0, 0.9, 0.0, 1.02)
TRIALS = [
    synthetic_trial(LEG, TRUTH, depth, 1e-3, np.random.default_rng(0), hold=0.1, duration=0.6, rate=250.0)
    for depth in (0.05, 0.1)
]
STEPS = {name: 1e-4 for name in QUANTITIES} | {
    "stiffness": 1e-2,
    "damping": 1e-3,
    "coulomb": 1e-3,
    "rotor_inertia": 1e-5,
}
DEFAULTS = {
    "per_trial": (),
    "nuisances": NUISANCES,
    "static_rest": False,
    "known": {},
    "unilateral": False,
    "bounds": {},
    "smooth_model": True,
}


def posed(vary=("stiffness", "damping", "rest_angle"), trials=TRIALS, **options):
    return pose(LEG, trials, vary, **DEFAULTS | options)


def values(problem, **truth):
    """The unknowns near the truth, off by some."""
    x = {"stiffness": 46.0, "damping": 1.0, "coulomb": 0.4, "rest_angle": 1.03, "rotor_inertia": 0.03} | truth
    initial = [float(np.median(trial.angle[trial.t < 0])) for trial in problem.trials]
    x = [x.get(e.name, {"initial_angle": initial[e.trial or 0] + 0.01}.get(e.name, 0.0007)) for e in problem.entries]
    return np.array(x)


def by_differences(problem, x):
    """Central differences of the residuals, from motions without sensitivities."""

    def residuals(x):
        return np.concatenate(
            [t.used * (problem.smoothed(problem.angle(x, j), j) - t.angle) for j, t in enumerate(problem.trials)]
        )

    columns = []
    for entry, unit in zip(problem.entries, np.eye(x.size), strict=True):
        step = STEPS[entry.name] * unit
        columns.append((residuals(x + step) - residuals(x - step)) / (2 * step.sum()))
    return np.column_stack(columns)


SOME = ("stiffness", "rest_angle")


class TestJacobian:
    @pytest.mark.parametrize(
        "smoothing", slow_but([None, MovingAverage(20), MovingAverage(15, "causal")], MovingAverage(20))
    )
    @pytest.mark.parametrize("static", slow_but([False, True], True))
    @pytest.mark.parametrize("per_trial", slow_but([(), SOME, KNEE], SOME))
    def test_differences(self, static, per_trial, smoothing):
        trials = [smooth_trial(trial, smoothing) for trial in TRIALS]
        problem = posed(KNEE, trials, static_rest=static, per_trial=per_trial)
        x = values(problem, rest_angle=1.25 if static else 1.03)
        found, expected = problem.linearized(x)[1], by_differences(problem, x)
        scale = np.abs(expected).max(axis=0)
        off = np.abs(found - expected) / scale
        # at the first sample after the release, and at turns with dry friction, the slope jumps
        assert np.quantile(off, 0.97) < 2e-3 and off.max() < 0.05
        assert (scale > 0).all()

    @pytest.mark.slow
    @pytest.mark.parametrize("static", slow_but([False, True], True))
    @pytest.mark.parametrize("name", [*KNEE, None])
    def test_without_dry_friction(self, static, name):
        problem = posed([name] if name else ["damping"], static_rest=static, known={"stiffness": 46.0})
        x = values(problem, rest_angle=1.25 if static else 1.03, coulomb=0.0)
        if name == "coulomb":
            x[0] = 0.3
        expected = by_differences(problem, x)
        inner = np.concatenate([np.abs(trial.t) > 0.006 for trial in TRIALS])
        off = np.abs(problem.linearized(x)[1] - expected)[inner] / np.abs(expected).max(axis=0)
        assert off.max() < (0.02 if name == "coulomb" else 1e-4)

    def test_own_parameters_do_not_reach_other_trials(self):
        problem = posed(per_trial=("damping",))
        jacobian, n = problem.linearized(values(problem))[1], TRIALS[0].t.size
        for column, entry in zip(jacobian.T, problem.entries, strict=True):
            reached = [np.abs(column[:n]).max() > 0, np.abs(column[n:]).max() > 0]
            assert reached == [entry.trial in (None, 0), entry.trial in (None, 1)]

    def test_model_not_smoothed(self):
        trials = [smooth_trial(trial, MovingAverage(20)) for trial in TRIALS]
        problem, plain = posed(trials=trials, smooth_model=False), posed()
        x = values(problem)
        np.testing.assert_array_equal(problem.linearized(x)[1], plain.linearized(x)[1])
        angle = plain.angle(x, 0)
        np.testing.assert_array_equal(problem.smoothed(angle, 0), angle)
        assert (posed(trials=trials).smoothed(angle, 0) != angle).any()


class TestModel:
    def test_by_hand(self):
        problem = posed(known={"coulomb": 0.3})
        x = values(problem)
        trial, (initial, late) = TRIALS[1], x[-2:]
        after = trial.t > late
        expected = np.full(trial.t.size, initial)
        motion = move(LEG, PassiveKnee(46.0, 1.0, 0.3, 1.03), initial, trial.t[after] - late)
        expected[after] = motion.angle
        np.testing.assert_allclose(problem.angle(x, 1), expected, rtol=0, atol=1e-7)
        n = TRIALS[0].t.size
        np.testing.assert_allclose(problem.linearized(x)[0][n:], expected - trial.angle, rtol=0, atol=1e-7)

    def test_static_rest(self):
        problem = posed(static_rest=True)
        x = values(problem, rest_angle=1.27)
        setting = problem.setting(x, 0)
        assert setting.rest_angle == 1.27
        assert equilibrium(LEG, setting.knee) == pytest.approx(1.27, abs=1e-12)

    def test_truth_leaves_the_noise(self):
        problem = posed()
        x = values(problem, stiffness=48.0, damping=0.9, rest_angle=1.02)
        for entry in range(3, 7):
            x[entry] = find_pushed_angle(LEG, TRUTH, 0.05 if entry < 5 else 0.1) if entry % 2 else 0.0
        assert problem.linearized(x)[0].std() == pytest.approx(1e-3, rel=0.1)

    def test_known_rotor_and_one_sided_spring(self):
        setting = posed(known={"rotor_inertia": 0.1}, unilateral=True).setting(np.array([50, 1, 1, 1.5, 0, 1.5, 0]), 0)
        assert setting.leg.rotor == 0.1 and setting.knee.unilateral
        assert posed().setting(np.array([50, 1, 1, 1.5, 0, 1.5, 0]), 0).leg.rotor == LEG.rotor

    def test_guess_is_near(self):
        start = {(entry.name, entry.trial): entry.start for entry in posed().entries}
        assert start["stiffness", None] == pytest.approx(48.0, rel=0.3)
        assert start["damping", None] == pytest.approx(0.9, rel=1.0)
        assert start["rest_angle", None] == pytest.approx(1.02, abs=0.15)
        assert start["initial_angle", 1] == pytest.approx(find_pushed_angle(LEG, TRUTH, 0.1), abs=1e-3)

    def test_integrations_are_counted(self):
        problem = posed()
        problem.angle(values(problem), 0)
        assert problem.tally["integrations"] == 1
        problem.linearized(values(problem))
        assert problem.tally["integrations"] == 1 + 2 * 4


class TestRefused:
    @pytest.mark.parametrize(
        ("options", "kind", "name"),
        [
            ({"vary": ["stifness"]}, "parameter", "stifness"),
            ({"vary": ["initial_angle"]}, "parameter", "initial_angle"),
            ({"per_trial": ["coulomb"]}, "parameter of each trial", "coulomb"),
            ({"nuisances": ["damping"]}, "nuisance", "damping"),
            ({"known": {"release_time": 0.0}}, "known parameter", "release_time"),
            ({"bounds": {"coulomb": (0, 1)}}, "bounded parameter", "coulomb"),
        ],
    )
    def test_names(self, options, kind, name):
        with pytest.raises(UnknownName, match=f"^unknown {kind} '{name}'; valid: "):
            posed(**options)

    @pytest.mark.parametrize("vary", [(), ("damping", "damping")])
    def test_vary(self, vary):
        with pytest.raises(BadValue, match="^vary is "):
            posed(vary)

    def test_no_trials(self):
        with pytest.raises(BadValue, match="^trials is "):
            posed(trials=[])

    @pytest.mark.parametrize(("name", "value"), [("stiffness", -1.0), ("stiffness", 0.0), ("damping", float("nan"))])
    def test_known(self, name, value):
        with pytest.raises(BadValue, match=f"^known {name} is "):
            posed(known={name: value})

    @pytest.mark.parametrize(
        "limits",
        [(60, 40), (50, 50), (-9, -1), (float("nan"), 60), (40, float("nan")), (40,), (1, 2, 3), 40, ("a", "b"), None],
    )
    def test_bounds(self, limits):
        with pytest.raises(BadValue, match="^bounds of stiffness is "):
            posed(bounds={"stiffness": limits})

    def test_bounds_of_the_release_time(self):
        problem = posed(bounds={"release_time": (-0.01, 0.02)})
        assert [e.bounds for e in problem.entries if e.name == "release_time"] == [(-0.01, 0.02)] * 2
        with pytest.raises(BadValue, match="^bounds of release_time is .1, 2.; .* for release$"):
            posed(bounds={"release_time": (1, 2)})

    @pytest.mark.parametrize("shift", [2.0, -3.0])
    def test_beyond_the_joint(self, shift):
        trial = replace(TRIALS[0], angle=TRIALS[0].angle + shift, label="release 7")
        with pytest.raises(BadValue, match="knee's angle in release 7 is .*is the calibration right"):
            posed(trials=[TRIALS[0], trial])
