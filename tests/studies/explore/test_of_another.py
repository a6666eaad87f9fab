"""The hop of another robot's leg with its numbers turned: sliders of its own size."""

import runpy
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import load, monopod
from spear_pin.cli.explored import write_script
from spear_pin.errors import BadValue
from spear_pin.model.scale import scale_of
from spear_pin.studies.explore.engines import REFERENCE
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.hops import settle_hops
from spear_pin.studies.explore.legs import KNOBS, hop_of_leg


@pytest.fixture(scope="module")
def leg():
    whole = load("q_spear_full")
    found = next(leg for leg in whole.legs if leg.name == "posterior_left")
    return monopod(whole, replace(found, side=1), "share", ["boom_x"])


@pytest.fixture(scope="module")
def subject(leg):
    return hop_of_leg(leg, "Q-SPEAR, leg posterior_left, hopping")


@pytest.mark.slow
def test_sliders_are_of_the_legs_own_size(leg, subject):
    scale = scale_of(leg)
    assert list(subject.knobs) == [name for name in KNOBS if name != "knee_ratio"]
    for name, factor in (("stiffness", scale.torque), ("frequency", 1 / scale.time)):
        knob = subject.knobs[name]
        assert knob.default == pytest.approx(KNOBS[name].default * factor, rel=1e-3)
        assert knob.low < knob.default < knob.high and knob.origin == "scaled"
    assert subject.knobs["friction"] == KNOBS["friction"]


@pytest.mark.slow
def test_it_begins_at_a_hop_whose_torque_was_solved_for(subject):
    hops = settle_hops(subject.at(), REFERENCE)
    assert hops.verdict == "periodic"
    assert hops.gait.durations["flight"] == pytest.approx(subject.wanted, abs=2e-5)
    assert subject.knobs["stance_torque"].origin == "solved" and "s of flight" in subject.keeps
    known = figures(hops)
    assert known["rotor_torque_knee"] is None and known["apex_height"] > 0


@pytest.mark.slow
def test_the_toe_stays_below_the_hip(subject, leg):
    knobs = subject.at(knee_touchdown=1.1)
    assert knobs.system.law.hip_touchdown == pytest.approx(leg.legs[0].lean(1.1))


def test_a_leg_that_may_run_off_is_refused(leg):
    with pytest.raises(BadValue, match="boom_x"):
        hop_of_leg(monopod(leg.cut.robot, leg.cut.legs[0][0]), "")


@pytest.mark.slow
def test_the_saved_program_cuts_the_leg_again(subject, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    hops = settle_hops(subject.at(friction=0.7), REFERENCE)
    program = tmp_path / "explored_hop.py"
    program.write_text(write_script(hops), encoding="utf-8")
    done = runpy.run_path(str(program))
    np.testing.assert_allclose(done["hops"].q, hops.trajectory.q, atol=1e-6)
