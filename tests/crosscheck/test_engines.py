"""The shipped URDFs in other programs: MuJoCo and Drake for the dynamics, yourdfpy for the kinematics."""

import logging

import numpy as np
import pytest
import yourdfpy

from spear_pin.model.loading import ROBOTS, load

STATES = 50

each_robot = pytest.mark.parametrize("name", ROBOTS)


def random_states(robot):
    rng = np.random.default_rng(7)
    return [(rng.uniform(-2, 2, robot.nq), rng.uniform(-5, 5, robot.nv)) for _ in range(STATES)]


def assert_close(actual, expected):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-9)


@each_robot
class TestMuJoCo:
    @staticmethod
    def build(mujoco, robot, name):
        """The model, its data, and the coordinate of the robot that each of its joints is."""
        spec = mujoco.MjSpec.from_file(str(ROBOTS[name].path))
        # the carriages and toes are massless, which MuJoCo refuses
        spec.compiler.fusestatic = False
        spec.compiler.boundmass = spec.compiler.boundinertia = 1e-14
        for joint in spec.joints:
            joint.armature = robot.model.armature[robot.index(joint.name)]
        model = spec.compile()
        return model, mujoco.MjData(model), [robot.index(model.joint(i).name) for i in range(model.njnt)]

    def test_mass_matrix_and_bias(self, name):
        mujoco = pytest.importorskip("mujoco")
        robot = load(name)
        model, data, order = self.build(mujoco, robot, name)
        assert sorted(order) == list(range(robot.nv))
        column = np.zeros(model.nv)
        for q, v in random_states(robot):
            data.qpos[:], data.qvel[:] = q[order], v[order]
            mujoco.mj_forward(model, data)
            mass_matrix = robot.mass_matrix(q)
            for i, unit in enumerate(np.eye(model.nv)):
                mujoco.mj_mulM(model, data, column, unit)
                assert_close(mass_matrix[order, order[i]], column)
            assert_close(robot.bias(q, v)[order], data.qfrc_bias)


@each_robot
class TestDrake:
    @staticmethod
    def build(name):
        """The plant; it reads gear ratio and rotor inertia from the drake tags by itself."""
        plants = pytest.importorskip("pydrake.multibody.plant")
        parsing = pytest.importorskip("pydrake.multibody.parsing")
        # it warns that it ignores <mechanicalReduction>
        logging.getLogger("drake").setLevel(logging.ERROR)
        plant = plants.MultibodyPlant(0.0)
        parsing.Parser(plant).AddModels(str(ROBOTS[name].path))
        plant.Finalize()
        return plant

    def test_mass_matrix_and_bias(self, name):
        plant, robot = self.build(name), load(name)
        assert plant.num_velocities() == robot.nv
        context = plant.CreateDefaultContext()
        # entry of Drake's vectors that is each coordinate of the robot
        order = [plant.GetJointByName(joint).velocity_start() for joint in robot.coordinates]
        for q, v in random_states(robot):
            positions, velocities = np.empty(robot.nq), np.empty(robot.nv)
            positions[order], velocities[order] = q, v
            plant.SetPositions(context, positions)
            plant.SetVelocities(context, velocities)
            assert_close(robot.mass_matrix(q), plant.CalcMassMatrix(context)[np.ix_(order, order)])
            bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
            assert_close(robot.bias(q, v), bias[order])


@each_robot
class TestYourdfpy:
    def test_valid(self, name):
        urdf = yourdfpy.URDF.load(str(ROBOTS[name].path))
        assert urdf.validate(), urdf.errors

    def test_toe_positions(self, name):
        robot = load(name)
        urdf = yourdfpy.URDF.load(str(ROBOTS[name].path), load_meshes=False)
        for q, _ in random_states(robot):
            urdf.update_cfg(dict(zip(robot.coordinates, q, strict=True)))
            for toe in robot.toes:
                assert_close(robot.toe_position(q, toe), urdf.get_transform(toe)[[0, 2], 3])
