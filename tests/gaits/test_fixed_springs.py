"""Q-SPEAR with knee springs that are never let go."""

import numpy as np
import pytest

from spear_pin import Spring, bounding, simulate, simulate_many
from tests.gaits.bounding_gaits import gait
from tests.hybrid.lanes import assert_agree, compiles

REST = np.radians(40.0)
SPRINGS = {
    "both ways": Spring(30.0, damping=0.0, rest=REST, unilateral=False),
    "one way": Spring(30.0, damping=0.0, rest=1.0),
    "damped": Spring(30.0, damping=0.4, rest=REST, unilateral=False),
}
each_spring = pytest.mark.parametrize("spring", SPRINGS.values(), ids=SPRINGS)


def sprung(spring):
    own = gait("long_stride").system
    return bounding(own.robot, own.law, spring), gait("long_stride").state


class TestFixedSprings:
    @each_spring
    def test_energy_is_kept_and_none_is_released(self, spring):
        system, state = sprung(spring)
        stride = simulate(system, state, 1, progress=False)
        assert stride.reason == "complete" and np.abs(stride.ledger.residual).max() < 1e-8
        assert not any(event.work.get("released") for event in stride.events)

    @each_spring
    def test_torque_in_every_phase(self, spring):
        system, state = sprung(spring)
        stride = simulate(system, state, 1, progress=False)
        for i, (knee, side) in enumerate([(4, 1.0), (6, -1.0)]):
            deflection = side * stride.q[:, knee] - spring.rest
            pulls = (deflection > 0) | (not spring.unilateral)
            expected = -side * np.where(pulls, 30.0 * deflection, 0.0)  # the damper's is not in it
            np.testing.assert_allclose(stride.spring[:, i], expected, rtol=0, atol=1e-8)
        assert ("spring_switch" in {event.name for event in stride.events}) == spring.unilateral

    @each_spring
    def test_a_run_begins_in_the_air(self, spring):
        system, (q, v) = sprung(spring)
        fall = simulate(system, (q + 0.05 * np.eye(7)[1], v), 1, progress=False)
        assert fall.reason == "complete" and np.abs(fall.ledger.residual).max() < 1e-8

    def test_dampers_act_in_stance_only(self):
        for domain in sprung(SPRINGS["damped"])[0].domains:
            closed = [contact != "open" for contact in domain.contacts]
            assert [mount.spring.damping for mount in domain.mounts] == [0.4 * bears for bears in closed], domain.name

    def test_the_motor_of_a_bearing_leg_gives_what_the_spring_does_not(self):
        """So the first stance is that without a spring, to rounding; in the air outputs are imposed all the same."""
        with_spring, state = sprung(SPRINGS["both ways"])
        bare = bounding(with_spring.robot, with_spring.law, Spring(0.0, damping=0.0))
        runs = [simulate(system, state, 1, progress=False) for system in (with_spring, bare)]
        np.testing.assert_allclose(runs[0].q[-1], runs[1].q[-1], rtol=0, atol=1e-7)
        assert np.abs(runs[0].u[:, 1] - runs[1].u[:, 1]).max() > 5.0

    @compiles
    @each_spring
    def test_lanes(self, spring):
        system, (q, v) = sprung(spring)
        found = simulate_many(system, q[None], v[None], 1)
        assert_agree(system, q[None], v[None], found)
