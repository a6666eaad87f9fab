"""What a lane on its own may pass over, and what it has to leave to the others: against the reference engine."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.domain import Guard, Reset, Switch
from spear_pin.hybrid.engines.taylor import Code, Ready
from spear_pin.hybrid.engines.taylor_single import UNCLEAR, Single
from spear_pin.hybrid.fields import flatten
from spear_pin.hybrid.lanes import runner
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.modes import starting_phase
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from tests.hybrid.lanes import FINE, watch_laps

pytestmark = pytest.mark.extra("heyoka")


def also(system, phase, *guards, **changes):
    """A system with guards more in a phase, and other changes there."""
    domains = [
        replace(each, guards=(*each.guards, *guards), **changes) if each.phase == phase else each
        for each in system.domains
    ]
    return replace(system, domains=tuple(domains))


def latching(system, event, latch):
    """A system in which an event latches more."""

    def more(guard):
        if guard.name != event or guard.reset is None:
            return guard
        own = guard.reset.latch or (lambda q, v, held, p: {})
        both = replace(guard.reset, latch=lambda q, v, held, p: {**own(q, v, held, p), **latch(q, v, held, p)})
        return replace(guard, reset=both)

    return replace(
        system, domains=tuple(replace(each, guards=tuple(map(more, each.guards))) for each in system.domains)
    )


def compared(system, state, cycles=1):
    """A lane and the run of the reference engine."""
    found = simulate_many(system, *(part[None] for part in state), cycles)
    expected = run(system, state, cycles, Options(FINE))
    assert (found.reason[0], found.cycles[0]) == (expected.reason, expected.cycles)
    return found, expected


def laps(system, gait):
    """The first cycle by a lane alone, or None."""
    numbers = Numbers(system, {}, Code(1e-12))
    phase, held = starting_phase(system, gait.state)
    return LoneRunner(numbers, 0).lap(phase, np.concatenate(gait.state), held, [0.0])


def entered(system, gait):
    """What the first domain of the stance is at the gait's state."""
    numbers = Numbers(system, {}, Code(1e-12))
    _, held = starting_phase(system, gait.state)
    single = numbers.compilation.single(system.domains[0], held)
    parameters = np.array([*numbers.constants(0), *flatten(held.values())])
    return single.enter(0.0, np.concatenate(gait.state), parameters)


def nothing(q, ops):
    """Zero, which no compiler sees."""
    return ops.sqrt(q[0] * q[0]) - q[0]


class TestUnclear:
    def test_a_guard_that_stays_on_zero(self, hop):
        """Or a hair above it."""
        assert entered(hop.system, hop).event != UNCLEAR
        for above in (0.0, 1e-12):
            stays = Guard("stays", lambda t, q, v, held, p, dyn, ops, by=above: nothing(q, ops) + by, Reset())
            assert entered(also(hop.system, "stance", stays), hop).event == UNCLEAR

    def test_a_kink_that_stays_on_zero(self, hop):
        def bent(domain):
            own = domain.law

            def law(t, q, v, held, p, dyn, ops):
                hip, knee = own(t, q, v, held, p, dyn, ops)
                return hip, knee + ops.maximum(nothing(q, ops), 0.0)

            return replace(domain, law=law) if domain.phase == "stance" else domain

        assert entered(replace(hop.system, domains=tuple(map(bent, hop.system.domains))), hop).event == UNCLEAR


class TestInstants:
    def test_events_that_accumulate(self, hop):
        """So many in an instant as end a run, though not more than a cycle may have."""
        tick = Reset(latch=lambda q, v, held, p: {"ticks": held["ticks"] + 1.0})
        ticking = Guard("tick", lambda t, q, v, held, p, dyn, ops: held["ticks"] - 24.5, tick)
        system = also(latching(hop.system, "touchdown", lambda q, v, held, p: {"ticks": 0.0}), "stance", ticking)
        found, _ = compared(system, hop.state)
        assert found.reason[0] == "zeno"

    def test_two_crossings_of_the_section_in_one_instant_bound_no_cycle(self, hop):
        """At a touch that is followed by another, 50 ns later; the spring is one that is never slack."""

        def passes(q, v, held, p):
            return {"passed": 1.0}

        again = Reset(latch=passes, phase="stance")
        twice = Guard("touchdown", lambda t, q, v, held, p, dyn, ops: held["passed"] + 5e-8 - t, again)
        system = rebuilt(hop.system, spring=replace(hop.system.spring, unilateral=False))
        system = also(latching(system, "touchdown", lambda q, v, held, p: {"passed": 0.0}), "stance", twice)
        q, v = (part.copy() for part in hop.state)
        v[1] += 0.05
        found, expected = compared(system, (q, v), 2)
        np.testing.assert_allclose(found.q[0], expected.state[0], rtol=0, atol=1e-8)


@pytest.mark.parametrize("few", [1, 0])
def test_what_is_observed_is_passed(hop, few, monkeypatch):
    """Rounding leaves every other event just ahead of where it was found, so that it would be found again and again."""

    def falls_to(speed):
        return lambda t, q, v, held, p, dyn, ops: v[0] - speed

    guards = [Guard(f"speed {speed:.3f}", falls_to(speed)) for speed in np.linspace(-0.6, 0.6, 12)]
    system = also(hop.system, "flight", *guards)
    monkeypatch.setattr(runner, "FEW", few)
    laps = watch_laps(monkeypatch)
    found = simulate_many(system, *(part[None] for part in hop.state), 3, observe=True)
    assert len(laps) == 3 * few and None not in laps and not found.repeated.any()
    expected = run(system, hop.state, 3, Options(FINE))
    for guard in guards:
        event = expected.event(guard.name)
        np.testing.assert_allclose(found.observed[guard.name][0], [*event.q, *event.v], rtol=0, atol=1e-8)
    np.testing.assert_allclose(found.q[0], expected.state[0], rtol=0, atol=1e-8)


class TestSwitches:
    def test_begin_anew_with_a_phase(self, hop):
        """Of stance and flight, which both have some."""
        flips = Reset(latch=lambda q, v, held, p: {"push": 1.0 - held.get("push", 0.0)})
        flight = hop.system.domains[-1]
        own = flight.law

        def law(t, q, v, held, p, dyn, ops):
            hip, knee = own(t, q, v, held, p, dyn, ops)
            return hip + 3.0 * held["push"], knee

        flying = replace(flight, law=law, switch=Switch("flip", lambda n, p: 0.04 * n, flips))
        system = replace(hop.system, domains=(*hop.system.domains[:-1], flying))
        system = latching(system, "lift_off", lambda q, v, held, p: {"push": 0.0})
        assert laps(system, hop) is not None
        found, expected = compared(system, hop.state, 2)
        np.testing.assert_allclose(found.v[0], expected.state[1], rtol=0, atol=1e-7)
        assert sum(event.name == "flip" for event in expected.events) == 9

    def test_one_that_is_due_within_the_step_off_the_guards(self, hop):
        """A lane that is off by that step is not off by more."""
        stance = hop.system.domains[0].switch

        def early(n, p):
            return 4e-7 if n == 1 else stance.time(n - 1, p)

        system = also(hop.system, "stance", switch=replace(stance, time=early))
        system = latching(system, "touchdown", lambda q, v, held, p: {"flexing": -held.get("flexing", 1.0)})
        found, expected = compared(system, hop.state)
        np.testing.assert_allclose(found.q[0], expected.state[0], rtol=0, atol=1e-8)


class TestCyclesBefore:
    def falling(self, free_hop):
        """A hop that is whole for some cycles, and then falls."""
        q, v = (part.copy() for part in free_hop.state)
        v[0] += 0.05
        return free_hop.system, (q, v)

    def test_the_time_of_a_fall_counts_them(self, free_hop):
        system, state = self.falling(free_hop)
        found, expected = compared(system, state, 8)
        assert found.reason[0] == "fall" and found.cycles[0] >= 2
        assert found.message[0] == expected.message

    def test_what_is_repeated_begins_behind_them(self, free_hop, monkeypatch):
        system, state = self.falling(free_hop)
        asked = []

        def recorded(system, state, cycles, options):
            asked.append(cycles)
            return run(system, state, cycles, options)

        monkeypatch.setattr(runner, "run", recorded)
        monkeypatch.setattr(runner.Lanes, "finish", given_up(runner.Lanes.finish))
        whole = compared(system, state, 8)[0].cycles[0]
        assert asked == [8 - whole]


def given_up(finish):
    """Has lanes that fall repeated, as any may be."""

    def changed(self, lanes, reason, detail):
        if reason == "fall":
            self.repeated[lanes] = True
        finish(self, lanes, reason, detail)

    return changed


@pytest.mark.parametrize("n", [1, 3])
def test_steps_are_as_short_as_asked_for(monkeypatch, n):
    """One alone, and several side by side."""
    gait, seen = Gait.load("long_stride"), []
    for kind in (Single, Ready):
        integrate = kind.run

        def noted(self, *given, integrate=integrate, **options):
            seen.append(given[4])
            return integrate(self, *given, **options)

        monkeypatch.setattr(kind, "run", noted)
    simulate_many(gait.system, *(np.tile(part, (n, 1)) for part in gait.state), max_step=1e-3)
    assert seen and set(seen) == {1e-3}
