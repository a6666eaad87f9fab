"""Figures of a hop: height, force, energy per cycle, and the spring's share of the push."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.errors import UnknownName
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.curves import Curves
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.reaching import angles
from spear_pin.hybrid.rules.cycles import RETOUCH
from spear_pin.hybrid.rules.surface import CHATTER
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.kinds import typed
from spear_pin.model.springs import describe_spring


@typed
def summarize(gait: Gait, trajectory: Trajectory) -> dict[str, Any]:
    """Returns figures of a hopping gait, from the gait and a trajectory of it, in SI units and radians.

    Returns:
        stance_torque, flight_time, stance_time, period, residual, multipliers, stable, as of the gait; from the
        first cycle apex_height (of the hip, above zero), peak_force (normal), peak_torque and peak_speed by
        joint, friction_used, work, positive_work, effort (see `spear_pin.gaits.measures.catalogue`),
        peak_compression of the spring, spring_share (see there), energy by flow, all measures by name; of all of them
        energy_residual, the largest, and retouches, how often the toe left the ground too briefly for a flight.
        Without an apex, or a whole cycle, what needs one is None, and energy is empty. So is the spring's share where
        no motor drives the knee alone, as of a leg with closed loops.

    Raises:
        UnknownName: the robot has neither a joint "knee" nor `[reach]`.
    """
    robot = gait.system.robot
    if "knee" not in trajectory.coordinates and robot.reach is None:
        raise UnknownName("joint", "knee", trajectory.coordinates)
    law, ledger, whole = gait.system.law, trajectory.ledger, trajectory.cycles > 0
    first = trajectory.cycle == 1
    apexes = [event.q for event in trajectory.named("apex") if event.time >= trajectory.t[first][0]]
    height = trajectory.coordinates.index("boom_z")
    _, knee = angles(robot, [*trajectory.q.T])
    sampled = Sampled(robot, trajectory)
    stance = sampled.curves.among(trajectory.phase == "stance")
    return {
        "stance_torque": law.stance_torque,
        "hip_touchdown": law.hip_commanded,
        "knee_touchdown": law.knee_touchdown,
        "frequency": law.frequency,
        "stiffness": gait.system.spring.stiffness,
        "springs": {name: describe_spring(name, spring) for name, spring in gait.system.springs.items()},
        "friction": gait.system.contact.friction,
        "slope": gait.system.ground.slope,
        "flight_time": gait.durations["flight"],
        "stance_time": gait.durations["stance"],
        "period": gait.period,
        "residual": gait.residual,
        "multipliers": gait.multipliers,
        "stable": gait.stable,
        "apex_height": float(apexes[0][height]) if apexes else None,
        **{name: sampled.largest(name) for name in ("peak_force", "friction_used")},
        **{name: sampled.of(name) for name in ("peak_torque", "peak_speed")},
        **{name: sampled.largest(name) for name in ("work", "positive_work", "effort")},
        "peak_compression": stance.peak(knee) - knee[first][0],
        "spring_share": spring_share(trajectory) if "knee" in trajectory.actuated else None,
        "energy_flows": {name: float(ledger[name][0]) for name in ledger.flows} if whole else {},
        "energy_residual": float(np.abs(ledger.residual).max()) if whole else None,
        "measures": sampled.values() if whole else {},
        "cycles": trajectory.cycles,
        "retouches": sum(event.domain != CHATTER for event in trajectory.named(RETOUCH)),
        "reason": trajectory.reason,
    }


@typed
def spring_share(trajectory: Trajectory) -> float:
    """Returns spring work over spring plus motor work at the knee, while the knee extends in the first stance.

    It is 0 where neither does work: the knee never extends, or it extends without torque.
    """
    rate = trajectory.v[:, trajectory.coordinates.index("knee")]
    motor = trajectory.u[:, trajectory.actuated.index("knee")]
    stance = Curves(trajectory.t, (trajectory.cycle == 1) & (trajectory.phase == "stance"))

    def work(torque: NDArray[np.float64]) -> float:
        return stance.integral(torque * rate, where=-rate)

    sprung = "knee" in trajectory.spring_joints
    spring = work(trajectory.spring[:, trajectory.spring_joints.index("knee")]) if sprung else 0.0
    total = spring + work(motor)
    return spring / total if total != 0.0 else 0.0


def durations(trajectory: Trajectory) -> NDArray[np.float64]:
    """Returns stance and flight of each whole hop, in s, (hops, 2); the flight follows the hop's last lift-off."""
    left = np.array([event.time for event in trajectory.named("lift_off")])
    bounds = [trajectory.t[trajectory.cycle == n][[0, -1]] for n in range(1, trajectory.cycles + 1)]
    parts = [(left[left < end].max() - begin, end - left[left < end].max()) for begin, end in bounds]
    return np.array(parts).reshape(-1, 2)
