"""SPEAR-II with a knee spring that is never let go, and with a motor that imitates the spring."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Spring, hopping, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.hopping import flight_law


@pytest.fixture(scope="module")
def latched(hop):
    return float(simulate(hop.system, hop.state).named("touchdown")[-1].q[-1])


class TestOtherKnees:
    """The same hop with a spring that is never let go, and with a motor that imitates the spring."""

    def test_imitated_spring(self, robot, hop):
        """Nothing moves differently, and the motor gives what motor and spring gave."""
        law = replace(hop.system.law, virtual_stiffness=48.84)
        imitated = hopping(robot, law, Spring(stiffness=0.0, damping=1.3))
        both = [simulate(system, hop.state, 2) for system in (hop.system, imitated)]
        np.testing.assert_allclose(both[1].q[-1], both[0].q[-1], atol=1e-9)
        np.testing.assert_allclose(both[1].tau, both[0].tau, atol=1e-6)
        assert np.abs(both[1].u[:, 1]).max() > 4 * np.abs(both[0].u[:, 1]).max()
        assert np.abs(both[1].ledger.residual).max() < 1e-8

    def test_fixed_spring(self, robot, hop, latched):
        """With its rest where the other latches, and the motor bearing it in flight, the orbit is the same."""
        fixed = hopping(robot, hop.system.law, Spring(rest=latched))
        run = simulate(fixed, hop.state, 2)
        np.testing.assert_allclose(run.q[-1], hop.state[0], atol=1e-7)
        assert run.engaged.all() and not [event for event in run.events if event.work.get("released")]
        assert np.abs(run.ledger.residual).max() < 1e-8
        flight = run.phase == "flight"
        pulls = np.minimum(-48.84 * (run.q[flight, -1] - latched), 0.0)
        np.testing.assert_allclose(run.spring[flight, 0], pulls, atol=1e-6)
        states = zip(run.q[flight], run.v[flight], strict=True)
        lone = [flight_law(0.0, *state, {"speed": 0.0}, fixed.law, None, None) for state in states]
        np.testing.assert_allclose(run.u[flight, 1], np.array(lone)[:, 1] - pulls, atol=1e-6)

    def test_starts_in_the_air_with_its_spring(self, robot, hop):
        q, v = hop.state[0].copy(), np.zeros(3)
        q[0], q[2] = q[0] + 0.05, q[2] + 0.2
        run = simulate(hopping(robot, hop.system.law, Spring(rest=float(q[2]) - 0.1)), (q, v), rtol=1e-11)
        assert run.phase[0] == "flight" and run.spring[0, 0] == pytest.approx(-4.884, abs=1e-9)
        assert np.abs(run.ledger.residual).max(initial=0.0) < 1e-8

    @pytest.mark.parametrize("rest", [4.0, float("nan")])
    def test_bad_rest(self, rest):
        with pytest.raises(BadValue, match="^Spring.rest is "):
            Spring(rest=rest)

    def test_limit_of_the_force_with_an_imitated_spring(self, robot, hop):
        """Flexion is limited as with a real one: nothing moves differently."""
        law = replace(hop.system.law, minimum_force=12.0, hold_extension=True)
        real = hopping(robot, law, Spring(damping=1.3))
        imitated = hopping(robot, replace(law, virtual_stiffness=48.84), Spring(stiffness=0.0, damping=1.3))
        both = [simulate(system, hop.state, 2) for system in (real, imitated)]
        assert both[0].named("force_limit") and len(both[0].events) == len(both[1].events)
        np.testing.assert_allclose(both[1].q[-1], both[0].q[-1], atol=1e-8)
        np.testing.assert_allclose(both[1].tau, both[0].tau, atol=1e-5)
