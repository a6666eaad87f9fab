"""Panels of a trajectory, each drawn into given axes, within `paper.style`; stance is shaded."""

from __future__ import annotations

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.container import Container
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.hopping import HoppingLaw
from spear_pin.hybrid.column_names import PAIR, of_a_pair
from spear_pin.hybrid.ground import Ground
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.hybrid.trajectory_parts import gaps
from spear_pin.viz.plots.paper import BLUE, GREEN, ORANGE, PURPLE, SKY, STANCE, STANCE_COLOR, VERMILLION, legend_above

Span = tuple[int, int]  # first and last sample

LINES = ("-", "--", ":", "-.")  # of one toe after the other
FLOWS = {  # label and colour of the energy flows, in the order of stacking
    "motor_knee": ("knee motor", BLUE),
    "motor_hip": ("hip motor", SKY),
    "damping": ("damping", VERMILLION),
    "impact": ("impact", ORANGE),
    "released": ("spring let go", PURPLE),
    "slip": ("slip", GREEN),
    "friction": ("joint friction", "0.5"),
}
NEGLIGIBLE = 1e-3  # of the largest flow: too little to be seen


def draw_angle(axes: Axes, trajectory: Trajectory, joint: str, gait: Gait | None) -> None:
    """Draws the angle of a joint over time, with the angles commanded in flight and latched in stance."""
    index = _row(trajectory, joint)
    over(axes, trajectory, f"{_words(joint)} angle (rad)")
    axes.plot(trajectory.t, trajectory.q[:, index], color=BLUE, label="simulated")
    if gait is not None:
        _levels(axes, trajectory, _commanded(trajectory, joint, gait), "--", "commanded")
    if joint in trajectory.spring_joints:
        engaged = trajectory.engaged[:, trajectory.spring_joints.index(joint)]
        spans = _runs(trajectory, _bears(trajectory) & engaged)
        latched = [(span, float(trajectory.q[span[0], index])) for span in spans]
        _levels(axes, trajectory, latched, ":", "latched")
    legend_above(axes)


def draw_force(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the ground force over time."""
    pairs = all(of_a_pair(f"force_z_{toe}") for toe in trajectory.toes)
    over(axes, trajectory, f"Ground force{PAIR * pairs} (N)")
    for index, toe in enumerate(trajectory.toes):
        of_toe = f" of {toe.replace('_', ' ')}" if len(trajectory.toes) > 1 else ""
        *tangential, normal = trajectory.force[:, index].T
        along = tangential[0] if len(tangential) == 1 else np.hypot(*tangential)
        for force, color, label in ((normal, BLUE, "normal"), (along, VERMILLION, "tangential")):
            axes.plot(trajectory.t, force, LINES[index % len(LINES)], color=color, label=label + of_toe)
    legend_above(axes, 4 if len(trajectory.toes) == 1 else 2)


def _row(trajectory: Trajectory, joint: str) -> int:
    """Returns the row of a joint in q.

    Raises:
        UnknownName: the robot has no such joint.
    """
    if joint not in trajectory.coordinates:
        raise UnknownName("joint", joint, trajectory.coordinates)
    return trajectory.coordinates.index(joint)


def draw_torque(axes: Axes, trajectory: Trajectory, joint: str = "knee") -> None:
    """Draws the torques on a knee over time."""
    _row(trajectory, joint)
    motor = trajectory.u[:, trajectory.actuated.index(joint)]
    sprung = joint in trajectory.spring_joints
    spring = trajectory.spring[:, trajectory.spring_joints.index(joint)] if sprung else 0.0 * motor
    total = trajectory.tau[:, trajectory.actuated.index(joint)]
    over(axes, trajectory, f"{_words(joint)} torque{PAIR * of_a_pair(f'u_{joint}')} (N·m)")
    axes.axhline(0.0, color="0.6", linewidth=0.5)
    axes.plot(trajectory.t, motor, color=BLUE, label="motor")
    axes.plot(trajectory.t, spring, color=GREEN, label="spring")
    axes.plot(trajectory.t, total - motor - spring, color=VERMILLION, label="damping")
    legend_above(axes)


def draw_energy(axes: Axes, trajectory: Trajectory, cycle: str = "Hop") -> None:
    """Draws the energy ledger, hop by hop; the motors of several legs are summed."""
    ledger = trajectory.ledger
    if trajectory.cycles == 0:
        raise BadValue("trajectory.cycles", 0, "at least one whole hop")
    hops = np.arange(1, trajectory.cycles + 1)
    floor = NEGLIGIBLE * float(np.abs(ledger.work).max())
    top, bottom = np.zeros(len(hops)), np.zeros(len(hops))
    handles: list[Artist | Container] = []
    flows: dict[str, NDArray[np.float64]] = {}
    for flow in ledger.kinds:
        kind = _of_all_legs(flow)
        flows[kind] = flows.get(kind, 0.0) + ledger[flow]
    for flow in sorted(flows, key=lambda name: list(FLOWS).index(name) if name in FLOWS else len(FLOWS)):
        energy = flows[flow]
        if np.abs(energy).max() <= floor:
            continue
        label, color = FLOWS.get(flow, (flow.replace("_", " "), "0.7"))
        gain, loss = np.maximum(energy, 0.0), np.minimum(energy, 0.0)
        # two bars, for a flow may change its sign from hop to hop
        handles.append(axes.bar(hops, gain, 0.7, top, color=color, label=label))
        axes.bar(hops, loss, 0.7, bottom, color=color)
        top, bottom = top + gain, bottom + loss
    handles += axes.plot(hops, ledger.change, "D", color="black", markersize=2.5, label="stored")
    axes.axhline(0.0, color="black", linewidth=0.6)
    axes.set_xlim(0.4, len(hops) + 0.6)
    axes.set_ylim(1.1 * min(float(bottom.min()), float(ledger.change.min())), 1.1 * float(top.max()))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True, nbins=12))
    axes.set_xlabel(cycle)
    axes.set_ylabel("Energy (J)")
    legend_above(axes, 3, handles=handles)


def draw_height(axes: Axes, trajectory: Trajectory, coordinate: str = "boom_z") -> None:
    """Draws the height of the hip over time."""
    rise = trajectory.coordinates.index(coordinate)
    apexes = trajectory.named("apex")
    over(axes, trajectory, "Height of the hip (m)")
    axes.plot(trajectory.t, trajectory.q[:, rise], color=BLUE, label="hip")
    if apexes:
        axes.plot([e.time for e in apexes], [e.q[rise] for e in apexes], "o", color=VERMILLION, label="apex")
    legend_above(axes)


def draw_clearance(axes: Axes, trajectory: Trajectory) -> None:
    """Draws the height of the toes above the ground over time."""
    robot = trajectory.load_robot()
    over(axes, trajectory, "Clearance (mm)")
    ground = trajectory.ground or Ground()
    for index, toe in enumerate(trajectory.toes):
        heights = np.array([ground.foot(robot, q, toe)[0] for q in trajectory.q])
        axes.plot(trajectory.t, 1e3 * heights, LINES[index % len(LINES)], color=GREEN, label=toe.replace("_", " "))
    if len(trajectory.toes) > 1:
        legend_above(axes)


def over(axes: Axes, trajectory: Trajectory, label: str) -> None:
    """Prepares axes for curves over the time of a trajectory: its stances, its limits, its labels."""
    if len(trajectory.t) < 2:
        raise BadValue("trajectory.t", trajectory.t, "at least two samples")
    for first, last in _stances(trajectory):
        axes.axvspan(trajectory.t[first], trajectory.t[last], color=STANCE_COLOR, zorder=0, gid=STANCE)
    axes.set_xlim(trajectory.t[0], trajectory.t[-1])
    axes.set_xlabel("Time (s)")
    axes.set_ylabel(label)


def _levels(axes: Axes, trajectory: Trajectory, levels: list[tuple[Span, float]], style: str, label: str) -> None:
    """Draws constant pieces, as one line with gaps; none is no line."""
    if not levels:
        return
    times = [time for (first, last), _ in levels for time in (trajectory.t[first], trajectory.t[last], np.nan)]
    values = [value for _, level in levels for value in (level, level, np.nan)]
    axes.plot(times, values, style, color=VERMILLION if style == "--" else GREEN, label=label)


def _stances(trajectory: Trajectory) -> list[Span]:
    """Returns the stances."""
    return _runs(trajectory, _bears(trajectory))


def _bears(trajectory: Trajectory) -> NDArray[np.bool_]:
    """Tells whether each sample is in a stance."""
    return np.asarray(np.char.find(trajectory.phase, STANCE) >= 0)


def _words(name: str) -> str:
    return name.replace("_", " ").capitalize()


def _of_all_legs(flow: str) -> str:
    """Returns the flow that a leg's motor flow is part of: "motor_knee" for "motor_left_knee"."""
    return f"motor_{flow.rpartition('_')[2]}" if flow.startswith("motor_") else flow


def _runs(trajectory: Trajectory, chosen: NDArray[np.bool_]) -> list[Span]:
    """Returns first and last sample of every unbroken run of chosen samples that lasts."""
    cuts = np.append(np.flatnonzero(np.diff(chosen.astype(int))), gaps(trajectory)) + 1
    pieces = np.split(np.arange(len(chosen)), np.unique(cuts))
    runs = [(int(piece[0]), int(piece[-1])) for piece in pieces if chosen[piece[0]]]
    return [(first, last) for first, last in runs if trajectory.t[last] > trajectory.t[first]]


def _commanded(trajectory: Trajectory, joint: str, gait: Gait) -> list[tuple[Span, float]]:
    """Returns the flights, and the commands of a `HoppingLaw` in each: the hip's depends on the speed at lift-off."""
    law = gait.system.law
    if not isinstance(law, HoppingLaw) or joint not in ("hip", "knee"):
        return []
    hip, knee = law.hip_commanded, law.knee_touchdown
    levels = []
    for first, last in _runs(trajectory, ~_bears(trajectory)):
        speed = trajectory.v[first, trajectory.coordinates.index("boom_x")] if law.foot_placement else 0.0
        commanded = {"hip": hip + law.foot_placement * (speed - law.speed), "knee": knee}
        levels.append(((first, last), float(commanded[joint])))
    return levels
