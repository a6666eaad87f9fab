"""Comparison of gaits, motions, springs and robots: measures, differences, and sentences about them."""

from spear_pin.studies.comparison.differences import Difference, Measure, describe_differences, differences, measures
from spear_pin.studies.comparison.sides import MOST, Side, read, sides_of

__all__ = [
    "MOST",
    "Difference",
    "Measure",
    "Side",
    "differences",
    "measures",
    "read",
    "describe_differences",
    "sides_of",
]
