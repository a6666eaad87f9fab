"""Statements of Chapter 3: the model and its equations."""

from __future__ import annotations

from spear_pin.studies.audit import printed_equations
from spear_pin.studies.audit.printed_designs import SPEAR_II
from spear_pin.studies.audit.statements.criteria import below, equal, first, near
from spear_pin.studies.audit.statements.statement import Statement

STATEMENTS = (
    Statement(
        "lumped-stiffness",
        "(3.5), (3.6)",
        "k_Rot is 2 k_belt r_Pulley² + k_S1 r_Spacer².",
        unknown="The form is right; k_S1 and r_Spacer are not printed, so its value cannot be had from it.",
    ),
    Statement(
        "table-3.1-ratios",
        "Table 3.1",
        "N_Knee is the gear ratio of the hip motor, N_Hip that of the knee motor.",
        "the knee's reflected inertia, were it so",
        printed_equations.knee_rotor_by_table_3_1,
        "kg·m²",
        SPEAR_II.knee_inertia,
        near(SPEAR_II.knee_inertia, 0.0005),
        remark="The two descriptions are exchanged: Table 2.4 has 15:1 at the knee.",
        exhibit="table-3.1",
    ),
    Statement(
        "rotor-energy",
        "(3.12), (3.13)",
        "The rotors add N² J to the inertia of hip and knee.",
        "what they add to the mass matrix at hip and knee",
        printed_equations.rotor_in_mass_matrix,
        "kg·m²",
        (SPEAR_II.hip_inertia, SPEAR_II.knee_inertia),
        near((SPEAR_II.hip_inertia, SPEAR_II.knee_inertia), 1e-9),
        built="The URDF has rotors and ratios by Table 2.4, and the library adds N² J.",
    ),
    Statement(
        "stator-turns",
        "(3.13)",
        "The knee rotor's energy depends on the knee's rate only.",
        "coupling N J that this leaves out, and the coupling of hip and knee in D",
        printed_equations.stator_coupling,
        "kg·m²",
        unknown="The knee motor turns with the thigh; which way its rotor turns is not printed, so the term's sign "
        "is not known.",
        remark="Left out here as in the source.",
    ),
    Statement(
        "kinetic-energy",
        "(3.14)",
        "The kinetic energy is that of two links turning about fixed axes, of the rotors and of the boom.",
        "the knee's effective inertia in the push test at 1 rad, as printed and corrected",
        printed_equations.effective_inertia,
        "kg·m²",
        criterion=equal(0.01),
        remark="Translation with the boom and the coupling of the links are missing, and the shank turns at the "
        "relative rate.",
        exhibit="fig-3.2",
    ),
    Statement(
        "potential-energy",
        "(3.15)",
        "The potential energy has cos(θ₁ + θ₂) and l₂ in the terms of the shank.",
        "the weight's torque on the knee at 1 rad, as printed and corrected",
        printed_equations.gravity_torque,
        "N·m",
        criterion=equal(0.01),
        remark="The difference of the angles and l₂ - d₂ belong there.",
        exhibit="fig-3.2",
    ),
    Statement(
        "sliding-friction",
        "(3.18)",
        "A sliding toe has F_x = μ F_y.",
        "power of the ground on a toe that slides at 1 m/s under 1 N, over μ: as printed and corrected",
        printed_equations.friction_power,
        "W",
        criterion=first(below(0.0)),
        remark="Without the direction of the sliding, friction drives one of the two.",
    ),
    Statement(
        "reduced-stance",
        "(3.16), (3.17), (3.19)",
        "In stance two coordinates are enough: the reduced equations have the same accelerations.",
        "largest difference over random states",
        printed_equations.stance_error,
        "rad/s²",
        criterion=below(1e-8),
    ),
    Statement(
        "stance-kinematics",
        "(3.20), (3.21)",
        "The hip's place above the toe follows from the two angles.",
        "largest difference from forward kinematics over random angles",
        printed_equations.kinematics_error,
        "m",
        criterion=below(1e-12),
    ),
    Statement(
        "scalar-input",
        "(3.22), (3.23)",
        "Hip and knee torque are added up to one input.",
        "rank of B: inputs that are independent",
        printed_equations.independent_inputs,
        criterion=near(1.0, 0.0),
        remark="Read as scalars, as they are named. u has a row for each joint; the knee's torque, spring and damper "
        "act on θ₂ only.",
    ),
    Statement(
        "spring-sign",
        "(3.7), (3.24)",
        "The spring's torque is +k (θ₂ - θ₂ᵗᵈ).",
        "largest growth rate about rest in the push test, as printed and corrected",
        printed_equations.spring_growth,
        "1/s",
        criterion=first(below(0.0)),
        remark="On θ₂ the printed sign pushes away. With torques positive in extension it would be right, but then "
        "(3.25) would drive.",
        assumes=("rest-angle",),
    ),
    Statement(
        "damping-in-flight",
        "Section 3.1",
        "Friction at the knee is negligible in flight.",
        "damping ratio of the knee's mode in flight with b = 1.3 N·m·s/rad, over that without",
        printed_equations.damping_gain,
        criterion=near(1.0, 0.1),
        remark="The belt and gears do not know whether the foot is on the ground. Neglected here as in the source.",
        assumes=("touchdown",),
    ),
)
