"""The former place of `torque_speed`, which is now in `spear_pin.viz.plots.design`."""

from spear_pin.viz.plots.design import torque_speed

__all__ = ["torque_speed"]
