"""Hybrid motion of legs with closed loops: impacts, both engines, hops beside those of eliminated equations."""

import math

import numpy as np
import pytest

from spear_pin import Contact, HoppingLaw, Spring, find_gait, hopping, simulate
from spear_pin.errors import BadValue
from spear_pin.gaits.reaching import pose_leg
from spear_pin.hybrid.batch import simulate_many
from spear_pin.hybrid.domain import Reset
from spear_pin.hybrid.engines.pinocchio import Flow
from spear_pin.hybrid.lanes.runner import FEW
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import differentiate_return_map, eigenvalues
from spear_pin.hybrid.strikes import strike_by_rule
from spear_pin.model.path import Joints
from tests.hybrid.eliminated import hop
from tests.hybrid.looped_hops import FOLDS, looped_hopping
from tests.hybrid.test_symbolic import compare
from tests.model.looped import LOWER, crank_leg, five_bar
from tests.model.test_loops import at
from tests.slow import slow_but

NAMES = "crank_leg", "five_bar"
IMPACTS = {  # angles, rates, velocity after the impact, impulse, loss: of another program
    "crank_leg": ((0.4,), (-0.8, 3.0), (-0.621917389, 12.076640039), (0.0, 0.556412060), 0.179584036),
    "five_bar": (
        (1.3, -1.1),
        (-1.2, 2.0, -3.0),
        (-1.201068952, 11.205170592, -10.080291889),
        (0.000515777, 0.110842497),
        0.051649502,
    ),
}
SPRUNG = {  # springs, where the leg rests on its toe, and how fast it swings about that: of another program
    "crank_leg": (
        {"slide": Spring(3000.0, damping=0.0, rest=0.19, unilateral=False)},
        (-0.672120310,),
        34.979591,
    ),
    "five_bar": (
        {
            "front_hip": Spring(25.0, damping=0.0, rest=1.2, unilateral=False),
            "back_hip": Spring(25.0, damping=0.0, rest=-1.2, unilateral=False),
        },
        (1.245583615, -1.245583615),
        43.998531,
    ),
}


@pytest.fixture(scope="module")
def legs(tmp_path_factory):
    folder = tmp_path_factory.mktemp("loops")
    return {"crank_leg": crank_leg(folder), "five_bar": five_bar(folder)}


@pytest.mark.parametrize("name", NAMES)
class TestImpact:
    def test_is_that_of_another_program(self, legs, name):
        robot, (angles, rates, after, impulse, loss) = legs[name], IMPACTS[name]
        q = at(robot, *angles)
        v = robot.reduced(q, rates).v
        strike = strike_by_rule(looped_hopping(robot), ["toe"], Reset(impact=("toe",)), q, v)
        own = [robot.index(joint) for joint in robot.independent]
        np.testing.assert_allclose(strike.v[own], after, rtol=0, atol=1e-9)
        np.testing.assert_allclose(strike.impulse[0], impulse, rtol=0, atol=1e-9)
        assert -strike.work == pytest.approx(loss, abs=1e-9)

    def test_keeps_the_loop_closed(self, legs, name):
        robot, (angles, rates, *_) = legs[name], IMPACTS[name]
        q = at(robot, *angles)
        strike = strike_by_rule(looped_hopping(robot), ["toe"], Reset(impact=("toe",)), q, robot.reduced(q, rates).v)
        assert np.abs(robot.loop_jacobian(q) @ strike.v).max() < 1e-12


@pytest.mark.parametrize("name", NAMES)
def test_it_rests_and_swings_as_that_of_another_program(legs, name):
    """The leg stands on its toe without torques; the stiffness about that is a central difference."""
    robot, (springs, angles, frequency) = legs[name], SPRUNG[name]
    system = looped_hopping(robot, spring=springs)
    stance = system.domains[0]
    held = {f"{spring}_taut": 1.0 for spring in springs}
    flow = Flow(system, stance, held)

    def swinging(fold):
        """The acceleration of the first motor where all have folded the leg further by so much."""
        q = at(robot, *(angle + fold * sign for angle, sign in zip(angles, FOLDS, strict=False)))
        flow(0.0, np.concatenate([q, np.zeros(robot.nv + flow._nw)]))
        return flow.a[robot.index(robot.actuated[0])]

    step = 1e-4
    slope = (swinging(step) - swinging(-step)) / (2 * step)
    assert abs(swinging(0.0) / slope) < 1e-9  # rad, from where it rests
    assert math.sqrt(-slope) == pytest.approx(frequency, abs=1e-5)


@pytest.mark.parametrize("name", NAMES)
def test_both_engines_accelerate_alike(legs, name):
    """In every phase, toes sticking and sliding, at states with closed loops."""
    robot = legs[name]
    system, rng = looped_hopping(robot), np.random.default_rng(3)
    held = {"leg_rest": 0.15 if name == "crank_leg" else (1.2, -0.9), "leg_taut": 1.0}
    for domain in system.domains:
        for _ in range(3):
            angles = rng.uniform(0.3, 1.0, robot.nu) * FOLDS[: robot.nu]
            q = at(robot, *angles)
            compare(system, domain, held, q, robot.reduced(q, rng.uniform(-2.0, 2.0, 1 + robot.nu)).v)


@pytest.mark.parametrize("name", slow_but(NAMES, "crank_leg"))
def test_hops_are_those_of_eliminated_equations(legs, name, cycles=3):
    system = looped_hopping(legs[name], contact=Contact(5.0))
    q, v = system.guess()
    own = [system.robot.index(joint) for joint in system.robot.independent]
    times, last = hop(name, np.concatenate([q[own], v[own]]), cycles)
    hops = simulate(system, (q, v), cycles=cycles)
    assert np.abs([event.time for event in hops.events if event.name == "touchdown"] - times).max() < 1e-9
    np.testing.assert_allclose(hops.q[-1][own], last[: len(own)], rtol=0, atol=1e-9)
    assert max(np.abs(system.robot.loop_gap(q)).max() for q in hops.q) < 1e-9
    assert np.abs(hops.ledger.residual).max() < 1e-8


def test_events_close_loops_that_a_coarse_integration_opened(legs):
    system = looped_hopping(legs["crank_leg"])
    hops = simulate(system, system.guess(), cycles=3, rtol=1e-5)
    assert max(np.abs(system.robot.loop_gap(q)).max() for q in hops.q) > 1e-8
    for event in (each for each in hops.events if each.name != "apex"):  # which is only observed
        assert np.abs(system.robot.loop_gap(event.q)).max() < 1e-12
        assert np.abs(system.robot.loop_jacobian(event.q) @ event.v).max() < 1e-12


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("name", slow_but(NAMES, "crank_leg"))
class TestGait:
    def test_lanes_are_those_of_the_reference_engine(self, legs, name):
        system = looped_hopping(legs[name])
        q, v = system.guess()
        one = simulate(system, (q, v), cycles=3)
        for n in (2, 2 * FEW):  # one by one, and together
            many = simulate_many(system, np.array([q] * n), np.array([v] * n), cycles=3)
            assert not many.repeated.any()
            np.testing.assert_allclose(many.q, [one.q[-1]] * n, rtol=0, atol=1e-9)

    def test_multipliers_are_those_of_differences(self, legs, name):
        system = looped_hopping(legs[name])
        gait = find_gait(system, vary=["push"], target={"flight_time": 0.15})
        assert len(gait.multipliers) == 1 + legs[name].nu
        exact = np.sort_complex(gait.multipliers)
        own = with_parameters(system, gait.parameters)
        differences = differentiate_return_map(own, gait.state)
        np.testing.assert_allclose(np.sort_complex(eigenvalues(differences)), exact, rtol=0, atol=1e-6)


@pytest.mark.parametrize("opening", [0.1, 0.01, -0.01, -0.1])
def test_the_determinant_of_a_five_bar_is_that_of_its_lower_links(legs, opening):
    """l² sin(ψ₁ - ψ₂) with ψ the directions of the lower links, near the toggle where both knees meet."""
    robot = legs["five_bar"]
    q = robot.closed([0.3, opening, -opening, -opening, opening])
    turns = (q[1] + q[2]) - (q[3] + q[4])
    dependent = [robot.index("front_knee"), robot.index("back_knee")]
    found = np.linalg.det(robot.loop_jacobian(q)[:, dependent])
    assert abs(found) == pytest.approx(LOWER**2 * abs(math.sin(turns)), abs=1e-12)
    assert abs(found) == pytest.approx({0.1: 3.988e-3, 0.01: 4.000e-4}[abs(opening)], abs=5e-7)


@pytest.mark.extra("heyoka")
def test_a_run_ends_at_a_toggle_in_both_engines(legs):
    """Thighs that close at 6 rad/s bring both knees together in the air."""
    robot = legs["five_bar"]
    spring = {"leg": Spring(12.0, path=Joints({"front_hip": 1.0, "back_hip": -1.0}))}
    system = hopping(robot, HoppingLaw(1.0, knee_gain=0.0, knee_damping=0.0, hip_gain=0.0, hip_damping=0.0), spring)
    q = pose_leg(robot, 0.0, 0.6)
    q[0] = 1.0
    v = robot.reduced(q, [0.0, -3.0, 3.0]).v
    run, many = simulate(system, (q, v), cycles=1), simulate_many(system, q[None], v[None], cycles=1)
    assert run.reason == many.reason[0] == "toggle" and "toggle at t = " in run.message
    assert many.message[0] == run.message and not many.repeated[0]
    assert 0.0 < run.q[-1][1] - run.q[-1][3] < 2e-3


def test_a_state_with_an_open_loop_is_refused(legs):
    system = looped_hopping(legs["crank_leg"])
    q, v = system.guess()
    with pytest.raises(BadValue, match="q is .* keeps pin closed"):
        simulate(system, (q + [0, 0, 1e-3, 0], v))
    with pytest.raises(BadValue, match="v is .* keeps pin closed"):
        simulate(system, (q, v + [0, 0, 1e-3, 0]))


@pytest.mark.extra("heyoka")
def test_lanes_with_an_open_loop_end_at_once(legs):
    system = looped_hopping(legs["crank_leg"])
    q, v = system.guess()
    states = np.array([q, q + [0, 0, 0.05, 0], q]), np.array([v, v, v + [0, 0, 0.5, 0]])
    many = simulate_many(system, *states, cycles=1)
    assert many.reason.tolist() == ["complete", "open_loop", "open_loop"]
