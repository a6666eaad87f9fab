"""Numbers of the bounding gaits for statements; torques are those of one motor, posterior leg first.

An argument for a gait is the name of one in `runs.GAITS`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.bounding_law import LEGS, PAIR
from spear_pin.gaits.measures.curves import Curves
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.catalogue import motor
from spear_pin.studies.audit import zero_dynamics
from spear_pin.studies.audit.printed_designs import Q_SPEAR
from spear_pin.studies.audit.runs import (
    GAITS,
    SHOWN,
    bound,
    hip_drive,
    hips,
    knee_drive,
    knee_points,
    one_hop,
    stride,
    stride_run,
)
from spear_pin.studies.bound import mean_speed
from spear_pin.studies.design import Points, against

OWN_SPRING = Q_SPEAR.stiffness  # N·m/rad
BEARING = 20.0  # N: below, the ratio of two forces means little


def speed() -> float:
    """Returns the mean forward speed, in m/s."""
    return mean_speed(bound())


def fixed_point_residual(gait: str = SHOWN) -> float:
    """Returns ‖P(x) - x‖ of the bound, torso_x left out, SI units, for the stride that is simulated here."""
    run = stride_run(gait)
    (q0, v0), (q1, v1) = run.start, run.state
    return float(np.linalg.norm(np.concatenate([(q1 - q0)[1:], v1 - v0])))


def phases() -> tuple[float, ...]:
    """Returns the durations of the phases of a stride in their order, in s."""
    return tuple(bound().durations.values())


def largest_multiplier() -> float:
    """Returns the modulus of the largest Floquet multiplier without event feedback."""
    return float(np.abs(bound().multipliers).max())


def largest_output(gait: str = SHOWN) -> float:
    """Returns the largest output in a stride, (5.9) and (5.18), in rad."""
    return zero_dynamics.largest_output(bound(gait).system.robot, stride_run(gait))


def decay_in_epsilons(gait: str = SHOWN, epsilon: float | None = None) -> float:
    """Returns the time in which disturbed outputs fall to a twentieth, in ε of (5.16)."""
    return zero_dynamics.decay(bound(gait).system, stride_run(gait), epsilon)


def friction_by_preload(gait: str = SHOWN, share: float = 0.9) -> tuple[float, ...]:
    """Returns the friction that the posterior stance needs, max |F_x| / F_z, with ū and with a share of it.

    Each run starts at the touchdown of the gait and lasts through the stance that follows.
    """
    system, found = bound(gait).system, []
    law = replace(system.law, posterior_knee_torque=share * system.law.posterior_knee_torque)
    less = system.build(system.robot, law, system.springs, system.contact)
    for run in (stride(gait), simulate(less, bound(gait).state, progress=False)):
        force = run.force[(run.cycle == 1) & (run.phase == "posterior_stance"), 0]
        bears = force[force[:, 1] > BEARING]
        found.append(float((np.abs(bears[:, 0]) / bears[:, 1]).max()))
    return tuple(found)


def preloads(gaits: Sequence[str] = ("long_stride", "least_effort")) -> tuple[float, ...]:
    """Returns ū of one motor, posterior and anterior, gait by gait, in N·m."""
    return tuple(getattr(bound(gait).system.law, f"{leg}_knee_torque") / PAIR for gait in gaits for leg in LEGS)


def knee_peaks(stiffness: float) -> tuple[float, float]:
    """Returns the largest torque of a knee motor in stance with a spring of this stiffness, in N·m."""
    posterior, anterior = knee_points(stiffness).peak
    return float(posterior), float(anterior)


def peak_over_hop() -> tuple[float, float]:
    """Returns the largest torque of a knee motor in the bound over that in the hop in place."""
    run = one_hop()
    hopping = Curves.of(run.t).amount(run.u[:, run.actuated.index("knee")])
    posterior, anterior = knee_peaks(OWN_SPRING)
    return posterior / hopping, anterior / hopping


def peak_reduction(stiffness: float = OWN_SPRING) -> tuple[float, float]:
    """Returns by how much a spring reduces the largest torque of a knee motor in stance, in N·m."""
    bare, sprung = knee_points(0.0).peak, knee_points(stiffness).peak
    return float(bare[0] - sprung[0]), float(bare[1] - sprung[1])


def flight_difference(stiffness: float = OWN_SPRING) -> float:
    """Returns the largest difference that a spring makes to a knee motor's torque with the leg in the air, in N·m."""
    bare, sprung = knee_points(0.0), knee_points(stiffness)
    return float(np.abs(bare.torque - sprung.torque)[~bare.bears].max())


def hip_difference(stiffness: float = 200.0) -> float:
    """Returns the largest difference that a knee spring makes to a hip motor's torque in the same motion, in N·m."""
    return float(np.abs(hips(0.0).torque - hips(stiffness).torque).max())


def peaks_by_stiffness(
    leg: int, stiffnesses: Sequence[float] = (0.0, 56.0, 112.0, 200.0), gait: str = SHOWN
) -> tuple[float, ...]:
    """Returns the largest torque of a leg's knee motor in stance by the stiffness of its spring, in N·m."""
    return tuple(float(knee_points(stiffness, gait).peak[leg]) for stiffness in stiffnesses)


def spread_in_stance(stiffness: float) -> tuple[float, float]:
    """Returns the difference between the largest and the least torque of a knee motor in stance, in N·m."""
    given = knee_points(stiffness)
    posterior, anterior = (float(np.ptp(given.torque[given.bears[:, leg], leg])) for leg in (0, 1))
    return posterior, anterior


def hip_time_outside(ratio: float) -> float:
    """Returns the largest share of a stride that a hip motor is outside its envelope, by gear ratio."""
    return float(against(hips(), hip_drive(ratio)).outside.max())


def hip_over_knee(gait: str = SHOWN) -> tuple[float, float]:
    """Returns the root mean square torque of a hip motor over that of its leg's knee motor."""
    posterior, anterior = hips(name=gait).rms / knee_points(name=gait).rms
    return float(posterior), float(anterior)


def knee_time_outside(power: str) -> float:
    """Returns the largest share of a stride that a knee motor is outside its envelope, by rated power."""
    return float(against(knee_points(), knee_drive(power)).outside.max())


def outside_near_events(power: str = "260 W", gaits: Sequence[str] = GAITS) -> tuple[float, ...]:
    """Returns the share of points outside a knee drive's envelope within 20 ms of touchdown or lift-off.

    The time counts after touchdown and before lift-off. There is one number for each gait that has points outside.
    """
    used = [against(knee_points(name=gait), knee_drive(power)) for gait in gaits]
    return tuple(each.near_events for each in used if not each.fits)


def outside_without_preload(power: str = "260 W") -> float:
    """Returns the share of points outside a knee drive's envelope in stance that stay outside without ū."""
    given, drive = knee_points(), knee_drive(power)
    out = _outside(given, power) & given.bears
    law = bound().system.law
    preload = np.array([law.posterior_knee_torque, law.anterior_knee_torque]) / PAIR
    reduced = np.sign(given.torque) * np.maximum(np.abs(given.torque) - preload, 0.0)
    return float((np.asarray(drive.margin(reduced, given.speed)) < 0.0)[out].mean())


def rotor_ratio(larger: str = "ec_90_flat_260w", smaller: str = "ec_60_flat_100w_48v") -> float:
    """Returns the rotor inertia of one motor of the catalogue over that of another."""
    return motor(larger).known("rotor_inertia") / motor(smaller).known("rotor_inertia")


def _outside(given: Points, power: str) -> NDArray[np.bool_]:
    return np.asarray(against(given, knee_drive(power)).margin < 0.0)
