"""Comparison of gaits, motions, springs and robots: measures, differences, and sentences about them."""

from spear_pin.studies.comparison.differences import (
    ComparedMeasure,
    Difference,
    compare_measures,
    describe_differences,
    differences,
)
from spear_pin.studies.comparison.sides import MOST, Side, read, sides_of

__all__ = [
    "MOST",
    "Difference",
    "ComparedMeasure",
    "Side",
    "differences",
    "compare_measures",
    "read",
    "describe_differences",
    "sides_of",
]
