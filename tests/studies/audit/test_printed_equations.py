"""Printed equations beside corrected ones, against derivations that share nothing with the package."""

import numpy as np
import pytest

from spear_pin.studies.audit import printed_equations
from spear_pin.studies.audit.switch import off_stiffness, switched_stiffness, torques
from tests.lagrangian import BOOM_MASS, SPEAR_II_LEG
from tests.push_by_hand import derive


@pytest.mark.parametrize("angle", [0.4, 1.0, 1.6])
def test_the_corrected_forms_are_lagranges(angle):
    inertia, _, _, gravity, *_ = derive(SPEAR_II_LEG, BOOM_MASS)(angle)
    assert printed_equations.effective_inertia(angle)[1] == pytest.approx(inertia, rel=1e-9)
    assert printed_equations.gravity_torque(angle)[1] == pytest.approx(-gravity, rel=1e-9)


def test_the_printed_kinetic_energy_by_hand():
    half = 0.5
    rise = 0.318 * np.sin(half)
    by_hand = (0.047 + 0.014 + 1.72 * 0.008**2) / 4 + 0.027 + 0.005 + 0.48 * 0.14**2 + 4.6 * rise**2
    assert printed_equations.effective_inertia()[0] == pytest.approx(by_hand, rel=1e-12)


def test_equations_that_are_right_have_no_error():
    assert printed_equations.kinematics_error() < 1e-14
    assert printed_equations.crank_error() < 1e-11
    assert 0.0 < printed_equations.stance_error() < 1e-9


def test_poles_in_flight():
    poles = printed_equations.flight_poles()
    slow, fast = poles[0], poles[-1]
    assert (slow.real, abs(slow.imag)) == (pytest.approx(-4.40, abs=5e-3), pytest.approx(18.52, abs=5e-3))
    assert (fast.real, abs(fast.imag)) == (pytest.approx(-7.97, abs=5e-3), pytest.approx(41.42, abs=5e-3))
    assert np.sort(printed_equations.flight_poles(printed=True).real)[-2:] == pytest.approx([15.07, 35.15], abs=5e-3)
    assert printed_equations.damping_gain() == pytest.approx(0.605 / 0.189, rel=0.01)


def test_signs():
    printed, corrected = printed_equations.spring_growth()
    assert corrected < 0.0 < printed
    assert printed_equations.friction_power() == (1.0, -1.0)
    assert printed_equations.friction_power(2.0, -3.0) == (-6.0, -6.0)  # corrected, it takes energy either way
    assert printed_equations.rotor_in_mass_matrix() == (pytest.approx(0.047), pytest.approx(0.027))


def test_switch():
    assert off_stiffness(1.0) == 0.5  # two equal springs in series
    assert switched_stiffness() == pytest.approx(1.0)
    engaged, disengaged = torques([0.0, 0.3, 0.5], latched=0.3)
    assert engaged[:2].tolist() == [0.0, 0.0] and engaged[2] == pytest.approx(0.2 * 48.84)
    assert disengaged[2] == pytest.approx(0.5 * 0.01 / 1.01 * 48.84)
