"""What an encoder at the boom's pivot reports: closed forms of its errors."""

import numpy as np
import pytest

from spear_pin import find_gait, hopping, load
from spear_pin.errors import BadValue
from spear_pin.hybrid.hardware import Sensing
from spear_pin.model.boom import RotaryBoom, on_rotary_boom
from spear_pin.studies.boom_encoder import Encoder, height_by_arc, height_by_sine, read_angle, tilt
from spear_pin.studies.hardware import Rig, on_rig

BOOM = RotaryBoom()
HEIGHTS = np.linspace(0.3, 0.9, 61)


def test_without_errors_it_is_the_height():
    np.testing.assert_allclose(height_by_sine(BOOM, read_angle(BOOM, Encoder(), HEIGHTS)), HEIGHTS, atol=1e-15)


def test_a_milliradian_is_two_millimetres():
    read = height_by_sine(BOOM, read_angle(BOOM, Encoder(offset=1e-3), HEIGHTS))
    np.testing.assert_allclose(read - HEIGHTS, 2.0 * np.cos(BOOM.elevation(HEIGHTS)) * 1e-3, atol=2e-7)
    assert read[28] - HEIGHTS[28] == pytest.approx(2e-3, abs=1e-8)  # at the pivot's height


def test_resolution():
    step = 2e-3
    read = height_by_sine(BOOM, read_angle(BOOM, Encoder(resolution=step), np.linspace(0.3, 0.9, 5001)))
    assert np.abs(read - np.linspace(0.3, 0.9, 5001)).max() == pytest.approx(BOOM.radius * step / 2, rel=0.02)
    assert (read - np.linspace(0.3, 0.9, 5001)).std() == pytest.approx(BOOM.radius * step / 12**0.5, rel=0.02)


def test_the_small_angle():
    read = height_by_arc(BOOM, read_angle(BOOM, Encoder(), HEIGHTS)) - HEIGHTS
    phi = np.arcsin((HEIGHTS - 0.58) / 2.0)
    np.testing.assert_allclose(read, 2.0 * (phi - np.sin(phi)), atol=1e-15)
    np.testing.assert_allclose(read, (HEIGHTS - 0.58) ** 3 / (6 * 2.0**2), rtol=0.02, atol=1e-15)


def test_noise_is_seeded():
    one, again, other = (read_angle(BOOM, Encoder(noise=1e-3, seed=s), np.full(4000, 0.6)) for s in (1, 1, 2))
    np.testing.assert_array_equal(one, again)
    assert (one != other).all() and one.std() == pytest.approx(1e-3, rel=0.05)


def test_tilt():
    lowered, outward = tilt(BOOM, [0.58, 0.68], 0.56)
    assert lowered == pytest.approx([0.0, 0.56 * (1 - np.sqrt(1 - 0.05**2))])
    assert outward == pytest.approx([0.0, 0.56 * 0.05])


@pytest.mark.parametrize("values", [{"resolution": -1.0}, {"noise": np.nan}, {"offset": 4.0}])
def test_bad_encoder(values):
    with pytest.raises(BadValue, match="^Encoder."):
        Encoder(**values)


@pytest.mark.slow
def test_apexes_of_eleven_hops():
    """Twelve bits hide what the noise does; fourteen just show it."""
    robot = on_rotary_boom(load("spear_ii", locked=["boom_x"]), BOOM)
    gait = find_gait(hopping(robot), ["stance_torque"], {"flight_time": 0.2})
    rig = Rig(hip_efficiency=1.0, knee_efficiency=1.0, sensing=Sensing(0.005, 0.2))
    apexes = np.array([event.q[0] for event in on_rig(gait, rig, 11, 1e-7, progress=False).named("apex")])
    assert apexes.size == 11 and np.ptp(apexes) == pytest.approx(7.6e-4, abs=2e-5)
    for bits, worst in ((12, 1.48e-3), (14, 3.8e-4)):
        step = 2 * np.pi / 2**bits
        read = height_by_sine(BOOM, read_angle(BOOM, Encoder(step), apexes))
        assert np.abs(read - apexes).max() == pytest.approx(worst, abs=3e-5)
        assert len(np.unique(read)) == 2 and np.ptp(read) == pytest.approx(2.0 * step, rel=1e-3)
