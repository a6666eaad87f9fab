"""Many lanes at once: one by one or together, what is rare, what they share, how they end."""

import math
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, Gait, HoppingLaw, Spring, hopping, vary
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid import batch
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.domain import Guard, Reset
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.lanes import runner
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.parameters import change_system, with_parameters
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from tests.hybrid.lanes import FINE, around, assert_agree, assert_same, compiles, refuse_laps, watch_laps

AS_SHIPPED = taylor.LEVEL  # tests compile with less, see `soon_compiled`


@compiles
class TestLanes:
    def test_do_not_depend_on_each_other(self, hop, monkeypatch):
        """The same in another order and in chunks, to the last digit."""
        monkeypatch.setattr(runner, "FEW", 0)
        q, v = around(hop, 0.05, 20)
        everything = simulate_many(hop.system, q, v)
        backwards = simulate_many(hop.system, q[::-1], v[::-1])
        monkeypatch.setattr(batch, "CHUNK", 7)
        told = []
        chunked = simulate_many(hop.system, q, v, on_lanes=told.append)
        assert told == [7, 7, 6]
        np.testing.assert_array_equal(chunked.q, everything.q)
        np.testing.assert_array_equal(backwards.v[::-1], everything.v)

    @pytest.mark.parametrize("spread", [0.01, 0.1])
    def test_one_by_one(self, hop, spread, monkeypatch):
        """Few lanes run one by one: to rounding as together, whatever they meet on their way."""
        q, v = around(hop, spread, 24)
        monkeypatch.setattr(runner, "FEW", 0)
        together = simulate_many(hop.system, q, v, 3, observe=True)
        monkeypatch.setattr(runner, "FEW", 24)
        laps = watch_laps(monkeypatch)
        alone = simulate_many(hop.system, q, v, 3, observe=True)
        refused = sum(each is None for each in laps)
        assert refused == 0 if spread < 0.1 else 0 < refused < len(laps) / 2
        assert_same(alone, together)

    @pytest.mark.parametrize("spread", [0.01, 0.1])
    def test_one_by_one_with_their_own_numbers(self, hop, spread, monkeypatch):
        q, v = around(hop, spread, 8)
        given = {"stiffness": np.linspace(47.0, 50.0, 8), "stance_torque": np.full(8, 7.9), "friction": np.full(8, 0.7)}
        laps = watch_laps(monkeypatch)
        alone = simulate_many(hop.system, q, v, 2, parameters=given)
        assert (None in laps) == (spread == 0.1)  # toes of some alternate
        monkeypatch.setattr(runner, "FEW", 0)
        assert_same(alone, simulate_many(hop.system, q, v, 2, parameters=given))

    def test_strides_one_by_one(self, monkeypatch):
        gait = Gait.load("force_lift_off")
        q, v = around(gait, 2e-4, 3)
        laps = watch_laps(monkeypatch)
        alone = simulate_many(gait.system, q, v, 2)
        assert len(laps) == 6 and None not in laps
        monkeypatch.setattr(runner, "FEW", 0)
        assert_same(alone, simulate_many(gait.system, q, v, 2), 1e-8)

    def test_lanes_that_are_refused_are_left(self, hop, monkeypatch):
        laps = refuse_laps(monkeypatch)
        found = simulate_many(hop.system, *(part[None] for part in hop.state), 6)
        assert len(laps) == runner.PATIENCE and found.cycles[0] == 6

    def test_what_the_reference_engine_observes_unasked(self, hop, monkeypatch):
        """Every arc is left to it."""
        state = [part[None] for part in hop.state]
        expected = simulate_many(hop.system, *state, 2, observe=True)
        monkeypatch.setattr(LoneRunner, "_enter", lambda runner, now: None)
        found = simulate_many(hop.system, *state, 2, observe=True)
        assert_same(found, expected, 1e-8)
        np.testing.assert_allclose(found.observed["apex"], expected.observed["apex"], rtol=0, atol=1e-8)
        assert not simulate_many(hop.system, *state, 2).observed

    def test_an_event_at_once_is_no_reason_to_refuse(self, robot, hop, monkeypatch):
        """The limit on flexion becomes active at touchdown."""
        system = hopping(robot, replace(hop.system.law, minimum_force=12.0), Spring(), Contact())
        laps = watch_laps(monkeypatch)
        q, v = (part[None] for part in hop.state)
        alone = simulate_many(system, q, v, 6)
        assert None not in laps and laps[0].held["limited"] == 0.0
        monkeypatch.setattr(runner, "FEW", 0)
        assert_same(alone, simulate_many(system, q, v, 6), 1e-8)

    def test_when_a_lane_ends(self, robot, hop, monkeypatch):
        """The time that is said counts the cycles that were run alone."""
        law = replace(hop.system.law, stance_torque=1.15 * hop.system.law.stance_torque)
        system = hopping(robot, law, Spring(), Contact(friction=0.3))
        q, v = around(hop, 0.1, 16, seed=1)
        laps = watch_laps(monkeypatch)
        alone = simulate_many(system, q, v, 6)
        later = (alone.reason == "fall") & (alone.cycles >= 1) & ~alone.repeated
        assert later.any() and any(laps)
        monkeypatch.setattr(runner, "FEW", 0)
        assert_same(alone, simulate_many(system, q, v, 6), 1e-8)

    @pytest.mark.parametrize("few", [0, 16])
    def test_what_was_seen_before_the_cycle_that_is_repeated(self, hop, few, monkeypatch):
        """The last apex is that of an earlier cycle, as the third lift-off latches no number."""
        monkeypatch.setattr(runner, "FEW", few)
        state = chart(hop.system, hop.state).state(np.array([0.01, 0.02, 0.02]))
        whole = run(hop.system, state, 3, Options(FINE))
        seen = [event.q for event in whole.events if event.name == "apex"]
        third = float([event for event in whole.events if event.name == "lift_off"][2].q[0])

        def fails(domain):
            guards = []
            for guard in domain.guards:
                if guard.name == "lift_off":
                    old = guard.reset.latch

                    def latch(q, v, held, p, old=old):
                        return {**old(q, v, held, p), "nothing": math.exp(1e5 * (abs(q[0] - third) <= 1e-7))}

                    guard = replace(guard, reset=replace(guard.reset, latch=latch))
                guards.append(guard)
            return replace(domain, guards=tuple(guards))

        system = replace(hop.system, domains=tuple(map(fails, hop.system.domains)))
        found = simulate_many(system, *(part[None] for part in state), 3, observe=True)
        assert (found.reason[0], found.cycles[0], found.repeated[0]) == ("not_finite", 2, True)
        np.testing.assert_allclose(found.observed["apex"][0][:3], seen[1], rtol=0, atol=1e-7)

    @pytest.mark.slow
    @pytest.mark.parametrize("unroll", [False, True])
    def test_however_it_is_compiled(self, hop, unroll, monkeypatch):
        """It computes the same, with loops or without, optimised or not; one lane alone, too."""
        q, v = around(hop, 0.02, 20)
        plain = simulate_many(hop.system, q, v, 2, unroll=unroll)
        monkeypatch.setattr(taylor, "LEVEL", AS_SHIPPED)
        assert_same(simulate_many(hop.system, q, v, 2), plain, 1e-9)
        monkeypatch.setattr(runner, "FEW", 20)
        assert_same(simulate_many(hop.system, q, v, 2), plain, 1e-9)

    @pytest.mark.parametrize("few", [0, 12])
    def test_events_at_the_same_instant(self, hop, few, monkeypatch):
        """One that is only observed does not hide the one that it falls together with."""
        monkeypatch.setattr(runner, "FEW", few)

        def tied(domain):
            slips = [
                replace(guard, name="about_to_slip", reset=None) for guard in domain.guards if guard.name == "slip"
            ]
            return replace(domain, guards=(*slips, *domain.guards))

        system = replace(hop.system, domains=tuple(map(tied, hop.system.domains)))
        q, v = around(hop, 0.05, 12, seed=3)
        found = simulate_many(system, q, v, observe=True)
        np.testing.assert_allclose(found.v, simulate_many(hop.system, q, v).v, rtol=0, atol=1e-8)

    @pytest.mark.parametrize("few", [0, 12])
    def test_beyond_a_guard(self, hop, few, monkeypatch):
        """A guard that is negative on entering is an event even if it rises."""
        monkeypatch.setattr(runner, "FEW", few)
        late = Guard("late", lambda t, q, v, held, p, dyn, ops: t - 5e-7, ends="overload")
        domains = [replace(each, guards=(late, *each.guards[each.phase != "flight" :])) for each in hop.system.domains]
        system = replace(hop.system, domains=tuple(domains))
        assert run(system, hop.state, 1, Options()).reason == "overload"
        assert simulate_many(system, *(part[None] for part in hop.state)).reason[0] == "overload"

    @pytest.mark.parametrize("few", [0, 12])
    def test_a_latch_of_what_is_too_large(self, hop, few, monkeypatch):
        monkeypatch.setattr(runner, "FEW", few)

        def overflows(domain):
            def latch(q, v, held, p):
                return {"nothing": math.exp(1e5 * held.get("taut", 0.0))}

            guards = [
                replace(each, reset=replace(each.reset, latch=latch)) if each.name == "lift_off" else each
                for each in domain.guards
            ]
            return replace(domain, guards=tuple(guards))

        system = replace(hop.system, domains=tuple(map(overflows, hop.system.domains)))
        found = simulate_many(system, *(part[None] for part in hop.state))
        assert found.reason[0] == run(system, hop.state, 1, Options()).reason == "not_finite"

    @pytest.mark.parametrize("few", [0, 12])
    def test_a_latch_without_a_value_for_some(self, hop, few, monkeypatch):
        """One that is no arithmetic for arrays, and so is asked lane by lane."""
        monkeypatch.setattr(runner, "FEW", few)
        torques = [hop.system.law.stance_torque, 0.9 * hop.system.law.stance_torque]
        runs = [
            run(with_parameters(hop.system, {"stance_torque": torque}), hop.state, 1, Options()) for torque in torques
        ]
        limit = sum(each.event("lift_off").v[0] for each in runs) / 2.0

        def overflows(domain):
            def latch(q, v, held, p):
                return {"speed": 0.0, "nothing": math.exp(1e6 * (v[0] - limit))}

            guards = [
                replace(each, reset=replace(each.reset, latch=latch)) if each.name == "lift_off" else each
                for each in domain.guards
            ]
            return replace(domain, guards=tuple(guards))

        system = change_system(hop.system, lambda built: replace(built, domains=tuple(map(overflows, built.domains))))
        q, v = (np.repeat(part[None], 2, axis=0) for part in hop.state)
        found = simulate_many(system, q, v, parameters={"stance_torque": torques})
        assert found.reason.tolist() == ["not_finite", "complete"]

    @pytest.mark.parametrize("few", [0, 12])
    def test_a_section_within_a_phase(self, hop, few, monkeypatch):
        """The phase goes on behind it, its clock running, which the law reads."""
        monkeypatch.setattr(runner, "FEW", few)

        def at_apex(domain):
            guards = []
            for each in domain.guards:
                if each.name == "apex":
                    reset = Reset(latch=lambda q, v, held, p: {"up": -1.0})
                    each = Guard("apex", lambda t, q, v, held, p, dyn, ops: held["up"] * v[0], reset)
                elif each.reset is not None and each.reset.phase == "flight":
                    rises = each.reset.latch
                    latch = lambda q, v, held, p, rises=rises: {**rises(q, v, held, p), "up": 1.0}  # noqa: E731
                    each = replace(each, reset=replace(each.reset, latch=latch))
                guards.append(each)
            law = domain.law
            if domain.phase == "flight":
                law = lambda t, *given: [u + 20.0 * t for u in domain.law(t, *given)]  # noqa: E731
            return replace(domain, guards=tuple(guards), law=law)

        system = replace(hop.system, section="apex", domains=tuple(map(at_apex, hop.system.domains)))
        apex = run(hop.system, hop.state, 1, Options()).event("apex")
        q, v = (apex.q + [0.01, 0.0, 0.0])[None], (apex.v * [0.0, 1.0, 1.0] - [0.01, 0.0, 0.0])[None]
        found, expected = simulate_many(system, q, v, 4), run(system, (q[0], v[0]), 4, Options(FINE))
        assert found.reason[0] == expected.reason == "complete"
        np.testing.assert_allclose(found.q[0], expected.state[0], rtol=0, atol=1e-8)
        assert found.durations["flight"][0] == pytest.approx(expected.durations["flight"], abs=1e-9)

    @pytest.mark.parametrize("few", [0, 12])
    def test_schedules_and_latches_are_each_systems_own(self, hop, few, monkeypatch):
        """Compiled code is shared by systems that differ in what their events do."""
        monkeypatch.setattr(runner, "FEW", few)
        simulate_many(hop.system, *(part[None] for part in hop.state))

        def later(domain):
            if domain.switch is None:
                return domain
            return replace(domain, switch=replace(domain.switch, time=lambda n, p: 0.52 * n / p.frequency))

        system = replace(hop.system, domains=tuple(map(later, hop.system.domains)))
        q, v = around(hop, 0.01, 3)
        assert_agree(system, q, v, simulate_many(system, q, v))

    def test_threads(self, hop):
        """Integrators are shared, and used by one thread at a time."""
        q, v = around(hop, 0.02, 3)
        expected = simulate_many(hop.system, q, v, 5)
        with ThreadPoolExecutor(4) as pool:
            for found in pool.map(lambda _: simulate_many(hop.system, q, v, 5), range(24)):
                np.testing.assert_array_equal(found.v, expected.v)

    @pytest.mark.parametrize(
        ("name", "said"),
        [("rest", "lanes|fields of the law"), ("hip_touchdown", "set it in the law"), ("unilateral", "unknown")],
    )
    def test_refuses_what_lanes_cannot_differ_in(self, robot, hop, name, said):
        system = hopping(robot, hop.system.law, Spring(rest=1.0))
        with pytest.raises((BadValue, UnknownName), match=said):
            simulate_many(system, *(part[None] for part in hop.state), parameters={name: [1.0]})

    def test_observed(self, hop):
        """The state at the apex, of lanes that the reference engine repeats too."""
        q, v = around(hop, 0.1, 6)
        assert not simulate_many(hop.system, q, v).observed
        found = simulate_many(hop.system, q, v, observe=True)
        assert_agree(hop.system, q, v, found)
        for i, state in enumerate(zip(q, v, strict=True)):
            apex = run(hop.system, state, 1, Options(FINE)).event("apex")
            np.testing.assert_allclose(found.observed["apex"][i], [*apex.q, *apex.v], rtol=0, atol=1e-8)

    def test_share_what_is_compiled(self, hop):
        """Robots and springs that differ in numbers only."""
        q, v = around(hop, 0.005, 4)
        simulate_many(hop.system, q, v)
        before = taylor.compile_domain.cache_info().misses
        geared = hopping(vary(hop.system.robot, knee_ratio=18.0), hop.system.law)
        for other in (geared, with_parameters(hop.system, {"stiffness": 50.0, "damping": 1.2})):
            found = simulate_many(other, q, v)
            assert taylor.compile_domain.cache_info().misses == before
            assert_agree(other, q, v, found)

    def test_below_ground(self, hop):
        q, v = around(hop, 0.01, 3)
        q[1, 0] -= 0.1
        found = simulate_many(hop.system, q, v)
        assert found.reason.tolist() == ["complete", "below_ground", "complete"]
        assert "-0.1" in found.message[1] and found.cycles.tolist() == [1, 0, 1]

    def test_stands_still(self, robot, hop):
        """Too weak to leave the ground."""
        system = hopping(robot, HoppingLaw(stance_torque=0.1))
        q, v = around(hop, 0.01, 2)
        found = simulate_many(system, q, 0.05 * v)
        assert found.reason.tolist() == ["no_event"] * 2 and "5 s in stance" in found.message[0]
        assert_agree(system, q, 0.05 * v, found)

    @pytest.mark.parametrize("observe", [False, True])
    def test_flies_away(self, hop, observe):
        """Longer than a phase may last."""
        q, v = np.array([[1.0, 0.5, 1.0]]), np.array([[60.0, 0.0, 0.0]])
        found = simulate_many(hop.system, q, v, observe=observe)
        assert found.reason.tolist() == ["no_event"] and "5 s in flight" in found.message[0]
        assert_agree(hop.system, q, v, found)

    def test_none(self, hop):
        found = simulate_many(hop.system, np.zeros((0, 3)), np.zeros((0, 3)))
        assert found.q.shape == (0, 3) and found.message == ()
