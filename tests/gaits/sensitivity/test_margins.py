"""Margins to another order of events: of a hop known from elsewhere, and derivatives against gaits nearby."""

from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Gait, find_gait, simulate
from spear_pin.gaits.sensitivity import margins as module
from spear_pin.gaits.sensitivity.closing import close_cycle, find_changed
from spear_pin.gaits.sensitivity.margins import margins, of_motion
from spear_pin.gaits.sensitivity.orbit import Orbit, branch
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.tangent.collocation import TAIL, Fineness
from spear_pin.hybrid.tangent.cycle import differentiate_cycle
from spear_pin.hybrid.tangent.record import Recorder

pytestmark = pytest.mark.extra("heyoka")
VARY, KEEP, OVER = ("stance_torque",), {"flight_time": 0.2}, ("stiffness", "knee_ratio", "friction")


@pytest.fixture(scope="module")
def begun(hop):
    return close_cycle(Orbit(hop.system, hop.state, (*VARY, *OVER)), KEEP)


def test_the_chain_is_all_but_slack_as_the_toe_leaves(hop, begun):
    """Against the sampled trajectory: the knee at lift-off less the angle that touchdown latched."""
    run = simulate(hop.system, hop.state, 1, progress=False)
    knee = run.coordinates.index("knee")
    flight = run.named("lift_off")[0]
    left = flight.q[knee] - hop.state[0][knee]
    assert begun.margins["spring_switch"].value == pytest.approx(left, abs=1e-8)
    assert left == pytest.approx(5.46e-3, abs=1e-5)


def test_margins_of_what_begins_on_zero_are_not_zero(begun):
    """Touchdown as the toe leaves, the spring as it engages, stick as the toe begins to slide."""
    assert "touchdown" not in begun.margins
    assert all(margin.value > 1e-4 for margin in begun.margins.values())


def test_before_an_event_only_motion_up_to_it_counts(hop, begun):
    """Against samples: the toe's load until the torque switches; after that it is less, as the toe slides off."""
    run = simulate(hop.system, hop.state, 1, samples=500, progress=False)
    first = (run.phase == "stance") & (run.t - run.t[0] < 0.5 / hop.system.law.frequency)
    before = begun.margins_before("torque_switch")
    assert before["lift_off"].value == pytest.approx(run.force[first, 0, 1].min(), rel=1e-4)
    assert begun.margins["lift_off"].value < 0.5 * before["lift_off"].value
    assert begun.margins_before("lift_off")["lift_off"].value == begun.margins["lift_off"].value
    assert begun.margins_before("touchdown")["lift_off"].value == 0.0


@pytest.mark.parametrize(("happens", "values"), [(True, [5.0, 2.0]), (False, [5.0, 2.0, 7.0, 0.5])])
def test_what_an_event_comes_near_to_on_its_way(monkeypatch, happens, values):
    """A guard that falls to 2, rises, and ends low: if it happens there, the end is no margin, nor is the top."""
    guard = SimpleNamespace(name="lift_off", observes=False, tolerance=0.0, waits=False)
    arc = SimpleNamespace(domain=SimpleNamespace(guards=(guard,)), event=guard if happens else None)
    course = [5.0, 2.0, 7.0, 0.5]
    monkeypatch.setattr(module, "long", lambda motion: motion)
    monkeypatch.setattr(module, "evaluate_guard", lambda stretch, g: SimpleNamespace(values=np.array(course)))
    monkeypatch.setattr(module, "extremes_of", lambda pieces: iter([(each, np.zeros(1)) for each in course]))
    found = [value for _, value, _ in of_motion([SimpleNamespace(arc=arc)])]
    assert found == values


def along(begun, found, name, j):
    return found.derivative @ branch(begun, list(KEEP))[:, j]


@pytest.mark.parametrize("j", range(len(OVER)))
def test_derivatives_against_gaits_nearby(begun, j):
    name, value = OVER[j], number(begun.system, OVER[j])
    h = 2e-4 * value
    others = dict.fromkeys(OVER, 0.0)
    ends = [find_changed(begun, KEEP, {**others, name: k * h}) for k in (1, -1, 2, -2)]

    for margin, found in begun.margins.items():
        a, b, c, d = (each.margins[margin].value for each in ends)
        expected = (8.0 * (a - b) - (c - d)) / 12.0
        scale = max(abs(found.value), 1e-3)
        assert h * along(begun, found, margin, j) == pytest.approx(expected, rel=1e-5, abs=1e-9 * scale)


def test_an_event_at_once_by_derivatives_against_gaits_nearby(hop):
    """With less torque the toe lifts off as that switches, the time of which moves with the frequency."""
    other, over = find_gait(with_numbers(hop.system, {"stance_torque": 6.5})), ("stiffness", "frequency")
    begun = close_cycle(Orbit(other.system, other.state, over), {})
    _, found, change = at_once(begun)
    assert found == pytest.approx(-begun.cycle.stretches[-2].end.guards[0]) and found > 1.0
    for j, name in enumerate(over):
        h = 2e-4 * number(begun.system, name)
        others = dict.fromkeys(over, 0.0)
        a, b, c, d = (at_once(find_changed(begun, {}, {**others, name: k * h}))[1] for k in (1, -1, 2, -2))
        along = change @ branch(begun, ())[:, j]
        assert h * along == pytest.approx((8.0 * (a - b) - (c - d)) / 12.0, rel=1e-5, abs=1e-9 * found)


def test_panels_do_not_matter():
    """A guard that rises from zero is nowhere less than where its domain is left, or turns."""
    gait = Gait.load("force_lift_off")
    orbit = Orbit(gait.system, gait.state, ("posterior_hip_torque",))
    start, seeds = np.concatenate(gait.state), orbit.seeds
    coarse = margins(
        differentiate_cycle(gait.system, Recorder(gait.system), start, orbit.start, seeds, Fineness(100.0 * TAIL, 6))
    )
    fine = margins(differentiate_cycle(gait.system, Recorder(gait.system), start, orbit.start, seeds))
    assert list(coarse) == list(fine)
    for name, margin in fine.items():
        assert coarse[name].value == pytest.approx(margin.value, rel=1e-6), name
        scale = np.abs(margin.derivative).max()
        np.testing.assert_allclose(coarse[name].derivative, margin.derivative, rtol=0, atol=1e-5 * scale, err_msg=name)


def at_once(orbit):
    """The last but one arc's only margin, of lift-off at once."""
    stretch = orbit.cycle.stretches[-2]
    assert stretch.at_once and stretch.arc.event.name == "lift_off" and not stretch.late
    (margin,) = of_motion([stretch])
    return margin
