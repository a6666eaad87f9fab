"""The planar dynamics for any scalars: numbers, whole batches, SymPy and CasADi, each against Pinocchio."""

from types import SimpleNamespace

import numpy as np
import pinocchio as pin
import pytest
import sympy as sp

from spear_pin import Robot, load, vary
from spear_pin.errors import BadValue
from spear_pin.model.planar import Planar

STATES = 200
RAIL = """<?xml version="1.0"?>
<robot name="rail" xmlns:drake="http://drake.mit.edu">
  <link name="base"/>
  {links}
  <joint name="swing" type="revolute">
    <parent link="base"/><child link="arm"/>
    <origin xyz="0.1 0 1" rpy="0 0.4 0"/><axis xyz="0 -1 0"/>
    <limit lower="-9" upper="9" effort="9" velocity="9"/>
  </joint>
  <joint name="slide" type="prismatic">
    <parent link="arm"/><child link="car"/>
    <origin xyz="0.2 0 -0.3" rpy="0 -1.1 0"/><axis xyz="{slides}"/>
    <limit lower="-9" upper="9" effort="9" velocity="9"/>
  </joint>
  <joint name="push" type="prismatic">
    <parent link="car"/><child link="rod"/>
    <origin xyz="0 0 0.1" rpy="0 0.7 0"/><axis xyz="0 0 -1"/>
    <limit lower="-9" upper="9" effort="9" velocity="9"/>
  </joint>
  <joint name="twist" type="revolute">
    <parent link="rod"/><child link="tip"/>
    <origin xyz="-0.1 0 0.25" rpy="0 2.5 0"/><axis xyz="0 1 0"/>
    <limit lower="-9" upper="9" effort="9" velocity="9"/>
  </joint>
  <joint name="branch" type="revolute">
    <parent link="car"/><child link="side"/>
    <origin xyz="0.05 0 0" rpy="0 3 0"/><axis xyz="0 -1 0"/>
    <limit lower="-9" upper="9" effort="9" velocity="9"/>
  </joint>
  <link name="foot"/>
  <joint name="sole" type="fixed"><parent link="tip"/><child link="foot"/><origin xyz="0.3 0 0.2" rpy="0 1 0"/></joint>
  <link name="heel"/>
  <joint name="ankle" type="fixed"><parent link="rod"/><child link="heel"/><origin xyz="0.1 0 0.2"/></joint>
  <transmission name="drive">
    <joint name="slide"/>
    <actuator name="motor"><drake:gear_ratio value="50"/><drake:rotor_inertia value="2e-4"/></actuator>
  </transmission>
</robot>
"""
LINK = """<link name="{}"><inertial><origin xyz="{} 0 {}" rpy="0 0.3 0"/><mass value="{}"/>
<inertia ixx="0.02" ixy="0" ixz="0.003" iyy="{}" iyz="0" izz="0.03"/></inertial></link>"""
LINKS = "\n".join(
    LINK.format(name, 0.1 * i - 0.2, 0.15 - 0.07 * i, 1.0 + i, 0.02 + 0.004 * i)
    for i, name in enumerate(("arm", "car", "rod", "tip", "side"))
)
TWIST = 'rpy="0 2.5 0"/><axis xyz="0 1 0"'
NUMBERS = SimpleNamespace(sin=np.sin, cos=np.cos)


@pytest.fixture(scope="module")
def rail(tmp_path_factory):
    """Prismatic joints on turning links, joint frames at angles, a branch, a rotor on a slide."""
    path = tmp_path_factory.mktemp("robots") / "rail.urdf"
    path.write_text(RAIL.format(links=LINKS, slides="0.6 0 -0.8"), encoding="utf-8")
    return load(path, toes=["foot", "heel"])


ROBOTS = {
    "spear_ii": lambda: load("spear_ii"),
    "spear_ii locked": lambda: load("spear_ii", locked=["boom_x"]),
    "spear_ii's knee alone": lambda: load("spear_ii", locked=["boom_x", "boom_z", "hip"]),
    "q_spear": lambda: load("q_spear"),
    "q_spear with long hips": lambda: vary(load("q_spear"), hip_distance=0.93),
    "q_spear with slow knees": lambda: vary(load("q_spear"), knee_ratio=40.0, torso_mass=28.0),
    "q_spear, pitch locked": lambda: load("q_spear", locked=["pitch"]),
    "biped": lambda: load("biped"),
}


@pytest.fixture(params=[*ROBOTS, "rail"])
def robot(request):
    return request.getfixturevalue("rail") if request.param == "rail" else ROBOTS[request.param]()


def states(robot, count=STATES, seed=7):
    rng = np.random.default_rng(seed)
    return [(rng.uniform(-2.5, 2.5, robot.nq), rng.uniform(-8.0, 8.0, robot.nv)) for _ in range(count)]


def flattened(terms, toes):
    """Everything that `Terms` has, as one list of scalars."""
    values = [value for row in terms.mass_matrix for value in row] + list(terms.bias)
    for toe in toes:
        values += [*terms.positions[toe], *(value for row in terms.jacobians[toe] for value in row), *terms.drifts[toe]]
    return values


def by_pinocchio(robot, q, v):
    values = [robot.mass_matrix(q).ravel(), robot.bias(q, v)]
    for toe in robot.toes:
        values += [robot.toe_position(q, toe), robot.toe_jacobian(q, toe).ravel(), robot.toe_drift(q, v, toe)]
    return np.concatenate(values)


def close(actual, expected, tolerance):
    expected = np.asarray(expected)
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * max(1.0, np.abs(expected).max()))


class TestTerms:
    def test_as_pinocchio(self, robot):
        planar = Planar(robot)
        for q, v in states(robot):
            terms = planar.terms(q.tolist(), v.tolist(), NUMBERS)
            close(np.array(terms.mass_matrix), robot.mass_matrix(q), 1e-12)
            close(np.array(terms.bias), robot.bias(q, v), 1e-12)
            for toe in robot.toes:
                close(terms.positions[toe], robot.toe_position(q, toe), 1e-12)
                close(terms.jacobians[toe], robot.toe_jacobian(q, toe), 1e-12)
                close(terms.drifts[toe], robot.toe_drift(q, v, toe), 1e-12)

    def test_gravity_that_is_not_along_z(self, robot):
        """As in the axes of a slope; across the plane it does nothing."""
        model = robot.model.copy()
        model.gravity.linear = np.array([-0.4, 0.3, -9.8])
        tilted = Robot(model, name=robot.name, toes=robot.toes, actuated=robot.actuated)
        planar = Planar(tilted)
        for q, v in states(robot, 20):
            close(np.array(planar.terms(q.tolist(), v.tolist(), NUMBERS).bias), tilted.bias(q, v), 1e-12)

    def test_rail_turns_what_slides(self, rail):
        """The robot that is to tell Coriolis terms has them."""
        q, v = np.array([0.3, 0.5, -0.2, 0.4, 1.0]), np.array([2.0, 1.5, -0.7, 0.3, 0.9])
        slide = rail.index("slide")
        assert abs(rail.coriolis_matrix(q, v)[0, slide]) > 1.0
        assert abs((rail.bias(q, v) - rail.gravity(q))[slide]) > 1.0
        assert rail.model.armature[slide] == pytest.approx(0.5)

    @pytest.mark.parametrize(
        ("frame", "toes"),
        [
            ('rpy="3.141592653589793 2.5 0"/><axis xyz="0 1 0"', ("foot", "heel")),  # upside down
            ('rpy="1.5707963267948966 0 0"/><axis xyz="0 0 1"', ("foot", "heel")),  # as many drawing programs export
            (TWIST, ("foot", "base")),
        ],
    )
    def test_frames_turned_any_way(self, tmp_path, frame, toes):
        """What matters is that the robot is planar, not how its URDF describes it."""
        text = RAIL.format(links=LINKS, slides="0.6 0 -0.8")
        assert text.count(TWIST) == 1
        path = tmp_path / "rail.urdf"
        path.write_text(text.replace(TWIST, frame), encoding="utf-8")
        robot = load(path, toes=toes)
        assert robot.planar
        for q, v in states(robot, 20):
            close(flattened(Planar(robot).terms(q, v, NUMBERS), robot.toes), by_pinocchio(robot, q, v), 1e-12)

    def test_gravity_of_the_model(self):
        robot = load("q_spear")
        robot.model.gravity.linear = np.array([0.0, 0.0, -1.62])
        q, v = states(robot, 1)[0]
        close(Planar(robot).terms(q, v, NUMBERS).bias, robot.bias(q, v), 1e-12)

    def test_names(self, robot):
        planar = Planar(robot)
        assert planar.coordinates == robot.coordinates and planar.nv == robot.nv
        assert tuple(planar.toes) == robot.toes

    def test_numpy_scalars(self, robot):
        """At rest too, where some rates are exactly zero."""
        planar = Planar(robot)
        q, v = states(robot, 1)[0]
        for rates in (v, np.zeros(robot.nv), np.where(np.arange(robot.nv) % 2, v, 0.0)):
            close(flattened(planar.terms(q, rates, NUMBERS), robot.toes), by_pinocchio(robot, q, rates), 1e-12)


class TestMotion:
    """Accelerations and forces solved for from these terms."""

    @staticmethod
    def solved(planar, q, v, tau, toes):
        terms = planar.terms(q.tolist(), v.tolist(), NUMBERS)
        D, bias = np.array(terms.mass_matrix), np.array(terms.bias)
        J = np.array([row for toe in toes for row in terms.jacobians[toe]]).reshape(-1, len(q))
        drift = np.array([value for toe in toes for value in terms.drifts[toe]])
        matrix = np.block([[D, -J.T], [J, np.zeros((len(J), len(J)))]])
        solution = np.linalg.solve(matrix, np.concatenate([tau - bias, -drift]))
        return solution[: len(q)], solution[len(q) :]

    @pytest.mark.parametrize("name", ROBOTS)
    def test_in_flight(self, name):
        robot = ROBOTS[name]()
        planar, rng = Planar(robot), np.random.default_rng(3)
        for q, v in states(robot, 50):
            tau = rng.uniform(-100.0, 100.0, robot.nv)
            a, _ = self.solved(planar, q, v, tau, ())
            close(a, pin.aba(robot.model, robot.model.createData(), q, v, tau), 1e-11)

    @pytest.mark.parametrize(
        ("name", "toes"),
        [
            ("spear_ii", ("toe",)),
            ("q_spear", ("posterior_toe",)),
            ("q_spear", ("anterior_toe",)),
            ("q_spear", ("posterior_toe", "anterior_toe")),
            ("q_spear with long hips", ("posterior_toe", "anterior_toe")),
            ("q_spear with slow knees", ("anterior_toe",)),
        ],
    )
    def test_on_the_ground(self, name, toes):
        robot = ROBOTS[name]()
        planar, data, rng = Planar(robot), robot.model.createData(), np.random.default_rng(4)
        for q, v in states(robot, 50):
            q = 0.4 * q  # away from straight legs, where forces know no bounds
            q[[i for i, joint in enumerate(robot.coordinates) if joint.endswith("knee")]] += 1.4
            tau = rng.uniform(-100.0, 100.0, robot.nv)
            a, force = self.solved(planar, q, v, tau, toes)
            J = np.vstack([robot.toe_jacobian(q, toe) for toe in toes])
            drift = np.concatenate([robot.toe_drift(q, v, toe) for toe in toes])
            pin.computeAllTerms(robot.model, data, q, v)
            expected = pin.forwardDynamics(robot.model, data, tau, J, drift)
            close(a, expected, 1e-11)
            close(force, data.lambda_c, 1e-11)


class TestScalars:
    def test_a_batch_at_once(self, robot):
        planar, many = Planar(robot), states(robot, 30)
        Q, V = (np.array(part).T for part in zip(*many, strict=True))
        together = flattened(planar.terms(Q, V, NUMBERS), robot.toes)
        together = np.array([np.broadcast_to(value, len(many)) for value in together]).T
        for (q, v), row in zip(many, together, strict=True):
            alone = flattened(planar.terms(q.tolist(), v.tolist(), NUMBERS), robot.toes)
            np.testing.assert_allclose(row, alone, rtol=1e-13, atol=1e-13)

    @pytest.mark.parametrize("name", ["spear_ii", "q_spear"])
    def test_sympy(self, name):
        robot = ROBOTS[name]()
        q = sp.symbols(f"q:{robot.nq}", real=True)
        v = sp.symbols(f"v:{robot.nv}", real=True)
        expressions = flattened(Planar(robot).terms(q, v, sp), robot.toes)
        evaluate = sp.lambdify([*q, *v], expressions, "math", cse=True)
        for at, rates in states(robot, 5):
            close(evaluate(*at.tolist(), *rates.tolist()), by_pinocchio(robot, at, rates), 1e-12)
        at, rates = states(robot, 1)[0]
        values = dict(zip([*q, *v], [*at.tolist(), *rates.tolist()], strict=True))
        substituted = [float(sp.sympify(expression).evalf(subs=values)) for expression in expressions]
        close(substituted, by_pinocchio(robot, at, rates), 1e-12)

    def test_sympy_gravity_is_a_gradient(self):
        """And the toes' Jacobians are their positions' derivatives."""
        robot = ROBOTS["spear_ii"]()
        q = sp.symbols(f"q:{robot.nq}", real=True)
        terms = Planar(robot).terms(q, [0.0] * robot.nv, sp)
        G = sp.Matrix(terms.bias)
        curl = G.jacobian(q) - G.jacobian(q).T
        assert curl.applyfunc(sp.simplify) == sp.zeros(robot.nv)
        for toe in robot.toes:
            expected = sp.Matrix(terms.positions[toe]).jacobian(q)
            difference = (sp.Matrix(terms.jacobians[toe]) - expected).evalf(
                subs=dict(zip(q, (1, 2, 0.3, 0.7), strict=True))
            )
            assert max(abs(value) for value in difference) < 1e-14

    @pytest.mark.extra("casadi")
    def test_casadi(self, robot):
        import casadi

        q, v = casadi.SX.sym("q", robot.nq), casadi.SX.sym("v", robot.nv)
        terms = Planar(robot).terms(casadi.vertsplit(q), casadi.vertsplit(v), casadi)
        values = casadi.vertcat(*flattened(terms, robot.toes))
        function = casadi.Function("terms", [q, v], [values])
        slope = casadi.Function("slope", [q, v], [casadi.jacobian(values, casadi.vertcat(q, v))])
        for at, rates in states(robot, 20):
            close(np.array(function(at, rates)).ravel(), by_pinocchio(robot, at, rates), 1e-12)
        at, rates = states(robot, 1)[0]
        x, n, h = np.concatenate([at, rates]), robot.nq, 1e-3
        for i, column in enumerate(np.array(slope(at, rates)).T):
            offset = np.eye(len(x))[i]

            def value(step, offset=offset):
                y = x + step * offset
                return by_pinocchio(robot, y[:n], y[n:])

            near, far = (value(k * h) - value(-k * h) for k in (1, 2))
            close(column, (8.0 * near - far) / (12.0 * h), 1e-9)


class TestRefusals:
    def test_three_dimensions_and_a_floating_base(self):
        with pytest.raises(BadValue, match="^robot is .*planar robot"):
            Planar(load("q_spear_full"))

    def test_out_of_the_plane(self, tmp_path):
        """One coordinate a joint, but one of them sideways."""
        path = tmp_path / "rail.urdf"
        path.write_text(RAIL.format(links=LINKS, slides="0.6 0.8 0"), encoding="utf-8")
        robot = load(path, toes=["foot"])
        assert not robot.planar and robot.nq == robot.nv
        with pytest.raises(BadValue, match="^robot is "):
            Planar(robot)

    @pytest.mark.filterwarnings("ignore:.*a continuous joint has no limits")
    def test_a_joint_of_two_numbers(self, tmp_path):
        """A wheel's angle is a cosine and a sine."""
        text = RAIL.format(links=LINKS, slides="0.6 0 -0.8")
        start = text.index('<joint name="twist"')
        path = tmp_path / "wheel.urdf"
        path.write_text(text[:start] + text[start:].replace("revolute", "continuous", 1), encoding="utf-8")
        robot = load(path, toes=["foot"])
        assert robot.planar and robot.nq == robot.nv + 1
        with pytest.raises(BadValue, match="one coordinate each"):
            Planar(robot)
