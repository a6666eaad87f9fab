"""The shipped URDFs in other programs: MuJoCo and Drake for the dynamics, yourdfpy for the kinematics."""

import logging

import numpy as np
import pinocchio as pin
import pytest

from spear_pin.model.loading import ROBOTS, load

STATES = 50

each_robot = pytest.mark.parametrize("name", ROBOTS)


def random_states(robot):
    rng = np.random.default_rng(7)
    states = [(rng.uniform(-2, 2, robot.nv), rng.uniform(-5, 5, robot.nv)) for _ in range(STATES)]
    return [(pin.integrate(robot.model, pin.neutral(robot.model), away), v) for away, v in states]


def joints(robot):
    """Name of each joint, and whether it is the floating one."""
    return [(name, joint.nv == 6) for name, joint in zip(robot.model.names, robot.model.joints, strict=True)][1:]


def in_world_axes(robot, q, v, count):
    """T and the rate of T v at v̇ = 0, where T v has the first numbers of a floating joint's v in world axes.

    Pinocchio has all six, velocity and angular velocity, in the axes of the link.
    """
    change, rate = np.eye(robot.nv), np.zeros(robot.nv)
    if robot.nq > robot.nv:
        rotation = pin.XYZQUATToSE3(q[:7]).rotation
        change[:count, :count] = np.kron(np.eye(count // 3), rotation)
        rate[:3] = rotation @ np.cross(v[3:6], v[:3])
    return change, rate


def assert_close(actual, expected):
    np.testing.assert_allclose(actual, expected, rtol=0, atol=1e-9)


@pytest.mark.extra("mujoco")
@each_robot
class TestMuJoCo:
    @staticmethod
    def build(mujoco, robot, name):
        """The model, its data, and the entries of its vectors that each number of q and of v is."""
        spec = mujoco.MjSpec.from_file(str(ROBOTS[name].path))
        # the carriages and toes are massless, which MuJoCo refuses
        spec.compiler.fusestatic = False
        spec.compiler.boundmass = spec.compiler.boundinertia = 1e-14
        for joint in spec.joints:
            if joint.name in robot.coordinates:
                joint.armature = robot.model.armature[robot.index(joint.name)]
        model = spec.compile()
        positions, velocities = [], []
        for name, floating in joints(robot):
            joint = model.joint(name)
            positions += [joint.qposadr[0] + i for i in ((0, 1, 2, 4, 5, 6, 3) if floating else (0,))]
            velocities += [joint.dofadr[0] + i for i in range(6 if floating else 1)]
        return model, mujoco.MjData(model), positions, velocities

    def test_mass_matrix_and_bias(self, name):
        import mujoco

        robot = load(name)
        model, data, positions, velocities = self.build(mujoco, robot, name)
        assert sorted(positions) == list(range(model.nq)) and sorted(velocities) == list(range(model.nv))
        mass_matrix = np.zeros((model.nv, model.nv))
        for q, v in random_states(robot):
            change, rate = in_world_axes(robot, q, v, 3)
            data.qpos[positions], data.qvel[velocities] = q, change @ v
            mujoco.mj_forward(model, data)
            for column, unit in zip(mass_matrix, np.eye(model.nv), strict=True):
                mujoco.mj_mulM(model, data, column, unit)
            there = mass_matrix[np.ix_(velocities, velocities)]
            assert_close(robot.mass_matrix(q), change.T @ there @ change)
            assert_close(robot.bias(q, v), change.T @ (data.qfrc_bias[velocities] + there @ rate))


@pytest.mark.extra("pydrake")
@each_robot
class TestDrake:
    @staticmethod
    def build(name):
        """The plant; it reads gear ratio and rotor inertia from the drake tags by itself."""
        from pydrake.multibody import parsing
        from pydrake.multibody import plant as plants

        # it warns that it ignores <mechanicalReduction>
        logging.getLogger("drake").setLevel(logging.ERROR)
        plant = plants.MultibodyPlant(0.0)
        parsing.Parser(plant).AddModels(str(ROBOTS[name].path))
        plant.Finalize()
        return plant

    @staticmethod
    def order(plant, robot):
        """The entries of Drake's vectors that each number of q and of v is."""
        positions, velocities = [], []
        for name, floating in joints(robot):
            joint = plant.GetJointByName("torso" if floating else name)  # it calls a floating joint as its link
            positions += [joint.position_start() + i for i in ((4, 5, 6, 1, 2, 3, 0) if floating else (0,))]
            velocities += [joint.velocity_start() + i for i in ((3, 4, 5, 0, 1, 2) if floating else (0,))]
        return positions, velocities

    def test_mass_matrix_and_bias(self, name):
        plant, robot = self.build(name), load(name)
        assert plant.num_velocities() == robot.nv
        context = plant.CreateDefaultContext()
        positions, velocities = self.order(plant, robot)
        for q, v in random_states(robot):
            change, rate = in_world_axes(robot, q, v, 6)
            there_q, there_v = np.empty(robot.nq), np.empty(robot.nv)
            there_q[positions], there_v[velocities] = q, change @ v
            plant.SetPositions(context, there_q)
            plant.SetVelocities(context, there_v)
            there = plant.CalcMassMatrix(context)[np.ix_(velocities, velocities)]
            assert_close(robot.mass_matrix(q), change.T @ there @ change)
            bias = plant.CalcBiasTerm(context) - plant.CalcGravityGeneralizedForces(context)
            assert_close(robot.bias(q, v), change.T @ (bias[velocities] + there @ rate))


def read(name, **options):
    """By yourdfpy, which is slow to import."""
    import yourdfpy

    return yourdfpy.URDF.load(str(ROBOTS[name].path), **options)


@each_robot
class TestYourdfpy:
    def test_valid(self, name):
        urdf = read(name)
        assert urdf.validate(), urdf.errors

    def test_toe_positions(self, name):
        robot = load(name)
        urdf = read(name, load_meshes=False)
        for q, _ in random_states(robot):
            turning = [joint for joint, floating in joints(robot) if not floating]
            urdf.update_cfg(dict(zip(turning, q[-len(turning) :], strict=True)))
            # it leaves a floating joint, the first, at zero
            base = np.eye(4) if robot.nq == robot.nv else pin.XYZQUATToSE3(q[:7]).homogeneous
            for toe in robot.toes:
                position = (base @ urdf.get_transform(toe))[:3, 3]
                assert_close(robot.frame_position(q, toe), position[[0, 2]] if robot.planar else position)
