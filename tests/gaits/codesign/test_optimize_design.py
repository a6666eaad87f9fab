"""Designs of the hop: a minimum known from elsewhere, prices and assumptions against designs found anew, mistakes."""

import json
import re

import numpy as np
import pytest

from spear_pin import Gait, find_gait, load, monopod, optimize_design, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.codesign.design import list_assumed
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.model.catalogue import mass_law, motor
from spear_pin.studies.hop_of_another import hop_of, scaled_hopping
from spear_pin.viz.notebook import card
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.design_by_gradient import optimised
from tests.model.legged import quadruped

pytestmark = pytest.mark.extra("heyoka")
OVER = {"stiffness": (42.0, 60.0), "knee_ratio": (8.0, 30.0), "knee_touchdown": (0.80, 1.02)}
MOTORS = {"knee": motor("spear_ii_knee")}
SLACK = {"margin_spring_switch": 0.02}


def best(gait, over=OVER, **options):
    given = {"at_least": SLACK, "largest_multiplier": 0.6, "motors": MOTORS, **options}
    return optimize_design(gait, "energy", over, {"flight_time": 0.2}, **given)


@pytest.fixture(scope="module")
def found(hop):
    return best(hop)


@pytest.mark.slow
def test_of_a_leg_without_rotors_that_is_free_along_x(tmp_path):
    """As somebody else's file has it, with what assumptions do to it: none of them is a rotor."""
    path = tmp_path / "dog.urdf"
    path.write_text(re.sub(r"<(drake:\w+) value=\"[^\"]*\"/>", "", quadruped()), encoding="utf-8")
    gait = hop_of(scaled_hopping(monopod(load(path, base="free", motors="all"), "HR")), 0.18)
    stiffness = gait.system.spring.stiffness
    design = optimize_design(gait, "effort", over={"stiffness": (0.95 * stiffness, 1.05 * stiffness)})
    assert design.converged and not [name for name in design.assumptions if name.endswith("rotor")]
    step = 1e-3 * stiffness
    ends = [find_again(gait, stiffness + s) for s in (step, -step)]
    more, less = (each.sensitivity(["stiffness"]).outputs["effort"] for each in ends)
    slope = gait.sensitivity(["stiffness"]).derivatives["effort"][0]
    assert (more - less) / (2.0 * step) == pytest.approx(slope, rel=1e-4)


def find_again(gait, stiffness):
    return find_gait(with_numbers(gait.system, {"stiffness": stiffness}), guess=gait.state)


def test_of_a_motor_whose_mass_is_said(hop):
    """Heat and rotor depend on N² r alone, so without a supply only the mass tells sizes apart: the least is best."""
    design = best(hop, {"knee_motor_size": (0.4, 2.0), "knee_ratio": (8.0, 30.0)}, at_least={}, assuming=[])
    size = design.parameters["knee_motor_size"].value
    assert design.converged and design.motor_masses == {"knee": pytest.approx(0.47 * size ** mass_law().exponent)}
    assert f"mass of a knee's motor {design.motor_masses['knee']:.3g} kg, by mass ∝ torque^0.49" in str(design)
    slopes = design.gait.sensitivity(["knee_motor_size", "knee_ratio"], ["stance_torque"], ["flight_time"], MOTORS)
    assert list(design.active) == ["least knee_motor_size"] and size == pytest.approx(0.4)
    price, rest = slopes.derivatives["energy"]
    assert design.active["least knee_motor_size"] == pytest.approx(price, rel=0.01) and abs(rest) < 1e-3


def test_the_minimum_that_others_found(found):
    """By sequential quadratic programming over exact and differenced gradients, from three starts each."""
    assert found.converged and found.objective == pytest.approx(20.4919, abs=2e-4)
    values = {name: each.value for name, each in found.parameters.items()}
    assert values == pytest.approx({"stiffness": 53.45, "knee_ratio": 16.51, "knee_touchdown": 0.8741}, rel=1e-3)
    assert found.largest == pytest.approx(0.436, abs=1e-3)
    assert list(found.active) == ["margin_spring_switch at least"]
    assert found.cycles <= 100 and found.stationarity < 1e-3


def test_the_gait_is_confirmed_by_the_reference_engine(found):
    run = simulate(found.gait.system, found.gait.state, 1, progress=False)
    assert found.gait.residual < 1e-9 and run.complete
    assert found.gait.durations["flight"] == pytest.approx(0.2, abs=1e-8)
    assert np.abs(found.gait.multipliers).max() == pytest.approx(found.largest, abs=1e-5)


@pytest.mark.slow
def test_prices_against_other_bounds(hop, found):
    h = 5e-4
    ends = [best(hop, at_least={"margin_spring_switch": 0.02 + side * h}, assuming=[]).objective for side in (1, -1)]
    (price,) = found.active.values()
    assert price == pytest.approx((ends[0] - ends[1]) / (2.0 * h), rel=1e-3)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["damping", "knee_rotor", "friction"])
def test_assumptions_against_designs_found_anew(found, name):
    from spear_pin.gaits.search import gait_beside

    value, ends = number(found.gait.system, name), []
    for side in (1.0, -1.0):
        system = with_numbers(found.gait.system, {name: value * (1.0 + 2e-3 * side)})
        begun = gait_beside(system, found.gait.state, ["stance_torque"], {"flight_time": 0.2})
        ends.append(best(begun, assuming=[], tolerance=1e-8).objective)
    each = found.assumptions[name]
    assert each.value == pytest.approx(value)
    expected = (ends[0] - ends[1]) / (4e-3 * value)
    assert each.derivative * value == pytest.approx(expected * value, rel=1e-3, abs=2e-4)


@pytest.mark.slow
def test_a_bound_on_the_multipliers_is_kept(hop, found):
    """Below those of the free minimum: it holds the design back, and looser by a little it costs less by its price."""
    h = 5e-4
    tight, here, loose = (best(hop, largest_multiplier=0.43 + side * h, assuming=[]) for side in (-1, 0, 1))
    assert here.converged and here.largest == pytest.approx(0.43, abs=1e-6)
    assert tight.objective > here.objective > loose.objective > found.objective
    (label,) = [each for each in here.active if each.startswith("multiplier")]
    assert (loose.objective - tight.objective) / (2.0 * h) == pytest.approx(here.active[label], rel=0.02)


def test_shown_and_written(found, tmp_path):
    kept = json.loads(found.to_json())
    assert kept["parameters"]["stiffness"]["unit"] == "N·m/rad" and kept["converged"] is True
    assert "margin_spring_switch at least" in str(found) and "20.492" in repr(found)
    text = card(found)
    assert "energy" in text and "knee ratio" in text
    assert save_figure(optimised(found), tmp_path / "design.svg").stat().st_size > 1000
    assert Gait.load(found.gait.save(tmp_path / "gait.json")).state[0] == pytest.approx(found.gait.state[0])


@pytest.mark.parametrize(
    ("over", "options", "text"),
    [
        ({}, {}, "one parameter or more"),
        ({"stiffness": (60.0, 42.0)}, {}, "a least and a greatest value"),
        ({"stiffness": (50.0, 60.0)}, {}, "the gait's own value in it"),
        ({"stance_torque": (5.0, 9.0)}, {}, "other than those that are solved for"),
        ({"stiffness": (42.0, 60.0)}, {"vary": []}, "as many measures"),
        ({"stiffness": (42.0, 60.0)}, {"largest_multiplier": 0.0}, "a number > 0"),
        ({"stiffness": (42.0, 60.0)}, {"at_most": {"work": np.inf}}, "a finite number"),
        (
            {"stiffness": (42.0, 60.0)},
            {"at_most": {"work": 5.0}, "at_least": {"work": 6.0}},
            "at most 5, the value of at_most",
        ),
        ({"stiffness": (42.0, 60.0)}, {"at_most": {"flight_time": 0.1}}, "within at_least and at_most"),
        ({"stiffness": (42.0, 60.0)}, {"assuming": ["stiffness"]}, "in neither over nor vary"),
        ({"stiffness": (42.0, 60.0)}, {"vary": ["stance_torque"] * 2}, "as many measures|each parameter once"),
    ],
)
def test_ranges_that_are_none(hop, over, options, text):
    with pytest.raises(BadValue, match=text):
        best(hop, over, **options)


def test_names_that_are_none(hop):
    for given in ({"at_most": {"nope": 1.0}}, {"at_least": {"margin_nope": 1.0}}, {"motors": {"toe": MOTORS["knee"]}}):
        with pytest.raises(UnknownName, match=r"nope|toe"):
            best(hop, {"stiffness": (42.0, 60.0)}, **given)
    with pytest.raises(UnknownName, match="event.*nope.*torque_switch"):
        best(hop, {"stiffness": (42.0, 60.0)}, at_least={"margin_lift_off_before_nope": 1.0})
    with pytest.raises(UnknownName, match="nope"):
        best(hop, {"nope": (42.0, 60.0)})
    with pytest.raises(UnknownName, match="nope"):
        best(hop, {"stiffness": (42.0, 60.0)}, assuming=["nope"])
    # all but the first are measures, but none that a search keeps
    for name in ("nope", "energy", "margin_spring_switch"):
        with pytest.raises(UnknownName, match=name):
            optimize_design(hop, "work", {"stiffness": (42.0, 60.0)}, {name: 1.0}, motors=MOTORS)
    with pytest.raises(
        BadValue, match=r"measure is 'energy'; expected a measure of a joint that motors names \(none\)"
    ):
        best(hop, {"stiffness": (42.0, 60.0)}, motors={})
    with pytest.raises(BadValue, match=rf"'electricity'.*that motors names \({', '.join(MOTORS)}\)"):
        best(hop, {"stiffness": (42.0, 60.0)}, at_most={"electricity": 20.0})
    with pytest.raises(BadValue, match="target flight_time is -1.0"):
        optimize_design(hop, "work", {"stiffness": (42.0, 60.0)}, {"flight_time": -1.0})


def test_bounds_that_nothing_keeps_are_told(hop):
    found = optimize_design(
        hop, "work", {"stiffness": (42.0, 60.0)}, {"flight_time": 0.2}, at_least={"margin_spring_switch": 5.0}
    )
    assert not found.converged and found.missed == pytest.approx(1.0 - found.margins["spring_switch"] / 5.0, rel=1e-3)
    assert "it began beyond its bounds" in str(found) and "BOUNDS ARE MISSED: the excesses add up to 98" in str(found)


def test_over_a_number_of_a_body(hop):
    assert "knee_ratio" in list_assumed(hop.system, ["stiffness"])
    assumed = list_assumed(hop.system, ["knee_mass"])
    assert "knee_ratio" not in assumed and "damping" in assumed


def test_what_is_no_minimum_has_no_prices(hop):
    """Its gradient is not balanced, so that multipliers say nothing."""
    bounds = {"at_most": {"peak_torque_knee": 20.0}, "iterations": 1}
    found = optimize_design(hop, "work", {"knee_mass": (0.4, 0.6)}, {"flight_time": 0.2}, **bounds)
    assert not found.converged and not found.active and not found.assumptions


def test_bounds_that_cannot_be_met_have_no_price(hop):
    bounds = {"at_most": {"peak_torque_knee": 6.0}, "at_least": {"peak_force_toe": 1e4}, "assuming": []}
    found = best(hop, {"stiffness": (47.0, 50.0)}, **bounds)
    assert not found.converged and found.reason
    assert all("peak" not in name for name in found.active)


@pytest.mark.slow
def test_a_toe_that_is_to_be_lifted_higher(hop):
    """Its height is Pinocchio's along the reference engine's motion."""
    bounds, over = {"greatest_height_toe": 0.072}, {"knee_ratio": (12.0, 18.0)}
    found = optimize_design(hop, "peak_torque_knee", over, {"flight_time": 0.2}, at_least=bounds, assuming=[])
    assert found.converged and list(found.active) == ["greatest_height_toe at least"]
    run = simulate(found.gait.system, found.gait.state, 1, samples=4000, progress=False)
    assert max(found.gait.system.robot.toe_position(q, "toe")[-1] for q in run.q) == pytest.approx(0.072, abs=1e-7)


def test_keeps_away_from_where_no_gait_is(hop):
    """Without a margin the hop without flight kept would fall off the end of its family; each step has a gait."""
    end = best(hop, at_least={}, largest_multiplier=None, assuming=[])
    assert end.objective < 20.2142 and end.gait.residual < 1e-9
