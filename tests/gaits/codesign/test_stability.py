"""Borders of stability against closed forms, and their derivatives against gaits found again."""

import numpy as np
import pytest

from spear_pin.gaits.codesign.stability import borders, slopes
from spear_pin.gaits.sensitivity.closing import close_cycle, find_changed
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.tangent.resets import NotDifferentiable

VARY, KEEP = ("stance_torque",), {"flight_time": 0.2}


def rotation(modulus, angle):
    return modulus * np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])


def test_closed_forms():
    assert borders(np.diag([0.5, -0.25]), 1.0) == pytest.approx([0.5 * 1.25, 1.5 * 0.75, 1.0 + 0.125])
    assert borders(np.diag([0.5, -0.25]), 0.5)[0] == pytest.approx(0.0)
    assert borders(np.diag([0.3, -0.5]), 0.5)[1] == pytest.approx(0.0)
    assert borders(rotation(0.7, 1.0), 0.7)[2] == pytest.approx(0.0)


@pytest.mark.parametrize("modulus", [0.9, 1.1])
def test_signs_tell_inside_from_outside(modulus):
    pair = np.zeros((3, 3))
    pair[:2, :2], pair[2, 2] = rotation(modulus, 2.0), 0.3
    for matrix, which in ((np.diag([modulus, 0.2]), 0), (np.diag([-modulus, 0.2]), 1), (pair, 2)):
        found = borders(matrix, 1.0)
        assert (found[which] > 0.0) == (modulus < 1.0)
        assert (np.delete(found, which) > 0.0).all()


def test_smooth_where_real_multipliers_meet():
    """Of [[a, b], [1, a]] the pair is a ± √b: the modulus has a kink at b = 0, the borders are linear in b."""
    b = np.linspace(-0.1, 0.1, 5)
    found = np.array([borders(np.array([[0.5, each], [1.0, 0.5]]), 0.9) for each in b])
    assert np.abs(np.diff(found, 2, axis=0)).max() < 1e-12


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize("name", ["stiffness", "knee_touchdown"])
def test_slopes_along_the_branch(hop, name):
    begun = close_cycle(Orbit(hop.system, hop.state, (*VARY, name)), KEEP)
    found = slopes(begun, list(KEEP), 0.6)
    h = {"stiffness": 0.02, "knee_touchdown": 2e-4}[name]
    ends = [borders(find_changed(begun, KEEP, {name: k * h}).jacobian, 0.6) for k in (1, -1, 2, -2)]
    expected = (8.0 * (ends[0] - ends[1]) - (ends[2] - ends[3])) / (12.0 * h)
    assert found[:, 0] == pytest.approx(expected, rel=1e-4, abs=1e-5)


@pytest.mark.extra("heyoka")
def test_where_one_side_has_no_derivative_the_other_tells(hop, monkeypatch):
    begun = close_cycle(Orbit(hop.system, hop.state, (*VARY, "stiffness")), KEEP)
    expected, beside = slopes(begun, list(KEEP), 0.6), Orbit.beside

    def below(self, change, *others):
        if change["stiffness"] > 0.0:
            raise NotDifferentiable("of this side")
        return beside(self, change, *others)

    monkeypatch.setattr(Orbit, "beside", below)
    assert slopes(begun, list(KEEP), 0.6) == pytest.approx(expected, rel=1e-4, abs=1e-6)
    monkeypatch.setattr(Orbit, "beside", lambda self, *others: below(self, {"stiffness": 1.0}))
    assert not slopes(begun, list(KEEP), 0.6).any()
