"""What each knob does to the figures, against figures of motions with the knob a little to either side."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, load, monopod, simulate
from spear_pin.studies.explore.carried import carry_gait
from spear_pin.studies.explore.engines import TAYLOR
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.gaits import bound_to_explore
from spear_pin.studies.explore.hops import settle_hops, transient
from spear_pin.studies.explore.legs import KNOBS, hop_of_leg, spear_ii_hop
from spear_pin.studies.explore.tangents import LONE, MULTIPLIER, SOLVED, tangents, tangents_of_multiplier

pytestmark = pytest.mark.extra("heyoka")
SHARE = 1e-3  # of a range, that a knob is turned either way
FINE = {"hop": 4000, "bound": 2000}  # samples of a phase: figures are of samples
CLOSE = 1e-4


def finely(view, knobs):
    """Figures of finely sampled cycles, and the largest multiplier's modulus."""
    motion = view(knobs, TAYLOR)
    gait = motion.gait
    cycle = simulate(gait.system, gait.state, 1, samples=FINE[knobs.subject.kind], progress=False)
    return figures(replace(motion, trajectory=cycle)) | {MULTIPLIER: abs(gait.multipliers[0])}


def differences(view, knobs, name):
    """Derivatives of figures by a knob, of fourth order."""
    knob = knobs.subject.knobs[name]
    h = SHARE * (knob.high - knob.low)
    a, b, c, d = (finely(view, knobs.turned(**{name: knobs.values[name] + k * h})) for k in (1, -1, 2, -2))
    return {
        key: (8 * (a[key] - b[key]) - (c[key] - d[key])) / (12 * h) for key, value in a.items() if value is not None
    }


def assert_close(knobs, name, slopes, expected, shown, rel):
    """Slopes and differences agree to a share of the figure's elasticity, and of the figure where that is small."""
    span = knobs.subject.knobs[name].high - knobs.subject.knobs[name].low
    part = 1e-5 if knobs.subject.kind == "hop" else 1e-4  # a bound's multipliers are differences of cycles themselves
    for figure, slope in slopes.items():
        assert slope * span == pytest.approx(expected[figure] * span, rel=rel, abs=part * abs(shown[figure])), figure


@pytest.fixture(scope="module")
def hop():
    return settle_hops(spear_ii_hop().at(stiffness=52.0), TAYLOR)


@pytest.fixture(scope="module")
def kept():
    return settle_hops(spear_ii_hop().at(kept=True, stiffness=52.0), TAYLOR)


class TestHop:
    @pytest.mark.slow
    @pytest.mark.parametrize("name", KNOBS)
    def test_against_hops_beside(self, hop, name):
        found, stability = tangents(hop), tangents_of_multiplier(hop)
        slopes = {**found.slopes[name], **stability.slopes[name]}
        assert len(slopes) == 8 and found.reason == stability.reason == "" and not found.refused
        expected = differences(settle_hops, hop.knobs, name)
        assert_close(hop.knobs, name, slopes, expected, finely(settle_hops, hop.knobs), CLOSE)

    @pytest.mark.slow
    @pytest.mark.parametrize("name", ["stiffness", "knee_touchdown"])
    def test_the_flight_time_is_kept(self, kept, name):
        found = tangents(kept)
        assert found.refused == {"stance_torque": SOLVED} and "stance_torque" not in found.slopes
        slopes = {**found.slopes[name], **tangents_of_multiplier(kept).slopes[name]}
        assert abs(slopes.pop("flight_time")) < 1e-12
        assert_close(
            kept.knobs, name, slopes, differences(settle_hops, kept.knobs, name), finely(settle_hops, kept.knobs), CLOSE
        )

    def test_the_torque_before_the_gear_has_the_ratio_in_it(self, hop):
        slopes, shown = tangents(hop).slopes, figures(hop)
        ratio = hop.knobs.values["knee_ratio"]
        elasticity = {
            key: slopes["knee_ratio"][key] * ratio / shown[key] for key in ("rotor_torque_knee", "peak_torque_knee")
        }
        assert elasticity["rotor_torque_knee"] == pytest.approx(elasticity["peak_torque_knee"] - 1.0, abs=1e-3)

    @pytest.mark.slow
    def test_a_toe_that_bounces(self):
        motion = settle_hops(spear_ii_hop().at(stiffness=60.0), TAYLOR)
        slopes = tangents(motion).slopes["damping"] | tangents_of_multiplier(motion).slopes["damping"]
        expected, shown = differences(settle_hops, motion.knobs, "damping"), finely(settle_hops, motion.knobs)
        assert_close(motion.knobs, "damping", slopes, expected, shown, CLOSE)

    def test_toes_that_alternate_are_refused_with_the_reason(self):
        found = tangents(settle_hops(spear_ii_hop().at(knee_ratio=22.0), TAYLOR))
        assert found.slopes == {} and found.reason.endswith("toes alternate")

    def test_what_does_not_repeat_each_hop_has_none(self):
        for motion in (
            transient(spear_ii_hop().at(), TAYLOR),
            settle_hops(spear_ii_hop().at(stance_torque=10.5), TAYLOR),
        ):
            assert tangents(motion).reason == tangents_of_multiplier(motion).reason == LONE

    def test_without_heyoka_they_are_the_same(self, hop, monkeypatch):
        expected = tangents(hop).slopes
        monkeypatch.setitem(sys.modules, "heyoka", None)
        for knob, slopes in tangents(hop).slopes.items():
            assert slopes == pytest.approx(expected[knob], rel=1e-6, abs=1e-9)


@pytest.mark.slow
def test_the_hip_of_another_leg_follows_the_knee():
    whole = load("q_spear_full")
    leg = monopod(whole, next(leg for leg in whole.legs if leg.name == "posterior_left"), "share", ["boom_x"])
    motion = settle_hops(hop_of_leg(leg, "").at(), TAYLOR)
    assert motion.gait.system.law.hip_touchdown is not None
    slopes = tangents(motion).slopes["knee_touchdown"]
    expected = differences(settle_hops, motion.knobs, "knee_touchdown")
    assert len(slopes) >= 5
    assert_close(motion.knobs, "knee_touchdown", slopes, expected, finely(settle_hops, motion.knobs), CLOSE)


@pytest.fixture(scope="module")
def motion():
    return carry_gait(bound_to_explore(Gait.load("long_stride"), "").at(speed=2.52))


def of_bound(knobs, engine):
    """The view of a bound, which needs no engine."""
    return carry_gait(knobs)


class TestBound:
    @pytest.mark.slow
    @pytest.mark.parametrize("name", ["speed", "knee_ratio"])
    def test_against_bounds_beside(self, motion, name):
        found, stability = tangents(motion), tangents_of_multiplier(motion)
        assert found.reason == "" and "posterior_lift_off" in found.one_sided
        slopes = {**found.slopes[name], **stability.slopes[name]}
        assert len(slopes) == 11
        assert_close(
            motion.knobs, name, slopes, differences(of_bound, motion.knobs, name), finely(of_bound, motion.knobs), CLOSE
        )

    def test_the_speed_is_what_its_knob_says(self, motion):
        slopes = tangents(motion).slopes
        assert slopes["speed"]["speed"] == pytest.approx(1.0, abs=1e-9)
        assert max(abs(row["speed"]) for name, row in slopes.items() if name != "speed") < 1e-12

    @pytest.mark.slow
    def test_what_is_zero_is_refused_alone(self, motion):
        knobs = motion.knobs.turned(stiffness=0.0)
        found = tangents(carry_gait(knobs))
        assert list(found.refused) == ["stiffness"] and "stiffness is 0.0" in found.refused["stiffness"]
        assert set(found.slopes) == set(knobs.values) - {"stiffness"}
        assert np.isfinite(list(found.slopes["knee_ratio"].values())).all()
