"""Motors and drives against closed forms, and the catalogue against what it says of itself."""

from dataclasses import fields, replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.catalogue import (
    GEARBOXES,
    MOTORS,
    VERIFICATIONS,
    gearbox,
    mass_law,
    motor,
    scale_motor,
    size_motor,
)
from spear_pin.model.loading import load
from spear_pin.model.motor import UNITS, Drive, Gearbox, Motor, drawn_power

IDEAL = Motor("ideal", torque_constant=0.1, resistance=0.5, rotor_inertia=1e-4, nominal_torque=0.3)
NUMBERS = {(name, quantity): x for name, entry in {**MOTORS, **GEARBOXES}.items() for quantity, x in entry.items()}

# stall torques at the nominal voltage that go with the numbers of the catalogue, in N·m
STALL = {
    "ec_60_flat_100w_24v": (4.18, 0.01),
    "ec_90_flat_90w_24v": (4.67, 0.005),
    "ec_90_flat_90w_48v": (4.53, 0.005),
    "faulhaber_3863h024cr": (1.455, 0.03),
}


def drive(efficiency=0.8, limit=None, ratio=10.0, bus=24.0, **changes):
    """10:1 on 24 V: N kt = 1 N·m/A, no-load 24 rad/s, 48 A at stall."""
    return Drive(replace(IDEAL, **changes), Gearbox(ratio, efficiency), bus, limit)


class TestClosedForms:
    def test_the_260_w_motor_at_15_to_1(self):
        knee = Drive(motor("ec_90_flat_260w"), Gearbox(15.0, 0.83), bus=48.0)
        assert knee.no_load_speed == pytest.approx(48 / (15 * 0.231), rel=1e-12)
        assert knee.no_load_speed == pytest.approx(13.9, abs=0.05)
        assert replace(knee, gearbox=Gearbox(15.0)).stall_torque == pytest.approx(197, abs=0.5)
        assert knee.stall_torque == pytest.approx(0.83 * 15 * 0.231 * 48 / 0.844, rel=1e-12)
        assert knee.continuous_torque == pytest.approx(11.7, abs=0.05)
        assert knee.continuous_speed == pytest.approx((48 - 0.844 * 4.06) / (15 * 0.231), rel=1e-12)
        assert knee.reflected_inertia == pytest.approx(0.114, abs=5e-4)
        work = knee.continuous_torque * knee.continuous_speed / 0.83
        assert work == pytest.approx(181, abs=0.5)  # as docs/reference/motors.md has it, at 1843 rpm
        assert 15 * knee.continuous_speed * 30 / np.pi == pytest.approx(1843, abs=0.5)

    def test_the_example_of_the_source_is_at_the_joint(self):
        knee = Drive(motor("spear_ii_knee"), gearbox("spear_ii_knee_gear"), bus=24.0)
        assert knee.voltage(0.0, 20.0) == pytest.approx(34.5, rel=1e-12)
        assert knee.no_load_speed == pytest.approx(13.9, abs=0.05)

    def test_reflected_inertias(self):
        knee = Drive(motor("ec_60_flat_100w_24v"), Gearbox(15.0), bus=24.0)
        assert knee.reflected_inertia == pytest.approx(15**2 * 1210e-7, rel=1e-12)
        assert knee.reflected_inertia == pytest.approx(0.027, abs=5e-4)  # of Table 2.4
        geared = replace(knee, gearbox=Gearbox(15.0, inertia=17.6e-7))
        assert geared.reflected_inertia - knee.reflected_inertia == pytest.approx(225 * 17.6e-7, rel=1e-9)

    def test_the_rotor_of_the_knee_is_that_of_the_urdf(self):
        robot = load("spear_ii")
        row = robot.index("knee")
        assert motor("spear_ii_knee").rotor_inertia == pytest.approx(robot.model.rotorInertia[row], rel=1e-9)
        assert gearbox("spear_ii_knee_gear").ratio == robot.model.rotorGearRatio[row]

    @pytest.mark.parametrize("name", STALL)
    def test_stall_torques(self, name):
        stall, tolerance = STALL[name]
        one = motor(name)
        assert Drive(one, Gearbox(1.0), one.nominal_voltage).stall_torque == pytest.approx(stall, rel=tolerance)

    def test_the_gears_take_their_share_either_way(self):
        assert drive().current([8.0, -8.0, 8.0, -8.0, 8.0], [1.0, -1.0, -1.0, 1.0, 0.0]) == pytest.approx(
            [10.0, -10.0, 6.4, -6.4, 10.0]
        )

    def test_powers(self):
        geared = drive()
        assert geared.joule_power(8.0, 1.0) == pytest.approx(0.5 * 10**2)
        assert geared.bus_power(8.0, 1.0) == pytest.approx(50 + 10)  # 8 W at the joint from 10 W of the rotor
        assert geared.bus_power(8.0, -20.0) == pytest.approx(0.5 * 6.4**2 - 20 * 6.4)  # |i| R < |e|: it feeds
        assert drawn_power([5.0, -5.0, 0.0], 0.24) == pytest.approx([5.0, -1.2, 0.0])
        assert drawn_power(-5.0, 0.0) == 0.0 and drawn_power(-5.0, 1.0) == -5.0


class TestEnvelope:
    def test_the_line_without_a_limit(self):
        assert drive().envelope([0.0, 12.0, 24.0]) == pytest.approx([38.4, 19.2, 0.0])

    def test_braking_the_back_emf_helps(self):
        assert drive().envelope(-12.0) == pytest.approx((24 + 12) / 0.5 / 0.8)

    def test_a_current_limit_cuts_both(self):
        assert drive(limit=20.0).envelope([-12.0, 0.0, 12.0, 20.0]) == pytest.approx([25.0, 16.0, 16.0, 6.4])
        assert drive(limit=20.0).stall_torque == pytest.approx(16.0)

    def test_above_the_no_load_speed_it_must_brake(self):
        overrun = drive()
        assert overrun.envelope(25.0) == pytest.approx(-1 / 0.5 / 0.8)
        assert overrun.margin([0.0, -1.0, -2.5, -10.0], 25.0) == pytest.approx([-2.5, -1.5, 0.0, 7.5])

    def test_margins_by_quadrant(self):
        limits = drive().envelope([12.0, -12.0])
        torque, speed = np.array([10.0, -10.0, 10.0, -10.0]), np.array([12.0, -12.0, -12.0, 12.0])
        margins = drive().margin(torque, speed)
        assert margins == pytest.approx([*(limits[:1] - 10).repeat(2), *(limits[1:] - 10).repeat(2)])
        assert (margins > 0).all()
        assert drive().margin(20.0, 12.0) == pytest.approx(-0.8) and drive().margin(20.0, -12.0) > 0
        assert drive().margin(0.0, -12.0) == drive().margin(0.0, 12.0) == pytest.approx(19.2)

    def test_above_the_greatest_speed_nothing_goes(self):
        bounded = drive(max_speed=150.0)
        assert np.isneginf(bounded.margin([1.0, -1.0], [15.1, 15.1])).all()
        assert bounded.margin(1.0, 14.9) == drive().margin(1.0, 14.9)

    def test_the_worst_point(self):
        worst = drive().worst([1.0, 19.0, 30.0], [0.0, 12.0, -12.0])
        assert (worst.index, worst.torque, worst.speed) == (1, 19.0, 12.0)
        assert worst.margin == pytest.approx(0.2)

    def test_the_continuous_range(self):
        assert drive().continuous_torque == pytest.approx(10 * 0.8 * 0.3)
        assert drive(limit=2.0).continuous_torque == pytest.approx(1.6)
        weak = replace(drive(), gearbox=Gearbox(10.0, 0.8, max_torque=1.5))
        assert weak.continuous_torque == 1.5
        assert drive().continuous_speed == pytest.approx(24 - 0.5 * 3.0)
        assert drive().envelope(drive().continuous_speed) == pytest.approx(drive().continuous_torque)
        assert drive(bus=1.0).continuous_speed == 0.0
        by_current = drive(nominal_torque=None, nominal_current=4.0)
        assert by_current.continuous_torque == pytest.approx(10 * 0.8 * 0.4)

    def test_scalars_and_arrays(self):
        grid = np.linspace(-30, 30, 12).reshape(3, 4)
        for method in (drive().envelope, lambda w: drive().margin(2.0, w), lambda w: drive().bus_power(2.0, w)):
            values = method(grid)
            assert values.shape == (3, 4)
            assert values[1, 2] == method(float(grid[1, 2]))
            assert np.ndim(method(1.0)) == 0 and f"{method(1.0):.1f}"


drives = st.builds(
    lambda kt, r, n, eta, bus, limit: Drive(Motor("any", kt, r), Gearbox(n, eta), bus, limit),
    st.floats(0.01, 0.5),
    st.floats(0.05, 5.0),
    st.floats(1.0, 120.0),
    st.floats(0.5, 1.0),
    st.floats(6.0, 100.0),
    st.none() | st.floats(0.5, 200.0),
)
shares = st.floats(-2.0, 2.0)  # of the no-load speed
many = settings(max_examples=300, derandomize=True, deadline=None)


@many
@given(drives, shares)
def test_at_the_envelope_voltage_or_current_is_exhausted(any_drive, share):
    speed = share * any_drive.no_load_speed
    torque = any_drive.envelope(speed)
    voltage, current = any_drive.voltage(torque, speed), any_drive.current(torque, speed)
    slack = 1e-9 * any_drive.bus
    at_the_bus = abs(voltage - any_drive.bus) <= slack
    at_the_limit = any_drive.current_limit is not None and current == pytest.approx(any_drive.current_limit)
    assert at_the_bus or (at_the_limit and voltage < any_drive.bus)


@many
@given(drives, shares, st.floats(-3.0, 3.0))
def test_a_margin_is_positive_just_where_voltage_and_current_allow(any_drive, share, effort):
    speed = share * any_drive.no_load_speed
    torque = effort * any_drive.stall_torque
    voltage, current = any_drive.voltage(torque, speed), any_drive.current(torque, speed)
    margin = any_drive.margin(torque, speed)
    limit = np.inf if any_drive.current_limit is None else any_drive.current_limit
    room = min(any_drive.bus - abs(voltage), limit - abs(current))
    if abs(margin) > 1e-6 * any_drive.stall_torque and abs(room) > 1e-9 * any_drive.bus:
        assert (margin > 0) == (room > 0)


@many
@given(drives, shares, st.floats(-3.0, 3.0))
def test_electrical_power_is_heat_and_work(any_drive, share, effort):
    lossless = replace(any_drive, gearbox=Gearbox(any_drive.gearbox.ratio))
    speed, torque = share * lossless.no_load_speed, effort * lossless.stall_torque
    heat, power, work = lossless.joule_power(torque, speed), lossless.bus_power(torque, speed), torque * speed
    slack = 1e-9 * (heat + abs(work)) + 1e-200
    assert power == pytest.approx(heat + work, abs=slack)
    assert any_drive.bus_power(torque, speed) >= any_drive.joule_power(torque, speed) + work - slack


@many
@given(drives, shares, st.floats(-100.0, 100.0))
def test_torque_undoes_current(any_drive, share, current):
    speed = share * any_drive.no_load_speed
    assert any_drive.current(any_drive.torque(current, speed), speed) == pytest.approx(current, rel=1e-12)


class TestErrors:
    @pytest.mark.parametrize("field", [field.name for field in fields(Motor)[1:]])
    @pytest.mark.parametrize("value", [-1.0, 0.0, np.nan, np.inf, "x"])
    def test_motor(self, field, value):
        with pytest.raises(BadValue, match=f"Motor.{field}"):
            Motor("bad", **{field: value})

    @pytest.mark.parametrize(
        ("make", "name"),
        [
            (lambda: Gearbox(0.0), "ratio"),
            (lambda: Gearbox(10.0, 0.0), "efficiency"),
            (lambda: Gearbox(10.0, 1.1), "efficiency"),
            (lambda: Gearbox(10.0, inertia=-1.0), "inertia"),
            (lambda: Gearbox(10.0, max_torque=0.0), "max_torque"),
            (lambda: Gearbox(10.0, mass=0.0), r"Gearbox.mass is 0.0; expected a number > 0, in kg, or None"),
            (lambda: size_motor(motor("ec_90_flat_260w"), 0.0), "size is 0.0; expected a number > 0"),
            (lambda: drive(bus=0.0), "bus"),
            (lambda: drive(limit=-1.0), "current_limit"),
            (lambda: drawn_power(1.0, 1.1), "regeneration"),
            (lambda: scale_motor(motor("ec_90_flat_260w"), 0.0), "power"),
            (lambda: drive().envelope(np.nan), "speed"),
            (lambda: drive().envelope("fast"), "speed"),
            (lambda: drive().margin([1.0, 2.0], [1.0, 2.0, 3.0]), "torque and speed"),
            (lambda: drive().worst([], []), "torque"),
            (lambda: drive().worst(1.0, 1.0), "torque"),
        ],
    )
    def test_other_values(self, make, name):
        with pytest.raises(BadValue, match=name):
            make()

    def test_what_is_unknown_is_asked_for(self):
        with pytest.raises(BadValue, match="torque_constant of ec_60_flat_200w is None.*N·m/A.*replace"):
            Drive(motor("ec_60_flat_200w"), Gearbox(15.0), 48.0).envelope(0.0)
        with pytest.raises(BadValue, match="nominal_torque of ec_60_flat_200w"):
            _ = motor("ec_60_flat_200w").continuous_torque
        with pytest.raises(BadValue, match="rated_power of faulhaber_3863h024cr"):
            scale_motor(motor("faulhaber_3863h024cr"), 600.0)

    def test_unknown_names(self):
        with pytest.raises(UnknownName, match="unknown motor 'ec_600'; nearest of .*: ec_"):
            motor("ec_600")
        with pytest.raises(UnknownName, match="unknown gearbox 'gp'; valid: .*gp_52_c_15"):
            gearbox("gp")


class TestScaled:
    def test_it_is_equal_motors_on_one_shaft(self):
        one = motor("ec_90_flat_260w")
        two, speeds = scale_motor(one, 520.0), np.linspace(-20, 20, 9)
        gear = Gearbox(15.0, 0.83)
        pair, single = Drive(two, gear, 48.0), Drive(one, gear, 48.0)
        assert pair.envelope(speeds) == pytest.approx(2 * single.envelope(speeds))
        assert pair.continuous_torque == pytest.approx(2 * single.continuous_torque)
        assert pair.reflected_inertia == pytest.approx(2 * single.reflected_inertia)
        assert pair.bus_power(20.0, 5.0) == pytest.approx(2 * single.bus_power(10.0, 5.0))
        assert pair.no_load_speed == single.no_load_speed
        assert (two.rated_power, two.inductance) == (520.0, one.inductance / 2)

    def test_it_says_that_it_is_an_assumption(self):
        assert "assumption" in scale_motor(motor("ec_90_flat_260w"), 600.0).name
        assert {number.verification for number in MOTORS["assumed_600w"].values()} == {"assumption"}
        assumed = motor("assumed_600w")
        assert replace(scale_motor(motor("ec_90_flat_260w"), 600.0), name=assumed.name) == assumed

    def test_its_mass_follows_the_law_of_the_catalogue(self):
        one, law = motor("ec_90_flat_260w"), mass_law()
        assert size_motor(one, 1.0) == replace(one, name="ec_90_flat_260w of size 1 (assumption)")
        assert size_motor(one, 2.0).mass == pytest.approx(1.0 * 2.0**law.exponent)
        assert size_motor(one, 2.0) == replace(scale_motor(one, 520.0), name="ec_90_flat_260w of size 2 (assumption)")

    def test_the_law_is_the_line_of_least_squares_through_what_is_known(self):
        """Without motors of which mass or torque is an assumption, such as those that follow the law."""
        law = mass_law()
        assert len(law.motors) == 6 and not {"assumed_600w", "antigravity_4004_300kv"} & set(law.motors)
        x = np.log([motor(name).continuous_torque for name in law.motors])
        off = np.log([motor(name).mass for name in law.motors]) - law.exponent * x - np.log(law.constant)
        assert [off.sum(), off @ x] == pytest.approx([0.0, 0.0], abs=1e-12)
        assert np.log(law.spread) ** 2 == pytest.approx(off @ off / 4)
        assert str(law) == (
            "mass ∝ torque^0.49, fitted to 6 motors of the catalogue within a factor of 1.31 (assumption)"
        )

    def test_rotors_of_a_makers_series_grow_as_their_torques(self):
        """So they do within a quarter, over four times the torque: the assumption of sizes."""
        series = [motor(f"ec_{name}") for name in ("60_flat_100w_24v", "90_flat_90w_48v", "90_flat_260w")]
        ratios = [each.rotor_inertia / each.continuous_torque for each in series]
        assert max(ratios) < 1.25 * min(ratios)

    def test_what_is_unknown_stays_unknown(self):
        assert scale_motor(motor("ec_60_flat_150w"), 300.0).resistance is None


class TestCatalogue:
    def test_every_entry_can_be_made(self):
        for name in MOTORS:
            assert motor(name).name == name
        for name in GEARBOXES:
            assert gearbox(name).ratio >= 1
        assert not set(MOTORS) & set(GEARBOXES)

    def test_every_number_has_a_provenance(self):
        assert len(NUMBERS) > 80
        for (_, quantity), number in NUMBERS.items():
            assert number.source.strip() and number.verification in VERIFICATIONS and number.unit == UNITS[quantity]

    def test_what_is_said_to_be_stated_by_the_source_is(self):
        stated = {place: each.value for place, each in NUMBERS.items() if each.verification == "source document"}
        assert stated == {
            ("spear_ii_knee", "torque_constant"): 0.115,  # (4.8)
            ("spear_ii_knee", "rated_power"): 100.0,  # Section 2.4
            ("spear_ii_knee_gear", "ratio"): 15.0,  # Table 2.4
        }

    def test_the_constant_of_the_source_is_that_of_the_48_v_winding(self):
        knee = motor("spear_ii_knee").torque_constant
        assert motor("ec_60_flat_100w_48v").torque_constant == pytest.approx(knee, rel=0.01)
        assert motor("ec_60_flat_100w_24v").torque_constant < 0.5 * knee
