"""Measures of several sides, what differs between them, and what words stand for."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, Ground, Spring, load, simulate
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.trajectory import SAMPLED
from spear_pin.studies.bound import summarize
from spear_pin.studies.comparison import (
    ComparedMeasure,
    compare_measures,
    describe_differences,
    differences,
    read,
    sides_of,
)
from spear_pin.studies.comparison.sides import parameters


@pytest.fixture(scope="module")
def sides():
    return sides_of(["long_stride", "long_stride_3.00"], cycles=1)


def row(rows, name):
    return next(each for each in rows if each.name == name)


@pytest.mark.slow
def test_measures_are_those_of_the_study_of_bounds(sides):
    rows = compare_measures(sides)
    for i, side in enumerate(sides):
        figures = summarize(side.gait, side.run)
        assert row(rows, "mean speed").values[i] == pytest.approx(figures["speed"], rel=1e-9)
        assert row(rows, "period").values[i] == pytest.approx(figures["period"], rel=1e-9)
        cost = row(rows, "cost of transport").values[i]
        assert cost == pytest.approx(figures["cost_of_transport"], rel=1e-9)
        peak = row(rows, "peak normal force, posterior toe, a pair").values[i]
        assert peak == pytest.approx(figures["peak_force"]["posterior"], rel=1e-9)
        assert row(rows, "energy, impact").values[i] == pytest.approx(-figures["impact_loss"], rel=1e-9)


@pytest.mark.slow
def test_in_space_forces_are_normal_and_the_way_is_what_it_goes(tmp_path):
    gait = Gait.load(Path(__file__).parents[3] / "examples" / "turn.json")
    run = simulate(gait.system, gait.state, 2)
    rows = compare_measures(sides_of([str(run.save(tmp_path / f"{name}.npz")) for name in "ab"]))
    chords = 2.0 * 12.339 * np.sin(np.radians(4.0) / 2.0)  # of a circle that the turn goes round
    assert row(rows, "distance a cycle").values[0] == pytest.approx(chords, rel=1e-4)
    peak = row(rows, "peak normal force, posterior left toe").values[0]
    assert peak == pytest.approx(run.force[:, 0, 2].max(), rel=1e-3) and peak > 600.0
    assert 20.0 < row(rows, "time on the ground, anterior right toe").values[0] < 22.0


def test_differences_are_from_the_first(sides):
    speed = row(compare_measures(sides), "mean speed")
    assert speed.changes == (0.0, pytest.approx(0.5, abs=1e-6))
    assert speed.shares == (0.0, pytest.approx(20.0, abs=1e-4))


@pytest.mark.parametrize(
    ("values", "changes", "shares"),
    [
        ((2.0, 3.0), (0.0, 1.0), (0.0, 50.0)),
        ((-2.0, -3.0), (0.0, -1.0), (0.0, -50.0)),
        ((0.0, 3.0), (0.0, 3.0), (None, None)),
        ((None, 3.0), (None, None), (None, None)),
        ((2.0, None), (0.0, None), (0.0, None)),
        ((1.0, 1.0 + 1e-12), (0.0, 0.0), (0.0, 0.0)),
    ],
)
def test_a_share_is_of_the_magnitude_of_the_first(values, changes, shares):
    measure = ComparedMeasure("", "", "", values)
    assert measure.changes == changes and measure.shares == shares


def test_only_parameters_that_differ_are_told(sides):
    names = [each.name for each in differences(sides)]
    assert "law: posterior_hip_torque" in names
    assert not any(name.startswith(("spring", "ground", "robot")) for name in names)
    assert differences([sides[0], sides[0]]) == ()


def test_sentences_tell_who_is_stable_and_the_main_differences(sides):
    task, first, second = describe_differences(sides, compare_measures(sides))
    assert task == "Not the same task: mean speeds 2.500 and 3.000 m/s."
    assert "long_stride is unstable (largest multiplier 1.067)" in first
    assert "long_stride_3.00 against long_stride: mean speed +20 % (3 against 2.5 m/s)" in second


def test_hops_of_other_flight_times_are_not_the_same_task(tmp_path, hop):
    """Said first, of gaits and of their motions."""
    shorter = replace(hop, durations={**hop.durations, "flight": 0.187})
    sides = sides_of([hop, shorter], ["one", "other"], cycles=1)
    assert (
        describe_differences(sides, compare_measures(sides))[0]
        == "Not the same task: flight times 0.2000 and 0.1870 s."
    )
    file = sides[0].run.save(tmp_path / "hop.npz")
    sides = sides_of([file, shorter], cycles=1)
    assert (
        describe_differences(sides, compare_measures(sides))[0]
        == "Not the same task: flight times 0.2000 and 0.1870 s."
    )
    sides = sides_of([file, hop], cycles=1)
    assert not any("task" in sentence for sentence in describe_differences(sides, compare_measures(sides)))


def test_slopes_and_kinds_are_of_the_task(sides, hop):
    both = [sides[0], sides_of([hop] * 2, cycles=1)[0]]
    assert describe_differences(both, compare_measures(both))[0].startswith(
        "Not the same task: gaits of different kinds (bounding, hopping)"
    )
    run = sides[0].run
    uphill = replace(sides[0], gait=None, run=replace(run, ground=Ground(slope=0.1)))
    both = [replace(sides[0], gait=None), uphill]
    assert "slopes 0.000 and 0.1000 rad" in describe_differences(both, compare_measures(both))[0]


@pytest.mark.slow
def test_turns_are_of_the_task():
    sides = sides_of([Gait.load("turn_4"), Gait.load("turn_9")], cycles=1)
    assert "turns a cycle 4.000 and 9.000 °" in describe_differences(sides, compare_measures(sides))[0]
    sides = sides_of(["trot", "trot"], cycles=1)
    assert not any("task" in sentence for sentence in describe_differences(sides, compare_measures(sides)))


def test_two_of_the_same_differ_in_nothing(sides):
    same = [sides[0], sides[0]]
    assert all(change in (0.0, None) for each in compare_measures(same) for change in each.changes)
    assert "by less than 1 % in period, mean speed" in describe_differences(same, compare_measures(same))[1]


def test_one_that_stands_is_not_said_to_move_alike(sides):
    standing, moving = sides_of(["q_spear"] * 2)[0], sides[0]
    assert not any(
        "less than" in sentence
        for sentence in describe_differences([standing, moving], compare_measures([standing, moving]))
    )


def test_robots_are_compared_as_they_stand():
    sides = sides_of([load("spear_ii"), "q_spear"])
    rows = compare_measures(sides)
    assert row(rows, "mass").values == (pytest.approx(6.8), pytest.approx(43.76))
    assert {each.group for each in rows} == {"robot"}
    assert describe_differences(sides, rows)[-1] == "The robots are different: spear_ii, q_spear."


@pytest.mark.slow
def test_springs_are_compared_by_hops_of_the_same_time_in_the_air():
    sides = sides_of(["stiffness=40", Spring(stiffness=60.0)], cycles=1)
    assert [side.label for side in sides] == ["stiffness=40", "stiffness=60"]
    assert row(compare_measures(sides), "flight time").changes[1] == pytest.approx(0.0, abs=1e-9)
    assert [each.name for each in differences(sides)] == ["law: stance_torque", "spring: stiffness"]
    assert row(compare_measures(sides), "peak torque, hip").shares[1] > 0.0


@pytest.mark.slow
def test_springs_are_put_into_another_gait():
    gait = Gait.load("long_stride")
    stiffer = f"stiffness={1.02 * gait.system.spring.stiffness}"
    sides = sides_of([gait, stiffer], cycles=1, of=gait)
    assert [each.name for each in differences(sides)] == ["spring: stiffness"]
    assert np.abs(sides[1].gait.residual) < 1e-8


def test_a_saved_trajectory_is_a_side(tmp_path, sides):
    path = sides[0].run.save(tmp_path / "strides.npz")
    again = sides_of([path, "long_stride"], ["saved", "solved"], cycles=1)
    assert [side.kind for side in again] == ["motion", "gait"]
    rows = [each for each in compare_measures(again) if each.group != "gait"]
    assert all(abs(each.changes[1] or 0.0) <= 1e-9 * abs(each.values[0] or 0.0) + 1e-12 for each in rows)


def test_what_a_motion_does_not_say_is_no_difference(sides):
    motion = sides_of([sides[0].run, "spear_ii"])[0]
    assert differences([motion, sides[0]]) == ()


def test_what_a_law_leaves_open_differs_from_what_it_says(sides):
    switched = sides[0]
    gait = switched.gait
    fixed = replace(
        switched, gait=replace(gait, system=rebuilt(gait.system, spring=replace(gait.system.spring, rest=0.1)))
    )
    assert [(each.name, each.values) for each in differences([switched, fixed])] == [("spring: rest", (None, 0.1))]


@pytest.mark.slow
def test_a_trajectory_with_gaps_is_refused(sides):
    with pytest.raises(BadValue, match="a trajectory with gaps"):
        sides_of([simulate(sides[0].gait.system, sides[0].gait.state, 2).in_phase("posterior_stance"), "q_spear"])


def test_labels_are_never_the_same():
    assert [side.label for side in sides_of(["spear_ii"] * 3)] == ["spear_ii", "spear_ii (2)", "spear_ii (3)"]


def test_words_are_springs_gaits_and_robots():
    assert read("stiffness=40, damping=1") == Spring(stiffness=40.0, damping=1.0)
    assert read("long_stride").system.kind == "bounding"
    assert read("q_spear").name == "q_spear"


@pytest.mark.parametrize(
    ("items", "error", "words"),
    [
        (["long_stride"], BadValue, "2 to 6"),
        (["spear_ii"] * 7, BadValue, "2 to 6"),
        (["spear_ii", "nothing"], UnknownName, "unknown gait or robot 'nothing'; nearest of .*: "),
        (["spear_ii", "stifness=3"], UnknownName, "unknown number of a spring 'stifness'; valid: stiffness"),
        (["spear_ii", "stiffness=x"], BadValue, "stiffness is 'x'; expected a number"),
        (["spear_ii", "stiffness=-1"], BadValue, "Spring.stiffness is -1.0"),
        (["spear_ii", "nothing.npz"], BadFile, "nothing.npz: cannot be read"),
        (["spear_ii", "nothing.json"], BadFile, "nothing.json: cannot be read"),
    ],
)
def test_what_cannot_be_compared_is_refused(items, error, words):
    with pytest.raises(error, match=words):
        sides_of(items)


@pytest.mark.parametrize("cycles", [0, 51, 1.5])
def test_cycles_are_some(cycles):
    with pytest.raises(BadValue, match="a whole number from 1 to 50"):
        sides_of(["spear_ii", "q_spear"], cycles=cycles)


def test_a_motion_without_a_whole_cycle_has_nothing_of_a_cycle(sides):
    left, right = sides_of([sides[0].run, replace(sides[0].run, cycles=0)])
    for name in ("motors' work, |power|", "distance a cycle", "period"):
        of_cycles, of_all = row(compare_measures((left, right)), name).values
        assert of_cycles is not None and of_all is None, name
    assert "no whole cycle" in right.notes[0]


def test_a_single_sample_is_refused(sides):
    run = sides[0].run
    lone = run.in_cycles(1, 1)
    lone = replace(lone, **{name: getattr(lone, name)[:1] for name in SAMPLED})
    with pytest.raises(BadValue, match="at least two"):
        sides_of([run, lone])


def test_dry_friction_is_among_what_differs(sides):
    gait = sides[0].gait
    rubbed = replace(sides[0], gait=replace(gait, system=with_dry_friction(gait.system, {"posterior_hip": 1.0})))
    assert parameters(rubbed)["DryFriction: forces"] == {"posterior_hip": 1.0}
