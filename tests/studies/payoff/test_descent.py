"""The descent from a hop: what a fixed spring rests at, what limits say, and that it leads down."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from spear_pin import HoppingLaw, Spring, find_gait, hopping, load
from spear_pin.errors import MissingExtra, NoGait
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import changed, number, rebuilt, with_parameters
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.studies.payoff import Motors, descent
from spear_pin.studies.payoff import hopping as hopping_study
from spear_pin.studies.payoff.cycles import AtTouchdown
from spear_pin.studies.payoff.descent import descended, limits
from spear_pin.studies.payoff.hopping import MESH, TAUT, electricity, kept, ranges
from spear_pin.studies.payoff.motors import known


@pytest.fixture(scope="module")
def motors():
    robot = load("spear_ii", locked=["boom_x"])
    return Motors(*(known(robot, part)[0] for part in ("knee", "hip")), own=("knee", "hip"))


def test_limits_are_those_of_file_and_motors(motors):
    robot = load("spear_ii", locked=["boom_x"])
    at_most, at_least = limits(robot, motors)
    assert at_most["peak_torque_knee"] == 60.0 and at_most["greatest_knee"] == pytest.approx(2.8)
    assert at_least["reserve_hip"] == 0.0 and at_least["least_knee"] == pytest.approx(-0.2)
    assert not [name for name in limits(robot, None)[1] if name.startswith("reserve")]
    slower = replace(motors, knee=replace(motors.knee, motor=replace(motors.knee.motor, max_speed=150.0)))
    assert limits(robot, slower)[0]["peak_speed_knee"] == 10.0


@pytest.mark.extra("heyoka")
def test_a_fixed_spring_rests_where_the_knee_is_to_land(hop):
    """The derivative by the commanded angle, against cycles in which the spring was put there by hand."""
    spring = Spring(stiffness=30.0, rest=1.37, unilateral=False)
    law = HoppingLaw(1.37, 0.64, 7.0, 1.18, virtual_stiffness=5.8, hold_extension=True, minimum_force=3.3)
    system = hopping(hop.system.robot, law, spring)
    tied = changed(system, AtTouchdown())
    state = find_gait(system, guess=(np.array([0.498, 0.649, 1.34]), np.array([-0.895, 2.228, 4.53]))).state
    orbit = Orbit(tied, state, ("knee_touchdown",))
    h = 1e-4

    def end(angle):
        moved = rebuilt(with_parameters(system, {"knee_touchdown": angle}), spring=replace(spring, rest=angle))
        return Orbit(moved, state, ()).cycle.y

    beside = [end(law.knee_touchdown + k * h) for k in (1, -1, 2, -2)]
    expected = (8.0 * (beside[0] - beside[1]) - (beside[2] - beside[3])) / (12.0 * h)
    assert orbit.cycle.dy[:, -1] == pytest.approx(expected, abs=1e-6 * np.abs(expected).max())


@pytest.fixture(scope="module")
def start(hop):
    """A hop of the study's, before it is led down."""
    law = replace(hop.system.law, hold_extension=True, minimum_force=0.05 * hop.system.robot.weight, hip_touchdown=0.5)
    return find_gait(rebuilt(hop.system, law=law), ["stance_torque"], {"flight_time": 0.2})


@pytest.mark.parametrize("failure", [NotDifferentiable("toes alternate"), NoGait("none", 1.0), ZeroDivisionError()])
def test_without_a_way_down_the_hop_stays_as_it_was(start, monkeypatch, failure):
    def refuses(*arguments, **named):
        raise failure

    monkeypatch.setattr(descent, "optimize_design", refuses)
    assert descended(start, "effort", None, ranges(start.system.robot, free=False), TAUT) is start


def test_that_heyoka_is_missing_is_told(start, monkeypatch):
    def missing(*arguments, **named):
        raise MissingExtra("heyoka", "fast", "a descent")

    monkeypatch.setattr(descent, "optimize_design", missing)
    with pytest.raises(MissingExtra, match="fast"):
        descended(start, "effort", None, ranges(start.system.robot, free=False), TAUT)


@pytest.mark.parametrize(
    ("torque", "cost", "left", "taken"),
    [(7.0, 0.9, 0.0, True), (7.0, 1.1, 0.0, False), (7.0, 0.9, -1.0, False), (1e3, 0.9, 0.0, False)],
)
def test_an_end_is_taken_if_it_costs_less_within_limits(start, monkeypatch, torque, cost, left, taken):
    """Of a torque in its range, too."""
    end = replace(start, system=with_parameters(start.system, {"stance_torque": torque}))
    monkeypatch.setattr(hopping_study, "descended", lambda *arguments: end)
    monkeypatch.setattr(hopping_study, "judged", lambda task, gait: (1.0, 0.0) if gait is start else (cost, left))
    task = SimpleNamespace(ranges=ranges(start.system.robot, free=False))
    assert hopping_study._down(task, start, "effort", None) is (end if taken else start)


@pytest.mark.slow
@pytest.mark.extra("heyoka")
def test_it_leads_down_within_limits(start, motors):
    chosen = ranges(start.system.robot, free=False)
    end = descended(start, "electricity", motors, chosen, TAUT)
    cycles = [simulate(each.system, each.state, samples=MESH, progress=False) for each in (start, end)]
    before, after = (electricity(motors, each.system, cycle) for each, cycle in zip((start, end), cycles, strict=True))
    assert after < 0.87 * before and kept(motors, end.system, cycles[1]).min() > -1e-3
    assert end.durations["flight"] == pytest.approx(0.2, abs=1e-8) and end.residual < 1e-9
    assert all(low <= number(end.system, name) <= high for name, (low, high) in chosen.items())
