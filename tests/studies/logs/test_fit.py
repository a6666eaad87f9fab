"""Values fitted to synthetic logs, whose truth is known; what is doubted and refused."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.interpolate import CubicHermiteSpline

from spear_pin import hopping, load, simulate, vary
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import number
from spear_pin.studies.logs import Log, identify_motion, replay
from spear_pin.studies.logs.shooting import Shooter
from spear_pin.viz.plots.logs import fit_over_log
from tests.studies.logs.crank_leg import DEGREE, configured, sampled, spring, synthetic, two_joints

pytestmark = pytest.mark.extra("heyoka")
NOISE = 5e-4  # rad
LEG = {"torque_scale": 1.0, "crank_armature": 0.00473, "crank_viscous": 0.021}
SPRING = {"stiffness": 400.0, "rest": spring().rest}


def noisy(log, seed=0, size=NOISE):
    angle = log["crank"] + size * np.random.default_rng(100 + seed).standard_normal(len(log.t))
    return replace(log, values={**log.values, "crank": angle})


def test_without_noise_the_truth_comes_back(bare, plain_log):
    found = identify_motion(bare, plain_log[0], list(LEG))
    assert {name: found[name].value for name in LEG} == pytest.approx(LEG, rel=1e-3)
    assert found.converged
    assert found.rms < 1e-5
    assert number(found.system, "crank_armature") == found["crank_armature"].value
    assert [found[name].unit for name in LEG] == ["1", "kg·m²", "N·m·s/rad"]


def lagging(crank, plain_log):
    _, trajectory = plain_log
    t, angle, torque = sampled(trajectory, crank)
    late = np.interp(t - 0.003, t, angle)
    return Log("late", t[3:], {"crank": late[3:], "crank_torque": torque[3:]})


def irregular(log):
    draws = np.random.default_rng(4)
    kept = draws.random(len(log.t)) < 0.9
    kept[400:406] = False
    return Log("irregular", log.t[kept], {name: each[kept] for name, each in log.values.items()})


def quantised(log):
    return replace(log, values={**log.values, "crank": np.round(log["crank"] / (0.02 * DEGREE)) * 0.02 * DEGREE})


def stronger(log):
    return replace(log, values={**log.values, "crank_torque": log["crank_torque"] / 1.1})


def turned(log):
    return replace(log, values={**log.values, "crank": log["crank"] + DEGREE})


@pytest.fixture(scope="module")
def cases(crank, bare, sprung, plain_log):
    """Systems, logs and truths by name."""
    log = plain_log[0]
    rough = synthetic(with_dry_friction(configured(crank), {"crank": 0.08}))[0]
    springy = synthetic(configured(crank, springs={"leg": spring()}))[0]
    softer = hopping(crank, spring={"leg": spring(200.0, SPRING["rest"] + 0.005)})
    heavy = vary(crank, crank_armature=0.004, crank_viscous=0.03)
    elsewhere = hopping(heavy, spring={"leg": replace(spring(), stiffness=0.0)})
    return {
        "noise": (bare, noisy(log), LEG),
        "noise, another": (bare, noisy(log, 1, 2e-3), LEG),
        "rounded": (bare, quantised(noisy(log, 10, 2e-4)), LEG),
        "late": (bare, noisy(lagging(crank, plain_log), 2), {**LEG, "lag": 0.003}),
        "zero": (bare, noisy(turned(log), 3), {**LEG, "crank_zero": DEGREE}),
        "torque": (bare, noisy(stronger(log), 4), {**LEG, "torque_scale": 1.1}),
        "friction": (bare, noisy(rough, 5), {**LEG, "crank_friction": 0.08}),
        "irregular": (bare, noisy(irregular(log), 6), LEG),
        "begun elsewhere": (elsewhere, noisy(log, 7), LEG),
        "spring": (softer, noisy(springy, 8), SPRING),
        "spring and leg": (sprung, noisy(springy, 9), {**LEG, **SPRING}),
        "spring, rounded": (softer, quantised(noisy(springy, 11, 2e-4)), SPRING),
    }


@pytest.mark.slow
def test_most_values_are_within_two_deviations(cases):
    fits = {name: identify_motion(system, log, list(truth)) for name, (system, log, truth) in cases.items()}
    assert max(fit.rms for fit in fits.values()) < 2.2e-3  # no more than the noise, so that deviations are small
    away = {
        (name, what): (fits[name][what].value - value) / fits[name][what].deviation
        for name, (_, _, truth) in cases.items()
        for what, value in truth.items()
    }
    outside = {name: each for name, each in away.items() if abs(each) > 2.0}
    assert len(outside) <= 0.1 * len(away), outside
    assert max(map(abs, away.values())) < 5.0
    assert 0.5 < np.sqrt(np.mean(np.square([*away.values()]))) < 1.5  # deviations are not too large either


@pytest.mark.slow
def test_a_second_sensor_has_a_lag_a_zero_and_a_noise_of_its_own(bare, plain_log):
    """The base's height, as a camera may see it: late, from another zero, at every other sample."""
    (log, run), lag, zero, noise = plain_log, 0.003, 0.05, 2e-4
    t, first = np.unique(run.t, return_index=True)
    line = CubicHermiteSpline(t, run.q[first, 0], run.v[first, 0])
    height = line(log.t - lag) + zero + noise * np.random.default_rng(8).standard_normal(len(log.t))
    height[::2] = np.nan
    both = replace(noisy(log), values={**noisy(log).values, "boom_z": height})
    fit = identify_motion(bare, both, ["torque_scale", "boom_z_zero", "boom_z_lag"])
    truth = {"torque_scale": 1.0, "boom_z_zero": zero, "boom_z_lag": lag}
    away = {name: (fit[name].value - value) / fit[name].deviation for name, value in truth.items()}
    assert max(map(abs, away.values())) < 2.0, away
    assert fit["boom_z_zero"].deviation < 4 * noise / np.sqrt(120) and fit["boom_z_lag"].deviation < 1e-4
    assert [fit[name].unit for name in truth] == ["1", "m", "s"] and fit.joints == ("crank", "boom_z")
    own = np.concatenate([residual[np.isfinite(residual[:, 1])] for residual in fit.residuals])
    assert own.std(axis=0) == pytest.approx([NOISE, noise], rel=0.1)
    assert fit.rms == pytest.approx(NOISE, rel=0.05)
    assert len(fit_over_log(fit).axes) == 4  # both sensors, and the residuals of each
    held = identify_motion(bare, both, ["torque_scale"], start={"boom_z_zero": zero, "boom_z_lag": lag})
    assert held["torque_scale"].value == pytest.approx(1.0, abs=2e-3) and held.joints == fit.joints


def test_a_second_sensor_that_is_not_in_the_log_is_named(bare, plain_log):
    with pytest.raises(UnknownName, match="quantity of the log synthetic 'boom_z'; valid: crank, crank_torque"):
        identify_motion(bare, plain_log[0], ["boom_z_lag"])


@pytest.mark.slow
def test_a_leg_of_two_joints_with_a_switched_spring():
    """SPEAR-II, hip and knee measured; where its spring was latched follows from the log."""
    robot = load("spear_ii", locked=["boom_x"])
    system = hopping(robot)
    run = simulate(system, system.guess(), 3, samples=2000, progress=False)
    softer = hopping(robot, spring=replace(system.spring, stiffness=40.0))
    found = identify_motion(softer, two_joints(run, 4000.0), ["stiffness", "damping"])
    assert found["stiffness"].value == pytest.approx(48.84, rel=1e-3)
    assert found["damping"].value == pytest.approx(1.3, rel=5e-3)
    turned = identify_motion(softer, two_joints(run, 4000.0, DEGREE), ["stiffness", "knee_zero"])
    assert turned["stiffness"].value == pytest.approx(48.84, rel=2e-3)
    assert turned["knee_zero"].value == pytest.approx(DEGREE, rel=1e-2)


def test_a_missing_torque_is_refused_and_a_hole_in_it_leaves_the_phase_out(bare, plain_log):
    log = plain_log[0]
    with pytest.raises(BadValue, match="expected 'crank_torque' as well; of a motor that is off, zeros"):
        identify_motion(bare, replace(log, values={"crank": log["crank"]}), ["crank_armature"])
    holed = np.where(abs(log.t - 0.5) < 0.05, np.nan, log["crank_torque"])
    found = identify_motion(bare, replace(log, values={**log.values, "crank_torque": holed}), ["crank_viscous"])
    assert [(phase.name, phase.left_out) for phase in found.left_out] == [
        ("stance", "101 ms have no position or torque")
    ]


def test_dry_friction_of_the_system_is_refused(crank, plain_log):
    rough = with_dry_friction(hopping(crank, spring={"leg": spring()}), {"crank": 0.1})
    with pytest.raises(BadValue, match="dry friction or brake is .'crank'.; expected a system without"):
        identify_motion(rough, plain_log[0], ["stiffness"])


@pytest.mark.slow
@pytest.mark.parametrize(("friction", "said"), [(0.1, False), (3.0, True)])
def test_friction_that_is_stiffer_than_the_steps_is_told(bare, plain_log, friction, said):
    whole = plain_log[0]
    kept = whole.t < 0.42
    log = Log("one hop", whole.t[kept], {name: each[kept] for name, each in whole.values.items()})
    given = {"crank_friction": friction}
    found = identify_motion(bare, log, ["crank_armature"], start=given, phases=["flight"])
    assert any("stiffer than the integration resolves" in each for each in found.doubts) is said
    assert "1 phase is few: the deviations do not tell how hops differ" in found.doubts
    shooter = Shooter(found.leg, ("crank_armature",))
    (arc,), (shot,) = found.arcs, found.shots
    finer = shooter.shoot("flight", arc.t, arc.torques, shot.y[0], shot.dy[0], arc.near, steps=32).dy[:, 1, 0]
    assert said or shot.dy[:, 1, 0] == pytest.approx(finer, abs=0.1 * abs(finer).max())


def test_what_is_hardly_told_apart_is_said(bare, plain_log):
    found = identify_motion(bare, noisy(plain_log[0]), [*LEG, "crank_friction"])
    assert any(each.startswith("crank_viscous and crank_friction are hardly told apart") for each in found.doubts)
    assert "masses were held: torque_scale and all inertias and forces go with them" in found.doubts


def test_what_is_not_told_apart_at_all_is_refused(bare, plain_log):
    """Every force and inertia is one scale: forces, rotor, friction and masses together have none."""
    masses = [
        "boom_z_mass",
        "slide_mass",
        "crank_mass",
        "rod_mass",
        "crank_inertia",
        "rod_inertia",
        "rod_com_z",
        "crank_com_x",
    ]
    with pytest.raises(BadValue, match="the data do not tell .* apart; hold one that was measured otherwise"):
        identify_motion(bare, plain_log[0], [*LEG, *masses])


def test_a_wrong_mass_scales_all_forces(crank, plain_log):
    heavier = vary(crank, boom_z_mass=1.1 * number(hopping(crank), "boom_z_mass"), slide_mass=1.1 * 0.15)
    system = hopping(heavier, spring={"leg": replace(spring(), stiffness=0.0)})
    found = identify_motion(system, plain_log[0], list(LEG))
    expected = {name: 1.1 * value for name, value in LEG.items()}
    assert {name: each.value for name, each in found.found.items()} == pytest.approx(expected, rel=2e-3)
    assert "masses were held: torque_scale and all inertias and forces go with them" in found.doubts


def test_a_spring_that_is_not_there_has_no_stiffness(sprung, plain_log):
    found = identify_motion(sprung, plain_log[0], ["stiffness"])
    assert abs(found["stiffness"].value) < 2.0 * found["stiffness"].deviation < 0.1


def test_a_model_that_misses_something_is_told(crank, plain_log):
    stiff = hopping(crank, spring={"leg": spring(1500.0)})
    found = identify_motion(stiff, plain_log[0], ["crank_viscous"])
    assert any(each.startswith("the model misses something: the residuals are") for each in found.doubts)


def test_a_phase_that_is_something_else_is_told(bare, plain_log):
    log = plain_log[0]
    bent = log["crank"] + np.where(abs(log.t - 0.5) < 0.05, 0.05 * np.cos(10 * np.pi * (log.t - 0.5)) ** 2, 0.0)
    found = identify_motion(bare, replace(log, values={**log.values, "crank": bent}), list(LEG))
    assert any("the stance from 0.415 s of synthetic fits worse than the others" in each for each in found.doubts)
    assert not any("how hops differ" in each for each in found.doubts)


@pytest.mark.parametrize(
    "error, over, options, text",
    [
        (UnknownName, ["weight"], {}, "unknown number of the leg 'weight'; nearest of"),
        (BadValue, [], {}, "over is []; expected names of some numbers, each once"),
        (BadValue, ["lag", "lag"], {}, "names of some numbers, each once"),
        (BadValue, ["lag"], {"phases": ["apex"]}, "phases is ['apex']; expected 'stance', 'flight' or both"),
        (BadValue, ["lag"], {"settle": -1.0}, "settle is -1.0; expected a number >= 0, in s"),
        (UnknownName, ["lag"], {"start": {"mass": 1.0}}, "unknown number of the leg 'mass'"),
    ],
)
def test_refuses(bare, plain_log, error, over, options, text):
    with pytest.raises(error) as caught:
        identify_motion(bare, plain_log[0], over, **options)
    assert text in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_model_that_blows_up_at_the_start_is_refused(bare, plain_log):
    with pytest.raises(BadValue, match="start is .'crank_viscous': 1000000.0.; expected values with which the model"):
        identify_motion(bare, plain_log[0], ["crank_viscous"], start={"crank_viscous": 1e6})


@pytest.mark.parametrize(
    ("name", "value", "said"),
    [
        ("lag", np.nan, "lag is nan; expected a number from -1 to 1, in s"),
        ("lag", 10.0, "lag is 10.0; expected a number from -1 to 1, in s"),
        ("crank_zero", np.inf, "crank_zero is inf; expected a finite number"),
        ("crank_friction", -1.0, "crank_friction is -1.0; expected a number >= 0"),
        ("hysteresis", -1.0, "hysteresis is -1.0; expected a number >= 0"),
        ("torque_scale", 0.0, "torque_scale is 0.0; expected a number > 0"),
    ],
)
def test_values_that_a_number_cannot_have_are_refused(sprung, plain_log, name, value, said):
    with pytest.raises(BadValue, match=said):
        identify_motion(sprung, plain_log[0], ["stiffness"], start={name: value})
    with pytest.raises(BadValue, match=said):
        replay(sprung, plain_log[0], {name: value})


def test_numbers_that_only_the_played_law_has_and_those_of_the_ground_are_not_offered(sprung, plain_log):
    for name in ("leg_shift", "leg_hysteresis", "crank_torque", "friction", "slope", "height"):
        with pytest.raises(UnknownName, match=f"unknown number of the leg '{name}'") as raised:
            identify_motion(sprung, plain_log[0], [name])
        assert {"torque_scale", "crank_friction", "stiffness", "rest", "hysteresis", "lag"} <= {*raised.value.valid}
        assert name not in raised.value.valid


def test_a_log_that_is_given_twice_is_refused(bare, plain_log):
    with pytest.raises(BadValue, match="log is .'synthetic', 'synthetic'.; expected different logs, each once"):
        identify_motion(bare, [plain_log[0]] * 2, ["crank_armature"])
