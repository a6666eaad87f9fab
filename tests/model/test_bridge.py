"""The bridge and the winding: the source's voltages, idle currents and the shorted motor."""

import numpy as np
import pytest

from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.bridge import (
    STATES,
    Battery,
    Bridge,
    back_emf,
    conduction_threshold,
    idle_current,
    shorted_damping,
)
from spear_pin.model.catalogue import gearbox, motor

KV, RATIO = 0.115, 15.0  # source: K_v of (4.8) in V·s/rad, Table 2.4
RPM = np.pi / 30.0  # rad/s


class TestTheSourcesVoltages:
    def test_its_example_is_of_the_joint(self):
        assert back_emf(KV, RATIO, 20.0) == pytest.approx(34.5, rel=1e-12)
        assert back_emf(KV, 1.0, 20.0) == pytest.approx(2.3, rel=1e-12)  # were 20 rad/s those of the rotor

    def test_the_catalogue_has_its_numbers(self):
        assert back_emf(motor("spear_ii_knee").torque_constant, gearbox("spear_ii_knee_gear").ratio, 20.0) == 34.5

    def test_of_several_speeds(self):
        speeds = np.array([[-2.0, 0.0], [1.0, 20.0]])
        np.testing.assert_allclose(back_emf(KV, RATIO, speeds), [[-3.45, 0.0], [1.725, 34.5]], rtol=1e-12)
        assert np.ndim(back_emf(KV, RATIO, 1.0)) == 0

    def test_the_constant_is_that_of_the_48_v_winding(self):
        assert 1.0 / KV / RPM == pytest.approx(83.0, abs=0.05)  # rpm/V
        assert abs(motor("ec_60_flat_100w_48v").torque_constant / KV - 1.0) < 0.01
        assert abs(motor("ec_60_flat_100w_24v").torque_constant / KV - 1.0) > 0.5

    def test_what_24_v_can_do_with_it(self):
        per_speed = back_emf(KV, RATIO, 1.0)
        assert Battery().voltage / per_speed == pytest.approx(13.9, abs=0.05)
        assert conduction_threshold(Battery(24.0), Bridge(0.7)) == pytest.approx(25.4, rel=1e-12)
        assert conduction_threshold(Battery(), Bridge()) / per_speed == pytest.approx(14.7, abs=0.05)
        assert conduction_threshold(Battery(48.0, 3.0), Bridge(0.0)) == 48.0


class TestIdleCurrent:
    BATTERY, BRIDGE = Battery(24.0, 0.4), Bridge(0.7)

    def coast(self, emf):
        return idle_current("coast", emf, 1.1, self.BATTERY, self.BRIDGE)

    def test_open_there_is_none(self):
        assert not idle_current("open", [-100.0, 0.0, 100.0], 1.1).any()
        assert idle_current("open", 100.0, 1.1) == 0.0

    def test_shorted_it_is_the_windings(self):
        np.testing.assert_allclose(idle_current("short", [-11.0, 0.0, 5.5], 1.1), [10.0, 0.0, -5.0], rtol=1e-12)
        with_battery = idle_current("short", 5.5, 1.1, self.BATTERY, self.BRIDGE)
        assert with_battery == pytest.approx(-5.0)  # which is not in the circuit

    def test_the_diodes_block_below_the_threshold(self):
        assert not self.coast(np.linspace(-25.4, 25.4, 101)).any()

    def test_and_conduct_above_it_through_everything(self):
        np.testing.assert_allclose(self.coast([25.4 + 1.5, -25.4 - 3.0]), [-1.0, 2.0], rtol=1e-12)
        assert idle_current("coast", 25.4 + 1.1, 1.1) == pytest.approx(-1.0)  # 24 V, 0.7 V each, no resistance

    def test_the_sources_joint_at_20_rad_s_charges_the_battery(self):
        current = idle_current("coast", back_emf(KV, RATIO, 20.0), 1.1)
        assert current == pytest.approx(-(34.5 - 25.4) / 1.1)
        assert idle_current("coast", back_emf(KV, RATIO, 14.0), 1.1) == 0.0

    def test_the_current_is_continuous_at_the_threshold(self):
        for side in (1.0, -1.0):
            assert self.coast(side * 25.4 * (1.0 + 1e-9)) == pytest.approx(0.0, abs=1e-7)

    @pytest.mark.parametrize("state", STATES)
    def test_it_brakes_and_is_odd(self, state):
        emf = np.linspace(-60.0, 60.0, 241)
        current = idle_current(state, emf, 1.1, self.BATTERY, self.BRIDGE)
        assert (current * emf <= 0.0).all()
        np.testing.assert_array_equal(current, -current[::-1])
        assert (np.diff(current) <= 0.0).all()
        assert (current[abs(emf) > 26.0] != 0.0).all() or state == "open"

    @pytest.mark.parametrize("state", STATES)
    def test_scalars_and_arrays(self, state):
        emf = np.array([[30.0, -40.0], [1.0, 0.0]])
        currents = idle_current(state, emf, 1.1)
        assert currents.shape == (2, 2)
        assert currents[0, 1] == idle_current(state, -40.0, 1.1)
        assert np.ndim(idle_current(state, -40.0, 1.1)) == 0

    def test_what_is_turned_is_heat_diodes_and_charge(self):
        emf = 32.0
        current = float(self.coast(emf))
        heat = current**2 * (1.1 + 0.4)
        assert -emf * current == pytest.approx(heat + 2 * 0.7 * -current + 24.0 * -current, rel=1e-12)


class TestShortedDamping:
    def test_of_the_two_windings(self):
        assert shorted_damping(KV, RATIO, 1.1) == pytest.approx(2.70, abs=0.01)
        assert shorted_damping(0.0534, RATIO, 0.307) == pytest.approx(2.09, abs=0.01)

    def test_it_is_the_torque_of_the_shorted_current(self):
        speed = 3.0
        torque = RATIO * KV * idle_current("short", back_emf(KV, RATIO, speed), 1.1)
        assert torque == pytest.approx(-shorted_damping(KV, RATIO, 1.1) * speed, rel=1e-12)


class TestErrors:
    def test_an_unknown_state(self):
        with pytest.raises(UnknownName, match="unknown state of the bridge 'brake'; valid: open, coast, short"):
            idle_current("brake", 1.0, 1.1)

    @pytest.mark.parametrize("state", STATES)
    @pytest.mark.parametrize("resistance", [0.0, -1.0, np.nan, np.inf, "x"])
    def test_resistance(self, state, resistance):
        with pytest.raises(BadValue, match="resistance"):
            idle_current(state, 1.0, resistance)

    @pytest.mark.parametrize(
        ("make", "name"),
        [
            (lambda: Battery(0.0), "Battery.voltage"),
            (lambda: Battery(np.nan), "Battery.voltage"),
            (lambda: Battery(24.0, -0.1), "Battery.resistance"),
            (lambda: Battery(24.0, np.inf), "Battery.resistance"),
            (lambda: Bridge(-0.7), "Bridge.diode"),
            (lambda: Bridge("x"), "Bridge.diode"),
            (lambda: shorted_damping(0.1, 15.0, 0.0), "resistance"),
        ],
    )
    def test_other_values(self, make, name):
        with pytest.raises(BadValue, match=name):
            make()
