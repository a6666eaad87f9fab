"""The page of a payoff study: the answer, the maps, two motions for comparison, every point, and the doubts."""

from spear_pin.viz.payoff.page import as_json, render

__all__ = ["as_json", "render"]
