"""Round feet whose arcs have ends: a rocker that tips over them as in closed form, a hop, engines and derivatives."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spear_pin import Contact, HoppingLaw, find_gait, hopping, monopod, simulate
from spear_pin.errors import BadFile, BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.contact import OPEN, STICK
from spear_pin.hybrid.controller import check_controllable
from spear_pin.hybrid.domain import Domain, Reset
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.flow_names import flow_names
from spear_pin.hybrid.periodic import differentiate_return_map
from spear_pin.hybrid.phases import contact_domains
from spear_pin.hybrid.result import Moment, Options
from spear_pin.hybrid.run import run
from spear_pin.hybrid.tangent.section import exact_jacobian
from spear_pin.model.mjcf import to_mjcf
from spear_pin.model.planar import Planar
from tests.hybrid.test_symbolic import HOP, compare
from tests.model.round_feet import rocker, round_spear

RADIUS, HANG, FIRST, LAST = 0.3, 0.12, -0.3, 0.5
ARC = f"radius = {RADIUS}\nfrom = {FIRST}\nto = {LAST}\n"
UNTIL = 1.6  # s
G, FINE = 9.81, {"method": "DOP853", "rtol": 1e-12, "atol": 1e-13}


@pytest.fixture(scope="module")
def rocking(tmp_path_factory):
    return rocker(tmp_path_factory.mktemp("rocker"), ARC, HANG)


def system_of(robot, friction=9.0):
    """A rocker without motors that stands on its foot."""
    stance = Domain("stance", "stance", (STICK,), lambda *_: ())
    domains = (*contact_domains(stance, robot.toes, Reset(phase="air")), Domain("air", "air", (OPEN,), lambda *_: ()))
    return HybridSystem("rocker", robot, None, {}, Contact(friction), domains, "", (), None, None, phase_limit=UNTIL)


def rocked(pitch, rate, until):
    """Pitch, its rate and x of the centre over time, by the equation of motion on the arc and on its ends.

    The centre of mass is the same distance from an end all the time.
    """
    ends = {-1: FIRST, 1: LAST}

    def slope(t, y, side):
        turned, w, _ = y
        if side == 0:
            inertia = 0.1 + RADIUS**2 + HANG**2 - 2 * RADIUS * HANG * math.cos(turned)
            push = G * HANG * math.sin(turned) + RADIUS * HANG * math.sin(turned) * w**2
            return [w, -push / inertia, -RADIUS * w]
        beta = turned - ends[side]
        inertia = 0.1 + RADIUS**2 + HANG**2 - 2 * RADIUS * HANG * math.cos(ends[side])
        return [w, -G * (HANG * math.sin(turned) - RADIUS * math.sin(beta)) / inertia, -RADIUS * math.cos(beta) * w]

    def crossing(end, direction):
        def event(t, y, side):
            return y[0] - end

        event.terminal, event.direction = True, direction
        return event

    t, y, side, switches = 0.0, [pitch, rate, 0.0], 0, []
    while t < until:
        leaving = (
            [(crossing(LAST, 1), 1), (crossing(FIRST, -1), -1)] if side == 0 else [(crossing(ends[side], -side), 0)]
        )
        found = solve_ivp(slope, (t, until), y, args=(side,), events=[event for event, _ in leaving], **FINE)
        t, y = found.t[-1], found.y[:, -1]
        hit = [next_side for (_, next_side), times in zip(leaving, found.t_events, strict=True) if len(times)]
        if hit:
            side = hit[0]
            switches.append(t)
    return np.array(y), switches


def rock(robot, rate, friction=9.0, slide=0.0):
    """Rolls for a time, or slides at first."""
    q, v = np.array([0.0, RADIUS, 0.0]), np.array([slide - RADIUS * rate, 0.0, rate])
    start = Moment(q, v, "stance", {"toe_ends": (0.0, 0.0)})
    return run(system_of(robot, friction), start, 1, Options(1e-11))


def energy(robot, state):
    return robot.kinetic_energy(*state) + robot.potential_energy(state[0])


class TestRocker:
    @pytest.mark.parametrize(("rate", "ends"), [(0.8, ""), (1.4, "first"), (1.8, "last last")])
    def test_rolls_and_tips_as_in_closed_form(self, rocking, rate, ends):
        found = rock(rocking, rate)
        (pitch, w, x), times = rocked(0.0, rate, UNTIL)
        assert found.reason == "no_event"
        assert [event.name for event in found.events] == [f"{end}_end:toe" for end in ends.split()]
        np.testing.assert_allclose([event.time for event in found.events], times, rtol=0, atol=1e-10)
        q, v = found.state
        np.testing.assert_allclose([q[2], v[2], q[0]], [pitch, w, x], rtol=0, atol=1e-10)

    @pytest.mark.parametrize("rate", [3.4, -3.4])
    def test_falls_onto_the_chord_of_its_arc(self, rocking, rate):
        found = rock(rocking, rate)
        assert found.reason == "fall" and "overturned:toe" in found.detail
        over = 0.5 * (FIRST + LAST) + math.copysign(math.pi, rate)
        assert found.state[0][2] == pytest.approx(over, abs=1e-9)

    def test_loses_nothing_where_its_arc_ends(self, rocking):
        found = rock(rocking, 1.8)
        for event in found.events:
            np.testing.assert_array_equal(event.v_before, event.v)
        start = np.array([0.0, RADIUS, 0.0]), np.array([-RADIUS * 1.8, 0.0, 1.8])
        assert energy(rocking, found.state) == pytest.approx(energy(rocking, start), abs=1e-10)

    def test_its_acceleration_jumps_there(self, rocking):
        """The centre of an arc moves level; about an end it is on a circle."""
        system, q, w = system_of(rocking), np.array([0.0, RADIUS, LAST]), 2.0
        v = np.array([-RADIUS * w, 0.0, w])
        on_arc, on_end = (Flow(system, system.domains[0], {"toe_ends": (0.0, part)}) for part in (0.0, 1.0))
        for flow in (on_arc, on_end):
            flow(0.0, np.concatenate([q, v, np.zeros(len(flow_names(system)))]))
        assert on_arc.a[1] == pytest.approx(0.0, abs=1e-12)
        assert on_end.a[1] == pytest.approx(-RADIUS * w**2, abs=1e-12)
        assert on_end.toe_velocity("toe") == pytest.approx((0.0, 0.0), abs=1e-15)

    def test_slides_on_with_the_same_speed(self, rocking):
        found = rock(rocking, -1.9, friction=0.05, slide=0.5)
        sliding = [event for event in found.events if event.name == "first_end:toe" and "slip" in event.domain]
        assert sliding and all((event.v_before == event.v).all() for event in sliding)


class TestKinematics:
    V = np.array([0.3, -1.0, 2.0])

    @pytest.mark.parametrize("pitch", [-2.0, -0.35, 0.1, 0.9, 2 * math.pi + 0.1, -2 * math.pi + 0.8])
    def test_touches_with_the_lowest_point_of_its_arc(self, rocking, pitch):
        """Whatever the turns; of a foot upside down, with the nearer end."""
        q = np.array([0.1, 0.4, pitch])
        within = np.linspace(FIRST, LAST, 20001) - pitch
        x, z = q[0] - RADIUS * np.sin(within), q[1] - RADIUS * np.cos(within)
        lowest = int(z.argmin())
        np.testing.assert_allclose(rocking.toe_position(q, "toe"), [x[lowest], z[lowest]], atol=1e-4)
        ahead, behind = (rocking.toe_position(q + s * 1e-6 * np.eye(3)[2], "toe") for s in (1, -1))
        height = (ahead - behind)[1] / 2e-6
        assert rocking.toe_jacobian(q, "toe")[1, 2] == pytest.approx(height, abs=1e-8)

    @pytest.mark.parametrize("pitch", [-0.6, 0.1, 0.8])
    def test_both_mechanics_agree(self, rocking, pitch):
        q, ends = np.array([0.1, 0.4, pitch]), (float(pitch < FIRST), float(pitch > LAST))
        plane = Planar(rocking)
        by_pitch, told = plane.feet(q, self.V, np), plane.terms(q, self.V, np, {"toe": ends})
        for feet in (by_pitch, told):
            np.testing.assert_allclose(feet.positions["toe"], rocking.toe_position(q, "toe"), atol=1e-14)
            np.testing.assert_allclose(feet.jacobians["toe"], rocking.toe_jacobian(q, "toe"), atol=1e-14)
        np.testing.assert_allclose(told.drifts["toe"], rocking.toe_drift(q, self.V, "toe"), atol=1e-14)


@pytest.fixture(scope="module")
def gait(tmp_path_factory):
    """A hop in whose stance the foot tips over the back end of its arc, and returns."""
    leg = round_spear(tmp_path_factory.mktemp("ended"), "[feet.toe]\nradius = 0.02\nfrom = -0.6\nto = 0.2\n")
    return find_gait(hopping(leg, HoppingLaw(stance_torque=7.834, hold_extension=True)))


class TestHop:
    def test_tips_in_stance_and_keeps_its_energy(self, gait):
        ran = simulate(gait.system, gait.state, cycles=1)
        assert [event.name for event in ran.events].count("first_end:toe") == 2
        assert np.abs(ran.ledger.residual).max() < 1e-8

    @pytest.mark.parametrize("parts", [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)])
    def test_both_engines_accelerate_alike(self, gait, parts):
        rng, held = np.random.default_rng(1), HOP | {"toe_ends": parts}
        for domain in gait.system.domains:
            compare(gait.system, domain, held, rng.uniform(0.2, 1.0, 3), rng.uniform(-1, 1, 3))

    def test_exact_derivatives_are_those_of_differences(self, gait):
        found, expected = exact_jacobian(gait.system, gait.state), differentiate_return_map(gait.system, gait.state)
        np.testing.assert_allclose(found, expected, atol=2e-6)

    @pytest.mark.extra("heyoka")
    def test_lanes_are_those_of_the_reference_engine(self, gait):
        lanes = simulate_many(gait.system, *(part[None] for part in gait.state), cycles=2)
        last = simulate(gait.system, gait.state, cycles=2).named("touchdown")[-1]
        np.testing.assert_allclose(lanes.q[0], last.q, atol=1e-9)
        np.testing.assert_allclose(lanes.v[0], last.v, atol=1e-8)


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_lands_on_an_end_and_stands_on_it(tmp_path):
    """Where the arc ends before the shank is as steep as at touchdown, there is nothing to roll on."""
    leg = round_spear(tmp_path, "[feet.toe]\nradius = 0.02\nfrom = -0.3\nto = 0.2\n")
    system = hopping(leg, HoppingLaw(stance_torque=7.834, hold_extension=True))
    ran = simulate(system, system.guess(), cycles=2)
    assert ran.complete and not [event for event in ran.events if "end" in event.name]
    lanes = simulate_many(system, *(part[None] for part in system.guess()), cycles=2)
    np.testing.assert_allclose(lanes.v[0], ran.named("touchdown")[-1].v, atol=1e-8)
    np.testing.assert_allclose(leg.toe_jacobian(lanes.q[0], "toe") @ lanes.v[0], 0.0, atol=1e-10)


@pytest.mark.parametrize(
    "what",
    [
        lambda system: to_mjcf(system.robot),
        lambda system: monopod(system.robot, system.robot.legs[0]),
        lambda system: check_controllable(system, ["hopping"]),
    ],
)
def test_what_does_not_keep_the_ends_is_refused(gait, what):
    with pytest.raises(BadValue, match=r"expected one whose round feet have no ends \(from, to\)"):
        what(gait.system)


@pytest.mark.parametrize(
    ("ends", "said"),
    [
        ("from = -0.6\n", "two pitches of the foot between -π and π, in rad, the lesser first"),
        ("from = 0.2\nto = -0.6\n", "the lesser first"),
        ("from = -4.0\nto = 0.2\n", "between -π and π"),
        ("from = -0.6\nto = true\n", "expected a number, in rad"),
    ],
)
def test_a_wrong_file_is_refused(tmp_path, ends, said):
    with pytest.raises(BadFile) as caught:
        round_spear(tmp_path, f"[feet.toe]\nradius = 0.02\n{ends}")
    assert said in str(caught.value) and "\n" not in str(caught.value)


def test_a_moment_says_by_itself_on_which_end_it_stands(rocking):
    """Beyond the last end, with nothing held, as with that end held."""
    system, q, v = system_of(rocking), np.array([0.0, 0.3, 0.7]), np.zeros(3)
    q[:2] -= rocking.toe_position(q, "toe") * (0.0, 1.0)
    runs = [simulate(system, Moment(q, v, "stance", held)) for held in ({}, {"toe_ends": (0.0, 1.0)})]
    assert runs[0].reason == runs[1].reason and len(runs[0].events) == len(runs[1].events)
    np.testing.assert_array_equal(runs[0].q[-1], runs[1].q[-1])


@pytest.mark.parametrize(
    ("pitch", "held", "expected"),
    [
        (0.7, (0.0, 0.0), "(0, 1), as the foot's pitch is 0.7 rad"),
        (0.7, (1.0, 0.0), "(0, 1), as the foot's pitch is 0.7 rad"),
        (0.1, (0.0, 1.0), "(0, 0), as the foot's pitch is 0.1 rad"),
        (0.1, (0.0, 0.5), "(0, 0), as the foot's pitch is 0.1 rad"),
        (0.1, (), "(0, 0), as the foot's pitch is 0.1 rad"),
    ],
)
def test_a_moment_whose_ends_contradict_the_pitch_is_refused(rocking, pitch, held, expected):
    """At an end it may be on either side."""
    system, v = system_of(rocking), np.zeros(3)

    def placed(pitch):
        q = np.array([0.0, 0.3, pitch])
        q[:2] -= rocking.toe_position(q, "toe") * (0.0, 1.0)
        return q

    with pytest.raises(BadValue) as caught:
        simulate(system, Moment(placed(pitch), v, "stance", {"toe_ends": held}))
    assert str(caught.value) == f"held['toe_ends'] is {held}; expected {expected}"
    assert not any(rocking.arcs["toe"].contradicts((0.0, last), placed(LAST)) for last in (0.0, 1.0))


@pytest.mark.extra("heyoka")
@pytest.mark.slow
def test_a_system_without_a_law_is_compiled(rocking):
    system, q, v = system_of(rocking), np.array([0.0, 0.3, 0.2]), np.array([0.0, 0.0, 1.5])
    q[:2] -= rocking.toe_position(q, "toe") * (0.0, 1.0)
    v[:2] -= rocking.toe_jacobian(q, "toe") @ v
    runs = [simulate(system, Moment(q, v, "stance", {}), engine=engine) for engine in ("reference", "compiled")]
    assert [event.name for event in runs[0].events] == [event.name for event in runs[1].events]
    np.testing.assert_allclose(runs[1].q[-1], runs[0].q[-1], atol=1e-8)
