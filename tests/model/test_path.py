"""Lengths of paths and their slopes, against geometry, Pinocchio's forces, differences and published numbers."""

import json
import math
from dataclasses import replace

import numpy as np
import pinocchio as pin
import pytest
from scipy.spatial import ConvexHull

from spear_pin import Spring, load
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.dynamics import FLOATS
from spear_pin.model.cable import Anchor, Between, Over
from spear_pin.model.equations import mechanism_of
from spear_pin.model.frames import frame_id
from spear_pin.model.linkage import Linkage, SliderLinkage
from spear_pin.model.path import Joints, Sum
from spear_pin.model.path_data import path_data, path_of, spring_data
from spear_pin.model.robot_posture import RobotPosture, find_spanned

LEG = load("spear_ii", locked=["boom_x"])
FULL = load("q_spear_full", base="chain")
THIGH = LEG.legs[0].thigh
PATELLA = Between(Anchor("thigh", (0.03, 0.0, -0.1)), Anchor("shank", (0.012, 0.0, 0.054)))
ACROSS = Between(Anchor("torso", (-0.2, 0.2, 0.03)), Anchor("posterior_left_shank", (0.03, 0.01, -0.08)))
PULLEY = Over(Anchor("thigh", (0.0, 0.0, 0.15 - THIGH)), Anchor("knee", (0, 0, 0)), Anchor("shank", (0, 0, -0.1)), 0.03)
LINKAGE = Linkage("knee", 0.03, 0.12, offset=0.01, zero=-0.3)
PATHS = {
    "joints": (LEG, Joints({"knee": 0.03, "hip": -0.006})),
    "patella": (LEG, PATELLA),
    "from the ground": (LEG, Between(Anchor("universe", (0.1, 0.0, 0.2)), Anchor("shank", (0.01, 0.0, -0.1)))),
    "pulley": (LEG, PULLEY),
    "linkage": (LEG, LINKAGE),
    "sum": (LEG, Sum([(2.0, PATELLA), (-0.5, Joints({"hip": 0.02}))])),
    "across": (FULL, ACROSS),
    "from leg to leg": (
        FULL,
        Between(Anchor("posterior_left_shank", (0.01, 0, -0.1)), Anchor("anterior_left_thigh", (0, 0, -0.1))),
    ),
}
each_path = pytest.mark.parametrize("name", PATHS)


def postures(robot, q):
    return RobotPosture(robot, FLOATS).at(np.array(q)), mechanism_of(robot).posed(list(q), FLOATS)


def somewhere(robot, seed=3):
    q = np.random.default_rng(seed).uniform(-0.7, 0.7, robot.nv)
    q[robot.coordinates.index("knee") if "knee" in robot.coordinates else -1] = 0.9
    return q


class TestSlope:
    @each_path
    def test_is_how_the_length_changes(self, name):
        robot, path = PATHS[name]
        q, h = somewhere(robot), 1e-5
        here, also = postures(robot, q)
        assert path.length(here) == pytest.approx(path.length(also), rel=1e-13)
        slope = np.zeros(robot.nv)
        for i, value in path.slope(here).items():
            slope[i] = value
            assert path.slope(also)[i] == pytest.approx(value, abs=1e-12)
        for i, way in enumerate(np.eye(robot.nv)):
            length = [path.length(postures(robot, q + step * way)[0]) for step in (-2 * h, -h, h, 2 * h)]
            difference = (length[0] - 8 * length[1] + 8 * length[2] - length[3]) / (12 * h)
            assert slope[i] == pytest.approx(difference, abs=1e-9)

    @each_path
    def test_is_zero_but_for_what_it_spans(self, name):
        robot, path = PATHS[name]
        names = {robot.coordinates[i] for i in path.slope(postures(robot, somewhere(robot))[0])}
        assert names == {*find_spanned(path, robot)}

    def test_of_a_biarticular_cable_over_a_robot_in_space(self):
        angles = {"torso_x": 0.1, "torso_y": -0.05, "torso_z": 0.6, "roll": 0.1, "pitch": -0.15, "yaw": 0.2}
        angles |= {"posterior_left_adduction": 0.12, "posterior_left_hip": 0.45, "posterior_left_knee": 0.8}
        rates = {"posterior_left_adduction": -0.5, "posterior_left_hip": 2.0, "posterior_left_knee": 4.0}
        q, v = (np.array([values.get(name, 0.0) for name in FULL.coordinates]) for values in (angles, rates))
        for posture in postures(FULL, q):
            slope = ACROSS.slope(posture)
            length, rate = ACROSS.length(posture), slope.rate(v)
            force = 5000.0 * (length - 0.3) + 12.0 * rate
            assert (length, rate, force) == pytest.approx((0.398319972, -0.264576474, 488.424943), abs=1e-6)
            torques = {FULL.coordinates[i]: -force * value for i, value in slope.items()}
            assert torques == pytest.approx(dict(zip(rates, (20.047797, 72.644462, -1.509819), strict=True)), abs=1e-6)

    def test_gives_the_torques_of_two_forces_on_the_bodies(self):
        q, still = somewhere(FULL), np.zeros(FULL.nv)
        model, data, posture = FULL.model, pin.Data(FULL.model), postures(FULL, q)[0]
        pin.framesForwardKinematics(model, data, q)
        forces = pin.StdVec_Force([pin.Force.Zero() for _ in range(model.njoints)])
        ends = [each.seen(posture).position for each in (ACROSS.start, ACROSS.end)]
        along = np.subtract(*ends) / ACROSS.length(posture)
        for anchor, place, sign in zip((ACROSS.start, ACROSS.end), ends, (-1.0, 1.0), strict=True):
            joint = model.frames[frame_id(model, anchor.body)].parentJoint
            at_place = pin.Force(sign * along, np.cross(place, sign * along))
            forces[joint] = data.oMi[joint].actInv(at_place)
        pulled = pin.rnea(model, data, q, still, still) - pin.rnea(model, data, q, still, still, forces)
        wanted = np.zeros(FULL.nv)
        for i, value in ACROSS.slope(posture).items():
            wanted[i] = -value
        np.testing.assert_allclose(pulled, wanted, atol=1e-12)


class TestLength:
    @pytest.mark.parametrize(("knee", "length", "lever"), [(0.90, 0.194837478, None), (1.3, 0.216593666, 0.055201599)])
    def test_of_a_cable_at_the_knee(self, knee, length, lever):
        for posture in postures(LEG, (0.5, 0.4, knee)):
            assert PATELLA.length(posture) == pytest.approx(length, abs=1e-9)
            assert lever is None or PATELLA.slope(posture)[2] == pytest.approx(lever, abs=1e-9)

    @pytest.mark.parametrize(
        ("between", "length", "lever"),
        [
            (2.4, 0.233713096, 0.043352075),  # free
            (2.9, 0.250297042, 0.03),  # wrapped
            (2.635542078, None, 0.03),  # where it leaves the pulley
        ],
    )
    def test_of_a_cable_over_a_pulley(self, between, length, lever):
        knee = math.pi - between  # at zero the leg is straight, and the ends are on both sides of the centre
        for posture in postures(LEG, (0.5, 0.4, knee)):
            (found,) = PULLEY.slope(posture).values()
            assert abs(found) == pytest.approx(lever, abs=1e-8)
            assert length is None or PULLEY.length(posture) == pytest.approx(length, abs=1e-9)

    @pytest.mark.parametrize("between", [1.5, 2.4, 2.7, 2.9])
    def test_over_a_pulley_is_that_of_the_shorter_way_round_their_hull(self, between):
        angles = np.linspace(0.0, 2 * np.pi, 20001)
        pulley = PULLEY.radius * np.column_stack([np.sin(angles), np.cos(angles)])
        ends = [[0.0, 0.15], [0.1 * math.sin(between), 0.1 * math.cos(between)]]
        points = np.vstack([ends, pulley])
        order = ConvexHull(points).vertices.tolist()
        first, last = order.index(0), order.index(1)
        ways = [points[_way(order, first, last)], points[_way(order, last, first)]]
        shorter = min(np.linalg.norm(np.diff(way, axis=0), axis=1).sum() for way in ways)
        found = PULLEY.length(postures(LEG, (0.5, 0.4, math.pi - between))[0])
        assert found == pytest.approx(shorter, abs=1e-8)

    def test_of_a_linkage_is_that_of_its_slider(self):
        like = SliderLinkage(1000.0, 0.2, LINKAGE.crank, LINKAGE.rod, 0.3, LINKAGE.offset)
        for knee in (0.2, 0.9, 1.4):
            posture = postures(LEG, (0.5, 0.4, knee))[0]
            assert LINKAGE.length(posture) == pytest.approx(like.compression(knee + 0.3) + 0.1)
            assert LINKAGE.slope(posture)[2] == pytest.approx(like.lever(knee + 0.3))

    def test_of_a_cable_between_bodies_beside_each_other_counts_what_is_across(self):
        wide = Between(Anchor("thigh", (0.03, 0.04, -0.1)), Anchor("shank", (0.012, 0.0, 0.054)))
        for posture in postures(LEG, (0.5, 0.4, 0.9)):
            assert wide.length(posture) == pytest.approx(math.hypot(PATELLA.length(posture), 0.04))


def _way(order, first, last):
    return order[first : last + 1] if first <= last else [*order[first:], *order[: last + 1]]


class TestNumbers:
    @each_path
    def test_are_set_by_their_names_and_checked(self, name):
        _, path = PATHS[name]
        assert path.units.keys() == path.numbers.keys()
        for each, value in path.numbers.items():
            other = path.moved({each: value + 1e-3})
            assert other.numbers == {**path.numbers, each: value + 1e-3}
            with pytest.raises(BadValue):
                path.moved({each: math.inf})

    @each_path
    def test_are_kept_in_a_file(self, name):
        spring = Spring(1000.0, damping=0.0, path=PATHS[name][1])
        path, others = path_of(json.loads(json.dumps(spring_data(spring))))
        assert path == spring.path and others["stiffness"] == 1000.0

    def test_of_a_mirrored_linkage_are_kept_as_well(self):
        path, _ = path_of(path_data(LINKAGE.on({}, -1.0)))
        for knee in (-0.9, 0.4):
            posture = postures(LEG, (0.5, 0.4, knee))[0]
            assert path.length(posture) == pytest.approx(LINKAGE.on({}, -1.0).length(posture))

    def test_are_in_units_of_the_path(self):
        assert Spring(path=PATELLA).units["stiffness"] == "N/m"
        assert Spring(path=Joints({"hip": 1.0})).units["stiffness"] == Spring().units["stiffness"] == "N·m/rad"


class TestMirrored:
    @pytest.mark.parametrize("name", ["joints", "patella", "pulley", "linkage", "sum"])
    def test_is_as_long_at_the_opposite_angles(self, name):
        _, path = PATHS[name]
        q, mirrored = (0.0, 0.4, 0.9), (0.0, -0.4, -0.9)
        other = path.on({}, -1.0)
        here, there = postures(LEG, q)[0], postures(LEG, mirrored)[0]
        assert other.length(there) == pytest.approx(path.length(here))
        assert other.on({}, -1.0) == path
        slopes = path.slope(here), other.slope(there)
        assert slopes[1] == pytest.approx({i: -value for i, value in slopes[0].items()})


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Joints({}), "a weight for each"),
        (lambda: Joints({"knee": 0.0}), "other than zero"),
        (lambda: Anchor("thigh", (0.0, 1.0)), "three numbers"),
        (lambda: Anchor("thigh", (0.0, 1.0, math.nan)), "three numbers"),
        (lambda: Over(PULLEY.start, PULLEY.centre, PULLEY.end, 0.0), "radius"),
        (lambda: Over(PULLEY.start, PULLEY.centre, PULLEY.end, 0.03, 2.0), "side"),
        (lambda: Linkage("knee", 0.2, 0.1), "rod - crank"),
        (lambda: Sum([]), "a weight and a path"),
        (lambda: Sum([(math.nan, PATELLA)]), "Sum.weight"),
        (lambda: Joints([("knee", 0.02), ("knee", 0.01)]), "each joint once"),
        (lambda: find_spanned(replace(PULLEY, radius=0.2), LEG), "farther than the radius"),
        (lambda: find_spanned(replace(PULLEY, centre=Anchor("hip", (0, 0, 0.3))), LEG), "keeps its distance"),
        (lambda: find_spanned(Between(PATELLA.start, Anchor("thigh", (0, 0, 0))), LEG), "whose length changes"),
        (lambda: path_of({"from": {"body": "thigh", "at": [0, 0, 0]}}), "from and to"),
        (lambda: path_of({"path": {"knee": 1.0}, "linkage": {}}), "path, or linkage"),
        (lambda: path_of({"path": 3.0}), "a table"),
        (lambda: path_of({"sum": [{"weight": 1.0}]}), "a path in each part"),
    ],
)
def test_what_is_no_path(make, words):
    with pytest.raises(BadValue, match=words):
        make()


@pytest.mark.parametrize(
    ("path", "kind"),
    [(Joints({"ankle": 1.0}), "joint"), (Between(Anchor("foot", (0, 0, 0)), PATELLA.end), "frame")],
)
def test_what_the_robot_has_not(path, kind):
    with pytest.raises(UnknownName, match=f"unknown {kind}"):
        find_spanned(path, LEG)
