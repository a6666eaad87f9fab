"""The runs that statements and figures of the report share, each made once in a process.

They are this package's own: where the source prints no number, an assumption or a solved value stands in its
place, see `spear_pin.studies.statements.assumptions`.
"""

from __future__ import annotations

from functools import cache

import numpy as np

from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.hardware import Sensing, with_hardware
from spear_pin.hybrid.simulate import simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.catalogue import gearbox, motor
from spear_pin.model.loading import load
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.studies import power_off as idle
from spear_pin.studies.design import STIFFNESSES, Points, points, spring_sweep
from spear_pin.studies.energetics import Costs, EnergyFlow, costs, energy_flow
from spear_pin.studies.hardware import RTOL, Rig, on_rig
from spear_pin.studies.identification import Estimate, MovingAverage, identify, smoothed
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import RATIOS, GearRow, gear_study, spear_ii
from spear_pin.studies.release import PassiveKnee
from spear_pin.studies.source_tables import TABLE_4_1

FLIGHT_TIME = 0.2  # s, Section 4.2.2
CURRENT_LIMIT, BANDWIDTH = 8.0, 500.0  # A, Hz: assumptions
NOISE = 0.005  # rad, of the synthetic records
RELEASES = 5  # of each depth, Section 4.1.3
BUS = 48.0  # V, of the quadruped's motors: an assumption


@cache
def hop() -> Gait:
    """SPEAR-II hopping in place, its stance torque solved for the flight time of Section 4.2.2."""
    return find_gait(hopping(load("spear_ii", locked=["boom_x"])), ["stance_torque"], {"flight_time": FLIGHT_TIME})


@cache
def hops() -> Trajectory:
    """Eleven of these hops, as many as in Fig. 4.13."""
    return simulate(hop().system, hop().state, 11, progress=False)


@cache
def hardware_hop() -> Gait:
    """The same on motors, gears and a battery."""
    robot = load("spear_ii", locked=["boom_x"])
    system = with_hardware(hopping(robot, HoppingLaw(stance_torque=9.4)), Rig().on(robot))
    return find_gait(system, ["stance_torque"], {"flight_time": FLIGHT_TIME})


@cache
def calm_hops() -> Trajectory:
    """Three hops on hardware."""
    return on_rig(hardware_hop(), Rig(), hops=3, progress=False)


@cache
def rough_hops() -> Trajectory:
    """Eleven hops on hardware with noise, lost commands and less current."""
    sensing = Sensing(angle_noise=0.005, rate_noise=0.2, losses=5.0)
    rig = Rig(sensing=sensing, current_limit=CURRENT_LIMIT, bandwidth=BANDWIDTH)
    return on_rig(hardware_hop(), rig, rtol=RTOL, progress=False)


@cache
def hop_energy() -> EnergyFlow:
    """Where the energy of a hop on hardware goes."""
    return energy_flow(hardware_hop().system, calm_hops())


@cache
def gears() -> tuple[GearRow, ...]:
    """The release from 10 cm without motor, and with the gear ratios of Fig. 4.6."""
    return tuple(gear_study(RATIOS))


@cache
def idling() -> dict[str, idle.PowerOff]:
    """The release with the motor in each state of Fig. 4.7, by label."""
    return {row.label: row for row in idle.power_off()}


def estimated(depth: float, motor_on: bool) -> PassiveKnee:
    """The knee with the estimates of a row of Table 4.1, RA read as the spring's zero."""
    row = next(row for row in TABLE_4_1 if (row.depth, row.motor) == (depth, motor_on))
    return PassiveKnee(stiffness=row.stiffness, damping=row.damping, zero=row.rest_angle)


@cache
def fitted(depth: float, motor_on: bool) -> Estimate:
    """What is estimated from five synthetic releases of a row of Table 4.1, smoothed as the source's were."""
    leg, knee = spear_ii(15.0 if motor_on else None), estimated(depth, motor_on)
    rng = np.random.default_rng(round(1e3 * depth) + motor_on)
    trials = [synthetic_trial(leg, knee, depth, NOISE, rng) for _ in range(RELEASES)]
    return identify(leg, [smoothed(trial, MovingAverage(100)) for trial in trials])


@cache
def bound() -> Gait:
    """Q-SPEAR bounding at 2.5 m/s, the gait that is shown unless another is asked for."""
    return Gait.load("long_stride")


@cache
def strides() -> Trajectory:
    """Two strides of it."""
    return simulate(bound().system, bound().state, 2, progress=False)


@cache
def knees() -> dict[float, Points]:
    """Operating points of the knee motors, by stiffness of a leg's spring."""
    return spring_sweep(bound(), STIFFNESSES)


@cache
def hips() -> Points:
    """Operating points of the hip motors."""
    return points(bound(), "hip")


def knee_drive(power: str) -> Drive:
    """A knee drive by its rated power, as the source names them: "100 W", "260 W" or "600 W"."""
    if power == "100 W":
        return Drive(motor("spear_ii_knee"), gearbox("spear_ii_knee_gear"), 24.0)
    names = {"260 W": "ec_90_flat_260w", "600 W": "assumed_600w"}
    return Drive(motor(names[power]), Gearbox(15.0, gearbox("spear_ii_knee_gear").efficiency), BUS)


def hip_drive(ratio: float) -> Drive:
    """The hip's motor behind gears without loss, on 24 V."""
    return Drive(motor("faulhaber_3863h024cr"), Gearbox(ratio), 24.0)


@cache
def bound_costs() -> Costs:
    """What the bound costs with the motors assumed for 600 W."""
    drives = [Drive(motor("assumed_600w"), gearbox("gp_52_c_15"), BUS)] * 4
    return costs(bound().system, simulate(bound().system, bound().state, 1, progress=False), drives)
