"""Statements of Tables 4.1 and 4.2: estimates from the push test, and how the motor changes them."""

from __future__ import annotations

from functools import partial

from spear_pin.studies.audit import printed_estimates
from spear_pin.studies.audit.printed_estimates import TABLE_4_2
from spear_pin.studies.audit.statements import push_numbers as push
from spear_pin.studies.audit.statements.criteria import above, between, near
from spear_pin.studies.audit.statements.statement import Statement

PRINTED = {row.motor: row for row in TABLE_4_2}
DAMPED = round(PRINTED[True].damping - PRINTED[False].damping, 2)  # N·m·s/rad, by the motor
STIFFENED = round(PRINTED[True].stiffness - PRINTED[False].stiffness, 2)  # N·m/rad
BELT_STATED = (0.73, 1.09)  # N·m/rad, Section 4.1.5.1
AVERAGED = {  # columns of Table 4.2: symbol, unit, and how far rounding may take them from the mean
    "stiffness": ("k_rot", "N·m/rad", 0.01),
    "damping": ("b", "N·m·s/rad", 0.015),
    "rest_angle": ("RA", "rad", 0.015),
    "sigma_stiffness": ("σ of k_rot", "N·m/rad", 0.01),
    "sigma_damping": ("σ of b", "N·m·s/rad", 0.01),
    "sigma_rest_angle": ("σ of RA", "rad", 0.01),
    "fit": ("fit", "%", 0.015),
}


def _average(column: str, motor: bool) -> Statement:
    """Returns the statement that a number of Table 4.2 is the mean of Table 4.1's rows."""
    name, unit, tolerance = AVERAGED[column]
    printed, case = float(getattr(PRINTED[motor], column)), "with motor" if motor else "no motor"
    return Statement(
        f"mean-{column}-{case}".replace("_", "-").replace(" ", "-"),
        "Table 4.2",
        f"{case.capitalize()}, the mean {name} is {printed:g} {unit}.",
        "mean of the rows of Table 4.1",
        partial(printed_estimates.mean, column, motor),
        unit,
        printed,
        near(printed, tolerance),
        exhibit="table-4.1",
    )


STATEMENTS = (
    *(_average(column, motor) for motor in (True, False) for column in AVERAGED),
    Statement(
        "motor-stiffens",
        "Section 4.1.4",
        "The motor raises k_rot by 0.85 N·m/rad.",
        "difference of the means of Table 4.1",
        partial(printed_estimates.motor_effect, "stiffness"),
        "N·m/rad",
        STIFFENED,
        near(STIFFENED, 0.01),
        exhibit="table-4.1",
    ),
    Statement(
        "motor-stiffens-distinctly",
        "Section 4.1.5.1",
        "That difference is distinct.",
        "weighted difference over its standard deviation",
        printed_estimates.motor_effect_in_deviations,
        criterion=above(2.0),
        remark="By the table's own standard deviations it may as well be none.",
        exhibit="table-4.1",
    ),
    Statement(
        "belt-stiffness",
        "(4.7)",
        "The belt's stiffness at the knee is between 0.73 and 1.09 N·m/rad.",
        "2 E A r² / L₀ for either modulus",
        printed_estimates.belt_range,
        "N·m/rad",
        BELT_STATED,
        near(BELT_STATED, 0.005),
        remark="With A = 1.242·10⁻⁵ m²; the unit is misprinted.",
    ),
    Statement(
        "belt-explains-motor",
        "Section 4.1.5.1",
        "The belt's stiffness explains what the motor adds to k_rot.",
        "difference of the means of Table 4.1",
        partial(printed_estimates.motor_effect, "stiffness"),
        "N·m/rad",
        BELT_STATED,
        between(*BELT_STATED),
        remark="The printed 0.85 is in the range, the rows' own mean is not. The belt is parallel to the spring only "
        "while the rotor stands still; without current it floats.",
        exhibit="table-4.1",
    ),
    Statement(
        "motor-damps",
        "Section 4.1.4",
        "The motor raises b by 0.26 N·m·s/rad.",
        "difference of the means of Table 4.1",
        partial(printed_estimates.motor_effect, "damping"),
        "N·m·s/rad",
        DAMPED,
        near(DAMPED, 0.015),
        exhibit="table-4.1",
    ),
    Statement(
        "boom-damping",
        "Section 6.2.3, Table 4.2",
        "Boom and leg damp four times as much as knee motor and transmission.",
        "b without the motor over what the motor adds, by the means of Table 4.1",
        printed_estimates.boom_over_motor,
        printed=4.0,
        criterion=near(4.0, 0.5),
        exhibit="table-4.1",
    ),
    Statement(
        "viscous-friction",
        "Section 4.1.1, Table 4.1",
        "One coefficient b describes a friction of Coulomb's kind.",
        "b with the motor from 5 to 10 cm",
        partial(printed_estimates.damping_by_depth, True),
        "N·m·s/rad",
        unknown="b falls with the depth, as dry friction makes it fall, but the differences are within the deviations; "
        "the records are not public.",
        exhibit="table-4.1",
    ),
    Statement(
        "resting-angle",
        "Table 4.1",
        "RA, 1 rad, is the resting angle of the knee.",
        "where the leg stands if 1 rad is the zero of its spring",
        push.resting_angle,
        "rad",
        1.0,
        unknown="It may be the spring's zero or the angle at which the leg stands, which differ by the weight's "
        "share. The "
        "ratios of the table's deviations favour the first.",
        assumes=("rest-angle",),
        exhibit="table-4.1",
    ),
)
