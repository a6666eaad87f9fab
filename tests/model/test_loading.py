"""Loading robots by name and path, robots in three dimensions, and what is refused on the way."""

import copy
import pickle

import numpy as np
import pinocchio as pin
import pytest

from spear_pin.errors import BadFile, BadValue, NoGait, SpearError, UnknownName
from spear_pin.model.loading import ROBOTS, load

# a yaw joint and a pitch joint, the foot on a fixed joint 0.5 m out along the arm
ARM = """
<robot name="arm">
  <link name="base"/>
  <link name="column">
    <inertial><mass value="1"/><inertia ixx="0.1" ixy="0" ixz="0" iyy="0.1" iyz="0" izz="0.2"/></inertial>
  </link>
  <link name="boom">
    <inertial>
      <origin xyz="0.25 0 0"/>
      <mass value="2"/>
      <inertia ixx="0.01" ixy="0" ixz="0" iyy="0.03" iyz="0" izz="0.04"/>
    </inertial>
  </link>
  <link name="foot"/>
  <joint name="yaw" type="revolute">
    <parent link="base"/>
    <child link="column"/>
    <axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="pitch" type="revolute">
    <parent link="column"/>
    <child link="boom"/>
    <origin xyz="0 0 0.2"/>
    <axis xyz="0 1 0"/>
    <limit lower="-3" upper="3" effort="1" velocity="1"/>
  </joint>
  <joint name="foot_mount" type="fixed">
    <parent link="boom"/>
    <child link="foot"/>
    <origin xyz="0.5 0 0"/>
  </joint>
  <transmission name="pitch_drive">
    <joint name="pitch"/>
    <actuator name="motor"><mechanicalReduction>10</mechanicalReduction></actuator>
  </transmission>
</robot>
"""

# the same arm on a body that flies
FLYING = ARM.replace('name="yaw" type="revolute"', 'name="yaw" type="floating"')

# every query with its arguments after q and v
QUERIES = {
    "mass_matrix": lambda robot, q, v: robot.mass_matrix(q),
    "coriolis_matrix": lambda robot, q, v: robot.coriolis_matrix(q, v),
    "gravity": lambda robot, q, v: robot.gravity(q),
    "bias": lambda robot, q, v: robot.bias(q, v),
    "kinetic_energy": lambda robot, q, v: robot.kinetic_energy(q, v),
    "potential_energy": lambda robot, q, v: robot.potential_energy(q),
    "frame_position": lambda robot, q, v: robot.frame_position(q, robot.toes[0]),
    "toe_position": lambda robot, q, v: robot.toe_position(q, robot.toes[0]),
    "toe_jacobian": lambda robot, q, v: robot.toe_jacobian(q, robot.toes[0]),
    "toe_drift": lambda robot, q, v: robot.toe_drift(q, v, robot.toes[0]),
    "actuation_matrix": lambda robot, q, v: robot.actuation_matrix,
    "mass": lambda robot, q, v: robot.mass,
}
ARRAYS = [query for query in QUERIES if not query.endswith("energy") and query != "mass"]

each_query = pytest.mark.parametrize("query", QUERIES)


@pytest.fixture
def write(tmp_path):
    def write(text, name="arm.urdf"):
        path = tmp_path / name
        path.write_text(text)
        return path

    return write


@pytest.fixture
def arm(write):
    return load(write(ARM), toes=["foot"])


def state(robot):
    """A configuration away from zero and rates."""
    v = np.linspace(-1.0, 1.5, robot.nv)
    return pin.integrate(robot.model, pin.neutral(robot.model), 0.3 * v + 0.1), v


def refusal(kind, call):
    """The error of a call, of exactly this kind, whose text must be one line."""
    with pytest.raises(SpearError) as caught:
        call()
    assert type(caught.value) is kind
    assert len(str(caught.value).splitlines()) == 1
    return caught.value


class TestShipped:
    def test_names(self):
        assert set(ROBOTS) == {"spear_ii", "spear_ii_series", "q_spear", "q_spear_full", "biped"}
        for shipped in ROBOTS.values():
            assert shipped.path.is_file() and shipped.summary and shipped.provenance

    def test_monopod(self):
        robot = load("spear_ii")
        assert (robot.name, robot.source, robot.toes) == ("spear_ii", "spear_ii", ("toe",))
        assert (robot.nq, robot.nv, robot.nu) == (4, 4, 2)
        assert robot.planar and robot.locked == () and robot.actuated == ("hip", "knee")

    def test_biped(self):
        robot = load("biped")
        assert robot.toes == ("left_toe", "right_toe")
        assert (robot.nq, robot.nv, robot.nu, robot.planar) == (7, 7, 4, True)

    def test_quadruped(self):
        robot = load("q_spear")
        assert robot.toes == ("posterior_toe", "anterior_toe")
        assert (robot.nq, robot.nv, robot.nu, robot.planar) == (7, 7, 4, True)

    @pytest.mark.parametrize("name", ROBOTS)
    def test_shapes(self, name):
        robot = load(name)
        q, v = state(robot)
        size = 2 if robot.planar else 3
        for toe in robot.toes:
            assert robot.toe_position(q, toe).shape == robot.toe_drift(q, v, toe).shape == (size,)
            assert robot.toe_jacobian(q, toe).shape == (size, robot.nv)

    def test_repr(self):
        assert repr(load("spear_ii")) == "Robot('spear_ii', nq=4, nv=4, nu=2, toes=['toe'])"
        assert repr(load("spear_ii", locked=["boom_x"])).endswith("toes=['toe'], locked=['boom_x'])")

    def test_own_toes(self):
        robot = load("spear_ii", toes=["shank", "toe"])
        assert robot.toes == ("shank", "toe")
        np.testing.assert_allclose(robot.toe_position(np.zeros(4), "shank"), [0, -0.318], atol=1e-15)

    def test_locked(self):
        robot = load("spear_ii", locked=["boom_x"])
        assert robot.locked == ("boom_x",) and robot.coordinates == ("boom_z", "hip", "knee")
        free = load("spear_ii")
        q, v = np.array([0.5, 0.4, 0.9]), np.array([1.0, -2.0, 3.0])
        np.testing.assert_allclose(robot.mass_matrix(q), free.mass_matrix([0, *q])[1:, 1:], atol=1e-14)
        np.testing.assert_allclose(robot.bias(q, v), free.bias([0, *q], [0, *v])[1:], atol=1e-13)

    def test_locked_motor_is_no_input(self):
        robot = load("spear_ii", locked=["knee"])
        assert robot.actuated == ("hip",)
        np.testing.assert_array_equal(robot.actuation_matrix, [[0], [0], [1]])

    def test_iterables(self):
        robot = load("spear_ii", toes=iter(["toe"]), locked=iter(["boom_x"]))
        assert (robot.toes, robot.locked) == (("toe",), ("boom_x",))


class TestPath:
    @pytest.mark.parametrize("name", ROBOTS)
    @each_query
    def test_shipped_file_answers_like_its_name(self, name, query):
        shipped = load(name)
        loaded = load(ROBOTS[name].path, toes=shipped.toes)
        assert (loaded.name, loaded.source) == (name, str(ROBOTS[name].path))
        answer = QUERIES[query]
        np.testing.assert_array_equal(answer(loaded, *state(loaded)), answer(shipped, *state(shipped)))

    def test_no_toes_unless_given(self, write):
        assert load(write(ARM)).toes == ()

    def test_path_as_text(self, write):
        assert load(str(write(ARM))).name == "arm"

    def test_fixed_foot(self, arm):
        assert arm.toes == ("foot",) and arm.actuated == ("pitch",) and arm.coordinates == ("yaw", "pitch")
        np.testing.assert_allclose(arm.toe_position([0, 0], "foot"), [0.5, 0, 0.2], atol=1e-15)

    def test_joint_as_toe(self, write):
        robot = load(write(ARM), toes=["foot_mount"])
        np.testing.assert_allclose(robot.toe_position([0, 0], "foot_mount"), [0.5, 0, 0.2], atol=1e-15)

    def test_nothing_moves(self, write):
        robot = load(
            write(ARM.replace('type="revolute"', 'type="fixed"').split("<transmission")[0] + "</robot>"), ["foot"]
        )
        assert (robot.nq, robot.nv, robot.nu) == (0, 0, 0)
        np.testing.assert_allclose(robot.toe_position([], "foot")[-1], 0.2, atol=1e-15)


class TestThreeDimensions:
    """The arm by hand: yaw turns about z, a positive pitch lowers the boom."""

    yaw, pitch = 0.7, -0.4
    q, v = np.array([yaw, pitch]), np.array([1.5, -2.0])

    def test_shapes(self, arm):
        assert not arm.planar
        assert arm.toe_position(self.q, "foot").shape == arm.toe_drift(self.q, self.v, "foot").shape == (3,)
        assert arm.toe_jacobian(self.q, "foot").shape == (3, 2)
        assert arm.mass_matrix(self.q).shape == arm.coriolis_matrix(self.q, self.v).shape == (2, 2)
        assert arm.gravity(self.q).shape == arm.bias(self.q, self.v).shape == (2,)
        assert arm.actuation_matrix.shape == (2, 1)

    def test_position(self, arm):
        reach, height = 0.5 * np.cos(self.pitch), 0.2 - 0.5 * np.sin(self.pitch)
        expected = [reach * np.cos(self.yaw), reach * np.sin(self.yaw), height]
        np.testing.assert_allclose(arm.toe_position(self.q, "foot"), expected, atol=1e-15)

    def test_jacobian(self, arm):
        sy, cy, sp, cp = np.sin(self.yaw), np.cos(self.yaw), np.sin(self.pitch), np.cos(self.pitch)
        expected = 0.5 * np.array([[-cp * sy, -sp * cy], [cp * cy, -sp * sy], [0, -cp]])
        np.testing.assert_allclose(arm.toe_jacobian(self.q, "foot"), expected, atol=1e-15)

    def test_drift(self, arm):
        reach = 0.5 * np.cos(self.pitch)
        out, side = (
            np.array([np.cos(self.yaw), np.sin(self.yaw), 0]),
            np.array([-np.sin(self.yaw), np.cos(self.yaw), 0]),
        )
        lowering = 0.5 * np.sin(self.pitch)
        yaw_rate, pitch_rate = self.v
        expected = (
            -reach * (yaw_rate**2 + pitch_rate**2) * out
            - 2 * yaw_rate * pitch_rate * lowering * side
            + lowering * pitch_rate**2 * np.array([0, 0, 1])
        )
        np.testing.assert_allclose(arm.toe_drift(self.q, self.v, "foot"), expected, atol=1e-14)

    def test_mass_matrix(self, arm):
        s, c = np.sin(self.pitch), np.cos(self.pitch)
        about_z = 0.2 + 0.01 * s**2 + 0.04 * c**2 + 2 * (0.25 * c) ** 2
        expected = np.diag([about_z, 0.03 + 2 * 0.25**2])
        np.testing.assert_allclose(arm.mass_matrix(self.q), expected, atol=1e-14)
        assert arm.kinetic_energy(self.q, self.v) == pytest.approx(self.v @ expected @ self.v / 2)

    def test_gravity(self, arm):
        np.testing.assert_allclose(arm.gravity(self.q), [0, -2 * 9.81 * 0.25 * np.cos(self.pitch)], atol=1e-14)
        height = 0.2 - 0.25 * np.sin(self.pitch)
        assert arm.potential_energy(self.q) == pytest.approx(2 * 9.81 * height)

    @each_query
    def test_flying(self, write, query):
        """A floating joint has one coordinate more than it has rates."""
        robot = load(write(FLYING), toes=["foot"])
        assert (robot.nq, robot.nv, robot.nu, robot.planar) == (8, 7, 1, False)
        assert robot.coordinates == (*(f"yaw_{part}" for part in ("vx", "vy", "vz", "wx", "wy", "wz")), "pitch")
        shapes = {
            "mass_matrix": (7, 7),
            "coriolis_matrix": (7, 7),
            "gravity": (7,),
            "bias": (7,),
            "actuation_matrix": (7, 1),
            "toe_jacobian": (3, 7),
            "toe_position": (3,),
            "frame_position": (3,),
            "toe_drift": (3,),
        }
        answer = QUERIES[query](robot, *state(robot))
        assert np.shape(answer) == shapes.get(query, ()) and np.isfinite(answer).all()

    def test_flying_foot(self, write):
        """Its velocity and drift are the derivatives of its position at constant rates."""
        robot = load(write(FLYING), toes=["foot"])
        q, v = state(robot)
        step = 1e-4
        behind, here, ahead = (
            robot.toe_position(pin.integrate(robot.model, q, t * v), "foot") for t in (-step, 0.0, step)
        )
        np.testing.assert_allclose(robot.toe_jacobian(q, "foot") @ v, (ahead - behind) / (2 * step), atol=1e-6)
        np.testing.assert_allclose(robot.toe_drift(q, v, "foot"), (ahead - 2 * here + behind) / step**2, atol=1e-6)

    @pytest.mark.parametrize("length", [0.0, 0.999, 1.001, 2.0])
    def test_quaternion_that_is_no_rotation(self, write, length):
        robot = load(write(FLYING), toes=["foot"])
        q, _ = state(robot)
        q[3:7] *= length
        error = refusal(BadValue, lambda: robot.toe_position(q, "foot"))
        assert error.name == "q" and "of length 1" in error.expected

    def test_rounded_quaternion(self, write):
        robot = load(write(FLYING), toes=["foot"])
        q, _ = state(robot)
        np.testing.assert_allclose(robot.mass_matrix(q.round(5)), robot.mass_matrix(q), atol=1e-4)

    def test_configuration_is_named(self, write):
        error = refusal(BadValue, lambda: load(write(FLYING)).mass_matrix(np.zeros(7)))
        assert "8 numbers (yaw_x, yaw_y, yaw_z, yaw_qx, yaw_qy, yaw_qz, yaw_qw, pitch)" in error.expected

    def test_continuous_joint(self, write):
        """Pinocchio stores it as cosine and sine."""
        robot = load(write(ARM.replace('name="yaw" type="revolute"', 'name="yaw" type="continuous"')), toes=["foot"])
        assert (robot.nq, robot.nv) == (3, 2)
        q = [np.cos(self.yaw), np.sin(self.yaw), self.pitch]
        np.testing.assert_allclose(robot.mass_matrix(q), load(write(ARM)).mass_matrix(self.q), atol=1e-14)
        error = refusal(BadValue, lambda: robot.mass_matrix([0.5, 0.5, self.pitch]))
        assert error.name == "q" and "a cosine and a sine, of length 1" in error.expected


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
    def test_robot(self):
        error = refusal(UnknownName, lambda: load("spear_iii"))
        assert (error.kind, error.value) == ("robot", "spear_iii")
        assert error.valid[:-1] == tuple(ROBOTS) and "path" in error.valid[-1]
        assert "unknown robot 'spear_iii'" in str(error) and "spear_ii, spear_ii_series, q_spear" in str(error)

    def test_empty_name(self):
        assert "unknown robot ''" in str(refusal(UnknownName, lambda: load("")))

    @pytest.mark.parametrize("joint", ["boom_y", "toe_tip", "universe", ""])
    def test_locked_joint(self, joint):
        error = refusal(UnknownName, lambda: load("spear_ii", locked=["boom_x", joint]))
        assert (error.kind, error.value, error.valid) == ("joint", joint, ("boom_x", "boom_z", "hip", "knee"))
        assert str(error) == f"unknown joint {joint!r}; valid: boom_x, boom_z, hip, knee"

    def test_toe_of_a_file(self, write):
        path = write(ARM)
        error = refusal(UnknownName, lambda: load(path, toes=["food"]))
        assert (error.kind, error.value) == ("frame", "food")
        assert {"foot", "boom", "column", "base"} <= set(error.valid)
        assert "unknown frame 'food'" in str(error)

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

    @pytest.mark.parametrize("arguments", [{"locked": "boom_x"}, {"toes": "toe"}], ids=["locked", "toes"])
    def test_name_instead_of_list(self, arguments):
        """Either one name is as good as a list of one, or the whole name is in the text."""
        (name,) = arguments.values()
        try:
            robot = load("spear_ii", **arguments)
        except SpearError as error:
            assert name in str(error).split(";")[0]
        else:
            assert name in robot.locked + robot.toes

    def test_joint_locked_twice(self):
        try:
            assert load("spear_ii", locked=["boom_x", "boom_x"]).nv == 3
        except SpearError as error:
            assert "boom_x" in str(error)

    def test_toe_named_like_its_joint(self, write):
        path = write(ARM.replace("foot_mount", "foot"))
        np.testing.assert_allclose(load(path, toes=["foot"]).toe_position([0, 0], "foot"), [0.5, 0, 0.2], atol=1e-15)

    def test_toe_that_is_no_text(self):
        assert "3" in str(refusal(UnknownName, lambda: load("spear_ii", toes=[3])))


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


class TestInertia:
    """A joint must move some inertia, or D is singular."""

    @staticmethod
    def without_inertial(link):
        start = ARM.index(f'<link name="{link}">')
        end = ARM.index("</link>", start)
        return ARM[:start] + f'<link name="{link}">' + ARM[end:]

    def test_urdf_without_inertia(self, write):
        path = write(self.without_inertial("boom"))
        error = refusal(BadFile, lambda: load(path))
        assert str(error) == f"{path}: joint 'pitch' moves no inertia: give its links an <inertial>"

    def test_massless_carrier_is_fine(self, write):
        assert load(write(self.without_inertial("column"))).nv == 2

    def test_point_mass_on_the_axis(self, write):
        text = (
            ARM.replace('xyz="0.25 0 0"', 'xyz="0 0 0"')
            .replace('iyy="0.03"', 'iyy="0"')
            .replace('izz="0.04"', 'izz="0.01"')
        )
        error = refusal(BadFile, lambda: load(write(text)))
        assert "'pitch'" in error.problem

    def test_two_joints_that_move_alike(self, write):
        """Each moves inertia, but their sum alone matters."""
        text = self.without_inertial("column").replace('axis xyz="0 0 1"', 'axis xyz="0 1 0"')
        text = text.replace('xyz="0 0 0.2"', 'xyz="0 0 0"')
        path = write(text)
        error = refusal(BadFile, lambda: load(path))
        assert error.path == str(path) and "mass matrix is singular" in error.problem

    def test_locking_makes_it_whole(self, write):
        text = self.without_inertial("column").replace('axis xyz="0 0 1"', 'axis xyz="0 1 0"')
        path = write(text.replace('xyz="0 0 0.2"', 'xyz="0 0 0"'))
        assert load(path, locked=["yaw"]).nv == 1

    def test_motor_on_a_flying_body(self, write):
        path = write(FLYING.replace('<joint name="pitch"/>', '<joint name="yaw"/>'))
        error = refusal(BadFile, lambda: load(path))
        assert error.path == str(path) and "'yaw'" in error.problem and "6 degrees of freedom" in error.problem

    def test_missing_file(self, tmp_path):
        error = refusal(BadFile, lambda: load(tmp_path / "nowhere.urdf"))
        assert error.path == str(tmp_path / "nowhere.urdf") and "No such file" in error.problem

    def test_silent(self, capfd):
        for name in ROBOTS:
            load(name)
        assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    "error",
    [
        UnknownName("toe", "foot", ["toe"]),
        BadValue("q", 1.0, "four"),
        BadFile("a.urdf", "torn", 3),
        NoGait("none", 0.1),
    ],
    ids=lambda error: type(error).__name__,
)
def test_errors_cross_processes(error):
    twin = pickle.loads(pickle.dumps(error))
    assert type(twin) is type(error) and str(twin) == str(error) and vars(twin) == vars(error)
