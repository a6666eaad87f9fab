"""Lanes in space end as the reference engine says, whether they are compiled or left to it."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.engines.taylor import Code
from spear_pin.hybrid.engines.taylor_single import UNCLEAR
from spear_pin.hybrid.fields import flatten
from spear_pin.hybrid.lanes import lone_runner, runner
from spear_pin.hybrid.lanes.groups import Group, spread_held
from spear_pin.hybrid.lanes.modes import find_sinking
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.rules.entry import NONE
from spear_pin.hybrid.run import run
from tests.hybrid.lanes import around, compiles, refuse_laps

VARIED = {
    "turn_9": [
        *(f"{pair}_{name}" for pair in LEGS for name in ("hip_torque", "knee_torque", "leg_touchdown", "stance_span")),
        *("flight_1_span", "flight_2_span", "knee_touchdown", "knee_rest", "epsilon", "virtual_stiffness"),
    ]
}
LANES, SPREAD = 3, (2e-4, 2e-3)  # the first lane is the gait itself; m and rad, m/s and rad/s


def pushed(gait):
    rng = np.random.default_rng(5)
    q, v = (np.tile(part, (LANES, 1)) for part in gait.state)
    for part, most in zip((q, v), SPREAD, strict=True):
        part[1:] += rng.uniform(-most, most, part[1:].shape)
    q[1:, 2] += 0.01  # no toe is below the ground, so these fly on first
    return q, v


@compiles
@pytest.mark.slow
@pytest.mark.parametrize(("name", "cycles"), [("trot", 1), ("pronk", 1), ("turn_9", 1), ("gallop", 1)])
def test_pushed(name, cycles):
    """Also where they differ in every number of the law of the plane, which is a part of the law in space."""
    gait = Gait.load(name)
    q, v = pushed(gait)
    numbers = {each: parameter(gait.system, each) * (1.0 + 1e-3 * np.arange(LANES)) for each in VARIED.get(name, ())}
    found = simulate_many(gait.system, q, v, cycles, parameters=numbers, unroll=False)
    for lane in range(LANES):
        own = with_parameters(gait.system, {each: float(values[lane]) for each, values in numbers.items()})
        expected = run(own, (q[lane], v[lane]), cycles, Options(1e-9))
        assert (found.reason[lane], found.cycles[lane]) == (expected.reason, expected.cycles)
        if expected.reason == "complete":
            off = np.abs(np.concatenate([found.q[lane] - expected.state[0], found.v[lane] - expected.state[1]])).max()
            assert off < 1e-7, (lane, off)
    assert not found.repeated[0]


@compiles
@pytest.mark.slow
def test_as_exact_as_asked_for():
    """No guard is so great, or so bent, that the steps follow it instead of the state."""
    gait = Gait.load("trot")
    found = simulate_many(gait.system, *(part[None] for part in gait.state))
    expected = run(gait.system, gait.state, 1, Options(1e-12)).state
    np.testing.assert_allclose(np.concatenate([found.q[0], found.v[0]]), np.concatenate(expected), rtol=0, atol=5e-12)


@compiles
@pytest.mark.slow
@pytest.mark.parametrize("alone", [True, False])
def test_a_toe_that_bounces_and_falls_at_once(monkeypatch, alone):
    """An impact of another toe leaves it on the ground and moving down; no step of the compiled code shows that."""
    if not alone:
        refuse_laps(monkeypatch)
    gait, rng = Gait.load("trot"), np.random.default_rng(0)
    local = chart(gait.system, gait.state)
    far = np.where(np.arange(500) % 3 == 0, 0.1, 0.02)
    q, v = [local.state(size * rng.normal(size=local.dimension)) for size in far][417]
    system = with_parameters(gait.system, {"friction": 1.1144459030615723})
    found = simulate_many(system, q[None], v[None], unroll=False)
    assert found.reason[0] == run(system, (q, v), 1, Options()).reason == "painleve"


@compiles
@pytest.mark.slow
def test_what_is_rare_is_left_to_the_reference_engine(monkeypatch):
    """A domain is compiled when it has been entered so often."""

    def noted(*given, **options):
        seen.append(given[1])
        return follow(*given, **options)

    follow, seen, counts, states = lone_runner.follow, [], [], []
    monkeypatch.setattr(lone_runner, "follow", noted)
    monkeypatch.setattr(runner, "RARE", 2)
    gait = Gait.load("trot")
    for _ in range(4):
        seen.clear()
        found = simulate_many(gait.system, *(part[None] for part in gait.state))
        counts.append(len(seen))
        states.append(np.concatenate([found.q[0], found.v[0]]))
        assert found.reason[0] == "complete" and not found.repeated[0]
    assert counts[0] > 5 and counts[-1] == 0
    np.testing.assert_allclose(states, states[-1:] * 4, rtol=0, atol=1e-10)


@compiles
@pytest.mark.slow
def test_lanes_left_to_the_reference_engine_end_as_compiled_ones(monkeypatch):
    """Also one that is lost; so does what is told of their cycles."""
    gait = Gait.load("trot")
    local, rng = chart(gait.system, gait.state), np.random.default_rng(3)
    states = [local.state(size * rng.normal(size=local.dimension)) for size in (0.0, 0.01, 0.02, 0.3)]
    q, v = (np.array(part) for part in zip(*states, strict=True))
    ends = []
    for rare in (8, 0):
        monkeypatch.setattr(runner, "RARE", rare)
        ends.append(simulate_many(replace(gait.system), q, v, 2, observe=True))
    one, other = ends
    assert one.reason.tolist() == other.reason.tolist() and len({*one.reason}) > 1
    assert one.cycles.tolist() == other.cycles.tolist() and one.repeated.tolist() == other.repeated.tolist()
    for name, seconds in one.durations.items():
        np.testing.assert_allclose(seconds, other.durations[name], rtol=0, atol=1e-9)
    whole = one.reason == "complete"
    np.testing.assert_allclose(one.q[whole], other.q[whole], rtol=0, atol=1e-9)
    np.testing.assert_allclose(one.v[whole], other.v[whole], rtol=0, atol=1e-9)


@compiles
@pytest.mark.slow
def test_a_toe_that_slides_for_less_than_a_microsecond_is_stopped(monkeypatch):
    """It lands on the edge of the friction cone, and its acceleration changes sign at once."""

    def noted(*given, **options):
        arc = follow(*given, **options)
        seen.append((arc.domain.name, arc.domain.guards[arc.end].name if arc.end >= 0 else "", arc.t))
        return arc

    follow, seen = lone_runner.follow, []
    monkeypatch.setattr(lone_runner, "follow", noted)
    gait = Gait.load("gallop")
    simulate_many(gait.system, *(part[1:2] for part in pushed(gait)), unroll=False)
    domain, end, after = seen[0]
    assert (domain, end) == ("anterior_left slip", "stick") and after < 2e-5


@compiles
@pytest.mark.slow
@pytest.mark.parametrize("name", ["trot", "turn_9"])
def test_side_by_side(name):
    """Lanes in the same domain share a register; each ends as it does alone."""
    gait = Gait.load(name)
    q, v = around(gait, 1e-4, 11)
    friction = np.linspace(0.78, 0.82, 11)
    together = simulate_many(gait.system, q, v, parameters={"friction": friction})
    assert (together.reason == "complete").all() and not together.repeated.any()
    for i in range(11):
        alone = simulate_many(gait.system, q[i : i + 1], v[i : i + 1], parameters={"friction": friction[i : i + 1]})
        np.testing.assert_allclose(together.q[i], alone.q[0], rtol=0, atol=1e-10)
        np.testing.assert_allclose(together.v[i], alone.v[0], rtol=0, atol=1e-10)
        assert together.orders[i] == alone.orders[0]


@cache
def bouncing():
    """The arc of a gallop in which one toe is off the ground for a moment, and the system."""
    gait = Gait.load("gallop")
    arcs = [each.arc for each in Orbit(gait.system, gait.state, ()).cycle.stretches]
    return next(arc for arc in arcs if arc.domain.name == "anterior_stance anterior_left open"), gait.system


@compiles
@pytest.mark.slow
@pytest.mark.parametrize(
    ("off", "rise", "event"), [(-1e-12, 1e-2, NONE), (-1e-12, 1e-6, UNCLEAR), (1e-12, -1e-2, UNCLEAR)]
)
def test_a_bouncing_toe_that_does_not_rise_is_left_to_the_reference_engine(off, rise, event):
    """It is an atom's breadth off the ground and falls before it has risen: no step shows that its sign changes."""
    arc, system = bouncing()
    robot = system.robot
    q, v = arc.y[: robot.nq], arc.y[robot.nq :]
    feet = [system.ground.foot(robot, q, toe) for toe in ("anterior_right_toe", "anterior_left_toe")]
    jacobian, speed = np.concatenate([own for _, own in feet]), np.array([0.0, 0.0, 0.0, 0.0, 0.0, rise])
    speed[3:5] = feet[1][1][:2] @ v
    height = off - feet[1][0]
    q, v = q + np.linalg.pinv(jacobian)[:, 5] * height, v + np.linalg.pinv(jacobian) @ (speed - jacobian @ v)
    numbers = Numbers(system, {}, Code(1e-12))
    parameters = np.array([*numbers.constants(0), *flatten(arc.held.values())])
    ready, y = numbers.compilation.single(arc.domain, arc.held), np.concatenate([q, v])
    assert ready.enter(arc.t, y, parameters).event == event
    held = spread_held(arc.held, 1)
    group = Group(np.zeros(1, np.int64), np.array([arc.t]), y[:, None], held)
    many = numbers.compiled(arc.domain, group)
    assert find_sinking(numbers, many, group, numbers.at(many, group)).tolist() == [event == UNCLEAR]


@compiles
@pytest.mark.slow
def test_an_impact_is_not_over_when_the_next_toe_lands(monkeypatch):
    """The first toe's impulse is still received as the second lands, for as long as the system says."""
    gait, seen = Gait.load("trot"), []

    def noted(system, domain, reset, q, v, overlap, now):
        seen.append((overlap.window, overlap.received(system.robot.toes, now)[:, 2].max()))
        return strike_toes(system, domain, reset, q, v, overlap, now)

    strike_toes = lone_runner.strike_toes
    monkeypatch.setattr(lone_runner, "strike_toes", noted)
    found = simulate_many(gait.system, *(part[None] for part in gait.state), unroll=False)
    assert found.cycles[0] == 1 and not found.repeated[0]
    assert [window for window, _ in seen] == len(seen) * [gait.system.overlap]
    assert seen[0][1] == 0.0 < seen[1][1]
