"""What becomes of the hop when its numbers are turned, by both engines, and the program that is saved of it."""

import ast
import re
import runpy
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import find_gait, simulate
from spear_pin.cli.explored import write_script
from spear_pin.errors import BadValue, NoGait, UnknownName
from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.rules.cycles import RETOUCH
from spear_pin.model.spring import Spring
from spear_pin.studies.explore.engines import REFERENCE, TAYLOR, best_engine
from spear_pin.studies.explore.figures import figures
from spear_pin.studies.explore.hops import NEAR, settle_hops, transient
from spear_pin.studies.explore.legs import KNOBS, spear_ii_hop
from spear_pin.studies.explore.motion import kind_of

pytestmark = pytest.mark.extra  # heyoka runs the hops where it is installed
ENGINES = [
    pytest.param(TAYLOR, marks=pytest.mark.extra("heyoka"), id="taylor"),
    pytest.param(REFERENCE, id="reference"),
]
knobs_of = spear_ii_hop().at
STIFFER = knobs_of(stiffness=54.0, knee_ratio=13.0, friction=0.6)
RATTLING = knobs_of(stiffness=60.0)  # the toe comes back at once after each touchdown
ALTERNATING = knobs_of(stiffness=97.2, stance_torque=6.8, knee_touchdown=1.1, frequency=3.0, damping=0.9)
FALLING = knobs_of(stance_torque=10.5)  # after two hops
RESTLESS = knobs_of(stiffness=45.0, frequency=1.8, damping=2.5, stance_torque=8.0)
STAYING = knobs_of(stance_torque=0.0)  # on the ground


def states(trajectory):
    """Configuration and velocity at the samples, side by side."""
    return np.hstack([trajectory.q, trajectory.v])


@pytest.mark.parametrize(
    ("names", "said"),
    [
        (["lift_off", "apex", "touchdown"], "lift off, apex, touchdown"),
        (["lift_off", RETOUCH, "lift_off"], "the toe bounces once: lift off, retouch, lift off"),
        ([RETOUCH] * 2, "the toe bounces twice: retouch, retouch"),
        ([RETOUCH] * 3, "the toe bounces 3 times: retouch, retouch, retouch"),
    ],
)
def test_kinds_are_orders_of_events(names, said):
    assert kind_of(SimpleNamespace(events=[SimpleNamespace(name=name, domain="stance") for name in names])) == said


class TestKnobs:
    def test_at_first_they_are_at_their_defaults(self):
        assert knobs_of().values == {name: knob.default for name, knob in KNOBS.items()}

    def test_the_source_and_assumptions_are_told_apart(self):
        origins = {name: knob.origin for name, knob in KNOBS.items()}
        assert {name for name, origin in origins.items() if origin != "source"} == {
            "stance_torque",
            "knee_touchdown",
            "friction",
        }
        assert origins["stance_torque"] == "solved"

    @pytest.mark.parametrize("name", KNOBS)
    @pytest.mark.parametrize("word", ["-1", "1e9", "nan", "inf", "", "six"])
    def test_what_is_out_of_its_range_is_refused_by_naming_it(self, name, word):
        low, high = KNOBS[name].low, KNOBS[name].high
        with pytest.raises(BadValue, match=f"^{name} is .*; expected a number from {low:g} to {high:g}"):
            spear_ii_hop().read({name: word})

    @pytest.mark.parametrize("name", KNOBS)
    def test_the_ends_of_a_range_are_in_it(self, name):
        for end in (KNOBS[name].low, KNOBS[name].high):
            assert spear_ii_hop().read({name: str(end)}).values[name] == end

    def test_an_unknown_knob_is_refused(self):
        with pytest.raises(UnknownName, match="unknown knob 'mass'; valid: stiffness, knee_ratio"):
            spear_ii_hop().read({"mass": "3"})

    def test_every_knob_arrives_in_the_system(self):
        knobs = knobs_of(
            stiffness=50.0,
            knee_ratio=10.0,
            stance_torque=9.0,
            knee_touchdown=1.1,
            friction=0.7,
            frequency=2.7,
            damping=1.2,
        )
        system = knobs.system
        assert system.spring == Spring(stiffness=50.0, damping=1.2)
        assert system.ground == Ground(friction=0.7)
        assert system.law == HoppingLaw(knee_touchdown=1.1, stance_torque=9.0, frequency=2.7)
        # the reflected inertia of Table 2.4's 0.027 kg·m² with another ratio
        assert system.robot.model.armature[-1] == pytest.approx(0.027 * (10 / 15) ** 2)


@pytest.mark.parametrize("engine", ENGINES)
class TestSettled:
    @pytest.mark.slow
    def test_a_periodic_hop_is_the_one_found_from_cold(self, engine):
        hops = settle_hops(STIFFER, engine)
        found = find_gait(STIFFER.system)
        assert hops.verdict == "periodic" and "stable" in hops.message
        np.testing.assert_allclose(np.concatenate(hops.gait.state), np.concatenate(found.state), atol=1e-7)
        np.testing.assert_allclose(hops.gait.multipliers, found.multipliers, atol=1e-5)
        assert hops.gait.durations == pytest.approx(found.durations, abs=1e-7)
        assert f"{abs(found.multipliers[0]):.3f}" in hops.message
        assert hops.trajectory.cycles == 1

    @pytest.mark.slow
    def test_a_pattern_repeats_over_two_hops_and_not_over_one(self, engine):
        hops = settle_hops(ALTERNATING, engine)
        assert hops.verdict == "pattern" and hops.gait is None
        assert "over 2 hops" in hops.message
        moved = [np.abs(simulate(ALTERNATING.system, hops.start, n).q[-1] - hops.start[0]).max() for n in (1, 2)]
        assert moved[0] > NEAR > moved[1]

    @pytest.mark.slow
    def test_a_toe_that_comes_back_at_once_makes_no_hop(self, engine):
        """One hop, whose spring works, and not two, the first of which were a few milliseconds."""
        hops = settle_hops(RATTLING, engine)
        assert hops.verdict == "periodic" and hops.trajectory.named(RETOUCH)
        assert len(hops.trajectory.named("apex")) == hops.trajectory.cycles == 1
        known = figures(hops)
        assert known["flight_time"] == pytest.approx(hops.gait.durations["flight"], abs=1e-6)
        assert 0.5 < known["spring_share"] < 0.7

    @pytest.mark.slow
    def test_what_does_not_repeat_is_not_called_periodic(self, engine):
        hops = settle_hops(RESTLESS, engine)
        assert hops.verdict == "unsettled" and hops.gait is None and "does not repeat" in hops.message
        assert hops.trajectory.cycles == 4
        landings = [hops.start[0], *(event.q for event in hops.trajectory.named("touchdown"))]
        assert min(np.abs(landing - hops.start[0]).max() for landing in landings[1:]) > NEAR / 10

    @pytest.mark.slow
    def test_a_fall_is_shown_with_the_hops_before_it(self, engine):
        hops = settle_hops(FALLING, engine)
        whole = simulate(FALLING.system, spear_ii_hop().start, 12)
        assert hops.verdict == "ended" and whole.reason == "fall"
        assert f"ends {whole.cycles} hops after" in hops.message and hops.trajectory.message in hops.message
        assert hops.trajectory.cycles == 2 and hops.trajectory.reason == "fall"
        np.testing.assert_allclose(states(hops.trajectory)[-1], states(whole)[-1], atol=1e-4)

    def test_a_robot_that_stays_on_the_ground_is_shown_from_the_beginning(self, engine):
        hops = settle_hops(STAYING, engine)
        assert hops.verdict == "ended" and "during the first hop" in hops.message
        assert hops.trajectory.reason == "no_event" and hops.start is spear_ii_hop().start


@pytest.mark.slow
def test_the_default_hop_is_the_one_of_the_documents():
    """The table of docs/results/hop.md."""
    hops = settle_hops(knobs_of(), REFERENCE)
    known = figures(hops)
    assert known["flight_time"] == pytest.approx(0.2, abs=1e-5)
    assert known["stance_time"] == pytest.approx(0.3643, abs=1e-4)
    assert known["apex_height"] == pytest.approx(0.6118, abs=1e-4)
    assert known["peak_force"] == pytest.approx(177.6, abs=0.1)
    assert known["spring_share"] == pytest.approx(0.698, abs=1e-3)
    assert abs(hops.gait.multipliers[0]) == pytest.approx(0.4062, abs=1e-4)


@pytest.mark.slow
def test_figures_by_hand():
    hops = settle_hops(STIFFER, best_engine())
    trajectory, known = hops.trajectory, figures(hops)
    torque, rate = trajectory.u[:, 1], trajectory.v[:, 2]
    assert known["peak_torque_knee"] == pytest.approx(max(torque.max(), -torque.min()), rel=1e-3)
    assert known["rotor_torque_knee"] == pytest.approx(known["peak_torque_knee"] / 13)
    assert known["peak_power_knee"] == pytest.approx(max(abs(torque * rate)), rel=1e-3)
    power = np.maximum(trajectory.u * trajectory.v[:, 1:], 0.0).sum(axis=1)
    assert known["positive_work"] == pytest.approx(np.trapezoid(power, trajectory.t), rel=2e-3)


def test_without_a_whole_hop_some_figures_are_none():
    known = figures(settle_hops(STAYING, best_engine()))
    assert known["apex_height"] is known["flight_time"] is known["positive_work"] is known["spring_share"] is None
    assert known["peak_force"] > 0


def test_a_transient_begins_at_the_default_hop_and_says_how_it_ends():
    hops = transient(FALLING, best_engine())
    assert hops.verdict == "transient" and hops.start is spear_ii_hop().start
    assert "A transient: 2 hops, " in hops.message and "knee" in hops.message


@pytest.mark.slow
@pytest.mark.parametrize("knobs", [STIFFER, ALTERNATING, FALLING], ids=["periodic", "pattern", "falling"])
def test_the_saved_program_computes_what_was_shown(knobs, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    hops = settle_hops(knobs, best_engine())
    program = tmp_path / "explored_hop.py"
    program.write_text(write_script(hops), encoding="utf-8")
    done = runpy.run_path(str(program))
    np.testing.assert_allclose(states(done["hops"]), states(hops.trajectory), atol=1e-6)
    np.testing.assert_allclose(done["hops"].force, hops.trajectory.force, atol=1e-4)
    assert done["hops"].reason == hops.trajectory.reason
    printed = capsys.readouterr().out
    assert (
        f"{figures(hops)['peak_force']:.2f} N" in printed and f"{figures(hops)['peak_torque_knee']:.3f} N·m" in printed
    )
    if hops.gait is not None:
        np.testing.assert_allclose(done["gait"].multipliers, hops.gait.multipliers, atol=1e-5)
    else:
        assert hops.trajectory.message in printed
    assert (tmp_path / "hop.html").stat().st_size > 500_000
    imported = re.findall(r"^from (\S+) import", write_script(hops), re.M)
    assert set(imported) == {"numpy", "spear_pin", "spear_pin.gaits.measures.of_samples", "spear_pin.viz.player"}


ODD = 'a"+str(__import__("os").system("false"))+"\\ """\n'


def test_a_robots_name_is_no_code(monkeypatch):
    """It is of somebody's file: in the program it stands as words."""
    knobs = knobs_of(stance_torque=10.5)
    hops = transient(knobs, best_engine())
    monkeypatch.setitem(vars(knobs.subject), "title", ODD)
    tree = ast.parse(write_script(hops))
    called = [node.func.id for node in ast.walk(tree) if isinstance(node, ast.Call) and isinstance(node.func, ast.Name)]
    assert "__import__" not in called and "str" not in called
    titles = [each.value for node in ast.walk(tree) if isinstance(node, ast.Call) for each in node.keywords]
    assert any(isinstance(each, ast.Constant) and each.value == f"{ODD} in place" for each in titles)


@pytest.fixture(scope="module")
def found():
    """The hop of a stiffer spring with the flight time that is kept."""
    return find_gait(knobs_of(stiffness=54.0).system, ["stance_torque"], {"flight_time": 0.2})


class TestKeepingTheFlightTime:
    @pytest.mark.slow
    @pytest.mark.parametrize("engine", ENGINES)
    def test_the_torque_is_solved_for_it(self, found, engine):
        hops = settle_hops(knobs_of(kept=True, stiffness=54.0, stance_torque=3.0), engine)
        assert hops.gait.durations["flight"] == pytest.approx(0.2, abs=1e-8)
        assert hops.knobs.values["stance_torque"] == pytest.approx(found.parameters["stance_torque"], abs=1e-6)
        assert hops.knobs.kept and hops.verdict == "periodic"

    @pytest.mark.slow
    def test_where_there_is_none_it_says_so(self):
        with pytest.raises(NoGait, match="0.2 s of flight"):
            settle_hops(knobs_of(kept=True, stiffness=20.0, damping=3.0), best_engine())
