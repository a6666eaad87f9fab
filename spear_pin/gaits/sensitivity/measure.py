"""A measure of a cycle with its derivatives, and what of it is rounding."""

from __future__ import annotations

from dataclasses import dataclass

from spear_pin.arrays import Array

MULTIPLIER = "multiplier_"
ROUNDING, ROOT = 1e-12, 1e-6  # in units of an output; repeated zero multipliers keep a root of rounding


def estimate_rounding(output: str) -> float:
    """Returns the modulus up to which an output counts as zero, because of rounding, in the output's unit."""
    return ROOT if output.startswith(MULTIPLIER) else ROUNDING


@dataclass(frozen=True)
class DualMeasure:
    """A measure of a cycle.

    Attributes:
        value: value in the measure's unit.
        derivative: along each direction, (c,).
        unit: the measure's unit.
    """

    value: float
    derivative: Array
    unit: str


def ratio(above: DualMeasure, below: DualMeasure, unit: str) -> DualMeasure:
    """Returns the ratio of two measures, in a given unit."""
    value = above.value / below.value
    return DualMeasure(value, (above.derivative - value * below.derivative) / below.value, unit)
