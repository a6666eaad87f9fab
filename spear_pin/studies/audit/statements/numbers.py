"""Numbers that statements ask of runs, where they take more than a formula; torques are those of one motor.

A bounding gait is named as in `runs.GAITS`. Of its legs the posterior one comes first.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import product

import numpy as np

from spear_pin.gaits.bounding_law import PAIR
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.measures.curves import Curves
from spear_pin.hybrid.simulate import simulate
from spear_pin.model.boom import RotaryBoom
from spear_pin.model.bridge import Battery, back_emf
from spear_pin.model.catalogue import motor
from spear_pin.studies.audit import runs
from spear_pin.studies.audit.printed_designs import SPEAR_II
from spear_pin.studies.audit.printed_equations import GRAVITY
from spear_pin.studies.boom_encoder import Encoder, height_by_sine, read_angle
from spear_pin.studies.bound.turn import summarize_turn
from spear_pin.studies.design import against
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, equilibrium, find_pushed_angle, release, rest_at, spear_ii

VOLTS = Battery().voltage  # of SPEAR-II's battery, Section 2.4.5
BRINK = 1e-6  # of the current limit
BOOM_RADIUS = 2.0  # m, Section 2.4.4
BEARING = 20.0  # N: below, the ratio of two forces means little
TURNS = ("turn_4", "turn_9", "turn_13", "turn_9_2.25", "turn_9_2.75")


def work_against(knee: float = runs.KNEE, friction: float = runs.FRICTION) -> tuple[float, ...]:
    """Returns the knee motor's work against the knee's motion in stance, with f halved, as it is, and doubled, in J.

    Each run starts at the touchdown of the hop with f as it is, and lasts through the stance that follows.
    """
    gait, found = runs.hop(knee, friction), []
    for factor in (0.5, 1.0, 2.0):
        law = replace(gait.system.law, frequency=factor * gait.system.law.frequency)
        system = gait.system.build(gait.system.robot, law, gait.system.springs, gait.system.contact)
        run = simulate(system, gait.state, progress=False)
        stance = (run.cycle == 1) & (run.phase == "stance")
        power = run.u[:, run.actuated.index("knee")] * run.v[:, run.coordinates.index("knee")]
        found.append(Curves(run.t, stance).positive(-power))
    return tuple(found)


def work_and_heat_by_ratio(ratios: Sequence[float] = (7.5, 15.0, 30.0)) -> tuple[float, ...]:
    """Returns the knee motor's positive work in a hop by gear ratio, in J, then ∫ (τ/N)² dt, in N²m²s."""
    work, heat = [], []
    for ratio in ratios:
        run = runs.one_hop(ratio=ratio)
        torque, rate = run.u[:, run.actuated.index("knee")], run.v[:, run.coordinates.index("knee")]
        work.append(Curves.of(run.t).positive(torque * rate))
        heat.append(Curves.of(run.t).integral((torque / ratio) ** 2))
    return (*work, *heat)


def boom_error(angle: float = np.pi / 180.0) -> float:
    """Returns the hip's height error by an error of the boom's angle, over the rise of a hop with 0.2 s of flight."""
    boom = RotaryBoom(radius=BOOM_RADIUS, pivot=0.0)
    error = height_by_sine(boom, read_angle(boom, Encoder(offset=angle), 0.0))
    return float(error / (GRAVITY * runs.FLIGHT_TIME**2 / 8.0))


def saturated_share() -> float:
    """Returns the share of time in which the knee motor's current is at its limit, on disturbed hardware."""
    run = runs.rough_hops()
    current = np.abs(run.current[:, run.actuated.index("knee")])
    at_limit = current >= runs.CURRENT_LIMIT * (1.0 - BRINK)
    return float(np.trapezoid(at_limit.astype(float), run.t) / (run.t[-1] - run.t[0]))


def fixed_point_residual(gait: str = runs.SHOWN) -> float:
    """Returns ‖P(x) - x‖ of the bound, torso_x left out, SI units, for the stride that is simulated here."""
    run = runs.stride_run(gait)
    (q0, v0), (q1, v1) = run.start, run.state
    return float(np.linalg.norm(np.concatenate([(q1 - q0)[1:], v1 - v0])))


def friction_by_preload(gait: str = runs.SHOWN, share: float = 0.9) -> tuple[float, ...]:
    """Returns the friction that the posterior stance needs, max |F_x| / F_z, with ū and with a share of it.

    Each run starts at the touchdown of the gait and lasts through the stance that follows.
    """
    system, found = runs.bound(gait).system, []
    law = replace(system.law, posterior_knee_torque=share * system.law.posterior_knee_torque)
    less = system.build(system.robot, law, system.springs, system.contact)
    for run in (runs.stride(gait), simulate(less, runs.bound(gait).state, progress=False)):
        force = run.force[(run.cycle == 1) & (run.phase == "posterior_stance"), 0]
        bears = force[force[:, 1] > BEARING]
        found.append(float((np.abs(bears[:, 0]) / bears[:, 1]).max()))
    return tuple(found)


def spread_in_stance(stiffness: float) -> tuple[float, float]:
    """Returns the difference between the largest and the least torque of a knee motor in stance, in N·m."""
    given = runs.knee_points(stiffness)
    posterior, anterior = (float(np.ptp(given.torque[given.bears[:, leg], leg])) for leg in (0, 1))
    return posterior, anterior


def outside_without_preload(power: str = "260 W") -> float:
    """Returns the share of points outside a knee drive's envelope in stance that stay outside without ū."""
    given, drive = runs.knee_points(), runs.knee_drive(power)
    out = (against(given, drive).margin < 0.0) & given.bears
    law = runs.bound().system.law
    preload = np.array([law.posterior_knee_torque, law.anterior_knee_torque]) / PAIR
    reduced = np.sign(given.torque) * np.maximum(np.abs(given.torque) - preload, 0.0)
    return float((np.asarray(drive.margin(reduced, given.speed)) < 0.0)[out].mean())


def least_forces(static_rest: bool = False) -> tuple[float, ...]:
    """Returns the least normal force on the toe after a release from each depth, with the motor and without, in N."""
    found = []
    for motor_on, depth in product((True, False), DEPTHS):
        leg, knee = spear_ii(15.0 if motor_on else None), runs.estimated(depth, motor_on)
        if static_rest:
            knee = rest_at(leg, knee, knee.zero)
        found.append(float(release(leg, knee, depth).force[:, 1].min()))
    return tuple(found)


def energy_left(depth: float = 0.10, static_rest: bool = False) -> float:
    """Returns the energy of the spring at rest over that at the depth of a push, in m."""
    leg, knee = spear_ii(), WITH_MOTOR
    if static_rest:
        knee = rest_at(leg, knee, knee.zero)
    return ((equilibrium(leg, knee) - knee.zero) / (find_pushed_angle(leg, knee, depth) - knee.zero)) ** 2


def emf(speed: float, ratio: float = SPEAR_II.knee_ratio) -> float:
    """Returns the back-EMF (4.8) of the knee motor at a speed of the joint, or with the ratio 1 of its rotor, in V."""
    return float(back_emf(motor("spear_ii_knee").known("torque_constant"), ratio, speed))


def recovered() -> float:
    """Returns the errors of stiffness and damping in the six synthetic sets, root mean square, in deviations."""
    errors = []
    for depth, motor_on in product(DEPTHS, (True, False)):
        found, truth = runs.fitted(depth, motor_on), runs.estimated(depth, motor_on)
        errors += [
            (found[name].value - getattr(truth, name)) / found[name].deviation for name in ("stiffness", "damping")
        ]
    return float(np.sqrt(np.mean(np.square(errors))))


def adduction_over_knee() -> tuple[float, ...]:
    """Returns the largest speed, then the range, of an adduction over a knee's in a stride, in each of `TURNS`."""
    shares = []
    for name in TURNS:
        gait = Gait.load(name)
        joints = summarize_turn(gait, simulate(gait.system, gait.state, 2, progress=False))["joints"]
        shares.append([joints["adduction"][of] / joints["knee"][of] for of in ("speed", "range")])
    return tuple(speed for speed, _ in shares) + tuple(span for _, span in shares)
