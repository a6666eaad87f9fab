"""Event feedback: what it adds, when, for how long; all engines agree; it comes off again, and is refused by name."""

import runpy
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, Spring, find_gait, hopping, load
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.gaits.feedback import add_feedback
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.domain import Reset
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.event_feedback import EventFeedback, feedback_of, with_feedback
from spear_pin.hybrid.fields import ADDED, adjust_law, value_in
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.parameters import numbers_of_law, parameter, with_parameters
from spear_pin.hybrid.periodic import (
    chart,
    differentiate_return_map,
    displacement,
    eigenvalues,
    multipliers,
    return_map,
)
from spear_pin.hybrid.result import Moment, Options, Segment
from spear_pin.hybrid.rules import surface
from spear_pin.hybrid.rules.cycles import RETOUCH
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.run import run
from spear_pin.hybrid.symmetry import head_state, mirror_of
from tests.gaits.feeding import fed, idle
from tests.solve.gaits import solo12_trot_steady

INPUTS = ("stance_torque", "knee_touchdown", "frequency")  # used in stance, in flight, and by the schedule
GAINS = np.array(
    [[2.0, -1.0, 3.0, 0.4, -0.2, 0.3], [0.3, 0.2, -0.4, 0.02, 0.05, 0.01], [1.0, 0.5, 0.3, 0.1, 0.0, -0.2]]
)


@pytest.fixture(scope="module")
def held(hop):
    return fed(hop, INPUTS, GAINS)


@pytest.fixture(scope="module")
def beside(hop):
    local = chart(hop.system, hop.state)
    return [local.state(np.array(xi)) for xi in ([0.01, -0.02, 0.03], [-0.004, 0.003, 0.02])]


@pytest.fixture(scope="module")
def chattering(robot):
    """A hop whose toe alternates between ground and air as it lifts off."""
    return find_gait(hopping(robot, HoppingLaw(stance_torque=5.92)))


class TestWhatIsAdded:
    def test_is_k_times_the_deviation_until_the_next_cycle(self, hop, held, beside):
        """By a hop whose law has these numbers outright."""
        off = np.concatenate(beside[0]) - np.concatenate(hop.state)
        values = {name: parameter(hop.system, name) + each for name, each in zip(INPUTS, GAINS @ off, strict=True)}
        wanted = return_map(with_parameters(hop.system, values), beside[0], 1e-11)
        found = return_map(held.system, beside[0], 1e-11)
        for one, other in zip(found.state, wanted.state, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-9)
        assert found.durations == pytest.approx(wanted.durations, abs=1e-9)
        then = np.concatenate(found.state) - np.concatenate(hop.state)
        for name, each in zip(INPUTS, GAINS @ then, strict=True):  # the cycle that begins has its own
            assert found.held[ADDED + name] == pytest.approx(each, abs=1e-12)

    @pytest.mark.slow
    def test_is_there_for_what_the_event_itself_latches(self):
        """A bound's torques are latched at the touchdown that adjusts them, and its angles later in the stride."""
        gait, inputs = Gait.load("long_stride"), ("posterior_hip_torque", "anterior_leg_touchdown")
        gains = np.random.default_rng(4).normal(size=(2, 14)) * [[100.0], [0.2]]
        gains[:, 0] = 0.0  # of torso_x
        local = chart(gait.system, gait.state)
        state = local.state(0.003 * np.random.default_rng(5).normal(size=local.dimension))
        by = gains @ (np.concatenate(state) - np.concatenate(gait.state))
        values = {name: parameter(gait.system, name) + each for name, each in zip(inputs, by, strict=True)}
        found, wanted = (
            return_map(system, state, 1e-11)
            for system in (fed(gait, inputs, gains).system, with_parameters(gait.system, values))
        )
        assert (np.abs(by) > [0.5, 1e-3]).all() and found.cycles == 1
        for one, other in zip(found.state, wanted.state, strict=True):
            np.testing.assert_allclose(one, other, rtol=0, atol=1e-8)

    def test_is_within_limits(self, hop, beside):
        limits, local = np.array([0.01, 0.005, 1.0]), chart(hop.system, hop.state)
        for sign in (1.0, -1.0):
            q, v = local.state(sign * np.array([0.01, -0.02, 0.03]))
            system = fed(hop, INPUTS, GAINS, limits=tuple(limits)).system
            held = system.landing[1].adjust(q.tolist(), v.tolist(), {}, None)
            wanted = GAINS @ (np.concatenate([q, v]) - np.concatenate(hop.state))
            assert (np.abs(wanted) > limits).tolist() == [True, True, False]
            assert [*held.values()] == pytest.approx(np.clip(wanted, -limits, limits), abs=1e-12)

    def test_on_the_gait_is_nothing(self, hop, held):
        once = return_map(held.system, hop.state, 1e-12)
        assert np.abs(displacement(hop.system, hop.state, once.state)).max() < 1e-8

    def test_is_found_in_parts_of_a_law(self):
        law = Gait.load("turn_9").system.law
        found = adjust_law(law, {ADDED + "posterior_hip_torque": 3.0, ADDED + "posterior_spread": 0.1, "past": 1.0})
        assert found.plane.posterior_hip_torque == law.plane.posterior_hip_torque + 3.0
        assert found.posterior_spread == law.posterior_spread + 0.1 and found.plane.epsilon == law.plane.epsilon
        assert adjust_law(law, {"past": 1.0}) is law
        assert value_in(law, "virtual_stiffness") == law.plane.virtual_stiffness

    def test_nothing_before_the_first_section(self, hop, held):
        """A run from the middle of a hop has the law's own numbers up to its first touchdown."""
        apex = run(held.system, hop.state, 1, Options(rtol=1e-9)).event("apex")
        lands = []
        for system in (held.system, hop.system):
            motion = run(system, Moment(apex.q, apex.v, "flight", {"speed": 0.0}), 1, Options(rtol=1e-9))
            lands.append(next(each.time for each in motion.events if each.name == "touchdown"))
            assert (ADDED + "stance_torque" in motion.held) == (system is held.system)
        assert lands[0] == lands[1]


class TestEngines:
    @pytest.mark.extra("heyoka")
    def test_lanes_are_as_the_reference_engine_says(self, held, beside):
        found = simulate_many(held.system, *(np.array(part) for part in zip(*beside, strict=True)))
        for i, state in enumerate(beside):
            wanted = return_map(held.system, state, 1e-11).state
            np.testing.assert_allclose(found.q[i], wanted[0], rtol=0, atol=1e-9)
            np.testing.assert_allclose(found.v[i], wanted[1], rtol=0, atol=1e-8)

    @pytest.mark.extra("heyoka")
    def test_exact_multipliers_are_those_of_differences(self, held):
        local = chart(held.system, held.state)
        columns = []
        for step in 1e-6 * np.eye(3):
            ends = [local.coordinates(return_map(held.system, local.state(e), 1e-12).state) for e in (step, -step)]
            columns.append((ends[0] - ends[1]) / 2e-6)
        wanted = np.linalg.eigvals(np.array(columns).T)
        for each in multipliers(held.system, held.state):
            assert np.abs(wanted - each).min() < 1e-5

    @pytest.mark.slow
    def test_a_trot_is_the_same_on_either_side(self):
        """Any feedback: from a state and from its mirror image between the halves, half a stride is the same."""
        trot = Gait.load("trot")
        gains = 5.0 * np.random.default_rng(8).normal(size=(10, 36))
        gains[:, :2] = gains[:, 3] = 0.0
        names, nominal = tuple(trot.system.law.inputs), np.concatenate(head_state(*trot.state))
        system = fed(trot, names, gains, nominal, limits=10 * (0.2,)).system
        state = chart(system, trot.state).state(1e-3 * np.random.default_rng(9).normal(size=32))
        first = return_map(system, state, 1e-11)
        whole = run(system, state, 2, Options(rtol=1e-11))
        mirror = mirror_of(system.robot)
        again = return_map(system, tuple(mirror(part) for part in head_state(*first.state)), 1e-11)
        np.testing.assert_allclose(displacement(system, again.state, whole.state), 0.0, rtol=0, atol=1e-7)
        assert abs(displacement(system, first.state, state)).max() > 1e-4


class TestWhen:
    def test_only_where_a_stride_begins(self):
        gait = idle(Gait.load("long_stride"))
        guards = [guard for domain in gait.system.domains for guard in domain.guards if guard.reset is not None]
        assert {guard.name for guard in guards if guard.reset.adjust is not None} == {"posterior_touchdown"}
        assert "posterior_return" in {guard.name for guard in guards}

    def test_domains_that_share_an_event_go_on_sharing_it(self):
        """Motion on a switching surface finds a guard of another domain by its reset."""
        bare = Gait.load("long_stride").system
        before, after = (
            [guard.reset for domain in system.domains for guard in domain.guards if guard.reset is not None]
            for system in (bare, idle(Gait.load("long_stride")).system)
        )
        assert len({*map(id, before)}) == len({*map(id, after)}) < len(after)

    def test_by_the_heading_in_space(self):
        """A state moved and turned has the same deviation; the yaw counts from the heading to which it steers."""
        gait = Gait.load("turn_9")
        nominal = np.concatenate(head_state(*gait.state))
        row = np.random.default_rng(3).normal(size=36)
        system = fed(gait, ("posterior_spread",), [row], nominal, heading=0.2).system
        adjust = system.landing[1].adjust
        q, v = head_state(*gait.state)
        q[[2, 7]] += 0.01, 0.02
        v[[0, 9]] += 0.03, 0.04
        by = row[[2, 7, 18, 27]] @ [0.01, 0.02, 0.03, 0.04]
        assert adjust(q.tolist(), v.tolist(), {}, None)[ADDED + "posterior_spread"] == pytest.approx(by - 0.2 * row[3])
        c, s = np.cos(0.7), np.sin(0.7)
        q[:2], q[3], v[:2] = (5.0, -3.0), 0.7, (c * v[0] - s * v[1], s * v[0] + c * v[1])
        found = adjust(q.tolist(), v.tolist(), {}, None)[ADDED + "posterior_spread"]
        assert found == pytest.approx(by + 0.5 * row[3], abs=1e-12)

    @pytest.mark.extra("example-robot-data")
    def test_between_the_halves_by_a_state_of_its_own(self):
        """A robot whose left and right differ: seen in the mirror, compared with the state halfway."""
        system = solo12_trot_steady().system
        feedback = feedback_of(system)
        assert feedback.between == "halfway" and feedback.halfway != feedback.nominal
        mirror, guards = mirror_of(system.robot), [guard for domain in system.domains for guard in domain.guards]
        second = next(guard.reset for guard in guards if guard.name == "halfway")
        for reset, nominal, see in (
            (system.landing[1], feedback.nominal, np.array),
            (second, feedback.halfway, mirror),
        ):
            q, v = see(np.array(nominal[:18])), see(np.array(nominal[18:]))
            assert max(map(abs, reset.adjust(q.tolist(), v.tolist(), {}, None).values())) < 1e-12


@dataclass(frozen=True)
class Slippery(HoppingLaw):
    """A law with a number that the ground has, too."""

    friction: float = 0.3


class TestWhereNoCycleBegins:
    """Motion on a switching surface and re-touches use the reset of the section, and adjust nothing."""

    def test_the_orbit_stays_as_it_is(self, chattering):
        held = add_feedback(chattering, ("knee_touchdown", "stance_torque"))
        once = return_map(held.system, chattering.state, 1e-11)
        assert "chatter" in " ".join(event.domain for event in once.events)
        assert np.abs(displacement(chattering.system, chattering.state, once.state)).max() < 1e-8
        found = eigenvalues(differentiate_return_map(held.system, chattering.state))
        assert np.abs(held.multipliers) == pytest.approx(np.abs(found), abs=1e-4)

    @pytest.mark.extra("heyoka")
    def test_lanes_after_those_of_other_feedback(self, chattering):
        """Motion on a surface is compiled once for all feedback, as it has none of it."""
        states = [
            chart(chattering.system, chattering.state).state(np.array(xi)) for xi in (3 * [0.0], [0.0, 0.0, 0.003])
        ]
        for gait in (idle(chattering, INPUTS), fed(chattering, INPUTS, GAINS)):
            found = simulate_many(gait.system, *(np.array(part) for part in zip(*states, strict=True)))
            for i, state in enumerate(states):
                wanted = return_map(gait.system, state, 1e-11).state
                np.testing.assert_allclose(found.v[i], wanted[1], rtol=0, atol=1e-6)

    def test_a_retouch_begins_no_cycle(self, hop, held):
        local, seen = chart(hop.system, hop.state), 0
        for i in range(12):
            state, segments = local.state(0.2 * np.random.default_rng(i).normal(size=3)), list[Segment]()
            found = run(held.system, state, 1, Options(1e-9), on_segment=segments.append)
            if any(event.name == RETOUCH for event in found.events):
                seen += 1
                assert len({each.held[ADDED + "stance_torque"] for each in segments}) == 1
        assert seen

    def test_what_is_added_is_added_once_where_two_toes_alternate(self, hop):
        """There a latch calls others, with the law as it is."""
        law, seen = hop.system.law, []
        one = Reset(latch=lambda q, v, held, p: seen.append(p.stance_torque) or {})
        latch_values({ADDED + "stance_torque": 1.0}, [surface._after([one], one)], [0.0], [0.0], law)
        assert seen == 2 * [law.stance_torque + 1.0]


class TestOnAndOff:
    def test_other_changes_stay(self, hop):
        rubbing = with_dry_friction(hop.system, {"boom_z": 0.5})
        held = with_feedback(rubbing, feedback_of(fed(hop, INPUTS, GAINS).system))
        assert [type(change).__name__ for change in held.changes] == ["DryFriction", "EventFeedback"]
        bare = with_feedback(replace(held, phase_limit=2.5), None)
        assert bare.changes == rubbing.changes and bare.phase_limit == 2.5
        assert [domain.name for domain in bare.domains] == [domain.name for domain in rubbing.domains]
        assert all(g.reset is None or g.reset.adjust is None for domain in bare.domains for g in domain.guards)
        assert with_feedback(hop.system, None) is hop.system

    def test_another_in_its_place(self, held):
        feedback = feedback_of(held.system)
        other = with_feedback(held.system, replace(feedback, limits=(0.0, 0.0, 0.0)))
        assert feedback_of(other).limits == (0.0, 0.0, 0.0) and len(other.changes) == 1

    def test_rebuilt_systems_keep_it(self, held):
        assert feedback_of(with_parameters(held.system, {"stance_torque": 8.0})) == feedback_of(held.system)

    def test_files_keep_it(self, held, tmp_path):
        again = Gait.load(held.save(tmp_path / "hop.json"))
        assert feedback_of(again.system) == feedback_of(held.system)
        text = (tmp_path / "hop.json").read_text()
        (tmp_path / "hop.json").write_text(text.replace('"frequency"\n', '"stiffness"\n', 1))
        with pytest.raises(BadFile, match="unknown input 'stiffness'"):
            Gait.load(tmp_path / "hop.json")


class TestRefused:
    def feedback(self, hop, **other):
        whole = feedback_of(fed(hop, INPUTS, GAINS).system)
        return with_feedback(hop.system, replace(whole, **other))

    def test_inputs(self, hop):
        for name in ("stiffness", "friction", "thrust"):
            with pytest.raises(UnknownName, match=name):
                self.feedback(hop, inputs=("stance_torque", "knee_touchdown", name))
        with pytest.raises(UnknownName, match="hip_touchdown"):  # which has no value
            self.feedback(hop, inputs=("stance_torque", "knee_touchdown", "hip_touchdown"))

    def test_a_number_that_the_ground_has_too(self, robot):
        """Its derivatives would be the ground's."""
        system = hopping(robot, Slippery())
        assert "friction" not in numbers_of_law(system) and "stance_torque" in numbers_of_law(system)

    @pytest.mark.parametrize(
        ("other", "said"),
        [
            ({"nominal": (0.0,)}, "nominal"),
            ({"nominal": (np.nan, *5 * (0.0,))}, "nominal"),
            ({"gains": (6 * (0.0,),)}, "gains"),
            ({"gains": 3 * ((0.0,),)}, "gains"),
            ({"limits": (1.0,)}, "gains"),
            ({"limits": (1.0, 1.0, -1.0)}, "limits"),
            ({"heading": np.inf}, "heading"),
            ({"between": "apex", "halfway": (1.0,)}, "halfway"),
            ({"halfway": 6 * (0.0,)}, "between"),
            ({"inputs": ("stance_torque", "frequency", "frequency")}, "each number once"),
        ],
    )
    def test_numbers(self, hop, other, said):
        with pytest.raises(BadValue, match=said):
            self.feedback(hop, **other)

    def test_an_event_that_does_not_exist(self, hop):
        with pytest.raises(UnknownName, match="half_way"):
            self.feedback(hop, between="half_way", halfway=6 * (0.0,))

    def test_ground_on_which_heights_are_others(self, robot, hop):
        sloped = hopping(robot, HoppingLaw(), Spring(), ground=Ground(slope=0.05))
        with pytest.raises(BadValue, match="level ground"):
            with_feedback(sloped, feedback_of(fed(hop, INPUTS, GAINS).system))

    def test_twice(self, held):
        with pytest.raises(BadValue, match="without event feedback"):
            EventFeedback(("stance_torque",), (6 * (0.0,),), 6 * (0.0,), (1.0,))(held.system)


@pytest.mark.slow
def test_a_law_of_ones_own(tmp_path):
    """A biped whose automaton the package does not know."""
    example = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "biped.py"))
    gait = find_gait(example["running"](load("biped")))
    held = add_feedback(gait, ("thrust", "set_back"))
    assert np.abs(eigenvalues(differentiate_return_map(held.system, gait.state)))[:3] == pytest.approx(
        np.abs(held.multipliers[:3]), abs=1e-6
    )
    again = Gait.load(held.save(tmp_path / "run.json"), like=gait.system)
    assert feedback_of(again.system) == feedback_of(held.system)
