"""Spread of outputs against closed forms, covariances by hand, and gaits found anew."""

import json
import re
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import find_gait, hopping, load
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.lane_measures import MEASURES
from spear_pin.gaits.many import find_many
from spear_pin.gaits.sensitivity import samples
from spear_pin.gaits.sensitivity.samples import find_anew, side_by_side
from spear_pin.gaits.sensitivity.spread import covariance_of, factor
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.parameters import with_numbers
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.viz.notebook import card
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.uncertainty import monte_carlo, variance_shares

pytestmark = pytest.mark.extra("heyoka")
OVER = ("stiffness", "damping", "knee_touchdown")
SMALL = {"stiffness": 0.5, "damping": "2 %", "knee_touchdown": 0.002}


@pytest.fixture(scope="module")
def hop():
    system = hopping(load("spear_ii", locked=["boom_x"]))
    return find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2}, rtol=1e-12)


@pytest.fixture(scope="module")
def table(hop):
    return hop.sensitivity(OVER, ["stance_torque"], ["flight_time"], {"knee": motor("spear_ii_knee")})


@pytest.fixture(scope="module")
def spread(table):
    return table.uncertainty(SMALL)


@pytest.fixture(scope="module")
def drawn(spread):
    return spread.monte_carlo(60, seed=3)


def with_slopes(spread, slopes, covariance):
    """The same with an output "y" of these slopes alone."""
    own = {"outputs": {"y": 1.0}, "output_units": {"y": "1"}, "derivatives": {"y": np.array(slopes, dtype=float)}}
    return replace(spread, table=replace(spread.table, **own), covariance=np.array(covariance, dtype=float))


class TestFirstOrder:
    def test_by_hand(self, spread):
        # y = 3 a + 4 b + 0 c with σ = 2, 1, 5: σ² = 36 + 16
        y = with_slopes(spread, [3.0, 4.0, 0.0], np.diag([4.0, 1.0, 25.0]))
        assert y.deviation("y") == pytest.approx(np.sqrt(52.0), rel=1e-15)
        assert y.shares("y") == pytest.approx([36 / 52, 16 / 52, 0.0])
        assert y.gains("y") == pytest.approx(y.shares("y")) and not y.correlated
        assert y.best("y") == "stiffness"

    def test_correlated_by_hand(self, spread):
        # a and b with σ = 1 and correlation 0.8: var(a + b) = 3.6, var(a + b | a) = var(b | a) = 1 - 0.64
        half = with_slopes(spread, [1.0, 1.0, 0.0], [[1.0, 0.8, 0.0], [0.8, 1.0, 0.0], [0.0, 0.0, 1.0]])
        assert half.deviation("y") ** 2 == pytest.approx(3.6)
        assert half.gains("y") == pytest.approx([1.0 - 0.36 / 3.6, 1.0 - 0.36 / 3.6, 0.0])
        assert half.shares("y") == pytest.approx([0.5, 0.5, 0.0]) and half.correlated
        # y = a does not name b, yet to know b tells 0.64 of it
        one = with_slopes(spread, [1.0, 0.0, 0.0], half.covariance)
        assert one.gains("y") == pytest.approx([1.0, 0.64, 0.0]) and one.shares("y") == pytest.approx([1.0, 0.0, 0.0])
        # errors that cancel: var(a - b) = 0.4, of which one share is negative where slopes differ
        other = with_slopes(spread, [2.0, -1.0, 0.0], half.covariance)
        assert other.shares("y").sum() == pytest.approx(1.0) and other.shares("y").min() < 0.0

    def test_a_gain_is_what_conditioning_takes_away(self, spread):
        rng = np.random.default_rng(1)
        root = rng.standard_normal((3, 3))
        covariance, slopes = root @ root.T, rng.standard_normal(3)
        y = with_slopes(spread, slopes, covariance)
        for i in range(3):
            rest = [j for j in range(3) if j != i]
            left = (
                covariance[np.ix_(rest, rest)] - np.outer(covariance[rest, i], covariance[i, rest]) / covariance[i, i]
            )
            known = slopes[rest] @ left @ slopes[rest]
            assert y.gains("y")[i] == pytest.approx(1.0 - known / (slopes @ covariance @ slopes))

    def test_the_order_of_parameters_does_not_matter(self, hop, spread):
        order = [2, 0, 1]
        motors = spread.table.motors
        other = hop.sensitivity([OVER[i] for i in order], ["stance_torque"], ["flight_time"], motors).uncertainty(SMALL)
        for name in spread.outputs:
            # derivatives of multipliers are differences
            assert other.deviation(name) == pytest.approx(spread.deviation(name), rel=1e-6, abs=1e-12)
            if spread.moves(name):
                assert other.gains(name) == pytest.approx(spread.gains(name)[order], rel=1e-5, abs=1e-9)

    def test_what_is_kept_does_not_move(self, spread):
        assert not spread.moves("flight_time") and not spread.gains("flight_time").any()
        with pytest.raises(BadValue, match="one that moves"):
            spread.best("flight_time")

    def test_what_has_no_derivative_has_no_deviation(self, spread):
        y = with_slopes(spread, [1.0, np.nan, 0.0], np.diag([1.0, 1.0, 1.0]))
        assert np.isnan(y.deviation("y")) and json.loads(y.to_json())["outputs"]["y"]["deviation"] is None


class TestSpread:
    def test_shares_and_numbers(self):
        found = covariance_of({"b": "50 %", "a": 2}, ("a", "b", "c"), np.array([1.0, -4.0, 3.0]))
        assert np.diag(found) == pytest.approx([4.0, 4.0, 0.0]) and np.count_nonzero(found) == 2

    def test_a_factor_of_a_singular_covariance(self):
        covariance = np.array([[4.0, 2e-3, 0.0], [2e-3, 1e-6, 0.0], [0.0, 0.0, 0.0]])
        root = factor(covariance)
        assert root @ root.T == pytest.approx(covariance, rel=1e-12, abs=1e-16)

    @pytest.mark.parametrize(
        ("spread", "error", "text"),
        [
            ({"nope": 1.0}, UnknownName, "'nope'; valid: stiffness"),
            ({"stiffness": -1.0}, BadValue, "a finite number >= 0"),
            ({"stiffness": float("nan")}, BadValue, "a finite number >= 0"),
            ({"stiffness": "much"}, BadValue, "'much'"),
            (np.eye(2), BadValue, "3 by 3"),
            (np.diag([1.0, np.inf, 1.0]), BadValue, "finite"),
            ([[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 1.0]], BadValue, "negative variance"),
            ([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], BadValue, "symmetric"),
        ],
    )
    def test_what_is_refused(self, table, spread, error, text):
        with pytest.raises(error, match=text):
            table.uncertainty(spread)

    def test_a_share_of_nothing(self):
        with pytest.raises(BadValue, match="value is 0"):
            covariance_of({"a": "1 %"}, ("a",), np.zeros(1))


class TestMonteCarlo:
    def test_each_sample_is_a_gait(self, hop, spread, drawn):
        found = drawn.samples
        assert found.alike.all()
        for i in (0, 7):
            numbers = dict(zip(OVER, found.parameters[i].tolist(), strict=True))
            numbers["stance_torque"] = float(found.outputs["stance_torque"][i])
            system = with_numbers(hop.system, numbers)
            state = [
                np.array([found.outputs[f"{kind}_{name}"][i] for name in system.robot.coordinates]) for kind in "qv"
            ]
            run = simulate(system, (state[0], state[1]), rtol=1e-11, samples=2000, progress=False)
            assert run.t[-1] - run.t[0] == pytest.approx(found.outputs["period"][i], rel=1e-8)
            assert found.outputs["flight_time"][i] == pytest.approx(0.2, rel=1e-8)
            force = run.force[:, 0, -1].max()
            assert force == pytest.approx(found.outputs["peak_force_toe"][i], rel=1e-3) and force <= (
                found.outputs["peak_force_toe"][i] * (1.0 + 1e-9)
            )
            rates = run.v[:, [system.robot.index(joint) for joint in system.robot.actuated]]
            powers = np.maximum(run.u * rates, 0.0).sum(axis=1)
            worked = float(np.trapezoid(powers, run.t))
            assert worked == pytest.approx(found.outputs["positive_work"][i], rel=1e-4)
            heights = [system.robot.toe_position(q, "toe")[-1] for q in run.q]
            assert max(heights) == pytest.approx(found.outputs["greatest_height_toe"][i], rel=1e-5)
            knee = run.u[:, system.robot.actuated.index("knee")]
            heat = float(np.trapezoid(Drive(motor("spear_ii_knee"), Gearbox(15.0), 24.0).joule_power(knee, 1.0), run.t))
            assert heat == pytest.approx(found.outputs["heat_knee"][i], rel=1e-3)
            peak = np.abs(run.u).max(axis=0)
            for j, joint in enumerate(system.robot.actuated):
                assert peak[j] == pytest.approx(found.outputs[f"peak_torque_{joint}"][i], rel=1e-3)

    def test_what_is_found_in_lanes_is_found_alone(self, spread):
        chosen = spread.table.given + np.array([[0.4, 0.02, -0.002], [-0.6, -0.03, 0.003]])
        assert side_by_side(spread.table)
        lanes, alone = find_anew(spread.table, chosen), samples._one_by_one(spread.table, chosen, lambda n: None)
        assert lanes.alike.all() and alone.alike.all()
        assert set(lanes.outputs) == set(alone.outputs)
        for name, values in lanes.outputs.items():
            # multipliers of lanes are differences, peaks between points are looked for in another way
            assert values == pytest.approx(alone.outputs[name], rel=1e-6, abs=1e-9), name

    def test_it_follows_the_tangent(self, drawn):
        for name in drawn.first:
            if drawn.verdict(name) != "stays":
                assert drawn.verdict(name) == "agrees" and abs(drawn.bend(name)) < 0.02, name
        assert drawn.verdict("flight_time") == "stays"

    def test_the_same_seed_draws_the_same(self, spread):
        one, again, other = (spread.monte_carlo(4, seed=seed) for seed in (3, 3, 4))
        assert again.plain() == one.plain()
        assert (again.samples.parameters != other.samples.parameters).all()

    def test_bodies_are_found_one_by_one(self, hop):
        spread = hop.sensitivity(["knee_mass", "hip_to_knee"]).uncertainty({"knee_mass": "1 %", "hip_to_knee": 1e-4})
        assert not side_by_side(spread.table)
        drawn = spread.monte_carlo(8)
        assert drawn.samples.alike.all() and drawn.verdict("positive_work") == "agrees"
        assert abs(drawn.bend("flight_time")) < 0.02

    @pytest.mark.slow
    def test_what_is_lost_is_said(self, table):
        # with half the damping there is no hop with such a flight: samples are lost, and the statement says so
        drawn = table.uncertainty({"damping": 0.25}).monte_carlo(40)
        lost = int((~drawn.samples.found).sum())
        assert lost > 5
        told = re.findall(r"(\d+) without a gait", drawn.statement())
        assert sum(map(int, told)) == lost
        assert drawn.plain()["converged"] == 40 - lost
        assert drawn.verdict("positive_work") != "agrees"

    @pytest.mark.parametrize("arguments", [(1,), (2_000_000,), (10, -1)])
    def test_what_is_refused(self, spread, arguments):
        with pytest.raises(BadValue):
            spread.monte_carlo(*arguments)

    @pytest.mark.slow
    def test_standard_deviations_agree_within_chance(self, spread):
        drawn = spread.monte_carlo(200, seed=5)
        assert drawn.samples.alike.all()
        for name in spread.outputs:
            if spread.moves(name):
                assert abs(drawn.deviation(name) - spread.deviation(name)) < 4.0 * drawn.error(name), name
                assert abs(drawn.bend(name)) < 0.01, name

    @pytest.mark.slow
    def test_correlated_errors(self, table):
        covariance = np.diag([0.25, 0.0007, 4e-6])
        covariance[0, 1] = covariance[1, 0] = -0.9 * np.sqrt(0.25 * 0.0007)
        spread = table.uncertainty(covariance)
        drawn = spread.monte_carlo(200, seed=6)
        for name in ("stance_torque", "positive_work", "multiplier_1"):
            assert abs(drawn.deviation(name) - spread.deviation(name)) < 4.0 * drawn.error(name), name
        # what knowing takes away, from the samples: what is left about a straight line over the parameter
        values, given = drawn.drawn("positive_work"), drawn.samples.parameters
        for i in range(3):
            share = np.corrcoef(given[:, i], values)[0, 1] ** 2
            assert share == pytest.approx(spread.gains("positive_work")[i], abs=0.16)


def test_guesses_of_lanes(hop):
    n = 3
    q, v = (np.tile(part, (n, 1)) for part in hop.state)
    stiffness = np.linspace(48.0, 49.0, n)
    table = find_many(hop.system, {"stiffness": stiffness}, guess=(q, v))
    assert table.converged.all()
    one = find_many(hop.system, {"stiffness": stiffness}, guess=hop.state)
    assert table.q == pytest.approx(one.q, abs=1e-9)
    with pytest.raises(BadValue, match="guess"):
        find_many(hop.system, {"stiffness": stiffness}, guess=(q[:2], v[:2]))


def test_measures_that_lanes_record_are_those_of_monte_carlo(hop, drawn):
    names = {*OVER, "stance_torque"}
    given = {name: drawn.samples.outputs.get(name) for name in names - set(OVER)}
    given |= dict(zip(OVER, drawn.samples.parameters.T, strict=True))
    robot = hop.system.robot
    q, v = (np.column_stack([drawn.samples.outputs[f"{k}_{name}"] for name in robot.coordinates]) for k in "qv")
    batch = simulate_many(hop.system, q, v, parameters=given, observe=True)
    for name in ("apex_height", "flight_time", "stance_time", "period"):
        assert MEASURES[name](hop.system, q, batch) == pytest.approx(drawn.samples.outputs[name], rel=1e-9)


def test_it_is_told_drawn_and_written(spread, drawn, tmp_path):
    assert "stance_torque" in str(spread) and "same order of events" in str(drawn)
    assert "N·m/rad" in card(spread) and "to first order" in card(drawn)
    data = json.loads(spread.to_json())
    assert data["outputs"]["positive_work"]["unit"] == "J" and data["deviations"]["stiffness"] == 0.5
    assert json.loads(drawn.to_json())["samples"] == 60
    bars = variance_shares(spread)
    widths = [patch.get_width() for patch in bars.axes[0].patches]
    assert sum(widths) == pytest.approx(100.0 * sum(map(spread.moves, spread.outputs)), rel=1e-9)
    histograms = monte_carlo(drawn)
    assert [axes.get_xlabel() for axes in histograms.axes] == [
        "Stance torque (N·m)",
        "Positive work (J)",
        "Multiplier 1",
    ]
    assert sum(patch.get_height() for patch in histograms.axes[0].patches) == 60
    for figure in (bars, histograms):
        assert save_figure(figure, tmp_path / "picture.svg").stat().st_size > 1000
    with pytest.raises(UnknownName, match="nothing"):
        spread.deviation("nothing")
    with pytest.raises(UnknownName, match="nothing"):
        monte_carlo(drawn, ["nothing"])
    with pytest.raises(BadValue, match="depend on an uncertain parameter"):
        monte_carlo(drawn, ["flight_time"])
