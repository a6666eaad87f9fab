"""One hop and its page, shared by the tests."""

from __future__ import annotations

from types import SimpleNamespace

import pytest

from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from spear_pin.viz import player
from tests.viz import samples
from tests.viz.recording import Recording, read


@pytest.fixture(scope="session")
def spear() -> Robot:
    return load("spear_ii")


@pytest.fixture(scope="session")
def hop() -> SimpleNamespace:
    return samples.hop(start=3.0)


@pytest.fixture(scope="session")
def hop_page(spear: Robot, hop: SimpleNamespace) -> str:
    return player.page(spear, hop, title="A hop")


@pytest.fixture(scope="session")
def recording(hop_page: str) -> Recording:
    return read(hop_page)
