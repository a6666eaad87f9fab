"""Plots of the design studies: torques with and without springs, drives, families of gaits.

In the style of `plots`; torques are those of one motor.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib import colormaps
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import LEGS
from spear_pin.gaits.gait import Gait
from spear_pin.model.catalogue import MOTORS
from spear_pin.model.motor import Drive
from spear_pin.model.variants import PARAMETERS
from spear_pin.studies.design import STIFFNESSES, Member, Points, against, points, spring_sweep
from spear_pin.viz.plots.bound import COLORS, SHADES
from spear_pin.viz.plots.paper import (
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
    Picture,
    legend_above,
    style,
    with_unit,
)

FRONT_FIRST = LEGS[::-1]  # as the source has its panels
DRIVES = (GREEN, PURPLE, ORANGE, SKY, "black")  # colours of drives, none of them a leg's
RELIED_ON = ("torque_constant", "resistance", "nominal_torque", "nominal_current", "nominal_voltage")
UNITS = {  # of what of a request a family may vary; those of a robot are in `PARAMETERS`
    "speed": "m/s",
    "minimum_force": "N",
    "clearance": "m",
    "minimum_stride": "s",
    "minimum_stance": "s",
    "minimum_knee_torque": "N·m",
    "hip_torque": "N·m",
    "stiffness": "N·m/rad",
    "virtual_stiffness": "N·m/rad",
    "knee_touchdown": "rad",
}


def compliance(gait: Gait, stiffness: float = 56.0) -> Figure:
    """Plots the torque of a knee motor with the spring and without, of front and back legs, as in Fig. 5.5.

    Args:
        gait: a bounding gait.
        stiffness: stiffness of a leg's spring, in N·m/rad.
    """
    sweep = spring_sweep(gait, (0.0, stiffness))
    with style():
        figure = Picture(figsize=(7.0, 2.3), layout="constrained")
        for axes, leg in zip(figure.subplots(1, 2), FRONT_FIRST, strict=True):
            _over_stride(axes, sweep[0.0], leg, "knee")
            _plot(axes, sweep[0.0], leg, "--", color=VERMILLION, label="without a spring")
            _plot(axes, sweep[stiffness], leg, color=BLUE, label=f"with {stiffness:g} N·m/rad")
            legend_above(axes, 3)
        return figure


def stiffness_sweep(gait: Gait, stiffnesses: Sequence[float] = STIFFNESSES) -> Figure:
    """Plots a knee motor's torque in stance with other springs and the same motion, as in Fig. 5.6.

    Args:
        gait: a bounding gait.
        stiffnesses: stiffnesses of a leg's spring, in N·m/rad.
    """
    if not len(stiffnesses):
        raise BadValue("stiffnesses", stiffnesses, "at least one")
    sweep = spring_sweep(gait, stiffnesses)
    colors = colormaps["cividis"](np.linspace(0.0, 0.8, len(sweep)))
    with style():
        figure = Picture(figsize=(7.0, 2.6), layout="constrained")
        panels = figure.subplots(1, 2)
        for axes, leg in zip(panels, FRONT_FIRST, strict=True):
            i = LEGS.index(leg)
            for (stiffness, given), color in zip(sweep.items(), colors, strict=True):
                bears = given.bears[:, i]
                time, torque = 1e3 * given.since[bears, i], given.torque[bears, i]
                axes.plot(time, torque, "-" if stiffness else "--", color=color, label=f"{stiffness:g}")
                _end_label(axes, time, torque, f"{stiffness:g}", color)
            axes.axhline(0.0, color="0.6", linewidth=0.5)
            axes.set_facecolor(SHADES[leg])
            axes.set_xlabel("Time since touchdown (ms)")
            axes.set_ylabel(f"{leg.capitalize()} knee motor (N·m)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, title="Spring of a leg (N·m/rad)", loc="outside upper center", ncols=len(sweep))
        return figure


def hip_torques(gait: Gait) -> Figure:
    """Plots the torque of a hip motor, of front and back legs, as in Fig. 5.7; its root mean square is dashed."""
    given = points(gait, "hip")
    with style():
        figure = Picture(figsize=(7.0, 2.3), layout="constrained")
        for axes, leg in zip(figure.subplots(1, 2, sharey=True), FRONT_FIRST, strict=True):
            _over_stride(axes, given, leg, "hip")
            _plot(axes, given, leg, color=BLUE, label="motor")
            rms = given.rms[LEGS.index(leg)]
            axes.axhline(rms, linestyle="--", color=VERMILLION, label=f"root mean square, {rms:.0f} N·m")
            axes.axhline(-rms, linestyle="--", color=VERMILLION)
            legend_above(axes, 3)
        return figure


def torque_speed(gait: Gait, drives: Mapping[str, Drive], part: str = "knee") -> Figure:
    """Plots operating points with drives, as in Fig. 5.8: a drive's limits are solid, continuous ones dashed.

    Speed is counted along the torque, so that braking is on the left, where an envelope is wider. Points that a drive
    cannot reach are ringed in its colour; above the no-load speed the torque may be too small as well as too large. The
    legend says how the numbers of each motor were verified.

    Args:
        gait: a bounding gait.
        drives: drives by name.
        part: "knee" or "hip".

    Raises:
        BadValue: there are no drives, or more than five.
    """
    if not 0 < len(drives) <= len(DRIVES):
        raise BadValue("drives", list(drives), f"one to {len(DRIVES)} drives")
    given = points(gait, part)
    torque = np.abs(given.torque)
    along = np.where(given.torque == 0.0, np.abs(given.speed), np.sign(given.torque) * given.speed)
    fastest = 1.08 * np.abs(along).max()
    with style():
        figure = Picture(figsize=(5.2, 4.0), layout="constrained")
        axes = figure.subplots()
        for size, (color, (name, drive)) in enumerate(zip(DRIVES, drives.items(), strict=False)):
            use = against(given, drive)
            _envelope(axes, drive, fastest, color)
            axes.plot([], [], color=color, label=f"{name}: {_verified(drive)}")  # for the legend
            out = use.margin < 0.0
            axes.plot(
                along[out], torque[out], "o", markersize=4.5 + 2.0 * size, markerfacecolor="none",
                markeredgecolor=color, markeredgewidth=0.6, gid=f"outside {name}",
            )  # fmt: skip
        for i, leg in enumerate(LEGS):
            for bears, marker, where in ((True, "x", "stance"), (False, ".", "flight")):
                chosen = given.bears[:, i] == bears
                axes.plot(
                    along[chosen, i], torque[chosen, i], marker, markersize=2.6, markeredgewidth=0.6,
                    color=COLORS[leg] if bears else "0.6" if leg == "posterior" else "0.3", label=f"{leg}, {where}",
                )  # fmt: skip
        axes.plot([], [], "o", markerfacecolor="none", markeredgecolor="0.4", label="outside, in the drive's colour")
        axes.plot([], [], "--", color="0.4", linewidth=0.8, label="continuous limits")
        axes.axvline(0.0, color="0.6", linewidth=0.5)
        axes.set_xlim(-fastest, fastest)
        axes.set_ylim(0.0, 1.5 * torque.max())
        axes.set_xlabel(f"Braking   |   Speed of the {part} along the torque (rad/s)   |   Driving")
        axes.set_ylabel(f"Torque of a {part} motor (N·m)")
        figure.legend(loc="outside upper left", ncols=2)
        return figure


def family_plot(members: Sequence[Member], name: str) -> Figure:
    """Plots peak torques, stride and largest multiplier over a family of gaits; a cross where none was found.

    Args:
        members: members of the family.
        name: name of the varied number, a numeric field of `Request` or a parameter of the robot.

    Raises:
        BadValue: there is no gait among them.
    """
    found = sorted((member for member in members if member.gait is not None), key=lambda member: member.value)
    gaits = [member.gait for member in found if member.gait is not None]
    if not gaits:
        raise BadValue("members", len(members), "at least one with a gait")
    values = np.array([member.value for member in found])
    knees = np.array([points(gait, "knee").peak for gait in gaits])
    hips = np.array([np.abs(points(gait, "hip").torque).max(axis=0) for gait in gaits])
    with style():
        figure = Picture(figsize=(7.0, 3.6), layout="constrained")
        (knee, hip), (stride, largest) = axes = figure.subplots(2, 2, sharex=True)
        for i, leg in enumerate(LEGS):
            knee.plot(values, knees[:, i], "o-", color=COLORS[leg], label=leg)
            hip.plot(values, hips[:, i], "o-", color=COLORS[leg], label=leg)
        periods = [1e3 * gait.period for gait in gaits]
        stride.plot(values, periods, "o-", color="black")
        if np.ptp(periods) < 0.1 * max(periods):  # else noise would look like a trend
            stride.set_ylim(0.9 * min(periods), 1.1 * max(periods))
        largest.plot(values, [abs(gait.multipliers[0]) for gait in gaits], "o-", color="black")
        largest.axhline(1.0, color="0.6", linewidth=0.5)
        labels = ("Knee, peak in stance (N·m)", "Hip, peak (N·m)", "Stride (ms)", "Largest multiplier")
        lost = [member.value for member in members if member.gait is None]
        for panel, label in zip(axes.flat, labels, strict=True):
            panel.set_ylabel(label)
            panel.margins(x=0.05)
            if lost:
                at_bottom = panel.get_xaxis_transform()
                panel.plot(lost, np.full(len(lost), 0.05), "x", color="0.4", transform=at_bottom, label="none found")
        for panel in (stride, largest):
            panel.set_xlabel(with_unit(name, _unit(name)))
        for panel in (knee, hip):
            legend_above(panel, 3)
        return figure


# what the panels share


def _over_stride(axes: Axes, given: Points, leg: str, part: str) -> None:
    for i, name in enumerate(LEGS):
        times = 1e3 * given.t[given.bears[:, i]]
        if len(times):
            axes.axvspan(times[0], times[-1], color=SHADES[name], zorder=0, gid=f"{name}_stance")
    axes.axhline(0.0, color="0.6", linewidth=0.5)
    axes.set_xlim(1e3 * given.t[0], 1e3 * given.t[-1])
    axes.set_xlabel("Time (ms)")
    axes.set_ylabel(f"{leg.capitalize()} {part} motor (N·m)")


def _plot(axes: Axes, given: Points, leg: str, line: str = "-", *, color: str, label: str) -> None:
    """Plots a line over the stride, interrupted at events, where the torque jumps."""
    jumps = np.flatnonzero(np.diff(given.t) == 0.0) + 1
    torque = given.torque[:, LEGS.index(leg)]
    axes.plot(np.insert(1e3 * given.t, jumps, np.nan), np.insert(torque, jumps, np.nan), line, color=color, label=label)


def _end_label(axes: Axes, time: Array, torque: Array, text: str, color: tuple[float, ...]) -> None:
    """Writes the name of a curve where it is farthest from both its ends."""
    at = int(np.argmax(np.abs(torque - 0.5 * (torque[0] + torque[-1]))))
    if np.ptp(torque) < 1.0:
        at = len(torque) // 2
    axes.annotate(text, (time[at], torque[at]), (0, 1.5), textcoords="offset points", color=color, fontsize=6.5)


def _envelope(axes: Axes, drive: Drive, fastest: float, color: str) -> None:
    if drive.motor.max_speed is not None:
        fastest = min(fastest, drive.motor.max_speed / drive.gearbox.ratio)
    speeds = np.linspace(-fastest, fastest, 401)
    most = drive.envelope(speeds)
    axes.plot(speeds, np.where(most >= 0.0, most, np.nan), color=color)
    least = -drive.envelope(-speeds)  # above the no-load speed it brakes at least this much
    axes.plot(speeds, np.where(least > 0.0, least, np.nan), color=color)
    torque, speed = drive.continuous_torque, drive.continuous_speed
    axes.plot([-speed, -speed, speed, speed], [0.0, torque, torque, 0.0], "--", color=color, linewidth=0.8)


def _verified(drive: Drive) -> str:
    """Returns the verification of the numbers of a drive's motor that its envelope uses."""
    entry = MOTORS.get(drive.motor.name, {})
    kinds = []
    for field in RELIED_ON:
        value = getattr(drive.motor, field)
        if value is not None:
            known = field in entry and entry[field].value == value
            kinds.append(entry[field].verification if known else "given by hand")
    return ", ".join(dict.fromkeys(kinds))


def _unit(name: str) -> str:
    return PARAMETERS[name].unit if name in PARAMETERS else UNITS.get(name, "1")
