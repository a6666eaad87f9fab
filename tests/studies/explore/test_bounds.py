"""A bound with its numbers turned: gaits carried from the nearest one that is known."""

import math
import runpy
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Gait, find_gait
from spear_pin.errors import BadValue, NoGait
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.studies.explore import bounds
from spear_pin.studies.explore.bounds import Underway, bound_to_explore, stride
from spear_pin.studies.explore.engines import REFERENCE, TAYLOR, best_engine
from spear_pin.studies.explore.figures import figures, script

pytestmark = pytest.mark.extra  # heyoka runs the strides where it is installed


@pytest.fixture(scope="module")
def subject():
    return bound_to_explore(Gait.load("long_stride"), "Q-SPEAR bounding")


def test_at_first_it_is_the_gait_itself(subject):
    motion = stride(subject.at(), REFERENCE)
    assert motion.gait.system.law.posterior_hip_torque == subject.gait.system.law.posterior_hip_torque
    assert motion.verdict == "periodic" and "unstable: the largest multiplier is 1.067" in motion.message
    assert figures(motion)["speed"] == pytest.approx(2.5, abs=1e-6)


def test_gaits_that_are_no_bounds_are_refused():
    with pytest.raises(BadValue, match="gait is 'trotting'.*a bound in the plane"):
        bound_to_explore(Gait.load("trot"), "")


def test_every_knob_arrives_in_the_system(subject):
    values = {name: knob.default + 0.1 * (knob.high - knob.default) for name, knob in subject.knobs.items()}
    system = subject.at(**values).system
    assert system.spring.stiffness == values["stiffness"] and system.contact.friction == values["friction"]
    for name in ("virtual_stiffness", "anterior_hip_torque", "posterior_leg_touchdown", "anterior_leg_touchdown"):
        assert getattr(system.law, name) == values[name]
    assert {name: system.robot.varied[name] for name in ("knee_ratio", "hip_ratio")} == {
        name: values[name] for name in ("knee_ratio", "hip_ratio")
    }


def test_event_feedback_is_left_out():
    subject = bound_to_explore(Gait.load("force_lift_off"), "")
    assert feedback_of(subject.gait.system) is None and not any(subject.gait.system.law.speed_gain)


@pytest.fixture(scope="module")
def found(subject):
    """What `find_gait` finds at another speed."""
    return find_gait(subject.gait.system, ["posterior_hip_torque"], {"mean_speed": 2.54}, guess=subject.start)


@pytest.mark.slow
@pytest.mark.parametrize(
    "engine",
    [pytest.param(TAYLOR, marks=pytest.mark.extra("heyoka"), id="taylor"), pytest.param(REFERENCE, id="reference")],
)
def test_a_gait_at_another_speed_is_the_one_that_find_gait_finds(subject, found, engine):
    motion = stride(subject.at(speed=2.54), engine)
    assert figures(motion)["speed"] == pytest.approx(2.54, abs=1e-6)
    assert motion.gait.parameters == pytest.approx(found.parameters, abs=1e-5)
    assert abs(motion.gait.multipliers[0]) == pytest.approx(abs(found.multipliers[0]), abs=1e-3)


@pytest.mark.slow
def test_where_there_is_no_gait_it_says_how_far_the_way_led(subject, monkeypatch):
    monkeypatch.setattr(bounds, "PATIENCE", 3.0)
    with pytest.raises(NoGait, match="There is a gait at .*, and none was found beyond: "):
        stride(subject.at(friction=0.1), best_engine())


@pytest.mark.slow
def test_without_time_the_way_found_so_far_is_kept(subject, monkeypatch):
    subject.remember(subject.known[0])  # the first search of all has no limit
    begun, engine = len(subject.known), best_engine()
    monkeypatch.setattr(bounds, "time", SimpleNamespace(perf_counter=lambda: float(len(subject.known) - begun)))
    monkeypatch.setattr(bounds, "PATIENCE", 0.5)

    def first_step_alone(*asked):
        if len(subject.known) > begun:
            raise NoGait("Newton's method takes longer than a few seconds", math.inf)
        return engine.beside(*asked[:-1], math.inf)

    with pytest.raises(Underway, match="There is a gait at mean speed 2.[678]"):
        stride(subject.at(speed=2.9), replace(engine, beside=first_step_alone))
    assert len(subject.known) == begun + 1


@pytest.mark.slow
def test_the_saved_program_computes_what_was_shown(subject, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    motion = stride(subject.at(speed=2.52), best_engine())
    (tmp_path / "explored_bound.py").write_text(script(motion), encoding="utf-8")
    done = runpy.run_path(str(tmp_path / "explored_bound.py"))
    np.testing.assert_allclose(done["gait"].state[0], motion.gait.state[0], atol=1e-5)
    assert (tmp_path / "bound.html").stat().st_size > 500_000
