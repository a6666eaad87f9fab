"""Logs and legs that several tests share; whoever changes one makes another of it."""

from dataclasses import replace

import pytest

from spear_pin import hopping, load
from tests.studies.logs.crank_leg import configured, spring, synthetic


@pytest.fixture(scope="session")
def crank():
    """The crank leg's robot."""
    return load("crank_hopper")


@pytest.fixture(scope="session")
def bare(crank):
    """The leg without a spring."""
    return hopping(crank, spring={"leg": replace(spring(), stiffness=0.0)})


@pytest.fixture(scope="session")
def sprung(crank):
    """The leg with a spring that pushes and pulls."""
    return hopping(crank, spring={"leg": spring()})


@pytest.fixture(scope="session")
def plain_log(crank):
    """A log of three hops without a spring, and the trajectory."""
    return synthetic(configured(crank))
