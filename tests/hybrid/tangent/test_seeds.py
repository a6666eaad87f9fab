"""Derivatives of a system's numbers: of robots of all kinds they have one length, that of the numbers."""

import re

import numpy as np
import pytest

from spear_pin import Gait, hopping, load, monopod, vary
from spear_pin.errors import BadValue
from spear_pin.hybrid.parameters import nonzero, number, with_numbers
from spear_pin.hybrid.tangent.seeds import numbers, seeds
from spear_pin.model.catalogue import mass_law
from spear_pin.model.numbers import body_numbers
from spear_pin.model.variants import PARAMETERS, parameters_of
from tests.model.legged import quadruped

TURNED = 'rpy="0 0.3 0"'


def without_rotors(text):
    """As many files are: they say of a motor no more than that there is one."""
    return re.sub(r"<(drake:\w+) value=\"[^\"]*\"/>", "", text)


def turned(text):
    """Centres of mass in axes that turning back and forth does not bring back to the last digit."""
    return text.replace("<inertial><origin xyz", f"<inertial><origin {TURNED} xyz")


@pytest.fixture(
    params=[
        pytest.param((without_rotors, "FL"), id="without rotors"),
        pytest.param((turned, "HR"), id="turned"),
        pytest.param((str, "FL"), id="as it is"),
    ]
)
def system(request, tmp_path):
    change, leg = request.param
    path = tmp_path / "dog.urdf"
    path.write_text(change(quadruped()), encoding="utf-8")
    return hopping(monopod(load(path, base="free", motors="all"), leg))


def names_of(system):
    return nonzero(system, ["stiffness", "damping", "friction", "stance_torque", *parameters_of(system.robot)]) + tuple(
        body_numbers(system.robot)
    )


def test_are_as_long_as_the_numbers(system):
    names = names_of(system)
    found, step = seeds(system, names).numbers, 2.0**-20
    assert found.shape == (len(numbers(system)), len(names))
    for name, column in zip(names, found.T, strict=True):
        value = number(system, name)
        more, less = (numbers(with_numbers(system, {name: value * (1.0 + s)})) for s in (step, -step))
        if len(more) == len(column):
            np.testing.assert_allclose((more - less) / (2.0 * step * value), column, rtol=1e-6, atol=1e-8)


def test_the_mass_of_a_motor_is_a_power_of_its_size():
    system = hopping(vary(load("spear_ii", locked=["boom_x"]), knee_motor_size=0.4))
    k, gravity = mass_law().exponent, system.robot.weight / system.robot.mass
    expected = gravity * PARAMETERS["knee_motor_mass"].default * k * 0.4 ** (k - 1.0)
    assert seeds(system, ["knee_motor_size"]).weight == pytest.approx([expected], rel=1e-9)


def test_a_rotor_that_there_is_not_is_zero(tmp_path):
    """And none of the shipped robot's, whose names the leg has."""
    path = tmp_path / "dog.urdf"
    path.write_text(without_rotors(quadruped()), encoding="utf-8")
    system = hopping(monopod(load(path, base="free", motors="all"), "FL"))
    assert [number(system, name) for name in ("hip_rotor", "knee_rotor", "boom_damping")] == [0.0, 0.0, 0.0]
    assert nonzero(system, ["hip_rotor", "hip_ratio"]) == ("hip_ratio",)
    with pytest.raises(BadValue, match="hip_rotor is 0.0; expected a number other than zero"):
        seeds(system, ["hip_rotor"])


def test_ratio_and_rotor_of_a_leg_are_those_of_its_file(tmp_path):
    path = tmp_path / "dog.urdf"
    path.write_text(quadruped(), encoding="utf-8")
    leg = monopod(load(path, base="free", motors="all"), "FL")
    system = hopping(leg)
    for joint in ("hip", "knee"):
        row, ratio, rotor = leg.index(joint), number(system, f"{joint}_ratio"), number(system, f"{joint}_rotor")
        assert ratio == pytest.approx(leg.gear_ratio(joint)) and ratio != 60.0
        assert ratio**2 * rotor == pytest.approx(leg.model.armature[row])
        same = vary(leg, **{f"{joint}_rotor": rotor})
        np.testing.assert_allclose(same.model.armature, leg.model.armature, rtol=1e-12)
    assert number(with_numbers(system, {"knee_ratio": 11.0}), "knee_ratio") == 11.0


def test_what_a_law_has_built_in_is_refused_in_the_plane():
    system = Gait.load("long_stride").system
    for name in ("anterior_hip_to_anterior_knee", "posterior_knee_to_posterior_toe"):
        with pytest.raises(BadValue, match="built into the law"):
            seeds(system, [name])
    assert seeds(system, ["anterior_knee_mass"]).numbers.any()
