"""The bounding automaton and the gaits that ship: every claim about them, by means other than the package's."""

import math
import re
from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin import Contact, Gait, Spring, Trajectory, bounding, load, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits import library
from spear_pin.gaits.bounding import SLOWEST
from spear_pin.gaits.bounding_law import INPUTS, evolution
from spear_pin.gaits.virtual_constraints import Outputs, dot, errors
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.periodic import chart, residual, return_map
from spear_pin.hybrid.record import NUMERICAL, Options
from spear_pin.hybrid.run import run
from tests.lagrangian import Q_SPEAR_PAIR, quadruped

NAMES = [name for name in library.names() if Gait.load(name).system.kind == "bounding"]
SPEED = 2.5  # m/s: at which those run whose names do not say another
FRICTION = 0.6  # that they may use, of the ground's 0.8
PHASES = ("posterior_stance", "flight_1", "anterior_stance", "flight_2")
POSTERIOR, ANTERIOR = (((2, 1.0), (3, 1.0), (4, -0.5)), ((4, 1.0),)), (((2, 1.0), (5, 1.0), (6, -0.5)), ((6, 1.0),))
BOTH = (*POSTERIOR, *ANTERIOR)
OUTPUTS = {  # (5.9), of which phase variable
    "posterior_stance": Outputs(ANTERIOR, POSTERIOR[0], (2, 3)),
    "flight_1": Outputs(BOTH, ((0, 1.0),), (0, 1, 2, 3)),
    "anterior_stance": Outputs(POSTERIOR, ANTERIOR[0], (0, 1)),
    "flight_2": Outputs(BOTH, ((0, 1.0),), (0, 1, 2, 3)),
}
LEGS = {"posterior": (0, 3, 4, 1.0), "anterior": (1, 5, 6, -1.0)}  # row of the toe, hip, knee, sense of flexion
each_gait = pytest.mark.parametrize("name", NAMES)


@cache
def gait(name):
    return Gait.load(name)


@cache
def stride(name):
    """One stride, its motion kept."""
    return run(gait(name).system, gait(name).state, 1, Options(rtol=1e-11, keep=True))


@cache
def trajectory(name):
    return simulate(gait(name).system, gait(name).state, 1, 1e-11)


@cache
def rigid(name):
    """The symbolic Lagrangian of the gait's robot."""
    varied = dict(gait(name).system.robot.varied)
    hip, knee = varied.pop("hip_ratio", 60.0) / 60.0, varied.pop("knee_ratio", 15.0) / 15.0
    rotors = Q_SPEAR_PAIR.rotors[0] * hip**2, Q_SPEAR_PAIR.rotors[1] * knee**2
    return quadruped(
        hip_offset=varied.pop("hip_distance", 0.7) / 2,
        torso=(varied.pop("torso_mass", 35.0), varied.pop("torso_inertia", 2.1)),
        pair=replace(Q_SPEAR_PAIR, rotors=rotors),
        **varied,
    )


def bearing(phase):
    return phase.removesuffix("_stance")


def energy_of_motion(name, q, v):
    return 0.5 * v @ rigid(name).terms(q, v).mass_matrix @ v


@each_gait
class TestGait:
    def test_is_periodic(self, name):
        found = gait(name)
        assert residual(found.system, found.state) <= 1e-8
        assert found.residual <= 1e-8
        assert tuple(found.durations) == PHASES and min(found.durations.values()) > 0.0
        cycle = stride(name)
        assert cycle.reason == "complete"
        assert dict(cycle.durations) == pytest.approx(dict(found.durations), abs=1e-7)

    def test_speed(self, name):
        cycle = stride(name)
        travelled = cycle.state[0][0] - cycle.start[0][0]
        said = re.search(r"_(\d\.\d\d)$", name)
        speed = float(said[1]) if said else SPEED
        assert travelled / sum(cycle.durations.values()) == pytest.approx(speed, abs=1e-6)
        assert gait(name).system.measures["mean_speed"](cycle) == pytest.approx(speed, abs=1e-6)
        assert gait(name).system.measures["stride"](cycle) == pytest.approx(speed * gait(name).period, abs=1e-6)
        assert gait(name).system.measures["period"](cycle) == pytest.approx(gait(name).period, abs=1e-7)

    def test_events_in_order(self, name):
        names = [event.name for event in trajectory(name).events]
        phases = [each for each in names if each.endswith(("touchdown", "lift_off"))]
        assert phases == ["posterior_lift_off", "anterior_touchdown", "anterior_lift_off", "posterior_touchdown"]

    def test_nominal_state_is_the_section_state(self, name):
        q, v = gait(name).state
        np.testing.assert_allclose(gait(name).system.law.nominal, [*q[1:], *v], rtol=0, atol=1e-9)
        guess = gait(name).system.guess()
        np.testing.assert_allclose(np.concatenate(guess)[1:], [*q[1:], *v], rtol=0, atol=1e-9)

    def test_outputs_stay_zero(self, name):
        """Hybrid zero dynamics: from just after each transition through the whole phase.

        While a foot slips, in the last instants of a stance that ends by force, the law, which takes it to
        stick, lets them leave zero a little.
        """
        seen = set()
        for segment in stride(name).segments:
            outputs = OUTPUTS[segment.domain.phase]
            for piece in segment.pieces:
                for t in np.linspace(piece.begin, piece.end, 5):
                    state = np.ravel(piece.state(np.array([t])))
                    y, dy = errors(outputs, evolution(segment.held), state[:7], state[7:14])
                    assert np.abs([*y, *dy]).max() < (1e-4 if "slip" in segment.domain.name else 1e-7)
            seen.add(segment.domain.phase)
        assert seen == set(PHASES)

    def test_equations_of_motion(self, name, tmp_path):
        """At every sample of a saved trajectory D a + C v + G = B τ + friction + Jᵀ F, by the Lagrangian."""
        motion = Trajectory.load(trajectory(name).save(tmp_path / "bound.npz"))
        for i in range(len(motion.t)):
            terms = rigid(name).terms(motion.q[i], motion.v[i])
            left = terms.mass_matrix @ motion.a[i] + terms.coriolis + terms.gravity
            right = np.array([0.0, 0.0, 0.0, *motion.tau[i]]) + motion.friction[i]
            for j, toe in enumerate(motion.toes):
                right = right + terms.jacobians[toe].T @ motion.force[i, j]
            scale = max(1.0, np.abs(left).max())
            np.testing.assert_allclose(left, right, rtol=0, atol=1e-8 * scale)
            for leg, (row, _, _, _) in LEGS.items():
                if motion.domain[i] == f"{leg}_stance":
                    toe = motion.toes[row]
                    np.testing.assert_allclose(terms.jacobians[toe] @ motion.v[i], 0.0, rtol=0, atol=1e-8)
                    slide = terms.jacobians[toe] @ motion.a[i] + terms.drifts[toe]
                    np.testing.assert_allclose(slide, 0.0, rtol=0, atol=1e-8 * max(1.0, np.abs(motion.a[i]).max()))

    def test_torques(self, name):
        """Of the bearing leg (5.4)-(5.6): a constant at the hip, a constant and the virtual spring at the knee."""
        motion, law = trajectory(name), gait(name).system.law
        for leg, (i, _, knee, side) in LEGS.items():
            stance = motion.phase == f"{leg}_stance"
            flexed = side * motion.q[stance, knee] - law.knee_rest
            push = getattr(law, f"{leg}_knee_torque") + law.virtual_stiffness * flexed
            hip = getattr(law, f"{leg}_hip_torque")
            np.testing.assert_allclose(motion.tau[stance, 2 * i], hip, rtol=0, atol=1e-6)
            np.testing.assert_allclose(motion.tau[stance, 2 * i + 1], -side * push, rtol=0, atol=1e-6)

    def test_impacts(self, name):
        """D (v⁺ - v⁻) = Jᵀ Λ and J v⁺ = 0, the impulse within the cone, by the Lagrangian."""
        for leg, (row, _, _, _) in LEGS.items():
            (event,) = trajectory(name).named(f"{leg}_touchdown")
            terms = rigid(name).terms(event.q, event.v_before)
            J, impulse = terms.jacobians[f"{leg}_toe"], event.impulse[row]
            change = terms.mass_matrix @ (event.v - event.v_before)
            np.testing.assert_allclose(change, J.T @ impulse, rtol=0, atol=1e-9 * max(1.0, np.abs(change).max()))
            np.testing.assert_allclose(J @ event.v, 0.0, rtol=0, atol=1e-9)
            assert terms.toes[f"{leg}_toe"][1] == pytest.approx(0.0, abs=1e-9) and (J @ event.v_before)[1] < 0.0
            assert (event.impulse[1 - row] == 0.0).all()
            assert impulse[1] > 0.0 and abs(impulse[0]) <= FRICTION * impulse[1]
            lost = energy_of_motion(name, event.q, event.v_before) - energy_of_motion(name, event.q, event.v)
            assert lost > 0.0 and event.work["impact"] == pytest.approx(-lost, abs=1e-9)

    def test_touchdown_posture(self, name):
        law = gait(name).system.law
        for leg, (_, hip, knee, side) in LEGS.items():
            (event,) = trajectory(name).named(f"{leg}_touchdown")
            assert side * event.q[knee] == pytest.approx(law.knee_touchdown, abs=1e-7)
            angle = event.q[2] + event.q[hip] - event.q[knee] / 2
            assert angle == pytest.approx(getattr(law, f"{leg}_leg_touchdown"), abs=1e-7)

    def test_energy(self, name):
        """What the joints do is lost in the impacts, and what the motors do there and in the springs let go."""
        motion, system = trajectory(name), gait(name).system
        nodes, weights = np.polynomial.legendre.leggauss(6)
        work = 0.0
        for segment in stride(name).segments:
            flow = Flow(system, segment.domain, segment.held)
            for piece in segment.pieces:
                half = 0.5 * (piece.end - piece.begin)
                for node, weight in zip(nodes, weights, strict=True):
                    y = np.ravel(piece.state(np.array([piece.begin + half * (1.0 + node)])))
                    flow(0.0, y)
                    work += half * weight * float(np.dot(flow.tau, y[10:14]))
        lost = sum(
            energy_of_motion(name, event.q, event.v_before) - energy_of_motion(name, event.q, event.v)
            for event in motion.events
            if event.name.endswith("touchdown")
        )
        ledger = motion.ledger
        assert work + ledger["slip"][0] == pytest.approx(lost, abs=1e-6)
        motors = sum(ledger[flow][0] for flow in ledger.flows if flow.startswith("motor_"))
        others = ledger["damping"][0] + ledger["friction"][0] + ledger["slip"][0]
        assert motors + others == pytest.approx(lost - ledger["released"][0], abs=1e-6)
        assert abs(ledger.residual[0]) < 1e-7

    def test_ground_force(self, name):
        """A positive normal force and friction within what is allowed; to the last where the knee ends the stance."""
        motion = trajectory(name)
        for leg, (row, _, _, _) in LEGS.items():
            (lift_off,) = motion.named(f"{leg}_lift_off")
            stance = motion.phase == f"{leg}_stance"
            if gait(name).system.law.lift_off == "force":
                assert motion.force[stance, row, 1].min() > -1e-4
                stance &= motion.t < lift_off.time - 1e-3
            tangential, normal = motion.force[stance, row].T
            assert normal.min() > 0.0
            assert (np.abs(tangential) / normal).max() <= FRICTION
            assert set(motion.domain[stance]) == {f"{leg}_stance"}
            assert (motion.force[stance, 1 - row] == 0.0).all()

    def test_no_scuffing(self, name):
        """A toe in the air is above the ground, from just after lift-off until just before touchdown."""
        motion = trajectory(name)
        height = np.array(
            [
                [rigid(name).terms(q, v).toes[toe][1] for toe in motion.toes]
                for q, v in zip(motion.q, motion.v, strict=True)
            ]
        )
        for leg, (row, _, _, _) in LEGS.items():
            aloft = motion.phase != f"{leg}_stance"
            assert height[aloft, row].min() > -1e-9
            ends = [event.time for event in motion.events if event.name in (f"{leg}_lift_off", f"{leg}_touchdown")]
            inner = aloft & (np.abs(np.subtract.outer(motion.t, [0.0, *ends])).min(axis=1) > 2e-3)
            assert height[inner, row].min() > 0.0
            swing = motion.phase == f"{'anterior' if leg == 'posterior' else 'posterior'}_stance"
            assert height[swing, row].min() > 1e-3

    def test_stays_for_some_strides(self, name):
        """However unstable it is, it is a gait."""
        motion = simulate(gait(name).system, gait(name).state, 3, 1e-11)
        assert motion.complete
        np.testing.assert_allclose(motion.events[-1].v, gait(name).state[1], rtol=0, atol=1e-6)

    def test_multipliers(self, name):
        found = np.abs(gait(name).multipliers)
        assert len(found) == chart(gait(name).system, gait(name).state).dimension == 10
        assert (np.diff(found) <= 1e-9).all()


def springs(name, stiffness):
    """The same gait with other springs in the knees, without damping."""
    system = gait(name).system
    return system.build(system.robot, system.law, Spring(stiffness=stiffness, damping=0.0), system.contact)


@each_gait
class TestVirtualSpring:
    """The motor gives what the physical spring does not, so the motion does not depend on that spring."""

    @pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
    def test_motion_is_the_same(self, name, share):
        here = trajectory(name)
        there = simulate(springs(name, share * gait(name).system.law.virtual_stiffness), gait(name).state, 1, 1e-11)
        kinds = ("touchdown", "lift_off")
        for one, other in zip(
            [event for event in here.events if event.name.endswith(kinds)],
            [event for event in there.events if event.name.endswith(kinds)],
            strict=True,
        ):
            assert one.name == other.name and one.time == pytest.approx(other.time, abs=1e-8)
            np.testing.assert_allclose(one.q, other.q, rtol=0, atol=1e-7)
            np.testing.assert_allclose(one.v, other.v, rtol=0, atol=1e-6)
            np.testing.assert_allclose(one.impulse, other.impulse, rtol=0, atol=1e-6)
        for leg, (i, _, _, _) in LEGS.items():
            extremes = [(motion.tau[motion.phase == f"{leg}_stance", 2 * i + 1][[0, -1]]) for motion in (here, there)]
            np.testing.assert_allclose(*extremes, rtol=0, atol=1e-5)

    def test_motor_torque_is_flat_if_it_is_all_physical(self, name):
        law = gait(name).system.law
        motion = simulate(springs(name, law.virtual_stiffness), gait(name).state, 1, 1e-11)
        rest = {"posterior": gait(name).state[0][4], "anterior": motion.named("anterior_touchdown")[0].q[6]}
        bound = law.virtual_stiffness * abs(law.knee_touchdown - law.knee_rest)
        for leg, (i, _, knee, side) in LEGS.items():
            stance = motion.phase == f"{leg}_stance"
            torque, compressed = motion.u[stance, 2 * i + 1], side * (motion.q[stance, knee] - rest[leg]) >= 0.0
            assert compressed.sum() > 10
            assert np.ptp(torque[compressed]) < 1e-6
            if law.lift_off == "knee":
                assert np.ptp(torque) <= bound + 1e-5
            total = motion.tau[stance, 2 * i + 1]
            assert np.ptp(total) > 1.0  # which is the spring's

    def test_without_a_spring_the_motor_gives_all(self, name):
        motion = simulate(springs(name, 0.0), gait(name).state, 1, 1e-9)
        np.testing.assert_array_equal(motion.u, motion.tau)
        assert (motion.spring == 0.0).all()


class TestAutomaton:
    LEADS = {
        "posterior_stance": {"posterior_lift_off": "flight_1", "anterior_touchdown": "double_1"},
        "double_1": {"posterior_lift_off": "anterior_stance", "anterior_lift_off": "posterior_stance"},
        "flight_1": {"anterior_touchdown": "anterior_stance", "posterior_return": "posterior_stance"},
        "anterior_stance": {"anterior_lift_off": "flight_2", "posterior_touchdown": "double_2"},
        "double_2": {"anterior_lift_off": "posterior_stance", "posterior_lift_off": "anterior_stance"},
        "flight_2": {"posterior_touchdown": "posterior_stance", "anterior_return": "anterior_stance"},
    }
    CLOSED = {
        "posterior_stance": (1, 0),
        "double_1": (1, 1),
        "flight_1": (0, 0),
        "anterior_stance": (0, 1),
        "double_2": (1, 1),
        "flight_2": (0, 0),
    }

    @pytest.fixture(params=["knee", "force"])
    def system(self, request):
        law = replace(gait(NAMES[0]).system.law, lift_off=request.param)
        return bounding(load("q_spear"), law)

    def test_phases(self, system):
        assert set(system.phases) == set(self.LEADS)
        assert system.section == "posterior_touchdown" and system.section_phase == "posterior_stance"
        assert system.landing[0] == "flight_2" and system.cyclic == ("torso_x",)
        assert {phase: len(system.of_phase(phase)) for phase in self.LEADS} == {
            phase: 3 ** sum(closed) for phase, closed in self.CLOSED.items()
        }

    def test_domains(self, system):
        for domain in system.domains:
            assert tuple(int(mode != "open") for mode in domain.contacts) == self.CLOSED[domain.phase]
            bears = {f"{leg}_knee" for leg, (row, *_) in LEGS.items() if self.CLOSED[domain.phase][row]}
            assert {mount.joint for mount in domain.mounts} == bears
            assert all(mount.side == LEGS[mount.joint.removesuffix("_knee")][3] for mount in domain.mounts)
            leads = {guard.name: guard.reset.phase for guard in domain.guards if guard.reset and guard.reset.phase}
            assert leads == self.LEADS[domain.phase]
        assert len({domain.name for domain in system.domains}) == len(system.domains)

    def test_resets(self, system):
        for domain in system.domains:
            for guard in domain.guards:
                if guard.name.endswith(("touchdown", "return")):
                    leg = guard.name.partition("_")[0]
                    assert guard.reset.impact == (f"{leg}_toe",) and not guard.reset.release
                if guard.name.endswith("lift_off"):
                    leg = guard.name.partition("_")[0]
                    assert guard.reset.release == (f"{leg}_knee",) and not guard.reset.impact

    def test_falls(self, system):
        for domain in system.domains:
            falls = {guard.name for guard in domain.guards if guard.ends == "fall"}
            assert falls == {f"fall:{leg}_{part}" for leg in LEGS for part in ("hip", "knee")}

    def test_knee_lifts_off_only_by_name(self):
        counts = {}
        for kind in ("knee", "force"):
            law = replace(gait(NAMES[0]).system.law, lift_off=kind)
            domain = bounding(load("q_spear"), law).of_phase("posterior_stance")[0]
            counts[kind] = sum(guard.name == "posterior_lift_off" for guard in domain.guards)
        assert counts == {"knee": 2, "force": 1}

    @each_gait
    def test_lift_off_as_asked(self, name):
        motion, law = trajectory(name), gait(name).system.law
        for leg, (row, _, knee, side) in LEGS.items():
            (event,) = motion.named(f"{leg}_lift_off")
            last = np.flatnonzero(motion.phase == f"{leg}_stance")[-1]
            if law.lift_off == "knee":
                assert side * event.q[knee] == pytest.approx(law.knee_rest, abs=1e-8)
                assert side * event.v[knee] < 0.0 and motion.force[last, row, 1] > 0.0
            else:
                assert motion.force[last, row, 1] == pytest.approx(0.0, abs=1e-4)

    def test_measures_and_defaults(self, system):
        assert system.spring == Spring(stiffness=112.0, damping=0.0) and system.contact == Contact()
        assert system.kind == "bounding" and set(system.measures) == {"mean_speed", "period", "stride"}


class TestTransitions:
    """What happens off the nominal path."""

    @each_gait
    @pytest.mark.parametrize("spin", [-2.0, -1.0, 1.0, 2.0])
    def test_outputs_begin_at_zero_after_every_transition(self, name, spin):
        """With pitch rate added: whatever comes, each phase begins with y = ẏ = 0, (5.22)."""
        result = run(gait(name).system, pitched(name, spin), 2, Options(1e-8, max_evaluations=50_000, keep=True))
        assert result.reason not in NUMERICAL
        began = None
        for segment in result.segments:
            outputs = OUTPUTS.get(segment.domain.phase)
            if outputs is None or not segment.pieces or (segment.began, segment.domain.phase) == began:
                continue
            began = segment.began, segment.domain.phase
            if segment.pieces[0].begin != 0.0:
                continue
            state = np.ravel(segment.pieces[0].state(np.zeros(1)))
            y, dy = errors(outputs, evolution(segment.held), state[:7], state[7:14])
            assert np.abs(y).max() < 1e-9
            begun = evolution(segment.held)
            if abs(dot(outputs.phase, state[7:14]) / begun.span) > SLOWEST:
                assert np.abs(dy).max() < 1e-9 * max(1.0, np.abs(state[7:14]).max())

    def test_double_stance_and_slip(self):
        """Raising or lowering the pitch rate brings the next foot down early, or a foot slides."""
        domains = set()
        for name in NAMES:
            for spin in (-4.0, -3.0, -2.0, -1.0, 1.0, 2.0):
                result = run(gait(name).system, pitched(name, spin), 2, Options(1e-8, max_evaluations=50_000))
                assert result.reason not in NUMERICAL, (name, spin, result.message)
                domains |= {event.domain for event in result.events}
        assert any(domain.startswith("double_") for domain in domains), domains
        assert any("slip" in domain for domain in domains), domains

    def test_of_double_stance(self):
        """Both feet bear, by their own springs and constants, whatever the swing wanted."""
        system, state = both_down()
        motion = simulate(system, state, 1, 1e-9, max_evaluations=50_000)
        law = system.law
        double = np.char.startswith(motion.phase, "double_")
        assert double.sum() > 10 and motion.reason not in NUMERICAL
        for leg, (i, _, knee, side) in LEGS.items():
            push = getattr(law, f"{leg}_knee_torque") + law.virtual_stiffness * (
                side * motion.q[double, knee] - law.knee_rest
            )
            np.testing.assert_allclose(motion.tau[double, 2 * i + 1], -side * push, rtol=0, atol=1e-9)
            np.testing.assert_allclose(motion.tau[double, 2 * i], getattr(law, f"{leg}_hip_torque"), rtol=0, atol=1e-9)

    @pytest.mark.parametrize("case", ["double stance", -3.0, -2.0, 2.0])
    def test_equations_of_motion(self, case):
        """In slip and double stance too, by the Lagrangian; friction opposes what slides, at its limit."""
        system, state = both_down() if case == "double stance" else (gait(NAMES[0]).system, pitched(NAMES[0], case))
        motion = simulate(system, state, 2, 1e-9, max_evaluations=50_000)
        friction = system.contact.friction
        contacts = {domain.name: domain.contacts for domain in system.domains} | {"chatter": ("open", "open")}
        for i in range(0, len(motion.t), 3):
            terms = rigid(NAMES[0]).terms(motion.q[i], motion.v[i])
            left = terms.mass_matrix @ motion.a[i] + terms.coriolis + terms.gravity
            right = np.array([0.0, 0.0, 0.0, *motion.tau[i]])
            modes = contacts[motion.domain[i]]
            scale = max(1.0, np.abs(left).max())
            for j, (toe, mode) in enumerate(zip(motion.toes, modes, strict=True)):
                force, J = motion.force[i, j], terms.jacobians[toe]
                right = right + J.T @ force
                slide, rise = J @ motion.a[i] + terms.drifts[toe]
                if mode == "open":
                    assert (force == 0.0).all()
                    continue
                assert abs(rise) < 1e-8 * scale and terms.toes[toe][1] == pytest.approx(0.0, abs=1e-7)
                if mode == "stick":
                    assert abs(slide) < 1e-8 * scale and np.abs(J @ motion.v[i]).max() < 1e-6
                else:
                    sense = {"slip+": 1.0, "slip-": -1.0}[mode]
                    assert force[0] == pytest.approx(-sense * friction * force[1], rel=1e-9, abs=1e-6)
                    assert sense * (J @ motion.v[i])[0] > -1e-6
            np.testing.assert_allclose(left, right, rtol=0, atol=1e-8 * scale)

    def test_a_stance_that_resumes_keeps_its_leg_angle(self):
        """A foot back on the ground just after lift-off: its stance goes on where it was."""
        system = gait(NAMES[0]).system
        flight = next(domain for domain in system.domains if domain.name == "flight_1")
        (returns,) = (guard for guard in flight.guards if guard.name == "posterior_return")
        (lands,) = (guard for guard in flight.guards if guard.name == "anterior_touchdown")
        q, v = gait(NAMES[0]).state
        held = {"posterior_leg": 0.7, "anterior_leg": 0.9, "adjust": (1.0, 2.0, 3.0, 4.0, 0.0, 0.0)}
        law = replace(system.law, speed_gain=(5.0, 7.0), speed_nominal=(1.0, 2.0))
        back = returns.reset.latch(q.tolist(), v.tolist(), held, law)
        assert (back["posterior_leg"], back["posterior_taut"], back["posterior_rest"]) == (0.7, 1.0, q[4])
        assert back["posterior_hip_torque"] == pytest.approx(law.posterior_hip_torque + 1.0 + 5.0 * (v[0] - 1.0))
        assert back["posterior_knee_torque"] == pytest.approx(law.posterior_knee_torque + 2.0)
        down = lands.reset.latch(q.tolist(), v.tolist(), held, law)
        assert down["anterior_leg"] == pytest.approx(q[2] + q[5] - q[6] / 2)
        assert down["anterior_hip_torque"] == pytest.approx(law.anterior_hip_torque + 3.0 + 7.0 * (v[0] - 2.0))
        assert down["anterior_knee_torque"] == pytest.approx(law.anterior_knee_torque + 4.0)
        assert down["span"] == pytest.approx(law.anterior_stance_span)
        left = max(1.0 - (q[2] + q[3] - q[4] / 2 - 0.7) / law.posterior_stance_span, 0.2)
        assert back["span"] == pytest.approx(left * law.posterior_stance_span)

    def test_event_feedback(self):
        """At posterior touchdown, once a stride, on all six parameters; not when a stance resumes."""
        found = gait(NAMES[0])
        q, v = found.state
        gains = tuple(tuple(0.1 * (i + 1) + 0.01 * j for j in range(13)) for i in range(len(INPUTS)))
        nominal = (*(q[1:] - 0.01).tolist(), *(v - 0.02).tolist())
        law = replace(found.system.law, feedback=gains, nominal=nominal)
        system = bounding(found.system.robot, law)
        flight = next(domain for domain in system.domains if domain.name == "flight_2")
        (lands,) = (guard for guard in flight.guards if guard.name == "posterior_touchdown")
        held = lands.reset.latch(q.tolist(), v.tolist(), {}, law)
        expected = np.array(gains) @ ([0.01] * 6 + [0.02] * 7)
        np.testing.assert_allclose(held["adjust"], expected, rtol=1e-10)
        assert held["posterior_hip_torque"] == pytest.approx(law.posterior_hip_torque + expected[0])
        assert held["posterior_knee_torque"] == pytest.approx(law.posterior_knee_torque + expected[1])
        lift_off = next(g for g in system.of_phase("posterior_stance")[0].guards if g.name == "posterior_lift_off")
        flying = lift_off.reset.latch(q.tolist(), v.tolist(), held, law)
        target = law.anterior_leg_touchdown + expected[5]
        assert flying["alpha"][2][3:] == pytest.approx((target, target, target), rel=1e-12)
        assert flying["alpha"][3][3:] == (-law.knee_touchdown,) * 3
        assert flying["alpha"][0][2:] == law.flight_1_trailing[0]

    def test_event_feedback_is_limited(self):
        found = gait(NAMES[0])
        q, v = found.state
        limits = (10.0, 20.0, 30.0, 40.0, 0.1, 0.2)
        for sign in (1.0, -1.0):
            gains = ((sign * 1e6,) * 13,) * 6
            nominal = (*(q[1:] - 0.01).tolist(), *(v - 0.01).tolist())
            law = replace(found.system.law, feedback=gains, nominal=nominal, feedback_limits=limits)
            system = bounding(found.system.robot, law)
            held = system.landing[1].latch(q.tolist(), v.tolist(), {}, law)
            assert held["adjust"] == tuple(sign * limit for limit in limits)

    def test_a_knee_that_never_flexed_has_nothing_to_come_back_from(self):
        """The rule of the knee counts from when it has flexed beyond θ̄; until then only a foot without force leaves."""
        found = gait(NAMES[0])
        law = replace(found.system.law, lift_off="knee")
        system = bounding(found.system.robot, law)
        guards = {guard.name: guard for guard in system.of_phase("posterior_stance")[0].guards[:2]}
        q, v = found.state[0].copy(), found.state[1].copy()
        held = system.landing[1].latch(q.tolist(), v.tolist(), {}, law)

        def value(name, knee, **more):
            q[4] = law.knee_rest + knee
            return guards[name].value(0.0, q.tolist(), v.tolist(), {**held, **more}, law, None, None)

        assert value("posterior_flexed", -0.1) > 0.0 > value("posterior_flexed", 0.1)
        assert value("posterior_lift_off", -0.1) > 0.0
        latched = guards["posterior_flexed"].reset.latch(q.tolist(), v.tolist(), held, law)
        assert value("posterior_lift_off", 0.1, **latched) > 0.0 > value("posterior_lift_off", -0.1, **latched)
        assert value("posterior_flexed", 0.1, **latched) > 0.0

    def test_feedback_at_the_nominal_state_changes_nothing(self):
        found = gait(NAMES[0])
        q, v = found.state
        gains = tuple((1.0,) * 13 for _ in INPUTS)
        law = replace(found.system.law, feedback=gains, nominal=(*q[1:].tolist(), *v.tolist()))
        after = return_map(bounding(found.system.robot, law, found.system.spring, found.system.contact), found.state)
        np.testing.assert_allclose(after.state[1], found.state[1], rtol=0, atol=1e-7)


def pitched(name, spin):
    """The section state with pitch rate added, the foot still at rest."""
    q, v = gait(name).state
    v = v + spin * np.eye(7)[2]
    J = gait(name).system.robot.toe_jacobian(q, "posterior_toe")
    J_base = J[:, :2]
    return q, v - np.concatenate([np.linalg.solve(J_base, J @ v), np.zeros(5)])


def both_down():
    """Both feet on the ground at once, legs flexing: a start in double stance."""
    found = gait(NAMES[0])
    robot = found.system.robot
    q, v = found.state[0].copy(), found.state[1].copy()
    q[2] = 0.0
    q[3:] = [0.55, 0.9, -0.35, -0.9]
    toes = robot.toes
    for _ in range(20):  # level the torso so that both toes are as high
        height = np.array([robot.toe_position(q, toe)[1] for toe in toes])
        rows = np.array([robot.toe_jacobian(q, toe)[1] for toe in toes])[:, [1, 2]]
        q[1:3] -= np.linalg.solve(rows, height)
    J = np.concatenate([robot.toe_jacobian(q, toe) for toe in toes])
    v = np.array([1.5, -0.6, 0.2, 0.0, 0.0, 0.0, 0.0])
    v[3:] = -np.linalg.solve(J[:, 3:], J[:, :3] @ v[:3])
    law = replace(found.system.law, feedback=(), speed_gain=(0.0, 0.0))
    return bounding(robot, law), (q, v)


class TestDisturbed:
    @staticmethod
    def start(seed):
        """A section state far from a gait's, the other foot in the air."""
        rng = np.random.default_rng(seed)
        found = gait(NAMES[seed % len(NAMES)])
        local = chart(found.system, found.state)
        for _ in range(50):
            size = 10.0 ** rng.uniform(-2.0, -0.3)
            scale = np.repeat([0.2, 1.5], [local.q_basis.shape[1], local.v_basis.shape[1]])
            state = local.state(size * scale * rng.normal(size=local.dimension))
            if found.system.robot.toe_position(state[0], "anterior_toe")[1] > 1e-3:
                return found.system, state
        raise AssertionError("no start above the ground")

    @pytest.mark.slow
    @pytest.mark.parametrize("first", range(0, 40, 10))
    def test_ends_with_a_physical_reason(self, first):
        reasons = []
        for seed in range(first, first + 10):
            system, state = self.start(seed)
            result = run(system, state, 3, Options(1e-8, max_evaluations=200_000))
            assert result.reason not in NUMERICAL, (seed, result.message)
            assert np.isfinite(np.concatenate(result.state)).all(), seed
            assert all(np.isfinite(event.v).all() and np.isfinite(event.impulse).all() for event in result.events), seed
            assert all(event.work.get("impact", 0.0) <= 1e-9 for event in result.events), seed
            reasons.append(result.reason)
        assert "complete" in reasons

    @pytest.mark.parametrize("seed", range(6))
    def test_ledger_closes(self, seed):
        system, state = self.start(seed)
        motion = simulate(system, state, 2, 1e-9, max_evaluations=200_000)
        assert np.abs(motion.ledger.residual).max(initial=0.0) < 1e-5


class TestLaw:
    @pytest.mark.parametrize(
        ("field", "value"),
        [
            ("virtual_stiffness", -1.0),
            ("epsilon", 0.0),
            ("epsilon", -0.01),
            ("knee_rest", 0.0),
            ("knee_rest", math.pi),
            ("knee_touchdown", -0.7),
            ("posterior_stance_span", 0.3),
            ("anterior_stance_span", 0.0),
            ("flight_1_span", 0.0),
            ("flight_2_span", -0.1),
            ("posterior_hip_torque", math.nan),
            ("anterior_knee_torque", math.inf),
            ("posterior_leg_touchdown", None),
            ("lift_off", "hand"),
            ("lift_off", ""),
            ("lift_off", 3),
            ("feedback", ((0.0,) * 13,) * 5),
            ("feedback", ((0.0,) * 12,) * 6),
        ],
    )
    def test_bad_value(self, field, value):
        with pytest.raises(BadValue) as caught:
            replace(gait(NAMES[0]).system.law, **{field: value})
        assert caught.value.name == f"BoundingLaw.{field}"

    @pytest.mark.parametrize("source", ["spear_ii", "q_spear_full"])
    def test_other_robots(self, source):
        with pytest.raises(BadValue, match="^robot is "):
            bounding(load(source), gait(NAMES[0]).system.law)

    @pytest.mark.parametrize("options", [{"locked": ["pitch"]}, {"toes": ["anterior_toe", "posterior_toe"]}])
    def test_other_models_of_the_robot(self, options):
        with pytest.raises(BadValue, match="^robot is "):
            bounding(load("q_spear", **options), gait(NAMES[0]).system.law)

    def test_no_guess_without_a_nominal_state(self):
        law = replace(gait(NAMES[0]).system.law, nominal=(), feedback=())
        with pytest.raises(BadValue, match="BoundingLaw.nominal"):
            bounding(load("q_spear"), law).guess()
