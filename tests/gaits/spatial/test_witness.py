"""Motion in space by other means: Pinocchio's own constrained dynamics, and MuJoCo's with our forces on its toes."""

from functools import cache

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import simulate
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.periodic import chart
from tests.gaits.orbits.test_embedding import spatial


@cache
def motion():
    """A stride that is not symmetric, with feet that slip."""
    system, state = spatial("long_stride")
    moved = chart(system, state).state(2e-2 * np.random.default_rng(5).normal(size=32))
    return system.robot, simulate(with_parameters(system, {"friction": 0.45}), moved)


def applied(robot, trajectory, row):
    """Generalised forces of motors, springs and friction."""
    tau = trajectory.friction[row].copy()
    tau[[robot.index(joint) for joint in robot.actuated]] += trajectory.tau[row]
    return tau


@pytest.mark.slow
def test_constrained_dynamics_of_pinocchio():
    robot, trajectory = motion()
    model, checked = robot.model, 0
    for row in range(0, len(trajectory.t), 7):
        closed = [i for i, force in enumerate(trajectory.force[row]) if force[2] > 1.0]
        if not closed or "slip" in trajectory.domain[row]:
            continue
        contacts = pin.StdVec_RigidConstraintModel()
        for i in closed:
            frame = model.frames[robot.toe_id(robot.toes[i])]
            contacts.append(
                pin.RigidConstraintModel(
                    pin.ContactType.CONTACT_3D, model, frame.parentJoint, frame.placement, pin.LOCAL_WORLD_ALIGNED
                )
            )
        datas = pin.StdVec_RigidConstraintData()
        datas.extend(contact.createData() for contact in contacts)
        data = pin.Data(model)
        pin.initConstraintDynamics(model, data, contacts, datas)
        q, v = trajectory.q[row], trajectory.v[row]
        settings = pin.ProximalSettings(1e-14, 1e-14, 20)
        a = pin.constraintDynamics(model, data, q, v, applied(robot, trajectory, row), contacts, datas, settings)
        np.testing.assert_allclose(a, trajectory.a[row], rtol=0, atol=1e-10 * abs(trajectory.a[row]).max() + 1e-9)
        checked += 1
    assert checked > 20


@pytest.mark.extra("mujoco")
def test_accelerations_of_mujoco():
    from tests.crosscheck.test_exports import compiled

    robot, trajectory = motion()
    mujoco, model, data, positions, velocities = compiled(robot)
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONTACT
    for row in range(len(trajectory.t)):
        data.qpos[positions], data.qvel[velocities] = trajectory.q[row], trajectory.v[row]
        forces = sum(
            robot.toe_jacobian(trajectory.q[row], toe).T @ trajectory.force[row, i] for i, toe in enumerate(robot.toes)
        )
        data.qfrc_applied[velocities] = applied(robot, trajectory, row) + forces
        mujoco.mj_forward(model, data)
        scale = abs(trajectory.a[row]).max()
        np.testing.assert_allclose(data.qacc[velocities], trajectory.a[row], rtol=0, atol=1e-8 * scale)
    assert len(trajectory.t) > 300
