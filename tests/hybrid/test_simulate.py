"""Trajectories: the equations of motion at every sample, contact, the spring, the energy ledger, how runs end."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import simpson

from spear_pin import Contact, HoppingLaw, Spring, hopping, simulate
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import Guard, Reset
from spear_pin.hybrid.record import REASONS
from tests.lagrangian import monopod

# source: the controller's gains, the spring with motor
HIP_GAIN, HIP_DAMPING, KNEE_GAIN, KNEE_DAMPING = 54.77, 1.37, 63.25, 0.52
STIFFNESS, SPRING_DAMPING = 48.84, 1.3
FREQUENCY = 2.56
FRICTION = 0.8


def terms_of(trajectory):
    """What the symbolic Lagrangian gives at every sample."""
    lagrangian = monopod(trajectory.coordinates)
    return [lagrangian.terms(q, v) for q, v in zip(trajectory.q, trajectory.v, strict=True)]


@pytest.fixture(scope="module")
def terms(hops):
    return terms_of(hops)


@pytest.fixture(scope="module")
def slipping(free_hop):
    """The hop with boom_x free on slippery ground."""
    system = free_hop.system.build(free_hop.system.robot, free_hop.system.law, contact=Contact(0.3))
    trajectory = simulate(system, free_hop.state, cycles=4)
    assert trajectory.complete
    return trajectory


@pytest.fixture(scope="module")
def slipping_terms(slipping):
    return terms_of(slipping)


def stretches(trajectory):
    """Slices of the samples of each stance and each flight."""
    changes = np.flatnonzero(trajectory.phase[1:] != trajectory.phase[:-1]) + 1
    bounds = [0, *changes, len(trajectory.t)]
    return [slice(a, b) for a, b in zip(bounds[:-1], bounds[1:], strict=True)]


def stances(trajectory):
    return [part for part in stretches(trajectory) if trajectory.phase[part][0] == "stance"]


def balance(trajectory, terms):
    """What is left of the equations of motion at every sample, relative to their largest term."""
    rows = [trajectory.coordinates.index(joint) for joint in trajectory.actuated]
    left = []
    for i, at in enumerate(terms):
        parts = [at.mass_matrix @ trajectory.a[i], at.coriolis, at.gravity, -trajectory.friction[i]]
        applied = np.zeros(len(trajectory.coordinates))
        applied[rows] = trajectory.tau[i]
        parts += [-applied, -at.jacobians["toe"].T @ trajectory.force[i, 0]]
        left.append(np.abs(sum(parts)).max() / np.abs(parts).max())
    return np.array(left)


class TestEquationsOfMotion:
    def test_balance_at_every_sample(self, hops, terms):
        assert balance(hops, terms).max() < 1e-8

    def test_balance_while_slipping(self, slipping, slipping_terms):
        assert (slipping.domain == "stance slip+").any() or (slipping.domain == "stance slip-").any()
        assert balance(slipping, slipping_terms).max() < 1e-8

    def test_the_sticking_toe_does_not_accelerate(self, hops, terms):
        sticking = np.flatnonzero(hops.domain == "stance")
        assert len(sticking) > 1000
        for i in sticking:
            acceleration = terms[i].jacobians["toe"] @ hops.a[i] + terms[i].drifts["toe"]
            assert np.abs(acceleration).max() < 1e-8 * max(1.0, np.abs(hops.a[i]).max())

    def test_the_slipping_toe_stays_on_the_ground(self, slipping, slipping_terms):
        for i in np.flatnonzero(np.char.startswith(slipping.domain, "stance slip")):
            acceleration = slipping_terms[i].jacobians["toe"] @ slipping.a[i] + slipping_terms[i].drifts["toe"]
            assert abs(acceleration[1]) < 1e-8 * max(1.0, np.abs(slipping.a[i]).max())

    @pytest.mark.parametrize("name", ["hops", "slipping"])
    def test_the_toe_is_at_height_zero_in_stance_and_above_in_flight(self, name, request):
        trajectory = request.getfixturevalue(name)
        heights = np.array([at.toes["toe"][1] for at in terms_of(trajectory)])
        stance = trajectory.phase == "stance"
        assert np.abs(heights[stance]).max() < 1e-8
        assert heights[~stance].min() > -1e-8
        assert heights[~stance].max() > 0.02

    def test_the_toe_does_not_move_while_it_sticks(self, hops, terms):
        for part in stances(hops):
            indices = [i for i in range(part.start, part.stop) if hops.domain[i] == "stance"]
            places = np.array([terms[i].toes["toe"][0] for i in indices])
            assert np.ptp(places) < 1e-9

    def test_velocity_and_acceleration_are_derivatives(self, hops):
        flight = next(part for part in stretches(hops) if hops.phase[part][0] == "flight")
        t, q, v, a = hops.t[flight], hops.q[flight], hops.v[flight], hops.a[flight]
        np.testing.assert_allclose(q[-1] - q[0], simpson(v, x=t, axis=0), rtol=0, atol=1e-5)
        np.testing.assert_allclose(v[-1] - v[0], simpson(a, x=t, axis=0), rtol=0, atol=1e-3)


class TestForces:
    def test_cone_and_unilateral_contact_while_sticking(self, hops):
        tangential, normal = hops.force[hops.domain == "stance", 0].T
        assert normal.min() >= -1e-6
        assert (np.abs(tangential) - FRICTION * normal).max() <= 1e-6

    def test_coulomb_friction_while_slipping(self, slipping, slipping_terms):
        seen = set()
        for i in np.flatnonzero(np.char.startswith(slipping.domain, "stance slip")):
            tangential, normal = slipping.force[i, 0]
            side = 1.0 if slipping.domain[i].endswith("+") else -1.0
            assert normal >= -1e-6
            assert tangential == pytest.approx(-side * 0.3 * normal, rel=1e-12, abs=1e-12)
            speed = (slipping_terms[i].jacobians["toe"] @ slipping.v[i])[0]
            assert side * speed > -2e-7
            seen.add(side if abs(speed) > 1e-3 else 0.0)
        assert seen & {1.0, -1.0}

    def test_flight_has_neither_ground_force_nor_spring(self, hops):
        flight = hops.phase == "flight"
        assert not hops.force[flight].any()
        assert not hops.spring[flight].any()
        assert not hops.engaged[flight].any()
        assert hops.engaged[~flight].all()

    def test_no_friction_where_the_robot_has_none(self, hops):
        assert not hops.friction.any()


class TestTorques:
    """The control law and the spring, written out by hand."""

    def test_flight(self, hops):
        flight = hops.phase == "flight"
        hip, knee = hops.q[flight, 1], hops.q[flight, 2]
        hip_rate, knee_rate = hops.v[flight, 1], hops.v[flight, 2]
        expected = np.column_stack(
            [
                HIP_GAIN * (0.5 - hip) - HIP_DAMPING * hip_rate,
                KNEE_GAIN * (1.0 - knee) - KNEE_DAMPING * knee_rate,
            ]
        )
        np.testing.assert_allclose(hops.u[flight], expected, rtol=0, atol=1e-10)
        np.testing.assert_array_equal(hops.tau[flight], hops.u[flight])

    def test_stance(self, hop, hops):
        torque = hop.system.law.stance_torque
        assert len(stances(hops)) == 11
        for part in stances(hops):
            since = hops.t[part] - hops.t[part][0]
            clear = np.abs(since - 0.5 / FREQUENCY) > 1e-9
            wave = torque * np.sign(np.sin(2 * np.pi * FREQUENCY * since))
            wave[0] = torque
            motor, knee, rate = hops.u[part], hops.q[part, 2], hops.v[part, 2]
            np.testing.assert_allclose(motor[clear, 1], wave[clear], rtol=1e-14)
            np.testing.assert_array_equal(motor[:, 0], 0.0)
            spring = -STIFFNESS * np.maximum(0.0, knee - knee[0])
            np.testing.assert_allclose(hops.spring[part, 0], spring, rtol=0, atol=1e-10)
            np.testing.assert_allclose(hops.tau[part, 1], motor[:, 1] + spring - SPRING_DAMPING * rate, atol=1e-10)
            np.testing.assert_array_equal(hops.tau[part, 0], 0.0)

    def test_the_square_wave_flips_at_half_its_period(self, hop, hops):
        begins = [hops.t[part][0] for part in stances(hops)]
        flips = [event.time for event in hops.named("torque_switch")]
        np.testing.assert_allclose(np.subtract(flips, begins), 0.5 / FREQUENCY, rtol=0, atol=1e-14)
        for flip in flips:
            before, after = np.flatnonzero(hops.t == flip)
            assert hops.u[before, 1] == -hops.u[after, 1] == hop.system.law.stance_torque

    def test_the_square_wave_goes_on_for_as_long_as_the_stance(self, robot):
        system = hopping(robot, HoppingLaw(stance_torque=0.5))
        standing = simulate(system, system.guess())
        assert standing.reason == "no_event"
        np.testing.assert_allclose(
            [event.time for event in standing.named("torque_switch")], np.arange(1, 26) / (2 * FREQUENCY), rtol=1e-14
        )
        since, knee = standing.t, standing.u[:, 1]
        phase = (2 * FREQUENCY * since) % 1.0
        clear = (phase > 1e-6) & (phase < 1 - 1e-6)
        np.testing.assert_array_equal(knee[clear], 0.5 * np.sign(np.sin(2 * np.pi * FREQUENCY * since[clear])))


class TestSpring:
    def test_latches_the_knee_at_touchdown(self, hops):
        touchdowns = hops.named("touchdown")[:-1]
        assert len(touchdowns) == 10
        for touchdown, part in zip(touchdowns, stances(hops)[1:], strict=True):
            assert hops.q[part, 2][0] == touchdown.q[2]
            assert hops.spring[part, 0][0] == 0.0
            compression = hops.q[part, 2] - touchdown.q[2]
            np.testing.assert_allclose(hops.spring[part, 0], -STIFFNESS * np.maximum(compression, 0), atol=1e-10)

    def test_latches_another_angle_when_it_lands_at_another(self, hop, hops):
        q, v = (part.copy() for part in (hops.named("apex")[0].q, hops.named("apex")[0].v))
        v[2] += 1.0
        disturbed = simulate(hop.system, (q, v), cycles=3)
        angles = [event.q[2] for event in disturbed.named("touchdown")]
        assert np.ptp(angles) > 1e-3
        for angle, part in zip(angles[:-1], stances(disturbed), strict=True):
            compression = np.maximum(disturbed.q[part, 2] - angle, 0)
            np.testing.assert_allclose(disturbed.spring[part, 0], -STIFFNESS * compression, atol=1e-10)

    def test_releases_what_it_stores_at_lift_off(self, hops):
        lift_offs = hops.named("lift_off")
        assert len(lift_offs) == 11
        for lift_off, part in zip(lift_offs, stances(hops), strict=True):
            compression = lift_off.q[2] - hops.q[part, 2][0]
            assert compression > 1e-3
            assert lift_off.work["released"] == pytest.approx(-0.5 * STIFFNESS * compression**2, rel=1e-12)
        released = [event.work["released"] for event in lift_offs]
        np.testing.assert_allclose(hops.ledger["released"], released, rtol=1e-12)

    @pytest.mark.parametrize("unilateral", [True, False])
    def test_beyond_the_latched_angle(self, robot, hop, unilateral):
        """Standing up from the latched angle and sinking back through it."""
        law = HoppingLaw(stance_torque=0.0)
        system = hopping(robot, law, Spring(stiffness=20.0, damping=0.3, unilateral=unilateral))
        q, v = hop.state
        trajectory = simulate(system, (q, -0.3 * v))
        knee = trajectory.q[:, 2] - q[2]
        assert knee.min() < -0.02 and knee.max() > 0.02
        expected = -20.0 * (np.maximum(knee, 0.0) if unilateral else knee)
        np.testing.assert_allclose(trajectory.spring[:, 0], expected, rtol=0, atol=1e-9)
        total = trajectory.spring[:, 0] - 0.3 * trajectory.v[:, 2]
        np.testing.assert_allclose(trajectory.tau[:, 1] - trajectory.u[:, 1], total, rtol=0, atol=1e-9)
        switches = [event for event in trajectory.named("spring_switch") if event.time > 0.0]
        assert bool(switches) == unilateral
        for switch in switches:
            assert switch.q[2] == pytest.approx(q[2], abs=1e-10)
        assert balance(trajectory, terms_of(trajectory)).max() < 1e-8


class TestSamples:
    def test_times_do_not_decrease(self, hops, slipping):
        assert (np.diff(hops.t) >= 0).all()
        assert (np.diff(slipping.t) >= 0).all()

    def test_at_least_a_hundred_in_every_phase(self, hops, slipping):
        for trajectory in (hops, slipping):
            assert min(part.stop - part.start for part in stretches(trajectory)[:-1]) >= 100

    def test_both_sides_of_every_event(self, hops):
        resets = [event for event in hops.events if event.name != "apex"]
        for event in resets[:-1]:
            before, after = np.flatnonzero(hops.t == event.time)
            assert after == before + 1
            np.testing.assert_allclose(hops.q[before], event.q, rtol=0, atol=1e-9)
            np.testing.assert_allclose(hops.v[before], event.v_before, rtol=0, atol=1e-8)
            np.testing.assert_array_equal(hops.q[after], event.q)
            np.testing.assert_array_equal(hops.v[after], event.v)
            assert hops.domain[before] == event.domain
            assert hops.domain[after] != event.domain or event.name == "torque_switch"

    def test_the_last_sample_is_the_last_event(self, hops):
        assert hops.t[-1] == hops.events[-1].time
        np.testing.assert_allclose(hops.q[-1], hops.events[-1].q, rtol=0, atol=1e-9)
        np.testing.assert_allclose(hops.v[-1], hops.events[-1].v_before, rtol=0, atol=1e-8)

    def test_cycles_are_numbered_from_one(self, hops):
        touchdowns = [event.time for event in hops.named("touchdown")]
        assert hops.complete and hops.cycles == 11
        np.testing.assert_array_equal(np.unique(hops.cycle), np.arange(1, 12))
        for number, (begin, end) in enumerate(zip([0.0, *touchdowns[:-1]], touchdowns, strict=True), start=1):
            inside = (hops.t > begin) & (hops.t < end)
            assert (hops.cycle[inside] == number).all()

    def test_what_lies_before_the_first_touchdown_is_cycle_zero(self, hop, hops):
        apex = hops.named("apex")[0]
        trajectory = simulate(hop.system, (apex.q, apex.v), cycles=2)
        np.testing.assert_array_equal(np.unique(trajectory.cycle), [0, 1, 2])
        assert (trajectory.phase[trajectory.cycle == 0] == "flight").all()
        assert trajectory.cycles == 2 and len(trajectory.named("touchdown")) == 3
        assert trajectory.ledger.change.shape == (2,)

    def test_apex_is_the_highest_sample(self, hops):
        for apex in hops.named("apex"):
            assert abs(apex.v[0]) < 1e-9
        assert hops.q[:, 0].max() <= max(apex.q[0] for apex in hops.named("apex")) + 1e-9

    def test_a_run_that_ends_at_once(self, hop):
        trajectory = simulate(hop.system, hop.state, max_evaluations=1)
        assert trajectory.reason == "evaluation_cap"
        assert len(trajectory.t) == len(trajectory.q) == len(trajectory.domain)

    def test_the_same_bits_again(self, hop, hops):
        again = simulate(hop.system, hop.state, cycles=11)
        for name in ("t", "q", "v", "a", "force", "tau"):
            np.testing.assert_array_equal(getattr(again, name), getattr(hops, name))

    def test_states_are_not_changed(self, hop):
        q, v = (part.copy() for part in hop.state)
        simulate(hop.system, (q, v))
        np.testing.assert_array_equal(q, hop.state[0])
        np.testing.assert_array_equal(v, hop.state[1])


class TestImpact:
    def test_lands_plastically(self, hops):
        lagrangian = monopod(hops.coordinates)
        for event in hops.named("touchdown"):
            at = lagrangian.terms(event.q, event.v_before)
            jacobian = at.jacobians["toe"]
            assert (jacobian @ event.v_before)[1] < -0.5
            np.testing.assert_allclose(jacobian @ event.v, 0.0, atol=1e-12)
            momentum = at.mass_matrix @ (event.v - event.v_before)
            np.testing.assert_allclose(momentum, jacobian.T @ event.impulse[0], rtol=0, atol=1e-11)
            tangential, normal = event.impulse[0]
            assert normal > 0 and abs(tangential) <= FRICTION * normal
            lost = at.kinetic_energy - lagrangian.terms(event.q, event.v).kinetic_energy
            assert event.work["impact"] == pytest.approx(-lost, rel=0, abs=1e-12)
        assert event.work["impact"] < -0.5

    def test_no_other_event_changes_the_velocity(self, hops):
        for event in hops.events:
            if event.name != "touchdown":
                np.testing.assert_array_equal(event.v, event.v_before)
                assert not event.impulse.any()


class TestLedger:
    def test_closes_every_hop(self, hops):
        assert hops.ledger.residual.shape == (11,)
        assert np.abs(hops.ledger.residual).max() < 1e-8

    def test_closes_over_eleven_hops_at_a_finer_tolerance(self, hop):
        fine = simulate(hop.system, hop.state, cycles=11, rtol=1e-11)
        assert abs(fine.ledger.residual.sum()) < 1e-8
        assert np.abs(fine.ledger.residual).sum() < 1e-8

    def test_residual_falls_with_the_tolerance(self, hop):
        left = [
            np.abs(simulate(hop.system, hop.state, cycles=3, rtol=rtol).ledger.residual).max()
            for rtol in (1e-6, 1e-8, 1e-10)
        ]
        assert left[0] > 3 * left[1] > 9 * left[2]
        assert left[2] < 1e-9

    def test_change_is_that_of_the_energies(self, hops):
        """By the Lagrangian; no spring is compressed at touchdown."""
        lagrangian = monopod(hops.coordinates)

        def energy(q, v):
            at = lagrangian.terms(q, v)
            return at.kinetic_energy + at.potential_energy

        sections = [(hops.q[0], hops.v[0])] + [(event.q, event.v) for event in hops.named("touchdown")]
        energies = [energy(q, v) for q, v in sections]
        np.testing.assert_allclose(hops.ledger.change, np.diff(energies), rtol=0, atol=1e-11)

    def test_each_flow_is_the_integral_of_its_power(self, hops):
        """Over the samples of each hop, by Simpson's rule."""
        powers = {
            "motor_hip": hops.u[:, 0] * hops.v[:, 1],
            "motor_knee": hops.u[:, 1] * hops.v[:, 2],
            "damping": -SPRING_DAMPING * hops.engaged[:, 0] * hops.v[:, 2] ** 2,
        }
        switches = np.flatnonzero(np.diff(hops.t) == 0) + 1
        pieces = np.split(np.arange(len(hops.t)), switches)
        for name, power in powers.items():
            for cycle in range(1, 12):
                inside = [piece for piece in pieces if hops.cycle[piece[0]] == cycle]
                work = sum(simpson(power[piece], x=hops.t[piece]) for piece in inside)
                assert hops.ledger[name][cycle - 1] == pytest.approx(work, rel=1e-3, abs=1e-3)

    def test_signs(self, hops):
        assert (hops.ledger["damping"] < -1.0).all()
        assert (hops.ledger["impact"] < -0.5).all()
        assert (hops.ledger["motor_knee"] > 1.0).all()
        assert (hops.ledger["released"] < 0.0).all()
        assert (hops.ledger["slip"] <= 0.0).all()
        assert not hops.ledger["friction"].any()

    def test_slip(self, slipping):
        assert (slipping.ledger["slip"] < -1e-6).all()
        assert np.abs(slipping.ledger.residual).max() < 1e-8

    def test_slip_is_the_integral_of_its_power(self, free_hop):
        """With the toe sliding for long on ice."""
        system = free_hop.system.build(free_hop.system.robot, free_hop.system.law, contact=Contact(0.05))
        trajectory = simulate(system, free_hop.state)
        speed = np.array([at.jacobians["toe"] @ v for at, v in zip(terms_of(trajectory), trajectory.v, strict=True)])
        power = trajectory.force[:, 0, 0] * speed[:, 0]
        assert power.max() < 1e-6
        pieces = np.split(np.arange(len(trajectory.t)), np.flatnonzero(np.diff(trajectory.t) == 0) + 1)
        work = sum(simpson(power[piece], x=trajectory.t[piece]) for piece in pieces)
        assert work < -1e-3
        assert trajectory.ledger["slip"][0] == pytest.approx(work, rel=1e-2)
        assert np.abs(trajectory.ledger.residual).max() < 1e-8

    def test_viscous_friction_of_the_slider(self, rubbing_robot, hop):
        trajectory = simulate(hopping(rubbing_robot, hop.system.law), hop.state, cycles=3)
        assert trajectory.complete
        expected = np.zeros_like(trajectory.v)
        expected[:, 0] = -2.5 * trajectory.v[:, 0]
        np.testing.assert_allclose(trajectory.friction, expected, rtol=0, atol=1e-13)
        assert np.abs(trajectory.friction).max() > 1.0
        assert (trajectory.ledger["friction"] < -0.1).all()
        assert np.abs(trajectory.ledger.residual).max() < 1e-8
        assert balance(trajectory, terms_of(trajectory)).max() < 1e-8


class TestStability:
    def test_an_error_in_the_knee_rate_is_forgotten_by_the_fifth_hop(self, hop, hops):
        apex = hops.named("apex")[0]
        disturbed = apex.v + np.array([0.0, 0.0, 1.0])
        heights = [e.q[0] for e in simulate(hop.system, (apex.q, disturbed), cycles=6).named("apex")]
        after = [height - apex.q[0] for height in heights if abs(height - apex.q[0]) > 0.0]
        assert max(map(abs, after[:2])) > 1e-4
        assert np.abs(np.array(heights[5:]) - apex.q[0]).max() < 1e-4

    def test_every_hop_is_the_same(self, hop, hops):
        assert np.ptp([event.q[0] for event in hops.named("apex")]) < 1e-7
        assert np.ptp(np.diff([event.time for event in hops.named("touchdown")])) < 1e-7


def finite(trajectory):
    numbers = [getattr(trajectory, name) for name in ("t", "q", "v", "a", "u", "tau", "friction", "force", "spring")]
    return all(np.isfinite(values).all() for values in numbers)


class TestEndings:
    """A failure is a result: it has a reason, a sentence, and finite samples up to where it happened."""

    @staticmethod
    def ends(trajectory, reason):
        assert trajectory.reason == reason and not trajectory.complete
        assert REASONS[reason] in trajectory.message and "\n" not in trajectory.message
        assert finite(trajectory)
        assert trajectory.ledger.work.shape == (trajectory.cycles, len(trajectory.ledger.flows))

    def test_fall(self, free_robot, robot):
        law = HoppingLaw(stance_torque=0.0, hip_gain=0.0, hip_damping=0.0, knee_gain=0.0, knee_damping=0.0)
        system = hopping(free_robot, law)
        trajectory = simulate(system, system.guess(), cycles=3)
        self.ends(trajectory, "fall")
        frame = trajectory.events[-1].name.removeprefix("fall:")
        assert free_robot.frame_position(trajectory.q[-1], frame)[1] == pytest.approx(0.0, abs=1e-9)
        assert "fall:knee" in trajectory.message

    def test_evaluation_cap(self, hop):
        trajectory = simulate(hop.system, hop.state, cycles=11, max_evaluations=2000)
        self.ends(trajectory, "evaluation_cap")
        assert trajectory.cycles == 2
        assert 2000 < trajectory.evaluations < 2100

    def test_a_phase_without_end(self, robot):
        system = hopping(robot, HoppingLaw(stance_torque=0.0))
        trajectory = simulate(system, system.guess())
        self.ends(trajectory, "no_event")
        assert trajectory.t[-1] == pytest.approx(system.phase_limit)

    def test_painleve(self, free_robot):
        """A leg dragged ahead of the hip on ground that is too rough: the slip equation loses its solution."""
        reached = []
        for lean in np.linspace(-1.2, 1.2, 13):
            q = np.array([0.0, 0.0, lean, 0.15])
            q[1] = -free_robot.toe_position(q, "toe")[1]
            for speed in (-2.0, 2.0):
                system = hopping(free_robot, HoppingLaw(), contact=Contact(2.0))
                trajectory = simulate(system, (q, np.array([speed, 0.0, 0.0, 0.0])), rtol=1e-7)
                assert finite(trajectory)
                if trajectory.reason == "painleve":
                    reached.append(trajectory)
        assert reached
        for trajectory in reached:
            self.ends(trajectory, "painleve")

    def test_a_law_without_a_value(self, hop):
        """Not a number in the law ends the run; none of it gets into the trajectory."""
        broken = replace(
            hop.system,
            domains=tuple(
                replace(domain, law=lambda t, *_: (0.0, 8.0 if t < 0.1 else math.nan)) for domain in hop.system.domains
            ),
        )
        trajectory = simulate(broken, hop.state)
        assert trajectory.reason in ("not_finite", "step_size")
        self.ends(trajectory, trajectory.reason)
        assert trajectory.t[-1] == pytest.approx(0.1, abs=1e-3)

    @pytest.mark.parametrize(
        "value",
        [
            lambda t, *_: 1.0 / (t - t),
            lambda t, *_: math.nan,
            lambda t, *_: math.sqrt(0.1 - t),
            lambda t, *_: math.log(0.1 - t) + 1e3,
            lambda t, *_: 1.0 if t < 0.1 else math.nan,
            lambda t, *_: math.nan if 0.09 < t < 0.11 else 0.1 - t,
        ],
    )
    @pytest.mark.parametrize("observes", [True, False])
    def test_a_guard_without_a_value(self, hop, value, observes):
        """It ends the run where it loses its value, and nothing is raised."""
        guard = Guard("broken", value, None if observes else Reset())
        domains = tuple(replace(domain, guards=(guard, *domain.guards)) for domain in hop.system.domains)
        trajectory = simulate(replace(hop.system, domains=domains), hop.state)
        assert trajectory.reason == "not_finite", trajectory.message
        assert trajectory.t[-1] <= 0.1 + 0.05
        assert np.isfinite(trajectory.q).all() and np.isfinite(trajectory.u).all()

    def test_a_law_that_raises_arithmetic_errors(self, hop):
        broken = replace(
            hop.system,
            domains=tuple(
                replace(domain, law=lambda t, *_: (0.0, 8.0 + math.sqrt(0.1 - t))) for domain in hop.system.domains
            ),
        )
        trajectory = simulate(broken, hop.state)
        assert trajectory.reason in ("not_finite", "step_size")
        self.ends(trajectory, trajectory.reason)


class TestRefusals:
    GOOD = (0.6, 0.5, 1.0), (0.0, 0.0, 0.0)

    @pytest.mark.parametrize(
        ("state", "name"),
        [
            (((0.6, 0.5), (0.0, 0.0, 0.0)), "q"),
            (((0.6, 0.5, 1.0), (0.0, 0.0, 0.0, 0.0)), "v"),
            (((0.6, 0.5, 1.0, 0.0), (0.0, 0.0, 0.0)), "q"),
            (((0.6, math.nan, 1.0), (0.0, 0.0, 0.0)), "q[1]"),
            (((0.6, 0.5, 1.0), (0.0, 0.0, math.inf)), "v[2]"),
            (((0.5, 0.0, 0.0), (0.0, 0.0, 0.0)), "height of toe"),
            ((0.6, 0.5, 1.0), "state"),
            (None, "state"),
            ((("a", 0.5, 1.0), (0.0, 0.0, 0.0)), "q"),
        ],
        ids=str,
    )
    def test_state(self, hop, state, name):
        with pytest.raises(BadValue) as error:
            simulate(hop.system, state)
        assert error.value.name == name

    @pytest.mark.parametrize(
        ("options", "name"),
        [
            ({"rtol": 1.0}, "rtol"),
            ({"rtol": 1e-14}, "rtol"),
            ({"rtol": 0.0}, "rtol"),
            ({"rtol": -1e-9}, "rtol"),
            ({"rtol": math.nan}, "rtol"),
            ({"atol": 0.0}, "atol"),
            ({"atol": math.nan}, "atol"),
            ({"atol": 1.0}, "atol"),
            ({"cycles": 0}, "cycles"),
            ({"cycles": -3}, "cycles"),
            ({"cycles": 1.5}, "cycles"),
            ({"cycles": math.nan}, "cycles"),
        ],
        ids=str,
    )
    def test_options(self, hop, options, name):
        with pytest.raises(BadValue) as error:
            simulate(hop.system, self.GOOD, **{"max_evaluations": 20000} | options)
        assert error.value.name == name
