"""Hardware in the hop: its ideal limit, its energy, and what each effect alone must do."""

from dataclasses import replace

import numpy as np
import pytest
import scipy

from spear_pin import simulate
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.parameters import with_hardware, with_parameters
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.model.actuator import CREEP, Thermal
from spear_pin.model.bridge import Battery
from spear_pin.model.motor import Gearbox
from tests.hybrid.hardware.drives import (
    CONFIGURATIONS,
    CONSTANT,
    IDEAL,
    LOSSY,
    MOTOR,
    REAL,
    R,
    apex,
    assert_same_motion,
    landings,
    total,
)
from tests.slow import slow_but


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
        errors = [np.abs(landings(run(replace(IDEAL, bandwidth=f))) - ideal).max() for f in (200.0, 400.0)]
        assert errors[1] < 0.2
        assert errors[0] / errors[1] == pytest.approx(2.0, abs=0.25)

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

    @pytest.mark.slow
    def test_the_actuators_are_in_the_order_of_the_joints(self, run, clean):
        fast = replace(IDEAL, gearbox=Gearbox(30.0))
        mixed = run(IDEAL, fast)
        assert_same_motion(mixed, clean)
        np.testing.assert_allclose(mixed.current * [CONSTANT, 2 * CONSTANT], mixed.u, rtol=1e-12, atol=1e-12)
        heated = run(replace(IDEAL, bandwidth=200.0), replace(IDEAL, current_limit=8.0, thermal=Thermal(7.0, 1.0)))
        np.testing.assert_array_equal(heated.current[:, 1], heated.reference[:, 1])
        assert np.abs(heated.current - heated.reference)[:, 0].max() > 0.1


class TestEnergy:
    @pytest.mark.parametrize("name", slow_but(CONFIGURATIONS, "ideal", "gearbox"))
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
        size = np.maximum(1.0, np.abs(ends[0]))  # tolerances are relative
        assert (np.abs(ends[1] - ends[0]) / size).max() < 1e-10
        assert (np.abs(ends[2] - ends[0]) / size).max() < 1e-8

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

    @pytest.mark.slow
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
