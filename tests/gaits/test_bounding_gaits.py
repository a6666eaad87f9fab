"""The bounding gaits that ship: every claim about them, by means other than the package's."""

import re

import numpy as np
import pytest

from spear_pin import Trajectory, simulate
from spear_pin.gaits.bounding_law import evolution
from spear_pin.gaits.virtual_constraints import errors
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.periodic import chart, residual
from tests.gaits.bounding_gaits import LEGS, OUTPUTS, PHASES, each_gait, gait, rigid, stride, trajectory

SPEED = 2.5  # m/s: at which those run whose names do not say another
FRICTION = 0.6  # that they may use, of the ground's 0.8


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

    @pytest.mark.slow
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

    @pytest.mark.slow
    def test_stays_for_some_strides(self, name):
        """However unstable it is, it is a gait."""
        motion = simulate(gait(name).system, gait(name).state, 3, 1e-11)
        assert motion.complete
        np.testing.assert_allclose(motion.events[-1].v, gait(name).state[1], rtol=0, atol=1e-6)

    def test_multipliers(self, name):
        found = np.abs(gait(name).multipliers)
        assert len(found) == chart(gait(name).system, gait(name).state).dimension == 10
        assert (np.diff(found) <= 1e-9).all()
