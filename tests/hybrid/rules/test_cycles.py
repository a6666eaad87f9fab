"""What closes a cycle: a toe that hardly left the ground re-touches, and no cycle ends there."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Gait, simulate, simulate_many
from spear_pin.hybrid.automaton import SHORTEST_FLIGHT
from spear_pin.hybrid.domain import Reset, Switch
from spear_pin.hybrid.fields import ADDED
from spear_pin.hybrid.hardware import Sensing
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.rules.cycles import (
    AT_ONCE,
    CREEP,
    CYCLE_EVENTS,
    INSTANT,
    INSTANT_EVENTS,
    RETOUCH,
    count_crowd,
    counts_to,
    creeps,
    due,
    flight_times,
    left_at_once,
    retouches,
    too_many,
    whole,
)
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.hybrid.run import run
from spear_pin.studies.hardware import Rig, on_rig
from spear_pin.studies.hop import durations
from tests.hybrid.lanes import assert_agree, compiles

HOPS = 4


@pytest.fixture(scope="module")
def gait(hop):
    return hop


@pytest.fixture(scope="module")
def stiff(gait):
    """With this spring the toe leaves the ground and comes back a few milliseconds after most touchdowns."""
    return with_parameters(gait.system, {"stiffness": 80.0})


@pytest.fixture(scope="module")
def hops(gait, stiff):
    return simulate(stiff, gait.state, HOPS)


def lifted(trajectory, event):
    """How long before an event the toe last lifted off, in s."""
    return event.time - max(e.time for e in trajectory.named("lift_off") if e.time < event.time)


class TestHop:
    def test_every_hop_has_its_flight(self, hops):
        assert hops.complete and hops.cycles == HOPS == len(hops.named("touchdown"))
        for n in range(1, HOPS + 1):
            begin, end = hops.t[hops.cycle == n][[0, -1]]
            assert sum(begin < apex.time < end for apex in hops.named("apex")) == 1
        assert all(lifted(hops, event) >= SHORTEST_FLIGHT for event in hops.named("touchdown"))

    def test_what_does_not_fly_touches_again(self, hops):
        assert hops.named(RETOUCH)
        for event in hops.named(RETOUCH):
            assert event.domain == CHATTER or lifted(hops, event) < SHORTEST_FLIGHT
            assert event.domain == CHATTER or event.impulse[0, 1] > 0.0, "it strikes all the same"
        assert {event.domain == CHATTER for event in hops.named(RETOUCH)} == {False, True}

    def test_time_in_the_air_is_that_of_the_flight(self, gait, stiff, hops):
        spans = durations(hops)
        begins = [0.0, *(event.time for event in hops.named("touchdown")[:-1])]
        for (stance, flight), begin, event in zip(spans, begins, hops.named("touchdown"), strict=True):
            assert flight == pytest.approx(lifted(hops, event), abs=1e-12)
            assert stance + flight == pytest.approx(event.time - begin, abs=1e-12)
        result = run(stiff, gait.state, HOPS, Options())
        assert [result.durations["stance"], result.durations["flight"]] == pytest.approx(spans[-1], abs=1e-12)

    def test_the_ledger_closes_over_re_touches(self, hops):
        assert len(hops.ledger.change) == HOPS
        assert np.abs(hops.ledger.residual).max() < 1e-8

    def test_every_touch_closes_a_cycle_where_none_is_too_short(self, gait, stiff, hops):
        counted = simulate(replace(stiff, shortest_flight=0.0), gait.state, HOPS)
        assert counted.cycles == HOPS and not counted.named(RETOUCH)
        assert len(counted.named("apex")) < HOPS
        touches = sorted(event.time for name in ("touchdown", RETOUCH) for event in hops.named(name))
        times = [event.time for event in counted.named("touchdown")]
        assert times == pytest.approx(touches[: len(times)], abs=1e-9), "the motion is the same"

    @pytest.mark.slow
    def test_a_robot_that_never_flies_long_enough(self, gait):
        """It rebounds for 48 ms again and again; time passes, so these events do not accumulate."""
        numbers = {"stiffness": 43.826, "damping": 1.531, "stance_torque": 7.3476, "friction": 0.8094}
        result = run(with_parameters(gait.system, numbers), gait.state, 50, Options(1e-8))
        assert result.reason == "no_cycle" and result.cycles < 50
        last = [event for event in result.events if event.time > result.event("touchdown").time]
        assert len(last) > 900 and sum(event.name == RETOUCH for event in last) > 200
        assert last[-1].time - last[0].time > 10.0

    @pytest.mark.slow
    def test_noise_makes_no_hops(self, gait):
        """Lost commands and noise have the toe touch again in one hop of this run."""
        rig = Rig(current_limit=8.0, sensing=Sensing(angle_noise=0.005, losses=5.0, seed=2))
        found = on_rig(gait, rig, 3, 1e-6, progress=False)
        assert found.complete and found.named(RETOUCH)
        assert len(found.named("apex")) == found.cycles


@compiles
class TestLanes:
    @pytest.mark.parametrize("n", [1, 64])
    def test_as_the_reference_engine(self, gait, n):
        rng = np.random.default_rng(0)
        drawn = {"stiffness": rng.uniform(75.0, 90.0, n), "stance_torque": rng.uniform(4.0, 9.0, n)}
        q, v = (np.tile(part, (n, 1)) for part in gait.state)
        found = simulate_many(gait.system, q, v, 2, parameters=drawn)
        few = {name: values[:8] for name, values in drawn.items()}
        assert_agree(
            gait.system, q[:8], v[:8], simulate_many(gait.system, q[:8], v[:8], 2, parameters=few), 2, 1e-7, few
        )
        assert_agree(gait.system, q[:8], v[:8], found, 2, 1e-7, few)


class TestRule:
    """Two toes; the first strikes, or both."""

    system = SimpleNamespace(robot=SimpleNamespace(toes=("left", "right")), shortest_flight=SHORTEST_FLIGHT)

    def test_a_flight_is_as_long_as_its_only_toe_is_aloft(self):
        one = SimpleNamespace(robot=SimpleNamespace(toes=("toe",)), shortest_flight=0.03, phase_limit=2.0)
        assert flight_times(one) == (0.03, 2.0)
        two = SimpleNamespace(robot=self.system.robot, shortest_flight=0.03, phase_limit=2.0)
        assert flight_times(two) == (0.0, 2.0)

    @pytest.mark.parametrize(
        ("impact", "aloft", "expected"),
        [
            ((), (0.0, 0.0), False),
            (("left",), (0.0, 1.0), True),
            (("left",), (0.0499, 1.0), True),
            (("left",), (0.05, 0.0), False),
            (("left",), (np.inf, 0.0), False),
            (("left", "right"), (0.001, 0.3), False),
            (("left", "right"), (0.001, 0.003), True),
        ],
    )
    def test_of_one_run_and_of_many(self, impact, aloft, expected):
        reset = Reset(impact=impact)
        assert bool(retouches(self.system, reset, np.array(aloft))) is expected
        many = retouches(self.system, reset, np.tile(np.array(aloft)[:, None], 64))
        assert np.shape(many) == ((64,) if impact else ()) and np.all(many == expected)


class TestTimeInTheAir:
    """Of a re-touch it counts to the phase that goes on, if no other toe bore meanwhile."""

    @pytest.mark.parametrize(
        ("domain", "event", "again", "phase"),
        [
            ("flight_1", "anterior_touchdown", False, "flight_1"),
            ("flight_1", "anterior_touchdown", True, "anterior_stance"),
            ("flight_1", "posterior_return", True, "posterior_stance"),
            ("anterior_stance", "posterior_touchdown", False, "anterior_stance"),
            ("anterior_stance", "posterior_touchdown", True, "anterior_stance"),
        ],
    )
    def test_counts_to(self, domain, event, again, phase):
        left = next(each for each in Gait.load("long_stride").system.domains if each.name == domain)
        reset = next(guard.reset for guard in left.guards if guard.name == event)
        assert counts_to(left, reset, again) == phase


class TestTime:
    @pytest.mark.parametrize("n", [1, 64])
    def test_events_of_an_instant(self, n):
        before, since = np.arange(n), np.where(np.arange(n) % 2, INSTANT, 0.5 * INSTANT)
        expected = [0 if i % 2 else i + 1 for i in range(n)]
        assert count_crowd(before, since).tolist() == expected
        assert [count_crowd(int(i), float(t)) for i, t in zip(before, since, strict=True)] == expected

    def test_creeping(self):
        assert creeps([i * 0.9 * INSTANT / (CREEP - 1) for i in range(CREEP)])
        assert not creeps([i * 1.1 * INSTANT / (CREEP - 1) for i in range(CREEP)]), "it goes on"
        assert not creeps([0.0] * (CREEP - 1)), "too few steps to tell"

    def test_too_many(self):
        counts = [(INSTANT_EVENTS - 1, CYCLE_EVENTS - 1), (INSTANT_EVENTS, CYCLE_EVENTS), (0, CYCLE_EVENTS)]
        assert [too_many(*count) for count in counts] == ["", "zeno", "no_cycle"]

    def test_crossings_in_one_instant_bound_no_cycle(self):
        assert whole(np.array([0.5 * INSTANT, INSTANT, 1.0])).tolist() == [False, True, True]
        assert [whole(seconds) for seconds in (0.5 * INSTANT, INSTANT)] == [False, True]

    def test_what_is_left_at_once(self, gait):
        guards = {guard.name: guard for guard in gait.system.of_phase("stance")[0].guards}
        assert left_at_once(guards["lift_off"], np.array([0.0, AT_ONCE, 2.0 * AT_ONCE])).tolist() == [True, True, False]
        assert not left_at_once(guards["slip"], 0.0) and not left_at_once(guards["fall:knee"], 0.0)

    def test_due(self, gait):
        law = SimpleNamespace(period=0.25)
        domain = replace(gait.system.domains[0], switch=Switch("beat", lambda n, p: n * p.period, Reset()))
        assert [due(domain, n, law, {}) for n in range(3)] == [0.25, 0.5, 0.75]
        assert due(replace(domain, switch=None), 0, law, {}) == np.inf
        domain, own = replace(domain, switch=Switch("beat", lambda n, p: n * p.frequency, Reset())), gait.system.law
        assert due(domain, 1, own, {ADDED + "frequency": 0.1}) == pytest.approx(2.0 * (own.frequency + 0.1))
