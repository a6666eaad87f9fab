"""Bounds off their path: early feet, slip and double stance, by the Lagrangian; and how they end."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from spear_pin import bounding, simulate
from spear_pin.gaits.bounding_law import evolution
from spear_pin.gaits.virtual_constraints import SLOWEST, dot, errors
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.reasons import NUMERICAL
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from tests.gaits.bounding_gaits import LEGS, NAMES, OUTPUTS, each_gait, gait, rigid
from tests.slow import slow_but

SPINS = slow_but((-4.0, -3.0, -2.0, -1.0, 1.0, 2.0), 1.0)  # rad/s added to the pitch


def pitched(name, spin):
    """The section state with pitch rate added, the foot still at rest."""
    q, v = gait(name).state
    v = v + spin * np.eye(7)[2]
    J = gait(name).system.robot.toe_jacobian(q, "posterior_toe")
    J_base = J[:, :2]
    return q, v - np.concatenate([np.linalg.solve(J_base, J @ v), np.zeros(5)])


@cache
def disturbed(name, spin):
    """Two strides from there, their motion kept."""
    return run(gait(name).system, pitched(name, spin), 2, Options(1e-8, max_evaluations=50_000, keep=True))


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
    law = replace(found.system.law, speed_gain=(0.0, 0.0))
    return bounding(robot, law), (q, v)


def chattering(forces, friction):
    """What each toe does while one alternates: that bears nothing, as one in the air; another sticks, or slides."""
    modes = []
    for tangential, normal in forces:
        sticks = abs(tangential) < friction * normal * (1.0 - 1e-9)
        closed = "stick" if sticks else "slip+" if tangential < 0.0 else "slip-"
        modes.append(closed if normal else "open")
    return modes


class TestTransitions:
    """What happens off the nominal path."""

    @each_gait
    @pytest.mark.parametrize("spin", SPINS)
    def test_outputs_begin_at_zero_after_every_transition(self, name, spin):
        """With pitch rate added: whatever comes, each phase begins with y = ẏ = 0, (5.22)."""
        result = disturbed(name, spin)
        assert result.reason not in NUMERICAL, result.message
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

    @pytest.mark.slow
    def test_double_stance_and_slip(self):
        """Raising the pitch rate brings the next foot down early, and feet slide."""
        domains = {event.domain for event in disturbed("long_stride", 2.0).events}
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

    @pytest.mark.slow
    @pytest.mark.parametrize("case", ["double stance", -3.0, -2.0, 2.0])
    def test_equations_of_motion(self, case):
        """In slip and double stance too, by the Lagrangian; friction opposes what slides, at its limit."""
        system, state = both_down() if case == "double stance" else (gait(NAMES[0]).system, pitched(NAMES[0], case))
        motion = simulate(system, state, 2, 1e-9, max_evaluations=50_000)
        friction = system.contact.friction
        contacts = {domain.name: domain.contacts for domain in system.domains}
        for i in range(0, len(motion.t), 3):
            terms = rigid(NAMES[0]).terms(motion.q[i], motion.v[i])
            left = terms.mass_matrix @ motion.a[i] + terms.coriolis + terms.gravity
            right = np.array([0.0, 0.0, 0.0, *motion.tau[i]])
            modes = contacts.get(motion.domain[i]) or chattering(motion.force[i], friction)
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

    @pytest.mark.parametrize("seed", slow_but(range(6), 0, 1))
    def test_ledger_closes(self, seed):
        system, state = self.start(seed)
        motion = simulate(system, state, 2, 1e-9, max_evaluations=200_000)
        assert np.abs(motion.ledger.residual).max(initial=0.0) < 1e-5
