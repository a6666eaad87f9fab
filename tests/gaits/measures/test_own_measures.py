"""A measure of one's own is known wherever measures are: in summaries, targets, derivatives, designs and pages."""

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, continue_gait, find_gait, hopping, load, optimize_design, simulate
from spear_pin.cli.writing import _added
from spear_pin.errors import BadFunction, BadValue, UnknownName
from spear_pin.gaits.measures.catalogue import Measure, describe_measure, measures, register
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.gaits.targets import measure_of
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.periodic import return_map
from spear_pin.studies.comparison import compare_measures, sides_of
from spear_pin.studies.explore.carried import carry_gait
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.gaits import gait_to_explore
from spear_pin.studies.explore.tangents import tangents
from spear_pin.studies.hop import summarize
from spear_pin.studies.sweep.job import check_job
from tests.cli.calls import run
from tests.gaits.feeding import idle

IMPULSE = Measure(
    "impulse_TOE",
    "N·s",
    "Impulse of the ground on a toe in a cycle, without those of touchdowns.",
    lambda cycle, toe: cycle.integral(cycle.forces[toe][1]) if toe in cycle.forces else None,
)


@pytest.fixture(autouse=True)
def impulse(measures_of_ones_own):
    register(IMPULSE)


@pytest.fixture(scope="module")
def hop():
    return find_gait(hopping(load("spear_ii", locked=["boom_x"])))


def test_its_name_and_unit(hop):
    assert describe_measure("impulse_toe").unit == "N·s" and "impulse_toe" in measures(hop.system)
    with pytest.raises(BadValue, match="does not have yet"):
        register(IMPULSE)
    with pytest.raises(BadValue, match="of is None"):
        register(Measure("beauty", "1", "Beauty."))
    for clash in ("greatest_knee", "work_JOINT", "two_JOINT_TOE"):
        with pytest.raises(BadValue, match=f"pattern is '{clash}'"):
            register(IMPULSE._replace(pattern=clash))
    for field, wrong in (("of", 3), ("pattern", ""), ("pattern", "has space"), ("pattern", 3), ("unit", 1)):
        with pytest.raises(BadValue, match=f"^{field} is {wrong!r}; expected a "):
            register(IMPULSE._replace(**{"pattern": "push_TOE", field: wrong}))
    with pytest.raises(UnknownName, match="beauty"):
        measure_of(hop.system, "beauty")


@pytest.mark.parametrize("name", ["hop", "long_stride", "trot"])
def test_with_touchdowns_it_bears_the_weight(hop, name):
    """A cycle changes no momentum."""
    gait = hop if name == "hop" else Gait.load(name)
    motion, robot = simulate(gait.system, gait.state, 1, progress=False), gait.system.robot
    struck = sum(np.nansum(np.asarray(event.impulse)[:, -1]) for event in motion.events if event.impulse is not None)
    borne = sum(Sampled(robot, motion).of("impulse").values())
    assert borne + struck == pytest.approx(robot.weight * gait.period, rel=1e-7)
    if name == "hop":
        assert summarize(gait, motion)["measures"]["impulse_toe"] == pytest.approx(borne, rel=1e-9)


@pytest.mark.slow
def test_a_trot_has_the_same_by_derivatives():
    """Half a stride closes its cycle, of which each leg does what its partner does in the other half."""
    gait = Gait.load("trot")
    found = gait.sensitivity(["torso_mass"]).outputs
    stride = simulate(gait.system, gait.state, 2, progress=False)
    for toe, value in Sampled(gait.system.robot, stride, (1, 2), halves=True).of("impulse").items():
        assert found[f"impulse_{toe}"] == pytest.approx(value, rel=1e-6)


@pytest.mark.extra("heyoka")
class TestWithDerivatives:
    def test_they_are_those_of_differences(self, hop):
        orbit = Orbit(hop.system, hop.state, ("stiffness",))
        found, measure = orbit.measures["impulse_toe"], measure_of(hop.system, "impulse_toe")
        value, ends = number(hop.system, "stiffness"), []
        for change in (1e-3, -1e-3):
            other = with_numbers(hop.system, {"stiffness": value + change})
            ends.append(measure(other, return_map(other, hop.state, 1e-12)))
        assert found.derivative[-1] == pytest.approx((ends[0] - ends[1]) / 2e-3, rel=1e-4) and found.unit == "N·s"
        assert found.value == pytest.approx(sum(ends) / 2.0, rel=1e-7)

    @pytest.mark.slow
    def test_it_may_be_a_target_and_followed(self, hop):
        wanted = 1.02 * Orbit(hop.system, hop.state, ()).measures["impulse_toe"].value
        found = find_gait(hop.system, ["stance_torque"], {"impulse_toe": wanted}, guess=hop.state)
        motion = simulate(found.system, found.state, 1, progress=False)
        assert Sampled(found.system.robot, motion).of("impulse")["toe"] == pytest.approx(wanted, rel=1e-7)
        branch = continue_gait(hop, "impulse_toe", (0.97 * wanted, 1.01 * wanted), ["stance_torque"], points=3)
        assert branch.values[0] < wanted / 1.02 < branch.values[-1]

    def test_it_may_be_kept_by_a_design(self, hop):
        kept = {"impulse_toe": Orbit(hop.system, hop.state, ()).measures["impulse_toe"].value}
        best = optimize_design(hop, "work", {"stiffness": (47.0, 50.0)}, kept, vary=["stance_torque"], iterations=2)
        there = Orbit(best.gait.system, best.gait.state, ()).measures["impulse_toe"].value
        assert there == pytest.approx(kept["impulse_toe"], rel=1e-8) and best.objective <= best.start

    @pytest.mark.slow
    def test_sweeps_take_it(self, hop):
        own = Orbit(hop.system, hop.state, ()).measures["impulse_toe"].value
        job = check_job(hop.system, {"impulse_toe": [own, 1.01 * own]}, ("stance_torque",), {}, 1e-9)
        rows = replace(job, guess=hop.state).rows()
        assert rows["residual"].max() < 1e-8
        assert rows["solved_stance_torque"][0] == pytest.approx(number(hop.system, "stance_torque"), rel=1e-6)

    @pytest.mark.slow
    def test_pages_show_it_with_its_slope(self):
        subject = gait_to_explore(Gait.load("long_stride"), "", over=("friction", "stiffness"))
        motion = carry_gait(subject.at())
        assert figures(motion)["impulse"] > 0.0
        assert np.isfinite(tangents(motion).slopes["stiffness"]["impulse"])


@pytest.mark.slow
@pytest.mark.parametrize("words", [("bound", "--cycles=1"), ("trot", "{folder}/steady.json", "--cycles=2")])
def test_commands_print_it(words, capsys, tmp_path):
    idle(Gait.load("trot")).save(tmp_path / "steady.json")
    status, out, _ = run(capsys, *(word.format(folder=tmp_path) for word in words), f"--out={tmp_path}")
    assert status == 0 and re.search(r"^impulse +(\w+ )*toe .* N·s$", out, re.MULTILINE)


def test_a_comparison_has_it():
    rows = compare_measures(sides_of(["long_stride", "long_stride_3.00"], cycles=1))
    assert [each.unit for each in rows if each.name.startswith("impulse ")] == ["N·s", "N·s"]


def test_units_are_written_as_they_are_given():
    register(Measure("rhythm", "1/s", "Cycles a second.", lambda cycle: 1.0 / cycle.period))
    rows = compare_measures(sides_of(["long_stride", "long_stride_3.00"], cycles=1))
    assert [each.unit for each in rows if each.name == "rhythm"] == ["1/s"]
    assert _added(load("spear_ii"), {"rhythm": 2.0, "impulse_toe": 3.0}) == [
        ("impulse", "toe 3 N·s"),
        ("rhythm", "2 1/s"),
    ]


@pytest.mark.parametrize(
    ("of", "said"),
    [
        (lambda cycle: 1.0 / 0.0, "ZeroDivisionError"),
        (lambda cycle: math.exp(1e3), "OverflowError"),
        (lambda cycle: "abc", "it gives 'abc'; expected a number"),
        (lambda cycle: cycle.torques, "expected a number"),
        (lambda cycle: next(iter(cycle.torques.values())), "expected a number"),
        (lambda cycle, toe: 1.0, "TypeError"),
    ],
)
def test_a_mistake_in_it_is_named(hop, of, said):
    register(Measure("wrong", "1", "A mistake.", of))
    motion = simulate(hop.system, hop.state, 1, progress=False)
    with pytest.raises(BadFunction, match=f"^measure 'wrong' .*{__name__.rsplit('.')[-1]}.py:.*{said}"):
        Sampled(hop.system.robot, motion).values()
    with pytest.raises(BadFunction, match=f"^measure 'wrong' .*{said}"):
        Orbit(hop.system, hop.state, ()).measures["wrong"]


def test_signals_take_numbers_from_either_side(hop):
    register(
        IMPULSE._replace(pattern="weights_TOE", of=lambda c, toe: c.integral(0.5 * c.forces[toe][1] * (2 / c.weight)))
    )
    motion = simulate(hop.system, hop.state, 1, progress=False)
    by_samples = Sampled(hop.system.robot, motion).of("weights")["toe"]
    assert by_samples == pytest.approx(Sampled(hop.system.robot, motion).of("impulse")["toe"] / hop.system.robot.weight)
    assert Orbit(hop.system, hop.state, ()).measures["weights_toe"].value == pytest.approx(by_samples, rel=1e-7)


@pytest.mark.slow
def test_heights_of_half_strides_count_once():
    """Those of a foot, and of the other foot in the other half, are of a whole stride."""
    register(IMPULSE._replace(pattern="raised_TOE", of=lambda c, toe: c.integral(c.heights[toe])))
    gait = Gait.load("trot")
    motion, robot = simulate(gait.system, gait.state, 2, progress=False), gait.system.robot
    found, (toe, *_) = Orbit(gait.system, gait.state, ()).measures, robot.toes
    heights = np.array([robot.toe_position(q, toe)[2] for q in motion.q])
    curves = Sampled(robot, motion, (1, 2), True).curves
    assert found[f"raised_{toe}"].value == pytest.approx(curves.integral(heights) / 2.0, rel=1e-6)


def test_what_no_cycle_has(hop):
    sampled = Sampled(hop.system.robot, simulate(hop.system, hop.state, 1, progress=False), (7,))
    assert np.isnan(sampled.period) and np.isnan(sampled.of("rms_torque")["knee"])
    assert np.isnan(sampled.largest("cost_of_transport"))
    with pytest.raises(UnknownName, match="nope"):
        sampled.of("nope")


@pytest.mark.slow
def test_a_trot_has_it_for_each_foot():
    """Of half a stride what a foot of the other side has in it counts, too."""
    gait = Gait.load("trot")
    found = Orbit(gait.system, gait.state, ()).measures
    motion = simulate(gait.system, gait.state, 2, progress=False)
    for name, value in Sampled(gait.system.robot, motion, (1, 2), True).of("impulse").items():
        assert found[f"impulse_{name}"].value == pytest.approx(value, rel=1e-7)


@pytest.mark.slow
def test_by_samples_half_strides_are_measured_whole():
    """A foot takes more torque in one half than in the other."""
    gait = Gait.load("trot")
    found, cycle = Orbit(gait.system, gait.state, ()).measures, return_map(gait.system, gait.state)
    for joint in ("posterior_left_knee", "posterior_right_knee"):
        measured = measure_of(gait.system, f"peak_torque_{joint}")(gait.system, cycle)
        assert measured == pytest.approx(found[f"peak_torque_{joint}"].value, rel=1e-5)
