"""A cycle's derivatives: of the bounds against the reference engine's multipliers, compiled against interpreted."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.engines.structure import Structure
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.fields import tangent_field
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.hybrid.tangent.seeds import numbers, seeds

pytestmark = pytest.mark.extra("heyoka")
BOUNDS = ("long_stride", "least_effort", "force_lift_off")
OVER = ("posterior_leg_touchdown", "posterior_hip_torque", "torso_mass", "knee_ratio")
H = 2e-4


@pytest.mark.slow
@pytest.mark.parametrize("name", BOUNDS)
class TestBounds:
    def test_multipliers(self, name):
        gait = Gait.load(name)
        found = np.sort(np.abs(np.linalg.eigvals(Orbit(gait.system, gait.state, ()).jacobian)))[::-1]
        assert found[:4] == pytest.approx(np.abs(gait.multipliers)[:4], abs=2e-7)

    @pytest.mark.parametrize(
        "parameter", ["posterior_leg_touchdown", "posterior_hip_torque", "torso_mass", "knee_ratio"]
    )
    def test_states_after_a_cycle(self, name, parameter):
        gait = Gait.load(name)
        orbit = Orbit(gait.system, gait.state, (parameter,))
        value = number(gait.system, parameter)
        y = np.concatenate(gait.state)

        def end(step):
            recorder = Recorder(with_numbers(gait.system, {parameter: value + step}))
            return recorder.lap(y).y

        h = H * abs(value)
        expected = (8.0 * (end(h) - end(-h)) - (end(2.0 * h) - end(-2.0 * h))) / (12.0 * h)
        found = orbit.cycle.dy[:, orbit.dimension]
        assert found == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


def test_compiled_and_interpreted_say_the_same(hop):
    system, y = hop.system, np.concatenate(hop.state)
    recorder = Recorder(system)
    arcs = recorder.lap(y).arcs
    rng, own = np.random.default_rng(3), seeds(system, ["stiffness", "friction", "knee_mass"]).numbers
    for arc in arcs[:3]:
        field = tangent_field(Structure(system, arc.domain, arc.held, recorder.mechanism))
        raw = np.concatenate([numbers(system), list(arc.held.values())])
        directions = np.concatenate([own, rng.normal(size=(len(arc.held), 3))])
        given = np.array([arc.t]), arc.y[:, None], raw, 0.5, rng.normal(size=(len(y), 1, 3)), directions
        for one, other in zip(field.at(*given), field._interpreted(*given), strict=True):
            for a, b in zip(one, other, strict=True):
                assert a == pytest.approx(b, rel=1e-11, abs=1e-10)


def test_an_engine_that_goes_on_elsewhere_is_noticed(hop):
    """Where the engine's impact is not the one that is differentiated, there is no derivative."""

    class Elsewhere(Recorder):
        def lap(self, y):
            record = super().lap(y)
            first, *others = record.arcs
            lasting = next(i for i, arc in enumerate(others) if others[i - 1].event is not None and i)
            others[lasting] = others[lasting]._replace(y=others[lasting].y + 1e-5)
            return replace(record, arcs=[first, *others])

    y = np.concatenate(hop.state)
    still = np.zeros((len(numbers(hop.system)), 1))
    assert differentiate_cycle(hop.system, Recorder(hop.system), y, np.zeros((len(y), 1)), still).y.shape == y.shape
    with pytest.raises(NotDifferentiable, match="by its rule"):
        differentiate_cycle(hop.system, Elsewhere(hop.system), y, np.zeros((len(y), 1)), still)


def test_domains_of_two_phases_may_have_one_name(hop):
    names = {domain.key: f"{i}" for phase in hop.system.phases for i, domain in enumerate(hop.system.of_phase(phase))}
    domains = tuple(replace(domain, name=names[domain.key]) for domain in hop.system.domains)
    assert len({domain.name for domain in domains}) < len(domains)
    other = Orbit(replace(hop.system, domains=domains), hop.state, ())
    np.testing.assert_allclose(other.jacobian, Orbit(hop.system, hop.state, ()).jacobian, rtol=0, atol=1e-12)
