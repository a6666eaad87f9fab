"""Random hops, with slip or stick as they land: every derivative is right, or the cycle is refused by name."""

import numpy as np
import pytest

from spear_pin import find_gait, hopping, load
from spear_pin.errors import NoGait
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.tangent.record import PLAIN, Recorder
from spear_pin.hybrid.tangent.resets import NotDifferentiable

pytestmark = [pytest.mark.slow, pytest.mark.extra("heyoka")]
NAMES = ("stance_torque", "stiffness", "damping", "knee_touchdown", "friction", "knee_ratio")
H = 1e-5  # of a parameter
SMALL = 0.05  # changes by the whole of a parameter, below which differences are rounding
TRIPLES = 10


def ends(system, y, name, steps):
    """States after a cycle from the same state with other values of a number."""
    found = []
    for step in steps:
        recorder = Recorder(with_numbers(system, {name: number(system, name) + step}))
        found.append(recorder.lap(y).y)
    return found


def checked(system):
    """Orders of events of a hop whose derivatives were compared, or why it was refused."""
    try:
        orbit = Orbit(system, find_gait(system).state, NAMES)
        cycle = orbit.cycle
    except NoGait:
        return "no gait"
    except NotDifferentiable as refusal:
        return str(refusal)
    y = np.concatenate(orbit.chart.state(np.zeros(orbit.dimension)))
    for j, name in enumerate(NAMES):
        value = number(system, name)
        h = H * abs(value)
        a, b, c, d = ends(system, y, name, (h, -h, 2.0 * h, -2.0 * h))
        expected = (8.0 * (a - b) - (c - d)) / (12.0 * h)
        error = np.abs(cycle.dy[:, orbit.dimension + j] - expected).max()
        assert value * error <= 1e-7 * max(value * np.abs(expected).max(), SMALL)
    return cycle.order


@pytest.fixture(scope="module")
def system():
    return hopping(load("spear_ii", locked=["boom_x"]))


def test_the_other_kind_of_hop(system):
    order = checked(with_numbers(system, {"stance_torque": 6.5}))
    assert [*map(set, order[-3:])] == [
        {"torque_switch"},
        {"lift_off"},
        {"touchdown"},
    ]  # it lifts off at once after the switch


def test_of_springs_ratios_and_friction(system):
    rng, told = np.random.default_rng(0), []
    for _ in range(TRIPLES):
        stiffness, ratio, friction = rng.uniform(42, 60), rng.uniform(10, 25), rng.uniform(0.2, 1.0)
        told.append(checked(with_numbers(system, {"stiffness": stiffness, "knee_ratio": ratio, "friction": friction})))
    orders = {each for each in told if isinstance(each, tuple)}
    assert {any("stick" in met for met in order) for order in orders} == {True, False}  # some land sliding
    refused = {each for each in told if isinstance(each, str)} - {"no gait"}
    assert all(each.startswith(PLAIN) and each.endswith("toes alternate") for each in refused), refused
