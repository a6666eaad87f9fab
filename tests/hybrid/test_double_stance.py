"""Two toes on the ground: both take part in an impact, each leaves in its own way."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
import sympy as sp

from spear_pin import Contact, HoppingLaw, Spring, hopping, load, simulate
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN, STICK
from spear_pin.hybrid.domain import Domain, Guard, Reset
from spear_pin.hybrid.engines.taylor import Code
from spear_pin.hybrid.lanes.groups import Group
from spear_pin.hybrid.lanes.impacts import strike
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.phases import contact_domains, fall, touchdown
from spear_pin.hybrid.rules.guards import rise, stays
from spear_pin.hybrid.rules.impact import joint_impact, plastic_impact

ROBOT = load("q_spear")
TOES = POSTERIOR, ANTERIOR = ROBOT.toes
POSTURE = (0.4, 0.8, 0.4, 0.8)
LEGS = {POSTERIOR: "posterior", ANTERIOR: "anterior"}


def hold(t, q, v, held, p, dyn, ops):
    """Damp the joints."""
    return [-5.0 * rate for rate in v[3:]]


def standing(contact):
    """Q-SPEAR with limp legs: in the air, on one pair of them, or on both."""

    def domain(name, *closed):
        return Domain(name, name, tuple(STICK if toe in closed else OPEN for toe in TOES), hold)

    def lands(toe, phase):
        return replace(touchdown(toe, Reset(impact=(toe,), phase=phase)), name=f"{LEGS[toe]}_touchdown")

    fallen = fall(["posterior_hip", "anterior_hip"])
    flight = replace(domain("flight"), guards=(*(lands(toe, name) for toe, name in LEGS.items()), *fallen))
    domains = []
    for toe, other in (TOES, TOES[::-1]):
        single = replace(domain(LEGS[toe], toe), guards=(lands(other, "double"), *fallen))
        domains += contact_domains(single, TOES, {toe: Reset(phase="flight")})
    lift_off = {POSTERIOR: Reset(phase="anterior"), ANTERIOR: Reset(phase="posterior")}
    domains += contact_domains(replace(domain("double", *TOES), guards=fallen), TOES, lift_off)
    return HybridSystem(
        kind="standing",
        robot=ROBOT,
        law=HoppingLaw(),
        springs={"knee": Spring()},
        contact=contact,
        domains=(*domains, flight),
        section="posterior_touchdown",
        cyclic=("torso_x",),
        build=standing,
        guess=lambda: dropped(0.0),
        phase_limit=1.0,
    )


def dropped(pitch, spin=0.0, speed=0.0, posture=POSTURE):
    """Falling, its lower toe 2 cm above the ground."""
    q = np.array([0.0, 1.0, pitch, *posture])
    q[1] += 0.02 - min(ROBOT.toe_position(q, toe)[1] for toe in TOES)
    return q, np.array([speed, -0.5, spin, 0.0, 0.0, 0.0, 0.0])


def follow(pitch, spin=0.0, speed=0.0, friction=0.8, posture=POSTURE):
    state = dropped(pitch, spin, speed, posture)
    return simulate(standing(Contact(friction)), state, 1, 1e-8, max_evaluations=20_000)


CASES = [
    (0.1, 0.0, 0.0, 0.8),
    (-0.1, 0.0, 0.0, 0.8),
    (0.1, 2.0, 0.5, 0.8),
    (-0.15, 1.0, -1.0, 0.3),
    (0.05, -3.0, 1.0, 2.0),
]  # pitch, spin, speed, friction


LIFTING = [
    (0.13, 3.3, 0.4, 2.0, (0.5, -0.1, -0.5, -0.6)),
    (0.13, 3.9, 1.4, 0.1, (0.7, 0.9, -0.3, 0.7)),
    (0.01, -3.3, 1.9, 2.0, (0.4, 0.4, -0.3, 0.3)),
    (0.12, -0.1, 2.0, 0.8, (0.8, -0.4, 0.4, -0.2)),
]  # the same, and a posture in which one foot coming down lifts the other


def joint_impacts(trajectory):
    """Impacts from one pair of legs onto both."""
    return [e for e in trajectory.events if e.name.endswith("touchdown") and not e.domain.startswith("flight")]


class TestImpact:
    @pytest.mark.parametrize("case", CASES)
    def test_both_toes_take_part(self, case):
        trajectory = follow(*case)
        found = joint_impacts(trajectory)
        assert found, [e.name for e in trajectory.events]
        for event in found:
            D, J = ROBOT.mass_matrix(event.q), np.concatenate([ROBOT.toe_jacobian(event.q, toe) for toe in TOES])
            expected = joint_impact(D, J, event.v_before, case[-1])
            np.testing.assert_array_equal(event.v, expected.v)
            np.testing.assert_array_equal(event.impulse, expected.impulse)
            np.testing.assert_allclose(D @ (event.v - event.v_before), J.T @ event.impulse.ravel(), rtol=0, atol=1e-10)
            lost = 0.5 * event.v_before @ D @ event.v_before - 0.5 * event.v @ D @ event.v
            assert -event.work["impact"] == pytest.approx(lost, rel=0, abs=1e-10) and lost >= 0.0
            assert ((J @ event.v)[1::2] > -1e-9).all()

    @pytest.mark.parametrize("case", CASES)
    def test_the_first_toe_strikes_alone(self, case):
        event = follow(*case).events[0]
        (index,) = np.flatnonzero(event.impulse.any(axis=1))
        alone = plastic_impact(
            ROBOT.mass_matrix(event.q), ROBOT.toe_jacobian(event.q, TOES[index]), event.v_before, case[-1]
        )
        np.testing.assert_array_equal(event.v, alone.v)
        np.testing.assert_array_equal(event.impulse[index], alone.impulse)

    def test_a_toe_that_the_impact_lifts_off_leaves_at_once(self):
        left = []
        for case in LIFTING:
            events = follow(*case).events
            for event, following in pairwise(events):
                rises = {toe: (ROBOT.toe_jacobian(event.q, toe) @ event.v)[1] for toe in TOES}
                toe = max(TOES, key=lambda toe: rises[toe])
                if rises[toe] > 1e-5 and event.impulse.any() and not event.domain.startswith("flight"):
                    assert (following.name, following.time) == (f"{LEGS[toe]}_lift_off", event.time)
                    np.testing.assert_array_equal(following.v, event.v)
                    np.testing.assert_array_equal(event.impulse[TOES.index(toe)], 0.0)
                    left.append(toe)
        assert set(left) == set(TOES)

    def test_toes_that_strike_together(self):
        """Level, both at once: as one impact."""
        trajectory = follow(0.0)
        system = standing(Contact())
        domains = tuple(
            replace(
                domain,
                guards=(replace(touchdown(POSTERIOR, Reset(impact=TOES, phase="double")), name="posterior_touchdown"),),
            )
            if domain.name == "flight"
            else domain
            for domain in system.domains
        )
        together = simulate(replace(system, domains=domains), dropped(0.0), 1, 1e-8, max_evaluations=20_000).events[0]
        assert together.impulse[:, 1].min() > 0.0
        D, J = ROBOT.mass_matrix(together.q), np.concatenate([ROBOT.toe_jacobian(together.q, toe) for toe in TOES])
        np.testing.assert_array_equal(together.v, joint_impact(D, J, together.v_before, 0.8).v)
        assert trajectory.events[0].time == pytest.approx(together.time, abs=1e-9)


class TestDomains:
    def test_each_toe_leaves_in_its_own_way(self):
        double = standing(Contact()).of_phase("double")
        assert len(double) == 9 and len({domain.name for domain in double}) == 9
        assert double[0].contacts == (STICK, STICK)
        assert double[1].name == "double anterior slip+"
        for domain in double:
            phases = {guard.name: guard.reset.phase for guard in domain.guards if guard.name.endswith("lift_off")}
            assert phases == {"posterior_lift_off": "anterior", "anterior_lift_off": "posterior"}

    def test_one_reset_for_all_toes(self):
        both = Domain("double", "double", (STICK, STICK), hold)
        reset = Reset(phase="flight")
        for domain in contact_domains(both, TOES, reset):
            leave = [guard for guard in domain.guards if guard.reset is reset]
            assert {guard.name for guard in leave} == {"lift_off"} and len(leave) == 4

    def test_one_toe_on_the_ground_has_no_more_guards_than_it_needs(self):
        stance = hopping(load("spear_ii")).of_phase("stance")
        assert [guard.name for guard in stance[0].guards][:3] == ["lift_off", "slip", "slip"]
        assert [domain.name for domain in stance] == ["stance", "stance slip+", "stance slip-"]

    def test_lifted_toes_come_first(self):
        """Whatever else would be an event in a stance that is none."""
        first = (Guard("first", lambda *_: 1.0, Reset()),)
        both = Domain("double", "double", (STICK, STICK), hold)
        for domain in contact_domains(both, TOES, Reset(phase="flight"), first):
            assert [guard.name for guard in domain.guards[:3]] == ["lift_off", "lift_off", "first"]
            values = [
                guard.value(0, None, None, {rise(ANTERIOR): 0.5}, None, None, None) for guard in domain.guards[:2]
            ]
            assert values[0] > 0.0 > values[1]
            assert all(guard.tolerance < values[0] for guard in domain.guards[:2])

    def test_on_symbols(self):
        speed = sp.Symbol("speed")
        assert sp.diff(stays(POSTERIOR)(0, None, None, {rise(POSTERIOR): speed}, None, None, None), speed) == -1


@pytest.mark.parametrize("lanes", [1, 3])
def test_lanes_whose_landing_toe_rises_are_left_as_they_are(lanes):
    """All of them, or some."""
    system = standing(Contact(0.8))
    numbers = Numbers(system, {"friction": np.full(lanes, 0.8)}, Code(1e-12))
    q, v = dropped(0.1)
    fast = np.outer(v, np.ones(lanes))
    fast[1, 0] = 2.0
    group = Group(np.arange(lanes), np.zeros(lanes), np.concatenate([np.outer(q, np.ones(lanes)), fast]), {})
    struck, risen = strike(numbers, list(TOES), Reset(impact=(ANTERIOR,)), group)
    assert risen.lanes.tolist() == [0] and struck.lanes.tolist() == list(range(1, lanes))
    np.testing.assert_array_equal(risen.y, group.y[:, :1])
    for y in struck.y.T:
        J = np.concatenate([ROBOT.toe_jacobian(q, toe) for toe in TOES])
        np.testing.assert_allclose(y[7:], joint_impact(ROBOT.mass_matrix(q), J, v, 0.8).v, rtol=0, atol=1e-10)
