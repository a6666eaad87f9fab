"""Legs of any quadruped in space: by their pairs, axes and zeros, whatever the robot calls them."""

from functools import cache

import numpy as np
import pytest

from spear_pin import SpatialLaw, load, sagittal
from spear_pin.errors import BadValue
from spear_pin.gaits.orbits.embedding import embed, whole
from spear_pin.gaits.spatial.automaton import Automaton
from spear_pin.gaits.spatial.legs import Group, move_in_space, pairs_of, place_in_space, sides_of, together
from spear_pin.gaits.virtual_constraints import jet, value
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.symmetry import asymmetry, mirror_of
from spear_pin.model.loading import path_of
from spear_pin.model.spring import Spring
from tests.gaits.orbits.test_embedding import planar, spatial
from tests.model.legged import quadruped

RENAMED = {"posterior_left": "HL", "posterior_right": "HR", "anterior_left": "FL", "anterior_right": "FR"}
MADE = {
    "mirrored": {},
    "hips about -y": {"hip": -1},
    "knees about -y": {"knee": -1},
    "toes ahead": {"hip": -1, "ahead": 0.04},
}


@cache
def made(folder, **of_leg):
    path = folder / "made.urdf"
    path.write_text(quadruped(**of_leg))
    plane = sagittal(load(path))
    return plane, whole(plane)


@pytest.mark.parametrize("of_leg", MADE.values(), ids=MADE)
class TestConvention:
    """γ is the angle of the line from hip to toe, the knee's that of the plane, with slopes to match."""

    def test_configurations_are_the_planes(self, of_leg, tmp_path):
        plane, robot = made(tmp_path, **of_leg)
        pairs = pairs_of(robot)
        planar_q = np.random.default_rng(1).uniform(-1.0, 1.0, 7)
        q = place_in_space(robot, pairs, planar_q)
        for end, pair in zip(("posterior", "anterior"), pairs, strict=True):
            place = plane.toe_position(planar_q, f"{end}_toe")
            hip = plane.frame_position(planar_q, f"{end}_hip")
            for leg in pair:
                np.testing.assert_allclose(robot.toe_position(q, leg.toe)[[0, 2]], place, rtol=0, atol=1e-12)
                ahead, _, up = place[0] - hip[0], 0.0, place[1] - hip[-1]
                assert np.cos(value(leg.angle, q) - np.arctan2(ahead, -up)) == pytest.approx(1.0, abs=1e-12)
                assert value(leg.controlled[1], q) == pytest.approx(planar_q[plane.index(f"{end}_knee")])
                assert leg.flexion(q) == pytest.approx(leg.bends * planar_q[plane.index(f"{end}_knee")])

    def test_velocities_are_the_planes(self, of_leg, tmp_path):
        plane, robot = made(tmp_path, **of_leg)
        pairs = pairs_of(robot)
        planar_q, planar_v = np.random.default_rng(2).uniform(-1.0, 1.0, (2, 7))
        q, v = place_in_space(robot, pairs, planar_q), move_in_space(robot, pairs, planar_v)
        for end, pair in zip(("posterior", "anterior"), pairs, strict=True):
            for leg in pair:
                found = robot.toe_jacobian(q, leg.toe) @ v
                np.testing.assert_allclose(
                    found[[0, 2]], plane.toe_jacobian(planar_q, f"{end}_toe") @ planar_v, atol=1e-12
                )

    def test_slopes(self, of_leg, tmp_path):
        _, robot = made(tmp_path, **of_leg)
        q, v = np.random.default_rng(3).uniform(-1.0, 1.0, (2, robot.nv))
        step = 1e-4
        for pair in pairs_of(robot):
            for leg in pair:
                for variable in leg.controlled:
                    before, now, after = (value(variable, q + x * step * v) for x in (-1.0, 0.0, 1.0))
                    found, rate = jet(variable, q, v), (after - before) / (2.0 * step)
                    assert (found.value, found.rate) == pytest.approx((now, rate), abs=1e-7)
                    assert sum(weight * v[index] for index, weight in found.row) == pytest.approx(rate, abs=1e-7)
                    assert found.drift == pytest.approx((after - 2.0 * now + before) / step**2, abs=1e-6)

    def test_the_mirror_leaves_the_toes_mirrored(self, of_leg, tmp_path):
        _, robot = made(tmp_path, **of_leg)
        mirror, q = mirror_of(robot), np.random.default_rng(4).uniform(-1.0, 1.0, robot.nv)
        seen = mirror(q)
        for left, right in pairs_of(robot):
            for one, other in ((left, right), (right, left)):
                place = robot.toe_position(q, one.toe) * (1.0, -1.0, 1.0)
                np.testing.assert_allclose(robot.toe_position(seen, other.toe), place, rtol=0, atol=1e-12)


@cache
def renamed(folder):
    """Q-SPEAR with legs of other names, axes of hips, knees and adductions turned round, and limits that tell sides."""
    text = path_of("q_spear_full").read_text(encoding="utf-8")
    for name, short in RENAMED.items():
        text = text.replace(name, short)
    for axis, other in (("1 0 0", "-1 0 0"), ("0 -1 0", "0 +1 0"), ("0 1 0", "0 -1 0")):
        text = text.replace(f'<axis xyz="{axis}"/>', f'<axis xyz="{other}"/>')
    hind, fore = text.partition('<joint name="FL_adduction"')[::2]
    text = hind.replace('lower="-2.8" upper="2.8"', 'lower="-2.8" upper="0"') + '<joint name="FL_adduction"'
    text += fore.replace('lower="-2.8" upper="2.8"', 'lower="0" upper="2.8"')
    path = folder / "renamed.urdf"
    path.write_text(text)
    return load(path, base="chain", toes=[f"{leg}_toe" for leg in ("FR", "HL", "FL", "HR")])


@pytest.mark.slow
def test_whatever_the_legs_are_called(tmp_path):
    """A stride of Q-SPEAR, pushed to the side, with joints that turn the other way and toes in another order."""
    system, (q, v) = spatial("long_stride")
    robot = renamed(tmp_path)
    other, state = embed(planar("long_stride"), robot=robot)
    assert other.law == system.law and other.overlap == system.overlap
    signs = np.r_[np.ones(6), -np.ones(12)]
    names = [
        *system.robot.coordinates[:6],
        *(f"{RENAMED[n.rpartition('_')[0]]}_{n.rpartition('_')[2]}" for n in system.robot.coordinates[6:]),
    ]
    rows = [robot.index(name) for name in names]
    for part, own in zip(state, (q, v), strict=True):
        np.testing.assert_allclose(part[rows], signs * own, rtol=0, atol=1e-12)
    v = v.copy()
    v[1] += 0.05
    pushed = np.empty(18)
    pushed[rows] = signs * v
    here, there = return_map(system, (q, v), 1e-11), return_map(other, (state[0], pushed), 1e-11)
    assert [event.name for event in here.events] == [event.name for event in there.events]
    for part, own in zip(there.state, here.state, strict=True):
        np.testing.assert_allclose(part[rows], signs * own, rtol=0, atol=1e-7)


def test_a_symmetric_state_is_its_own_image():
    system, (q, v) = spatial("long_stride")
    assert asymmetry(system.robot, (q, v)) == 0.0
    v = v.copy()
    v[1] += 0.05
    assert asymmetry(system.robot, (q, v)) == pytest.approx(0.1)


def test_numbers_of_adduction_go_by_size(tmp_path):
    plane, law = planar("long_stride").system.law, SpatialLaw(planar("long_stride").system.law)
    _, robot = made(tmp_path)
    scaled = SpatialLaw.scaled(plane, robot)
    ratio = scaled.adduction_stiffness / law.adduction_stiffness
    times = scaled.adduction_epsilon / law.adduction_epsilon
    assert 0.0 < ratio < 0.5 and 0.5 < times < 1.0
    assert scaled.adduction_damping == pytest.approx(law.adduction_damping * ratio * times)


class TestGroups:
    def test_all_four(self):
        (group,) = together(load("q_spear_full", base="chain"))
        pairs = pairs_of(load("q_spear_full", base="chain"))
        assert group.legs == (*pairs[0], *pairs[1])

    def test_phases_of_any_two(self):
        """Three legs and one: a phase for each set that bears, and one more before each touchdown that closes."""
        robot = load("q_spear_full", base="chain")
        (group,) = together(robot)
        three, one = Group("three", group.legs[:3], "flight_1"), Group("one", group.legs[3:], "flight_2")
        automaton = Automaton(robot, (three, one), ("three_touchdown",), (three,), "knee")
        assert automaton.phase(group.legs[:3]) == "three_stance" and automaton.phase(group.legs[3:]) == "one"
        assert automaton.phase(group.legs[1:3]) == "posterior_right+anterior_left_stance"
        phases = {domain.phase for domain in automaton.domains({"knee": Spring(28.0)})}
        assert len(phases) == 15 + 2 + 2  # three in the air, flying to their touchdown or with the one on the ground


class TestPairs:
    def test_diagonals(self):
        first, second = sides_of(load("q_spear_full", base="chain"), across=True)
        assert [leg.name for leg in first] == ["posterior_right", "anterior_left"]
        assert [leg.name for leg in second] == ["posterior_left", "anterior_right"]

    def test_a_base_that_is_no_chain(self):
        with pytest.raises(BadValue, match="chain"):
            pairs_of(load("q_spear_full"))

    def test_toes_that_are_missing(self):
        with pytest.raises(BadValue, match="toes"):
            pairs_of(load("q_spear_full", base="chain", toes=["posterior_left_toe"]))

    def test_legs_without_motors(self):
        with pytest.raises(BadValue, match="motors"):
            pairs_of(load("q_spear_full", base="chain", motors=["posterior_left_hip"]))

    def test_all_motors_are_none_of_the_chains(self):
        assert len(load("q_spear_full", base="chain", motors="all").actuated) == 12

    def test_a_plane_that_no_robot_was_cut_to(self):
        with pytest.raises(BadValue, match="sagittal"):
            whole(load("biped"))
