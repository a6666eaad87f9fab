"""Closed loops in MuJoCo: its equality constraints have the robot's rows, in files that are read and written."""

import warnings

import numpy as np
import pytest

from spear_pin import RobotWarning, load
from spear_pin.model.mjcf import to_mjcf
from tests.crosscheck.test_engines import assert_close
from tests.model.looped import CRANK_LEG, CRANK_LOOP, crank_leg, five_bar, write
from tests.model.mjcf_looped import BARS, BASE, BELT, PIN, bar, machine

pytestmark = pytest.mark.extra("mujoco")
SITES = '<connect site1="tip" site2="pivot"/>'
TWO = f"""<body name="rocker" pos="{BASE} 0.03 0" euler="0 0.3 0">
    <joint name="out" type="slide" axis="1 0 0" ref="0.02"/>
    <joint name="rocker" axis="0 1 0" pos="0.01 0 0.02" ref="0.1"/>
    <inertial pos="0 0 -0.05" mass="0.2" diaginertia="1e-3 1e-3 1e-3"/></body>"""
TURNED = BARS.replace('name="coupler" pos="0 0 -0.1"', 'name="coupler" pos="0 0 -0.1" euler="0 -0.4 0"')
FILES = {
    "anchor": machine(),
    "sites": machine(SITES),
    "belt": machine(PIN + BELT, BARS + bar("pulley", "0 0.1 0", ref='ref="0.5"')),
    "world": machine(f'<connect body1="coupler" anchor="{BASE} 0 0.02"/>', motors=""),
    "a site of the world": machine('<connect site1="tip" site2="hook"/>'),
    "two joints of a body": machine(
        bars=BARS.partition('<body name="rocker"')[0] + TWO, motors='<motor joint="crank"/><motor joint="out"/>'
    ),
    "turned bodies": machine(bars=TURNED),
}
WRITTEN = {"crank_leg": crank_leg, "five_bar": five_bar, "crank_hopper": lambda _: load("crank_hopper")}


def assert_same_loops(robot, text, seed=3):
    """In MuJoCo the loops are closed where the robot's are, have its rows but for signs, and bodies its inertia."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(text)
    data, zeros = mujoco.MjData(model), model.qpos0
    assert [model.joint(i).name for i in range(model.njnt)] == list(robot.coordinates)
    rng, seen, matrix = np.random.default_rng(seed), 0, np.zeros((model.nv, model.nv))
    for start in rng.uniform(-0.5, 0.5, (20, robot.nv)):
        q = robot.closure.closed(start)
        if not np.isfinite(q).all():
            continue
        seen += 1
        data.qpos[:] = q + zeros
        mujoco.mj_forward(model, data)
        rows = np.reshape(data.efc_J, (-1, model.nv))[: data.ne]
        moving = np.abs(rows).max(axis=1) > 1e-12  # a pin's row along y does nothing in the plane
        rows, own = rows[moving], robot.loop_jacobian(q)
        signs = np.sign(np.sum(rows * own, axis=1))
        np.testing.assert_allclose(signs[:, None] * rows, own, rtol=0, atol=1e-9)
        assert np.abs(data.efc_pos[: data.ne]).max() < 1e-9
        for column, unit in zip(matrix, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, column, unit)
        assert_close(robot.mass_matrix(q), matrix)
    assert seen > 5


@pytest.mark.parametrize("which", FILES)
def test_loops_that_are_read(tmp_path, which):
    path = tmp_path / "machine.xml"
    path.write_text(FILES[which], encoding="utf-8")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RobotWarning)
        robot = load(path, motors=None if "motor" in FILES[which] else ["crank"])
    assert robot.loops
    assert_same_loops(robot, FILES[which])


@pytest.mark.parametrize("which", WRITTEN)
def test_loops_that_are_written(tmp_path, which):
    robot = WRITTEN[which](tmp_path)
    assert_same_loops(robot, to_mjcf(robot))


def test_ends_of_a_pin_beside_each_other(tmp_path):
    """In the plane they coincide; MuJoCo gets them at one place, as its pin has a row along y too."""
    toml = CRANK_LOOP.replace("at = [0, 0, 0]", "at = [0, 0.2, 0]")
    robot = load(write(tmp_path, "crank_leg", CRANK_LEG, toml), base="fixed")
    assert_same_loops(robot, to_mjcf(robot))
