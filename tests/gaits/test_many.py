"""Many gaits at once against the search for one, and what they say where there is none."""

import sys

import numpy as np
import pytest

from spear_pin import Gait, find_gait
from spear_pin.errors import BadValue, MissingExtra, UnknownName
from spear_pin.gaits import lane_cycles, many
from spear_pin.gaits.gait_table import CONVERGED, REASONS
from spear_pin.gaits.lane_cycles import LaneCycles
from spear_pin.gaits.many import find_many
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import chart, differentiate_return_map, eigenvalues, multipliers, residual
from spear_pin.hybrid.tangent.resets import NotDifferentiable

compiles = pytest.mark.extra("heyoka")
WANTED = {"flight_time": 0.2}


def numbers(n, seed=0):
    rng = np.random.default_rng(seed)
    return {"stiffness": rng.uniform(46.0, 52.0, n), "damping": rng.uniform(1.1, 1.5, n)}


def assert_is(table, i, gait):
    """A row is a gait that was found alone."""
    np.testing.assert_allclose(table.q[i], gait.state[0], rtol=0, atol=1e-7)
    np.testing.assert_allclose(table.v[i], gait.state[1], rtol=0, atol=1e-7)
    d = len(gait.multipliers)
    np.testing.assert_allclose(table.multipliers[i, :d], gait.multipliers, rtol=0, atol=1e-5)
    for phase, seconds in gait.durations.items():
        assert table.durations[phase][i] == pytest.approx(seconds, abs=1e-7)
    for name, value in gait.parameters.items():
        assert table.parameters[name][i] == pytest.approx(value, abs=1e-6)


@compiles
class TestAgainstOneSearch:
    def test_for_a_flight_time(self, robot, hop):
        given = numbers(5)
        told = []
        table = find_many(hop.system, given, ["stance_torque"], WANTED, guess=hop.state, on_lanes=told.append)
        assert table.reason.tolist() == [CONVERGED] * 5 and sum(told) == 5
        for i in range(5):
            system = with_parameters(hop.system, {name: float(values[i]) for name, values in given.items()})
            assert_is(table, i, find_gait(system, ["stance_torque"], WANTED))

    def test_for_targets_of_their_own(self, hop):
        wanted = np.array([0.195, 0.2, 0.21, 0.17])
        given = {"stiffness": np.full(4, 48.84)}
        table = find_many(hop.system, given, ["stance_torque"], {"flight_time": wanted}, guess=hop.state)
        # there is none with 0.17 s: later lift-off than at the torque's switch goes with flights below 0.15 s
        assert table.converged.tolist() == [True, True, True, False]
        np.testing.assert_allclose(table.durations["flight"][:3], wanted[:3], atol=1e-9)
        assert_is(table, 1, hop)

    def test_for_an_apex(self, hop, hops):
        apex = [event for event in hops.events if event.name == "apex"][-1].q[0]
        given = {"stiffness": np.array([48.84])}
        assert_is(find_many(hop.system, given, ["stance_torque"], {"apex_height": apex}), 0, hop)

    def test_with_nothing_to_solve_for(self, free_hop):
        torques = free_hop.system.law.stance_torque + np.array([0.0, 0.02])
        table = find_many(free_hop.system, {"stance_torque": torques}, guess=free_hop.state)
        assert table.multipliers.shape == (2, 4) and not table.stable.any()
        for i, torque in enumerate(torques):
            system = with_parameters(free_hop.system, {"stance_torque": float(torque)})
            assert_is(table, i, find_gait(system, guess=free_hop.state))

    @pytest.mark.slow
    def test_bounds(self):
        gait = Gait.load("long_stride")
        table = find_many(gait.system, {"stiffness": np.array([105.0])}, guess=gait.state)
        assert table.converged.all()
        alone = eigenvalues(differentiate_return_map(gait.system, gait.state))
        np.testing.assert_allclose(table.multipliers[:, : len(alone)], [alone], rtol=0, atol=1e-5)
        np.testing.assert_allclose(table.v, [gait.state[1]], rtol=0, atol=1e-6)


@compiles
class TestExactJacobians:
    """Of lanes whose cycles take longer than a derivative; the hop's do not, so that both kinds are quick for it."""

    ASKED = ({"stiffness": [48.0, 49.0, 50.0]}, ["stance_torque"], WANTED)

    @pytest.fixture
    def lanes(self, monkeypatch):
        """Numbers of lanes in each call of the batch engine."""
        run, counts = lane_cycles.simulate_many, []

        def counted(system, q, *rest, **options):
            counts.append(len(q))
            return run(system, q, *rest, **options)

        monkeypatch.setattr(lane_cycles, "simulate_many", counted)
        return counts

    def test_find_the_gaits_of_differences(self, hop, lanes, monkeypatch):
        differenced = find_many(hop.system, *self.ASKED, guess=hop.state)
        before = sum(lanes)
        monkeypatch.setattr(lane_cycles, "is_unrolled", lambda system: False)
        exact = find_many(hop.system, *self.ASKED, guess=hop.state)
        assert sum(lanes) - before < 0.5 * before and exact.converged.all()
        np.testing.assert_allclose(exact.v, differenced.v, rtol=0, atol=1e-9)
        np.testing.assert_allclose(exact.multipliers, differenced.multipliers, rtol=0, atol=1e-7)
        assert (exact.multipliers != differenced.multipliers).any()

    def test_give_way_to_differences_where_there_is_none(self, hop, monkeypatch):
        known = find_many(hop.system, *self.ASKED, guess=hop.state)

        def refused(system, state):
            raise NotDifferentiable("an event has none")

        monkeypatch.setattr(lane_cycles, "is_unrolled", lambda system: False)
        monkeypatch.setattr(lane_cycles, "tangent_cycles", lambda *given: None)
        monkeypatch.setattr(lane_cycles, "exact_jacobian", refused)
        found = find_many(hop.system, *self.ASKED, guess=hop.state)
        np.testing.assert_array_equal(found.multipliers, known.multipliers)


@compiles
class TestDifferences:
    """Of cycles beside a gait, one of which is changed."""

    @pytest.fixture
    def beside(self, hop, monkeypatch):
        """Finds the multipliers of a hop with a change of its last cycle."""
        run = LaneCycles.__call__

        def found(change):
            def changed(self, lanes, q, v, values):
                after = run(self, lanes, q, v, values)
                change(after)
                return after

            monkeypatch.setattr(LaneCycles, "__call__", changed)
            cycles = LaneCycles(hop.system, {"stiffness": np.array([48.84])}, (), (), 1e-9)
            return lane_cycles.multipliers(cycles, chart(hop.system, hop.state).lane, np.empty((1, 0)))

        return found

    def test_of_one_that_does_not_close(self, beside):
        def opened(after):
            after.reason[-1] = "no_event"

        spectra = beside(opened)
        assert spectra.reason[0] == "no_multipliers" and np.isnan(spectra.multipliers).all()

    def test_of_one_that_the_reference_engine_ran(self, hop, beside):
        def other(after):
            after.reference[-1], after.q[-1] = True, after.q[-1] + 1e-6

        np.testing.assert_allclose(beside(other).multipliers[0], multipliers(hop.system, hop.state), rtol=0, atol=1e-6)


@compiles
@pytest.mark.slow
def test_a_turn_on_other_ground():
    """In space, from beside a kept gait of which a foot slides; with heading and place left out."""
    gait = Gait.load("turn_9")
    q, v = gait.state
    found = find_many(gait.system, {"friction": [0.9]}, guess=(q + 1e-5 * np.sin(np.arange(len(q))), v))
    there, state = with_parameters(gait.system, {"friction": 0.9}), (found.q[0], found.v[0])
    assert found.reason[0] == CONVERGED and residual(there, state) < 2e-9 < 1e-5 < residual(there, gait.state)
    known = np.abs(multipliers(there, state))  # of exact derivatives
    np.testing.assert_allclose(np.abs(found.multipliers[0, : len(known)]), known, rtol=0, atol=2e-6)


@compiles
class TestLanes:
    def test_do_not_depend_on_their_order(self, hop):
        given = {name: np.append(values, 1.4) for name, values in numbers(9).items()}
        tables = [
            find_many(hop.system, {name: values[::step] for name, values in given.items()}, ["stance_torque"], WANTED)
            for step in (1, -1, 1)
        ]
        for other, step in ((tables[1], -1), (tables[2], 1)):
            for name in ("q", "v", "multipliers", "residual"):
                np.testing.assert_array_equal(getattr(other, name)[::step], getattr(tables[0], name))
            np.testing.assert_array_equal(other.reason[::step], tables[0].reason)

    def test_begin_from_neighbours(self, hop, monkeypatch):
        """Far from the guess Newton's method fails, and gets there from lane to lane."""
        given = {"stance_torque": np.linspace(4.5, 9.0, 13)}
        monkeypatch.setattr(many, "ROUNDS", 0)
        monkeypatch.setattr(many._Lanes, "settle", lambda self, guess: None)
        alone = find_many(hop.system, given, guess=hop.state).converged
        monkeypatch.setattr(many, "ROUNDS", 6)
        table = find_many(hop.system, given, guess=hop.state)
        assert table.converged.all() and not alone.all()

    def test_say_why_there_is_no_gait(self, hop):
        given = {"stance_torque": np.array([7.8, 0.05, -1.0])}
        table = find_many(hop.system, given, guess=hop.state)
        assert table.converged.tolist() == [True, False, False] and table.stable.tolist() == [True, False, False]
        assert table.reason[2] == "not_valid" and set(table.reason) <= set(REASONS)
        assert np.isnan(table.q[1:]).all() and np.isnan(table.largest[1:]).all()


@compiles
class TestBadInput:
    def test_measures(self, hop):
        given = {"stiffness": np.array([48.0])}
        with pytest.raises(BadValue, match="^target is 'knee_at_touchdown'; expected one of flight_time"):
            find_many(hop.system, given, ["stance_torque"], {"knee_at_touchdown": 1.0})
        with pytest.raises(UnknownName, match="hight"):
            find_many(hop.system, given, ["stance_torque"], {"hight": 1.0})
        with pytest.raises(BadValue, match="^target is "):
            find_many(hop.system, given, ["stance_torque"])
        with pytest.raises(BadValue, match="^target flight_time is "):
            find_many(hop.system, given, ["stance_torque"], {"flight_time": [0.2, 0.3]})
        for wanted in (0.03, [0.03], np.nan):
            with pytest.raises(BadValue, match="^target flight_time is .*; expected a number from 0.05 to 5, in s"):
                find_many(hop.system, given, ["stance_torque"], {"flight_time": wanted})

    def test_parameters(self, hop):
        for given in ({}, {"stiffness": 48.0}, {"stiffness": [np.nan]}, {"stiffness": [1.0], "damping": [1.0, 2.0]}):
            with pytest.raises(BadValue, match="^parameters"):
                find_many(hop.system, given)
        with pytest.raises(UnknownName, match="stiffnes"):
            find_many(hop.system, {"stiffnes": [48.0]})

    def test_without_the_extra(self, hop, monkeypatch):
        monkeypatch.setitem(sys.modules, "heyoka", None)
        with pytest.raises(MissingExtra, match=r"\.\[fast\]"):
            find_many(hop.system, {"stiffness": [48.0]})
