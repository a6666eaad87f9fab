"""What a spring saves by the report: the kept gaits are gaits, cost what is said, and no hop nearby costs less."""

from dataclasses import replace

import pytest

from spear_pin import load
from spear_pin.hybrid.periodic import residual
from spear_pin.hybrid.simulate import simulate
from spear_pin.studies.audit import knees
from spear_pin.studies.audit.knees import BOUND, GAITS, HOP
from spear_pin.studies.audit.statements import STATEMENTS
from spear_pin.studies.design import points_of
from spear_pin.studies.payoff import hopping
from spear_pin.studies.payoff.bounding import BOUNDS
from spear_pin.studies.payoff.grid import FIXED, KINDS, NONE, Point
from spear_pin.studies.payoff.hop_search import best_hop
from spear_pin.studies.payoff.searches import Search
from spear_pin.studies.prose import read

OVER = {"knee_motor_size": (0.3, 4.0), "knee_ratio": (6.0, 30.0)}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("gait", GAITS)
def test_each_is_a_gait_with_that_knee(gait, kind):
    found = knees.load_gait(gait, kind)
    assert residual(found.system, found.state) < 1e-8
    spring = found.system.spring
    assert (spring.stiffness == 0.0) == (kind == NONE) and (spring.rest is not None) == (kind == FIXED)


@pytest.mark.slow
def test_what_they_cost():
    costs = {gait: [knees.figures(gait, kind).cost for kind in KINDS] for gait in GAITS}
    assert costs[HOP] == pytest.approx([16.98, 2.376, 5.477], rel=1e-3)
    assert costs[BOUND] == pytest.approx([0.4171, 0.2169, 0.2263], rel=1e-3)
    studies = {statement.id: statement.study for statement in STATEMENTS}
    assert studies["free-flight"]() == pytest.approx([2.305, 1.043], rel=2e-3)
    assert studies["spring-saves"]() == pytest.approx([0.3225, 0.5425, 0.1436, 1.011], rel=1e-3)
    assert studies["compromise-addressed"]() == pytest.approx([2.83, 0.9241, 0.5335, 2.692, 1.172, 3.319], rel=1e-3)


@pytest.mark.slow
@pytest.mark.extra("casadi")
def test_what_its_motors_have_to_do_is_what_a_bound_without_springs_takes():
    """The search for that bound ends where it ended before."""
    gait = BOUNDS.reference(load("q_spear"), knees.SPEED)
    cycle = simulate(gait.system, gait.state, progress=False)
    for part, (torque, rate) in read(knees.__package__, "motors.toml").items():
        given = points_of(gait.system.robot, cycle, part)
        assert (given.rms.max(), abs(given.speed).max()) == pytest.approx((torque, rate), rel=1e-3)


@pytest.mark.slow
@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("kind", KINDS)
def test_no_hop_nearby_costs_less(kind):
    start, robot = knees.load_gait(HOP, kind), load("spear_ii", locked=["boom_x"])
    asked = Search(Point(kind, 0.2, 0.0 if kind == NONE else None), None, (hopping.FINER,))
    task = hopping.task_of(robot, knees.motors(HOP), "electricity", asked, OVER)
    found = best_hop(replace(task, starts=0), [start])
    again = hopping.figures_of(found.gait, knees.motors(HOP), samples=hopping.FINER, own=robot).cost
    assert again > 0.999 * knees.figures(HOP, kind).cost
