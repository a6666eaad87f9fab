"""Columns of a trajectory over time, those of the same unit in one panel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.hybrid.trajectory_parts import gaps
from spear_pin.hybrid.trajectory_tables import chosen
from spear_pin.kinds import typed
from spear_pin.viz.plots.panels import label_columns, over
from spear_pin.viz.plots.paper import Picture, style

DEFAULT = ("q", "force_z")
QUANTITIES = {
    "m": "Position",
    "rad": "Angle",
    "m/s": "Velocity",
    "rad/s": "Angular velocity",
    "m/s²": "Acceleration",
    "rad/s²": "Angular acceleration",
    "N": "Force",
    "N·m": "Torque",
    "A": "Current",
}
WIDTH, MARGIN, PANEL = 5.2, 0.4, 1.35  # in


@typed
def over_time(trajectory: Trajectory, columns: Sequence[str] = ()) -> Figure:
    """Columns over time, stance shaded.

    Args:
        trajectory: whose they are.
        columns: as of `Trajectory.plot`.

    Raises:
        UnknownName: there is no such column.
        BadValue: there are less than two samples.
    """
    names, table = trajectory.columns()
    units, wanted = trajectory.units(), chosen(names, tuple(columns) or DEFAULT)
    panels = list(dict.fromkeys(units[name] for name in wanted))
    breaks = gaps(trajectory) + 1  # a line is not drawn across what is left out
    t = np.insert(trajectory.t, breaks, np.nan)
    with style():
        size = (WIDTH, MARGIN + PANEL * len(panels))
        figure = Picture(figsize=size, layout="constrained")
        for axes, unit in zip(figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0], panels, strict=True):
            over(axes, trajectory, f"{QUANTITIES.get(unit, 'Value')} ({unit})")
            axes.set_xlabel("")
            for name in (each for each in wanted if units[each] == unit):
                axes.plot(t, np.insert(table[:, names.index(name)], breaks, np.nan), label=name)
            label_columns(axes)
        axes.set_xlabel("Time (s)")
        figure.align_ylabels()
        return figure
