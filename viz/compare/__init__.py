"""Comparison page for gaits, motions, springs and robots."""

from spear_pin.viz.compare.comparison import Comparison, compare

__all__ = ["Comparison", "compare"]
