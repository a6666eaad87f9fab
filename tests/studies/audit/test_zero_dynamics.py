"""The outputs of a bound: that they stay at zero, that it is noticed where they do not, and how fast they return."""

import math

import pytest
from scipy.optimize import brentq

from spear_pin.errors import BadValue
from spear_pin.hybrid.result import Moment, Options
from spear_pin.hybrid.run import run
from spear_pin.studies import prose
from spear_pin.studies.audit import zero_dynamics
from spear_pin.studies.audit.runs import bound, stride_run


@pytest.fixture(scope="module")
def system():
    return bound().system


def test_outputs_stay_at_zero(system):
    assert zero_dynamics.largest_output(system.robot, stride_run()) < 1e-8


@pytest.mark.slow
def test_what_is_off_is_noticed(system):
    flight = next(each for each in stride_run().segments if each.domain.phase == "flight_1")
    state = flight.pieces[0].state([flight.pieces[0].begin])[:, 0]
    q, v = state[: system.robot.nq].copy(), state[system.robot.nq : system.robot.nq + system.robot.nv]
    q[system.robot.index("anterior_hip")] += 2e-3
    off = run(system, Moment(q, v, "flight_1", flight.held), 1, Options(keep=True))
    assert zero_dynamics.largest_output(system.robot, off) == pytest.approx(2e-3, rel=1e-3)


@pytest.mark.slow
def test_they_return_as_a_critically_damped_pair_of_poles_does(system):
    x = brentq(lambda x: (1 + x) * math.exp(-x) - zero_dynamics.LEFT, 1.0, 10.0)
    assert zero_dynamics.decay(system, stride_run(), 0.01) == pytest.approx(x, rel=1e-4)
    said = prose.read("spear_pin.studies.audit.statements", "chapter5.toml")["outputs-converge"]
    assert said["criterion"]["near"][0] == pytest.approx(x, abs=1e-4)


def test_a_phase_that_is_too_short(system):
    with pytest.raises(BadValue, match="epsilon"):
        zero_dynamics.decay(system, stride_run(), 0.1)
