"""Records of cycles in space: the reference engine makes the first ones, then compiled code does."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.tangent import record
from spear_pin.hybrid.tangent.record import Recorder
from spear_pin.hybrid.tangent.reference_runner import ReferenceRunner

pytestmark = [pytest.mark.extra("heyoka"), pytest.mark.slow]


@pytest.fixture
def ran(monkeypatch):
    """Notes which engine runs a cycle."""
    found = []
    for runner in (LoneRunner, ReferenceRunner):

        def noted(self, *asked, lap=runner.lap, kind=runner):
            found.append(kind)
            return lap(self, *asked)

        monkeypatch.setattr(runner, "lap", noted)
    record.by_reference.cache_clear()
    return found


def test_the_second_way_takes_over_and_agrees(ran, monkeypatch):
    monkeypatch.setattr(record, "CYCLES", 1)
    gait = Gait.load("trot")
    y, laps = np.concatenate(gait.state), []
    for _ in range(2):
        laps.append(Recorder(gait.system).lap(y))
    slow, fast = laps
    assert ran == [ReferenceRunner, LoneRunner]
    np.testing.assert_allclose(fast.y, slow.y, rtol=0, atol=1e-9)
    assert fast.order == slow.order and fast.phase == slow.phase
    assert [arc.domain.name for arc in fast.arcs] == [arc.domain.name for arc in slow.arcs]
    for one, other in zip(fast.arcs, slow.arcs, strict=True):
        assert one.end == pytest.approx(other.end, abs=1e-10)
        if one.motion is not None and one.end > one.t:
            times = np.linspace(one.t, one.end, 7)
            np.testing.assert_allclose(one.motion(times), other.motion(times), rtol=0, atol=1e-8)


def test_without_heyoka_it_never_takes_over(ran, monkeypatch):
    monkeypatch.setattr(record, "CYCLES", 0)
    monkeypatch.setattr(taylor, "available", lambda: False)
    gait = Gait.load("trot")
    Recorder(gait.system).lap(np.concatenate(gait.state))
    assert ran == [ReferenceRunner]
