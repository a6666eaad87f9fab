"""Closed-loop motion for scalars of any kind, against the reference engine's."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import Gait, Ground, HoppingLaw, SpatialLaw, Spring, hopping, load
from spear_pin.gaits.series_hopping import series_hopping
from spear_pin.hybrid.elimination import factorize, solve, solve_sparse, substitute
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.engines.structure import Scalars, with_fields
from spear_pin.hybrid.engines.symbolic import Motion
from spear_pin.hybrid.result import Options
from spear_pin.hybrid.run import run
from spear_pin.model.cable import Anchor, Between, Over
from spear_pin.model.linkage import Linkage
from spear_pin.model.path import Joints, Sum
from spear_pin.model.planar import Planar

OPS = SimpleNamespace(
    **{name: getattr(np, name) for name in ("sin", "cos", "tan", "tanh", "sqrt", "exp", "atan2", "maximum")},
    solve=solve,
)
HOP = {"knee_touchdown": 0.9, "taut": 1.0, "flexing": 1.0, "compressing": 1.0, "limited": 1.0, "speed": 0.3}
SERIES = {"rest": 0.0, "taut": 1.0, "flexing": -1.0}


def hops():
    locked, free = load("spear_ii", locked=["boom_x"]), load("spear_ii")
    placed = HoppingLaw(hip_touchdown=0.5, foot_placement=0.1, virtual_stiffness=3.0)
    return {
        "hop": (hopping(locked), HOP),
        "limited": (hopping(locked, HoppingLaw(minimum_force=10.0)), HOP),
        "free": (hopping(free, placed), HOP),
        "sloped": (hopping(free, placed, ground=Ground(0.8, 0.3, 0.2)), HOP),
        "fixed spring": (hopping(locked, spring=Spring(rest=0.8)), HOP),
        "stretched": (hopping(locked, spring=Spring(hysteresis=1.5)), HOP | {"knee_way": 1.0}),
        "let go": (hopping(locked, spring=Spring(20.0, hysteresis=1.5)), HOP | {"knee_way": -1.0}),
        "series": (series_hopping(load("spear_ii_series", locked=["boom_x"])), SERIES),
        **{f"spring on {name}": (hopping(locked, spring=spring), HOP | held) for name, spring, held in sprung()},
    }


def sprung():
    """Springs on paths of each kind, and two on one joint."""
    half, knee = Spring(24.42), Joints({"knee": 1.0})
    yield "knee, twice", {"knee": half, "other": replace(half, path=knee)}, {"other_rest": 0.85, "other_taut": 1.0}
    cable = Between(Anchor("thigh", (0.03, 0.0, -0.1)), Anchor("shank", (0.012, 0.0, 0.054)))
    pulley = Over(Anchor("thigh", (0.02, 0.0, -0.1)), Anchor("knee", (0, 0, 0)), Anchor("shank", (0.01, 0, -0.1)), 0.03)
    paths = {
        "hip and knee": Joints({"knee": 0.03, "hip": -0.006}),
        "a cable": cable,
        "a pulley": pulley,
        "a linkage": Linkage("knee", 0.03, 0.12, 0.01, -0.3),
        "a cable to the world": Between(Anchor("universe", (0.1, 0.0, 0.2)), Anchor("shank", (0.01, 0.0, -0.1))),
        "a sum": Sum([(1.0, cable), (-0.5, Joints({"hip": 0.02}))]),
    }
    rests = {"hip and knee": (0.4, 0.9), "a cable to the world": (0.5, 0.4, 0.9), "a sum": (0.4, 0.9)}
    for name, path in paths.items():
        held = {"cable_rest": rests.get(name, 0.9), "cable_taut": 1.0}
        yield name, {"cable": Spring(17000.0, damping=30.0, path=path), "knee": Spring(20.0)}, held


SYSTEMS = hops()


def of(system):
    joints = system.robot.model.damping.tolist()
    return Scalars(system.law, system.springs, system.ground, joints)


def compare(system, domain, held, q, v, t=0.01):
    """Acceleration, forces, torques and guards of both."""
    flow = Flow(system, domain, held)
    y = np.concatenate([q, v, np.zeros(flow._nw)])
    flow(t, y)
    guards = [flow.value(guard, t, y) for guard in domain.guards]
    motion = Motion(system, domain, Planar(system.robot), t, list(q), list(v), held, of(system), OPS)
    flow(t, y)  # the limit on flexion asks it for other forces
    scale = 1.0 + np.abs(flow.a).max()
    np.testing.assert_allclose(np.array(motion.a, float) / scale, flow.a / scale, rtol=0, atol=1e-11)
    np.testing.assert_allclose(np.array(motion.u, float), flow.u, rtol=1e-9, atol=1e-9)
    for toe in flow._at_rest:
        given = np.random.default_rng(2).uniform(-20.0, 20.0, len(flow.u)).tolist()
        size = 1.0 + abs(flow.normal_force(toe, given))
        assert float(motion.normal_force(toe, given)) == pytest.approx(flow.normal_force(toe, given), abs=1e-10 * size)
    for toe in system.robot.toes:
        np.testing.assert_allclose(motion.force(toe), flow.force(toe), rtol=1e-9, atol=1e-8)
        np.testing.assert_allclose(motion.toe_acceleration(toe), flow.toe_acceleration(toe), rtol=0, atol=1e-9 * scale)
    # the overload's is a difference of squares
    squares = [np.sum(np.square(flow.u)) if guard.name == "overload" else 0.0 for guard in domain.guards]
    size = 1.0 + np.abs(guards) + squares
    np.testing.assert_allclose(np.array(motion.guards, float) / size, guards / size, rtol=0, atol=1e-10)


@pytest.mark.parametrize("name", SYSTEMS)
def test_hops(name):
    system, held = SYSTEMS[name]
    rng = np.random.default_rng(1)
    for domain in system.domains:
        for _ in range(5):
            compare(system, domain, held, rng.uniform(0.2, 1.0, system.robot.nq), rng.uniform(-1, 1, system.robot.nv))


def test_bound():
    """Every phase of the stride, sticking and slipping, with what is held in it."""
    gait = Gait.load("long_stride")
    segments = run(gait.system, gait.state, 1, Options(keep=True)).segments
    held = {segment.domain.phase: segment.held for segment in segments}
    rng = np.random.default_rng(2)
    seen = 0
    for domain in gait.system.domains:
        if domain.phase in held:
            seen += 1
            for _ in range(3):
                q, v = rng.uniform(0.2, 1.0, 7), rng.uniform(-1, 1, 7)
                q[6] = -q[6]
                compare(gait.system, domain, held[domain.phase], q, v)
    assert seen == 8


@pytest.mark.parametrize(("unnamed", "slow_down"), [((), 1.0), ((0,), 1.0), ((0, 1), 1.0), ((), 0.5)])
def test_torques_beside_those_that_impose(unnamed, slow_down):
    """The motion is what all torques make of it, whether or not the law names them as it imposes the others'."""
    gait = Gait.load("long_stride")
    first = run(gait.system, gait.state, 1, Options(keep=True)).segments[0]

    def law(t, q, v, held, p, dyn, ops):
        given = [(0, -60.0), (1, -35.0)]
        named = [pair for pair in given if pair[0] not in unnamed]
        swing = dyn.imposing([((5, 1.0), (2, 1.0)), ((6, 2.0),)], [3.0 - q[5], -4.0 * v[6]], (2, 3), named)
        swing = swing if slow_down == 1.0 else [slow_down * torque for torque in swing]
        return [*(torque for _, torque in given), *swing]

    rng = np.random.default_rng(6)
    for _ in range(3):
        q, v = rng.uniform(0.2, 1.0, 7) * [1, 1, 1, 1, 1, 1, -1], rng.uniform(-1, 1, 7)
        compare(gait.system, replace(first.domain, law=law), first.held, q, v)


def test_imposing_in_any_order():
    """Rows need not have the order of their motors, nor unit weights."""
    gait = Gait.load("long_stride")
    segments = run(gait.system, gait.state, 1, Options(keep=True)).segments
    flight = next(segment for segment in segments if segment.domain.name == "flight_1")

    def law(t, q, v, held, p, dyn, ops):
        rows = [((i, 2.0),) for i in (4, 3, 6, 5)]
        return dyn.imposing(rows, [-4.0 * v[i] for i in (4, 3, 6, 5)], (0, 1, 2, 3), ())

    q, v = np.array([0.1, 0.7, 0.1, 0.5, 0.6, 0.3, -0.8]), np.linspace(-1.0, 1.0, 7)
    compare(gait.system, replace(flight.domain, law=law), flight.held, q, v)


def test_many_states_at_once():
    """With arrays as scalars."""
    system, held = SYSTEMS["hop"]
    rng = np.random.default_rng(3)
    q, v = rng.uniform(0.2, 1.0, (3, 7)), rng.uniform(-1, 1, (3, 7))
    stance = system.domains[0]
    every = Motion(system, stance, Planar(system.robot), 0.0, list(q), list(v), held, of(system), OPS)
    for i in range(7):
        one = Motion(system, stance, Planar(system.robot), 0.0, list(q[:, i]), list(v[:, i]), held, of(system), OPS)
        np.testing.assert_allclose([part[i] for part in every.a], one.a, rtol=1e-12)


def test_frames_of_no_toe():
    robot = load("spear_ii")
    planar, q = Planar(robot), [0.2, 0.7, 0.5, 1.1]
    for frame, expected in (("hip", (0.2, 0.7)), ("knee", (0.2 + 0.318 * np.sin(0.5), 0.7 - 0.318 * np.cos(0.5)))):
        np.testing.assert_allclose(planar.position(frame, q, np), expected, atol=1e-14)


def test_linear_algebra():
    rng = np.random.default_rng(4)
    root = rng.normal(size=(5, 5))
    matrix, right = root @ root.T + np.eye(5), rng.normal(size=5)
    matrix[0, 3:] = matrix[3:, 0] = 0.0
    expected = np.linalg.solve(matrix, right)
    np.testing.assert_allclose(substitute(factorize(matrix.tolist()), right.tolist()), expected, atol=1e-12)
    np.testing.assert_allclose(solve(matrix.tolist(), right.tolist()), expected, atol=1e-12)
    skewed = matrix + rng.normal(size=(5, 5))
    np.testing.assert_allclose(solve(skewed.tolist(), right.tolist()), np.linalg.solve(skewed, right), atol=1e-10)


def test_limbs_stay_uncoupled():
    """Joints on one trunk share nothing but the trunk, so factors are no fuller than the mass matrix."""
    rng = np.random.default_rng(2)
    matrix = np.diag(4.0 + rng.random(6))
    matrix[0, 1:] = matrix[1:, 0] = rng.uniform(0.1, 1.0, 5)
    lower, _ = factorize(matrix.tolist())
    np.testing.assert_array_equal(np.nonzero(lower), np.nonzero(np.tril(matrix, -1)))


@pytest.mark.parametrize("seed", range(20))
def test_sparse_systems(seed):
    """As of a constrained robot: units to begin with, zeros on the diagonal, what is left dense."""
    rng = np.random.default_rng(seed)
    root = rng.normal(size=(5, 5))
    mass, rows = root @ root.T + np.eye(5), rng.normal(size=(2, 5)) * (rng.random((2, 5)) < 0.6)
    rows[0, :2], rows[1, :2] = (1.0, 0.0), (0.0, -1.0)
    matrix, right = np.block([[mass, -rows.T], [rows, np.zeros((2, 2))]]), rng.normal(size=7)
    np.testing.assert_allclose(solve_sparse(matrix.tolist(), right.tolist()), np.linalg.solve(matrix, right), atol=1e-9)


def test_sparse_systems_of_units():
    matrix = [[0.0, 1.0, 2.0], [-1.0, 0.0, 0.0], [3.0, 0.0, 1.0]]
    np.testing.assert_allclose(solve_sparse(matrix, [1.0, 2.0, 3.0]), np.linalg.solve(matrix, [1.0, 2.0, 3.0]))


def test_fields_need_not_be_valid():
    law = with_fields(HoppingLaw(), {"frequency": "f"})
    assert law.frequency == "f" and law.knee_gain == 63.25 and isinstance(law, HoppingLaw)


def test_fields_of_a_part():
    plane = Gait.load("long_stride").system.law
    law = with_fields(SpatialLaw(plane), {"virtual_stiffness": "k", "posterior_adduction": "a"})
    assert law.plane.virtual_stiffness == "k" and law.posterior_adduction == "a"
    assert law.plane.knee_touchdown == plane.knee_touchdown
