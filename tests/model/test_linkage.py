"""The spring behind a slider and a rod, against its geometry solved by sympy and against its energy."""

import numpy as np
import pytest
import sympy as sp

from spear_pin.errors import BadValue
from spear_pin.model.linkage import SliderLinkage
from spear_pin.model.spring import Spring

LINKAGE = SliderLinkage(4000.0, free_length=0.14, crank=0.05, rod=0.1, stop=0.22, offset=0.01)
ANGLES = np.linspace(-1.2, 1.4, 53)


def test_compression_and_torque_are_those_of_the_geometry():
    phi, s = sp.symbols("phi s", real=True)
    c, r, e = (sp.Float(x, 30) for x in ("0.05", "0.1", "0.01"))
    pin, slider = sp.Matrix([c * sp.sin(phi), c * sp.cos(phi)]), sp.Matrix([s, e])
    ahead = max(sp.solve((pin - slider).dot(pin - slider) - r**2, s), key=lambda root: root.subs(phi, 0))
    x = sp.Float("0.14", 30) - (sp.Float("0.22", 30) - ahead)
    torque = sp.diff(4000 * x**2 / 2, phi)
    for angle in ANGLES:
        there = float(x.subs(phi, angle))
        assert float(LINKAGE.compression(angle)) == pytest.approx(there, abs=1e-15)
        expected = float(torque.subs(phi, angle)) if there > 0 else 0.0
        assert float(LINKAGE.torque(angle)) == pytest.approx(expected, abs=1e-12)


def test_torque_is_the_slope_of_the_energy():
    h = 1e-6
    slope = (LINKAGE.energy(ANGLES + h) - LINKAGE.energy(ANGLES - h)) / (2 * h)
    np.testing.assert_allclose(LINKAGE.torque(ANGLES), slope, atol=1e-6)


def test_it_lies_loose_before_it_begins():
    begin = LINKAGE.begin(-1.0, 1.0)
    assert abs(float(LINKAGE.compression(begin))) < 1e-12
    assert not LINKAGE.torque(np.linspace(-1.0, begin - 1e-9, 20)).any() and LINKAGE.torque(begin + 0.01) > 0
    with pytest.raises(BadValue, match="^angles is .*between which compression of the spring begins"):
        LINKAGE.begin(0.5, 1.0)


def test_its_table_is_one_of_a_spring():
    begin = LINKAGE.begin(-1.0, 1.0)
    spring = Spring(0.0, damping=0.0, table=LINKAGE.table(begin, np.arange(0.1, 1.5, 0.1)))
    past = np.linspace(0.0, 1.4, 100)
    np.testing.assert_allclose(-spring.torque(past), LINKAGE.torque(begin + past), atol=0.05)


@pytest.mark.parametrize(
    ("name", "value"),
    [("stiffness", 0.0), ("free_length", -0.1), ("crank", float("nan")), ("rod", 0.0), ("stop", "1"), ("offset", 0.05)],
)
def test_what_is_no_linkage(name, value):
    numbers = {name: getattr(LINKAGE, name) for name in ("stiffness", "free_length", "crank", "rod", "stop", "offset")}
    with pytest.raises(BadValue, match=f"{name} is "):
        SliderLinkage(**numbers | {name: value})
