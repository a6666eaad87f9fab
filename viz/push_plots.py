"""The former place of `fit_summary`, which is now in `spear_pin.viz.plots.identification`."""

from spear_pin.viz.plots.identification import fit_summary

__all__ = ["fit_summary"]
