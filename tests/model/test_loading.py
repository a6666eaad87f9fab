"""Loading robots by name and path: what comes out, in silence, and the names and URDFs that are refused."""

import pickle

import numpy as np
import pytest

from spear_pin.errors import BadFile, BadValue, NoGait, SpearError, UnknownName
from spear_pin.model.loading import ROBOTS, load
from tests.model.queries import QUERIES, each_query, refusal, state
from tests.model.spatial_arm import ARM, FLYING


class TestShipped:
    def test_names(self):
        own = {"spear_ii", "spear_ii_series", "q_spear", "q_spear_full", "biped"}
        assert set(ROBOTS) == own | {"hoppy", "hoppy_leg", "mups_v2", "crank_hopper", "minitaur_leg"}
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
        for toe in robot.toes:
            assert robot.toe_position(q, toe).shape == (2 if robot.planar else 3,)
            assert robot.toe_drift(q, v, toe).shape == (robot.dimension,)
            assert robot.toe_jacobian(q, toe).shape == (robot.dimension, robot.nv)

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
        text = ARM.replace('type="revolute"', 'type="fixed"').split("<transmission")[0] + "</robot>"
        robot = load(write(text), ["foot"], base="fixed", motors=[])
        assert (robot.nq, robot.nv, robot.nu) == (0, 0, 0)
        np.testing.assert_allclose(robot.toe_position([], "foot")[-1], 0.2, atol=1e-15)


class TestUnknownNames:
    def test_robot(self):
        error = refusal(UnknownName, lambda: load("spear_iii"))
        assert (error.kind, error.value) == ("robot", "spear_iii")
        assert error.valid[: len(ROBOTS)] == tuple(ROBOTS) and "path" in error.also
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
        assert (
            str(error) == f"{path}: joint 'pitch' moves no inertia: give its links an <inertial> (repair=True mends it)"
        )

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
