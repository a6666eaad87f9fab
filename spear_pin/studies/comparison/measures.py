"""Measures that any gait, motion or robot has, whatever it is of, each with its unit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.column_names import PAIR, of_a_pair, parted
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.robot import Robot
from spear_pin.studies.comparison.sides import Side

Values = dict[tuple[str, str], float]  # by name and unit

GAIT, MOTION, FORCES, TORQUES, ENERGY, BODY = "gait", "motion", "ground", "motors", "energy a cycle", "robot"
GROUPS = (GAIT, MOTION, FORCES, TORQUES, ENERGY, BODY)


def of_side(side: Side) -> dict[str, Values]:
    """Measures of a side, by group; those that are no number are not there."""
    found = {BODY: _body(side.robot)} | ({} if side.gait is None else {GAIT: _gait(side)})
    if side.run is not None:
        found |= _motion(side.robot, side.run)
    return {
        group: {key: value for key, value in values.items() if np.isfinite(value)} for group, values in found.items()
    }


def _gait(side: Side) -> Values:
    gait = side.gait
    assert gait is not None
    return {
        ("largest multiplier", ""): float(np.abs(gait.multipliers).max()),
        **{(f"{phase.replace('_', ' ')} time", "s"): seconds for phase, seconds in gait.durations.items()},
        ("residual of the fixed point", ""): gait.residual,
    }


def _motion(robot: Robot, run: Trajectory) -> dict[str, Values]:
    """Of whole cycles, where there are some; else of all samples, and nothing that is of a cycle."""
    cycles = [number for number in np.unique(run.cycle).tolist() if number >= 1][: run.cycles]
    rows = np.isin(run.cycle, cycles) if cycles else np.ones(len(run), dtype=bool)
    t, q, v, u, force = (getattr(run, name)[rows] for name in ("t", "q", "v", "u", "force"))
    normal = force[:, :, -1]
    count, seconds = max(1, len(cycles)), float(t[-1] - t[0])
    forward, aside, upward = (
        next((i for i, name in enumerate(run.coordinates) if name.endswith(axis)), None) for axis in ("_x", "_y", "_z")
    )
    distance = None if forward is None else float(q[-1, forward] - q[0, forward])
    if forward is not None and aside is not None:
        ends = [*(int(np.argmax(run.cycle[rows] == number)) for number in cycles or [0]), -1]
        distance = float(np.linalg.norm(np.diff(q[ends][:, [forward, aside]], axis=0), axis=1).sum())
    motion: Values = {("period", "s"): seconds / count} if cycles else {}
    if distance is not None:
        motion["mean speed", "m/s"] = distance / seconds
        motion |= {("distance a cycle", "m"): distance / count} if cycles else {}
    if upward is not None:
        motion |= {
            ("greatest height", "m"): float(q[:, upward].max()),
            ("least height", "m"): float(q[:, upward].min()),
        }
    for toe, name in enumerate(run.toes):
        motion[f"time on the ground, {_words(name)}", "%"] = 100 * _share(t, normal[:, toe] > 0.0)
    rate = v[:, [run.coordinates.index(joint) for joint in run.actuated]]
    forces = {
        (f"peak normal force, {_effort(f'force_z_{name}')}", "N"): float(normal[:, i].max())
        for i, name in enumerate(run.toes)
    }
    total = normal.sum(axis=1)
    forces["peak normal force, in weights", ""] = float(total.max()) / robot.weight
    torques: Values = {}
    for i, joint in enumerate(run.actuated):
        torques[f"peak torque, {_effort(f'u_{joint}')}", "N·m"] = float(np.abs(u[:, i]).max())
        torques[f"rms torque, {_effort(f'u_{joint}')}", "N·m"] = float(np.sqrt(np.trapezoid(u[:, i] ** 2, t) / seconds))
        torques[f"peak rate, {_words(joint)}", "rad/s"] = float(np.abs(rate[:, i]).max())
    for i, joint in enumerate(run.spring_joints):
        torques[f"peak spring torque, {_effort(f'spring_{joint}')}", "N·m"] = float(np.abs(run.spring[rows, i]).max())
    power = u * rate
    work = float(np.trapezoid(np.abs(power).sum(axis=1), t))
    energy: Values = {}
    if cycles:
        positive = float(np.trapezoid(np.maximum(power, 0.0).sum(axis=1), t))
        energy = {("motors' work, positive", "J"): positive / count, ("motors' work, |power|", "J"): work / count}
    if distance is not None and abs(distance) > 1e-3 * abs(seconds):
        energy["cost of transport (mechanical, |power|)", ""] = work / (robot.weight * abs(distance))
    if run.cycles:
        for flow in run.ledger.flows:
            energy[_words(flow).replace("motor ", "net work, "), "J"] = float(run.ledger[flow].mean())
        energy["unaccounted for, at most", "J"] = float(np.abs(run.ledger.residual).max())
    return {MOTION: motion, FORCES: forces, TORQUES: torques, ENERGY: energy}


def _body(robot: Robot) -> Values:
    found: Values = {("mass", "kg"): robot.mass, ("coordinates", ""): float(robot.nv), ("motors", ""): float(robot.nu)}
    for leg in robot.legs[:4]:
        found |= {(f"thigh, {_words(leg.name)}", "m"): leg.thigh, (f"shank, {_words(leg.name)}", "m"): leg.shank}
    for joint in robot.actuated[:12]:
        found[f"gear ratio, {_words(joint)}", ""] = robot.gear_ratio(joint)
        found[f"rotor inertia at the joint, {_words(joint)}", "kg·m²"] = float(robot.model.armature[robot.index(joint)])
        limit = robot.limits[joint].effort
        if 0.0 < limit < np.inf:
            found[f"limit of torque, {_words(joint)}", "N·m"] = float(limit)
    return found


def _share(t: Array, on: NDArray[np.bool_]) -> float:
    """Share of the time at which something is on, between 0 and 1."""
    return float((np.diff(t) * (on[:-1] & on[1:])).sum() / (t[-1] - t[0]))


def _effort(column: str) -> str:
    """What has the force or torque of a column, in words."""
    return _words(parted(column)[1]) + PAIR * of_a_pair(column)


def _words(name: str) -> str:
    return name.replace("_", " ")
