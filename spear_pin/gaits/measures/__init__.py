"""Measures of a cycle: the meaning of each name in one table, and values from the samples of a motion."""

from spear_pin.gaits.measures.catalogue import Measure, measures, register

__all__ = ["Measure", "measures", "register"]
