"""The former place of `sweep_map`, which is now in `spear_pin.viz.plots.sweep`."""

from spear_pin.viz.plots.sweep import sweep_map

__all__ = ["sweep_map"]
