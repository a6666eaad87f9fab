"""What a robot answers: values of the caller's own, the same of a copy, and refusals that name what was wrong."""

import copy
import pickle

import numpy as np
import pytest

from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.loading import load
from spear_pin.model.robot import Robot
from tests.model.queries import ARRAYS, QUERIES, each_query, refusal, state


class TestAnswers:
    @each_query
    @pytest.mark.parametrize(
        "duplicate", [lambda r: pickle.loads(pickle.dumps(r)), copy.deepcopy], ids=["pickle", "copy"]
    )
    def test_duplicates_answer_alike(self, query, duplicate):
        robot = load("spear_ii", locked=["boom_x"])
        twin = duplicate(robot)
        answer = QUERIES[query]
        np.testing.assert_array_equal(answer(twin, *state(twin)), answer(robot, *state(robot)))

    def test_pickled_attributes(self):
        robot = load("q_spear", toes=["anterior_toe"], locked=["torso_x"])
        twin = pickle.loads(pickle.dumps(robot))
        for attribute in ("name", "source", "toes", "actuated", "locked", "coordinates", "planar", "nq", "nv", "nu"):
            assert getattr(twin, attribute) == getattr(robot, attribute)
        np.testing.assert_array_equal(twin.model.armature, robot.model.armature)
        assert repr(twin) == repr(robot)

    @pytest.mark.parametrize("query", ARRAYS)
    def test_answers_are_copies(self, query):
        robot = load("spear_ii")
        first = QUERIES[query](robot, *state(robot))
        kept = first.copy()
        assert first.dtype == np.float64
        first += 1.0
        second = QUERIES[query](robot, *state(robot))
        np.testing.assert_array_equal(second, kept)

    @pytest.mark.parametrize("query", ARRAYS)
    def test_answers_outlive_the_next_query(self, query):
        robot = load("spear_ii")
        first = QUERIES[query](robot, *state(robot))
        kept = first.copy()
        for other in QUERIES.values():
            other(robot, np.full(4, -0.7), np.full(4, 2.0))
        np.testing.assert_array_equal(first, kept)

    @each_query
    def test_arguments_are_left_alone(self, query):
        robot = load("spear_ii")
        q, v = np.array([0.1, 0.2, 0.3, 0.4]), np.array([1.0, 2.0, 3.0, 4.0])
        QUERIES[query](robot, q, v)
        np.testing.assert_array_equal([q, v], [[0.1, 0.2, 0.3, 0.4], [1.0, 2.0, 3.0, 4.0]])

    @each_query
    def test_lists_integers_and_strides(self, query):
        robot = load("spear_ii")
        answer = QUERIES[query](robot, np.array([0.0, 1.0, 0.0, 1.0]), np.array([1.0, 2.0, 3.0, 4.0]))
        np.testing.assert_array_equal(QUERIES[query](robot, [0, 1, 0, 1], (1, 2, 3, 4)), answer)
        strided = np.array([[0.0, 1.0, 0.0, 1.0], [1.0, 2.0, 3.0, 4.0]]).T
        np.testing.assert_array_equal(QUERIES[query](robot, strided[:, 0], strided[:, 1]), answer)


class TestUnknownNames:
    @pytest.mark.parametrize("query", ["toe_position", "toe_jacobian", "toe_id"])
    def test_toe(self, query):
        robot = load("q_spear")
        arguments = ["toe"] if query == "toe_id" else [np.zeros(7), "toe"]
        error = refusal(UnknownName, lambda: getattr(robot, query)(*arguments))
        assert (error.kind, error.value, error.valid) == ("toe", "toe", ("posterior_toe", "anterior_toe"))

    def test_toe_of_drift(self):
        robot = load("spear_ii")
        error = refusal(UnknownName, lambda: robot.toe_drift(np.zeros(4), np.zeros(4), "shank"))
        assert str(error) == "unknown toe 'shank'; valid: toe"

    def test_frame(self):
        robot = load("spear_ii")
        error = refusal(UnknownName, lambda: robot.frame_position(np.zeros(4), "ankle"))
        assert error.kind == "frame" and error.value == "ankle" and "shank" in error.valid

    def test_coordinate(self):
        robot = load("spear_ii", locked=["boom_x"])
        assert [robot.index(name) for name in robot.coordinates] == [0, 1, 2]
        error = refusal(UnknownName, lambda: robot.index("boom_x"))
        assert (error.kind, error.value, error.valid) == ("joint", "boom_x", ("boom_z", "hip", "knee"))


class TestBadValues:
    @pytest.mark.parametrize("query", [q for q in QUERIES if q not in ("actuation_matrix", "mass")])
    @pytest.mark.parametrize("length", [0, 3, 5])
    def test_length_of_q(self, query, length):
        robot = load("spear_ii")
        error = refusal(BadValue, lambda: QUERIES[query](robot, np.zeros(length), np.zeros(4)))
        assert error.name == "q"
        assert "4 numbers (boom_x, boom_z, hip, knee)" in error.expected and f"({length},)" in str(error)

    @pytest.mark.parametrize("query", ["coriolis_matrix", "bias", "kinetic_energy", "toe_drift"])
    def test_length_of_v(self, query):
        robot = load("spear_ii")
        error = refusal(BadValue, lambda: QUERIES[query](robot, np.zeros(4), np.zeros(3)))
        assert error.name == "v" and "4 numbers" in error.expected and "(3,)" in str(error)

    @pytest.mark.parametrize("number", [np.nan, np.inf, -np.inf])
    def test_not_finite(self, number):
        robot = load("spear_ii")
        for query in (robot.mass_matrix, robot.gravity, lambda q: robot.toe_position(q, "toe")):
            error = refusal(BadValue, lambda query=query: query([0, 0.5, number, 0]))
            assert str(error) == f"q[2] is {number}; expected a finite number"
        error = refusal(BadValue, lambda: robot.bias(np.zeros(4), [0, 0, 0, number]))
        assert str(error) == f"v[3] is {number}; expected a finite number"

    @pytest.mark.parametrize(
        "value", ["abc", ["a", "b", "c", "d"], {}, [1j] * 4, [object] * 4, [[1], [2, 3]], None, 3.0, [None] * 4]
    )
    def test_not_numbers(self, value):
        error = refusal(BadValue, lambda: load("spear_ii").mass_matrix(value))
        assert error.name.startswith("q") and str(error).startswith("q")

    def test_table_of_one_row(self):
        error = refusal(BadValue, lambda: load("spear_ii").mass_matrix(np.zeros((1, 4))))
        assert "(1, 4)" in str(error)

    @pytest.mark.parametrize("shape", [(2, 4), (100,)])
    def test_long_value(self, shape):
        assert len(str(refusal(BadValue, lambda: load("spear_ii").mass_matrix(np.zeros(shape))))) < 400

    @pytest.mark.parametrize("value", [[10**400, 0, 0, 0], np.full(4, 1j)], ids=["huge", "complex"])
    def test_not_real(self, value):
        assert refusal(BadValue, lambda: load("spear_ii").mass_matrix(value)).name.startswith("q")


def test_weight_is_what_gravity_makes_it():
    robot = load("q_spear")
    assert robot.weight == pytest.approx(9.81 * robot.mass, rel=1e-14)
    model = robot.model.copy()
    model.gravity.linear = np.array([-3.0, 0.0, -4.0])
    elsewhere = Robot(model, name=robot.name, toes=robot.toes, actuated=robot.actuated)
    assert elsewhere.weight == pytest.approx(5.0 * robot.mass, rel=1e-14)
