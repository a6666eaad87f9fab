"""Measures of cycles with kinks of the law, against differences: peaks on a kink move with it."""

from dataclasses import dataclass

import numpy as np
import pytest

from spear_pin import HoppingLaw, Spring, hopping
from spear_pin.gaits.sensitivity.orbit import Orbit
from spear_pin.hybrid.parameters import number

pytestmark = pytest.mark.extra("heyoka")
OVER = ("stance_torque", "stiffness", "knee_mass")


@dataclass(frozen=True)
class Capped(Spring):
    """A spring whose torque stays the same from a deflection on."""

    cap: float = 0.3

    def torque(self, deflection, ops=np):
        return super().torque(-ops.maximum(-deflection, -self.cap), ops)


def orbit(robot, state, stiffness, cap):
    system = hopping(robot, HoppingLaw(stance_torque=2.0), Capped(stiffness, cap=cap))
    return Orbit(system, state, OVER)


@pytest.mark.parametrize(("stiffness", "cap"), [(180.0, 0.1), (250.0, 0.15), (180.0, 0.2)])
def test_measures_against_differences(robot, hop, stiffness, cap):
    at = orbit(robot, hop.state, stiffness, cap)
    bent = [each for each in at.cycle.stretches if each.arc.event is None]
    assert bent and all(np.abs(each.tau).max() > 0.0 for each in bent)
    d, still = at.dimension, np.zeros(2 * robot.nv)
    for j, name in enumerate(OVER):
        h = 1e-4 * number(at.system, name)
        beside = [at.beside({name: k * h}, still, OVER).measures for k in (1, -1, 2, -2)]
        for measure, found in at.measures.items():
            a, b, c, e = (each[measure].value for each in beside)
            expected = (8.0 * (a - b) - (c - e)) / (12.0 * h)
            scale = max(abs(found.value), np.abs(found.derivative[d:] * [number(at.system, n) for n in OVER]).max())
            assert h * found.derivative[d + j] == pytest.approx(h * expected, abs=1e-11 * scale), (measure, name)
