"""Figures of a bound in space: load of the adduction compared with the knee, friction, and drift."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.arrays import Array
from spear_pin.gaits.feedback import Regulated
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.spatial.legs import pairs_of
from spear_pin.hybrid.symmetry import ROLL, YAW, X, Y
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed

PARTS = ("adduction", "hip", "knee")


@typed
def summarize_in_space(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Returns figures of a bounding gait in space, from the gait and a trajectory of it, in SI units and radians.

    The course is the first heading; if the halves of a stride are mirror images, it is halfway between those of both.

    Returns:
        - residual, multipliers: see `Gait`.
        - cycles, reason, energy_residual: whole strides, why it ended, and the largest imbalance of a stride, in J.
        - speed, period: along its course at the begin, in m/s; of whole strides, in s.
        - aside, heading: where it is at the end across that course, in m, and how its heading has changed.
        - largest_roll: on the way.
        - slips: how often a foot begins to slide.
        - friction_used: largest ratio of tangential to normal force, where a foot carries 2 % of its even share.
        - friction_used_across: the same for the force across the heading.
        - measures: means and peaks of whole cycles, all of `spear_pin.gaits.measures.catalogue` by name.
        - joints: of the largest of all legs' "adduction", "hip" and "knee" range, speed, torque and power.
    """
    robot = gait.system.robot
    legs = [leg for pair in pairs_of(robot) for leg in pair]
    q, t = trajectory.q, trajectory.t
    whole = t[(trajectory.cycle > 0) & (trajectory.cycle <= trajectory.cycles)]
    sampled, halves = Sampled(robot, trajectory, ()), bool(gait.system.mirrored_toes)
    second = q[trajectory.cycle > 1][:1] if halves else q[:0]
    course = float(np.mean([q[0, YAW], *second[:, YAW]]))
    ahead, aside = _turned(q[-1, [X, Y]] - q[0, [X, Y]], course)
    curves, joints = sampled.curves, {}
    for i, part in enumerate(PARTS):
        names = [robot.actuated[leg.motors[i]] for leg in legs]
        joints[part] = {
            "range": max(float(np.diff(curves.range(sampled.angles[name]))[0]) for name in names),
            "speed": max(curves.amount(sampled.speeds[name]) for name in names),
            "torque": max(curves.amount(sampled.torques[name]) for name in names),
            "power": max(curves.amount(sampled.torques[name] * sampled.speeds[name]) for name in names),
        }
    across = np.stack([_turned(force[:, :2].T, yaw)[1] for force, yaw in zip(trajectory.force, q[:, YAW], strict=True)])
    normal, toes = trajectory.force[:, :, 2], range(len(trajectory.toes))
    cycles = range(1, trajectory.cycles + 1)
    measures = Sampled(robot, trajectory, cycles, halves).values() if trajectory.cycles else {}
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
        "largest_roll": curves.amount(q[:, ROLL]),
        "slips": len(trajectory.named("slip")),
        "friction_used": sampled.largest("friction_used"),
        "friction_used_across": max(curves.ratio(across[:, i], normal[:, i], sampled.pressed) for i in toes),
        "joints": joints,
        "measures": measures,
    }


def multipliers_of(gait: Gait, found: Regulated | None) -> dict[str, Any]:
    """Lists all multipliers of a section, for the gait that is played and for the one without its feedback.

    Args:
        gait: the gait that is played.
        found: how its feedback was found; None for a saved gait, for which only its own multipliers are known.

    Returns:
        - multipliers, multipliers_without_feedback: all of them, by decreasing modulus; None where they are not known.
        - kinds, kinds_without_feedback: of each "along" or "lateral", None where the gait does not tell these apart.
        - stable, stable_without_feedback: whether the largest is below 1.
    """
    if found is None:
        known = {"multipliers": gait.multipliers.tolist(), "kinds": [None] * len(gait.multipliers)}
        unknown = dict.fromkeys(f"{name}_without_feedback" for name in ("multipliers", "kinds", "stable"))
        return {**known, "stable": gait.stable, **unknown}
    said: dict[str, Any] = {}
    for each, of in ((found.held, ""), (found.without, "_without_feedback")):
        said[f"multipliers{of}"], said[f"kinds{of}"] = each.values.tolist(), list(each.kinds)
        said[f"stable{of}"] = bool(abs(each.values[0]) < 1.0)
    return said


def _turned(vector: Array, yaw: float) -> tuple[Any, Any]:
    """Returns the parts of vectors (x, y) along a heading and across it."""
    c, s = np.cos(yaw), np.sin(yaw)
    return c * vector[0] + s * vector[1], c * vector[1] - s * vector[0]
