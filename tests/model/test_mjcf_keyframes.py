"""Keyframes of MJCF files: postures of the robot, whatever else is in the file."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import load
from tests.cases.legs import mjcf, put

BOTH = 'range="-130 130"'
BALL = '<worldbody><body name="ball" pos="1 0 0"><freejoint/><geom size="0.1"/></body></worldbody>'


def postures(tmp_path, **parts):
    robot = load(put(tmp_path, xml=mjcf(**parts)), base="fixed", motors="all")
    return robot, {each.key(): each.data() for each in robot.model.referenceConfigurations}


def keys(*texts):
    return f"<keyframe>{''.join(f'<key {text}/>' for text in texts)}</keyframe>"


def test_names(tmp_path):
    _, found = postures(tmp_path, knee=BOTH, after=keys('name="home" qpos="0.6 -1.2"', 'qpos="0 -1"', 'name="ctrl"'))
    assert set(found) - {"qpos0"} == {"home", "key_1"}  # the former is Pinocchio's own, zero
    np.testing.assert_array_equal(found["home"], [0.6, -1.2])


def test_ref_is_zero(tmp_path):
    with pytest.warns(match="less ref"):
        _, found = postures(tmp_path, knee=f'{BOTH} ref="-40"', after=keys('name="home" qpos="0.6 -1.2"'))
    np.testing.assert_allclose(found["home"], [0.6, -1.2 + 40], rtol=1e-14)


@pytest.mark.filterwarnings("ignore:.*the bodies beside it")
@pytest.mark.parametrize("before", [True, False])
def test_other_bodies_are_passed_over(tmp_path, before):
    ball, own = "9 9 9 1 0 0 0", "0.6 -1.2"
    key = keys(f'name="home" qpos="{f"{ball} {own}" if before else f"{own} {ball}"}"')
    _, found = postures(tmp_path, knee=BOTH, **({"before": BALL, "after": key} if before else {"after": BALL + key}))
    np.testing.assert_array_equal(found["home"], [0.6, -1.2])


def test_base_that_floats(tmp_path):
    key = keys('name="home" qpos="1 2 3 0 0 0 2 0.6 -1.2"')
    robot = load(put(tmp_path, xml=mjcf(free='<freejoint name="f"/>', knee=BOTH, after=key)), motors="all")
    found = robot.model.referenceConfigurations["home"]
    np.testing.assert_array_equal(found, [1, 2, 3, 0, 0, 1, 0, 0.6, -1.2])
    assert pin.isNormalized(robot.model, found) and robot.legs[0].side == -1
