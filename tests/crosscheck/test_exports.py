"""Exported files in the programs they are for: MuJoCo compiles the MJCF to the same robot."""

import numpy as np
import pytest
import trimesh

from spear_pin.model.loading import ROBOTS, load
from spear_pin.model.mjcf import qpos, qvel, to_mjcf
from spear_pin.model.monopod import monopod
from spear_pin.model.sagittal import sagittal
from spear_pin.model.variants import vary
from tests.cli.calls import printed, run
from tests.crosscheck.test_engines import assert_close, in_world_axes, joints, random_states

CASES = {name: lambda name=name: load(name) for name in ROBOTS} | {
    "locked": lambda: load("spear_ii", locked=["boom_x"]),
    "a leg that was cut out": lambda: monopod(load("q_spear_full"), _leg("q_spear_full")),
    "a plane": lambda: vary(sagittal(load("q_spear_full")), knee_ratio=20.0),
    "varied": lambda: vary(load("q_spear_full"), hip_spacing=0.4, knee_ratio=20.0, torso_mass=30.0),
}


def _leg(name):
    return load(name).legs[0]


pytestmark = pytest.mark.extra("mujoco")
each_robot = pytest.mark.parametrize("case", CASES)


def compiled(robot):
    """MuJoCo, the model, its data, and the entries of its vectors that each number of q and of v is."""
    import mujoco

    model = mujoco.MjModel.from_xml_string(to_mjcf(robot))
    positions, velocities = [], []
    for name, floating in joints(robot):
        joint = model.joint(name)
        positions += [joint.qposadr[0] + i for i in ((0, 1, 2, 4, 5, 6, 3) if floating else (0,))]
        velocities += [joint.dofadr[0] + i for i in range(6 if floating else 1)]
    return mujoco, model, mujoco.MjData(model), positions, velocities


@each_robot
def test_mass_matrix_bias_and_toes(case):
    robot = CASES[case]()
    mujoco, model, data, positions, velocities = compiled(robot)
    assert sorted(positions) == list(range(model.nq)) and sorted(velocities) == list(range(model.nv))
    mass_matrix = np.zeros((model.nv, model.nv))
    for q, v in random_states(robot):
        change, rate = in_world_axes(robot, q, v, 3)
        data.qpos[positions], data.qvel[velocities] = q, change @ v
        np.testing.assert_array_equal(qpos(robot, q), data.qpos)
        assert_close(qvel(robot, q, v), data.qvel)
        mujoco.mj_forward(model, data)
        for column, unit in zip(mass_matrix, np.eye(model.nv), strict=True):
            mujoco.mj_mulM(model, data, column, unit)
        there = mass_matrix[np.ix_(velocities, velocities)]
        assert_close(robot.mass_matrix(q), change.T @ there @ change)
        assert_close(robot.bias(q, v), change.T @ (data.qfrc_bias[velocities] + there @ rate))
        for toe in robot.toes:
            place = data.site(toe).xpos - [0.0, 0.0, robot.radii.get(toe, 0.0)]
            assert_close(robot.toe_position(q, toe), place[[0, 2]] if robot.planar else place)


@each_robot
def test_motors(case):
    robot = CASES[case]()
    mujoco, model, data, _, velocities = compiled(robot)
    efforts = robot.model.upperEffortLimit[[robot.index(joint) for joint in robot.actuated]]
    data.ctrl[:] = 2.0 * model.actuator_ctrlrange[:, 1]  # as much as it may, and then as much again
    mujoco.mj_forward(model, data)
    assert_close(robot.actuation_matrix @ efforts, data.qfrc_actuator[velocities])
    assert float(model.body_mass.sum()) == pytest.approx(robot.mass, abs=1e-9)


@pytest.mark.parametrize("name", ["spear_ii", "q_spear", "q_spear_full"])
def test_it_falls_onto_its_toes(name):
    robot = load(name)
    mujoco, model, data, _, _ = compiled(robot)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_forward(model, data)
    touching = {model.geom(geom).name for contact in data.contact for geom in contact.geom}
    assert touching == {"ground", *robot.toes}
    mujoco.mj_step(model, data, nstep=20)
    up = data.site(robot.toes[0]).xpos[2]
    assert abs(up) < 2e-3


TRUNK = """<robot name="trunk">
  <link name="base"><inertial><origin xyz="0.2 -0.1 0.05"/><mass value="2"/>
    <inertia ixx="0.01" iyy="0.02" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><mesh filename="base.stl" scale="0.001 -0.001 0.001"/></geometry></visual></link>
  <link name="arm"><inertial><origin xyz="0 0 0.1"/><mass value="0.1"/>
    <inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0 0 0.1"/>
      <geometry><mesh filename="base.stl" scale="0.0001 0.0001 0.0001"/></geometry></visual>
  </link>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
</robot>"""
HALF = np.array([0.2, 0.1, 0.05])  # m: of the mesh, a box whose lower corner is at the link's origin but for y


def test_meshes_load_from_the_folder_and_the_trunk_rests_on_the_floor(capsys, tmp_path, monkeypatch):
    """By their paths beside the file, whoever loads it from where; in a mirror and in another scale, in mm."""
    import mujoco

    box = trimesh.creation.box(2e3 * HALF)
    box.apply_translation(1e3 * HALF)
    box.export(tmp_path / "base.stl")
    (tmp_path / "trunk.urdf").write_text(TRUNK, encoding="utf-8")
    out = tmp_path / "out"
    out.mkdir()
    options = ("--base", "free", "--motors", "turn", "--out", out)
    found = printed(capsys, "export", tmp_path / "trunk.urdf", "--mjcf", *options)
    assert found["meshes"] == [str(out / "trunk_meshes" / f"0{i}.stl") for i in range(2)]
    moved = out.rename(tmp_path / "elsewhere")
    monkeypatch.chdir("/")
    model = mujoco.MjModel.from_xml_path(str(moved / "trunk.xml"))
    assert model.nmesh == 2
    data = mujoco.MjData(model)
    data.qpos[2] = 0.4
    mujoco.mj_step(model, data, nstep=3000)
    bodies = {model.body(model.geom_bodyid[geom]).name for contact in data.contact for geom in contact.geom}
    assert bodies == {"world", "base"} and np.abs(data.qvel[:3]).max() < 1e-3
    # the mesh begins at the link's origin, to the right of it, being in a mirror
    assert data.qpos[2] == pytest.approx(0.0, abs=2e-3)
    solid = next(i for i in range(model.ngeom) if model.geom_conaffinity[i] and model.geom_bodyid[i])
    start = mujoco.MjData(model)
    mujoco.mj_forward(model, start)
    np.testing.assert_allclose(start.geom_xpos[solid] - start.xpos[1], HALF * [1, -1, 1], rtol=0, atol=1e-6)


def test_what_has_no_toes_is_said(capsys, tmp_path):
    (tmp_path / "trunk.urdf").write_text(TRUNK, encoding="utf-8")
    words = (tmp_path / "trunk.urdf", "--mjcf", "--base", "free", "--motors", "turn", "--out", tmp_path)
    status, out, _ = run(capsys, "export", *words)
    assert status == 0 and "not drawn: mesh 'base.stl' of 'base' (no such file)" in out and "--toes names" in out


@pytest.mark.parametrize("name", ["q_spear", "q_spear_full"])
def test_the_trunk_of_a_robot_that_folds_rests_on_the_floor(name):
    robot = load(name)
    mujoco, model, data, _, _ = compiled(robot)
    mujoco.mj_resetDataKeyframe(model, data, model.key("home").id)
    mujoco.mj_step(model, data, nstep=3000)
    touching = {model.body(model.geom_bodyid[geom]).name for contact in data.contact for geom in contact.geom}
    height = data.xpos[model.body("torso").id][2]
    assert "torso" in touching and 0.05 < height < 0.12
