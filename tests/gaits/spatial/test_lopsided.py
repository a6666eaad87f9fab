"""A trot of a robot whose left and right differ: a cycle is a whole stride, its halves no mirror images."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import Gait, trotting
from spear_pin.gaits.spatial.trotting import halfway
from spear_pin.hybrid.periodic import chart, return_map
from spear_pin.hybrid.symmetry import even_out, head_state, measure_asymmetry, mirror_of


@pytest.fixture(scope="module")
def trot():
    return Gait.load("trot")


@pytest.fixture(scope="module")
def heavier(trot):
    """Q-SPEAR with 1% more mass in one of its thighs."""
    model = trot.system.robot.model.copy()
    joint = model.getJointId("posterior_left_hip")
    body = model.inertias[joint]
    model.inertias[joint] = pin.Inertia(1.01 * body.mass, body.lever, 1.01 * body.inertia)
    return trot.system.robot.with_model(model)


def test_how_far_from_the_mirror_image(trot, heavier):
    assert measure_asymmetry(trot.system.robot) < 1e-12
    assert 1e-4 < measure_asymmetry(heavier) < 0.1


def test_evened_has_the_mean_of_both_sides(heavier):
    """D is linear in the inertias of the bodies."""
    own, even = mirror_of(heavier), even_out(heavier)
    q = np.cos(np.arange(18.0)) / 2.0
    image = own(own(heavier.mass_matrix(own(q))).T)
    np.testing.assert_allclose(even.mass_matrix(q), (heavier.mass_matrix(q) + image) / 2.0, rtol=0, atol=1e-12)
    assert measure_asymmetry(even) < 1e-12
    assert even.mass == pytest.approx(heavier.mass, rel=1e-14)
    assert measure_asymmetry(heavier) > 1e-4


@pytest.mark.slow
def test_a_cycle_is_a_whole_stride(trot, heavier):
    system = trotting(heavier, trot.system.law, trot.system.spring)
    run = return_map(system, chart(system, trot.state).state(np.zeros(32)), 1e-8)
    assert {"diagonal_left_stance", "diagonal_right_stance"} <= run.durations.keys()
    assert [event.name for event in run.events].count("halfway") == 1
    assert system.measures["period"](run) == pytest.approx(2.0 * trot.period, rel=0.05)


@pytest.mark.slow
def test_between_the_halves_it_is_nearly_as_it_was(trot, heavier):
    system = trotting(heavier, trot.system.law, trot.system.spring)
    run = return_map(system, chart(system, trot.state).state(np.zeros(32)), 1e-8)
    own = np.concatenate(halfway(trot.system, return_map(trot.system, trot.state)))
    np.testing.assert_allclose(own, np.concatenate(head_state(*trot.state)), rtol=0, atol=1e-8)
    off = np.abs(np.concatenate(halfway(system, run)) - own).max()
    assert 1e-6 < off < 0.5
