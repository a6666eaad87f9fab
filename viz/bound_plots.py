"""The former place of `bound_summary`, which is now in `spear_pin.viz.plots.bound`."""

from spear_pin.viz.plots.bound import bound_summary

__all__ = ["bound_summary"]
