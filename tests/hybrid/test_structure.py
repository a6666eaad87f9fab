"""Numbers that are run-time parameters: systems that differ in them share compiled code."""

import pytest

from spear_pin import Gait
from spear_pin.hybrid.engines.structure import Structure
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.model.equations import mechanism_of

NUMBERS = ("stiffness", "friction", "torso_mass", "hip_distance", "knee_ratio", "posterior_hip_torque")
IN_SPACE = ("roll_mass", "roll_inertia_xx", "hip_spacing", "adduction_stiffness")


def structures(system):
    """The structures of its first domains."""
    return [Structure(system, domain, {}, mechanism_of(system.robot)) for domain in system.domains[:12]]


@pytest.mark.parametrize(("name", "numbers"), [("long_stride", NUMBERS), ("trot", NUMBERS + IN_SPACE)])
def test_numbers_that_vary_are_not_compiled_in(name, numbers):
    system = Gait.load(name).system
    own = structures(system)
    for each in numbers:
        other = with_numbers(system, {each: 1.01 * number(system, each)})
        assert structures(other) == own, each
        assert other.domains[0] is not system.domains[0]
