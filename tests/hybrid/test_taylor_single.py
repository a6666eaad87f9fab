"""The Taylor engine for one lane: its impact, and what it sees at a state."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, Gait, hopping, simulate_many
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.engines.taylor import Code, Ready
from spear_pin.hybrid.engines.taylor_single import AHEAD, UNCLEAR, Entry, Single
from spear_pin.hybrid.fields import flatten
from spear_pin.hybrid.lanes.compilation import compilation
from spear_pin.hybrid.lanes.groups import Group, alone, spread_held
from spear_pin.hybrid.lanes.modes import choose
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import FINEST, Options
from spear_pin.hybrid.rules.entry import NONE
from spear_pin.hybrid.rules.footing import LEAVES
from spear_pin.hybrid.rules.impact import plastic_impact
from spear_pin.hybrid.run import run

pytestmark = pytest.mark.extra("heyoka")


def systems(hop):
    yield hop, "stance", 0.3
    yield Gait.load("long_stride"), "posterior_stance", 0.05


def test_impact_is_rouths(hop):
    """Impacts that stick, slide on and slide back, and toes that rise."""
    rng, robot = np.random.default_rng(0), hop.system.robot
    strike = compilation(hop.system, Code(1e-12)).impact("toe")
    ways = set()
    for _ in range(400):
        friction = float(10.0 ** rng.uniform(-2.5, 0.5))
        numbers = Numbers(hop.system, {"friction": np.array([friction])}, Code(1e-12))
        q, v = hop.state[0] + 0.4 * rng.normal(size=3), 3.0 * rng.normal(size=3)
        expected = plastic_impact(robot.mass_matrix(q), robot.toe_jacobian(q, "toe"), v, friction)
        after = strike(np.concatenate([q, v]), np.array(numbers.constants(0)))
        assert (after is None) == (not expected.impulse.any())
        if after is not None:
            np.testing.assert_allclose(after[3:], expected.v, rtol=1e-11, atol=1e-11)
            np.testing.assert_array_equal(after[:3], q)
        ways.add((bool(expected.impulse.any()), expected.slides))
    assert len(ways) == 3


def test_chooses_as_for_many(hop):
    """A domain fits one lane where it is chosen for many, whatever the state."""
    rng = np.random.default_rng(1)
    chosen = {}
    for gait, phase, spread_of in systems(hop):
        system = gait.system
        numbers, local = Numbers(system, {}, Code(1e-12)), chart(system, gait.state)
        held = first_held(numbers, gait)
        for _ in range(60):
            q, v = local.state(spread_of * rng.normal(size=local.dimension))
            v = v + rng.choice([0.0, 0.3]) * rng.normal(size=len(v))
            y = np.concatenate([q, v])
            group = Group(np.array([0]), np.zeros(1), y[:, None], spread_held(held, 1))
            found, _ = choose(numbers, phase, group)
            parameters = np.array([*numbers.constants(0), *flat(held)])
            entries = {
                domain.name: single_of(numbers, domain, held).enter(0.0, y, parameters)
                for domain in system.of_phase(phase)
            }
            fitting = [(entry.fitness, -i, name) for i, (name, entry) in enumerate(entries.items()) if entry]
            fits = sorted(fitting)[-1:]
            assert [name for *_, name in fits] == [ready.domain.name for ready, _, _ in found]
            for fitness, _, name in fits:
                chosen[name, fitness == LEAVES] = chosen.get((name, fitness == LEAVES), 0) + 1
    assert len(chosen) >= 6, chosen


def test_a_step_ahead_is_exact(hop):
    """To rounding as the integrator's."""
    numbers = Numbers(hop.system, {}, Code(1e-15))
    held = first_held(numbers, hop)
    single = single_of(numbers, hop.system.domains[0], held)
    parameters, y = np.array([*numbers.constants(0), *flat(held)]), np.concatenate(hop.state)
    ahead = single.enter(0.0, y, parameters)  # the spring's guard is on zero
    assert isinstance(ahead, Entry) and ahead.t == AHEAD and ahead.event == NONE
    t, reached, end, _ = single.run(0.0, ahead.y, AHEAD, parameters)
    back = single.run(0.0, y, 2.0 * AHEAD, parameters)
    assert end == back[2] == taylor.TIME_LIMIT and t == AHEAD
    np.testing.assert_allclose(reached, back[1], rtol=0, atol=1e-13)


def test_a_motion_that_is_kept_is_the_same(hop):
    """Up to its event or a time, it ends alike; it is at any time where the integrator stops there."""
    numbers = Numbers(hop.system, {}, Code(1e-15))
    held = first_held(numbers, hop)
    single = single_of(numbers, hop.system.domains[0], held)
    parameters, y = np.array([*numbers.constants(0), *flat(held)]), np.concatenate(hop.state)
    begun = single.enter(0.0, y, parameters)
    for until in (0.05, 10.0):
        *end, motion = single.run(begun.t, begun.y, until, parameters, keep=True)
        expected = single.run(begun.t, begun.y, until, parameters)
        assert end[0] == pytest.approx(expected[0], abs=1e-15) and end[2] == expected[2]
        np.testing.assert_allclose(end[1], expected[1], rtol=0, atol=1e-12)
        np.testing.assert_allclose(motion(np.array([end[0]]))[:, 0], end[1], rtol=0, atol=1e-12)
    assert len(motion.begins) > 1 and motion.begins[0] == begun.t
    np.testing.assert_array_equal(motion(np.array([begun.t]))[:, 0], begun.y)
    for time in (begun.t + 1e-6, 0.01, motion.begins[1], 0.037, 0.05):
        t, reached, ended, _ = single.run(begun.t, begun.y, time, parameters)
        assert (t, ended) == (time, taylor.TIME_LIMIT)
        np.testing.assert_allclose(motion(np.array([time]))[:, 0], reached, rtol=0, atol=1e-12)


def test_a_motion_that_cannot_be_followed_fails(hop):
    numbers = Numbers(hop.system, {}, Code(1e-15))
    single = single_of(numbers, hop.system.domains[0], first_held(numbers, hop))
    parameters = np.array([*numbers.constants(0), *flat(first_held(numbers, hop))])
    *_, end, motion = single.run(0.0, np.full(6, np.nan), 0.05, parameters, keep=True)
    assert end == taylor.FAILED and not np.isfinite(motion(np.array([0.01]))).any()


@pytest.mark.parametrize("lanes", [1, 3])
def test_an_event_for_which_no_root_is_found_is_noticed(hop, lanes):
    """By rounding, heyoka may find none; the motion would go on through the ground."""
    numbers = Numbers(hop.system, {}, Code(1e-13 * lanes))  # of its own, as the events are taken away
    held, flight = first_held(numbers, hop), hop.system.of_phase("flight")[0]
    y = np.concatenate(hop.state) * np.array([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]) + np.array([0.05, 0.0, 0.0, 0.0, 0.0, 0.0])
    ready = numbers.compilation.domain(flight, held)
    (_, falling), first = ready.compiled._events[0], ready.compiled.state[0]
    ready.compiled._events = [(first * first + 1.0, falling)]  # which never happens
    parameters = np.array([*numbers.constants(0), *flat(held)])
    for until, end in ((0.05, taylor.TIME_LIMIT), (0.15, taylor.FAILED)):  # it falls for a tenth of a second
        if lanes == 1:
            single = single_of(numbers, flight, held)
            found = [single.run(0.0, y, until, parameters, keep=keep)[2] for keep in (False, True)]
        else:
            many = np.tile(parameters[:, None], lanes)
            found = ready.run(np.zeros(lanes), np.tile(y[:, None], lanes), np.full(lanes, until), many)[2]
        assert set(found) == {end}


def test_what_is_not_finite_is_unclear(hop):
    numbers = Numbers(hop.system, {}, Code(1e-12))
    held = first_held(numbers, hop)
    single = single_of(numbers, hop.system.domains[0], held)
    parameters = np.array([*numbers.constants(0), *flat(held)])
    assert single.enter(0.0, np.concatenate(hop.state), parameters).event == NONE
    assert single.enter(0.0, np.full(6, np.nan), parameters).event == UNCLEAR


def test_systems_of_equal_structure_share_what_is_compiled(hop):
    """So that a new number costs no new compilation."""
    held, functions = None, set()
    for torque in (8.0, 9.0):
        system = hop.with_law(stance_torque=torque).system
        numbers = Numbers(system, {}, Code(1e-12))
        held = held or first_held(numbers, hop)
        functions.add(id(single_of(numbers, system.domains[0], held)._function))
    assert len(functions) == 1


def first_held(numbers, gait):
    """What is held just behind the section."""
    flight, lands = gait.system.landing
    group = Group(np.array([0]), np.zeros(1), np.concatenate(gait.state)[:, None], {})
    flying = numbers.latch(group, gait.system.reset_into(flight), begins=False)
    return alone(numbers.latch(flying, lands, begins=True).held)


def single_of(numbers, domain, held):
    return numbers.compilation.single(domain, held)


def flat(held):
    return flatten(held.values())


def test_a_step_off_zero_just_before_lift_off(free_hop):
    """A toe begins to slide 3 µs before it lifts off; a step of the second order off that guard was seen 2e-10 off."""
    law = replace(free_hop.system.law, stance_torque=8.122048403796029)
    spring = replace(free_hop.system.spring, stiffness=50.71474303714905)
    system = hopping(free_hop.system.robot, law, spring, Contact(0.9674327699572879))
    q = np.array([0.0, 0.5616171748133175, 0.5966621832497461, 0.9481077271918436])
    v = np.array([0.3425360436345699, -0.7756434718099996, 2.3626645631764602, 5.591621713306942])
    found = simulate_many(system, q[None], v[None], 1, 1e-12)
    assert not found.repeated[0]
    exact = run(system, (q, v), 1, Options(FINEST)).state
    np.testing.assert_allclose(np.concatenate([found.q[0], found.v[0]]), np.concatenate(exact), rtol=0, atol=1e-11)


def test_a_lane_that_diverges_leaves_the_others(hop):
    """Its step has no length, and its time no value."""
    numbers = Numbers(hop.system, {}, Code(1e-15))
    held, n = first_held(numbers, hop), 4
    ready = numbers.compilation.domain(hop.system.domains[0], held)
    parameters = np.tile(np.array([*numbers.constants(0), *flat(held)])[:, None], n)
    y = np.tile(np.concatenate(hop.state)[:, None], n)
    y[3:, 2] = 1e200
    until = np.array([0.05, 0.06, 0.02, 10.0])
    t, reached, ends = ready.run(np.zeros(n), y, until, parameters)
    alone = [ready.run(np.zeros(1), y[:, [i]], until[[i]], parameters[:, [i]]) for i in (0, 1, 3)]
    assert ends[2] == taylor.FAILED and np.isfinite(t).all()
    for i, one in zip((0, 1, 3), alone, strict=True):
        assert (t[i], ends[i]) == (one[0][0], one[2][0])
        np.testing.assert_array_equal(reached[:, i], one[1][:, 0])


@pytest.mark.parametrize("n", [1, 12])
def test_what_is_observed_goes_on_below_zero(hop, n, monkeypatch):
    """The arc after an apex begins where its guard is on zero, and falls."""
    ends, run_one, run_many = [], Single.run, Ready.run

    def one(self, *given, **named):
        found = run_one(self, *given, **named)
        ends.append(found[2])
        return found

    def many(self, *given):
        found = run_many(self, *given)
        ends.extend(found[2].tolist())
        return found

    monkeypatch.setattr(Single, "run", one)
    monkeypatch.setattr(Ready, "run", many)
    batch = simulate_many(hop.system, *(np.tile(part, (n, 1)) for part in hop.state), 2, observe=True)
    assert ends and taylor.FAILED not in ends and not batch.repeated.any()
