"""Figures of a hop round a post: distance and height, forces, torques, and the friction that it needs."""

from __future__ import annotations

from typing import Any

import numpy as np

from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.round_hopping import HIP, YAW, limb_of
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed


@typed
def summarize_round(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Returns figures of a gait round a post, from the gait and a trajectory that begins with it, in SI units.

    Returns:
        - flight_time, stance_time, period, residual, multipliers, stable: see `Gait`.
        - turn, speed: a hop about the post, to the left, and of the leg's plane along its circle.
        - apex_height: of the hip; None where it has no apex.
        - sway: by which the toe moves towards the post and from it in the first stance.
        - peak_force: normal.
        - peak_torque: of hip and knee, by joint.
        - friction_used: largest ratio of tangential to normal force, where the toe carries 2 % of the weight.
        - friction_at_impact: the largest such ratio of a touchdown's impulses.
        - slips: how often the toe begins to slide along its circle.
        - energy, energy_residual: of the first hop by flow, in J, and the largest imbalance of a hop.
        - measures: of the first hop, all of `spear_pin.gaits.measures.catalogue` by name.
        - cycles, reason: whole hops, and why it ended.
    """
    robot, ledger = gait.system.robot, trajectory.ledger
    sampled = Sampled(robot, trajectory)
    touches, apexes = trajectory.named("touchdown"), trajectory.named("apex")
    stance = trajectory.q[(trajectory.phase == "stance") & (trajectory.cycle == 1)]
    post = np.array(robot.post or (0.0, 0.0))
    distances = [np.hypot(*(robot.toe_position(q, robot.toes[0])[:2] - post)) for q in stance]
    impulses = np.array([touch.impulse[0] for touch in touches]).reshape(-1, 2)
    yaw = trajectory.q[trajectory.cycle == 1, robot.index(YAW)]
    turn = float(yaw[-1] - yaw[0])
    return {
        "flight_time": gait.durations["flight"],
        "stance_time": gait.durations["stance"],
        "period": gait.period,
        "turn": turn,
        "speed": limb_of(robot).reach * turn / gait.period,
        "apex_height": float(robot.frame_position(apexes[0].q, HIP)[2]) if apexes else None,
        "sway": float(np.ptp(distances)) if distances else 0.0,
        "peak_force": sampled.largest("peak_force"),
        "peak_torque": sampled.of("peak_torque"),
        "friction_used": sampled.largest("friction_used"),
        "friction_at_impact": float((np.abs(impulses[:, 0]) / impulses[:, 1]).max(initial=0.0)),
        "slips": len(trajectory.named("slip")),
        "multipliers": gait.multipliers,
        "stable": gait.stable,
        "residual": gait.residual,
        "energy_flows": {name: float(ledger[name][0]) for name in ledger.flows} if trajectory.cycles else {},
        "energy_residual": float(np.abs(ledger.residual).max()) if trajectory.cycles else None,
        "measures": sampled.values() if trajectory.cycles else {},
        "cycles": trajectory.cycles,
        "reason": trajectory.reason,
    }
