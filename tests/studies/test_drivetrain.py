"""Motor and gear ratio at the knee: figures by other means, laws of scaling, limits, failures with a reason."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from spear_pin import HoppingLaw, hopping, load, simulate, vary
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Motor
from spear_pin.studies.drivetrain import KneeDrive, judge_drive, knee_drives, knee_inertia
from spear_pin.studies.hardware import Rig, on_rig

ETA, R, KT, N = 0.83, 1.1, 0.115, 15.0
KNEE = motor("spear_ii_knee")
ROBOT = load("spear_ii", locked=["boom_x"])


@pytest.fixture(scope="module")
def own() -> KneeDrive:
    """SPEAR-II's own knee."""
    (row,) = knee_drives(ROBOT, {"own": KNEE}, [N], efficiency=ETA)
    return row


@pytest.fixture(scope="module")
def light() -> KneeDrive:
    """A quarter of the rotor behind twice the ratio."""
    (row,) = knee_drives(ROBOT, {"light": replace(KNEE, rotor_inertia=KNEE.rotor_inertia / 4)}, [2 * N], efficiency=ETA)
    return row


@pytest.fixture(scope="module")
def hop(own):
    """The knee's time, torque and speed over a hop, in pieces between events."""
    run = simulate(own.gait.system, own.gait.state, 1, progress=False)
    ends = np.flatnonzero(np.diff(run.t) == 0.0) + 1
    return [np.split(values, ends) for values in (run.t, run.u[:, 1], run.v[:, -1])]


def integral(t, values):
    """By parabolas, piece by piece."""
    return sum(simpson(y, x=x) for x, y in zip(t, values, strict=True) if len(x) > 2)


def current(torque, speed):
    """From joint torque and speed, gears losing either way."""
    return torque / (N * KT) * np.where(torque * speed < 0.0, ETA, 1.0 / ETA)


@pytest.mark.slow
class TestOwnKnee:
    def test_it_is_the_hop_on_hardware(self, own):
        assert own.can and not own.endures and own.gait.stable and own.ratio == N
        assert own.stance_torque == pytest.approx(9.43, abs=0.01)  # docs/explanation/hardware.md
        assert own.energy + 0.1 == pytest.approx(26.4, abs=0.15)
        assert own.gait.durations["flight"] == pytest.approx(0.2, abs=1e-9)
        assert own.multiplier == pytest.approx(0.466, abs=0.005)

    def test_its_gains_are_the_laws(self, own):
        """The robot's own rotor is what they are meant for."""
        law = own.gait.system.law
        assert law.knee_gain == pytest.approx(HoppingLaw().knee_gain, rel=1e-6)
        assert law.knee_damping == pytest.approx(HoppingLaw().knee_damping, rel=1e-6)

    def test_heat_is_the_integral_of_r_i_squared(self, own, hop):
        t, torque, speed = hop
        heat = integral(t, [R * current(u, w) ** 2 for u, w in zip(torque, speed, strict=True)])
        assert own.heat == pytest.approx(heat, rel=2e-3)
        period = t[-1][-1] - t[0][0]
        assert own.rms_current == pytest.approx(np.sqrt(heat / R / period), rel=1e-3)
        assert own.thermal_load == pytest.approx(KT * np.sqrt(heat / R / period) / 0.227, rel=1e-3)

    def test_root_mean_square_by_parabolas(self, own, hop):
        t, torque, _ = hop
        square = integral(t, [u**2 for u in torque]) / (t[-1][-1] - t[0][0])
        assert own.rms_torque == pytest.approx(np.sqrt(square), rel=1e-3)

    def test_energy_is_heat_and_what_the_shaft_does(self, own, hop):
        t, torque, speed = hop
        amperes = [current(u, w) for u, w in zip(torque, speed, strict=True)]
        power = [(R * i + N * KT * w) * i for i, w in zip(amperes, speed, strict=True)]
        assert own.energy == pytest.approx(integral(t, power), rel=2e-3)
        assert own.drawn == pytest.approx(integral(t, [np.maximum(p, 0.0) for p in power]), rel=2e-3)
        assert own.drawn > own.energy

    def test_margin_is_that_of_the_closed_form(self, own, hop):
        torque, speed = (np.concatenate(values) for values in hop[1:])
        along = np.sign(torque) * speed
        most = N * KT * (24.0 - N * KT * along) / R
        margin = (np.where(along < 0.0, 1.0 / ETA, ETA) * most - np.abs(torque)).min()
        assert own.margin == pytest.approx(margin, rel=1e-12) and margin > 0.0
        assert own.peak_speed == pytest.approx(np.abs(speed).max(), rel=1e-3)
        assert own.peak_torque == pytest.approx(np.abs(torque).max(), rel=1e-3)
        assert own.drive.no_load_speed == pytest.approx(24.0 / (N * KT))

    def test_inside_the_envelope_limits_change_nothing(self, own):
        free = simulate(own.gait.system, own.gait.state, 1, progress=False)
        real = on_rig(own.gait, Rig(battery=Battery(24.0), current_limit=1.01 * own.peak_current), 1, progress=False)
        np.testing.assert_allclose(real.q[-1], free.q[-1], atol=1e-7)

    def test_reflected_inertia_is_in_the_mass_matrix(self, own, light):
        q = [0.55, 0.5, 1.0]
        bare = vary(ROBOT, knee_rotor=0.0).mass_matrix(q)
        for row in (own, light):
            more = row.gait.system.robot.mass_matrix(q) - bare
            assert more[2, 2] == pytest.approx(row.reflected_inertia, rel=1e-9)
            assert row.reflected_inertia == pytest.approx(row.ratio**2 * row.drive.motor.rotor_inertia, rel=1e-12)
            assert np.abs(more).sum() == pytest.approx(more[2, 2], rel=1e-9)


class TestLaws:
    @pytest.mark.slow
    def test_the_motion_depends_on_the_reflected_inertia_alone(self, own, light):
        for name in ("stance_torque", "apex", "impact"):
            assert getattr(light, name) == pytest.approx(getattr(own, name), rel=1e-6)
        assert light.multiplier == pytest.approx(own.multiplier, rel=1e-4)  # by differences
        for name in ("peak_torque", "peak_speed", "rms_torque"):  # of samples, which are not at the same times
            assert getattr(light, name) == pytest.approx(getattr(own, name), rel=1e-3)

    @pytest.mark.slow
    def test_heat_of_the_same_motion_falls_with_the_square_of_the_ratio(self, own, light):
        assert light.heat == pytest.approx(own.heat / 4.0, rel=1e-6)
        assert light.rms_current == pytest.approx(own.rms_current / 2.0, rel=1e-6)
        assert light.energy - light.heat == pytest.approx(own.energy - own.heat, rel=1e-6)

    @pytest.mark.slow
    def test_but_the_speed_is_not_to_be_had(self, own, light):
        assert light.drive.no_load_speed == own.drive.no_load_speed / 2 and light.margin < 0.0 < own.margin

    def test_inertia_of_the_knee_in_the_air(self):
        """With the hip held the shank and the rotor would be all; free, less than that."""
        law = HoppingLaw()
        more = knee_inertia(vary(ROBOT, knee_rotor=1e3), law)
        assert more == pytest.approx(225e3, rel=1e-3)
        bare = knee_inertia(vary(ROBOT, knee_rotor=0.0), law)
        assert 0.0 < bare < ROBOT.mass_matrix([0.0, 0.5, 1.0])[2, 2] - 0.027 + 1e-12


class TestFailure:
    @pytest.mark.slow
    def test_outside_the_envelope(self, own):
        weak = judge_drive("weak", replace(own.drive, bus=14.0), own.gait)
        assert not weak.can and weak.margin < 0.0 and weak.heat == own.heat
        assert f"by {-weak.margin:.1f} N·m" in weak.reason and "outside the envelope" in weak.reason
        assert judge_drive("limited", replace(own.drive, current_limit=0.9 * own.peak_current), own.gait).margin < 0.0
        assert judge_drive("limited", replace(own.drive, current_limit=1.1 * own.peak_current), own.gait).can

    @pytest.mark.slow
    def test_faster_than_its_bearings(self, own):
        slow = replace(KNEE, max_speed=50.0)
        hip, knee = own.gait.system.hardware.actuators
        system = with_hardware(own.gait.system, Hardware((hip, replace(knee, motor=slow))))
        row = judge_drive("slow", replace(own.drive, motor=slow), replace(own.gait, system=system))
        assert row.margin == -np.inf and row.reason.endswith("above the motor's max_speed")

    @pytest.mark.slow
    def test_no_gait_is_a_row_with_a_reason(self):
        """The rotor reflects 0.8 kg·m², twenty times what swings, and the gains stay."""
        heavy = replace(KNEE, rotor_inertia=2e-3)
        (row,) = knee_drives(ROBOT, {"heavy": heavy}, [20.0], retune=False)
        assert row.gait is None and not row.can and not row.endures and row.reason.startswith("no gait found")
        assert row.reflected_inertia == pytest.approx(0.8) and np.isnan([row.heat, row.margin, row.energy]).all()

    @pytest.mark.slow
    def test_a_gait_of_another_motor_is_refused(self, own):
        other = replace(own.drive, motor=motor("ec_90_flat_260w"))
        with pytest.raises(BadValue, match="gait .*the drive's motor"):
            judge_drive("other", other, own.gait)
        with pytest.raises(BadValue, match="gait"):
            judge_drive("ideal", own.drive, replace(own.gait, system=hopping(ROBOT)))


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        ({"motors": {}}, "motors"),
        ({"ratios": []}, "ratios .*at least one"),
        ({"ratios": [15.0, -2.0]}, r"ratios\[1\] is -2.0"),
        ({"ratios": [15.0, "x"]}, r"ratios\[1\] is 'x'"),
        ({"efficiency": 1.5}, "Gearbox.efficiency is 1.5"),
        ({"bus": 0.0}, "Drive.bus is 0.0"),
        ({"current_limit": -1.0}, "Drive.current_limit is -1.0"),
        ({"target": {}}, "target .*one measure"),
        ({"target": {"flight_time": 0.2, "period": 0.5}}, "target"),
        ({"motors": {"150 W": motor("ec_60_flat_150w")}}, "torque_constant of ec_60_flat_150w is None"),
        ({"motors": {"any": Motor("any", 0.1, 1.0, nominal_torque=0.2)}}, "rotor_inertia of any is None"),
        ({"motors": {"any": Motor("any", 0.1, 1.0, rotor_inertia=1e-4)}}, "nominal_torque of any is None"),
    ],
)
def test_bad_values_are_refused_at_once(arguments, expected):
    with pytest.raises(BadValue, match=expected):
        knee_drives(ROBOT, **{"motors": {"own": KNEE}, "ratios": [15.0], **arguments})


def test_unknown_measures_are_named():
    with pytest.raises(UnknownName, match="target 'flight'"):
        next(knee_drives(ROBOT, {"own": KNEE}, [15.0], target={"flight": 0.2}))
