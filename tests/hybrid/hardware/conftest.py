"""Hops with hardware and without."""

from functools import cache

import pytest

from spear_pin import simulate
from spear_pin.hybrid.hardware import Hardware
from spear_pin.hybrid.parameters import with_hardware


@pytest.fixture(scope="package")
def run(hop):
    """Hops with hardware, each run once."""

    @cache
    def hops(hip, knee=None, sensing=None, cycles=2, rtol=1e-11):
        system = with_hardware(hop.system, Hardware((hip, knee or hip), sensing))
        trajectory = simulate(system, hop.state, cycles, rtol)
        assert trajectory.complete, trajectory.message
        return trajectory

    return hops


@pytest.fixture(scope="package")
def clean(hop):
    return simulate(hop.system, hop.state, 2, 1e-11)
