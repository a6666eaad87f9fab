"""A belt that is not rigid: beside the spring, or between knee and rotor."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from spear_pin.errors import BadValue
from spear_pin.studies.push_test import WITH_MOTOR, belt_frequencies, equilibrium, rest_at, spear_ii, swing

LEG = spear_ii()
KNEE = rest_at(LEG, WITH_MOTOR, 1.0)


def test_rigid_is_the_swing():
    assert belt_frequencies(LEG, KNEE, 1.0).rigid == pytest.approx(swing(LEG, KNEE).frequency, rel=1e-12)


def test_limits():
    """Stiff: the rotor moves with the knee. Soft: it stays where it is."""
    stiff, soft = belt_frequencies(LEG, KNEE, 1e7), belt_frequencies(LEG, KNEE, 1e-9)
    alone = swing(LEG.with_rotor(0.0), KNEE).frequency
    assert stiff.low == pytest.approx(stiff.rigid, rel=1e-5) and soft.high == pytest.approx(alone, rel=1e-8)
    assert soft.locked == pytest.approx(alone, rel=1e-8) and soft.parallel == pytest.approx(soft.rigid, rel=1e-8)


@pytest.mark.parametrize("belt", [0.7256, 1.0884, 30.0])
def test_modes_by_integration(belt):
    """Knee and rotor as two bodies, started in either mode's own shape, pass zero after a quarter period."""
    rest = equilibrium(LEG, KNEE)
    body = float(LEG.effective_inertia(rest)) - LEG.rotor
    slope = (float(LEG.gravity(rest + 1e-5)) - float(LEG.gravity(rest - 1e-5))) / 2e-5
    found = belt_frequencies(LEG, KNEE, belt)
    for frequency in (found.low, found.high):
        shape = belt / (belt - LEG.rotor * (2 * np.pi * frequency) ** 2)  # of the rotor, per knee

        def flow(t, y):
            twist = belt * (y[0] - y[1])
            return y[2], y[3], (-(KNEE.stiffness + slope) * y[0] - twist) / body, twist / LEG.rotor

        quarter = solve_ivp(flow, (0, 0.25 / frequency), [1.0, shape, 0, 0], "DOP853", rtol=1e-11, atol=1e-13).y[:, -1]
        assert abs(quarter[0]) < 1e-6 and abs(quarter[1]) < 1e-6 * max(1.0, abs(shape))


def test_as_soft_as_neoprene_it_would_not_delay():
    """Faster than without motor, when the source sees the motor delay the swing."""
    alone = swing(LEG.with_rotor(0.0), KNEE).frequency
    for belt in (0.7256, 1.0884):
        assert belt_frequencies(LEG, KNEE, belt).high > alone > belt_frequencies(LEG, KNEE, belt).rigid


def test_refusals():
    with pytest.raises(BadValue, match="^belt is "):
        belt_frequencies(LEG, KNEE, 0.0)
    with pytest.raises(BadValue, match="^rotor is "):
        belt_frequencies(LEG.with_rotor(0.0), KNEE, 1.0)
