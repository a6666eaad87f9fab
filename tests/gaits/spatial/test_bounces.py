"""Toes of legs that bear leave the ground and strike it again: the law goes on, and time does."""

import numpy as np
import pytest

from spear_pin import Contact, Gait, SpatialLaw, bounding_in_space, simulate
from spear_pin.gaits.spatial.automaton import CLEAR
from spear_pin.hybrid.contact import OPEN, STICK
from spear_pin.hybrid.reasons import REASONS
from tests.random_starts import draw_in_space, drop, quadruped


def dropped(seed):
    start, law = draw_in_space(seed), SpatialLaw(Gait.load("long_stride").system.law)
    system = bounding_in_space(quadruped(), law, contact=Contact(start.friction))
    return simulate(system, (np.array(start.q), np.array(start.v)), 1, 1e-8, progress=False)


@pytest.fixture(scope="module")
def bouncing():
    """A drop after whose landing legs bounce."""
    return dropped(5)


def test_phases_have_domains_with_each_bearing_toe_open_too():
    system = bounding_in_space(quadruped(), SpatialLaw(Gait.load("long_stride").system.law))
    contacts = {domain.contacts for domain in system.of_phase("posterior_stance")}
    assert (OPEN, STICK, OPEN, OPEN) in contacts and (OPEN, OPEN, OPEN, OPEN) in contacts
    assert len(contacts) == 9  # each of two toes sticks, slips or is open


def test_a_law_by_force_lifts_off_where_the_force_ends():
    system = bounding_in_space(quadruped(), SpatialLaw(Gait.load("force_lift_off").system.law))
    assert not any(domain.bouncing for domain in system.domains)


@pytest.mark.slow
def test_springs_stay_engaged_in_a_bounce(bouncing):
    toes, engaged = quadruped().toes, bouncing.engaged
    open_in = np.array([" open" in domain for domain in bouncing.domain])
    assert open_in.any()
    for i, toe in enumerate(toes):
        leg = toe.removesuffix("_toe")
        aloft = np.array([f"{leg} open" in domain for domain in bouncing.domain])
        assert (bouncing.force[aloft, i] == 0.0).all()
        heights = [quadruped().toe_position(q, toe)[2] for q in bouncing.q[aloft]]
        assert max(heights, default=0.0) < CLEAR + 1e-6
        assert engaged[aloft, i].any() or not aloft.any()


@pytest.mark.slow
def test_energy_is_booked_through_bounces(bouncing):
    if bouncing.cycles:
        assert np.abs(bouncing.ledger.residual).max() < 1e-5
    lost = [event.work["impact"] for event in bouncing.events if "impact" in event.work]
    assert lost and max(lost) < 1e-9


@pytest.mark.slow
@pytest.mark.parametrize("seed", [57, 62])
def test_where_other_toes_have_events_none_is_on_the_ground_before_it_has_struck_it(seed):
    dropping = dropped(seed)
    assert dropping.cycles and np.abs(dropping.ledger.residual).max() < 1e-6  # 8e-3 and 3e-5 J without


@pytest.mark.slow
def test_a_toe_that_slides_on_ever_more_slowly_is_stopped_in_time():
    assert drop(17).evaluations < 30_000  # its direction turns the faster the slower it is


@pytest.mark.slow
def test_drops_end_for_a_reason_that_is_not_of_numbers():
    found = [drop(seed) for seed in range(2)]  # the nightly has hundreds
    assert {one.reason for one in found} <= {*REASONS}
    assert all(one.finite and one.residual < 1e-6 for one in found)
    assert not [one for one in found if one.reason in ("step_size", "not_finite", "evaluation_cap", "zeno")]
