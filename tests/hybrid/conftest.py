"""The hop on slippery ground, and the Lagrangian along trajectories that many tests look at."""

import pytest

from spear_pin import Contact, simulate
from tests.hybrid.motions import terms_of


@pytest.fixture(scope="session")
def terms(hops):
    """What the symbolic Lagrangian gives at every sample of the eleven hops."""
    return terms_of(hops)


@pytest.fixture(scope="session")
def slipping(free_hop):
    """The hop with boom_x free on slippery ground."""
    system = free_hop.system.build(free_hop.system.robot, free_hop.system.law, contact=Contact(0.3))
    trajectory = simulate(system, free_hop.state, cycles=4)
    assert trajectory.complete
    return trajectory


@pytest.fixture(scope="session")
def slipping_terms(slipping):
    """What the symbolic Lagrangian gives at every sample of the hop on slippery ground."""
    return terms_of(slipping)
