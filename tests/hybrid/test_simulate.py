"""Simulation: how events and cycles appear in the samples, that the hop is stable, and arguments that are refused."""

import math
import weakref
from dataclasses import fields

import numpy as np
import pytest

from spear_pin import Spring, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.hybrid.result import Options, Piece
from spear_pin.hybrid.run import run
from spear_pin.hybrid.simulate import sample
from spear_pin.hybrid.trajectory import SAMPLED
from tests.hybrid.motions import stretches


class TestSamples:
    def test_times_do_not_decrease(self, hops, slipping):
        assert (np.diff(hops.t) >= 0).all()
        assert (np.diff(slipping.t) >= 0).all()

    def test_at_least_a_hundred_in_every_phase(self, hops, slipping):
        for trajectory in (hops, slipping):
            assert min(part.stop - part.start for part in stretches(trajectory)[:-1]) >= 100

    def test_both_sides_of_every_event(self, hops):
        resets = [event for event in hops.events if event.name != "apex"]
        for event in resets[:-1]:
            before, after = np.flatnonzero(hops.t == event.time)
            assert after == before + 1
            np.testing.assert_allclose(hops.q[before], event.q, rtol=0, atol=1e-9)
            np.testing.assert_allclose(hops.v[before], event.v_before, rtol=0, atol=1e-8)
            np.testing.assert_array_equal(hops.q[after], event.q)
            np.testing.assert_array_equal(hops.v[after], event.v)
            assert hops.domain[before] == event.domain
            assert hops.domain[after] != event.domain or event.name == "torque_switch"

    def test_the_last_sample_is_the_last_event(self, hops):
        assert hops.t[-1] == hops.events[-1].time
        np.testing.assert_allclose(hops.q[-1], hops.events[-1].q, rtol=0, atol=1e-9)
        np.testing.assert_allclose(hops.v[-1], hops.events[-1].v_before, rtol=0, atol=1e-8)

    def test_cycles_are_numbered_from_one(self, hops):
        touchdowns = [event.time for event in hops.named("touchdown")]
        assert hops.complete and hops.cycles == 11
        np.testing.assert_array_equal(np.unique(hops.cycle), np.arange(1, 12))
        for number, (begin, end) in enumerate(zip([0.0, *touchdowns[:-1]], touchdowns, strict=True), start=1):
            inside = (hops.t > begin) & (hops.t < end)
            assert (hops.cycle[inside] == number).all()

    def test_what_lies_before_the_first_touchdown_is_cycle_zero(self, hop, hops):
        apex = hops.named("apex")[0]
        trajectory = simulate(hop.system, (apex.q, apex.v), cycles=2)
        np.testing.assert_array_equal(np.unique(trajectory.cycle), [0, 1, 2])
        assert (trajectory.phase[trajectory.cycle == 0] == "flight").all()
        assert trajectory.cycles == 2 and len(trajectory.named("touchdown")) == 3
        assert trajectory.ledger.change.shape == (2,)

    def test_apex_is_the_highest_sample(self, hops):
        for apex in hops.named("apex"):
            assert abs(apex.v[0]) < 1e-9
        assert hops.q[:, 0].max() <= max(apex.q[0] for apex in hops.named("apex")) + 1e-9

    def test_a_run_that_ends_at_once(self, hop):
        trajectory = simulate(hop.system, hop.state, max_evaluations=1)
        assert trajectory.reason == "evaluation_cap"
        assert len(trajectory.t) == len(trajectory.q) == len(trajectory.domain)

    def test_the_same_bits_again(self, hop, hops):
        again = simulate(hop.system, hop.state, cycles=11)
        for name in ("t", "q", "v", "a", "force", "tau"):
            np.testing.assert_array_equal(getattr(again, name), getattr(hops, name))

    def test_states_are_not_changed(self, hop):
        q, v = (part.copy() for part in hop.state)
        simulate(hop.system, (q, v))
        np.testing.assert_array_equal(q, hop.state[0])
        np.testing.assert_array_equal(v, hop.state[1])


class TestLongRuns:
    def test_what_it_interpolates_with_is_let_go(self, hop, monkeypatch):
        """The steps of no more than a phase or two are held at once, however many hops there are."""
        live, most = weakref.WeakSet(), 0

        class Counted(Piece):
            def __init__(self, *fields):
                nonlocal most
                super().__init__(*fields)
                live.add(self)
                most = max(most, len(live))

        monkeypatch.setattr("spear_pin.hybrid.integration.Piece", Counted)
        simulate(hop.system, hop.state)
        of_one, most = most, 0
        simulate(hop.system, hop.state, cycles=6)
        assert 5 < most <= of_one

    def test_samples_of_a_hop_take_60_kilobytes(self, hops):
        """At most, so that with events and ledger 2,000 hops stay below 150 MB."""
        arrays = [value for field in fields(hops) if isinstance(value := getattr(hops, field.name), np.ndarray)]
        assert len(arrays) == 15 and sum(array.nbytes for array in arrays) < 60_000 * hops.cycles
        assert len(hops) == len(hops.t)

    def test_nothing_is_left_out(self, hop, hops):
        """What is asked of all hops at once is what the hops give one after the other."""
        state, samples = hop.state, 0
        for number in range(3):
            one = simulate(hop.system, state)
            np.testing.assert_allclose(one.ledger.work[0], hops.ledger.work[number], rtol=0, atol=1e-8)
            state, samples = (one.events[-1].q, one.events[-1].v), samples + len(one)
        assert samples == (hops.cycle <= 3).sum()


class TestMoreSamples:
    def test_of_each_phase_as_many_as_asked_for(self, hop, hops):
        fine = simulate(hop.system, hop.state, cycles=2, samples=1000)
        assert min(part.stop - part.start for part in stretches(fine)) >= 1000
        few = simulate(hop.system, hop.state, cycles=2, samples=1)
        assert len(few) < len(fine) / 50
        for trajectory in (few, fine):  # the motion is the same
            assert [event.time for event in trajectory.events] == [event.time for event in hops.events[:10]]
            np.testing.assert_array_equal(trajectory.ledger.work, hops.ledger.work[:2])

    @pytest.mark.parametrize("samples", [0, -1, 1.5, math.nan, math.inf, "many", None])
    def test_refused(self, hop, samples):
        with pytest.raises(BadValue, match="^samples is .*; expected a whole number, at least 1"):
            simulate(hop.system, hop.state, samples=samples)


class TestStability:
    def test_an_error_in_the_knee_rate_is_forgotten_by_the_fifth_hop(self, hop, hops):
        apex = hops.named("apex")[0]
        disturbed = apex.v + np.array([0.0, 0.0, 1.0])
        heights = [e.q[0] for e in simulate(hop.system, (apex.q, disturbed), cycles=6).named("apex")]
        after = [height - apex.q[0] for height in heights if abs(height - apex.q[0]) > 0.0]
        assert max(map(abs, after[:2])) > 1e-4
        assert np.abs(np.array(heights[5:]) - apex.q[0]).max() < 1e-4

    def test_every_hop_is_the_same(self, hop, hops):
        assert np.ptp([event.q[0] for event in hops.named("apex")]) < 1e-7
        assert np.ptp(np.diff([event.time for event in hops.named("touchdown")])) < 1e-7


class TestRefusals:
    GOOD = (0.6, 0.5, 1.0), (0.0, 0.0, 0.0)

    @pytest.mark.parametrize(
        ("state", "name"),
        [
            (((0.6, 0.5), (0.0, 0.0, 0.0)), "q"),
            (((0.6, 0.5, 1.0), (0.0, 0.0, 0.0, 0.0)), "v"),
            (((0.6, 0.5, 1.0, 0.0), (0.0, 0.0, 0.0)), "q"),
            (((0.6, math.nan, 1.0), (0.0, 0.0, 0.0)), "q[1]"),
            (((0.6, 0.5, 1.0), (0.0, 0.0, math.inf)), "v[2]"),
            (((0.5, 0.0, 0.0), (0.0, 0.0, 0.0)), "height of toe"),
            ((0.6, 0.5, 1.0), "state"),
            (None, "state"),
            ((("a", 0.5, 1.0), (0.0, 0.0, 0.0)), "q"),
        ],
        ids=str,
    )
    def test_state(self, hop, state, name):
        with pytest.raises(BadValue) as error:
            simulate(hop.system, state)
        assert error.value.name == name

    @pytest.mark.parametrize(
        ("options", "name"),
        [
            ({"rtol": 1.0}, "rtol"),
            ({"rtol": 1e-14}, "rtol"),
            ({"rtol": 0.0}, "rtol"),
            ({"rtol": -1e-9}, "rtol"),
            ({"rtol": math.nan}, "rtol"),
            ({"atol": 0.0}, "atol"),
            ({"atol": math.nan}, "atol"),
            ({"atol": 1.0}, "atol"),
            ({"cycles": 0}, "cycles"),
            ({"cycles": -3}, "cycles"),
            ({"cycles": 1.5}, "cycles"),
            ({"cycles": math.nan}, "cycles"),
        ],
        ids=str,
    )
    def test_options(self, hop, options, name):
        with pytest.raises(BadValue) as error:
            simulate(hop.system, self.GOOD, **{"max_evaluations": 20000} | options)
        assert error.value.name == name


def test_a_kept_run_is_sampled_as_one_that_is_simulated(hop):
    kept = run(hop.system, hop.state, 2, Options(keep=True))
    trajectory, again = simulate(hop.system, hop.state, cycles=2), sample(hop.system, kept)
    for name in SAMPLED:
        np.testing.assert_array_equal(getattr(again, name), getattr(trajectory, name))
    np.testing.assert_array_equal(again.ledger.work, trajectory.ledger.work)


def test_spring_without_stiffness_is_never_engaged_so_that_nobody_draws_it():
    system = hopping(load("spear_ii", locked=["boom_x"]), HoppingLaw(virtual_stiffness=48.84), Spring(stiffness=0.0))
    motion = simulate(system, system.guess())
    assert motion.spring_joints == ("knee",) and not motion.engaged.any()
