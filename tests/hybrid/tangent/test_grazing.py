"""Events whose guards graze: derivatives grow as one by the rate, and are refused in the end; and events that meet."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.domain import Guard, Reset
from spear_pin.hybrid.parameters import change_system
from spear_pin.hybrid.tangent.resets import NotDifferentiable

pytestmark = pytest.mark.extra("heyoka")
AT = 0.1  # s after lift-off
BOOM_Z = 0


@dataclass(frozen=True)
class Gate:
    """A change: flight goes on as another phase once a guard has fallen through zero."""

    guard: Guard

    def __call__(self, system):
        (flight,) = system.of_phase("flight")
        late = replace(flight, name="late_flight", phase="late_flight")
        early = replace(flight, guards=(self.guard, *flight.guards))
        others = [early if domain is flight else domain for domain in system.domains]
        return replace(system, domains=(*others, late))


def slow(rate):
    """A guard that falls through zero with a rate at `AT`, where 1 % more of the frequency raises it by 0.01."""

    def value(t, q, v, held, p, dyn, ops):
        left = AT - t
        return left * left * left + rate * left + (p.frequency / 2.56 - 1.0)

    return Guard("gate", value, Reset(phase="late_flight"))


def ceiling(height):
    """The carriage rises to a height."""
    return Guard("gate", lambda t, q, v, held, p, dyn, ops: height - q[BOOM_Z], Reset(phase="late_flight"))


def gated(hop, guard, over=()):
    return Orbit(change_system(hop.system, Gate(guard)), hop.state, over)


@pytest.mark.parametrize("rate", [1e-1, 1e-4, 1e-7])
def test_the_time_of_an_event_by_what_moves_its_guard(hop, rate):
    orbit = gated(hop, slow(rate), ("frequency",))
    column = orbit.dimension
    # the flight begins later by `lift`, to which its clock is reset, so that only the frequency moves the guard
    assert orbit.cycle.durations["flight"].x == pytest.approx(AT, abs=1e-12)
    assert orbit.cycle.durations["flight"].d[column] == pytest.approx(1.0 / 2.56 / rate, rel=1e-6)
    assert orbit.cycle.steepness == pytest.approx(rate * AT / (AT**3 + rate * AT), rel=0.1)


@pytest.mark.parametrize("rate", [9e-9, 1e-11, 0.0])
def test_a_grazing_guard_is_refused_by_name(hop, rate):
    orbit = gated(hop, slow(rate))
    with pytest.raises(NotDifferentiable, match="gate grazes: its guard falls through zero with"):
        _ = orbit.cycle


def test_a_height_that_is_hardly_reached(hop):
    apex = gated(hop, ceiling(10.0)).measures["apex_height"]  # a ceiling that is never reached
    found = []
    for below in (1e-4, 1e-6, 1e-8):  # m
        orbit = gated(hop, ceiling(apex.value - below))
        duration = orbit.cycle.durations["flight"]
        (stretch,) = [each for each in orbit.cycle.stretches if each.arc.event.name == "gate"]
        speed = float(stretch.arc.after[orbit.system.robot.nv + BOOM_Z])
        found.append((duration.d * speed, speed))
    # it is reached later by as much as the apex is lower, by the speed there
    off = [np.abs(rate + apex.derivative).max() / np.abs(apex.derivative).max() for rate, _ in found]
    assert off[2] < 2e-3 and off[1] == pytest.approx(10.0 * off[2], rel=0.1)
    assert found[0][1] / found[2][1] == pytest.approx(1e2, rel=1e-2)  # the speed falls as the root of what is missing


@dataclass(frozen=True)
class Meeting:
    """A change: flight passes a height, and goes on as another phase at the same one, higher with the frequency.

    Attributes:
        height: of the carriage, in m.
    """

    height: float

    def __call__(self, system):
        def passes(t, q, v, held, p, dyn, ops):
            return held["passed"] + (1.0 - held["passed"]) * (self.height - q[BOOM_Z])

        def met(t, q, v, held, p, dyn, ops):
            above = self.height - q[BOOM_Z] + (p.frequency / 2.56 - 1.0)
            return held["passed"] * above + (1.0 - held["passed"])

        def lifting(guard):
            if guard.reset is None or guard.reset.phase != "flight":
                return guard
            before = guard.reset.latch or (lambda q, v, held, p: {})
            return replace(guard, reset=replace(guard.reset, latch=lambda *given: {**before(*given), "passed": 0.0}))

        passed = Guard("passed", passes, Reset(latch=lambda q, v, held, p: {"passed": 1.0}))
        lifted = [replace(each, guards=tuple(map(lifting, each.guards))) for each in system.domains]
        (flight,) = [each for each in lifted if each.phase == "flight"]
        early = replace(flight, guards=(passed, Guard("met", met, Reset(phase="late_flight")), *flight.guards))
        late = replace(flight, name="late_flight", phase="late_flight")
        return replace(system, domains=(*[early if each is flight else each for each in lifted], late))


def test_an_event_that_meets_another_has_a_time_of_its_own(hop):
    height = gated(hop, ceiling(10.0)).measures["apex_height"].value - 0.01  # m
    orbit = Orbit(change_system(hop.system, Meeting(height)), hop.state, ("frequency",))
    plain = gated(hop, ceiling(height), ("frequency",)).cycle.durations["flight"]
    (stretch,) = [each for each in orbit.cycle.stretches if each.arc.event.name == "passed"]
    speed = stretch.arc.after[orbit.system.robot.nv + BOOM_Z]
    later, column = orbit.cycle.durations["flight"].d - plain.d, orbit.dimension
    assert later[:column] == pytest.approx(0.0, abs=1e-9)  # what moves both alike
    assert later[column] == pytest.approx(1.0 / 2.56 / speed, rel=1e-9)
    assert "met" in orbit.cycle.borders
    assert frozenset({"passed", "met"}) in orbit.cycle.order
