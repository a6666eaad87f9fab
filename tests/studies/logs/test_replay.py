"""Replays: of logs that the model made itself, with other numbers, and by the values of a fit."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import hopping, load, simulate
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.studies.logs import identify_motion, replay
from tests.studies.logs.crank_leg import two_joints

pytestmark = pytest.mark.extra("heyoka")


def test_the_model_s_own_log_comes_back(bare, plain_log):
    log, trajectory = plain_log
    found = replay(bare, log)
    assert len(found.hops) == 3
    for name in ("compression", "stance", "push_off"):
        assert abs(found.off(name)) < 2e-3
    lift_offs = [event.time for event in trajectory.events if event.name == "lift_off"]
    assert [hop.lift_off for hop in found.hops] == pytest.approx(lift_offs, abs=2e-3)
    assert max(hop.rms for hop in found.hops) < 2e-2
    assert repr(found).startswith("Replay('synthetic': 3 hops; model less log: compression ")


def test_a_weaker_motor_pushes_off_slower(bare, plain_log):
    weak = replay(bare, plain_log[0], {"torque_scale": 0.9})
    assert weak.off("push_off") < -0.02
    assert weak.off("compression") > 0.02


def test_a_fit_is_replayed_with_its_values(bare, plain_log):
    log = plain_log[0]
    stronger = replace(log, values={**log.values, "crank_torque": log["crank_torque"] / 1.1})
    fit = identify_motion(bare, stronger, ["torque_scale"])
    assert fit["torque_scale"].value == pytest.approx(1.1, rel=1e-4)
    assert abs(replay(fit, stronger).off("push_off")) < 2e-3 < abs(replay(bare, stronger).off("push_off"))


def test_a_leg_that_never_lifts_off_has_no_push_off(bare, plain_log):
    weak = replay(bare, plain_log[0], {"torque_scale": 0.01})
    assert np.isnan(weak.off("push_off")) and np.isfinite(weak.off("compression"))
    assert repr(weak).endswith(" %, stance –, push_off –)")


def test_a_model_that_blows_up_is_refused(bare, plain_log):
    with pytest.raises(BadValue, match="values is .'crank_viscous': 1000000.0.; expected values with which the model"):
        replay(bare, plain_log[0], {"crank_viscous": 1e6})


def test_the_law_makes_the_log_that_it_made():
    """SPEAR-II: the law acts from the fitted state on, and the spring was latched where the log says."""
    robot = load("spear_ii", locked=["boom_x"])
    system = hopping(robot)
    run = simulate(system, system.guess(), 2, samples=2000, progress=False)
    log = two_joints(run)
    found = replay(system, log, motors="law")
    lift_offs = [event.time for event in run.events if event.name == "lift_off"]
    assert [hop.lift_off for hop in found.hops] == pytest.approx(lift_offs, abs=2e-3)
    assert max(hop.rms for hop in found.hops) < 2e-2
    assert abs(found.off("push_off")) < 1e-2
    weaker = replay(with_numbers(system, {"stance_torque": 6.0}), log, motors="law")
    assert weaker.off("push_off") < -0.03
    # the weaker leg lands sooner, where its motion ends
    assert np.isnan(weaker.hops[0].modelled[-1]).all() and np.isfinite(weaker.hops[0].modelled[0]).all()
    # by the law a toe may slide; by the log it rests
    assert replay(system, log, {"friction": 0.3}, motors="law").hops[0].rms > 2.0 * found.hops[0].rms
    with pytest.raises(UnknownName, match="unknown number of the leg 'friction'"):
        replay(system, log, {"friction": 0.3})


def test_refuses(bare, plain_log):
    log = plain_log[0]
    with pytest.raises(BadValue, match="window is 0.0; expected a number > 0, in s"):
        replay(bare, log, window=0.0)
    with pytest.raises(BadValue, match=r"window is 100.0; expected at most 0\.\d+ s, the time of the longest stance"):
        replay(bare, log, window=100.0)
    with pytest.raises(BadValue, match="motors is 'both'; expected 'measured' or 'law'"):
        replay(bare, log, motors="both")
    with pytest.raises(UnknownName, match="'mass'"):
        replay(bare, log, {"mass": 1.0})
    with pytest.raises(BadFile, match="it has no hop"):
        replay(bare, replace(log, values={**log.values, "crank": np.zeros_like(log.t)}))
