"""Actuators: the power balance, the limits of voltage, current and heat, the current loop, against closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from spear_pin.errors import BadValue
from spear_pin.model.actuator import CREEP, FOLD, Actuator, Thermal
from spear_pin.model.bridge import Battery
from spear_pin.model.motor import Drive, Gearbox, Motor, find_passed_on, find_passed_on_creeping

R, L = 0.5, 1e-3
MOTOR = Motor("any", torque_constant=0.1, resistance=R, inductance=L)
HUGE = 1e6  # N·m, more than anything gives


def actuator(**changes):
    """10:1 on 24 V: N kt = 1 N·m/A, no-load 24 rad/s, 48 A at stall."""
    return replace(Actuator(MOTOR, Gearbox(10.0, 0.8)), **changes)


def at(current=0.0, square=0.0):
    return {"current": current, "square": square}


def follow(one, torque, speed, times):
    """The states over time at a constant command and speed, from zero."""

    def slopes(t, y):
        found = one.slopes(torque, speed, dict(zip(one.states, y, strict=True)))
        return [found[name] for name in one.states]

    longest = times[-1] / 200
    start = [0.0] * len(one.states)
    answer = solve_ivp(slopes, (0.0, times[-1]), start, "DOP853", times, max_step=longest, rtol=1e-10, atol=1e-12)
    return dict(zip(one.states, answer.y, strict=True))


motors = st.builds(
    lambda kt, ohm, henry: Motor("any", torque_constant=kt, resistance=ohm, inductance=henry),
    st.floats(0.01, 0.5),
    st.floats(0.05, 5.0),
    st.floats(1e-5, 1e-2),
)
actuators = st.builds(
    lambda motor, n, eta, v, r, limit, bandwidth, share, tau: Actuator(
        motor,
        Gearbox(n, eta),
        Battery(v, r),
        limit,
        bandwidth,
        Thermal(share * limit, tau) if share and limit < math.inf else None,
    ),
    motors,
    st.floats(1.0, 120.0),
    st.floats(0.5, 1.0),
    st.floats(6.0, 100.0),
    st.sampled_from([0.0, 1e-9, 1e-4]) | st.floats(0.0, 2.0),
    st.just(math.inf) | st.floats(0.5, 200.0),
    st.none() | st.floats(10.0, 2000.0),
    st.none() | st.floats(0.2, 2.0),
    st.floats(0.1, 20.0),
)
shares = st.floats(-2.0, 2.0)
many = settings(max_examples=400, derandomize=True, deadline=None)


def scaled(one, torque, speed, current, heat):
    """Torque, speed and states as shares of stall, of no load and of what can be borne."""
    volts = one.battery.voltage
    total = one.motor.resistance + one.battery.resistance
    everything = {"current": current * volts / total, "square": heat}
    x = {name: everything[name] for name in one.states}
    return torque * one.constant * volts / total, speed * volts / one.constant, x


@pytest.mark.slow
@many
@given(actuators, shares, shares, shares, st.floats(0.0, 1e4))
def test_the_batterys_power_is_accounted_for(one, torque, speed, current, heat):
    torque, speed, x = scaled(one, torque, speed, current, heat)
    amperes = one.current(torque, speed, x)
    slope = one.slopes(torque, speed, x).get("current", 0.0)
    power = one.power(amperes, speed, slope)
    assert power.joule >= 0.0 and power.gearbox >= 0.0
    parts = (power.joule, power.gearbox, power.joint, power.stored)
    scale = sum(map(abs, parts)) + abs(power.battery)
    assert power.battery == pytest.approx(sum(parts), rel=0, abs=1e-12 * scale + 1e-200)
    # each by itself
    volts, inside = one.battery.voltage, one.battery.resistance
    emf = one.constant * speed
    drawn = power.battery / volts
    terminal = one.motor.resistance * amperes + emf + one.motor.inductance * slope
    assert (volts - inside * drawn) * drawn == pytest.approx(terminal * amperes, rel=0, abs=1e-11 * scale + 1e-200)
    assert drawn * inside <= 0.5 * volts * (1.0 + 1e-12)
    assert power.joint == one.torque(amperes, speed) * speed
    assert power.joule == pytest.approx(one.motor.resistance * amperes**2 + inside * drawn**2, rel=1e-12, abs=1e-200)
    # the bridge makes no more than the battery has
    assert abs(terminal + inside * amperes) <= volts * (1.0 + 1e-9)


@pytest.mark.slow
@many
@given(actuators, shares, shares, st.floats(0.0, 1e4))
def test_the_loops_steady_state_is_the_quasi_static_current(one, torque, speed, heat):
    one = replace(one, bandwidth=100.0)
    torque, speed, x = scaled(one, torque, speed, 0.0, heat)
    quasi_static = replace(one, bandwidth=None)
    assert one.current(torque, speed, x) == 0.0  # it remembers
    amperes = quasi_static.current(torque, speed, {"square": heat})
    steepest = (one.battery.voltage + abs(one.constant * speed)) / one.motor.inductance
    slope = one.slopes(torque, speed, x | {"current": amperes})["current"]
    assert slope == pytest.approx(0.0, abs=1e-12 * steepest)
    for off in (1.0, -1.0):  # to which it returns from either side
        away = x | {"current": amperes + off}
        assert off * one.slopes(torque, speed, away)["current"] < 0.0


@pytest.mark.slow
@many
@given(actuators, shares, st.floats(-50.0, 50.0))
def test_torque_and_greatest_torque_are_those_of_the_drive(one, share, amperes):
    one = replace(one, bandwidth=None, thermal=None, battery=Battery(one.battery.voltage))
    limit = one.current_limit if one.current_limit < math.inf else None
    drive = Drive(one.motor, one.gearbox, one.battery.voltage, limit)
    speed = share * drive.no_load_speed
    if abs(speed) < 20 * CREEP:  # where the one jumps and the other creeps
        speed = math.copysign(20 * CREEP, speed)
    assert one.torque(amperes, speed) == pytest.approx(drive.torque(amperes, speed), rel=1e-12)
    greatest = one.torque(one.current(HUGE * one.constant, speed, {}), speed)
    expected = drive.envelope(speed)
    if speed < 0:  # where the back-EMF may force more than the limit
        expected = max(expected, -drive.envelope(-speed))
    assert greatest == pytest.approx(expected, rel=1e-9, abs=1e-9 * one.constant)
    if limit is None or speed >= -drive.no_load_speed:
        assert expected == drive.envelope(speed)
    other = one.torque(one.current(-HUGE * one.constant, -speed, {}), -speed)
    assert other == pytest.approx(-greatest, rel=1e-12)


class TestByHand:
    def test_the_gears_take_their_share_either_way(self):
        assert [actuator().torque(i, w) for i, w in ((10, 1), (-10, -1), (6.4, -1), (-6.4, 1), (10, 0))] == (
            pytest.approx([8.0, -8.0, 8.0, -8.0, 10.0])
        )

    def test_at_rest_and_creeping(self):
        """A drive at rest counts as driven; creeping gears pass on all at rest, and what a drive does beyond."""
        efforts, speeds = np.array([10.0, -10.0, 10.0, -10.0]), np.array([1.0, -1.0, -1.0, 1.0])
        np.testing.assert_allclose(find_passed_on(0.8, efforts, 0.0), 0.8)
        np.testing.assert_allclose(find_passed_on(0.8, efforts, speeds), [0.8, 0.8, 1.25, 1.25], rtol=1e-12)
        creeping = [find_passed_on_creeping(0.8, *each, CREEP) for each in zip(efforts, speeds, strict=True)]
        np.testing.assert_allclose(creeping, [0.8, 0.8, 1.25, 1.25], rtol=1e-12)
        assert [find_passed_on_creeping(0.8, effort, 0.0, CREEP) for effort in efforts] == [1.0] * 4
        assert find_passed_on_creeping(0.8, 10.0, CREEP, CREEP) == pytest.approx(0.8 ** np.tanh(1.0))

    def test_one_constant_for_both(self):
        assert actuator().constant == Drive(MOTOR, Gearbox(10.0, 0.8), 24.0).constant == pytest.approx(1.0)

    def test_the_reference_does_not_know_of_the_losses(self):
        assert actuator().reference(3.0) == pytest.approx(3.0)
        assert replace(actuator(), gearbox=Gearbox(20.0, 0.8)).reference(3.0) == pytest.approx(1.5)

    def test_below_the_limits_the_current_follows(self):
        assert actuator().current(5.0, 20.0, {}) == pytest.approx(5.0)
        assert actuator().current(-40.0, 12.0, {}) == pytest.approx(-40.0)

    def test_voltage_and_current_limits(self):
        assert actuator().current(HUGE, 12.0, {}) == pytest.approx((24 - 12) / R)
        assert actuator().current(HUGE, -12.0, {}) == pytest.approx((24 + 12) / R)
        assert actuator(battery=Battery(24.0, 0.1)).current(-HUGE, -12.0, {}) == pytest.approx(-(24 - 12) / 0.6)
        assert actuator(current_limit=7.0).current(HUGE, 12.0, {}) == 7.0
        assert actuator(current_limit=7.0).current(-HUGE, 12.0, {}) == -7.0
        assert actuator().current(5.0, 25.0, {}) == pytest.approx(-1.0 / R)  # above no load it must brake
        assert actuator(current_limit=0.5).current(5.0, 25.0, {}) == pytest.approx(-1.0 / R)  # whatever the limit

    def test_the_power_of_a_full_bridge_is_that_of_a_circuit(self):
        one = actuator(battery=Battery(24.0, 0.1))
        current = one.current(HUGE, 12.0, {})
        power = one.power(current, 12.0)
        assert current == pytest.approx(20.0)
        assert (power.battery, power.joule, power.joint) == pytest.approx((24 * 20, 0.6 * 400, 0.8 * 20 * 12))
        assert (power.gearbox, power.stored) == pytest.approx((0.2 * 20 * 12, 0.0))

    def test_braking_charges_the_battery(self):
        power = actuator().power(-10.0, 20.0)
        assert power.battery == pytest.approx(R * 100 - 10 * 20)
        assert (power.joint, power.gearbox) == pytest.approx((-12.5 * 20, 250 - 200))
        inside = actuator(battery=Battery(24.0, 0.1)).power(-10.0, 20.0)
        charging = -inside.battery / 24.0
        assert (24.0 + 0.1 * charging) * charging == pytest.approx(150.0)
        assert 0.0 < charging < 150.0 / 24.0

    def test_a_small_resistance_of_the_battery_matters_little(self):
        ideal = actuator().power(10.0, 5.0).battery
        for resistance in (1e-6, 1e-9, 1e-12, 1e-15):
            drawn = actuator(battery=Battery(24.0, resistance)).power(10.0, 5.0).battery
            assert drawn - ideal == pytest.approx(resistance * (ideal / 24) ** 2, rel=1e-3, abs=1e-12)
        assert actuator(battery=Battery(1e6, 0.3)).power(10.0, 5.0).battery == pytest.approx(ideal, rel=1e-9)

    def test_what_has_a_memory(self):
        thermal = Thermal(4.0, 1.0)
        assert actuator().states == ()
        assert actuator(bandwidth=100.0).states == ("current",)
        assert actuator(thermal=thermal, current_limit=8.0).states == ("square",)
        both = actuator(bandwidth=100.0, thermal=thermal, current_limit=8.0)
        assert both.states == ("current", "square")
        assert both.slopes(1.0, 0.0, at(2.0, 1.0))["square"] == pytest.approx(4.0 - 1.0)
        assert both.stored(at(3.0)) == pytest.approx(0.5 * L * 9)
        assert actuator().stored({}) == 0.0


class TestCurrentLoop:
    def test_it_is_of_first_order_where_the_voltage_suffices(self):
        times = np.linspace(0.0, 0.01, 41)
        current = follow(actuator(bandwidth=100.0), 3.0, 8.0, times)["current"]
        np.testing.assert_allclose(current, 3.0 * (1.0 - np.exp(-2 * np.pi * 100.0 * times)), atol=1e-8)

    @pytest.mark.parametrize("side", [1.0, -1.0])
    def test_else_the_winding_sets_the_pace(self, side):
        one, speed = actuator(bandwidth=2000.0, battery=Battery(24.0, 0.1)), side * 18.0
        times = np.linspace(0.0, 0.01, 41)
        current = side * follow(one, side * 20.0, speed, times)["current"]
        np.testing.assert_allclose(current, (24 - 18) / 0.6 * (1.0 - np.exp(-0.6 / L * times)), atol=1e-6)

    def test_it_is_slew_limited_and_then_first_order(self):
        one = actuator(bandwidth=1000.0)
        times = np.linspace(0.0, 0.004, 401)
        current = follow(one, 20.0, 4.0, times)["current"]
        slopes = [one.slopes(20.0, 4.0, at(i))["current"] for i in current]
        free = 2 * np.pi * 1000.0 * (20.0 - current)
        greatest = (24 - R * current - 4.0) / L
        np.testing.assert_allclose(slopes, np.minimum(free, greatest), rtol=1e-12)
        assert (free > greatest)[:50].all() and (free < greatest)[-50:].all()
        assert current[-1] == pytest.approx(20.0, rel=1e-5) and (np.diff(current) > 0).all()

    def test_the_loop_knows_the_amplifiers_limit(self):
        end = follow(actuator(bandwidth=500.0, current_limit=5.0), 20.0, 2.0, np.array([0.0, 0.02]))["current"][-1]
        assert end == pytest.approx(5.0, rel=1e-6)

    def test_above_no_load_it_brakes_in_the_end(self):
        times = np.array([0.0, 0.05])
        assert follow(actuator(bandwidth=500.0), 5.0, 27.0, times)["current"][-1] == pytest.approx(-3.0 / R)


class TestThermal:
    PEAK, CONTINUOUS, TAU = 10.0, 4.0, 2.0

    def protected(self, **changes):
        return actuator(current_limit=self.PEAK, thermal=Thermal(self.CONTINUOUS, self.TAU), **changes)

    def limit(self, square):
        limits = [self.protected().current(side * HUGE, 0.0, {"square": square}) for side in (1.0, -1.0)]
        assert limits[0] == -limits[1]
        return limits[0]

    def test_the_mean_square_relaxes(self):
        times = np.linspace(0.0, 8.0, 41)
        square = follow(self.protected(), 3.0, 0.0, times)["square"]
        np.testing.assert_allclose(square, 9.0 * (1.0 - np.exp(-times / self.TAU)), atol=1e-7)

    def test_the_peak_is_had_as_long_as_there_is_something_to_spare(self):
        full = (1.0 - FOLD) * self.CONTINUOUS**2
        lasts = -self.TAU * math.log(1.0 - full / self.PEAK**2)
        times = np.linspace(0.0, 20 * self.TAU, 4001)
        one = self.protected()
        square = follow(one, HUGE, 0.0, times)["square"]
        current = np.array([one.current(HUGE, 0.0, {"square": s}) for s in square])
        peak = times < lasts - 1e-3
        assert peak.sum() > 20 and (current[peak] == self.PEAK).all()
        assert (current[times > lasts + 1e-2] < self.PEAK).all()
        assert (np.diff(current) <= 1e-9).all()  # of the integration
        assert current[-1] == pytest.approx(self.CONTINUOUS, rel=1e-3)
        assert square.max() <= self.CONTINUOUS**2 * (1 + 1e-9)

    def test_the_limit_folds_from_peak_to_continuous_and_no_further(self):
        squares = np.linspace(0.0, 4 * self.CONTINUOUS**2, 1001)
        limits = np.array([self.limit(square) for square in squares])
        assert limits[0] == self.PEAK and limits[-1] == self.CONTINUOUS
        assert limits.min() == self.CONTINUOUS and limits.max() == self.PEAK
        assert (np.diff(limits) <= 0).all()
        assert self.limit((1 - FOLD) * 16.0) == pytest.approx(self.PEAK)
        assert self.limit((1 - FOLD / 2) * 16.0) == pytest.approx(7.0)
        assert self.limit(16.0) == self.limit(1e9) == self.CONTINUOUS

    def test_it_acts_on_a_loop_too(self):
        hot = at(square=2 * self.CONTINUOUS**2)
        assert self.protected(bandwidth=100.0).slopes(HUGE, 0.0, hot)["current"] == pytest.approx(200 * np.pi * 4.0)

    def test_an_amplifier_below_the_continuous_current_needs_none(self):
        weak = replace(self.protected(), current_limit=3.0)
        assert weak.current(HUGE, 0.0, {"square": 1e9}) == 3.0


class TestErrors:
    @pytest.mark.parametrize("value", [0.0, -1.0, math.nan, -math.inf, "x"])
    @pytest.mark.parametrize(
        ("make", "name"),
        [
            (lambda x: actuator(current_limit=x), "Actuator.current_limit"),
            (lambda x: actuator(bandwidth=x), "Actuator.bandwidth"),
            (lambda x: Thermal(x, 1.0), "Thermal.continuous"),
            (lambda x: Thermal(4.0, x), "Thermal.time_constant"),
        ],
    )
    def test_values(self, make, name, value):
        with pytest.raises(BadValue, match=name):
            make(value)

    def test_protection_needs_a_limit(self):
        with pytest.raises(BadValue, match="Actuator.current_limit.*finite"):
            actuator(thermal=Thermal(4.0, 1.0))

    @pytest.mark.parametrize("quantity", ["torque_constant", "resistance", "inductance"])
    def test_what_is_unknown_is_asked_for(self, quantity):
        unknown = replace(MOTOR, **{quantity: None})
        with pytest.raises(BadValue, match=f"{quantity} of any is None"):
            actuator(motor=unknown, bandwidth=100.0)
        if quantity == "inductance":
            assert actuator(motor=unknown).power(1.0, 1.0).stored == 0.0  # without a loop it is not needed


@many
@given(st.floats(-20.0, 20.0), st.floats(-0.3, 0.3), st.floats(0.5, 1.0))
def test_gears_never_give_power_away(amperes, speed, efficiency):
    """Nor where they creep."""
    one = replace(actuator(), gearbox=Gearbox(10.0, efficiency))
    assert one.power(amperes, speed).gearbox >= -1e-15
    assert abs(one.torque(amperes, speed)) <= abs(one.constant * amperes) / efficiency * (1 + 1e-12)
