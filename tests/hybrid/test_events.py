"""Events found exactly: free fall in closed form, guards of time alone, ties, starts on a guard, grazing."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, HoppingLaw, Spring, hopping, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Guard, Reset
from spear_pin.hybrid.events import Watch
from spear_pin.model.loading import load

GRAVITY = 9.81
ROBOT = load("spear_ii", locked=["boom_x"])
SHAPE = (0.4, 0.9)
LAST = 0.3  # s: when the run of a `falling` system ends
LIMP = HoppingLaw(stance_torque=0.0, hip_gain=0.0, hip_damping=0.0, knee_gain=0.0, knee_damping=0.0)


def at_height(height, rise=0.0, shape=SHAPE):
    """A state in which the toe is so high and everything rises at this speed, the joints at rest."""
    q = np.array([0.0, *shape])
    q[0] = height - ROBOT.toe_position(q, "toe")[1]
    return q, np.array([rise, 0.0, 0.0])


def falling(*guards):
    """A system in which the limp robot falls through the floor, with these guards, each a function of time alone."""

    def begin(q, v, held, p):
        return {"passed": 0.0, "passed_too": 0.0}

    end = Guard("end", lambda t, *_: LAST - t, Reset(latch=begin, phase="fall"))
    domain = Domain("fall", "fall", (OPEN,), lambda *_: (0.0, 0.0), guards=(*guards, end))
    return HybridSystem(
        kind="falling",
        robot=ROBOT,
        law=LIMP,
        springs={"knee": Spring()},
        contact=Contact(),
        domains=(domain,),
        section="end",
        cyclic=(),
        build=falling,
        guess=lambda: at_height(1.0),
    )


def fall(system, state=None, **options):
    trajectory = simulate(system, state or at_height(1.0), progress=False, **options)
    assert trajectory.reason == "complete", trajectory.message
    return trajectory


def times(trajectory, name):
    return [event.time for event in trajectory.named(name)]


def watched(value):
    """When a function of time is seen to fall through zero."""
    return times(fall(falling(Guard("seen", lambda t, *_: value(t)))), "seen")


def once(value, name="once", flag="passed"):
    """An event when a function of time falls through zero for the first time."""
    passed = Reset(latch=lambda *_: {flag: 9.0})
    return Guard(name, lambda t, q, v, held, *_: value(t) + held[flag], passed)


def test_a_fall_is_seen_that_another_event_a_moment_later_hides(monkeypatch):
    monkeypatch.setattr("spear_pin.hybrid.events.may_be_quick", lambda *_: False)  # as if it followed the motion
    fell = Guard("seen", lambda t, *_: 1.0 - 2.0 * math.exp(-(((t - 0.1) / 1e-5) ** 2)))  # below zero for 17 µs
    run = fall(falling(fell, once(lambda t: 0.1 - t)))
    assert times(run, "seen") == pytest.approx([0.1 - 1e-5 * math.sqrt(math.log(2.0))], abs=1e-12)
    assert times(run, "once") == pytest.approx([0.1], abs=1e-12)


class TestBetweenSteps:
    """A guard is looked at halfway through a step, there only by an estimate of the state."""

    STATE = at_height(1.0)[0], np.array([1.0, 25.0, -40.0])  # legs that whirl

    @pytest.fixture
    def steps(self, monkeypatch):
        """Of each step the toe's height halfway: estimated, and on the integrator's own interpolant."""
        found, step = [], Watch.step

        def spied(watch, ends, states, slopes, interpolate):
            (t0, t1), (y0, y1), (f0, f1) = ends, states, slopes
            estimate = 0.5 * (y0 + y1) + (t1 - t0) / 8.0 * (f0 - f1)
            middle = interpolate()(0.5 * (t0 + t1))
            found.append([ROBOT.toe_position(y[:3], "toe")[1] for y in (estimate, middle)])
            return step(watch, ends, states, slopes, interpolate)

        monkeypatch.setattr(Watch, "step", spied)
        fall(falling(), self.STATE, rtol=1e-6)
        monkeypatch.undo()
        return found

    def test_where_the_estimate_is_on_the_wrong_side(self, steps):
        seen = 0
        assert min(abs(estimate - middle) for estimate, middle in steps) > 1e-6
        for estimate, middle in steps:
            level = 0.5 * (estimate + middle)
            guard = Guard("passes", lambda t, q, v, held, p, dyn, ops, level=level: dyn.height("toe") - level)
            events = fall(falling(guard), self.STATE, rtol=1e-6).named("passes")
            seen += len(events)
            for event in events:
                assert ROBOT.toe_position(event.q, "toe")[1] == pytest.approx(level, rel=0, abs=1e-13)
        assert seen >= 10


class TestFreeFall:
    """The limp robot keeps its shape in the air, so its toe moves on a parabola."""

    @pytest.mark.parametrize(("height", "rise"), [(0.05, 0.0), (0.2, -1.3), (0.01, 0.8), (1e-4, 2.0), (1.5, 3.0)])
    @pytest.mark.parametrize("rtol", [1e-4, 1e-9])
    def test_touchdown_and_apex(self, height, rise, rtol):
        trajectory = simulate(hopping(ROBOT, LIMP), at_height(height, rise), rtol=rtol, progress=False)
        touchdown = trajectory.named("touchdown")[0]
        expected = (rise + math.sqrt(rise**2 + 2 * GRAVITY * height)) / GRAVITY
        assert touchdown.time == pytest.approx(expected, rel=0, abs=1e-12)
        assert ROBOT.toe_position(touchdown.q, "toe")[1] == pytest.approx(0.0, abs=1e-12)
        np.testing.assert_allclose(touchdown.q[1:], SHAPE, rtol=0, atol=1e-12)
        np.testing.assert_allclose(touchdown.v_before, [rise - GRAVITY * expected, 0, 0], rtol=0, atol=1e-11)
        if rise > 0.0:
            apex = trajectory.named("apex")[0]
            assert apex.time == pytest.approx(rise / GRAVITY, rel=0, abs=1e-12)
            assert apex.q[0] == pytest.approx(at_height(height)[0][0] + rise**2 / (2 * GRAVITY), rel=0, abs=1e-12)

    def test_touchdown_resets_at_the_event_and_nowhere_else(self):
        trajectory = simulate(hopping(ROBOT, LIMP), at_height(0.05), progress=False)
        touchdown = trajectory.named("touchdown")[0]
        in_the_air = trajectory.t < touchdown.time
        parabola = at_height(0.05)[0][0] - 0.5 * GRAVITY * trajectory.t[in_the_air] ** 2
        np.testing.assert_allclose(trajectory.q[in_the_air, 0], parabola, rtol=0, atol=1e-12)

    def test_the_knee_reaches_the_ground_in_closed_form(self):
        """With the foot folded above the knee the run ends there."""
        shape = (0.2, 2.6)
        knee_above_toe = -(ROBOT.toe_position([0, *shape], "toe")[1] - ROBOT.frame_position([0, *shape], "knee")[1])
        assert knee_above_toe < 0.0
        height = 0.3
        q, v = at_height(height - knee_above_toe, shape=shape)
        trajectory = simulate(hopping(ROBOT, LIMP), (q, v), progress=False)
        assert trajectory.reason == "fall" and trajectory.events[-1].name == "fall:knee"
        assert trajectory.t[-1] == pytest.approx(math.sqrt(2 * height / GRAVITY), rel=0, abs=1e-12)


class TestGuardsOfTime:
    @pytest.mark.parametrize("time", [1e-8, 1e-6, 1e-3, 0.0371, 0.05, 0.1, math.e / 10])
    def test_one_event(self, time):
        trajectory = fall(falling(once(lambda t: time - t)))
        assert times(trajectory, "once") == [pytest.approx(time, rel=1e-14, abs=1e-18)]

    def test_every_fall_of_an_oscillation_and_none_of_its_rises(self):
        rate = 60.0
        seen = watched(lambda t: math.cos(rate * t))
        expected = [(0.5 + 2 * k) * math.pi / rate for k in range(3)]
        np.testing.assert_allclose(seen, expected, rtol=0, atol=1e-14)

    @pytest.mark.parametrize("slope", [1e-6, 1.0, 1e6])
    def test_whatever_the_scale_of_the_guard(self, slope):
        np.testing.assert_allclose(watched(lambda t: slope * (0.123 - t)), [0.123], rtol=0, atol=1e-14)

    def test_an_inflection(self):
        assert watched(lambda t: (0.2 - t) ** 3) == pytest.approx([0.2], abs=1e-4)

    def test_a_jump(self):
        assert watched(lambda t: 1.0 if t < 0.1234 else -1.0) == pytest.approx([0.1234], abs=1e-14)

    @pytest.mark.parametrize("depth", [1e-4, 1e-7, 1e-10])
    @pytest.mark.parametrize("bottom", [0.03, 0.11, 0.1777, 0.23])
    def test_a_dip_within_a_step(self, depth, bottom):
        seen = watched(lambda t: (t - bottom) ** 2 * (1 + 2 * (t - bottom)) - depth)
        assert len(seen) == 1
        assert seen[0] == pytest.approx(bottom - math.sqrt(depth), rel=0, abs=20 * depth)

    @pytest.mark.parametrize("clearance", [1e-10, 1e-4])
    def test_no_event_where_a_dip_stays_above_zero(self, clearance):
        assert watched(lambda t: (t - 0.1777) ** 2 + clearance) == []


class TestTies:
    @staticmethod
    def guards(first, second):
        """Two events, each of which happens once."""
        return once(lambda t: first - t, "one"), once(lambda t: second - t, "two", "passed_too")

    def test_both_of_two_at_the_same_time(self):
        trajectory = fall(falling(*self.guards(0.1, 0.1)))
        assert [event.name for event in trajectory.events] == ["one", "two", "end"]
        assert times(trajectory, "one") == times(trajectory, "two") == pytest.approx([0.1], rel=1e-14)

    def test_the_order_of_the_guards_breaks_the_tie(self):
        trajectory = fall(falling(*reversed(self.guards(0.1, 0.1))))
        assert [event.name for event in trajectory.events] == ["two", "one", "end"]

    @pytest.mark.parametrize("gap", [1e-3, 1e-8])
    def test_the_earlier_of_two_comes_first(self, gap):
        trajectory = fall(falling(*self.guards(0.1 + gap, 0.1)))
        assert [event.name for event in trajectory.events] == ["two", "one", "end"]
        assert times(trajectory, "one")[0] - times(trajectory, "two")[0] == pytest.approx(gap, abs=1e-15)

    def test_two_that_only_record(self):
        record = [Guard(name, lambda t, *_: 0.1 - t) for name in ("a", "b")]
        trajectory = fall(falling(*record))
        assert times(trajectory, "a") == times(trajectory, "b") == pytest.approx([0.1], rel=1e-14)

    def test_both_sides_of_the_state_are_kept(self):
        trajectory = fall(falling(*self.guards(0.1, 0.1)))
        assert np.count_nonzero(trajectory.t == times(trajectory, "one")[0]) >= 2


class TestStartOnAGuard:
    @staticmethod
    def first(value):
        """When the event is first seen."""
        return next(iter(times(fall(falling(once(value))), "once")), None)

    def test_falling_from_zero_is_an_event_at_once(self):
        assert self.first(lambda t: -t) == 0.0

    def test_rising_from_zero_is_none(self):
        assert self.first(lambda t: t) is None

    def test_resting_on_zero_ends_a_phase_at_once(self):
        system = falling(Guard("rests", lambda t, *_: 0.0, ends="fall"))
        trajectory = simulate(system, at_height(1.0), progress=False)
        assert trajectory.reason == "fall" and times(trajectory, "rests") == [0.0]

    @pytest.mark.parametrize("value", [0.0, -1e-10])
    def test_resting_on_zero_within_a_phase_is_none(self, value):
        """As where the spring's joint is held at the latched angle: it would toggle for ever."""
        assert self.first(lambda t: value) is None

    @pytest.mark.parametrize("length", [1e-3, 2e-2, 0.2])
    def test_rising_from_zero_and_falling_back(self, length):
        assert self.first(lambda t: t * (length - t)) == pytest.approx(length, rel=1e-12)

    @pytest.mark.parametrize("begins", [0.0, -1e-9])
    @pytest.mark.parametrize("length", [1e-4, 1e-3, 2e-2, 0.2])
    def test_patience_ends_as_it_rises(self, length, begins):
        """A toe that bounces strikes where it comes back, however long a step is, and not where patience ends."""
        found = self.patient(lambda t: begins + 10.0 * t * (length - t))
        back = 0.5 * (length + math.sqrt(length**2 + 0.4 * begins))
        assert found == pytest.approx(back, rel=1e-9)

    def test_patience_where_it_never_rises(self):
        assert self.patient(lambda t: -0.01 * t) == pytest.approx(1e-4, rel=1e-9)

    @staticmethod
    def patient(value):
        """When a guard that waits, of the package, is an event: it is watched between steps, unlike a user's."""
        guard = once(lambda t: value(t))
        guard.value.__module__ = "spear_pin"
        return times(fall(falling(replace(guard, patience=1e-6))), "once")[0]

    def test_rising_from_just_below_zero_is_none(self):
        assert self.first(lambda t: t - 1e-10) is None

    def test_falling_from_just_above_zero_is_an_event_at_once(self):
        assert self.first(lambda t: 1e-10 - t) == pytest.approx(0.0, abs=1e-9)

    def test_below_its_tolerance_is_an_event_at_once_even_if_it_rises(self):
        assert self.first(lambda t: t - 1e-6) == 0.0


class TestStartOnTheGround:
    """The toe on the ground or within 10 nm of it."""

    @pytest.mark.parametrize("height", [0.0, 5e-9, -5e-9])
    def test_coming_down_touches_down_at_once(self, height):
        trajectory = simulate(hopping(ROBOT, LIMP), at_height(height, rise=-1.0), progress=False)
        assert trajectory.events[0].name == "touchdown"
        assert trajectory.events[0].time == pytest.approx(0.0, abs=1e-8)

    @pytest.mark.parametrize("height", [0.0, 5e-9, -5e-9])
    def test_going_up_flies(self, height):
        trajectory = simulate(hopping(ROBOT, LIMP), at_height(height, rise=1.0), progress=False)
        assert [event.name for event in trajectory.events[:2]] == ["apex", "touchdown"]
        assert trajectory.events[1].time == pytest.approx(2.0 / GRAVITY, rel=0, abs=1e-8)

    def test_at_rest_stands(self):
        trajectory = simulate(hopping(ROBOT, LIMP), at_height(0.0), progress=False)
        assert trajectory.phase[0] == "stance" and "touchdown" not in {e.name for e in trajectory.events[:1]}

    def test_below_the_ground_is_refused(self):
        with pytest.raises(BadValue, match="height of toe"):
            simulate(hopping(ROBOT, LIMP), at_height(-2e-8), progress=False)
