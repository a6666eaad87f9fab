"""Runs whose motion compiled code integrates, beside those of SciPy."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Clutch, Contact, Gait, HoppingLaw, Spring, hopping, load, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.domain import Guard
from spear_pin.hybrid.dry_friction import with_dry_friction
from tests.slow import slow_but

pytestmark = pytest.mark.extra("heyoka")

LATE = Spring(clutch=Clutch(on_delay=0.004, off_delay=0.004, damper="joint"))
CRANK = HoppingLaw(-0.35, stance_torque=0.7, frequency=5.0, knee_gain=6.0, knee_damping=0.15, hold_extension=True)


@pytest.fixture(scope="module")
def leg():
    return load("spear_ii", locked=["boom_x"])


MOTIONS = {
    "hop": lambda leg: starting(hopping(leg)),
    "late switch": lambda leg: starting(hopping(leg, spring=LATE)),
    "slips and falls": lambda leg: starting(hopping(load("spear_ii"), contact=Contact(friction=0.3))),
    "chatters and falls": lambda leg: starting(hopping(leg, spring=Spring(damping=0.0))),
    "loop": lambda leg: starting(hopping(load("crank_hopper"), CRANK)),
    "pushed bound": lambda leg: pushed("long_stride", 0.8),
    "trot": lambda leg: pushed("trot", 0.05),
}


def starting(system):
    return system, system.guess()


def pushed(name, rate):
    gait = Gait.load(name)
    q, v = gait.state
    return gait.system, (q, v + rate * np.eye(len(v))[2])


IN_AN_INSTANT = {"loop": "slip"}
"""Events that happen in the instant of another, or not, by rounding."""


def apart(events, name):
    """The events without those of a name that happen in the instant of another."""
    others = np.array([event.time for event in events if event.name != name])
    return [event for event in events if event.name != name or np.abs(others - event.time).min() > 1e-8]


@pytest.mark.parametrize("name", slow_but(MOTIONS, "hop"))
def test_motion_is_that_of_the_reference(leg, name):
    system, state = MOTIONS[name](leg)
    one, other = (simulate(system, state, cycles=2, engine=engine) for engine in ("reference", "compiled"))
    assert one.reason == other.reason
    events = [apart(run.events, IN_AN_INSTANT.get(name)) for run in (one, other)]
    assert [event.name for event in events[0]] == [event.name for event in events[1]]
    for ours, theirs in zip(*events, strict=True):
        assert theirs.time == pytest.approx(ours.time, abs=2e-9)
        np.testing.assert_allclose(theirs.v, ours.v, rtol=0, atol=2e-7)
    np.testing.assert_allclose(other.q[-1], one.q[-1], rtol=0, atol=2e-8)
    np.testing.assert_allclose(other.ledger.work, one.ledger.work, rtol=0, atol=1e-7)
    if one.cycles:
        assert (np.abs(other.ledger.residual) < 1e-9 * np.abs(other.ledger.work).sum(axis=1)).all()


def test_samples_are_those_of_the_reference(leg):
    system, state = MOTIONS["hop"](leg)
    one, other = (simulate(system, state, cycles=2, engine=engine) for engine in ("reference", "compiled"))
    for column in ("t", "q", "v", "a", "u", "force"):
        np.testing.assert_allclose(getattr(other, column), getattr(one, column), rtol=1e-7, atol=1e-6)
    assert len(other.named("apex")) == len(one.named("apex")) == 2


def test_what_cannot_be_compiled_is_refused(leg):
    system = hopping(leg)
    for option in ({"sample_time": 0.001}, {"max_step": 0.001}):
        with pytest.raises(BadValue, match="sample_time or a max_step"):
            simulate(system, system.guess(), **option, engine="compiled")
    with pytest.raises(BadValue, match="dry friction"):
        simulate(with_dry_friction(system, {"knee": 0.5}), system.guess(), engine="compiled")
    with pytest.raises(BadValue, match="engine"):
        simulate(system, system.guess(), engine="taylor")


def test_events_that_are_observed_together_are_both_told(leg):
    """Also the apex, which measures need, beside an event of one's own at the same instant."""
    system = hopping(leg)
    extra = [Guard(name, lambda t, q, v, held, p, dyn, ops: 0.05 - t) for name in ("one", "other")]
    observed = replace(
        system,
        domains=tuple(
            replace(each, guards=(*each.guards, *extra)) if each.phase == "flight" else each for each in system.domains
        ),
    )
    runs = [simulate(observed, observed.guess(), engine=engine) for engine in ("reference", "compiled")]
    assert [[event.name for event in run.events] for run in runs][0] == [event.name for event in runs[1].events]
    assert {"one", "other"} <= {event.name for event in runs[1].events}


def test_evaluations_are_counted(leg):
    system = hopping(leg)
    assert simulate(system, system.guess(), max_evaluations=100, engine="compiled").reason == "evaluation_cap"
