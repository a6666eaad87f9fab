"""Trajectories of the hop taken apart: their stances, and what the symbolic Lagrangian gives at their samples."""

import numpy as np

from tests.lagrangian import monopod

# source: the spring with motor
STIFFNESS, SPRING_DAMPING = 48.84, 1.3


def terms_of(trajectory):
    """What the symbolic Lagrangian gives at every sample."""
    lagrangian = monopod(trajectory.coordinates)
    return [lagrangian.terms(q, v) for q, v in zip(trajectory.q, trajectory.v, strict=True)]


def stretches(trajectory):
    """Slices of the samples of each stance and each flight."""
    changes = np.flatnonzero(trajectory.phase[1:] != trajectory.phase[:-1]) + 1
    bounds = [0, *changes, len(trajectory.t)]
    return [slice(a, b) for a, b in zip(bounds[:-1], bounds[1:], strict=True)]


def stances(trajectory):
    return [part for part in stretches(trajectory) if trajectory.phase[part][0] == "stance"]


def balance(trajectory, terms):
    """What is left of the equations of motion at every sample, relative to their largest term."""
    rows = [trajectory.coordinates.index(joint) for joint in trajectory.actuated]
    left = []
    for i, at in enumerate(terms):
        parts = [at.mass_matrix @ trajectory.a[i], at.coriolis, at.gravity, -trajectory.friction[i]]
        applied = np.zeros(len(trajectory.coordinates))
        applied[rows] = trajectory.tau[i]
        parts += [-applied, -at.jacobians["toe"].T @ trajectory.force[i, 0]]
        left.append(np.abs(sum(parts)).max() / np.abs(parts).max())
    return np.array(left)
