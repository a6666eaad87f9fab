"""The section and its charts: of one state, and of many to the same digits, on slopes and with toes that slide."""

import math
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Contact, Gait, Ground, HoppingLaw, hopping
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.per_lane import null_spaces
from spear_pin.hybrid.periodic import return_map
from spear_pin.hybrid.section import chart, section
from spear_pin.hybrid.symmetry import mirror_of, turn_state
from tests.hybrid.test_ground import Step
from tests.lagrangian import monopod


class TestChart:
    @pytest.mark.parametrize(("name", "dimension"), [("hop", 3), ("free_hop", 4)])
    def test_covers_the_section(self, name, dimension, request):
        """The toe at rest on the ground takes one position and two rates; translation is left out."""
        gait = request.getfixturevalue(name)
        local = chart(gait.system, gait.state)
        lagrangian = monopod(gait.system.robot.coordinates)
        assert local.dimension == dimension
        rng = np.random.default_rng(1)
        for xi in 0.05 * rng.normal(size=(20, dimension)):
            q, v = local.state(xi)
            at = lagrangian.terms(q, v)
            assert abs(at.toes["toe"][1]) < 1e-14
            assert np.abs(at.jacobians["toe"] @ v).max() < 1e-12
            if "boom_x" in gait.system.robot.coordinates:
                assert q[0] == pytest.approx(gait.state[0][0], abs=1e-15)
            # the chart projects along its normals, which leaves the coordinates to first order
            assert np.abs(local.coordinates((q, v)) - xi).max() < 0.05

    def test_origin(self, hop):
        local = chart(hop.system, hop.state)
        q, v = local.state(np.zeros(3))
        np.testing.assert_allclose(q, hop.state[0], rtol=0, atol=1e-14)
        np.testing.assert_allclose(v, hop.state[1], rtol=0, atol=1e-12)
        np.testing.assert_allclose(local.coordinates(hop.state), 0.0, atol=1e-15)

    def test_tangent_to_first_order(self, hop):
        local = chart(hop.system, hop.state)
        columns = [local.coordinates(local.state(xi)) / 1e-6 for xi in 1e-6 * np.eye(3)]
        np.testing.assert_allclose(columns, np.eye(3), rtol=0, atol=1e-5)

    def test_a_toe_that_slides_has_one_coordinate_more(self, robot, hop):
        system = hopping(robot, hop.system.law, contact=Contact(0.02))
        q, v = return_map(system, hop.state).state
        toe_velocity = robot.toe_jacobian(q, "toe") @ v
        assert abs(toe_velocity[0]) > 1e-3 and abs(toe_velocity[1]) < 1e-9
        local = chart(system, (q, v))
        assert local.dimension == 4
        xi = np.array([0.01, 0.02, -0.03, 0.04])
        moved, rates = local.state(xi)
        assert abs(robot.toe_position(moved, "toe")[1]) < 1e-14
        assert abs((robot.toe_jacobian(moved, "toe") @ rates)[1]) < 1e-12

    def test_where_there_is_no_state(self, hop):
        local = chart(hop.system, hop.state)
        for far in (1e7, math.nan, math.inf):
            assert np.isnan(local.state(np.array([far, 0.0, 0.0]))).all()

    def test_on_ground_of_another_shape(self, free_robot):
        """Its functions may be of numbers only."""

        class Tread(Step):
            def above(self, x, z, ops=math):
                return super().above(x, z, ops) - math.sin(0.0 * float(x))

        law = HoppingLaw(hip_touchdown=0.5)
        level, step = hopping(free_robot, law), hopping(free_robot, law, ground=Tread())
        q, v = level.guess()
        xi = np.array([0.01, 0.02, -0.03, 0.04])
        for own, expected in zip(chart(step, (q, v)).state(xi), chart(level, (q, v)).state(xi), strict=True):
            np.testing.assert_allclose(own, expected, rtol=0, atol=1e-14)
        on_top = q + [1.0, 0.02, 0.0, 0.0]
        moved, _ = chart(step, (on_top, v)).state(xi)
        assert free_robot.toe_position(moved, "toe")[1] == pytest.approx(0.02, abs=1e-14)

    def test_with_every_toe_in_the_air(self, hop):
        """Nothing holds there."""
        q, v = (part[None] for part in hop.state)
        charts = replace(section(hop.system), toes=()).charts(q, v, np.zeros(0, dtype=bool))
        assert charts.dimension == 6
        moved = charts.states(np.full((1, 6), 0.01))
        np.testing.assert_allclose(charts.coordinates(*moved), 0.01, rtol=0, atol=1e-15)


def charts_of(system, q, v, numbers):
    whole = section(system, numbers)
    return whole.charts(q, v, whole.sliding(q, v)[0])


class TestLanes:
    @pytest.mark.parametrize("name", ["hop", "free_hop", "slopes", "slides", "long_stride", "trot"])
    def test_one_has_the_digits_it_has_among_64(self, name, request):
        """In any order, too."""
        numbers, n = {}, 64
        rng = np.random.default_rng(1)
        if name == "slides":
            gait = request.getfixturevalue("hop")
            system = hopping(gait.system.robot, gait.system.law, contact=Contact(0.02))
            q, v = return_map(system, gait.state).state
        else:
            gait = (
                Gait.load(name)
                if name in ("long_stride", "trot")
                else request.getfixturevalue(name.replace("slopes", "free_hop"))
            )
            system, (q, v) = gait.system, gait.state
        q, v = q + 1e-3 * rng.normal(size=(n, len(q))), np.repeat(v[None], n, axis=0)
        if name == "slopes":
            numbers = {"slope": rng.uniform(-0.1, 0.1, n), "height": rng.uniform(-0.3, 0.3, n), "stiffness": np.ones(n)}
        charts = charts_of(system, q, v, numbers)
        xi = 1e-2 * rng.normal(size=(n, charts.dimension))
        states = charts.states(xi)
        back = charts.coordinates(*states)
        mixed = rng.permutation(n)
        for part, other in zip(states, charts.take(mixed).states(xi[mixed]), strict=True):
            np.testing.assert_array_equal(part[mixed], other)
        for i in range(n):
            lane = slice(i, i + 1)
            own = charts_of(system, q[lane], v[lane], {key: each[lane] for key, each in numbers.items()})
            np.testing.assert_array_equal(own.q_bases, charts.q_bases[lane])
            np.testing.assert_array_equal(own.v_bases, charts.v_bases[lane])
            for part, other in zip(own.states(xi[lane]), states, strict=True):
                np.testing.assert_array_equal(part, other[lane])
            np.testing.assert_array_equal(own.coordinates(*own.states(xi[lane])), back[lane])

    def test_are_on_the_ground_and_at_rest_there(self):
        """Two toes, one of which is closed, by Pinocchio's kinematics."""
        gait, rng = Gait.load("long_stride"), np.random.default_rng(1)
        robot, (toe,) = gait.system.robot, section(gait.system).toes
        q, v = (np.repeat(part[None], 5, axis=0) for part in gait.state)
        charts = charts_of(gait.system, q, v, {})
        xi = 1e-2 * rng.normal(size=(5, charts.dimension))
        q, v = charts.states(xi)
        np.testing.assert_allclose(charts.coordinates(q, v), xi, rtol=0, atol=1e-2)
        for configuration, rates in zip(q, v, strict=True):
            assert abs(robot.toe_position(configuration, toe)[1]) < 1e-14
            assert np.abs(robot.toe_jacobian(configuration, toe) @ rates).max() < 1e-13

    def test_on_ground_that_varies(self, free_hop):
        """The coordinates are those on the ground as it was; the states are on the ground as it is."""
        q, v = (part[None] for part in free_hop.state)
        charts, numbers = charts_of(free_hop.system, q, v, {}), {"slope": np.array([0.02]), "height": np.array([0.1])}
        moved, rates = charts.on({**numbers, "stance_torque": np.array([8.0])}).states(np.zeros((1, 4)))
        there = with_parameters(free_hop.system, {name: float(each[0]) for name, each in numbers.items()})
        height, jacobian = there.ground.foot(there.robot, moved[0], "toe")
        assert abs(height) < 1e-14 and np.abs(jacobian @ rates[0]).max() < 1e-13
        assert there.ground == Ground(there.ground.friction, 0.02, 0.1)
        assert charts.on({"stance_torque": np.array([8.0])}).section is charts.section

    def test_one_that_is_nowhere_leaves_the_others(self, hop):
        q, v = (np.repeat(part[None], 3, axis=0) for part in hop.state)
        charts = charts_of(hop.system, q, v, {})
        xi = np.array([[0.01, 0.02, 0.03], [math.nan, 0.0, 0.0], [0.01, 0.02, 0.03]])
        q, v = charts.states(xi)
        assert np.isnan(q[1]).all() and np.isnan(v[1]).all()
        np.testing.assert_array_equal(q[0], q[2])
        np.testing.assert_array_equal(q[0], charts.take(np.array([0])).states(xi[:1])[0][0])


class TestSymmetries:
    """What moves or turns the robot as a whole, or mirrors it between half strides, is left out."""

    @pytest.mark.parametrize("name", ["turn_9", "trot"])
    def test_states_at_another_place_and_heading(self, name):
        gait = Gait.load(name)
        local = chart(gait.system, gait.state)
        q, v = turn_state(*gait.state, 0.7, (2.0, -1.0))
        assert np.abs(local.coordinates((q, v))).max() < 1e-14
        begins = turn_state(*gait.state, -0.3, (0.0, 1.0))
        moved = section(gait.system).displacement((begins[0][None], begins[1][None]), (q[None], v[None] + 1e-3))
        assert np.abs(moved[0, : len(q)]).max() < 1e-14 and np.abs(moved[0, len(q) + 2 :] - 1e-3).max() < 1e-14
        mirror = mirror_of(gait.system.robot)
        mirrored = local.coordinates((mirror(gait.state[0]), mirror(gait.state[1])))
        assert (np.abs(mirrored).max() < 1e-14) == bool(gait.system.mirrored_toes)

    @pytest.mark.parametrize("name", ["free_hop", "turn_9", "trot", "trot mirrored"])
    def test_changes_are_those_of_coordinates(self, name, request):
        gait = Gait.load(name.split()[0]) if name != "free_hop" else request.getfixturevalue(name)
        system, (q, v) = gait.system, gait.state
        local, nv = chart(system, (q, v)), system.robot.nv
        if "mirrored" in name:
            q, v = (mirror_of(system.robot)(part) for part in (q, v))
        if system.section_toes:
            q, v = turn_state(q, v, 0.7, (2.0, -1.0))
        y, h, moves = np.concatenate([q, v]), 1e-6, np.eye(2 * nv)
        ends = [[local.coordinates((at[:nv], at[nv:])) for at in (y + h * move, y - h * move)] for move in moves]
        slopes = np.array([(above - below) / (2.0 * h) for above, below in ends]).T
        np.testing.assert_allclose(local.changes(y, moves), slopes, rtol=0, atol=1e-8)
        whole, q, v = local.lane.section, *np.split(y, 2)
        ends = [np.stack([y + h * move, y - h * move]) for move in moves]
        seen = [np.concatenate(whole.seen(at[:, :nv], at[:, nv:]), axis=1) for at in ends]
        slopes = np.array([(above - below) / (2.0 * h) for above, below in seen]).T
        np.testing.assert_allclose(whole.changes(q[None], v[None], moves[None])[0], slopes, rtol=0, atol=1e-8)

    def test_the_lowest_foot_touches_the_ground_before_the_impact(self):
        gait, rng = Gait.load("turn_9"), np.random.default_rng(1)
        robot, charts = gait.system.robot, chart(gait.system, gait.state).lane.take(np.zeros(5, dtype=np.int64))
        xi = 1e-2 * rng.normal(size=(5, charts.dimension))
        begun = charts.q + 0.1
        assert charts.section.placed(begun, charts.v, charts.slides)[0] is not begun
        np.testing.assert_array_equal(begun, charts.q + 0.1)  # left as it was
        q, v = charts.states(xi)
        for at in q:
            lowest = min(robot.frame_position(at, toe)[2] for toe in gait.system.section_toes)
            assert lowest == pytest.approx(0.0, abs=1e-14)
        np.testing.assert_allclose(charts.coordinates(q, v), xi, rtol=0, atol=1e-14)

    @pytest.mark.parametrize("name", ["free_hop", "turn_9", "trot"])
    def test_an_end_that_is_nowhere_is_left_alone(self, name, request):
        gait = Gait.load(name) if name != "free_hop" else request.getfixturevalue(name)
        charts = chart(gait.system, gait.state).lane.take(np.zeros(2, dtype=np.int64))
        q, v = (np.array([part, np.full_like(part, np.nan)]) for part in gait.state)
        found = charts.coordinates(q, v), charts.section.displacement((charts.q, charts.v), (q, v))
        for each in found:
            assert np.abs(each[0]).max() < 1e-14 and np.isnan(each[1]).any()


def test_null_spaces_of_rows_that_say_the_same():
    rows = np.array([[[0.0, 1.0, 0.2, 0.0], [0.0, 1.0, 0.2, 0.0], [1.0, 0.0, 0.0, 0.3]]] * 2)
    bases = null_spaces(rows)
    assert bases.shape == (2, 4, 2)
    np.testing.assert_allclose(rows @ bases, 0.0, atol=1e-15)
    np.testing.assert_allclose(np.swapaxes(bases, 1, 2) @ bases, [np.eye(2)] * 2, rtol=0, atol=1e-15)
