"""Comparison of gaits, motions, springs and robots: measures, differences, and sentences about them."""

from spear_pin.studies.comparison.differences import Difference, Measure, differences, measures, said
from spear_pin.studies.comparison.sides import MOST, Side, read, sides_of

__all__ = ["MOST", "Difference", "Measure", "Side", "differences", "measures", "read", "said", "sides_of"]
