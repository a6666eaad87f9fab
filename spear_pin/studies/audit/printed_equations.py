"""Equations of the source as printed and corrected, and the differences between both.

They serve only for comparison; nothing else in this package uses a printed form that is wrong.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.model.loading import load
from spear_pin.model.variants import vary
from spear_pin.studies.audit.printed_designs import by_urdf
from spear_pin.studies.push_test import WITH_MOTOR, equilibrium, rest_at, spear_ii

ANGLE = 1.0  # rad, of the knee, hip at half of it: the toe below the hip
GRAVITY = 9.81  # m/s²
SAMPLES, SEED = 50, 0


def effective_inertia(angle: float = ANGLE) -> tuple[float, float]:
    """Returns the knee's inertia in the push test by (3.14) as printed, and corrected, in kg·m²."""
    leg = by_urdf("spear_ii")
    about_hip = leg.hip_inertia + leg.thigh_inertia + leg.thigh_mass * leg.thigh_com**2
    about_knee = leg.knee_inertia + leg.shank_inertia + leg.shank_mass * leg.shank_com**2
    fall = leg.thigh_length * np.sin(0.5 * angle)  # of the hip for one rad more
    printed = about_hip * 0.5**2 + about_knee + leg.torso_mass * fall**2
    return float(printed), float(spear_ii().effective_inertia(angle))


def gravity_torque(angle: float = ANGLE) -> tuple[float, float]:
    """Returns the weight's torque on the push test's knee by (3.15) printed, and corrected, in N·m, flexing > 0."""
    leg, hip = by_urdf("spear_ii"), 0.5 * angle
    fall = (
        leg.torso_mass * leg.thigh_length * np.sin(hip)
        + leg.thigh_mass * (leg.thigh_length - leg.thigh_com) * np.sin(hip) * 0.5
        + leg.leg_mass * leg.shank_length * np.sin(hip + angle) * 1.5
    )
    return float(GRAVITY * fall), float(-spear_ii().gravity(angle))


def spring_growth(static_rest: bool = False) -> tuple[float, float]:
    """Returns the largest growth rate about rest with the spring of (3.24) as printed, and corrected, in 1/s.

    The equation is J θ̈ + b θ̇ + (∓k + dG/dθ) θ = 0, with the leg pinned at its toe.

    Args:
        static_rest: whether RA is the angle at rest.
    """
    leg, knee = spear_ii(), WITH_MOTOR
    if static_rest:
        knee = rest_at(leg, knee, knee.zero)
    rest = equilibrium(leg, knee)
    inertia, slope = float(leg.effective_inertia(rest)), float(leg.motion_with_slopes(rest)[5])
    rates = [float(np.roots([inertia, knee.damping, sign * knee.stiffness + slope]).real.max()) for sign in (-1.0, 1.0)]
    return rates[0], rates[1]


def friction_power(force: float = 1.0, speed: float = 1.0) -> tuple[float, float]:
    """Returns the ground's power on a sliding toe, over μ, by (3.18) printed and corrected, in W.

    Args:
        force: normal force on the toe, in N.
        speed: speed at which the toe slides forward, in m/s.
    """
    return force * speed, -force * float(np.sign(speed)) * speed


def stator_coupling(angle: float = ANGLE) -> tuple[float, float]:
    """Returns the coupling of hip and knee that (3.13) leaves out, N J of the knee's rotor, and all of it, in kg·m²."""
    robot = load("spear_ii")
    hip, knee = robot.index("hip"), robot.index("knee")
    left_out = robot.model.rotorInertia[knee] * robot.gear_ratio("knee")
    return float(left_out), float(abs(robot.mass_matrix([0.0, 0.0, 0.5 * angle, angle])[hip, knee]))


def rotor_in_mass_matrix() -> tuple[float, float]:
    """Returns the rotors' part of D's diagonal at hip and knee, in kg·m², by the kinetic energies (3.12) and (3.13)."""
    robot = load("spear_ii")
    added, q = [], np.zeros(robot.nq)
    for joint, name in (("hip", "hip_rotor"), ("knee", "knee_rotor")):
        row = robot.index(joint)
        added.append(float((robot.mass_matrix(q) - vary(robot, **{name: 0.0}).mass_matrix(q))[row, row]))
    return added[0], added[1]


def kinematics_error() -> float:
    """Returns the largest difference of (3.20) and (3.21) from forward kinematics, over random angles, in m."""
    robot, leg, worst = load("spear_ii"), by_urdf("spear_ii"), 0.0
    for hip, knee in np.random.default_rng(SEED).uniform(-1.5, 1.5, (SAMPLES, 2)):
        toe = robot.toe_position([0.0, 0.0, hip, knee], "toe")
        x = leg.shank_length * np.sin(knee - hip) - leg.thigh_length * np.sin(hip)
        y = leg.thigh_length * np.cos(hip) + leg.shank_length * np.cos(knee - hip)
        worst = max(worst, float(np.abs(toe + (x, y)).max()))
    return worst


def crank_error() -> float:
    """Returns the largest differences of (4.1) to (4.4) from the pinned leg: angle in rad, height in m, and rates."""
    leg, design = spear_ii(), by_urdf("spear_ii")
    thigh, shank = design.thigh_length, design.shank_length
    angles = np.linspace(0.2, 1.8, SAMPLES)
    hip = np.arctan2(shank * np.sin(angles), thigh + shank * np.cos(angles))
    height = thigh * np.cos(hip) + shank * np.cos(angles - hip)
    turn = shank * np.cos(angles - hip) / height  # per unit of the knee's rate
    fall = -thigh * turn * np.sin(hip) - shank * (1.0 - turn) * np.sin(angles - hip)
    place, slope = leg.configuration(angles), leg.configuration.derivative()(angles)
    printed, ours = np.array([height, hip, fall, turn]), np.array([place[0], place[1], slope[0], slope[1]])
    return float(np.abs(printed - ours).max())


def stance_error() -> float:
    """Returns the largest difference of accelerations by the reduced (3.19) and by (3.16) with (3.17), in rad/s²."""
    robot, worst = load("spear_ii"), 0.0
    rng = np.random.default_rng(SEED)
    for _ in range(SAMPLES):
        q = np.array([0.0, 0.0, *rng.uniform(-1.0, 1.0, 2)])
        jacobian = robot.toe_jacobian(q, "toe")
        basis = np.vstack([-np.linalg.solve(jacobian[:, :2], jacobian[:, 2:]), np.eye(2)])  # S = dq / dq_st
        v = basis @ rng.normal(size=2)
        drift = np.concatenate([-np.linalg.solve(jacobian[:, :2], robot.toe_drift(q, v, "toe")), np.zeros(2)])
        D, force = robot.mass_matrix(q), robot.actuation_matrix @ rng.normal(size=2) - robot.bias(q, v)
        reduced = np.linalg.solve(basis.T @ D @ basis, basis.T @ (force - D @ drift))
        bordered = np.block([[D, -jacobian.T], [jacobian, np.zeros((2, 2))]])
        full = np.linalg.solve(bordered, np.concatenate([force, -robot.toe_drift(q, v, "toe")]))[2:4]
        worst = max(worst, float(np.abs(reduced - full).max()))
    return worst


def flight_poles(printed: bool = False, knee_damping: float = 0.0, knee: float = ANGLE) -> NDArray[np.complex128]:
    """Returns the poles of hip and knee in flight about the touchdown angles, boom_x locked, in rad/s, slowest first.

    Args:
        printed: whether (4.9) and (4.10) have the printed sign of the proportional term.
        knee_damping: damping of the joint itself, in N·m·s/rad; the source neglects it in flight.
        knee: angle of the knee at touchdown, in rad; the hip is at half of it.
    """
    law, robot = HoppingLaw(knee_touchdown=knee), load("spear_ii", locked=["boom_x"])
    D = robot.mass_matrix([0.6, 0.5 * law.knee_touchdown, law.knee_touchdown])
    inertia = np.linalg.inv(np.linalg.inv(D)[1:, 1:])  # of the joints, the boom free to rise
    gain = (-1.0 if printed else 1.0) * np.diag([law.hip_gain, law.knee_gain])
    damping = np.diag([law.hip_damping, law.knee_damping + knee_damping])
    top = np.hstack([np.zeros((2, 2)), np.eye(2)])
    matrix = np.vstack([top, -np.linalg.solve(inertia, np.hstack([gain, damping]))])
    poles = np.linalg.eigvals(matrix).astype(np.complex128)
    return poles[np.argsort(np.abs(poles))]


def damping_gain(knee_damping: float = 1.3, knee: float = ANGLE) -> float:
    """Returns the ratio of the damping ratios of the knee's (faster) mode in flight with and without knee damping."""
    fastest = [flight_poles(knee_damping=damping, knee=knee)[-1] for damping in (knee_damping, 0.0)]
    ratios = [float(-pole.real / abs(pole)) for pole in fastest]
    return ratios[0] / ratios[1]
