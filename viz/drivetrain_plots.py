"""The former place of `drivetrain`, which is now in `spear_pin.viz.plots.drivetrain`."""

from spear_pin.viz.plots.drivetrain import drivetrain

__all__ = ["drivetrain"]
