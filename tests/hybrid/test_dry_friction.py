"""Dry friction of the slider: closed forms, an integration by hand, energy, and where it holds the joint."""

import math
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spear_pin import Contact, HoppingLaw, Spring, find_gait, hopping, load, simulate, vary
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Guard, Reset
from spear_pin.hybrid.dry_friction import with_dry_friction
from spear_pin.hybrid.hardware import Sensing
from spear_pin.hybrid.modes import choose
from spear_pin.hybrid.parameters import with_hardware, with_parameters
from spear_pin.hybrid.phases import height
from spear_pin.hybrid.reasons import NUMERICAL
from spear_pin.hybrid.result import Moment, Options
from spear_pin.hybrid.run import run
from spear_pin.studies.hardware import Rig
from tests import random_starts
from tests.hybrid.by_hand import terms
from tests.lagrangian import monopod

GRAVITY = 9.81
STIFF = load("spear_ii", locked=["boom_x", "hip", "knee"])  # a mass on a slider
ROBOT = load("spear_ii", locked=["boom_x"])
WEIGHT = GRAVITY * STIFF.mass
LIMITED = HoppingLaw(stance_torque=8.0, minimum_force=10.0)
ENDED = 4.0  # s


def ramp(t, q, v, held, p, dyn, ops):
    """A knee that is extended ever harder, and then not any more."""
    return (0.0, -60.0 * t * ops.maximum(1.0 - t / 0.4, 0.0))


def in_the_air(robot, law=lambda *_: ()):
    """A system that stays in the air until its toe touches the ground, or time is up."""
    end = Guard("end", lambda t, *_: ENDED - t, Reset(phase="air"))
    domain = Domain("air", "air", (OPEN,), law, guards=(Guard("floor", height("toe"), ends="fall"), end))
    return HybridSystem(
        kind="air",
        robot=robot,
        law=LIMITED,
        springs={"knee": Spring()},
        contact=Contact(),
        domains=(domain,),
        section="end",
        cyclic=(),
        build=lambda *_: in_the_air(robot, law),
        guess=lambda: (np.zeros(robot.nq), np.zeros(robot.nv)),
    )


def slide(friction, above, rate, robot=STIFF, **options):
    """The mass thrown from so high above the ground."""
    bottom = -robot.toe_position([0.0], "toe")[1]
    system = with_dry_friction(in_the_air(robot), {"boom_z": friction})
    return simulate(system, (np.array([bottom + above]), np.array([rate])), progress=False, **options), bottom


@cache
def gait(friction=20.0, damping=1.3):
    system = hopping(ROBOT, LIMITED, Spring(damping=damping))
    return find_gait(with_dry_friction(system, {"boom_z": friction}), ["stance_torque"], {"flight_time": 0.2})


def assert_moves_by(trajectory, friction, coordinates):
    """Every sample obeys the equations of motion of a Lagrangian, with Coulomb's force in them."""
    lagrangian = monopod(coordinates)
    z = coordinates.index("boom_z")
    moving = np.abs(trajectory.v[:, z]) > 1e-6
    expected = -friction * np.sign(trajectory.v[moving, z])
    np.testing.assert_allclose(trajectory.friction[moving, z], expected, rtol=1e-12)
    assert (np.abs(trajectory.friction[:, z]) <= friction).all()
    assert not np.delete(trajectory.friction, z, axis=1).any()
    for i in range(len(trajectory.t)):
        part = lagrangian.terms(trajectory.q[i], trajectory.v[i])
        force = part.jacobians["toe"].T @ trajectory.force[i, 0] + trajectory.friction[i]
        force[-2:] += trajectory.tau[i]
        left = part.mass_matrix @ trajectory.a[i] + part.coriolis + part.gravity
        np.testing.assert_allclose(left, force, atol=1e-8)


class TestThrown:
    """Deceleration g + τ/m upward, acceleration g - τ/m downward."""

    @pytest.mark.parametrize("friction", [0.0, 5.0, 30.0, 60.0])
    @pytest.mark.parametrize("rtol", [1e-5, 1e-9])
    def test_up_and_down(self, friction, rtol):
        rate, above, specific = 1.7, 0.3, friction / STIFF.mass
        thrown, bottom = slide(friction, above, rate, rtol=rtol)
        top, floor = thrown.named("rest:boom_z")[0], thrown.named("floor")[0]
        rise = rate**2 / (2 * (GRAVITY + specific))
        up, down = rate / (GRAVITY + specific), math.sqrt(2 * (above + rise) / (GRAVITY - specific))
        assert top.time == pytest.approx(up, abs=1e-12)
        assert top.q[0] - bottom == pytest.approx(above + rise, abs=1e-12)
        assert floor.time == pytest.approx(up + down, abs=1e-12)
        assert len(thrown.events) == 2 and thrown.reason == "fall"

    @pytest.mark.parametrize("friction", [0.0, 40.0, 0.999 * WEIGHT])
    def test_dropped_from_rest(self, friction):
        """The direction is that of the acceleration."""
        dropped, _ = slide(friction, 1e-3, 0.0)
        expected = math.sqrt(2e-3 / (GRAVITY - friction / STIFF.mass))
        assert dropped.named("floor")[0].time == pytest.approx(expected, rel=1e-9)
        assert [event.name for event in dropped.events] == ["floor"]

    def test_downward_there_is_no_event(self):
        thrown, _ = slide(20.0, 0.2, -0.5)
        slow = GRAVITY - 20.0 / STIFF.mass
        expected = (-0.5 + math.sqrt(0.25 + 2 * slow * 0.2)) / slow
        assert [event.name for event in thrown.events] == ["floor"]
        assert thrown.named("floor")[0].time == pytest.approx(expected, abs=1e-12)

    def test_with_viscous_friction(self):
        """The rise, with m v̇ = -(m g + τ) - b v."""
        friction, b, rate = 25.0, 45.0, 1.2
        thrown, bottom = slide(friction, 0.0, rate, vary(STIFF, boom_damping=b))
        m, pull = STIFF.mass, WEIGHT + friction
        up = m / b * math.log(1 + b * rate / pull)
        top = m * rate / b - pull * up / b
        event = thrown.named("rest:boom_z")[0]
        assert (event.time, event.q[0] - bottom) == pytest.approx((up, top), abs=1e-12)


class TestHeld:
    @pytest.mark.parametrize("factor", [1.0001, 1.5])
    def test_it_stays_where_it_comes_to_rest(self, factor):
        thrown, bottom = slide(factor * WEIGHT, 0.1, 1.0)
        assert thrown.reason == "complete"  # time was up
        top = thrown.named("rest:boom_z")[0]
        rise = 1.0 / (2 * GRAVITY * (1 + factor))
        assert top.q[0] - bottom == pytest.approx(0.1 + rise, abs=1e-12)
        held = thrown.domain == "air boom_z held"
        assert held.sum() > 50 and np.ptp(thrown.q[held, 0]) < 1e-10 and not thrown.a[held].any()
        np.testing.assert_allclose(thrown.friction[held, 0], WEIGHT, rtol=1e-12)
        assert [event.name for event in thrown.events] == ["rest:boom_z", "end"]

    def test_for_good(self):
        """The run ends with a reason."""
        system = replace(with_dry_friction(in_the_air(STIFF), {"boom_z": 2 * WEIGHT}), phase_limit=1.0)
        stuck = simulate(system, (np.array([1.0]), np.zeros(1)), progress=False)
        assert stuck.reason == "stuck" and not stuck.events and (stuck.q == 1.0).all()
        assert stuck.message.endswith("within the time limit of the phase (1 s in air)")

    @pytest.mark.parametrize(("factor", "held"), [(1.01, True), (0.99, False)])
    def test_from_either_side_of_coulombs_force(self, factor, held):
        state = (np.array([1.0]), np.zeros(1))
        result = run(with_dry_friction(in_the_air(STIFF), {"boom_z": factor * WEIGHT}), state, 1, Options())
        assert result.domain.name == ("air boom_z held" if held else "air")

    @pytest.mark.slow
    def test_let_go_and_caught(self):
        """A knee that kicks tears the slider from friction that bears the weight; it comes to rest again."""
        friction, start = 80.0, np.array([1.2, 0.6, 1.3, 0.0, 0.0, 0.0])
        system = with_dry_friction(in_the_air(ROBOT, ramp), {"boom_z": friction})
        ours = simulate(system, Moment(start[:3], start[3:], "air", {}), rtol=1e-11, progress=False)
        names = [event.name for event in ours.events if event.time < 0.5]
        assert names[0] == "let_go:boom_z" and names.count("rest:boom_z") >= 1
        y, mode, clock, turns = start, 0.0, 0.0, []
        for _ in names:
            y, clock, mode = self.by_hand(y, clock, mode, friction)
            turns.append((clock, y))
        for event, (time, y) in zip(ours.events, turns, strict=False):
            assert event.time == pytest.approx(time, abs=1e-8)
            np.testing.assert_allclose(np.concatenate([event.q, event.v]), y, atol=2e-7)

    def by_hand(self, y, clock, mode, friction):
        """To the next change of mode: the state, its time, and the mode then."""

        def forces(t, y):
            D, bias, _, _ = terms(y)
            return D, np.array([0.0, *ramp(t, None, None, None, None, None, Numbers)]) - bias

        def needed(t, y):
            """What holds the slider: its row of the equations, the two others solved without it."""
            D, force = forces(t, y)
            return D[0, 1:] @ np.linalg.solve(D[1:, 1:], force[1:]) - force[0]

        def flow(t, y):
            D, force = forces(t, y)
            if mode == 0.0:
                return [*y[3:], 0.0, *np.linalg.solve(D[1:, 1:], force[1:])]
            return [*y[3:], *np.linalg.solve(D, force - [mode * friction, 0.0, 0.0])]

        events = [lambda t, y: y[3]] if mode else [lambda t, y: friction - abs(needed(t, y))]
        begin = clock
        if mode:  # off the rate of zero it begins with
            step = solve_ivp(flow, (clock, clock + 1e-5), y, "DOP853", rtol=1e-12, atol=1e-14)
            begin, y = clock + 1e-5, step.y[:, -1]
        events[0].terminal = True
        found = solve_ivp(flow, (begin, 3.0), y, "DOP853", events=events, rtol=1e-11, atol=1e-13, max_step=5e-3)
        assert found.status == 1
        clock, y = float(found.t_events[0][0]), found.y_events[0][0]
        hold = needed(clock, y)
        after = 0.0 if mode and abs(hold) < friction else -float(np.sign(hold))
        return y, clock, after


class Numbers:
    maximum = max


def test_a_state_without_numbers_ends_a_run_and_raises_nothing(hop):
    """No mode of dry friction fits it, nor does any fit worse than the others."""
    system = with_dry_friction(hop.system, {"boom_z": 1.0})
    flow = choose(system, "flight", {}, 0.0, np.full(20, np.nan))
    assert flow.domain.phase == "flight"


class TestHop:
    @pytest.mark.slow
    def test_of_a_gait(self):
        """Stable at 20 N with the spring's damping as it is; it needs two thirds more torque."""
        found = gait()
        assert found.parameters["stance_torque"] == pytest.approx(13.217, abs=2e-3)
        assert found.stable and found.residual < 1e-9
        assert found.durations["flight"] == pytest.approx(0.2, abs=1e-9)

    @pytest.mark.slow
    @pytest.mark.parametrize(
        ("friction", "torque", "largest", "taken"), [(10.0, 5.082, 0.874, 4.20), (40.0, 12.266, 2.536, 12.20)]
    )
    def test_of_the_documented_gaits(self, friction, torque, largest, taken):
        law = HoppingLaw(stance_torque=0.98 * torque, minimum_force=20.0)
        system = with_dry_friction(hopping(ROBOT, law, Spring(damping=0.26)), {"boom_z": friction})
        found = find_gait(system, ["stance_torque"], {"flight_time": 0.2})
        assert found.parameters["stance_torque"] == pytest.approx(torque, abs=2e-3)
        assert abs(found.multipliers[0]) == pytest.approx(largest, abs=3e-3)
        hops = simulate(found.system, found.state, progress=False)
        assert -hops.ledger["friction"][0] == pytest.approx(taken, abs=0.01)

    @pytest.mark.slow
    def test_equations_of_motion(self):
        hops = simulate(gait().system, gait().state, progress=False)
        assert_moves_by(hops, 20.0, ("boom_z", "hip", "knee"))
        assert set(hops.domain) >= {"stance", "flight"} and len(hops.named("rest:boom_z")) == 2

    def test_free_to_move_forward(self):
        robot = load("spear_ii")
        system = hopping(robot, LIMITED)
        start = system.guess()
        rubbed = simulate(with_dry_friction(system, {"boom_z": 8.0, "boom_x": 3.0}), start, 1, progress=False)
        assert rubbed.complete, rubbed.message
        assert np.abs(rubbed.ledger.residual).max() < 1e-8
        taken = 8.0 * np.abs(np.diff(rubbed.q[:, 1])).sum() + 3.0 * np.abs(np.diff(rubbed.q[:, 0])).sum()
        assert rubbed.ledger["friction"].sum() == pytest.approx(-taken, abs=1e-8)
        only = simulate(with_dry_friction(system, {"boom_z": 8.0}), start, 1, progress=False)
        assert_moves_by(only, 8.0, ("boom_x", "boom_z", "hip", "knee"))

    @pytest.mark.slow
    def test_energy(self):
        """It takes its force times the way, and the ledger closes."""
        hops = simulate(gait().system, gait().state, 3, progress=False)
        assert np.abs(hops.ledger.residual).max() < 1e-8
        for cycle in range(3):
            way = np.abs(np.diff(hops.q[hops.cycle == cycle + 1, 0])).sum()
            assert hops.ledger["friction"][cycle] == pytest.approx(-20.0 * way, abs=1e-8)
        assert way == pytest.approx(0.416, abs=2e-3)

    @pytest.mark.slow
    def test_together_with_viscous_friction(self):
        robot = vary(ROBOT, boom_damping=20.0)
        system = with_dry_friction(hopping(robot, replace(LIMITED, stance_torque=12.0)), {"boom_z": 10.0})
        hops = simulate(system, gait().state, 2, progress=False)
        assert hops.complete and np.abs(hops.ledger.residual).max() < 1e-8
        moving = np.abs(hops.v[:, 0]) > 1e-6
        expected = -20.0 * hops.v[moving, 0] - 10.0 * np.sign(hops.v[moving, 0])
        np.testing.assert_allclose(hops.friction[moving, 0], expected, rtol=1e-12)

    def test_none_is_none(self, hop):
        plain = simulate(hop.system, hop.state, 2, 1e-11)
        none = simulate(with_dry_friction(hop.system, {"boom_z": 0.0}), hop.state, 2, 1e-11)
        kept = [event for event in none.events if event.name != "rest:boom_z"]
        assert [event.name for event in kept] == [event.name for event in plain.events]
        for ours, theirs in zip(kept, plain.events, strict=True):
            np.testing.assert_allclose([ours.time, *ours.q], [theirs.time, *theirs.q], rtol=0, atol=1e-10)
        np.testing.assert_allclose(none.ledger.work, plain.ledger.work, atol=1e-9)

    @pytest.mark.slow
    def test_multipliers_by_other_differences(self):
        """In the joint angles and a rate, ten times the step, a map of one's own."""
        found = gait()

        def on_section(x):
            hip, knee, rate = x
            q = np.array([0.318 * (np.cos(hip) + np.cos(hip - knee)), hip, knee])
            _, _, J, _ = terms(np.concatenate([q, np.zeros(3)]))
            v = np.zeros(3)
            v[[0, 1]] = np.linalg.solve(J[:, :2], -J[:, 2] * rate)
            return q, v + [0.0, 0.0, rate]

        def mapped(x):
            landing = simulate(found.system, on_section(x), rtol=1e-10, progress=False).events[-1]
            return np.array([*landing.q[1:], landing.v[2]])

        x, h = np.array([*found.state[0][1:], found.state[1][2]]), 1e-4
        np.testing.assert_allclose(mapped(x), x, atol=1e-8)
        columns = [(mapped(x + step) - mapped(x - step)) / (2 * h) for step in h * np.eye(3)]
        values = np.linalg.eigvals(np.array(columns).T)
        ours = found.multipliers[np.lexsort((found.multipliers.imag, found.multipliers.real))]
        np.testing.assert_allclose(ours, values[np.lexsort((values.imag, values.real))], atol=2e-4)

    @pytest.mark.slow
    def test_an_impact_turns_it(self):
        """Extending fast, the leg strikes the ground and throws the sinking slider up."""
        q = np.array([0.0, 0.5, 1.0])
        q[0] = 1e-4 - ROBOT.toe_position(q, "toe")[1]
        system = with_dry_friction(hopping(ROBOT, LIMITED), {"boom_z": 15.0})
        hops = simulate(system, (q, np.array([-0.02, 4.0, -6.0])), progress=False)
        landing = hops.named("touchdown")[0]
        assert landing.v_before[0] < 0 < landing.v[0]
        rising, sinking = (hops.t > landing.time) & (hops.v[:, 0] > 1e-6), hops.v[:, 0] < -1e-6
        assert rising[hops.t > landing.time][1] and sinking[hops.t > landing.time].any()
        assert (hops.friction[rising, 0] == -15.0).all() and (hops.friction[sinking, 0] == 15.0).all()

    @pytest.mark.slow
    @pytest.mark.parametrize("friction", [3.0, 50.0, 120.0])
    def test_random_starts(self, friction):
        """Whatever happens, it is no failure of the numbers, and no mode alternates without end."""
        for seed in range(12):
            start = random_starts.draw(seed)
            system = hopping(random_starts.robot(start.free), LIMITED, contact=Contact(0.8))
            state = np.array(start.q), np.array(start.v)
            result = run(with_dry_friction(system, {"boom_z": friction}), state, 3, Options(1e-8))
            assert result.reason not in (*NUMERICAL, "zeno"), (seed, result.message)


class TestComposition:
    @pytest.mark.slow
    def test_with_hardware_in_either_order(self):
        found = gait()
        hardware = Rig(sensing=Sensing(0.002, 0.05), bandwidth=500.0).on(ROBOT)
        plain = hopping(ROBOT, found.system.law)
        one = with_dry_friction(with_hardware(plain, hardware), {"boom_z": 20.0})
        other = with_hardware(with_dry_friction(plain, {"boom_z": 20.0}), hardware)
        runs = [simulate(system, found.state, rtol=1e-8, progress=False) for system in (one, other)]
        np.testing.assert_array_equal(runs[0].q, runs[1].q)
        np.testing.assert_array_equal(runs[0].ledger.work, runs[1].ledger.work)
        rebuilt = [with_parameters(system, {"stance_torque": 9.0}) for system in (one, other)]
        for system in rebuilt:
            assert system.hardware == hardware and system.law.stance_torque == 9.0
            assert all(domain.rubs[0].force == 20.0 for domain in system.domains)
        assert np.abs(runs[0].ledger.residual).max() < 1e-7

    def test_one_joint_after_the_other(self, free_robot, free_hop):
        """Both slides of a leg that is free to move forward."""
        system = hopping(free_robot, replace(free_hop.system.law, minimum_force=20.0))
        both = with_dry_friction(system, {"boom_z": 10.0, "boom_x": 1.0})
        after = with_dry_friction(with_dry_friction(system, {"boom_z": 10.0}), {"boom_x": 1.0})
        runs = [simulate(each, free_hop.state, rtol=1e-8, progress=False) for each in (both, after)]
        np.testing.assert_allclose(runs[0].q[-1], runs[1].q[-1], atol=1e-10)
        assert np.abs(runs[0].ledger.residual).max() < 1e-7

    def test_more_than_can_move_freely(self):
        """In stance the leg has one degree of freedom: which of two joints holds it, friction does not say."""
        with pytest.raises(BadValue, match="^forces is .*at most 1 joint"):
            with_dry_friction(hopping(ROBOT), {"boom_z": 60.0, "knee": 0.001})
        with pytest.raises(BadValue, match="^forces is "):
            with_dry_friction(with_dry_friction(hopping(ROBOT), {"boom_z": 60.0}), {"knee": 0.001})

    @pytest.mark.parametrize("forces", [{"boom_z": 66.0}, {"knee": 12.0}])
    def test_held_at_the_latched_angle(self, forces):
        """The spring is neither taut nor slack there, and does not switch for ever."""
        q = np.array([2 * 0.318 * np.cos(0.5), 0.5, 1.0])
        system = with_dry_friction(hopping(ROBOT, HoppingLaw(stance_torque=0.0)), forces)
        assert simulate(system, (q, np.zeros(3)), progress=False).reason == "stuck"

    def test_the_other_system_is_left_alone(self):
        system = hopping(ROBOT)
        with_dry_friction(system, {"boom_z": 20.0})
        assert not any(domain.rubs for domain in system.domains)

    @pytest.mark.parametrize("value", [-1.0, math.nan, math.inf, "5", None])
    def test_bad_force(self, value):
        with pytest.raises(BadValue, match="^dry friction of boom_z is .*>= 0, in N or N·m$"):
            with_dry_friction(hopping(ROBOT), {"boom_z": value})

    def test_bad_joint(self):
        with pytest.raises(UnknownName, match="unknown joint 'boom_x'; valid: boom_z, hip, knee"):
            with_dry_friction(hopping(ROBOT), {"boom_x": 1.0})
        with pytest.raises(BadValue, match="which boom_z has already"):
            with_dry_friction(with_dry_friction(hopping(ROBOT), {"boom_z": 1.0}), {"boom_z": 1.0})
