"""A server of the hop's page, and a browser."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from spear_pin.cli.explored import write_script
from spear_pin.studies.explore.engines import best_engine
from spear_pin.studies.explore.legs import spear_ii_hop
from spear_pin.viz.explore.server import Explorer, Server
from tests.viz.chromium import Browser
from tests.viz.explore.exploring import serving


@pytest.fixture(scope="package")
def server() -> Iterator[Server]:
    with serving(Explorer(spear_ii_hop(), best_engine(), write_script)) as started:
        yield started


@pytest.fixture(scope="package")
def browser() -> Iterator[Browser]:
    with Browser(1280, 900) as started:
        yield started
