"""Poses of every joint over the frames of a motion, as stacked matrices."""

from __future__ import annotations

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array


def local_poses(model: pin.Model, q: Array) -> Array:
    """Returns the pose of each joint in its parent joint, (frames, joints, 4, 4), with the world at index 0."""
    data = pin.Data(model)
    poses = np.tile(np.eye(4), (len(q), model.njoints, 1, 1))
    for frame, configuration in enumerate(q):
        pin.forwardKinematics(model, data, configuration)
        for joint in range(1, model.njoints):
            poses[frame, joint] = data.liMi[joint].homogeneous
    return poses


def world_poses(model: pin.Model, local: Array) -> Array:
    """Returns the pose of each joint in the world, (frames, joints, 4, 4), from the poses in their parents."""
    poses = local.copy()
    for joint in range(1, model.njoints):
        poses[:, joint] = poses[:, model.parents[joint]] @ local[:, joint]
    return poses


def center_of_mass(model: pin.Model, world: Array) -> Array:
    """Returns the centre of mass in the world, (frames, 3), in m."""
    masses = np.array([inertia.mass for inertia in model.inertias])
    levers = np.array([np.append(inertia.lever, 1.0) for inertia in model.inertias])
    masses[0] = 0.0
    positions = np.einsum("fjab,jb->fja", world, levers)[:, :, :3]
    return np.asarray(np.einsum("fja,j->fa", positions, masses) / max(masses.sum(), 1e-12))


def quaternions(rotations: Array) -> Array:
    """Returns rotation matrices, (frames, 3, 3), as quaternions x, y, z, w, (frames, 4)."""
    return np.array([pin.Quaternion(rotation).coeffs() for rotation in rotations])
