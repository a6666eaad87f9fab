"""A bound: its figures per stride, and its speed."""

from spear_pin.studies.bound.figures import summarize
from spear_pin.studies.bound.held import list_active_bounds
from spear_pin.studies.bound.of_another import bound_of, springs_of
from spear_pin.studies.bound.speed import at_speed, mean_speed

__all__ = ["at_speed", "bound_of", "list_active_bounds", "mean_speed", "springs_of", "summarize"]
