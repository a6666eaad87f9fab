"""Simulations that statements and figures of the report share; each is made once in a process.

They are this package's own. Where the source prints no number, an assumption or a solved value replaces it, see
`spear_pin.studies.audit.statements.assumptions`.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache, wraps
from inspect import signature
from typing import ParamSpec, TypeVar

import numpy as np

from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw, hopping
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.gaits.search import find_gait
from spear_pin.hybrid.contact import Contact
from spear_pin.hybrid.hardware import Sensing
from spear_pin.hybrid.parameters import with_hardware
from spear_pin.hybrid.result import Options, Run
from spear_pin.hybrid.run import run
from spear_pin.hybrid.simulate import sample, simulate
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.catalogue import gearbox, motor
from spear_pin.model.loading import load
from spear_pin.model.motor import Drive, Gearbox
from spear_pin.model.variants import vary
from spear_pin.studies.audit.printed_designs import Q_SPEAR, SPEAR_II
from spear_pin.studies.audit.printed_estimates import TABLE_4_1
from spear_pin.studies.design import STIFFNESSES, Points, points_of, sprung
from spear_pin.studies.energetics import Costs, EnergyFlow, costs, energy_flow
from spear_pin.studies.hardware import RTOL, Rig, on_rig
from spear_pin.studies.identification import Estimate, MovingAverage, identify, smooth_trial
from spear_pin.studies.laboratory import synthetic_trial
from spear_pin.studies.push_test import RATIOS, GearRow, PassiveKnee, gear_study, spear_ii
from spear_pin.studies.push_test import power_off as idle

FLIGHT_TIME = 0.2  # s, Section 4.2.2
CURRENT_LIMIT, BANDWIDTH = 8.0, 500.0  # A, Hz: assumptions
NOISE = 0.005  # rad, of the synthetic records
RELEASES = 5  # of each depth, Section 4.1.3
BUS = 48.0  # V, of the quadruped's motors: an assumption
KNEE, FRICTION = HoppingLaw().knee_touchdown, Contact().friction  # rad, 1: assumptions
GAITS = ("long_stride", "least_effort", "force_lift_off")  # those at the speed of Table 5.1
SHOWN = GAITS[0]  # unless another is asked for
P = ParamSpec("P")
T = TypeVar("T")


def kept(function: Callable[P, T]) -> Callable[P, T]:
    """Makes a function compute each answer once; an argument that is left out is the same as its default."""
    once, parameters = cache(function), signature(function)

    @wraps(function)
    def asked(*args: P.args, **given: P.kwargs) -> T:
        bound = parameters.bind(*args, **given)
        bound.apply_defaults()
        return once(*bound.args, **bound.kwargs)

    return asked


@kept
def hop(knee: float = KNEE, friction: float = FRICTION, ratio: float = SPEAR_II.knee_ratio) -> Gait:
    """Finds SPEAR-II's hop in place; its stance torque is solved for the flight time of Section 4.2.2.

    Args:
        knee: commanded angle of the knee in flight, in rad.
        friction: coefficient of friction of the ground.
        ratio: ratio of the knee's gearbox.
    """
    robot = vary(load("spear_ii", locked=["boom_x"]), knee_ratio=ratio)
    system = hopping(robot, HoppingLaw(knee_touchdown=knee), contact=Contact(friction=friction))
    return find_gait(system, ["stance_torque"], {"flight_time": FLIGHT_TIME})


@kept
def one_hop(knee: float = KNEE, friction: float = FRICTION, ratio: float = SPEAR_II.knee_ratio) -> Trajectory:
    """Simulates one of these hops, from touchdown to touchdown."""
    gait = hop(knee, friction, ratio)
    return simulate(gait.system, gait.state, progress=False)


@kept
def hop_measures() -> dict[str, float]:
    """Returns the measures of one of these hops, of `spear_pin.gaits.measures.catalogue`, by name."""
    return Sampled(hop().system.robot, one_hop()).values()


@cache
def hops() -> Trajectory:
    """Simulates eleven of these hops, as many as in Fig. 4.13."""
    return simulate(hop().system, hop().state, 11, progress=False)


@cache
def hardware_hop() -> Gait:
    """Finds the hop with that flight time on motors, gears and a battery."""
    robot = load("spear_ii", locked=["boom_x"])
    system = with_hardware(hopping(robot, HoppingLaw(stance_torque=9.4)), Rig().on(robot))
    return find_gait(system, ["stance_torque"], {"flight_time": FLIGHT_TIME})


@cache
def calm_hops() -> Trajectory:
    """Simulates three hops on hardware."""
    return on_rig(hardware_hop(), Rig(), hops=3, progress=False)


@cache
def rough_hops() -> Trajectory:
    """Simulates eleven hops on hardware with noise, lost commands and less current."""
    sensing = Sensing(angle_noise=0.005, rate_noise=0.2, losses=5.0)
    rig = Rig(sensing=sensing, current_limit=CURRENT_LIMIT, bandwidth=BANDWIDTH)
    return on_rig(hardware_hop(), rig, rtol=RTOL, progress=False)


@cache
def hop_energy() -> EnergyFlow:
    """Returns the energy flow of a hop on hardware."""
    return energy_flow(hardware_hop().system, calm_hops())


@kept
def gears(static_rest: bool = False) -> tuple[GearRow, ...]:
    """Simulates the release from 10 cm without motor, and with the gear ratios of Fig. 4.6."""
    return tuple(gear_study(RATIOS, static_rest=static_rest))


@kept
def idling(static_rest: bool = False) -> dict[str, idle.PowerOff]:
    """Simulates the release with the motor in each state of Fig. 4.7, by label."""
    return {row.label: row for row in idle.power_off(static_rest=static_rest)}


def estimated(depth: float, motor_on: bool) -> PassiveKnee:
    """Returns the knee with the estimates of a row of Table 4.1, with RA as the spring's zero."""
    row = next(row for row in TABLE_4_1 if (row.depth, row.motor) == (depth, motor_on))
    return PassiveKnee(stiffness=row.stiffness, damping=row.damping, zero=row.rest_angle)


@cache
def fitted(depth: float, motor_on: bool) -> Estimate:
    """Estimates a row of Table 4.1 from five synthetic releases, smoothed in the source's way."""
    leg, knee = spear_ii(15.0 if motor_on else None), estimated(depth, motor_on)
    rng = np.random.default_rng(round(1e3 * depth) + motor_on)
    trials = [synthetic_trial(leg, knee, depth, NOISE, rng) for _ in range(RELEASES)]
    return identify(leg, [smooth_trial(trial, MovingAverage(100)) for trial in trials])


@kept
def bound(name: str = SHOWN) -> Gait:
    """Finds Q-SPEAR's bound at 2.5 m/s."""
    return Gait.load(name)


@cache
def strides() -> Trajectory:
    """Simulates two strides of the bound."""
    return simulate(bound().system, bound().state, 2, progress=False)


@kept
def stride_run(name: str = SHOWN, stiffness: float = Q_SPEAR.stiffness) -> Run:
    """Simulates a stride with latched values, with knee springs of a stiffness a leg, in N·m/rad."""
    return run(sprung(bound(name).system, stiffness), bound(name).state, 1, Options(keep=True))


@kept
def stride(name: str = SHOWN, stiffness: float = Q_SPEAR.stiffness) -> Trajectory:
    """Returns the samples of that stride."""
    return sample(sprung(bound(name).system, stiffness), stride_run(name, stiffness))


def knee_points(stiffness: float = Q_SPEAR.stiffness, name: str = SHOWN) -> Points:
    """Returns operating points of the knee motors, with springs of a stiffness a leg, in N·m/rad."""
    return points_of(bound(name).system.robot, stride(name, stiffness), "knee")


@cache
def knees() -> dict[float, Points]:
    """Returns operating points of the knee motors by stiffness, as in Fig. 5.6."""
    return {stiffness: knee_points(stiffness) for stiffness in STIFFNESSES}


def hips(stiffness: float = Q_SPEAR.stiffness, name: str = SHOWN) -> Points:
    """Returns operating points of the hip motors, with springs of a stiffness a leg, in N·m/rad."""
    return points_of(bound(name).system.robot, stride(name, stiffness), "hip")


def knee_drive(power: str) -> Drive:
    """Returns a knee drive by its rated power, as the source names them: "100 W", "260 W" or "600 W"."""
    if power == "100 W":
        return Drive(motor("spear_ii_knee"), gearbox("spear_ii_knee_gear"), 24.0)
    names = {"260 W": "ec_90_flat_260w", "600 W": "assumed_600w"}
    return Drive(motor(names[power]), Gearbox(15.0, gearbox("spear_ii_knee_gear").efficiency), BUS)


def hip_drive(ratio: float) -> Drive:
    """Returns the drive of the hip: its motor behind gears without loss, on 24 V."""
    return Drive(motor("faulhaber_3863h024cr"), Gearbox(ratio), 24.0)


@cache
def bound_costs() -> Costs:
    """Returns the costs of the bound with the motors assumed for 600 W."""
    drives = [Drive(motor("assumed_600w"), gearbox("gp_52_c_15"), BUS)] * 4
    return costs(bound().system, simulate(bound().system, bound().state, 1, progress=False), drives)
