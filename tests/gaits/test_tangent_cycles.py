"""Cycles with derivatives: against differences of the reference engine, and gaits against those found without them."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, Spring, find_gait, hopping, load
from spear_pin.gaits.series_hopping import series_hopping
from spear_pin.gaits.tangent_cycles import tangent_cycles
from spear_pin.hybrid import periodic
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.modes import starting_phase
from spear_pin.hybrid.parameters import parameter, with_parameters
from spear_pin.hybrid.periodic import chart, differentiate_return_map, eigenvalues, one_by_one, return_map
from spear_pin.hybrid.result import Moment, Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.shooting import Shooting
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.record import Recorder

pytestmark = pytest.mark.extra("heyoka")
ONE = np.zeros(1, dtype=np.int64)
ON_SLOPE = HoppingLaw(hip_touchdown=0.5, stance_torque=8.0), Ground(slope=0.02, height=0.1)


def shooting_about(system, state, vary, target):
    """The equations about a state by exact cycles, and with the reference engine's alone."""
    exact = tangent_cycles(system, vary, target)
    assert exact is not None

    def cycle(begun, values):
        own = with_parameters(system, dict(zip(vary, values.tolist(), strict=True)))
        return return_map(own, begun, 1e-12)

    charts, wanted = chart(system, state).lane, np.zeros((1, len(target)))
    reference = one_by_one(system, cycle, [lambda run, _, name=name: system.measures[name](run) for name in target])
    own = Shooting(charts, exact.otherwise(reference), vary, wanted, exact.slopes)
    return own, Shooting(charts, reference, vary, wanted)


def assert_jacobians_agree(system, state, vary, target, xi, change=1.01, tolerance=2e-7):
    """Beside a state and with other numbers, residuals and Jacobians of both, and that the exact ones are such."""
    own, other = shooting_about(system, state, vary, target)
    unknowns = np.concatenate([xi, [change * parameter(system, name) for name in vary]])
    (found,), (expected,) = (each.residuals(ONE, unknowns[None])[0] for each in (own, other))
    np.testing.assert_allclose(found, expected, rtol=0, atol=1e-9)
    exact = own.jacobians(ONE, unknowns[None])[0]
    along = np.random.default_rng(0).normal(size=(3, len(unknowns)))  # mixes all of them
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    errors = []
    for step in (2e-4, 1e-4):  # whose errors fall by four, and are extrapolated
        values, why = other.residuals(np.zeros(6, dtype=np.int64), unknowns + step * np.concatenate([along, -along]))
        assert not why.any()
        errors.append((values[:3] - values[3:]) / (2.0 * step) - along @ exact.T)
    scale = np.abs(exact).max()
    assert np.abs((4.0 * errors[1] - errors[0]) / 3.0).max() < tolerance * scale


def test_jacobians_of_the_hop_beside_the_gait(hop):
    xi = np.array([1e-3, -4e-3, 7e-3])
    target = ("flight_time", "apex_height", "knee_rate_at_touchdown")
    assert_jacobians_agree(hop.system, hop.state, ("stance_torque", "stiffness", "friction"), target, xi)


@pytest.mark.slow
def test_jacobians_where_the_ground_varies(free_robot):
    """The state moves with the ground that it is on."""
    law, ground = ON_SLOPE
    system = hopping(free_robot, law, ground=ground)
    gait = find_gait(system, ["hip_touchdown"], {"mean_speed": 0.0})
    xi = np.array([2e-3, -1e-3, 3e-3, 2e-3])
    vary = ("slope", "height", "hip_touchdown")
    assert_jacobians_agree(gait.system, gait.state, vary, ("mean_speed", "period", "hip_at_touchdown"), xi)


@pytest.mark.slow
def test_jacobians_of_a_bound():
    gait = Gait.load("force_lift_off")
    xi = 1e-4 * np.random.default_rng(2).normal(size=chart(gait.system, gait.state).dimension)
    vary = ("posterior_hip_torque", "anterior_hip_torque", "knee_touchdown")
    target = ("mean_speed", "period", "stride")
    assert_jacobians_agree(gait.system, gait.state, vary, target, xi, change=1.0001, tolerance=2e-6)


def assert_same(found, expected, tolerance=1e-9):
    for one, other in zip(found.state, expected.state, strict=True):
        np.testing.assert_allclose(one, other, rtol=0, atol=tolerance)
    for name, value in expected.parameters.items():
        assert found.parameters[name] == pytest.approx(value, rel=tolerance)
    assert found.residual <= 1e-9
    np.testing.assert_allclose(np.abs(found.multipliers), np.abs(expected.multipliers), rtol=0, atol=1e-7)


def both(monkeypatch, *asked, **named):
    """A gait that is found by exact derivatives, and the same without the engine that they are of."""
    found = find_gait(*asked, **named)
    with monkeypatch.context() as patch:
        patch.setattr(taylor, "available", lambda: False)
        return found, find_gait(*asked, **named)


class TestGaits:
    @pytest.mark.parametrize(
        ("vary", "target"), [([], {}), (["stance_torque", "stiffness"], {"flight_time": 0.195, "stance_time": 0.36})]
    )
    def test_the_same_hop(self, robot, monkeypatch, vary, target):
        assert_same(*both(monkeypatch, hopping(robot), vary, target))

    def test_the_reference_engine_checks_alone(self, robot, monkeypatch):
        """No cycle of it is differenced, and none is settled by it: it runs the gait once, and the cycle after it."""
        counted = []
        monkeypatch.setattr(
            "spear_pin.gaits.attempts.return_map", lambda *asked: counted.append(1) or return_map(*asked)
        )
        monkeypatch.setattr(periodic, "differentiate_return_map", lambda *_: pytest.fail("differenced"))
        find_gait(hopping(robot), ["stance_torque"], {"flight_time": 0.2})
        assert len(counted) == 1

    def test_multipliers_are_exact(self, hop):
        """Those of the reference engine's differences are off by what those are."""
        found = find_gait(hop.system, guess=hop.state).multipliers
        y = np.concatenate(hop.state)
        system, recorder = hop.system, Recorder(hop.system)
        whole = differentiate_cycle(system, recorder, y, np.eye(len(y)), np.zeros((len(recorder.numbers), len(y))))
        off_section = np.linalg.eigvals(whole.dy)
        for value in found:
            assert np.abs(off_section - value).min() < 1e-9
        np.testing.assert_allclose(
            found, eigenvalues(differentiate_return_map(system, hop.state, 1e-12)), rtol=0, atol=1e-7
        )

    def test_a_name_by_which_a_system_means_another_measure(self, robot):
        system = replace(hopping(robot), measures={"flight_time": lambda run: run.durations["flight"] - 0.004})
        gait = find_gait(system, ["stance_torque"], {"flight_time": 0.2})
        assert gait.durations["flight"] == pytest.approx(0.204, abs=1e-8)

    @pytest.mark.slow
    def test_the_same_bound(self, monkeypatch):
        gait = Gait.load("long_stride")
        asked = gait.system, ["posterior_hip_torque"], {"mean_speed": 2.51}
        assert_same(*both(monkeypatch, *asked, guess=gait.state), tolerance=2e-9)

    @pytest.mark.slow
    def test_the_same_series_hop(self, monkeypatch):
        system = series_hopping(load("spear_ii_series", locked=["boom_x"]))
        assert_same(*both(monkeypatch, system), tolerance=2e-9)


class TestLeftToTheReferenceEngine:
    def test_without_the_engine(self, robot, monkeypatch):
        monkeypatch.setattr(taylor, "available", lambda: False)
        assert tangent_cycles(hopping(robot), (), ()) is None

    def test_what_no_lanes_run(self, robot):
        assert tangent_cycles(with_dry_friction(hopping(robot), {"boom_z": 5.0}), (), ()) is None

    def test_measures_of_ones_own(self, robot):
        assert tangent_cycles(hopping(robot), ("stance_torque",), (lambda run: 0.0,)) is None

    def test_numbers_that_are_not_compiled(self, robot):
        assert tangent_cycles(hopping(robot), ("damping",), ()) is not None
        assert tangent_cycles(hopping(robot, spring=Spring(damping=0.0)), ("damping",), ()) is None

    def test_a_cycle_without_derivatives(self, hop):
        """A leg that falls, and a number out of its range: what is asked in their stead says why."""
        cycles = tangent_cycles(hop.system, ("stiffness",), ())
        q, v = (part[None] for part in hop.state)
        for stiffness in (0.5, -1.0):
            values = np.array([[stiffness]])
            assert cycles.otherwise(lambda *asked: asked)(ONE, q, v, values) == (ONE, q, v, values)
            assert np.isnan(cycles.slopes(ONE, q, v, values)[0]).all()


@pytest.mark.slow
def test_names_mean_what_the_system_says(hop):
    """Of the cycle of each, all measures that both know."""
    bound = Gait.load("least_effort")
    for gait in (hop, bound):
        names = tuple(name for name in gait.system.measures if name != "mean_speed" or gait is bound)
        cycles = tangent_cycles(gait.system, (), names)
        after = cycles.otherwise(lambda *_: pytest.fail("not known"))(
            ONE, *(x[None] for x in gait.state), np.empty((1, 0))
        )
        result = return_map(gait.system, gait.state, 1e-11)
        assert len(names) >= 3
        expected = [gait.system.measures[name](result) for name in names]
        np.testing.assert_allclose(after.measured[0], expected, rtol=0, atol=1e-8)


def test_follows_from_the_air_to_the_section(hop):
    """As the reference engine, with what is latched on the way."""
    system, guess = hop.system, hop.system.guess()
    moment = Moment(*guess, *starting_phase(system, guess))
    in_the_air = moment.phase == "flight"
    cycles = tangent_cycles(system, (), ())
    for _ in range(3):
        moment = cycles.follow(moment, np.empty(0))
    expected = run(system, guess, 3 - in_the_air, Options(1e-11))
    np.testing.assert_allclose(np.concatenate([moment.q, moment.v]), np.concatenate(expected.state), rtol=0, atol=1e-7)
    assert moment.held == pytest.approx(dict(expected.held), abs=1e-7)
