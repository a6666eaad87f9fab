"""Two points that are really searched: a bound without springs, and from it one with switchable ones."""

import pytest

from spear_pin import load, simulate
from spear_pin.studies.payoff import Motors, Point, Search, Store, assume_motor
from spear_pin.studies.payoff.bounding import BOUNDS
from spear_pin.studies.payoff.gaits import Searcher
from spear_pin.studies.payoff.grid import NONE, SWITCHED
from spear_pin.studies.payoff.searches import rebuilt


@pytest.mark.slow
@pytest.mark.extra("casadi")
def test_two_points(tmp_path):
    robot = load("q_spear")
    motors = Motors(
        assume_motor(robot, "knee", 30.0, 15.0), assume_motor(robot, "hip", 30.0, 12.0), own=("knee", "hip")
    )
    searcher = Searcher(BOUNDS, robot, motors, Store(tmp_path / "store.jsonl", {}))
    (bare,) = searcher.find([Search(Point(NONE, 2.0), None, BOUNDS.meshes)])
    (sprung,) = searcher.find([Search(Point(SWITCHED, 2.0, 56.0), bare, BOUNDS.meshes)])
    for found in (bare, sprung):
        gait = rebuilt(BOUNDS.kind, robot, found.gait)
        stride = simulate(gait.system, gait.state, progress=False)
        assert found.figures.speed == pytest.approx(2.0, abs=1e-6) and found.figures.residual < 1e-8
        assert stride.cycles == 1 and abs(stride.q[-1, 1:] - stride.q[0, 1:]).max() < 1e-6
        # the collocation's cost takes gears to lose both ways, the simulation's only as they do
        assert 0.8 < found.figures.cost / (found.solution.objective / 10.0) < 1.02
    assert sprung.figures.cost < 0.98 * bare.figures.cost
    assert (
        sprung.origin == "no spring at 2 m/s"
        and searcher.find([Search(Point(NONE, 2.0), None, BOUNDS.meshes)])[0].key == bare.key
    )
