"""Figures of a bound in space: what the adduction does beside the knee, friction, and how far it strays."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.spatial.legs import pairs_of
from spear_pin.hybrid.symmetry import ROLL, YAW, X, Y
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.scale import scale_in_space

PARTS = ("adduction", "hip", "knee")
LOADED = 20.0  # N of Q-SPEAR: below, the ratio of two forces means little


@typed
def summarize_in_space(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Figures of a bounding gait in space, from the gait and a trajectory of it, SI units and radians.

    Returns:
        - residual, multipliers: as of `Gait`.
        - cycles, reason, energy_residual: whole strides, why it ended, and the largest imbalance of a stride, in J.
        - speed, period: along the heading at the begin, in m/s; of whole strides, in s.
        - aside, heading: where it is at the end across its first heading, in m, and its heading then.
        - largest_roll: on the way.
        - slips: how often a foot begins to slide.
        - friction_used: largest ratio of tangential to normal force, where that is over 20 N of Q-SPEAR.
        - friction_used_across: the same of what is across the heading.
        - joints: of the largest of all legs' "adduction", "hip" and "knee" range, speed, torque and power.
    """
    robot = gait.system.robot
    legs = [leg for pair in pairs_of(robot) for leg in pair]
    q, v, t = trajectory.q, trajectory.v, trajectory.t
    whole = t[(trajectory.cycle > 0) & (trajectory.cycle <= trajectory.cycles)]
    ahead, aside = _turned(q[-1, [X, Y]] - q[0, [X, Y]], q[0, YAW])
    joints = {}
    for i, part in enumerate(PARTS):
        rows, columns = [(leg.adduction, leg.hip, leg.knee)[i] for leg in legs], [leg.motors[i] for leg in legs]
        joints[part] = {
            "range": float(np.ptp(q[:, rows], axis=0).max()),
            "speed": float(np.abs(v[:, rows]).max()),
            "torque": float(np.abs(trajectory.u[:, columns]).max()),
            "power": float(np.abs(trajectory.u[:, columns] * v[:, rows]).max()),
        }
    across = np.stack([_turned(force[:, :2].T, yaw)[1] for force, yaw in zip(trajectory.force, q[:, YAW], strict=True)])
    along = np.linalg.norm(trajectory.force[:, :, :2], axis=2)
    normal = trajectory.force[:, :, 2]
    loaded = normal > LOADED * scale_in_space(robot).force
    return {
        "residual": gait.residual,
        "multipliers": gait.multipliers.tolist(),
        "cycles": trajectory.cycles,
        "reason": trajectory.reason,
        "energy_residual": float(np.abs(trajectory.ledger.residual).max(initial=0.0)),
        "speed": float(ahead) / float(t[-1] - t[0]),
        "period": float(np.ptp(whole)) / trajectory.cycles if trajectory.cycles else 0.0,
        "aside": float(aside),
        "heading": float(q[-1, YAW] - q[0, YAW]),
        "largest_roll": float(np.abs(q[:, ROLL]).max()),
        "slips": sum(event.name == "slip" for event in trajectory.events),
        "friction_used": float((along[loaded] / normal[loaded]).max(initial=0.0)),
        "friction_used_across": float((np.abs(across)[loaded] / normal[loaded]).max(initial=0.0)),
        "joints": joints,
    }


def _turned(vector: Array, yaw: float) -> tuple[Any, Any]:
    """Parts of vectors (x, y) along a heading and across it."""
    c, s = np.cos(yaw), np.sin(yaw)
    return c * vector[0] + s * vector[1], c * vector[1] - s * vector[0]
