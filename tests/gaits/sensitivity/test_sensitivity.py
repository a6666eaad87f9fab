"""Derivatives of gaits against gaits that are found again with other numbers, and what is refused."""

import json
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, find_gait, hopping, load, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.search import gait_beside
from spear_pin.gaits.sensitivity.samples import find_anew
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.viz.notebook import card
from spear_pin.viz.plots import save_figure
from spear_pin.viz.plots.sensitivity import elasticities
from tests.gaits import found_again

pytestmark = pytest.mark.extra("heyoka")
OVER = ("stiffness", "damping", "knee_touchdown", "friction", "knee_mass", "knee_ratio", "hip_to_knee", "knee_to_toe")


@pytest.fixture(scope="module")
def hop():
    system = hopping(load("spear_ii", locked=["boom_x"]))
    return find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2}, rtol=1e-12)


@pytest.fixture(scope="module")
def table(hop):
    return hop.sensitivity(OVER)


def outputs_of(orbit):
    """Measures and exact multipliers, in the order of the table."""
    moduli = np.sort(np.abs(np.linalg.eigvals(orbit.jacobian)))[::-1]
    return [*(measure.value for measure in orbit.measures.values()), *moduli]


@pytest.mark.parametrize("name", OVER)
def test_against_gaits_found_again(hop, table, name):
    value, j = number(hop.system, name), OVER.index(name)
    for output, expected in zip(table.derivatives, found_again.measures(hop, name, outputs_of), strict=True):
        derivative, size = table.derivatives[output][j], 2e-7 * abs(table.outputs[output])
        assert derivative * value == pytest.approx(expected * value, rel=1e-6, abs=size)


def test_what_is_kept_stays(hop):
    table = hop.sensitivity(["stiffness", "knee_ratio"], ["stance_torque"], ["flight_time"])
    assert table.derivatives["flight_time"] == pytest.approx([0.0, 0.0], abs=1e-15)
    assert table.measures[0] == "stance_torque" and table.derivatives["stance_torque"] is table.solved["stance_torque"]
    assert table.outputs["stance_torque"] == hop.system.law.stance_torque
    h = 1e-2
    torques = []
    for step in (h, -h):
        system = with_numbers(hop.system, {"stiffness": hop.system.spring.stiffness + step})
        torques.append(
            gait_beside(system, hop.state, ["stance_torque"], {"flight_time": 0.2}).parameters["stance_torque"]
        )
    assert table.solved["stance_torque"][0] == pytest.approx((torques[0] - torques[1]) / (2.0 * h), rel=1e-6)


def test_more_friction_is_used_by_as_much_where_a_toe_slips(table):
    assert table.elasticity("friction_used_toe")[OVER.index("friction")] == pytest.approx(1.0, abs=1e-9)


@pytest.mark.parametrize("name", ["hop", pytest.param("long_stride", marks=pytest.mark.slow)])
def test_height_is_how_high_a_toe_gets(hop, name):
    """Against the heights that Pinocchio has along samples of the reference engine, through the three highest."""
    gait = hop if name == "hop" else Gait.load(name)
    outputs = gait.sensitivity(["knee_ratio"]).outputs
    run = simulate(gait.system, gait.state, 1, samples=2000, progress=False)
    for toe in gait.system.robot.toes:
        heights = np.array([gait.system.ground.foot(gait.system.robot, q, toe)[0] for q in run.q])
        i = int(heights.argmax())
        bend, slope, top = np.polyfit(run.t[i - 1 : i + 2] - run.t[i], heights[i - 1 : i + 2], 2)
        assert outputs[f"greatest_height_{toe}"] == pytest.approx(top - slope**2 / (4.0 * bend), abs=1e-8)


def test_it_is_told_drawn_and_written(table, tmp_path):
    assert "friction_used_toe" in str(table) and "N·m/rad" in card(table)
    data = json.loads(table.to_json())
    assert data["outputs"]["flight_time"]["unit"] == "s" and data["units"]["stiffness"] == "N·m/rad"
    figure = elasticities(table)
    assert len(figure.axes[0].get_yticks()) == len(table.outputs)
    assert save_figure(figure, tmp_path / "table.svg").stat().st_size > 1000
    with pytest.raises(UnknownName, match="nothing"):
        table.elasticity("nothing")


@pytest.mark.parametrize("value", [0.0, -3e-16])
def test_an_output_that_is_zero_has_no_elasticity(table, tmp_path, value):
    """As the deflection of springs in a bound, which are slack as they are let go."""
    other = replace(table, outputs={**table.outputs, "work": value})
    assert np.isnan(other.elasticity("work")).all() and np.isfinite(other.elasticity("positive_work")).all()
    labels = [text.get_text() for text in elasticities(other).axes[0].texts]
    assert labels.count("none") == len(OVER) and "none, none" in card(other)
    assert other.values[other.measures.index("work")].any()


@pytest.mark.parametrize(
    ("over", "vary", "keep", "error", "text"),
    [
        (["nope"], [], [], UnknownName, "'nope'; nearest of .*: "),
        ([], [], [], BadValue, "one parameter or more"),
        (["stiffness", "stiffness"], [], [], BadValue, "each once"),
        (["stiffness"], ["stance_torque"], [], BadValue, "as many measures"),
        (["stiffness"], ["stance_torque"], ["nope"], UnknownName, "'nope'"),
        (["slope"], [], [], BadValue, "slope is 0.0"),
        (["foot_placement"], [], [], BadValue, "^foot_placement is 0.0; .* has to be 0 while boom_x is locked"),
    ],
)
def test_what_is_refused(hop, over, vary, keep, error, text):
    with pytest.raises(error, match=text):
        hop.sensitivity(over, vary, keep)


def test_a_state_that_is_no_fixed_point_is_refused(hop):
    system = with_numbers(hop.system, {"stiffness": 50.0})
    with pytest.raises(BadValue, match="a fixed point"):
        Gait(system, hop.state, {}, 0.0, hop.multipliers, hop.durations).sensitivity(["stiffness"])


@pytest.mark.slow
def test_where_two_events_meet_each_has_its_own_time():
    # lift-off of long_stride is where its spring grows slack; gaits with a smaller angle have the same order of events
    table = Gait.load("long_stride").sensitivity(["knee_touchdown"])
    assert "posterior_lift_off" in table.one_sided
    h = np.array([-2e-5, -1e-5])
    found = find_anew(table, table.given + h[:, None])
    assert found.alike.all()
    for name in ("period", "stride", "mean_speed", "work", "positive_work", "rms_torque_posterior_knee"):
        far, near = (found.outputs[name] - table.outputs[name]) / h
        assert table.derivatives[name][0] == pytest.approx(2.0 * near - far, rel=1e-4), name
