"""Gaits, motions, springs and robots beside one another, on a page of their own."""

from spear_pin.viz.compare.comparison import Comparison, compare

__all__ = ["Comparison", "compare"]
