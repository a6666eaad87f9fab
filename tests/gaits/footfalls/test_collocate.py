"""Gaits of given footfalls by collocation, each checked by Pinocchio, which the programme does not use.

What needs CasADi is skipped without it.
"""

import warnings
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import load, trotting
from spear_pin.errors import BadValue, Infeasible, NoGait
from spear_pin.gaits.footfalls.beside import law_of_trot
from spear_pin.gaits.footfalls.collocate import collocate
from spear_pin.gaits.footfalls.limbs import legs_of
from spear_pin.gaits.footfalls.request import FootfallRequest, StanceLaw, SwingLaw
from spear_pin.gaits.footfalls.sequence import FOOTFALLS, opposite
from spear_pin.gaits.objectives import in_its_unit
from spear_pin.gaits.spatial.legs import pairs_of
from spear_pin.gaits.virtual_constraints import Outputs, Sum, errors, value
from spear_pin.hybrid.periodic import chart, displacement, return_map
from spear_pin.hybrid.symmetry import head_state, mirror_of, turn_state
from spear_pin.model.catalogue import motor
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.model.scale import scale_in_space
from tests.gaits.footfalls.checking import violations

pytestmark = pytest.mark.extra("casadi")
COARSE = replace(FOOTFALLS["trot"], intervals=(3, 2))
TURN = np.radians(15.0)


@pytest.fixture(scope="module")
def robot():
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of CasADi's wrappers as they are imported
        import casadi  # noqa: F401
    return load("q_spear_full", base="chain")


@pytest.fixture(scope="module")
def trot(robot):
    return collocate(robot, FootfallRequest(footfalls=COARSE, speed=2.0))


@pytest.fixture(scope="module")
def lawful(robot):
    return collocate(robot, FootfallRequest(footfalls=COARSE, speed=2.0, law=StanceLaw()))


def lacking(robot, stretch, node):
    """Forces that the motion at a node lacks, (18,)."""
    q, v, a = (part[node] for part in (stretch.q, stretch.v, stretch.a))
    given = np.concatenate([np.zeros(6), stretch.needed[node]])
    for leg, force in stretch.forces.items():
        given += robot.toe_jacobian(q, f"{leg}_toe").T @ force[node]
    return robot.mass_matrix(q) @ a + robot.bias(q, v) - given


class TestTrot:
    def test_motion_at_the_nodes(self, robot, trot):
        for stretch in trot.stretches:
            for node in range(len(stretch.t)):
                assert np.abs(lacking(robot, stretch, node)).max() < 1e-4
                for leg in stretch.bearing:
                    q, v, a = (part[node] for part in (stretch.q, stretch.v, stretch.a))
                    jacobian = robot.toe_jacobian(q, f"{leg}_toe")
                    drift = robot.toe_drift(q, v, f"{leg}_toe")
                    np.testing.assert_allclose(jacobian @ a + drift, 0.0, atol=1e-5)

    def test_forces_and_torques_within_what_is_asked(self, robot, trot):
        request, stretch = trot.request, trot.stretches[0]
        for leg, force in stretch.forces.items():
            assert force[:, 2].min() >= request.minimum_force - 1e-5
            assert (np.hypot(force[:, 0], force[:, 1]) <= request.friction * force[:, 2] + 1e-4).all()
            assert (
                np.hypot(*stretch.impulses[opposite(leg)][:2]) <= request.friction * stretch.impulses[opposite(leg)][2]
            )
        limits = [robot.limits[name].effort for name in robot.coordinates[6:]]
        assert all((np.abs(each.u) <= limits).all() for each in trot.stretches)
        assert all(np.abs(each.q[:, 6::3]).max() <= request.adduction + 1e-6 for each in trot.stretches)

    def test_springs_are_between_joints_and_motors(self, robot, trot):
        stretch, limbs = trot.stretches[0], legs_of(robot)
        for leg in stretch.bearing:
            knee, side = limbs[leg].knee, limbs[leg].side
            flexed = np.maximum(side * (stretch.q[:, knee] - stretch.q[0, knee]), 0.0)
            share = (stretch.needed - stretch.u)[:, knee - 6]
            np.testing.assert_allclose(share, -side * 56.0 * flexed, atol=0.05)
        np.testing.assert_array_equal(trot.stretches[1].needed, trot.stretches[1].u)

    def test_closes_by_an_impact_in_the_mirror(self, robot, trot):
        mirror, first, last = mirror_of(robot), trot.stretches[0], trot.stretches[-1]
        image = mirror(first.q[0])
        image[0] += 0.5 * trot.request.speed * trot.period
        np.testing.assert_allclose(last.q[-1], image, atol=1e-7)
        change = robot.mass_matrix(last.q[-1]) @ (mirror(first.v[0]) - last.v[-1])
        for leg, impulse in first.impulses.items():
            jacobian = robot.toe_jacobian(last.q[-1], f"{leg}_toe")
            change -= jacobian.T @ impulse
            np.testing.assert_allclose(jacobian @ mirror(first.v[0]), 0.0, atol=1e-7)
            assert robot.toe_position(last.q[-1], f"{leg}_toe")[2] == pytest.approx(0.0, abs=1e-7)
            assert (jacobian @ last.v[-1])[2] < 0.0
        np.testing.assert_allclose(change, 0.0, atol=1e-6)

    def test_between_nodes(self, trot):
        found = violations(trot)
        assert found.motion < 0.05 and found.turning < 0.05
        assert found.torque == 0.0

    def test_from_another_one(self, robot, trot):
        again = collocate(robot, trot.request, start=trot.solution)
        assert again.effort_per_distance == pytest.approx(trot.effort_per_distance, rel=1e-6)
        assert again.solution.iterations < trot.solution.iterations


class TestLaw:
    def test_torques_on_the_ground(self, robot, lawful):
        """In the form of `spatial.law.support`."""
        law, stretch, limbs = lawful.request.law, lawful.stretches[0], legs_of(robot)
        for leg, (hip, knee, upright) in lawful.constants.items():
            limb = limbs[leg]
            flexed = limb.side * stretch.q[:, limb.knee] - law.knee_rest
            off = stretch.q[:, limb.adduction] - stretch.q[0, limb.adduction]
            held = upright - law.adduction_stiffness * off - law.adduction_damping * stretch.v[:, limb.adduction]
            np.testing.assert_allclose(stretch.u[:, limb.hip - 6], hip, atol=1e-5)
            total = -limb.side * (knee + law.stiffness * flexed)
            np.testing.assert_allclose(stretch.needed[:, limb.knee - 6], total, atol=1e-5)
            np.testing.assert_allclose(stretch.u[:, limb.adduction - 6], held, atol=1e-5)
            np.testing.assert_allclose(flexed[[0, -1]], 0.0, atol=1e-7)


@pytest.fixture(scope="module")
def controlled(robot):
    return collocate(robot, FootfallRequest(speed=2.0, law=StanceLaw(), swing=SwingLaw()))


@pytest.mark.slow
class TestLawInTheAir:
    def test_a_half_stride_of_the_event_exact_simulation_leads_nearly_back(self, robot, controlled):
        last, mirror = controlled.stretches[-1], mirror_of(robot)
        system = trotting(robot, law_of_trot(controlled), controlled.request.spring)
        start = chart(system, head_state(mirror(last.q[-1]), mirror(last.v[-1]))).state(np.zeros(32))
        run = return_map(system, start, 1e-8)
        assert run.durations["diagonal_left_stance"] == pytest.approx(controlled.stretches[0].duration, abs=1e-3)
        assert run.durations["flight_2"] == pytest.approx(controlled.stretches[1].duration, abs=1e-3)
        missed = np.abs(displacement(system, start, run.state))
        assert missed[:18].max() < 0.03 and missed[18:24].max() < 0.1  # rates of knees that trail are worse

    def test_outputs_are_zero(self, robot, controlled):
        """What the law controls in the air is where it is to be, by the functions that simulation runs."""
        request, gait = controlled.request, controlled
        legs = {leg.name: leg for pair in pairs_of(robot) for leg in pair}
        for stretch in gait.stretches:
            bearing = [legs[name] for name in stretch.bearing]
            for name, evolution in stretch.evolutions.items():
                phase = Sum(tuple((0.5, leg.angle) for leg in bearing)) if bearing else ((0, 1.0),)
                outputs = Outputs(legs[name].controlled, phase, ())
                for q, v in zip(stretch.q[:-1], stretch.v[:-1], strict=True):
                    y, dy = errors(outputs, evolution, q, v)
                    np.testing.assert_allclose(y, 0.0, atol=5e-3)
                    np.testing.assert_allclose(dy, 0.0, atol=0.3)
                i = legs[name].adduction
                off, rate, epsilon = stretch.q[:, i] - gait.aims[name], stretch.v[:, i], request.swing.adduction_epsilon
                np.testing.assert_allclose(stretch.a[:, i], -off / epsilon**2 - 2.0 * rate / epsilon, atol=1e-4)
        last = gait.stretches[1]
        for name in ("posterior_right", "anterior_left"):
            q, v = last.q[-1].tolist(), last.v[-1].tolist()
            assert value(legs[name].angle, q) == pytest.approx(last.evolutions[name].alpha[0][-1], abs=5e-3)
            assert value(legs[name].angle, v) == pytest.approx(0.0, abs=0.3)
            assert abs(q[legs[name].knee]) == pytest.approx(request.law.knee_rest, abs=1e-6)


def largest(gait, part=slice(None)):
    """Largest torque of some motors, of each leg in order of adduction, hip and knee."""
    return max(np.abs(stretch.u[:, part]).max() for stretch in gait.stretches)


@pytest.mark.slow
class TestWishes:
    """What a request for a bound may ask, a request in space may ask, too."""

    def wished(self, robot, trot, **wishes):
        return collocate(robot, replace(trot.request, **wishes), start=trot.solution)

    def test_least_peak(self, robot, trot):
        found = self.wished(robot, trot, objective="peak")
        assert largest(found) < 0.5 * largest(trot)
        assert in_its_unit(found.request, scale_in_space(robot), found.solution) == pytest.approx(largest(found))

    def test_hips_spared(self, robot, trot):
        found = self.wished(robot, trot, objective="hip")
        hips = [sum(float((each.u[:, 1::3] ** 2).sum()) for each in gait.stretches) for gait in (found, trot)]
        assert hips[0] < 0.5 * hips[1]

    def test_hip_torque(self, robot, trot):
        most = 0.5 * largest(trot, slice(1, None, 3))
        assert largest(self.wished(robot, trot, hip_torque=most), slice(1, None, 3)) <= most * (1.0 + 1e-6)

    def test_drives(self, robot, trot):
        """Torques at the nodes are within the envelope by the motor's own rule."""
        drive = Drive(motor("assumed_600w"), Gearbox(4.0, 0.9), 48.0)
        found = self.wished(robot, trot, knee_drive=drive, hip_drive=drive)
        for stretch in found.stretches:
            for part in (1, 2):
                torque, rate = stretch.u[:, part::3], stretch.v[:, 6 + part :: 3]
                assert np.min(drive.margin(torque, rate)) > -1e-4

    def test_what_is_out_of_reach_is_named(self, robot, trot):
        with pytest.raises(Infeasible, match="mean speed.*m/s.*try speed=") as caught:
            self.wished(robot, trot, speed=20.0)
        assert caught.value.violation > 1.0 and caught.value.unit == "m/s"

    def test_a_wish_that_asks_for_another_is_named(self, robot, trot):
        with pytest.raises(Infeasible, match="duration of the stride.*longest_stride="):
            self.wished(robot, trot, clearance=0.8)


@pytest.mark.slow
class TestOthers:
    def test_finer_meshes_are_truer(self, robot, trot):
        coarse, fine = (violations(gait) for gait in (trot, collocate(robot, trot.request, meshes=(1, 3))))
        assert fine.slip < coarse.slip / 5.0
        assert fine.motion < coarse.motion / 3.0

    def test_the_whole_stride_is_the_mirrored_one(self, robot, trot):
        whole = collocate(robot, replace(trot.request, footfalls=COARSE.unfolded), start=None)
        assert whole.effort_per_distance == pytest.approx(trot.effort_per_distance, rel=1e-3)
        assert whole.period == pytest.approx(trot.period, rel=1e-2)

    def test_turning(self, robot):
        gait = collocate(robot, FootfallRequest(footfalls=COARSE.unfolded, turn=TURN))
        first, last = gait.stretches[0], gait.stretches[-1]
        place = 2.0 * gait.period * np.sinc(0.5 * TURN / np.pi) * np.array([np.cos(0.5 * TURN), np.sin(0.5 * TURN)])
        q, v = turn_state(first.q[0], first.v[0], TURN, place)
        np.testing.assert_allclose(last.q[-1], q, atol=1e-7)
        change = robot.mass_matrix(q) @ (v - last.v[-1])
        pushed = sum(robot.toe_jacobian(q, f"{leg}_toe").T @ impulse for leg, impulse in first.impulses.items())
        np.testing.assert_allclose(change, pushed, atol=1e-6)

    @pytest.mark.parametrize(("name", "speed"), [("pace", 2.0), ("pronk", 2.0), ("bound", 2.5)])
    def test_gaits(self, robot, name, speed):
        gait = collocate(robot, FootfallRequest(footfalls=FOOTFALLS[name], speed=speed))
        found = violations(gait)
        assert found.motion < 0.05 and found.slip < 0.05
        if name != "pace":
            assert max(np.abs(each.q[:, [1, 3, 5]]).max() for each in gait.stretches) < 1e-3

    @pytest.mark.extra("example-robot-data")
    def test_another_robot(self):
        solo = load("solo12", base="chain", motors="all", toes=[f"{leg}_FOOT" for leg in ("FL", "FR", "HL", "HR")])
        gait = collocate(solo, FootfallRequest.scaled(solo))
        assert gait.request.speed == pytest.approx(1.419, abs=1e-3)
        assert violations(gait).slip < 0.02


def test_a_law_of_a_trot_asks_for_one_in_the_air(lawful):
    with pytest.raises(BadValue, match="SwingLaw"):
        law_of_trot(lawful)


def test_says_what_is_missed(robot):
    with pytest.raises(NoGait, match="misses"):
        collocate(robot, FootfallRequest(footfalls=COARSE), iterations=3)


def test_refuses_no_mesh(robot):
    with pytest.raises(BadValue, match="meshes"):
        collocate(robot, FootfallRequest(), meshes=())
