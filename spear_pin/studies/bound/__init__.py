"""A bound: its figures per stride, and its speed."""

from spear_pin.studies.bound.figures import summarize, weight
from spear_pin.studies.bound.of_another import bound_of
from spear_pin.studies.bound.speed import at_speed, mean_speed

__all__ = ["at_speed", "bound_of", "mean_speed", "summarize", "weight"]
