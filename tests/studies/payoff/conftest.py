"""Motors that several tests share."""

import pytest

from spear_pin.studies.audit import knees


@pytest.fixture(scope="session")
def motors():
    """SPEAR-II's motors."""
    return knees.motors(knees.HOP)
