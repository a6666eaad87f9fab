"""The dynamics in space for any scalars: numbers, whole batches and CasADi, against Pinocchio."""

import math
import warnings
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import load
from spear_pin.errors import BadValue
from spear_pin.model.planar import Planar
from spear_pin.model.spatial import Spatial
from tests.model.spatial_arm import ARM

STATES = 20
BATCH = SimpleNamespace(sin=np.sin, cos=np.cos)
SOLO = [f"{leg}_FOOT" for leg in ("FL", "FR", "HL", "HR")]
ON_RAIL = """
<robot name="rail">
  <link name="base"/>
  <link name="car"><inertial><origin xyz="0.1 0.2 -0.1" rpy="0.3 0 1"/><mass value="2"/>
    <inertia ixx="0.02" ixy="0.001" ixz="0.003" iyy="0.03" iyz="-0.002" izz="0.04"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0 0.1 -0.3"/><mass value="1"/>
    <inertia ixx="0.02" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.02"/></inertial></link>
  <link name="rod"><inertial><origin xyz="0.2 0 0"/><mass value="0.7"/>
    <inertia ixx="0.01" ixy="0" ixz="0.001" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
  <link name="tip"/>
  <joint name="slide" type="prismatic"><parent link="base"/><child link="car"/><origin xyz="0 1 0" rpy="0.2 0.4 1"/>
    <axis xyz="0.6 0 -0.8"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint>
  <joint name="swing" type="revolute"><parent link="car"/><child link="arm"/><origin xyz="0.1 -0.1 1" rpy="0 0.4 2"/>
    <axis xyz="0 0.6 0.8"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint>
  <joint name="push" type="prismatic"><parent link="arm"/><child link="rod"/><origin xyz="0 0 -0.4" rpy="1 0 0"/>
    <axis xyz="0 -1 0"/><limit lower="-9" upper="9" effort="9" velocity="9"/></joint>
  <joint name="end" type="fixed"><parent link="rod"/><child link="tip"/><origin xyz="0.1 0.2 0.3"/></joint>
</robot>
"""


def in_file(tmp_path, text, toe):
    path = tmp_path / "robot.urdf"
    path.write_text(text, encoding="utf-8")
    return load(path, toes=[toe], motors="all")


ROBOTS = {
    "q_spear_full": lambda tmp_path: load("q_spear_full", base="chain"),
    "spear_ii": lambda tmp_path: load("spear_ii"),
    "arm": lambda tmp_path: in_file(tmp_path, ARM, "foot"),
    "rail": lambda tmp_path: in_file(tmp_path, ON_RAIL, "tip"),
    "solo12": lambda tmp_path: load("solo12", base="chain", motors="all", toes=SOLO),
}


@pytest.fixture(params=[*list(ROBOTS)[:-1], pytest.param("solo12", marks=pytest.mark.extra("example-robot-data"))])
def robot(request, tmp_path):
    return ROBOTS[request.param](tmp_path)


def motions(robot, seed=5):
    rng = np.random.default_rng(seed)
    for _ in range(STATES):
        q, v, a = (rng.uniform(-size, size, robot.nv) for size in (1.4, 8.0, 50.0))
        yield q, v, a, {toe: rng.uniform(-300.0, 300.0, 3) for toe in robot.toes}


def world(vector, robot):
    """A vector of the world; of a planar robot x and z."""
    return np.array(vector)[[0, 2] if robot.planar else [0, 1, 2]]


def close(actual, expected, tolerance=1e-12):
    expected = np.asarray(expected)
    np.testing.assert_allclose(actual, expected, rtol=0, atol=tolerance * max(1.0, np.abs(expected).max()))


def mechanisms(robot):
    return [Spatial(robot), Planar(robot)] if robot.planar else [Spatial(robot)]


def test_forces_as_by_pinocchio(robot):
    """In the plane from the mass matrix too, which knows pushes along x and z only."""
    for mechanism in mechanisms(robot):
        for q, v, a, pushes in motions(robot):
            jacobians = {toe: robot.toe_jacobian(q, toe) for toe in robot.toes}
            pulled = sum(jacobians[toe].T @ world(push, robot) for toe, push in pushes.items())
            flat = len(mechanism.lift) == 2
            given = {toe: tuple((world(push, robot) if flat else push).tolist()) for toe, push in pushes.items()}
            needed = mechanism.forces(q.tolist(), v.tolist(), a.tolist(), math, given)
            close(needed, robot.mass_matrix(q) @ a + robot.bias(q, v) - pulled)
            rest = [0.0] * robot.nv
            close(mechanism.forces(q.tolist(), rest, a.tolist(), math, gravity=False), robot.mass_matrix(q) @ a)


def test_toes_as_by_pinocchio(robot):
    for mechanism in mechanisms(robot):
        flat = len(mechanism.lift) == 2
        for q, v, a, _ in motions(robot):
            for toe, foot in mechanism.moving_feet(q.tolist(), v.tolist(), a.tolist(), math).items():
                jacobian = robot.toe_jacobian(q, toe)
                found = [np.array(part) if flat else world(part, robot) for part in foot]
                close(found[0], robot.toe_position(q, toe))
                close(found[1], jacobian @ v)
                close(found[2], jacobian @ a + robot.toe_drift(q, v, toe))


def test_a_toe_of_the_world_stays_and_carries_its_push(robot):
    q, v, a, _ = next(motions(robot))
    motion = [part.tolist() for part in (q, v, a)]
    for mechanism in mechanisms(robot):
        place = (0.1, 0.2, 0.3)[: len(mechanism.lift)]
        free, still = mechanism.forces(*motion, math), tuple(0.0 for _ in place)
        mechanism.toes = {"peg": (-1, place)}
        assert mechanism.moving_feet(*motion, math)["peg"] == (place, still, still)
        assert mechanism.forces(*motion, math, {"peg": (50.0,) * len(place)}) == free


def test_terms_as_by_pinocchio(robot):
    spatial = Spatial(robot)
    assert spatial.with_numbers(spatial.numbers).numbers == spatial.numbers
    for q, v, _, _ in motions(robot):
        terms = spatial.terms(q.tolist(), v.tolist(), math)
        close(terms.mass_matrix, robot.mass_matrix(q))
        close(terms.bias, robot.bias(q, v))
        for toe in robot.toes:
            close(world(terms.positions[toe], robot), robot.toe_position(q, toe))
            close(world(terms.jacobians[toe], robot), robot.toe_jacobian(q, toe))
            close(world(terms.drifts[toe], robot), robot.toe_drift(q, v, toe))
            close(world(spatial.position(toe, q.tolist(), math), robot), robot.toe_position(q, toe))


def test_twice_the_mass_has_twice_the_inertia():
    spatial = Spatial(load("q_spear_full", base="chain"))
    numbers = np.array(spatial.numbers)
    of_bodies = numbers[: 14 * spatial.nv].reshape(spatial.nv, 14)
    of_bodies[:, :11] *= 2.0  # mass, first moment, inertia and rotor, but not the placement
    q, v = np.linspace(-0.4, 0.6, spatial.nv).tolist(), np.linspace(1.0, -2.0, spatial.nv).tolist()
    heavy, light = spatial.with_numbers(numbers.tolist()).terms(q, v, math), spatial.terms(q, v, math)
    close(heavy.mass_matrix, 2.0 * np.array(light.mass_matrix))
    close(heavy.bias, 2.0 * np.array(light.bias))
    assert heavy.positions == light.positions


def test_a_batch_at_once():
    robot = load("q_spear_full", base="chain")
    spatial = Spatial(robot)
    given = list(motions(robot))
    q, v, a = (np.array([motion[i] for motion in given]).T for i in range(3))
    pushes = {toe: tuple(np.array([motion[3][toe] for motion in given]).T) for toe in robot.toes}
    together = np.array(spatial.forces(q, v, a, BATCH, pushes))
    for i, (*motion, forces) in enumerate(given):
        alone = spatial.forces(*(part.tolist() for part in motion), math, forces)
        np.testing.assert_allclose(together[:, i], alone, rtol=1e-13, atol=1e-10)


@pytest.mark.extra("casadi")
def test_symbols():
    """CasADi's symbols; so many operations as a recursion has, and not as matrices."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)
        import casadi as ca
    robot = load("q_spear_full", base="chain")
    spatial = Spatial(robot)
    symbols = [ca.SX.sym(name, robot.nv) for name in "qva"]
    push = ca.SX.sym("F", 3 * len(robot.toes))
    parts = ca.vertsplit(push)
    pushes = {toe: tuple(parts[3 * i : 3 * i + 3]) for i, toe in enumerate(robot.toes)}
    needed = spatial.forces(*(ca.vertsplit(each) for each in symbols), ca, pushes)
    function = ca.Function("forces", [*symbols, push], [ca.vertcat(*needed)], {"cse": True})
    assert function.n_instructions() < 1700
    for q, v, a, forces in motions(robot):
        found = np.array(function(q, v, a, np.concatenate(list(forces.values())))).ravel()
        close(found, spatial.forces(q.tolist(), v.tolist(), a.tolist(), math, forces))


def test_refuses_a_quaternion():
    with pytest.raises(BadValue, match="chain"):
        Spatial(load("q_spear_full"))


def test_toes_round_a_post():
    """Along the circle on which they stand, which turns as they move, and vertically."""
    robot, rng = load("hoppy"), np.random.default_rng(3)
    for q, v in rng.uniform(-1.0, 1.0, (STATES, 2, robot.nv)):
        q[:2] *= 0.3
        feet = Spatial(robot).feet(q.tolist(), v.tolist(), math)
        np.testing.assert_allclose(feet.jacobians["toe"], robot.toe_jacobian(q, "toe"), rtol=0, atol=1e-14)
        np.testing.assert_allclose(feet.drifts["toe"], robot.toe_drift(q, v, "toe"), rtol=0, atol=1e-12)
