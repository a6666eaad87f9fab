"""Columns of a trajectory over time; columns with the same unit share a panel."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from spear_pin.errors import SpearError, require
from spear_pin.hybrid.column_names import PAIR, of_a_pair, split_column_name
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.hybrid.trajectory_parts import gaps
from spear_pin.hybrid.trajectory_tables import choose_columns
from spear_pin.kinds import typed
from spear_pin.model.chain import CHAIN
from spear_pin.viz.plots.panels import over
from spear_pin.viz.plots.paper import Picture, legend_above, style

DEFAULT = ("q", "spring", "force_z")
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
HANDLE, LETTER = 0.4, 0.065  # in, of a legend


@typed
def over_time(trajectory: Trajectory, columns: Sequence[str] = (), cycles: int | None = None) -> Figure:
    """Plots columns over time, with stance shaded.

    Args:
        trajectory: the trajectory that has the columns.
        columns: names of columns; see `Trajectory.plot`.
        cycles: number of cycles to draw, from the first; None: all.

    Raises:
        UnknownName: there is no such column.
        BadValue: there are less than two samples, or the number of cycles is not positive.
    """
    if cycles is not None:
        require("cycles", cycles, lambda number: number >= 1, "a whole number >= 1, or None for all")
    trajectory, left_out = _beginning(trajectory, cycles)
    names, table = trajectory.columns()
    usual = [group for group in DEFAULT if any(split_column_name(name)[0] == group for name in names)]
    units, wanted = trajectory.units(), choose_columns(names, tuple(columns or usual))
    parts = _parts(trajectory)
    places = {name: (parts.get(split_column_name(name)[1], ""), units[name]) for name in wanted}
    panels = list(dict.fromkeys(places.values()))
    breaks = gaps(trajectory) + 1  # a line is not drawn across what is left out
    t = np.insert(trajectory.t, breaks, np.nan)
    with style():
        size = (WIDTH, MARGIN + PANEL * len(panels))
        figure = Picture(figsize=size, layout="constrained")
        for axes, place in zip(figure.subplots(len(panels), 1, sharex=True, squeeze=False)[:, 0], panels, strict=True):
            (part, unit), drawn = place, [name for name in wanted if places[name] == place]
            pairs = [of_a_pair(name) for name in drawn]
            quantity = f"{part} {QUANTITIES.get(unit, 'Value')}".strip().capitalize()
            over(axes, trajectory, f"{quantity}{PAIR * all(pairs)} ({unit})")
            axes.set_xlabel("")
            for name, paired in zip(drawn, pairs, strict=True):
                label = name + PAIR * (paired and not all(pairs))
                axes.plot(t, np.insert(table[:, names.index(name)], breaks, np.nan), label=label)
            legend_above(axes, _fitting(drawn))
        axes.set_xlabel("Time (s)")
        if left_out:
            figure.suptitle(left_out, x=0.99, horizontalalignment="right", fontsize="x-small", color="0.4")
        figure.align_ylabels()
        return figure


def _parts(trajectory: Trajectory) -> dict[str, str]:
    """Returns the part of a leg that each joint is, for a robot in space; parts of all legs share a panel."""
    if trajectory.coordinates[: len(CHAIN)] != CHAIN:
        return {}
    try:
        legs = trajectory.load_robot().legs
    except (SpearError, ValueError):
        return {}
    named = [{"adduction": leg.abduction, "hip": leg.hip, "knee": leg.knee} for leg in legs]
    return {joint: part for joints in named for part, joint in joints.items() if joint is not None}


def _fitting(labels: Sequence[str]) -> int:
    """Returns the number of columns for a legend of labels, as many as have room."""
    return max(1, min(4, int((WIDTH - MARGIN) / (HANDLE + LETTER * max(map(len, labels))))))


def _beginning(trajectory: Trajectory, cycles: int | None) -> tuple[Trajectory, str]:
    """Returns the first whole cycles of a trajectory, and how to see the rest; all of it if it has no more."""
    there = np.unique(trajectory.cycle[trajectory.cycle > 0])
    if cycles is None or len(there) <= cycles:
        return trajectory, ""
    first, last = int(there[0]), int(there[cycles - 1])
    said = f"cycle {first}" if first == last else f"cycles {first} to {last}"
    return trajectory.in_cycles(first, last), f"{said} of {len(there)}; plot(…, cycles=None) shows all"
