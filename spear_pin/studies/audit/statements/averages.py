"""Statements that the numbers of Table 4.2 are the means of Table 4.1."""

from __future__ import annotations

from spear_pin.studies.audit.printed_estimates import TABLE_4_2
from spear_pin.studies.audit.statements.criteria import near
from spear_pin.studies.audit.statements.formula import Formula
from spear_pin.studies.audit.statements.statement import Statement

PRINTED = {row.motor: row for row in TABLE_4_2}
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
        Formula(f"printed_estimates.average({motor}).{column}"),
        unit,
        printed,
        near(printed, tolerance),
        exhibit="table-4.1",
    )


STATEMENTS = tuple(_average(column, motor) for motor in (True, False) for column in AVERAGED)
