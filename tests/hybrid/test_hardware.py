"""Hardware in the hop: its ideal limit, its energy, what each effect alone must do, and the files it is kept in."""

import csv
import json
import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import scipy

from spear_pin import Trajectory, find_gait, hopping, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.hardware import EDGE, HORIZON, Hardware, Sensing
from spear_pin.hybrid.parameters import with_hardware, with_parameters
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.model.actuator import CREEP, Actuator, Thermal
from spear_pin.model.bridge import Battery
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Gearbox
from tests.slow import slow_but

MOTOR = motor("spear_ii_knee")
R, CONSTANT = MOTOR.resistance, 15.0 * MOTOR.torque_constant
HUGE = Battery(1e6)
IDEAL = Actuator(MOTOR, Gearbox(15.0), HUGE)
REAL = replace(IDEAL, battery=Battery(24.0))
NOISE = Sensing(angle_noise=2e-3, rate_noise=2e-2, cutoff=50.0)
LOSSES = Sensing(losses=5.0, loss_duration=0.02, seed=3)
LOSSY = replace(REAL, gearbox=Gearbox(15.0, 0.83), battery=Battery(24.0, 0.3))
SAME = 1e-8
CONFIGURATIONS = {
    "ideal": (IDEAL, None),
    "saturated": (replace(IDEAL, battery=Battery(12.0)), None),
    "gearbox": (replace(IDEAL, gearbox=Gearbox(15.0, 0.83)), None),
    "loop": (replace(REAL, bandwidth=200.0), None),
    "battery": (replace(REAL, battery=Battery(24.0, 0.3)), None),
    "stiff battery": (replace(IDEAL, battery=Battery(1e6, 0.3)), None),
    "thermal": (replace(REAL, current_limit=8.0, thermal=Thermal(3.0, 0.1)), None),
    "noise": (REAL, NOISE),
    "losses": (REAL, LOSSES),
    "all": (
        replace(LOSSY, current_limit=8.0, thermal=Thermal(4.0, 0.3), bandwidth=200.0),
        replace(NOISE, losses=5.0, loss_duration=0.02),
    ),
}


def tolerances(monkeypatch, system, state, **asked):
    """What a hop is integrated with."""
    used = set()

    class Spied(scipy.integrate.DOP853):
        def __init__(self, *arguments, rtol, atol, **others):
            used.add((rtol, atol))
            super().__init__(*arguments, rtol=rtol, atol=atol, **others)

    with monkeypatch.context() as patch:
        patch.setattr(scipy.integrate, "DOP853", Spied)
        simulate(system, state, **asked)
    used.remove((1.0, np.inf))  # of the one step that ends on an event
    return used


@pytest.mark.parametrize(
    ("asked", "ideal", "driven"),
    [
        ({"rtol": 1e-7}, (1e-7, 1e-9), (1e-8, 1e-10)),
        ({"rtol": 1e-7, "atol": 1e-8}, (1e-7, 1e-8), (1e-8, 1e-9)),
        ({"rtol": 1e-13}, (1e-13, 1e-15), (1e-13, 1e-16)),
    ],
    ids=str,
)
def test_is_integrated_with_a_tenth_of_the_tolerance(hop, monkeypatch, asked, ideal, driven):
    used = tolerances(monkeypatch, hop.system, hop.state, **asked)
    assert [pytest.approx(pair) for pair in used] == [ideal]
    used = tolerances(monkeypatch, with_hardware(hop.system, Hardware((IDEAL, IDEAL))), hop.state, **asked)
    assert [pytest.approx(pair) for pair in used] == [driven]


@pytest.fixture(scope="module")
def run(hop):
    """Hops with hardware, each run once."""

    @cache
    def hops(hip, knee=None, sensing=None, cycles=2, rtol=1e-11):
        system = with_hardware(hop.system, Hardware((hip, knee or hip), sensing))
        trajectory = simulate(system, hop.state, cycles, rtol)
        assert trajectory.complete, trajectory.message
        return trajectory

    return hops


@pytest.fixture(scope="module")
def clean(hop):
    return simulate(hop.system, hop.state, 2, 1e-11)


def landings(trajectory):
    """Time, configuration and velocity at each touchdown."""
    return np.array([[e.time, *e.q, *e.v_before, *e.v] for e in trajectory.named("touchdown")])


def apex(trajectory):
    return trajectory.named("apex")[0].q[-3]


def assert_same_motion(trajectory, expected):
    assert [e.name for e in trajectory.events] == [e.name for e in expected.events]
    for ours, theirs in zip(trajectory.events, expected.events, strict=True):
        np.testing.assert_allclose([ours.time, *ours.q, *ours.v], [theirs.time, *theirs.q, *theirs.v], atol=SAME)
    assert trajectory.ledger.flows == expected.ledger.flows
    np.testing.assert_allclose(trajectory.ledger.work, expected.ledger.work, atol=SAME)
    np.testing.assert_allclose(trajectory.ledger.change, expected.ledger.change, atol=SAME)


def total(trajectory, flow):
    """Energy of a flow of all joints, in J."""
    return sum(trajectory.electrical[f"{flow}_{joint}"].sum() for joint in trajectory.actuated)


class TestIdealLimit:
    def test_it_is_the_hop_without_hardware(self, run, clean):
        ideal = run(IDEAL)
        assert_same_motion(ideal, clean)
        assert clean.electrical is None and clean.current.shape == clean.reference.shape == (len(clean.t), 0)
        np.testing.assert_allclose(ideal.current * CONSTANT, ideal.u, rtol=1e-12, atol=1e-12)
        np.testing.assert_array_equal(ideal.current, ideal.reference)

    @pytest.mark.slow
    def test_the_loop_converges_to_it_with_its_bandwidth(self, run):
        ideal = landings(run(IDEAL))
        errors = [np.abs(landings(run(replace(IDEAL, bandwidth=f))) - ideal).max() for f in (200.0, 400.0, 800.0)]
        assert errors[-1] < 0.1
        for coarse, fine in zip(errors, errors[1:], strict=False):
            assert coarse / fine == pytest.approx(2.0, abs=0.25)

    @pytest.mark.slow
    def test_it_converges_to_the_quasi_static_limit_where_the_voltage_runs_out(self, run):
        weak = replace(IDEAL, battery=Battery(15.0))
        limit = landings(run(weak))
        assert np.abs(limit - landings(run(IDEAL))).max() > 0.1
        errors = []
        for f in (400.0, 800.0):
            quick = replace(weak, bandwidth=f, motor=replace(MOTOR, inductance=0.05 / f))
            errors.append(np.abs(landings(run(quick)) - limit).max())
        assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.4)

    def test_the_actuators_are_in_the_order_of_the_joints(self, run, clean):
        fast = replace(IDEAL, gearbox=Gearbox(30.0))
        mixed = run(IDEAL, fast)
        assert_same_motion(mixed, clean)
        np.testing.assert_allclose(mixed.current * [CONSTANT, 2 * CONSTANT], mixed.u, rtol=1e-12, atol=1e-12)
        heated = run(replace(IDEAL, bandwidth=200.0), replace(IDEAL, current_limit=8.0, thermal=Thermal(7.0, 1.0)))
        np.testing.assert_array_equal(heated.current[:, 1], heated.reference[:, 1])
        assert np.abs(heated.current - heated.reference)[:, 0].max() > 0.1


class TestEnergy:
    @pytest.mark.parametrize("name", slow_but(CONFIGURATIONS, "ideal", "gearbox", "all"))
    def test_both_ledgers_close(self, run, name):
        one, sensing = CONFIGURATIONS[name]
        trajectory = run(one, sensing=sensing, rtol=1e-9)
        assert trajectory.cycles == 2 and trajectory.electrical.work.shape == (2, 8)
        assert np.abs(trajectory.ledger.residual).max() < 1e-8
        assert np.abs(trajectory.electrical.residual).max() < 1e-8
        assert trajectory.evaluations < 60_000
        for joint in ("hip", "knee"):
            motors = trajectory.ledger[f"motor_{joint}"]
            np.testing.assert_array_equal(trajectory.electrical[f"motor_{joint}"], -motors)
            assert (trajectory.electrical[f"joule_{joint}"] < 0).all()
            gears = trajectory.electrical[f"gearbox_{joint}"]
            assert (gears < 0).all() if one.gearbox.efficiency < 1 else not gears.any()
        stored = trajectory.electrical.change
        assert (stored != 0).any() if one.bandwidth else not stored.any()

    def test_a_cycle_is_as_accurate_as_asked_for(self, hop):
        """Where gears turn from driving to braking, the integrator's own estimates are too small."""
        gears = replace(REAL, gearbox=Gearbox(15.0, 0.83))
        system = with_parameters(with_hardware(hop.system, Hardware((gears, gears))), {"stance_torque": 9.4})
        ends = [np.concatenate(return_map(system, hop.state, rtol).state) for rtol in (1e-13, 1e-10, 1e-8)]
        assert np.abs(ends[1] - ends[0]).max() < 2e-10
        assert np.abs(ends[2] - ends[0]).max() < 2e-8

    def test_its_flows_are_integrals_of_the_samples(self, run):
        trajectory = run(LOSSY)
        part = trajectory.cycle == 1
        t, current, rate = trajectory.t[part], trajectory.current[part], trajectory.v[part, -2:]
        shaft = CONSTANT * current * rate
        share = 0.83 ** np.tanh(np.sign(current) * rate / CREEP)
        np.testing.assert_allclose(trajectory.u[part], CONSTANT * current * share, rtol=1e-12, atol=1e-12)
        terminals = R * current**2 + shaft
        drawn = (24 - np.sqrt(24**2 - 4 * 0.3 * terminals)) / (2 * 0.3)
        powers = {
            "battery": 24 * drawn,
            "joule": -R * current**2 - 0.3 * drawn**2,
            "gearbox": -shaft * (1 - share),
            "motor": -shaft * share,
        }
        for flow, power in powers.items():
            for i, joint in enumerate(("hip", "knee")):
                energy = trajectory.electrical[f"{flow}_{joint}"][0]
                assert np.trapezoid(power[:, i], t) == pytest.approx(energy, rel=2e-3, abs=2e-3)


class TestEachEffectAlone:
    def test_gears_that_lose_lower_the_apex_and_cost_energy(self, run):
        ideal, lossy = run(REAL), run(replace(REAL, gearbox=Gearbox(15.0, 0.83)))
        assert apex(lossy) < apex(ideal) - 5e-3
        costs = [total(one, "battery") / -total(one, "motor") for one in (ideal, lossy)]
        assert costs[1] > 1.1 * costs[0] > 1.1
        assert total(lossy, "gearbox") < 0 == total(ideal, "gearbox")

    def test_a_current_limit_below_the_peak(self, run, clean):
        limited = run(replace(IDEAL, current_limit=5.0))
        assert np.abs(clean.u[:, 1]).max() / CONSTANT > 5.2
        assert np.abs(limited.current).max() == 5.0 < np.abs(limited.reference).max()
        assert np.abs(landings(limited) - landings(clean)).max() > 1e-3
        expected = np.clip(limited.reference, -5.0, 5.0)
        np.testing.assert_array_equal(limited.current, expected)

    def test_a_current_limit_above_the_peak(self, run, clean):
        assert_same_motion(run(replace(IDEAL, current_limit=5.5)), clean)

    def test_the_batterys_resistance_only_heats_while_no_limit_is_met(self, run, clean):
        stiff, soft = run(REAL), run(replace(REAL, battery=Battery(24.0, 0.3)))
        assert_same_motion(soft, clean)
        assert total(soft, "joule") < 1.01 * total(stiff, "joule") < 0
        more_heat = total(stiff, "joule") - total(soft, "joule")
        assert total(soft, "battery") - total(stiff, "battery") == pytest.approx(more_heat, rel=1e-6)

    def test_it_lowers_the_voltage_that_is_left(self, run):
        stiff, soft = (run(replace(REAL, battery=Battery(15.0, r))) for r in (0.0, 1.0))
        clips = [(np.abs(one.current - one.reference)[:, 1] > 1e-9).sum() for one in (stiff, soft)]
        assert clips[1] > clips[0] > 0

    def test_too_little_voltage_clips(self, run, clean):
        volts = 12.0
        assert volts / CONSTANT < np.abs(clean.v[:, -1]).max()  # no load
        weak = run(replace(IDEAL, battery=Battery(volts)), cycles=1)
        emf = CONSTANT * weak.v[:, -2:]
        clipped = np.abs(weak.current - weak.reference) > 1e-9
        assert clipped.sum() > 10 and not clipped.all()
        needed = R * weak.reference + emf
        np.testing.assert_array_equal(clipped, np.abs(needed) > volts * (1 + 1e-9))
        np.testing.assert_allclose((R * weak.current + emf)[clipped], volts * np.sign(needed[clipped]), rtol=1e-9)
        assert apex(weak) < apex(clean)

    def test_heat_folds_the_current_back(self, run, clean):
        peak, continuous, tau = 8.0, 3.0, 0.1
        hot = run(replace(IDEAL, current_limit=peak, thermal=Thermal(continuous, tau)))
        bound = np.abs(hot.current) < np.abs(hot.reference) - 1e-6
        assert bound[:, 1].any() and not bound.all()
        alone = hot.domain != CHATTER  # in it two laws' currents are blended, of which one may be bound
        assert np.abs(hot.current)[bound & alone[:, None]].min() >= continuous
        assert np.abs(hot.current).max() < np.abs(clean.u).max() / CONSTANT - 0.3
        square, knee = 0.0, hot.current[:, 1]
        for i, dt in enumerate(np.diff(hot.t)):  # the mean square by the trapezoidal rule
            square += (knee[i] ** 2 + knee[i + 1] ** 2 - 2 * square) / (2 * tau + dt) * dt
            allowed = continuous + (peak - continuous) * min(max(10 * (1 - square / continuous**2), 0), 1)
            assert abs(knee[i + 1]) < allowed + 0.15
        assert_same_motion(run(replace(IDEAL, current_limit=8.0, thermal=Thermal(6.0, tau))), clean)


class TestSensing:
    def test_noise_of_no_amplitude_changes_nothing(self, run, clean):
        assert_same_motion(run(IDEAL, sensing=Sensing(seed=5)), clean)

    def test_the_clock_runs_on_through_events(self, run, hop):
        noisy, law = run(IDEAL, sensing=NOISE), hop.system.law
        flight = noisy.phase == "flight"
        assert (noisy.cycle[flight] == 2).any() and len(noisy.named("touchdown")) == 2
        noises = [NOISE.noise(t, 2) for t in noisy.t[flight]]
        angles, rates = (np.array([noise[i] for noise in noises]) for i in (0, 1))
        q, v = noisy.q[flight, -2:] + angles, noisy.v[flight, -2:] + rates
        targets = np.array([0.5, 1.0]) * law.knee_touchdown
        wanted = [law.hip_gain, law.knee_gain] * (targets - q) - [law.hip_damping, law.knee_damping] * v
        np.testing.assert_allclose(noisy.u[flight], wanted, atol=1e-9)
        assert np.abs(wanted - noisy.u[flight] + [law.hip_gain, law.knee_gain] * angles).max() > 0.05

    @pytest.mark.slow
    def test_the_same_seed_the_same_run(self, run):
        first, again = run(REAL, sensing=NOISE), run.__wrapped__(REAL, sensing=replace(NOISE))
        other = run(REAL, sensing=replace(NOISE, seed=1))
        np.testing.assert_array_equal(landings(first), landings(again))
        assert np.abs(landings(first) - landings(other)).max() > 1e-3

    @pytest.mark.slow
    def test_lost_commands_leave_no_current(self, run):
        lossy = run(REAL, sensing=LOSSES)
        since = [lossy.t - b for b in LOSSES.losses_begin if b < lossy.t[-1]]
        assert since
        lost = np.any([(s >= EDGE) & (s <= 0.02 - EDGE) for s in since], axis=0)
        around = np.any([(s >= 0) & (s <= 0.02) for s in since], axis=0)
        assert lost.sum() > 5 and not lossy.current[lost].any() and lossy.reference[lost].all(axis=1).any()
        np.testing.assert_array_equal(lossy.current[~around], lossy.reference[~around])

    @pytest.mark.parametrize("joints", [1, 2, 4, 8])
    def test_the_noise_has_its_amplitude_and_cutoff(self, joints):
        sensing = Sensing(angle_noise=0.3, rate_noise=2.0, cutoff=10.0, seed=2)
        times = np.linspace(0.0, 100.0, 4001)
        noises = np.array([sensing.noise(t, joints) for t in times])
        assert noises.shape == (4001, 2, joints)
        np.testing.assert_allclose(noises.std(axis=0), np.outer([0.3, 2.0], np.ones(joints)), rtol=0.05)
        alike = np.corrcoef(noises.reshape(4001, -1).T) - np.eye(2 * joints)
        assert np.abs(alike).max() < 0.15
        spectrum = np.abs(np.fft.rfft(noises[:, 0, 0] * np.hanning(4001)))
        assert spectrum[np.fft.rfftfreq(4001, 0.025) > 10.2].max() < 1e-3 * spectrum.max()

    def test_commands_ramp_out_and_in(self):
        sensing = Sensing(losses=1.0, loss_duration=0.01)
        begins = sensing.losses_begin
        assert len(begins) == pytest.approx(HORIZON, abs=4 * math.sqrt(HORIZON)) and (np.diff(begins) > 0).all()
        begin = begins[np.argmax(np.diff(begins))]
        offsets = [-EDGE, 0.0, EDGE / 2, EDGE, 0.005, 0.01 - EDGE, 0.01 - EDGE / 2, 0.01, 0.02]
        arriving = [sensing.arriving(begin + offset) for offset in offsets]
        assert arriving == pytest.approx([1.0, 1.0, 0.5, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0], abs=1e-9)
        assert Sensing().arriving(1.0) == 1.0

    def test_what_is_lost_does_not_come_back_when_another_loss_begins(self):
        sensing = Sensing(losses=50.0, loss_duration=0.05)
        begins = sensing.losses_begin[:100]
        assert (np.diff(begins) < 0.04).any()
        for time in np.arange(begins[0], begins[-1], 1e-3):
            lost = ((time - begins >= EDGE) & (time - begins <= 0.05 - EDGE)).any()
            assert not lost or sensing.arriving(time) == 0.0
        fine = [sensing.arriving(t) for t in np.arange(begins[0], begins[0] + 0.5, EDGE / 8)]
        assert np.abs(np.diff(fine)).max() < 0.13


class TestSystems:
    def test_without_hardware_it_is_what_it_was(self, hop, clean):
        hardware = Hardware((REAL, REAL))
        assert with_hardware(hop.system, None) is hop.system
        bare = with_hardware(with_hardware(hop.system, hardware), None)
        rebuilt = bare.build(bare.robot, bare.law)
        assert bare.hardware is None and rebuilt.hardware is None
        again = simulate(rebuilt, hop.state, 2, 1e-11)
        np.testing.assert_array_equal(again.q, clean.q)

    def test_systems_that_are_rebuilt_keep_the_last(self, hop):
        first, last = Hardware((REAL, REAL)), Hardware((IDEAL, REAL), NOISE)
        system = with_hardware(with_hardware(hop.system, first), last)
        changed = with_parameters(with_parameters(system, {"stance_torque": 7.0}), {"stiffness": 40.0})
        assert changed.hardware is last
        assert (changed.law.stance_torque, changed.spring.stiffness) == (7.0, 40.0)

    @pytest.mark.slow
    def test_a_gait_is_found_for_the_hardware(self, hop, robot):
        geared = with_hardware(hopping(robot), Hardware((REAL, replace(REAL, gearbox=Gearbox(15.0, 0.83)))))
        near = with_parameters(geared, {"stance_torque": 9.4})
        gait = find_gait(near, ["stance_torque"], {"flight_time": 0.2}, guess=hop.state)
        assert gait.system.hardware is geared.hardware
        assert gait.durations["flight"] == pytest.approx(0.2, abs=1e-9)
        assert gait.parameters["stance_torque"] > 1.1 * hop.parameters["stance_torque"]

    @pytest.mark.parametrize("count", [0, 1, 3])
    def test_every_motor_has_one(self, hop, count):
        with pytest.raises(BadValue, match=r"actuators.*2, one for each of .*hip.*knee"):
            with_hardware(hop.system, Hardware((REAL,) * count))

    def test_names_of_the_states(self):
        loop = replace(REAL, bandwidth=100.0)
        hot = replace(loop, current_limit=8.0, thermal=Thermal(4.0, 1.0))
        assert Hardware((REAL, REAL)).names == ()
        hardware = Hardware((hot, loop), NOISE)
        assert hardware.names == ("clock", "current_0", "square_0", "current_1")
        assert hardware.states([1.0, 2.0, 3.0, 4.0]) == (1.0, [{"current": 2.0, "square": 3.0}, {"current": 4.0}])
        assert hardware.stored([1.0, 2.0, 3.0, 4.0]) == pytest.approx(0.5 * MOTOR.inductance * (4 + 16))
        assert Hardware((loop, REAL)).max_step == hardware.max_step < Hardware((REAL, REAL)).max_step

    @pytest.mark.parametrize(
        ("field", "value"),
        [("angle_noise", -1e-3), ("rate_noise", math.nan), ("cutoff", 0.0), ("cutoff", 251.0)]
        + [("losses", -1.0), ("losses", 51.0), ("loss_duration", 1e-4), ("angle_noise", "x")],
    )
    def test_bad_values(self, field, value):
        with pytest.raises(BadValue, match=f"Sensing.{field}"):
            Sensing(**{field: value})


class TestFiles:
    def test_round_trip(self, run, tmp_path):
        one, sensing = CONFIGURATIONS["all"]
        trajectory = run(one, sensing=sensing, rtol=1e-9)
        again = Trajectory.load(trajectory.save(tmp_path / "hop.npz"))
        assert again.current.shape == (len(trajectory.t), 2) and again.electrical.flows == trajectory.electrical.flows
        for name in ("t", "q", "u", "current", "reference"):
            np.testing.assert_array_equal(getattr(again, name), getattr(trajectory, name))
        for name in ("work", "change", "residual"):
            np.testing.assert_array_equal(getattr(again.electrical, name), getattr(trajectory.electrical, name))

    @pytest.mark.parametrize("old", [False, True])
    def test_without_hardware(self, clean, tmp_path, old):
        path = clean.save(tmp_path / "hop.npz")
        if old:  # as from before there was hardware
            with np.load(path) as data:
                arrays = {name: data[name] for name in data if name not in ("current", "reference")}
            meta = json.loads(str(arrays["meta"]))
            del meta["drives"]
            np.savez_compressed(path, **arrays | {"meta": np.array(json.dumps(meta))})
        again = Trajectory.load(path)
        assert again.electrical is None and again.current.shape == again.reference.shape == (len(clean.t), 0)
        np.testing.assert_array_equal(again.u, clean.u)
        assert not any("current" in name for name in again.columns()[0])

    def test_columns(self, run, tmp_path):
        trajectory = run(replace(IDEAL, current_limit=5.0))  # less than the reference
        with trajectory.export(tmp_path / "hop.csv").open(encoding="utf-8") as file:
            rows = list(csv.reader(file))
        for name, values in (("current", trajectory.current), ("reference", trajectory.reference)):
            for i, joint in enumerate(("hip", "knee")):
                column = rows[0].index(f"{name}_{joint} [A]")
                np.testing.assert_array_equal([float(row[column]) for row in rows[1:]], values[:, i])
