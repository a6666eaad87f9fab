"""Continuation: branches of periodic gaits over one number, by arc length."""

from spear_pin.gaits.continuation.branch import BorderPoint, Branch, End, SpecialPoint
from spear_pin.gaits.continuation.continuing import continue_gait

__all__ = ["BorderPoint", "Branch", "End", "SpecialPoint", "continue_gait"]
