"""A bound and gaits with their numbers turned: carried from the nearest one that is known."""

import math
import runpy
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Clutch, Gait, Spring, find_gait, hopping, load
from spear_pin.cli.explored import write_script
from spear_pin.errors import BadValue, NoGait, UnknownName
from spear_pin.hybrid.event_feedback import feedback_of
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.studies.explore import carried as module
from spear_pin.studies.explore.carried import LATE, Underway, carry_gait
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.gaits import bound_to_explore, gait_to_explore
from spear_pin.studies.explore.tangents import tangents
from tests.slow import slow_but

pytestmark = pytest.mark.extra  # heyoka runs the cycles where it is installed


@pytest.fixture(scope="module")
def subject():
    return bound_to_explore(Gait.load("long_stride"), "Q-SPEAR bounding", "long_stride")


def test_at_first_it_is_the_gait_itself(subject):
    motion = carry_gait(subject.at())
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
    for subject in (bound_to_explore(Gait.load("force_lift_off"), ""), gait_to_explore(Gait.load("turn_9"), "")):
        assert feedback_of(subject.gait.system) is None
    assert not any(subject.gait.system.law.plane.speed_gain)


@pytest.mark.slow
def test_a_gait_at_another_speed_is_the_one_that_find_gait_finds(subject):
    found = find_gait(subject.gait.system, ["posterior_hip_torque"], {"mean_speed": 2.54}, guess=subject.start)
    motion = carry_gait(subject.at(speed=2.54))
    assert figures(motion)["speed"] == pytest.approx(2.54, abs=1e-6)
    assert motion.gait.parameters == pytest.approx(found.parameters, abs=1e-5)
    assert abs(motion.gait.multipliers[0]) == pytest.approx(abs(found.multipliers[0]), abs=1e-3)


@pytest.mark.slow
def test_where_there_is_no_gait_it_says_how_far_the_way_led(subject, monkeypatch):
    monkeypatch.setattr(module, "PATIENCE", 0.06)
    with pytest.raises(NoGait, match="There is a gait at .*, and none was found beyond: "):
        carry_gait(subject.at(friction=0.1))


@pytest.mark.slow
def test_without_time_the_way_found_so_far_is_kept(subject, monkeypatch):
    subject.remember(subject.known[0])  # the first search of all has no limit
    begun = len(subject.known)
    monkeypatch.setattr(module, "time", SimpleNamespace(perf_counter=lambda: float(len(subject.known) - begun)))
    monkeypatch.setattr(module, "PATIENCE", 0.01)
    with pytest.raises(Underway, match=f"There is a gait at mean speed 2.[678].*{LATE}"):
        carry_gait(subject.at(speed=2.9))
    assert len(subject.known) == begun + 1


@pytest.mark.slow
def test_the_saved_program_computes_what_was_shown(subject, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    motion = carry_gait(subject.at(speed=1.6, friction=0.7, knee_ratio=15.5))
    (tmp_path / "explored_bound.py").write_text(write_script(motion), encoding="utf-8")
    done = runpy.run_path(str(tmp_path / "explored_bound.py"))
    assert done["gait"].parameters == pytest.approx(motion.gait.parameters, rel=1e-6)
    np.testing.assert_allclose(done["gait"].state[0], motion.gait.state[0], atol=1e-5)
    assert (tmp_path / "bound.html").stat().st_size > 500_000


class TestAnyGait:
    """A hop free along x, which has no page of its own; a trot, whose cycle is half a stride."""

    @pytest.fixture(scope="class")
    @staticmethod
    def free():
        return gait_to_explore(find_gait(hopping(load("spear_ii"))), "a hop", ["knee_mass", "stance_torque"])

    @pytest.mark.slow
    def test_it_is_the_gait_that_is_found_with_the_number(self, free):
        value = 1.02 * free.knobs["knee_mass"].default
        motion = carry_gait(free.at(knee_mass=value))
        expected = find_gait(with_numbers(free.gait.system, {"knee_mass": value}), guess=free.start)
        assert number(motion.gait.system, "knee_mass") == value and motion.verdict == "periodic"
        assert figures(motion)["period"] == pytest.approx(expected.period, rel=1e-8)
        assert abs(expected.period - free.gait.period) > 1e-5

    @pytest.mark.parametrize("name", slow_but(["knee_mass", "stance_torque"], "stance_torque"))
    def test_slopes_are_differences_of_figures(self, free, name):
        knob, at = free.knobs[name], {"knee_mass": 1.01 * free.knobs["knee_mass"].default}
        h = 1e-3 * knob.default
        middle = free.at(**at)
        slopes = tangents(carry_gait(middle)).slopes[name]
        a, b = (figures(carry_gait(middle.turned(**{name: middle.values[name] + d}))) for d in (h, -h))
        assert {"period", "peak_force", "peak_torque", "positive_work", "effort"} <= set(slopes)
        for figure in ("period", "peak_force", "peak_torque"):  # integrals of so few samples are too coarse
            assert slopes[figure] == pytest.approx((a[figure] - b[figure]) / (2 * h), rel=1e-3), figure

    @pytest.mark.slow
    def test_the_saved_program_carries_it_too(self, tmp_path, monkeypatch):
        monkeypatch.chdir(tmp_path)
        free = find_gait(hopping(load("spear_ii")))
        free.save(tmp_path / "gait.json")
        motion = carry_gait(
            gait_to_explore(free, "a hop", ["knee_mass"]).at(knee_mass=1.02 * number(free.system, "knee_mass"))
        )
        (tmp_path / "explored.py").write_text(write_script(motion), encoding="utf-8")
        done = runpy.run_path(str(tmp_path / "explored.py"))
        np.testing.assert_allclose(done["gait"].state[0], motion.gait.state[0], atol=1e-8)
        assert done["motion"].t[-1] == pytest.approx(figures(motion)["period"], rel=1e-8)

    @pytest.mark.slow
    def test_a_trot_is_carried(self):
        subject = gait_to_explore(Gait.load("trot"), "a trot", ["hip_spacing"])
        motion = carry_gait(subject.at(hip_spacing=1.01 * subject.knobs["hip_spacing"].default))
        assert motion.verdict == "periodic" and abs(motion.gait.multipliers[0]) == pytest.approx(3.7, abs=0.1)
        assert f"cycles={motion.trajectory.cycles}" in write_script(motion) and motion.trajectory.cycles == 2
        shown, slopes = figures(motion), tangents(motion).slopes["hip_spacing"]
        assert set(slopes) == {name for name, x in shown.items() if x is not None}

    def test_numbers_without_a_name_or_a_range_are_refused(self):
        gait = Gait.load("trot")
        with pytest.raises(UnknownName, match="unknown parameter 'nope'"):
            gait_to_explore(gait, "", ["nope"])
        with pytest.raises(BadValue, match=r"slope is 0.0; expected a number other than zero"):
            gait_to_explore(gait, "", ["slope"])

    def test_sliders_are_numbers_of_springs_ground_and_law(self):
        knobs = gait_to_explore(Gait.load("trot"), "").knobs
        assert {"stiffness", "friction", "leg_stiffness", "stance_span"} <= set(knobs)
        for knob in knobs.values():
            assert knob.low < knob.default < knob.high
            assert math.isclose(knob.low + knob.high, 2 * knob.default, abs_tol=2 * 10.0**-knob.digits)

    @pytest.mark.parametrize("name", ["trot", "turn_9", "long_stride"])
    def test_sliders_reach_their_ends(self, name):
        over = ["hip_rotor"] if name == "trot" else []
        for each in ([], over):
            subject = gait_to_explore(Gait.load(name), "", each)
            for key, knob in subject.knobs.items():
                for end in (knob.low, knob.high):
                    assert subject.read({key: f"{end:.{knob.digits}f}"}).values[key] == end

    def test_and_of_switches_that_are_not_ideal(self):
        late = Spring(clutch=Clutch(0.004, 0.004, pitch=0.05, damper="joint"))
        hop = find_gait(hopping(load("spear_ii", locked=["boom_x"]), spring=late))
        subject = gait_to_explore(hop, "a late hop")
        assert list(subject.knobs)[:6] == ["stiffness", "damping", "on_delay", "off_delay", "pitch", "friction"]
        assert subject.knobs["on_delay"].unit == "s" and subject.knobs["pitch"].unit == "rad"
        h, at = 1e-5, subject.at(pitch=0.04)
        slopes = tangents(carry_gait(at)).slopes["pitch"]
        a, b = (carry_gait(at.turned(pitch=0.04 + d)).gait.period for d in (h, -h))
        assert slopes["period"] == pytest.approx((a - b) / (2 * h), rel=1e-3) and abs(slopes["period"]) > 1e-4
