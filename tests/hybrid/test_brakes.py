"""Brakes: impacts in closed form, a Lagrangian's equations of motion, energy, and what they refuse."""

from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Gait, HoppingLaw, hopping, load, simulate
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.brakes import Brake, with_brakes
from spear_pin.hybrid.domain import Guard, Reset
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.rules.guards import rise
from spear_pin.hybrid.rules.impact import find_struck_toes
from spear_pin.hybrid.strikes import Overlap, strike_toes
from spear_pin.model.path import Joints
from tests.hybrid.test_heel_and_toe import footed, leg
from tests.lagrangian import monopod

LEG = load("spear_ii", locked=["boom_x"])
HOP = hopping(LEG, HoppingLaw(stance_torque=8.2, hold_extension=True))
START = np.array([0.56349008, 0.50685044, 0.96311709]), np.array([-0.80510327, 2.76839068, 5.46453907])
BOTH = Joints({"knee": 0.03, "hip": -0.006})
AIR = "flight"


def braked(force=200.0, path=None, system=HOP):
    return with_brakes(system, {"knee": Brake(force, (AIR,), path)})


def closed(reset, q, v):
    """Velocity and work of an impact."""
    strike = strike_toes(HOP, HOP.of_phase(AIR)[0], reset, q, v, Overlap(0.0), 0.0)
    return strike.v, strike.work


class TestImpact:
    Q, V = np.array([0.6, 0.5, 1.0]), np.array([0.2, 1.0, -3.0])

    def test_of_a_knee_in_the_air(self):
        """Numbers of another program."""
        v, work = closed(Reset(grips=(Joints({"knee": 1.0}),)), self.Q, self.V)
        np.testing.assert_allclose(v, (0.182045100, 1.534938610, 0.0), atol=1e-9)
        assert work == pytest.approx(-0.164642579, abs=1e-9)

    def test_of_a_path_together_with_a_toe_that_lands(self):
        """Both come to rest, by impulses of which the toe's is within its cone."""
        v, row = np.array([-0.8, 0.5, 0.4]), np.array([0.0, -0.006, 0.03])
        found, work = closed(Reset(impact=("toe",), phase="stance", grips=(BOTH,)), self.Q, v)
        J, D = LEG.toe_jacobian(self.Q, "toe"), LEG.mass_matrix(self.Q)
        assert abs(J[1] @ found) < 1e-12 and abs(row @ found) < 1e-12
        along, up, _ = np.linalg.solve(np.vstack([J, row]).T, D @ (found - v))
        assert up > 0.0 and abs(along) <= 0.8 * up + 1e-12
        assert work == pytest.approx(0.5 * found @ D @ found - 0.5 * v @ D @ v, abs=1e-12)


@pytest.mark.parametrize(("path", "row"), [(None, (0.0, 0.0, 1.0)), (BOTH, (0.0, -0.006, 0.03))])
class TestHeld:
    def test_hop_obeys_the_equations_of_motion(self, path, row):
        """In the air the brake's force, along its path, is all that they lack; it takes no power."""
        hop, lagrangian = simulate(braked(path=path), START, cycles=1, rtol=1e-11), monopod(LEG.coordinates)
        assert hop.reason == "complete" and hop.named("lift_off")[0].work["impact"] < -0.3
        air = np.flatnonzero(hop.domain == f"{AIR} knee held")
        assert len(air) > 20 and np.ptp(hop.q[air] @ row) < 1e-12 and abs(hop.v[air[1:]] @ row).max() < 1e-12
        for i in air[1:]:
            part = lagrangian.terms(hop.q[i], hop.v[i])
            motors = np.array([0.0, *hop.tau[i]])
            lacks = part.mass_matrix @ hop.a[i] + part.coriolis + part.gravity - motors
            np.testing.assert_allclose(lacks, hop.friction[i], atol=1e-9)
            np.testing.assert_allclose(np.cross(lacks, row), 0.0, atol=1e-9)
        assert hop.ledger["friction"][0] == pytest.approx(0.0, abs=1e-12)

    def test_energy_is_kept(self, path, row):
        hops = simulate(braked(path=path), START, cycles=2, rtol=1e-11)
        assert abs(hops.ledger.residual[1]) < 1e-10  # the start is known to 1e-8 m
        for event in hops.named("lift_off"):
            D = LEG.mass_matrix(event.q)
            change = 0.5 * event.v @ D @ event.v - 0.5 * event.v_before @ D @ event.v_before
            assert event.work["impact"] == pytest.approx(change, abs=1e-12)
            assert abs(event.v @ row) < 1e-12


class TestSlipping:
    def test_with_its_force_until_it_holds_again(self):
        hop = simulate(braked(1.0), START, cycles=1, rtol=1e-11)
        (holds,), (slips,) = hop.named("rest:knee"), hop.named("let_go:knee")
        assert holds.time < slips.time
        slides = (hop.domain == AIR) & (abs(hop.v[:, 2]) > 1e-6)
        np.testing.assert_allclose(hop.friction[slides, 2], -np.sign(hop.v[slides, 2]), atol=1e-12)
        held = hop.domain == f"{AIR} knee held"
        assert abs(hop.friction[held, 2]).max() <= 1.0 + 1e-9
        near = np.argmin(abs(hop.t - slips.time) + ~held)
        assert abs(hop.friction[near, 2]) == pytest.approx(1.0, abs=1e-6)
        assert hop.ledger["friction"][0] < -0.01 and hop.ledger["slip"][0] > -1e-3

    def test_where_a_run_begins_in_the_air(self):
        """No event closes the brake there."""
        q, v = START[0] + (0.05, 0.0, 0.0), np.array([0.0, 0.0, -2.0])
        fall = simulate(braked(5.0), (q, v), cycles=1)
        rests = fall.named("rest:knee")[0]
        moves = fall.t < rests.time - 1e-9
        assert 0.0 < rests.time and fall.friction[moves, 2] == pytest.approx(5.0)


def loss(event, row):
    """Energy that a brake takes as it closes in the air, ½ ṡ² / (∇s D⁻¹ ∇sᵀ)."""
    return 0.5 * (row @ event.v_before) ** 2 / (row @ np.linalg.solve(LEG.mass_matrix(event.q), row))


class TestWithinPhases:
    KNEE = np.array([0.0, 0.0, 1.0])

    def test_closes_a_time_after_the_phase_began_and_opens_by_a_condition(self):
        """In the air it then moves as without a brake; the touchdown opens it, if it is closed still."""
        system = with_brakes(HOP, {"knee": Brake(200.0, (AIR,), delay=0.02, until=lambda t, *_: 0.05 - t)})
        hops = simulate(system, START, cycles=2, rtol=1e-11)
        for lifts, closes, opens in zip(*map(hops.named, ("lift_off", "closes:knee", "opens:knee")), strict=True):
            assert (closes.time - lifts.time, opens.time - lifts.time) == pytest.approx((0.02, 0.05), abs=1e-12)
            assert closes.work == {"impact": pytest.approx(-loss(closes, self.KNEE), abs=1e-12)}
            assert abs(closes.v[2]) < 1e-12 and abs(opens.q[2] - closes.q[2]) < 1e-12 and not opens.work
            held = (hops.t > closes.time + 1e-9) & (hops.t < opens.time - 1e-9)
            assert {*hops.domain[held]} == {f"{AIR} knee held"}
            free = (hops.t > opens.time + 1e-9) & (hops.t < opens.time + 0.05)
            assert {*hops.domain[free]} == {AIR} and not hops.friction[free].any()
        assert abs(hops.ledger.residual[1]) < 1e-10

    def test_closes_by_a_force_in_stance_together_with_the_toe_and_slips(self):
        """An impact with rows [J; ∇s]; then the knee moves against the brake's force until it holds."""
        force = 120.0
        system = with_brakes(HOP, {"knee": Brake(3.0, ("stance",), when=lambda *g: force - g[5].force("toe")[-1])})
        hop = simulate(system, START, cycles=1, rtol=1e-11)
        (closes,), stance = hop.named("closes:knee"), hop.phase == "stance"
        load, before = hop.force[:, 0, 1], hop.t < closes.time - 1e-9
        assert load[stance & before].max() < force and load[stance & before][-1] == pytest.approx(force, abs=3.0)
        D = LEG.mass_matrix(closes.q)
        rows = np.vstack([LEG.toe_jacobian(closes.q, "toe"), self.KNEE])
        impulse, *_ = np.linalg.lstsq(rows.T, D @ (closes.v - closes.v_before), rcond=None)
        np.testing.assert_allclose(rows.T @ impulse, D @ (closes.v - closes.v_before), atol=1e-12)
        assert abs(rows @ closes.v).max() < 1e-12 and impulse[1] > 0.0
        slides = stance & (hop.t > closes.time + 1e-9) & (abs(hop.v[:, 2]) > 1e-6)
        np.testing.assert_allclose(hop.friction[slides, 2], -3.0 * np.sign(hop.v[slides, 2]), atol=1e-12)
        assert slides.any() and hop.reason == "complete" and hop.ledger["friction"][0] < 0.0
        assert not hop.friction[hop.phase == AIR].any()

    def test_closes_late_after_a_condition_unless_the_phase_ends_before(self):
        turns = lambda t, q, v, *_: -v[2]  # noqa: E731 - the knee flexes again
        hop, never = (
            simulate(with_brakes(HOP, {"knee": Brake(200.0, (AIR,), BOTH, turns, delay)}), START, cycles=1, rtol=1e-11)
            for delay in (0.03, 0.9)
        )
        (waits,), (closes,) = hop.named("waits:knee"), hop.named("closes:knee")
        assert abs(waits.v[2]) < 1e-9 and closes.time - waits.time == pytest.approx(0.03, abs=1e-12)
        assert closes.work["impact"] == pytest.approx(-loss(closes, np.array([0.0, -0.006, 0.03])), abs=1e-12)
        assert never.named("waits:knee") and not never.named("closes:knee")

    def test_just_after_a_phase_began_it_is_as_at_its_beginning(self):
        late = with_brakes(HOP, {"knee": Brake(200.0, (AIR,), delay=1e-9)})
        one, other = (simulate(system, START, cycles=1, rtol=1e-11) for system in (braked(), late))
        np.testing.assert_allclose(other.q[-1], one.q[-1], atol=1e-7)

    def test_two_close_one_after_the_other(self):
        """The first stays at rest as the second closes."""
        brakes = {"knee": Brake(200.0, (AIR,), delay=0.02), "hip": Brake(200.0, (AIR,), delay=0.04)}
        hop = simulate(with_brakes(HOP, brakes), START, cycles=1, rtol=1e-11)
        (second,) = hop.named("closes:hip")
        assert abs(second.v[1:]).max() < 1e-12 and f"{AIR} knee held hip held" in hop.domain
        np.testing.assert_allclose(hop.q[hop.t > second.time, 1:], [second.q[1:]] * sum(hop.t > second.time), atol=1e-9)


def test_a_rebuilt_system_keeps_its_brakes():
    names = [domain.name for domain in with_parameters(braked(), {"stance_torque": 8.0}).domains]
    assert names == ["stance", "stance slip+", "stance slip-", f"{AIR} knee held", AIR, AIR]


class TestRefused:
    @pytest.mark.parametrize(
        ("brakes", "error", "said"),
        [
            ({"ankle": Brake(1.0, (AIR,))}, UnknownName, "unknown joint 'ankle'"),
            ({"knee": Brake(1.0, ("swing",))}, UnknownName, "unknown phase of the brake 'knee' 'swing'; valid: stance"),
            ({"knee": Brake(1.0, ("stance",))}, BadValue, "expected phases other than 'stance', with which a cycle"),
            ({"knee": Brake(1.0, (AIR,)), "two": Brake(1.0, (AIR,), Joints({"knee": 2.0}))}, BadValue, "combination"),
        ],
    )
    def test_what_does_not_fit_the_system(self, brakes, error, said):
        with pytest.raises(error, match=said):
            with_brakes(HOP, brakes)

    @pytest.mark.parametrize("other", [braked(), with_dry_friction(HOP, {"knee": 0.1})])
    def test_a_name_twice(self, other):
        with pytest.raises(BadValue, match="^name of a brake is 'knee'; expected one that no other brake and no joint"):
            braked(path=BOTH, system=other)

    def test_no_force(self):
        with pytest.raises(BadValue, match=r"^Brake.force is 0.0; expected a number > 0, in N or N·m"):
            Brake(0.0, (AIR,))

    def test_a_delay_of_seconds(self):
        with pytest.raises(BadValue, match=r"^Brake.delay is 2.0; expected a number from 0 to 1, in s"):
            Brake(1.0, (AIR,), delay=2.0)

    def test_a_system_in_space(self):
        with pytest.raises(BadValue, match="^system is 'trotting'; expected one in the plane, without pinned toes"):
            with_brakes(Gait.load("trot").system, {"anterior_left_knee": Brake(1.0, (AIR,))})

    def test_what_a_loop_ties(self):
        law = HoppingLaw(-0.35, stance_torque=0.7, frequency=5.0, knee_gain=6.0, knee_damping=0.15)
        with pytest.raises(BadValue, match="^joints of the brake 'slide' is .* expected joints that loops do not tie"):
            with_brakes(hopping(load("crank_hopper"), law), {"slide": Brake(1.0, (AIR,))})


class TestUntil:
    """A condition to open that a brake has from the beginning of its phases."""

    @pytest.mark.parametrize("until", [lambda *_: -1.0, lambda t, q, v, *_: v[2] + 1.0])
    def test_it_does_not_grip_where_that_holds_already(self, until):
        """The knee extends as the leg lifts off; then the motion is that without a brake."""
        plain = simulate(HOP, START, cycles=1, rtol=1e-11)
        hop = simulate(with_brakes(HOP, {"knee": Brake(200.0, (AIR,), until=until)}), START, cycles=1, rtol=1e-11)
        (lifts,), (opens,) = hop.named("lift_off"), hop.named("opens:knee")
        assert opens.time == lifts.time and not hop.named("closes:knee") and not opens.work
        assert plain.named("lift_off")[0].v[2] < -1.0 and f"{AIR} knee held" not in hop.domain
        np.testing.assert_allclose(hop.q[-1], plain.q[-1], atol=1e-9)

    def test_else_it_grips_as_without_a_condition(self):
        """In the instant after; where no toe strikes then, that is the same impact."""
        plain = simulate(braked(), START, cycles=1, rtol=1e-11)
        system = with_brakes(HOP, {"knee": Brake(200.0, (AIR,), until=lambda *_: 1.0)})
        hop = simulate(system, START, cycles=1, rtol=1e-11)
        (lifts,), (closes,) = plain.named("lift_off"), hop.named("closes:knee")
        assert closes.work["impact"] == pytest.approx(lifts.work["impact"], abs=1e-9)
        np.testing.assert_allclose(hop.q[-1], plain.q[-1], atol=1e-9)

    def test_it_stays_closed_over_phases_and_does_not_grip_again(self, tmp_path):
        brakes = {"ankle": Brake(0.05, ("flat", "toe"), until=lambda *_: 1.0)}
        system = footed(leg(tmp_path))
        hop = simulate(with_brakes(system, brakes), system.guess())
        (closes,) = hop.named("closes:ankle")
        lands = [event for event in hop.named("retouch") if event.domain.startswith("toe") and event.time < 0.06]
        assert len(lands) > 3 and closes.time < lands[0].time and not hop.named("opens:ankle")
        assert all(abs(event.v[3]) < 1e-12 for event in lands)


@pytest.mark.parametrize(("joint", "delay"), [("knee", 0.3), ("hip", 0.3), ("knee", 0.35), ("hip", 0.35)])
def test_the_ground_does_not_pull_at_a_toe_that_a_brake_lifts(joint, delay):
    """It leaves at once, with the momentum of the joint's impact alone."""
    hop = simulate(with_brakes(HOP, {joint: Brake(200.0, ("stance",), delay=delay)}), START, cycles=1, rtol=1e-10)
    grips, leaves = hop.named(f"closes:{joint}")[0], hop.named("lift_off")[0]
    assert leaves.time == grips.time and not grips.impulse.any()
    alone = np.eye(3)[2 if joint == "knee" else 1]
    change = LEG.mass_matrix(grips.q) @ (grips.v - grips.v_before)
    np.testing.assert_allclose(np.cross(change, alone), 0.0, atol=1e-12)
    assert abs(alone @ grips.v) < 1e-12 and LEG.toe_jacobian(grips.q, "toe")[1] @ grips.v > 0.0
    assert grips.work["impact"] == pytest.approx(0.5 * change @ (grips.v + grips.v_before), abs=1e-12)
    assert all(event.impulse[:, 1].min() >= 0.0 for event in hop.events)


def without_lift_off(system):
    """The system, of which stance has no event that leads on."""
    never = Guard("never", lambda *_: 1.0, replace(system.reset_into(AIR), release=()))

    def changed(domain):
        kept = tuple(guard for guard in domain.guards if guard.name != "lift_off")
        return replace(domain, guards=(*kept, never) if domain.phase == AIR else kept)

    return replace(system, domains=tuple(map(changed, system.domains)))


def test_a_run_ends_where_no_event_lets_go_of_a_toe_that_a_brake_lifts():
    system = with_brakes(without_lift_off(HOP), {"knee": Brake(200.0, ("stance",), delay=0.3)})
    hop = simulate(system, START, cycles=1)
    assert hop.reason == "lifted" and hop.events[-1].name == "lifts:toe"
    assert hop.message.startswith("a brake lifted a toe off the ground") and hop.events[-1].time == pytest.approx(0.3)


def flat(robot, q):
    """A configuration with the ankle turned so that heel and toe are at one height."""
    heel, toe = (robot.toe_position(q, each) for each in ("heel", "toe"))
    turned = q - np.eye(4)[3] * np.arctan2(*(toe - heel)[::-1])
    assert robot.toe_position(turned, "heel")[1] == pytest.approx(robot.toe_position(turned, "toe")[1], abs=1e-12)
    return turned


class TestTwoToes:
    """A brake of the ankle, or of the knee, that grips while heel and toe are down."""

    @pytest.mark.parametrize("joint", ["ankle", "knee"])
    def test_law_of_the_impact_at_random_states(self, tmp_path, joint):
        """Momentum, the path at rest, 0 <= impulse ⊥ rise >= 0, the cone, and the energy lost."""
        system = with_brakes(footed(leg(tmp_path)), {joint: Brake(5.0, ("flat",), delay=0.01)})
        robot, rng, found = system.robot, np.random.default_rng(3), set()
        row, domain = np.eye(robot.nv)[robot.index(joint)], system.of_phase("flat")[0]
        reset = next(guard.reset for guard in domain.guards if guard.name == f"closes:{joint}")
        assert find_struck_toes(system, domain, reset) == ["heel", "toe"]
        for _ in range(100):
            q, v = flat(robot, rng.uniform(0.2, 1.0, 4)), rng.uniform(-3.0, 3.0, 4)
            strike, D = strike_toes(system, domain, reset, q, v, Overlap(0.0), 0.0), robot.mass_matrix(q)
            J = np.concatenate([robot.toe_jacobian(q, toe) for toe in robot.toes])
            left = D @ (strike.v - v) - J.T @ strike.impulse.ravel()
            np.testing.assert_allclose(left, (row @ left) * row, atol=1e-9)
            (along, up), up_speed = strike.impulse.T, (J @ strike.v)[1::2]
            assert abs(row @ strike.v) < 1e-12 and up.min() > -1e-10 and up_speed.min() > -1e-8
            assert abs(up * up_speed).max() < 1e-8 and (abs(along) <= system.contact.friction * up + 1e-8).all()
            change = 0.5 * strike.v @ D @ strike.v - 0.5 * v @ D @ v
            assert strike.work == pytest.approx(change, abs=1e-12) and change <= 0.0
            leaves = tuple(strike.rises[rise(toe)] > 0.0 for toe in robot.toes)
            np.testing.assert_allclose([strike.rises[rise(toe)] for toe in robot.toes], up_speed * leaves, atol=1e-12)
            found.add(leaves)
        assert found == {(False, False), (False, True), (True, False), (True, True)}

    @pytest.mark.parametrize(
        ("joint", "delay", "leaving"),
        [("ankle", 0.02, ["heel"]), ("ankle", 0.08, ["toe"]), ("knee", 0.1, ["heel", "toe"])],
    )
    def test_toes_leave_that_it_lifts(self, tmp_path, joint, delay, leaving):
        system = footed(leg(tmp_path))
        hop = simulate(with_brakes(system, {joint: Brake(5.0, ("flat",), delay=delay)}), system.guess(), rtol=1e-10)
        grips = hop.named(f"closes:{joint}")[0]
        after = [event for event in hop.events if event.time == grips.time][1:]
        assert [event.name for event in after] == [f"{toe}_lift_off" for toe in leaving]
        for toe, (_, normal) in zip(system.robot.toes, grips.impulse, strict=True):
            assert (normal == 0.0) == (toe in leaving) and normal >= 0.0
        assert hop.reason == "complete" and abs(hop.ledger.residual).max() < 1e-9
        assert hop.force[:, :, 1].min() > -1e-5

    def test_each_leaves_alone_where_another_event_lets_go_of_both(self, tmp_path):
        system = footed(leg(tmp_path))
        jumps = Guard("jumps", lambda *_: 1.0, Reset(release=("knee",), phase="flight"))
        domains = (
            replace(each, guards=(jumps, *each.guards)) if each.phase == "flat" else each for each in system.domains
        )
        made = with_brakes(replace(system, domains=tuple(domains)), {"ankle": Brake(5.0, ("flat",), delay=0.1)})
        domain, *_ = made.of_phase("flat")
        assert [guard.name for guard in domain.guards[:3]] == ["heel_lift_off", "toe_lift_off", "jumps"]
