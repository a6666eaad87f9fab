"""The motion of a recorded cycle, against a run of the reference engine."""

import numpy as np
import pytest

from spear_pin import Gait
from spear_pin.hybrid.arc import motion_of
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.simulate import sample
from spear_pin.hybrid.tangent.record import many
from spear_pin.hybrid.tangent.reference_runner import ReferenceRunner

RUNNERS = [
    pytest.param(ReferenceRunner, id="reference"),
    pytest.param(
        lambda system: LoneRunner(many(system, {}), 0, keep=True), marks=pytest.mark.extra("heyoka"), id="compiled"
    ),
]


def off(ran, t, y):
    """How far a state is from that of a run at a time, whose sides of an event are both right."""
    found = []
    for segment in ran.segments:
        for piece in segment.pieces:
            begin, end = segment.began + piece.begin, segment.began + piece.end
            if begin - 1e-9 <= t <= end + 1e-9:
                there = np.ravel(piece.state(np.array([min(max(t, begin), end) - segment.began])))
                found.append(np.abs(there[: len(y)] - y).max())
    return min(found)


@pytest.mark.parametrize("runner", RUNNERS)
@pytest.mark.parametrize("name", ["hop", "bound"])
def test_it_is_sampled_as_a_run_is(request, name, runner):
    gait = request.getfixturevalue("hop") if name == "hop" else Gait.load("long_stride")
    ran = run(gait.system, gait.state, 1, Options(1e-12, keep=True))
    record = runner(gait.system).lap(ran.segments[0].domain.phase, np.concatenate(gait.state), ran.segments[0].held)
    motion = motion_of(gait.system.domains, gait.state, record)
    found, expected = sample(gait.system, motion), sample(gait.system, ran)
    assert found.cycles == 1 and found.reason == "complete" and found.events == () and not len(found.ledger.work)
    assert {phase: s for phase, s in motion.durations.items() if s} == pytest.approx(dict(ran.durations), abs=1e-9)
    assert list(dict.fromkeys(found.domain)) == list(dict.fromkeys(expected.domain))
    assert max(off(ran, t, y) for t, y in zip(found.t, np.hstack([found.q, found.v]), strict=True)) < 1e-9
    assert np.abs(found.force[-1] - expected.force[-1]).max() < 1e-6 * gait.system.robot.weight
    for column in ("tau", "force", "spring"):  # which the law gives at each sample
        peaks = [np.abs(getattr(each, column)).max() for each in (found, expected)]
        assert peaks[0] == pytest.approx(peaks[1], rel=1e-4), column
