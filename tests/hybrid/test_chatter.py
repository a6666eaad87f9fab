"""Switching without end: what follows a touch at once, other toes meanwhile, and where it cannot be resolved."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, HoppingLaw, hopping, load
from spear_pin.hybrid.contact import OPEN, SLIP_BACKWARD, SLIP_FORWARD, STICK
from spear_pin.hybrid.domain import Alternation
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.filippov import Sliding, Unloaded
from spear_pin.hybrid.modes import choose, find_fitting
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.rules.surface import CHATTER, chatter
from spear_pin.hybrid.run import run
from tests import random_starts
from tests.hybrid.test_double_stance import ANTERIOR, POSTERIOR, ROBOT, TOES, dropped, standing


def limited_hop(seed, friction, minimum_force=1.0):
    start = random_starts.draw(seed)
    robot = random_starts.robot(start.free)
    system = hopping(robot, HoppingLaw(minimum_force=minimum_force), contact=Contact(friction))
    return run(system, (np.array(start.q), np.array(start.v)), 11, Options(1e-8, max_evaluations=200_000))


class TestForceLimit:
    """Flexion limited by the force of a toe at rest, at high friction."""

    @pytest.mark.parametrize(("seed", "friction"), [(12, 1.875), (15, 1.673), (32, 1.509), (243, 1.743)])
    def test_does_not_depend_on_whether_the_toe_sticks(self, seed, friction):
        """Limited it slips; were it unlimited because it slips, it would stick again, and so on."""
        assert limited_hop(seed, friction).reason in ("complete", "fall", "painleve")

    @pytest.mark.parametrize(("seed", "friction"), [(17, 1.377), (21, 1.708), (27, 1.547)])
    def test_begins_at_once_after_each_touch(self, seed, friction):
        result = limited_hop(seed, friction)
        assert result.reason in ("complete", "fall", "painleve")
        assert CHATTER in {event.domain for event in result.events}

    @pytest.mark.parametrize(("seed", "friction"), [(43, 1.734), (151, 1.513), (230, 1.458)])
    def test_a_stance_that_undoes_what_began_it(self, seed, friction):
        """Just begun it keeps the toe down, its spring then lifts it; the turns grow from nothing."""
        assert limited_hop(seed, friction).reason in ("complete", "fall", "painleve")

    @pytest.mark.parametrize("mode", [STICK, SLIP_FORWARD, SLIP_BACKWARD])
    def test_force_of_a_toe_at_rest_in_every_mode(self, mode):
        robot = load("spear_ii", locked=[])
        system = hopping(robot)
        stance = system.of_phase("stance")
        held = {"knee_touchdown": 1.0, "taut": 1.0, "flexing": 1.0, "compressing": 1.0, "limited": 0.0, "speed": 0.0}
        q, v = np.array([0.0, 0.0, 0.4, 0.9]), np.array([0.3, -0.2, 1.0, 2.0])
        y = np.concatenate([q, v, np.zeros(5)])
        sticking, flow = (
            Flow(system, next(domain for domain in stance if domain.contacts == (kind,)), held)
            for kind in (STICK, mode)
        )
        sticking(0.0, y), flow(0.0, y)
        assert sticking.normal_force("toe", sticking.u) == sticking.force("toe")[1]
        assert flow.normal_force("toe", flow.u) == sticking.force("toe")[1]
        assert (flow.force("toe")[1] == sticking.force("toe")[1]) is (mode == STICK)


def between(system, closed=(STICK, STICK)):
    """The posterior toe's switching between double stance and anterior stance."""
    grounded = next(domain for domain in system.of_phase("double") if domain.contacts == closed)
    airborne = next(domain for domain in system.of_phase("anterior") if domain.contacts == (OPEN, closed[1]))
    touch = next(guard.reset for guard in airborne.guards if guard.name == "posterior_touchdown")
    leave = next(guard.reset for guard in grounded.guards if guard.name == "posterior_lift_off")
    return Alternation(grounded, airborne, touch, leave, POSTERIOR)


class TestOtherToe:
    def test_what_may_happen_to_it_still_may(self):
        guards = chatter(between(standing(Contact()))).guards
        assert [guard.name for guard in guards[:2]] == ["posterior_touchdown", "posterior_lift_off"]
        names = [guard.name for guard in guards[2:]]
        assert "anterior_lift_off" in names and names.count("slip") == 2 and "posterior_touchdown" not in names

    @pytest.mark.parametrize("mode", [STICK, SLIP_FORWARD])
    def test_forces_of_the_blend(self, mode):
        """On the toe that stays, the accelerations being those of the blended torques."""
        system = standing(Contact())

        def pressed(t, q, v, held, p, dyn, ops):
            return [-40.0, 20.0, 5.0, -5.0]

        pair = between(system, (STICK, mode))
        pair = replace(pair, grounded=replace(pair.grounded, law=pressed))
        flow = Sliding(system, chatter(pair), {})
        q, v = dropped(0.0)
        y = np.concatenate([q, v, np.zeros(7)])
        flow(0.0, y)
        assert flow.toe_acceleration(POSTERIOR)[1] == pytest.approx(0.0, abs=1e-9)
        force = np.array(flow.force(ANTERIOR))
        D, J = ROBOT.mass_matrix(q), ROBOT.toe_jacobian(q, ANTERIOR)
        torques = ROBOT.actuation_matrix @ np.array(flow.u)
        np.testing.assert_allclose(D @ flow.a + ROBOT.bias(q, v), torques + J.T @ force, rtol=0, atol=1e-9)

    def test_a_controller_reckons_with_a_toe_that_bears_nothing(self):
        system = standing(Contact())
        pair = between(system)
        q, v = dropped(0.0)
        y = np.concatenate([q, v, np.zeros(7)])
        stance, unloaded = Flow(system, pair.grounded, {}), Unloaded(system, pair.grounded, pair.airborne, {})
        stance(0.0, y), unloaded(0.0, y)
        for toe in (POSTERIOR, ANTERIOR):
            assert stance.normal_force(toe, 4 * [5.0]) == unloaded.normal_force(toe, 4 * [5.0])
        assert unloaded.force(POSTERIOR) == (0.0, 0.0) != stance.force(POSTERIOR)


class FakeFlow:
    """What a flow says of its toes: sliding speeds, forces and accelerations."""

    friction_coefficient = 0.8

    def __init__(self, domain, toes):
        self.domain, self.toes = domain, toes

    def __call__(self, t, y):
        return y

    def toe_velocity(self, toe):
        return self.toes[toe][0], 0.0

    def force(self, toe):
        return self.toes[toe][1]

    foot_force = force

    def toe_acceleration(self, toe):
        return self.toes[toe][2], 0.0

    def pivot(self, toe):
        return 1.0


class TestModes:
    def test_a_toe_that_is_pulled_leaves_and_not_one_that_is_in_the_wrong_mode(self):
        """One toe is pulled whatever the other does, which cannot stick: it slips."""
        system = standing(Contact(0.8))
        double = {domain.contacts: domain for domain in system.of_phase("double")}
        pulled = -1.5, (-300.0, -370.0), 0.0
        flows = [
            FakeFlow(double[STICK, SLIP_BACKWARD], {POSTERIOR: (0.0, (546.0, 676.0), 0.0), ANTERIOR: pulled}),
            FakeFlow(double[SLIP_FORWARD, SLIP_BACKWARD], {POSTERIOR: (0.0, (-20.0, 25.0), -215.0), ANTERIOR: pulled}),
            FakeFlow(double[SLIP_BACKWARD, SLIP_BACKWARD], {POSTERIOR: (0.0, (480.0, 600.0), -25.0), ANTERIOR: pulled}),
        ]
        assert find_fitting(system, iter(flows), 0.0, None) is flows[2]
        assert find_fitting(system, iter(flows[:2]), 0.0, None) is flows[0], "where nothing fits, the first one pulled"

    def test_sticking_first(self):
        system = standing(Contact())
        q, v = dropped(0.0)
        y = np.concatenate([q, 0.0 * v, np.zeros(7)])
        assert choose(system, "double", {}, 0.0, y).domain.contacts[:1] in {(STICK,), (SLIP_FORWARD,), (SLIP_BACKWARD,)}
        assert len(TOES) == 2


def test_where_no_motion_goes_on_the_message_names_the_domains():
    """Two phases that lead into each other without a toe that could carry the motion between them."""
    system = standing(Contact())
    flight = system.of_phase("flight")[0]
    (down, up) = (guard for guard in flight.guards if guard.name.endswith("touchdown"))
    never = lambda t, q, v, held, p, dyn, ops: -1.0  # noqa: E731
    again = [
        replace(
            flight,
            name=name,
            phase=name,
            guards=(replace(down, value=never, reset=replace(down.reset, impact=(), phase=to)),),
        )
        for name, to in (("flight", "other"), ("other", "flight"))
    ]
    alternating = replace(system, domains=(*(d for d in system.domains if d.phase != "flight"), *again))
    result = run(alternating, dropped(0.0), 1, Options(1e-8))
    assert result.reason == "zeno" and result.detail.endswith("among flight, other")
    assert up.reset is not None
