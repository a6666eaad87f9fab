"""Events that are over within a step of the integrator: thin curbs, slots, waves, pulses of time, double roots."""

import math

import numpy as np
import pytest

from spear_pin import hopping, load, simulate, simulate_many
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import Guard
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.events import may_be_quick
from spear_pin.hybrid.intervals import INTERVALS, Interval, Unsure, bounds
from tests.hybrid.quick_events import CASES, Curb, Waves, flying, start
from tests.slow import slow_but

SYMBOLIC = [name for name, make in CASES.items() if make().symbolic]


class TestEvents:
    @pytest.mark.parametrize("rtol", [1e-4, 1e-9])
    @pytest.mark.parametrize("name", CASES)
    def test_are_found_when_they_happen(self, name, rtol):
        case = CASES[name]()
        found = simulate(case.system, start(), rtol=rtol, progress=False)
        assert found.events[0].name == case.name
        assert found.events[0].time == pytest.approx(case.time, rel=0, abs=1e-12)

    @pytest.mark.extra("heyoka")
    @pytest.mark.parametrize("n", [1, 20])
    @pytest.mark.parametrize("name", slow_but(SYMBOLIC, "curb of 0.01 m", "bump", "smooth pulse of time"))
    def test_are_found_in_lanes(self, name, n):
        case = CASES[name]()
        q, v = (np.tile(part, (n, 1)) for part in start())
        found = simulate_many(case.system, q, v)
        assert not found.repeated.any()
        for message in found.message:
            assert f"({case.name} at t = {case.time:.6g} s)" in message

    def test_none_where_there_is_none(self):
        """A curb that the toe clears, and a pulse that stays above zero by little."""
        pulse = Guard("pulse", lambda t, q, v, held, p, dyn, ops: ops.maximum(t - 0.1, 0.1 - t) + 1e-8, ends="fall")
        found = simulate(flying(pulse, ground=Curb(rise=0.0)), start(), progress=False)
        assert [event.name for event in found.events] == ["end"]

    def test_each_fall_of_one_that_is_only_recorded(self):
        """Several within a step, each when it happens."""
        rate = 2000.0
        waves = Guard("crest", lambda t, q, v, held, p, dyn, ops: ops.cos(rate * t))
        found = [event.time for event in simulate(flying(waves), start(), progress=False).named("crest")]
        expected = (0.5 + 2.0 * np.arange(64)) * math.pi / rate
        np.testing.assert_allclose(found, expected[expected < 0.2], rtol=0, atol=1e-13)


class TestSteps:
    def test_are_as_many_for_guards_of_this_package(self):
        """None of which is looked at more closely."""
        system = hopping(load("spear_ii", locked=["boom_x"]))
        q, v = system.guess()
        for domain in system.domains:
            flow = Flow(system, domain, {"latched": 1.0, "taut": 1.0, "knee_touchdown": 1.0})
            y = np.concatenate([q, v, np.zeros(6)])
            assert not any(may_be_quick(flow, guard, 0.0, y) for guard in domain.guards[:1])

    @pytest.mark.parametrize("longest", [1e-2, 1e-3])
    def test_are_no_longer_than_is_said(self, longest):
        found = simulate(flying(), start(), max_step=longest, progress=False)
        assert found.evaluations > 12 * 0.2 / longest

    @pytest.mark.extra("heyoka")
    @pytest.mark.parametrize("n", [1, 20])
    def test_of_lanes_are_no_longer_than_is_said(self, n):
        q, v = (np.tile(part, (n, 1)) for part in start())
        ends = [simulate_many(flying(), q, v, max_step=longest).q for longest in (None, 1e-2, 1e-5)]
        np.testing.assert_allclose(ends[0], ends[1], rtol=0, atol=1e-12)
        np.testing.assert_allclose(ends[0], ends[2], rtol=0, atol=1e-10)

    @pytest.mark.parametrize("longest", [0.0, -1.0, math.nan, math.inf, "short", True, 1e-12])
    def test_of_no_length_are_refused(self, longest):
        with pytest.raises(BadValue, match="max_step"):
            simulate(flying(), start(), max_step=longest)


class TestIntervals:
    """What a function may be on an interval holds what it is at every point of it."""

    FUNCTIONS = (
        lambda x, ops: ops.sin(x) * ops.cos(2.0 * x) - x / 3.0,
        lambda x, ops: ops.exp(-(x**2)) + ops.tanh(x) - 1.0 / (2.0 + x * x),
        lambda x, ops: ops.sqrt(abs(x)) + ops.maximum(x, -0.5) - (x - 1.0) ** 3,
        lambda x, ops: ops.atan2(x, 2.0) + ops.tan(0.1 * x) + 2.0 ** -1 - +x,
        lambda x, ops: ops.solve([[2.0 + x * x, 1.0], [1.0, 3.0]], [x, 1.0])[0],
        lambda x, ops: x**-2 + x**0 + abs(-x) * 3.0,
    )  # fmt: skip

    @pytest.mark.parametrize("function", FUNCTIONS)
    def test_hold_all_values(self, function):
        rng = np.random.default_rng(1)
        for low, length in rng.uniform((-5.0, 1e-6), (5.0, 3.0), (200, 2)).tolist():
            high = low + length
            try:
                least, greatest = bounds(function(Interval(low, high), INTERVALS))
            except Unsure:
                continue
            values = [bounds(function(x, INTERVALS))[0] for x in np.linspace(low, high, 33).tolist() if x]
            assert least <= min(values) + 1e-12 and max(values) <= greatest + 1e-12

    def test_compare_where_the_answer_is_sure(self):
        some = Interval(1.0, 2.0)
        assert some < 3.0 and some > 0.5 and 0.5 < some and some <= 2.0 and some >= 1.0 and some != 3.0 and some
        assert max(some, 0.0) is some and not some < 1.0 and not some > 2.0
        for compare in (lambda: some < 1.5, lambda: some >= 1.5, lambda: some == 1.5, lambda: bool(some - 1.5)):
            with pytest.raises(Unsure):
                compare()

    def test_exponentials_too_large_for_a_number_begin_with_a_number(self):
        for low in (1.0, 701.0, 1e300):
            least, greatest = bounds(Interval(low, 1e301).exp())
            assert math.isfinite(least) and greatest == math.inf
        assert bounds(Interval(-math.inf, 0.0).exp()) == (0.0, 1.0)

    def test_are_those_of_arrays_too(self):
        row = np.array([Interval(1.0, 2.0), Interval(-1.0, 1.0)], dtype=object)
        assert bounds(row @ np.array([2.0, 3.0])) == (-1.0, 7.0)
        assert bounds(np.exp(row)[1]) == pytest.approx((math.exp(-1.0), math.e))
        assert bounds(row[0] * 2 - np.float64(1.0)) == (1.0, 3.0)

    def test_take_no_functions_of_floats(self):
        with pytest.raises(TypeError):
            math.sin(Interval(0.0, 1.0))


def test_waves_are_short(monkeypatch):
    """So that an engine that looks at both ends of a step, and halfway, does not see the first that is struck."""
    monkeypatch.setattr("spear_pin.hybrid.events.may_be_quick", lambda *_: False)
    case = CASES["waves"]()
    assert simulate(case.system, start(), progress=False).events[0].time > case.time + 1e-3
    assert Waves().size > 0.0
