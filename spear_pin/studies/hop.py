"""What one asks of a hop: height, force, energy per cycle, and how much of the push the spring does."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.integrate import trapezoid

from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.trajectory import Trajectory


def summarize(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Figures of a hopping gait, from the gait and a trajectory of it, SI units and radians.

    Returns:
        stance_torque, flight_time, stance_time, period, residual, multipliers, stable; from the
        first cycle apex_height (hip above ground), peak_force (vertical), peak_compression of the
        spring, spring_share (see there), energy by flow; energy_residual is the largest of all cycles.
    """
    law = gait.system.law
    first = trajectory.cycle == 1
    apex = next(event for event in trajectory.named("apex") if event.time >= trajectory.t[first][0])
    knee = trajectory.coordinates.index("knee")
    touchdown = trajectory.q[first, knee][0]
    return {
        "stance_torque": law.stance_torque,
        "hip_touchdown": 0.5 * law.knee_touchdown if law.hip_touchdown is None else law.hip_touchdown,
        "knee_touchdown": law.knee_touchdown,
        "frequency": law.frequency,
        "stiffness": gait.system.spring.stiffness,
        "friction": gait.system.contact.friction,
        "flight_time": gait.durations["flight"],
        "stance_time": gait.durations["stance"],
        "period": gait.period,
        "residual": gait.residual,
        "multipliers": gait.multipliers,
        "stable": gait.stable,
        "apex_height": float(apex.q[trajectory.coordinates.index("boom_z")]),
        "peak_force": float(trajectory.force[first, 0, 1].max()),
        "peak_knee_rate": float(np.abs(trajectory.v[first, knee]).max()),
        "peak_compression": float(trajectory.q[first & (trajectory.phase == "stance"), knee].max() - touchdown),
        "spring_share": spring_share(trajectory),
        "energy": {name: float(trajectory.ledger[name][0]) for name in trajectory.ledger.flows},
        "energy_residual": float(np.abs(trajectory.ledger.residual).max()),
        "cycles": trajectory.cycles,
        "reason": trajectory.reason,
    }


def spring_share(trajectory: Trajectory) -> float:
    """Spring work over spring plus motor work at the knee, while the knee extends in the first stance.

    It is 0 where neither does any: the knee never extends, or it extends without torque.
    """
    knee = trajectory.coordinates.index("knee")
    motor = trajectory.u[:, trajectory.actuated.index("knee")]
    rate = trajectory.v[:, knee]
    stance = (trajectory.cycle == 1) & (trajectory.phase == "stance")

    def work(torque: NDArray[np.float64]) -> float:
        power = np.where(rate < 0.0, torque * rate, 0.0)
        return float(trapezoid(power[stance], trajectory.t[stance]))

    spring = work(trajectory.spring[:, trajectory.spring_joints.index("knee")])
    total = spring + work(motor)
    return spring / total if total != 0.0 else 0.0
