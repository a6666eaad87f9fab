"""Plots for figures and tables of the source: spring, balance, model, geometry, bridge, estimates."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from spear_pin.errors import BadValue
from spear_pin.model.bridge import STATES, Battery, Bridge, back_emf, conduction_threshold, idle_current
from spear_pin.model.motor import Motor
from spear_pin.studies.audit.printed_designs import SPEAR_I, SPEAR_II
from spear_pin.studies.audit.printed_equations import effective_inertia, gravity_torque
from spear_pin.studies.audit.printed_estimates import TABLE_4_1, TABLE_4_2, TableRow, average
from spear_pin.studies.audit.switch import torques
from spear_pin.studies.identification import QUANTITIES
from spear_pin.studies.push_test import DEPTHS, WITH_MOTOR, equilibrium, find_pushed_angle, spear_ii
from spear_pin.studies.push_test.power_off import PowerOff
from spear_pin.viz.plots.identification import mathematical
from spear_pin.viz.plots.paper import BLUE, GREEN, PURPLE, VERMILLION, Picture, legend_above, style
from spear_pin.viz.plots.push import ANGLE, TIME

METRICS = {  # rows of Table 2.4 that are to be small, with their labels
    "leg_mass": "leg, mass",
    "thigh_mass": "thigh, mass",
    "shank_mass": "shank, mass",
    "thigh_inertia": "thigh, inertia",
    "shank_inertia": "shank, inertia",
    "thigh_com": "thigh, distance of c.o.m.",
    "shank_com": "shank, distance of c.o.m.",
    "hip_inertia": "hip, rotor inertia",
    "knee_inertia": "knee, rotor inertia",
    "thigh_width": "thigh, width",
}
CASES = (GREEN, VERMILLION, BLUE, PURPLE)  # of the motor that idles: no motor, off, on, shorted
PLACES = (0.0, 1.0, 2.0, 3.4, 5.0)  # of three depths, their mean and the printed one
ASIDE = 0.1  # of a place, by which the belt on and off lie apart


def switched_spring(latched: float = 0.3) -> Figure:
    """Plots the torque on the joint with the key engaged at an angle, and without, as in Fig. 2.1.

    Args:
        latched: angle at which the key engages, in rad.
    """
    angles = np.linspace(0.0, 1.2, 241)
    engaged, disengaged = torques(angles, latched)
    with style():
        figure = Picture(layout="constrained")
        axes = figure.subplots()
        axes.plot(angles, engaged, color=BLUE, label="key engaged: $S_1$")
        axes.plot(angles, disengaged, "--", color=VERMILLION, label="disengaged: $S_1$ and $S_2$ in series")
        axes.axvline(latched, color="0.6", linewidth=0.5)
        axes.annotate("latched", (latched, engaged.max()), (3, -6), textcoords="offset points", fontsize=7.5)
        axes.set_xlabel(ANGLE)
        axes.set_ylabel("Torque against flexion (N·m)")
        legend_above(axes, 1)
        return figure


def design_metrics() -> Figure:
    """Plots each number of Table 2.4 over that of Table 2.2: left of the line it has become smaller."""
    ratios = np.array([getattr(SPEAR_II, name) / getattr(SPEAR_I, name) for name in METRICS])
    at = np.arange(len(METRICS))
    with style():
        figure = Picture(figsize=(4.6, 2.8), layout="constrained")
        axes = figure.subplots()
        axes.barh(at, ratios - 1.0, 0.6, 1.0, color=[BLUE if ratio <= 1.0 else VERMILLION for ratio in ratios])
        axes.axvline(1.0, color="black", linewidth=0.6)
        for place, ratio in zip(at, ratios, strict=True):
            side = -1.0 if ratio < 1.0 else 1.0
            axes.annotate(
                f"{ratio:.2f}", (ratio, place), (3 * side, 0), textcoords="offset points", va="center", fontsize=7.5,
                ha="right" if side < 0 else "left",
            )  # fmt: skip
        axes.set_xscale("log")
        axes.set_xlim(0.05, 6.0)
        axes.set_xticks([0.1, 0.5, 1.0, 2.0, 5.0], ["0.1", "0.5", "1", "2", "5"])
        axes.set_yticks(at, list(METRICS.values()))
        axes.invert_yaxis()
        axes.set_xlabel("SPEAR-II over SPEAR-I")
        return figure


def balance() -> Figure:
    """Plots thigh and centre of mass about the hip, of both robots, as in Fig. 2.9; both with SPEAR-II's length."""
    length = 0.318
    with style():
        figure = Picture(figsize=(3.4, 2.6), layout="constrained")
        panels = figure.subplots(1, 2, sharey=True)
        for axes, (name, design) in zip(panels, {"SPEAR-I": SPEAR_I, "SPEAR-II": SPEAR_II}.items(), strict=True):
            axes.plot([0.0, 0.0], [0.0, -length], color="0.75", linewidth=6.0, solid_capstyle="round", zorder=1)
            axes.plot(0.0, 0.0, "o", color="white", markeredgecolor="black", markersize=6.0, zorder=2)
            axes.plot(0.0, -design.thigh_com, "P", color=VERMILLION, markersize=6.0, zorder=3)
            label = f"{1e3 * design.thigh_com:g} mm"
            axes.annotate(label, (0.0, -design.thigh_com), (9, -3), textcoords="offset points", color=VERMILLION)
            axes.set_title(name)
            axes.set_aspect("equal")
            axes.set_xlim(-0.12, 0.12)
            axes.set_ylim(-length - 0.05, 0.05)
            axes.set_xticks([])
        panels[0].set_ylabel("Height above the hip (m)")
        return figure


def printed_model() -> Figure:
    """Plots the knee's effective inertia and weight torque by (3.14) and (3.15), as printed and corrected."""
    angles = np.linspace(0.2, 1.8, 65)
    quantities = {
        "Effective inertia (kg·m²)": np.array([effective_inertia(angle) for angle in angles]),
        "Torque of the weight (N·m)": np.array([gravity_torque(angle) for angle in angles]),
    }
    with style():
        figure = Picture(figsize=(7.0, 2.3), layout="constrained")
        for axes, (label, values) in zip(figure.subplots(1, 2), quantities.items(), strict=True):
            axes.plot(angles, values[:, 1], color=BLUE, label="corrected")
            axes.plot(angles, values[:, 0], "--", color=VERMILLION, label="as printed")
            axes.set_xlabel(ANGLE)
            axes.set_ylabel(label)
            axes.set_ylim(bottom=0.0)
            legend_above(axes, 2)
        return figure


def crank_slider() -> Figure:
    """Plots the leg at rest and at each depth, and height and hip over the knee, as in Figs. 4.2 and 4.3."""
    leg, length = spear_ii(), 0.318
    rest = equilibrium(leg, WITH_MOTOR)
    poses = {"at rest": rest} | {f"{100 * d:g} cm": find_pushed_angle(leg, WITH_MOTOR, d) for d in DEPTHS}
    angles = np.linspace(0.0, 1.9, 96)
    with style():
        figure = Picture(figsize=(7.0, 2.6), layout="constrained")
        drawn, height, hip = figure.subplots(1, 3, width_ratios=(0.8, 1.0, 1.0))
        for i, (name, angle) in enumerate(poses.items()):
            y, thigh, _ = leg.configuration(angle)
            knee = (length * np.sin(thigh), y - length * np.cos(thigh))
            shade = str(0.72 - 0.24 * i) if i < 3 else "black"
            drawn.plot([0.0, knee[0], 0.0], [y, knee[1], 0.0], "o-", color=shade, markersize=3.5, label=name)
            height.plot(angle, y, "o", color=shade)
            hip.plot(angle, thigh, "o", color=shade)
        drawn.axhline(0.0, color="0.4", linewidth=1.2)
        drawn.set_aspect("equal")
        drawn.set_xlim(-0.15, 0.35)
        drawn.set_xlabel("Forward (m)")
        drawn.set_ylabel("Height (m)")
        place = leg.configuration(angles)
        for axes, values, label in ((height, place[0], "Height of the hip (m)"), (hip, place[1], "Hip angle (rad)")):
            axes.plot(angles, values, color=BLUE, linewidth=1.0, zorder=1)
            axes.set_xlabel(ANGLE)
            axes.set_ylabel(label)
        figure.legend(*drawn.get_legend_handles_labels(), loc="outside upper left", ncols=len(poses))
        return figure


def power_off_heights(cases: Mapping[str, PowerOff]) -> Figure:
    """Plots the height of the boom after the release with the motor idling, as in Fig. 4.7.

    Args:
        cases: cases by label, from `spear_pin.studies.push_test.power_off.power_off`.

    Raises:
        BadValue: there are no cases, or more than four.
    """
    if not 0 < len(cases) <= len(CASES):
        raise BadValue("cases", list(cases), f"one to {len(CASES)} cases")
    with style():
        figure = Picture(figsize=(4.6, 2.6), layout="constrained")
        axes = figure.subplots()
        for color, (label, case) in zip(CASES, cases.items(), strict=False):
            given = case.release
            hidden = label.endswith("on")  # it lies on the one before
            axes.plot(
                given.t, given.height, "--" if hidden else "-", color=color, label=label, lw=1.6 if hidden else 1.1
            )
        axes.set_xlabel(TIME)
        axes.set_ylabel("Height of the boom (m)")
        legend_above(axes, 2)
        return figure


def bridge_currents(machine: Motor, ratio: float, speeds: tuple[float, float] = (0.0, 25.0)) -> Figure:
    """Plots current and back-EMF of a motor turned from outside by state of its bridge, Figs. 4.8 and 4.9.

    Args:
        machine: needs torque constant and resistance.
        ratio: ratio of its gearbox.
        speeds: least and largest speed of the joint, in rad/s.
    """
    rates = np.linspace(*speeds, 251)
    constant, resistance = machine.known("torque_constant"), machine.known("resistance")
    emf = back_emf(constant, ratio, rates)
    threshold = conduction_threshold(Battery(), Bridge())
    names = {"open": "supply disconnected", "coast": "all switches open", "short": "phases shorted"}
    lines = {"open": ":", "coast": "-", "short": "--"}
    with style():
        figure = Picture(figsize=(7.0, 2.4), layout="constrained")
        volts, amperes = figure.subplots(1, 2)
        volts.plot(rates, emf, color=BLUE, label="back-EMF (4.8)")
        volts.axhline(threshold, color=VERMILLION, linestyle="--", label="battery and two diodes")
        volts.set_ylabel("Back-EMF (V)")
        for state, color in zip(STATES, (GREEN, BLUE, VERMILLION), strict=True):
            current = -idle_current(state, emf, resistance)
            amperes.plot(rates, current, lines[state], color=color, label=names[state])
        amperes.set_ylabel("Braking current (A)")
        for axes in (volts, amperes):
            axes.set_xlabel("Speed of the joint (rad/s)")
            legend_above(axes, 3)
        return figure


def source_comparison() -> Figure:
    """Plots stiffness and damping of Table 4.1 with standard deviations and mean, and the mean of Table 4.2."""
    with style():
        figure = Picture(figsize=(5.4, 4.2), layout="constrained")
        stiffness, damping = figure.subplots(2, 1, sharex=True)
        for motor, color, side, name in ((True, BLUE, -1, "with motor"), (False, VERMILLION, 1, "without motor")):
            rows = [*(row for row in TABLE_4_1 if row.motor == motor), average(motor)]
            printed = next(row for row in TABLE_4_2 if row.motor == motor)
            for panel, column in ((stiffness, "stiffness"), (damping, "damping")):
                _draw_rows(panel, [*rows, printed], column, color, side, name)
        for panel, quantity in ((stiffness, QUANTITIES["stiffness"]), (damping, QUANTITIES["damping"])):
            panel.axvspan(0.5 * (PLACES[2] + PLACES[3]), PLACES[-1] + 1.0, color="0.95", zorder=0)
            panel.set_xlim(-0.5, PLACES[-1] + 0.9)
            panel.set_ylabel(f"{mathematical(quantity.symbol)} ({quantity.unit})")
        depths = [f"{100.0 * row.depth:g}" for row in TABLE_4_1 if row.motor and row.depth is not None]
        damping.set_xticks(PLACES, [*depths, "mean of Table 4.1", "printed in Table 4.2"])
        damping.set_xlabel("Depth of the push (cm)", loc="left")
        figure.legend(*stiffness.get_legend_handles_labels(), loc="outside upper left", ncols=3)
        return figure


def _draw_rows(panel: Axes, rows: Sequence[TableRow], quantity: str, color: str, side: int, name: str) -> None:
    """Draws values of one column of the tables, the last two with numbers: the mean, and its printed value."""
    values = [float(getattr(row, quantity)) for row in rows]
    deviations = [float(getattr(row, f"sigma_{quantity}")) for row in rows]
    places = np.array(PLACES) + side * ASIDE
    panel.errorbar(
        places, values, deviations, fmt="none", ecolor=color, elinewidth=0.8, capsize=2.5, label=f"{name}, ± σ"
    )
    panel.plot(places[:-1], values[:-1], "o", color=color, markersize=4.0, gid=f"table 4.1 {name}")
    panel.plot(places[-1:], values[-1:], "s", color=color, markersize=4.5, gid=f"table 4.2 {name}")
    mean, printed = values[-2:]
    remark = "" if round(mean, 2) == round(printed, 2) else "\nnot the mean"
    for place, value, text in ((places[-2], mean, ""), (places[-1], printed, remark)):
        panel.annotate(
            f"{value:.2f}{text}", (place, value), (6 * side, 0), textcoords="offset points", color=color, fontsize=7.5,
            ha="left" if side > 0 else "right", va="center",
        )  # fmt: skip
