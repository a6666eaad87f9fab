"""Feet of a heel and a toe: statics, tipping, sliding, impacts and hops, by closed forms, energy and differences."""

import math
from dataclasses import dataclass, replace

import numpy as np
import pytest

from spear_pin import Contact, Ground, Spring, find_gait, load, simulate
from spear_pin.errors import BadFile, BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.contact import OPEN, STICK
from spear_pin.hybrid.domain import Domain, Guard, Mount, Reset
from spear_pin.hybrid.dry_friction import count_free
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.lanes.compilation import Code
from spear_pin.hybrid.lanes.groups import Group
from spear_pin.hybrid.lanes.impacts import strike
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.parameters import number, with_numbers, with_parameters
from spear_pin.hybrid.periodic import differentiate_return_map
from spear_pin.hybrid.phases import contact_domains, fall, spring_switches, touchdown
from spear_pin.hybrid.result import Moment
from spear_pin.hybrid.soundness import check
from spear_pin.hybrid.strikes import strike_by_rule
from spear_pin.hybrid.tangent.section import exact_jacobian
from spear_pin.model.planar import Planar
from tests.hybrid.test_symbolic import OPS, compare, of
from tests.model import heeled
from tests.model.heeled import AHEAD, DEEP, FOOT, HEEL, SPIN, TOE, WHEEL, block, leg, wheeled
from tests.model.looped import fixed

G = 9.81
WEIGHT, LONG = G * (FOOT + WHEEL), TOE - HEEL
TIPS = TOE * WEIGHT - AHEAD * FOOT * G  # N·m: the ankle's torque that unloads the heel


def standing(robot, law, contact=None, limit=1.0):
    """A foot that is flat on the ground, on its heel, on its toe, or in the air."""

    def phase(name, *closed):
        opened = [toe for toe in robot.toes if toe not in closed]
        lands = [(toe, Reset(impact=(toe,), phase="flat" if closed else toe)) for toe in opened]
        guards = tuple(replace(touchdown(toe, reset), name=f"{toe}_lands") for toe, reset in lands)
        return Domain(name, name, tuple(OPEN if toe in opened else STICK for toe in robot.toes), law, guards=guards)

    leaves = {"heel": Reset(phase="toe"), "toe": Reset(phase="heel")}
    domains = [*contact_domains(phase("flat", *robot.toes), robot.toes, leaves), phase("flight")]
    for toe in robot.toes:
        domains += contact_domains(phase(toe, toe), robot.toes, {toe: Reset(phase="flight")})
    return HybridSystem(
        kind="standing",
        robot=robot,
        law=None,
        springs={},
        contact=contact or Contact(),
        domains=tuple(domains),
        section="",
        cyclic=(),
        build=lambda other, _, __, ground: standing(other, law, ground, limit),
        guess=lambda: (np.zeros(robot.nq), np.zeros(robot.nv)),
        phase_limit=limit,
    )


def free(t, q, v, held, p, dyn, ops):
    """No motors."""
    return ()


def spinning(torque, growth=0.0):
    """An ankle's torque that grows with the ankle's angle."""
    return lambda t, q, v, held, p, dyn, ops: (torque + growth * q[3],)


def moved(system, q, v=None, phase="flat", rtol=1e-11):
    q = np.array(q, dtype=float)
    return simulate(system, Moment(q, np.zeros(len(q)) if v is None else v, phase, {}), rtol=rtol, progress=False)


def energy(robot, trajectory, i):
    return robot.kinetic_energy(trajectory.q[i], trajectory.v[i]) + robot.potential_energy(trajectory.q[i])


class TestFlat:
    def test_statics(self, tmp_path):
        """The ankle's torque moves the force between heel and toe; nothing pushes along the ground."""
        torque = 0.4 * TIPS
        trajectory = moved(standing(wheeled(tmp_path), spinning(torque), limit=0.01), [0.0, DEEP, 0.0, 0.0])
        heel = (TIPS - torque) / LONG
        np.testing.assert_allclose(trajectory.force[0], [[0.0, heel], [0.0, WEIGHT - heel]], atol=1e-12)
        np.testing.assert_allclose(trajectory.a[0], [0.0, 0.0, 0.0, torque / SPIN], atol=1e-11)

    def test_both_engines_accelerate_alike(self, tmp_path):
        system = standing(leg(tmp_path), lambda t, q, v, held, p, dyn, ops: (0.3, -1.0, 0.5 - q[3]))
        rng = np.random.default_rng(1)
        for domain in system.domains:
            for _ in range(2):
                compare(system, domain, {}, rng.uniform(0.2, 0.6, 4), rng.uniform(-1, 1, 4))

    def test_both_engines_accelerate_alike_beside_a_hand(self, tmp_path):
        """The hand slides while the foot rests, or rests while the foot slides."""
        wheeled(tmp_path)
        path, hand = tmp_path / "wheeled.urdf", heeled.at(0.3, 0.1, fixed("to_hand", "wheel", "hand"))
        path.write_text(path.read_text(encoding="utf-8").replace("</robot>", f'<link name="hand"/>{hand}</robot>'))
        robot, contacts = load(path, base="fixed", toes=["heel", "hand", "toe"]), (STICK,) * 3
        every = Domain("all", "all", contacts, spinning(0.3))
        domains = contact_domains(every, robot.toes, dict.fromkeys(robot.toes, Reset(phase="all")))
        system = replace(standing(wheeled(tmp_path), free), robot=robot, domains=domains)
        assert len(system.domains) == 9
        rng = np.random.default_rng(1)
        for domain in system.domains[1:]:  # the first would leave no motion
            q, v, flow = rng.uniform(0.2, 0.6, 4), rng.uniform(-1, 1, 4), Flow(system, domain, {})
            flow(0.0, np.concatenate([q, v, np.zeros(flow._nw)]))
            motion = Motion(system, domain, Planar(robot), 0.0, [*q], [*v], {}, of(system), OPS)
            scale = 1.0 + np.abs(flow.a).max()
            np.testing.assert_allclose(np.array(motion.a, float) / scale, flow.a / scale, rtol=0, atol=1e-11)
            for toe in robot.toes:
                np.testing.assert_allclose(motion.force(toe), flow.force(toe), rtol=1e-9, atol=1e-8)

    def test_rests_in_the_cone_of_the_sum(self, tmp_path):
        """On a slope, near the limit of friction: all the force along the ground on one toe would be too much."""
        half, high, friction = 0.3, 0.1, 0.5
        robot = block(tmp_path, half, high)
        for share in (0.95, 1.05):
            slope = math.atan(share * friction)
            q = np.array([0.0, 0.0, slope])
            q[:2] -= robot.toe_position(q, "heel")
            trajectory = moved(standing(robot, free, Ground(friction, slope), limit=0.05), q)
            normal, pull = 3.0 * G * math.cos(slope), 3.0 * G * math.sin(slope)
            along = min(pull, friction * normal)
            heel = (half * normal + high * along) / (2.0 * half)
            np.testing.assert_allclose(trajectory.force[-1].sum(axis=0), [along, normal], rtol=1e-9)
            np.testing.assert_allclose(trajectory.force[-1, 0], [along * heel / normal, heel], rtol=1e-9)
            down = (pull - along) / 3.0
            np.testing.assert_allclose(
                trajectory.a[-1], [-down * math.cos(slope), -down * math.sin(slope), 0.0], atol=1e-9
            )
            assert set(trajectory.domain) == {"flat" if share < 1.0 else "flat heel slip- toe slip-"}

    def test_toes_of_one_body_slide_alike(self, tmp_path):
        system = standing(wheeled(tmp_path), spinning(0.0))
        names = [each.name for each in system.of_phase("flat")]
        assert names == ["flat", "flat heel slip+ toe slip+", "flat heel slip- toe slip-"]
        assert [count_free(each, system.robot) for each in system.domains[:4]] == [1, 2, 2, 4]


def test_a_foot_tips_over_its_toe_at_the_instant_of_the_closed_form(tmp_path):
    """In flat stance the torque is torque · cosh(ω t) with ω² = growth / SPIN; its work is known by the angle alone."""
    torque, growth, robot = 0.95 * TIPS, 1.0, wheeled(tmp_path)
    trajectory = moved(standing(robot, spinning(torque, growth), Contact(50.0), limit=0.2), [0.0, DEEP, 0.0, 0.0])
    (event,) = trajectory.events
    assert (event.name, event.domain) == ("heel_lift_off", "flat")
    assert event.time == pytest.approx(math.sqrt(SPIN / growth) * math.acosh(TIPS / torque), abs=1e-10)
    rolls = trajectory.phase == "toe"
    assert trajectory.q[-1, 2] < -0.1  # toe down
    toes = np.array([robot.toe_position(q, "toe") for q in trajectory.q[rolls]])
    np.testing.assert_allclose(toes, [[TOE, 0.0]] * len(toes), atol=1e-8)
    np.testing.assert_array_equal(trajectory.force[rolls, 0], 0.0)
    angle = trajectory.q[-1, 3]
    gained = energy(robot, trajectory, -1) - energy(robot, trajectory, 0)
    assert gained == pytest.approx(torque * angle + 0.5 * growth * angle**2, abs=1e-9)


def test_a_foot_slides_at_the_instant_at_which_its_toes_together_lose_their_grip(tmp_path):
    """A motor pushes a mass forward by force · cosh(ω t) with ω² = growth / WHEEL, and so the foot backward."""
    friction, growth, until = 0.2, 100.0, 0.3
    grip, omega = friction * WEIGHT, math.sqrt(growth / WHEEL)
    force, robot = 0.5 * grip, wheeled(tmp_path, "prismatic")
    trajectory = moved(standing(robot, spinning(force, growth), Contact(friction), until), [0.0, DEEP, 0.0, 0.0])
    (event,) = trajectory.events
    assert (event.name, event.domain) == ("slip", "flat")
    assert event.time == pytest.approx(math.acosh(grip / force) / omega, abs=1e-10)
    assert trajectory.domain[-1] == "flat heel slip- toe slip-"
    np.testing.assert_allclose(trajectory.force[-1].sum(axis=0), [grip, WEIGHT], rtol=1e-9)
    x, _, _, ankle = trajectory.v[-1]
    given = force / omega * math.sinh(omega * event.time) + grip * (until - event.time)
    assert FOOT * x + WHEEL * (x + ankle) == pytest.approx(given, abs=1e-9)


class TestImpact:
    @pytest.mark.parametrize(("half", "high"), [(0.1, 0.2), (0.1, 0.08), (0.2, 0.1)])
    def test_a_rocking_block(self, tmp_path, half, high):
        """Housner's: it rocks on over its toe with 1 - 3/2 sin²α of its rate, or stays flat if that is negative."""
        robot, tilt = block(tmp_path, half, high), 0.05  # toe up, as it falls onto the toe
        system = standing(robot, free, Contact(50.0), limit=0.5)
        q = np.array([0.0, 0.0, tilt])
        q[:2] -= robot.toe_position(q, "heel")
        trajectory = moved(system, q, phase="heel")
        event = trajectory.events[0]
        assert event.name == "toe_lands"
        fallen = robot.potential_energy(q) - robot.potential_energy(event.q)
        inertia = 4.0 * (half**2 + high**2)  # about the edge
        before = -math.sqrt(2.0 * fallen / inertia)
        kept = max(1.0 - 1.5 * half**2 / (half**2 + high**2), 0.0)
        assert event.v_before[2] == pytest.approx(before, rel=1e-8)
        assert event.v[2] == pytest.approx(kept * before, abs=1e-8)
        assert event.work["impact"] == pytest.approx(0.5 * inertia * (kept**2 - 1.0) * before**2, rel=1e-7)
        if kept:
            assert [each.name for each in trajectory.events[:2]] == ["toe_lands", "heel_lift_off"]
            assert not event.impulse[0].any()
        else:  # the sum stops the block, and each toe gives its share of what stops its turn
            down, along, turn = -3.0 * half * before, 3.0 * high * before, (half**2 + high**2) * before
            np.testing.assert_allclose(event.impulse.sum(axis=0), [along, down], rtol=1e-7)
            heel = 0.5 * (down + (high * along + turn) / half)
            assert event.impulse[0, 1] == pytest.approx(heel, rel=1e-7) and heel > 0.0
            np.testing.assert_allclose(event.impulse[:, 0] / event.impulse[:, 1], along / down, rtol=1e-9)
            assert trajectory.phase[-1] == "flat" and len(trajectory.events) == 1


class TestBouncesEnd:
    """The block rocks from heel to toe, ever less, and then rests."""

    @pytest.mark.parametrize(("half", "high"), [(0.1, 0.2), (0.1, 0.15)])
    def test_it_rests_and_the_ledger_has_what_was_lost(self, tmp_path, half, high):
        robot, tilt = block(tmp_path, half, high), 0.01
        q = np.array([0.0, 0.0, tilt])
        q[:2] -= robot.toe_position(q, "heel")
        trajectory = moved(standing(robot, free, Contact(50.0)), q, phase="heel")
        rocks = [event for event in trajectory.events if event.work]
        assert trajectory.phase[-1] == "flat" and len(rocks) > 8
        np.testing.assert_allclose(rocks[-1].v, 0.0, atol=1e-14)
        np.testing.assert_allclose(trajectory.v[-1], 0.0, atol=1e-12)
        np.testing.assert_allclose(trajectory.q[-1], [0.0, high, 0.0] + np.eye(3)[0] * trajectory.q[-1], atol=1e-12)
        lost = energy(robot, trajectory, 0) - energy(robot, trajectory, -1)
        assert sum(event.work["impact"] for event in rocks) == pytest.approx(-lost, abs=1e-12)

    def test_lanes_rest_as_the_reference_engine_does(self, tmp_path):
        robot, q = block(tmp_path, 0.1, 0.2), np.array([0.0, 0.2, 0.0])
        system = standing(robot, free, Contact(50.0))
        (lands,) = (guard.reset for guard in system.of_phase("toe")[0].guards if guard.name == "heel_lands")
        about_toe = np.array([*-robot.toe_jacobian(q, "toe")[:, 2], 1.0])  # so that the heel comes down
        v = np.outer(about_toe, [6e-6, 6e-5])  # rad/s
        numbers = Numbers(system, {"friction": np.full(2, 50.0)}, Code(1e-12))
        lanes = Group(np.arange(2), np.zeros(2), np.concatenate([np.outer(q, [1.0, 1.0]), v]), {})
        struck, _ = strike(numbers, list(robot.toes), lands, lanes)
        expected = [strike_by_rule(system, robot.toes, lands, q, each).v for each in v.T]
        np.testing.assert_allclose(struck.y[3:].T, expected, atol=1e-18)
        np.testing.assert_allclose(struck.y[3:, 0], 0.0, atol=1e-18)
        assert struck.held["toe_rise"][0] == 0.0 and struck.held["toe_rise"][1] > 1e-6


@dataclass(frozen=True)
class HopLaw:
    """In N·m, rad, N·m/rad, N·m·s/rad: angles at touchdown, and the ankle's in stance until it is pushed."""

    thrust: float = 1.4
    hip: float = 0.39
    knee: float = 0.88
    ankle: float = 0.69
    flat: float = 0.42
    push: float = 0.63
    gain: float = 8.0
    hip_gain: float = 3.9
    ankle_gain: float = 1.7
    damping: float = 0.23


def aloft(t, q, v, held, p, dyn, ops):
    ankle = p.ankle_gain * (p.ankle - q[3]) - 0.03 * v[3]
    return p.gain * (p.hip - q[1]) - p.damping * v[1], p.gain * (p.knee - q[2]) - p.damping * v[2], ankle


def bearing(t, q, v, held, p, dyn, ops):
    ankle = p.ankle_gain * (p.flat - p.push * held["thrusting"] - q[3]) - 0.03 * v[3]
    return p.hip_gain * (p.hip - q[1]) - 0.5 * p.damping * v[1], -p.thrust * held["thrusting"], ankle


def footed(robot, law=None, spring=None, contact=None, *, ground=None):
    """Hops from heel to toe: it lands on its heel, comes down flat, and rolls over its toe as it pushes off."""
    law, spring, contact = law or HopLaw(), spring or Spring(12.0, damping=0.03), ground or contact or Contact()
    mount, fallen = Mount("knee", spring, rest="rest", taut="taut"), fall(["hip", "knee"])

    def extends(t, q, v, held, p, dyn, ops):
        return v[2] * (1.0 - held["thrusting"]) + held["thrusting"]

    def lands(toe, phase, latch=None):
        return touchdown(
            toe, Reset((toe,), (), latch, phase), "touchdown" if latch and toe == "heel" else f"{toe}_lands"
        )

    def stance(name, closed, leaves, *guards):
        contacts = tuple(STICK if toe in closed else OPEN for toe in robot.toes)
        thrust = Guard("thrust", extends, Reset(latch=lambda q, v, held, p: {"thrusting": 1.0}))
        guards = (*guards, *spring_switches(mount), thrust, *fallen)
        return contact_domains(Domain(name, name, contacts, bearing, (mount,), (), guards), robot.toes, leaves)

    def latched(q, v, held, p):
        return {"rest": q[2], "taut": 1.0, "thrusting": 0.0}

    def guess():
        q = np.array([0.0, law.hip, law.knee, law.ankle])
        q[0] -= robot.toe_position(q, "heel")[1]
        J, v = robot.toe_jacobian(q, "heel"), np.array([-0.7, 0.0, 0.0, 0.0])
        v[1:3] = np.linalg.solve(J[:, 1:3], -J @ v)
        return q, v

    leaves, onto = Reset(release=("knee",), phase="flight"), {"heel": Reset(phase="toe"), "toe": Reset(phase="heel")}
    first = [lands(toe, toe, latched) for toe in robot.toes]
    domains = (
        *stance("heel", ["heel"], {"heel": leaves}, lands("toe", "flat")),
        *stance("flat", robot.toes, onto),
        *stance("toe", ["toe"], {"toe": leaves}, lands("heel", "flat")),
        Domain("flight", "flight", (OPEN, OPEN), aloft, guards=(*first, *fallen)),
    )
    measures = {"flight_time": lambda run: run.durations["flight"]}
    return HybridSystem(
        "footed", robot, law, {"knee": spring}, contact, domains, "touchdown", (), footed, guess, measures
    )


@pytest.fixture(scope="module")
def gait(tmp_path_factory):
    system = footed(leg(tmp_path_factory.mktemp("heeled")))
    return find_gait(system, vary=["thrust"], target={"flight_time": 0.15})


@pytest.mark.slow
class TestHop:
    def test_it_lands_on_its_heel_and_rolls_over_its_toe(self, gait):
        hops = simulate(gait.system, gait.state, cycles=3)
        assert gait.stable and np.abs(hops.ledger.residual).max() < 1e-8
        names = [event.name for event in hops.events]
        assert names[: len(names) // 3] == [
            "toe_lands",
            "thrust",
            "spring_switch",
            "heel_lift_off",
            "slip",
            "toe_lift_off",
            "touchdown",
        ]
        flat = hops.phase == "flat"
        feet = np.array([[gait.system.robot.toe_position(q, toe)[1] for toe in ("heel", "toe")] for q in hops.q[flat]])
        assert np.abs(feet).max() < 1e-8 and hops.force[flat][:, :, 1].min() > -1e-5

    def test_momentum_and_energy_of_the_impact_onto_the_sole(self, gait):
        event = simulate(gait.system, gait.state).named("toe_lands")[0]
        robot = gait.system.robot
        D, J = robot.mass_matrix(event.q), np.concatenate([robot.toe_jacobian(event.q, toe) for toe in robot.toes])
        np.testing.assert_allclose(D @ (event.v - event.v_before), J.T @ event.impulse.ravel(), atol=1e-10)
        np.testing.assert_allclose(J @ event.v, 0.0, atol=1e-9)
        lost = 0.5 * event.v_before @ D @ event.v_before - 0.5 * event.v @ D @ event.v
        assert -event.work["impact"] == pytest.approx(lost, abs=1e-12) and event.impulse[:, 1].min() > 0.0

    @pytest.mark.extra("heyoka")
    def test_lanes_are_those_of_the_reference_engine(self, gait):
        (q, v), turn = gait.state, np.array([0.0, 0.0, 0.0, 1e-3])  # of the ankle, beside a heel that stays down
        q, v = np.array([q, q + turn]), np.array([v, v])
        q[1, 0] -= gait.system.robot.toe_position(q[1], "heel")[1]
        lanes = simulate_many(gait.system, q, v, cycles=2)
        for i in range(2):
            last = simulate(gait.system, (q[i], v[i]), cycles=2, rtol=1e-11).named("touchdown")[-1]
            np.testing.assert_allclose(lanes.q[i], last.q, atol=1e-9)
            np.testing.assert_allclose(lanes.v[i], last.v, atol=1e-8)

    @pytest.mark.extra("heyoka")
    def test_exact_derivatives_are_those_of_differences(self, gait):
        system = with_parameters(gait.system, gait.parameters)
        expected = differentiate_return_map(system, gait.state)
        np.testing.assert_allclose(exact_jacobian(system, gait.state), expected, atol=1e-6)

    @pytest.mark.extra("heyoka")
    def test_sensitivities_are_those_of_differences(self, gait):
        names, system = ["stiffness", "thrust", "friction"], with_parameters(gait.system, gait.parameters)
        found = gait.sensitivity(names).derivatives["period"]

        def at(name, k):
            other = with_numbers(system, {name: number(system, name) * (1.0 + 1e-3 * k)})
            return sum(find_gait(other, guess=gait.state, rtol=1e-12).durations.values())

        for name, derivative in zip(names, found, strict=True):
            change = 8.0 * (at(name, 1) - at(name, -1)) - (at(name, 2) - at(name, -2))
            assert derivative == pytest.approx(change / (12e-3 * number(system, name)), rel=1e-6)


class TestRefused:
    def test_heel_and_toe_at_one_point(self, tmp_path):
        with pytest.raises(BadFile, match="points apart; 'heel' and 'toe' are one point") as caught:
            wheeled(tmp_path, heel=TOE)
        assert "\n" not in str(caught.value)

    def test_a_third_toe_of_one_body(self, tmp_path):
        path = tmp_path / "wheeled.urdf"
        wheeled(tmp_path)
        text = path.read_text(encoding="utf-8")
        ball = heeled.at(0.1, -DEEP, fixed("to_ball", "foot", "ball"))
        path.write_text(text.replace("</robot>", f'<link name="ball"/>{ball}</robot>'), encoding="utf-8")
        robot = load(path, base="fixed", toes=["heel", "ball", "toe"])
        with pytest.raises(BadValue, match="at most two toes of a body on the ground, not heel, ball, toe"):
            check(robot, [Domain("flat", "flat", (STICK,) * 3, free)], None, lambda: None, ())

    def test_a_body_that_cannot_turn(self, tmp_path):
        with pytest.raises(BadValue, match="one of heel, toe on the ground, as both bind less than x, z and turn"):
            standing(block(tmp_path, 0.1, 0.1, "fixed"), free)

    def test_a_sole_in_space(self):
        robot = load("q_spear_full", toes=["anterior_left_toe", "anterior_left_shank"])
        with pytest.raises(BadValue, match="at most one toe of a body in space on the ground"):
            check(robot, [Domain("flat", "flat", (STICK,) * 2, free)], None, lambda: None, ())
