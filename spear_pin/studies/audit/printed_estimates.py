"""Tables 4.1 and 4.2 of the source, as printed, and whether they agree with each other."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import fmean

import numpy as np

from spear_pin.studies.push_test import PassiveKnee, find_pushed_angle, rest_at, spear_ii
from spear_pin.studies.push_test.motion import move

COLUMNS = ("stiffness", "damping", "rest_angle", "sigma_stiffness", "sigma_damping", "sigma_rest_angle", "fit")


@dataclass(frozen=True)
class TableRow:
    """A row of Table 4.1 or 4.2.

    Attributes:
        motor: whether the belt was on.
        depth: depth of the push, in m; None for an average.
        stiffness: k_rot, in N·m/rad.
        damping: b, in N·m·s/rad.
        rest_angle: RA, in rad.
        sigma_stiffness: standard deviation of the stiffness, in N·m/rad.
        sigma_damping: standard deviation of the damping, in N·m·s/rad.
        sigma_rest_angle: standard deviation of the rest angle, in rad.
        fit: fit in percent.
    """

    motor: bool
    depth: float | None
    stiffness: float
    damping: float
    rest_angle: float
    sigma_stiffness: float
    sigma_damping: float
    sigma_rest_angle: float
    fit: float


TABLE_4_1 = (
    TableRow(True, 0.050, 49.88, 1.56, 1.01, 9.97, 0.81, 0.05, 86.30),
    TableRow(True, 0.075, 55.93, 1.35, 1.03, 6.30, 0.47, 0.03, 88.20),
    TableRow(True, 0.100, 48.25, 1.03, 1.00, 2.97, 0.23, 0.02, 84.10),
    TableRow(False, 0.050, 48.31, 1.30, 1.00, 8.74, 0.66, 0.05, 90.30),
    TableRow(False, 0.075, 48.53, 1.02, 1.00, 5.08, 0.37, 0.03, 89.60),
    TableRow(False, 0.100, 47.12, 0.80, 1.00, 2.59, 0.19, 0.02, 83.00),
)
TABLE_4_2 = (
    TableRow(True, None, 48.84, 1.30, 1.00, 6.19, 0.50, 0.03, 84.62),
    TableRow(False, None, 47.99, 1.04, 1.00, 5.47, 0.41, 0.03, 87.62),
)
BELT = {"length": 0.3048, "area": 1.242e-5, "radius": 0.0254}  # L₀, m; A, printed as "1.242 m⁻⁵", m²; r, m
BELT_MODULUS = (13.8e6, 20.7e6)  # E of neoprene, Pa


@dataclass(frozen=True)
class Ratios:
    """Standard deviations of an estimate relative to that of the stiffness; they do not depend on the noise.

    Attributes:
        row: row of Table 4.1.
        printed: σ_RA/σ_k in rad² per N·m, and σ_b/σ_k in s, from the table.
        spring_zero: the same ratios computed with RA as the spring's zero.
        static_rest: the same ratios computed with RA as the angle at rest.
    """

    row: TableRow
    printed: tuple[float, float]
    spring_zero: tuple[float, float]
    static_rest: tuple[float, float]


def average(motor: bool) -> TableRow:
    """Returns the mean of the rows of Table 4.1 with the motor, or without."""
    rows = [row for row in TABLE_4_1 if row.motor == motor]
    return TableRow(motor, None, *(fmean(getattr(row, name) for row in rows) for name in COLUMNS))


def motor_effect(column: str) -> float:
    """Returns the mean difference that the motor makes to a column of Table 4.1."""
    return float(getattr(average(True), column) - getattr(average(False), column))


def motor_effect_in_deviations() -> float:
    """Returns the stiffness difference by the motor, weighted by inverse variances, over its standard deviation."""
    (engaged, first), (disengaged, second) = weighted_stiffness(True), weighted_stiffness(False)
    return (engaged - disengaged) / float(np.hypot(first, second))


def weighted_stiffness(motor: bool) -> tuple[float, float]:
    """Returns the mean of k_rot weighted by inverse variances, and its standard deviation, in N·m/rad."""
    rows = [row for row in TABLE_4_1 if row.motor == motor]
    weights = np.array([row.sigma_stiffness**-2 for row in rows])
    mean = weights @ [row.stiffness for row in rows] / weights.sum()
    return float(mean), float(weights.sum() ** -0.5)


def deviation_ratios(duration: float = 3.0, rate: float = 1000.0) -> list[Ratios]:
    """Returns the ratios of the standard deviations of Table 4.1, as printed and by the two readings of RA.

    They hold for least squares with white residuals and a known start, over `duration` seconds of the release.
    """
    t = np.arange(round(duration * rate)) / rate
    found = []
    for row in TABLE_4_1:
        computed = [_ratios(row, t, static) for static in (False, True)]
        printed = row.sigma_rest_angle / row.sigma_stiffness, row.sigma_damping / row.sigma_stiffness
        found.append(Ratios(row, printed, *computed))
    return found


def _ratios(row: TableRow, t: np.ndarray, static: bool) -> tuple[float, float]:
    leg = spear_ii(15.0 if row.motor else None)
    knee = PassiveKnee(row.stiffness, row.damping, 0.0, row.rest_angle)
    if static:
        knee = rest_at(leg, knee, row.rest_angle)
    jacobian = move(
        leg, knee, find_pushed_angle(leg, knee, row.depth or 0.0), t, ("stiffness", "damping", "zero")
    ).sensitivity
    if static:  # the zero is RA + Sᵀ G(RA) / k
        gravity, slope = leg.motion_with_slopes(row.rest_angle)[[2, 5]]
        jacobian = jacobian @ np.array(
            [[1, 0, 0], [0, 1, 0], [-gravity / knee.stiffness**2, 0, 1 + slope / knee.stiffness]]
        )
    deviation = np.sqrt(np.diag(np.linalg.inv(jacobian.T @ jacobian)))
    return float(deviation[2] / deviation[0]), float(deviation[1] / deviation[0])
