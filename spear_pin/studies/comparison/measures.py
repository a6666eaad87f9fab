"""Measures that any gait, motion or robot has, each with its unit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.gaits.measures.catalogue import added, describe_measure, unit_on
from spear_pin.gaits.measures.of_samples import Sampled
from spear_pin.hybrid.column_names import PAIR, lengths, motors_at, of_a_pair, split_column_name, unit_of
from spear_pin.hybrid.trajectory import Trajectory
from spear_pin.model.robot import Robot
from spear_pin.studies.comparison.sides import Side
from spear_pin.words import show_unit

Values = dict[tuple[str, str], float]  # by name and unit

ONE = ", one motor"  # of the two that a pair's joint stands for
GAIT, MOTION, FORCES, TORQUES, ENERGY, BODY = "gait", "motion", "ground", "motors", "energy a cycle", "robot"
GROUPS = (GAIT, MOTION, FORCES, TORQUES, ENERGY, BODY)


def of_side(side: Side) -> dict[str, Values]:
    """Returns the measures of a side, by group, without those that have no number."""
    found = {BODY: _body(side.robot)} | ({} if side.gait is None else {GAIT: _gait(side)})
    if side.run is not None:
        found |= _motion(side.robot, side.run, side.gait is not None and bool(side.gait.system.mirrored_toes))
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


def _motion(robot: Robot, run: Trajectory, halves: bool) -> dict[str, Values]:
    """Returns measures of whole cycles, where there are some; else of all samples, without measures of a cycle."""
    cycles = [number for number in np.unique(run.cycle).tolist() if number >= 1][: run.cycles]
    sampled = Sampled(robot, run, cycles, halves)
    curves, rows, found = sampled.curves, sampled.curves.chosen, sampled.values()
    t, normal = run.t[rows], run.force[rows][:, :, -1]
    upward = next((i for i, name in enumerate(run.coordinates) if name.endswith("_z")), None)
    motion: Values = {("period", "s"): found["period"]} if cycles else {}
    if "stride" in found:
        motion["mean speed", "m/s"] = found["mean_speed"]
        motion |= {("distance a cycle", "m"): found["stride"]} if cycles else {}
    if upward is not None:
        least, greatest = curves.range(run.q[:, upward])
        motion |= {("greatest height", "m"): greatest, ("least height", "m"): least}
    for toe, name in enumerate(run.toes):
        motion[f"time on the ground, {_words(name)}", "%"] = 100 * _share(t, normal[:, toe] > 0.0)
    forces = {
        (f"peak normal force, {_effort(f'force_z_{name}')}", "N"): found[f"peak_force_{name}"] for name in run.toes
    }
    forces |= {(f"friction used, {_words(name)}", ""): found[f"friction_used_{name}"] for name in run.toes}
    if robot.weight:
        forces["peak normal force, in weights", ""] = curves.peak(run.force[:, :, -1].sum(axis=1)) / robot.weight
    torques: Values = {}
    measured, units = lengths(robot), {name: unit_on(robot, describe_measure(name), name) for name in found}
    for joint in run.actuated:
        one = _words(joint) + ONE * (motors_at(joint) > 1)
        for kind, of in (("peak_torque", one), ("rms_torque", one), ("peak_speed", _words(joint))):
            name = f"{kind}_{joint}"
            torques[f"{_words(kind)}, {of}", units[name]] = found[name]
    for i, joint in enumerate(run.spring_joints):
        unit = unit_of("spring", measured[joint])
        torques[f"peak spring torque, {_effort(f'spring_{joint}')}", unit] = curves.amount(run.spring[:, i])
    if (springs := run.springs) is not None:
        for i, (name, length) in enumerate(zip(springs.names, springs.units, strict=True)):
            torques[f"peak pull, {_words(name)}", unit_of("pull", length)] = curves.peak(springs.pull[:, i])
            torques[f"greatest stretch, {_words(name)}", length] = curves.peak(springs.stretch[:, i])
    energy: Values = {}
    if cycles:
        energy = {
            ("motors' work, positive", "J"): found["positive_work"],
            ("motors' work, |power|", "J"): found["absolute_work"],
            ("effort", units["effort"]): found["effort"],
        }
    if "cost_of_transport" in found:
        energy["cost of transport", ""] = found["cost_of_transport"]
    groups = {"N": forces, "N·s": forces, "N·m": torques, "J": energy}
    for each in added():
        for name, value in each.values(sampled).items():
            groups.get(each.unit, motion)[_words(name), show_unit(unit_on(robot, each, name))] = value
    if run.cycles:
        for flow in dict.fromkeys([*run.ledger.kinds, *run.ledger.flows]):
            joint = flow.removeprefix("motor_")
            name = f"energy, {_words(flow)}" if joint == flow else f"net work, {_words(joint)}"
            energy[name, "J"] = float(run.ledger[flow].mean())
        energy["unaccounted for, at most", "J"] = float(np.abs(run.ledger.residual).max())
    return {MOTION: motion, FORCES: forces, TORQUES: torques, ENERGY: energy}


def _body(robot: Robot) -> Values:
    found: Values = {("mass", "kg"): robot.mass, ("coordinates", ""): float(robot.nv), ("motors", ""): float(robot.nu)}
    for leg in robot.legs[:4]:
        found |= {(f"thigh, {_words(leg.name)}", "m"): leg.thigh, (f"shank, {_words(leg.name)}", "m"): leg.shank}
    measured = lengths(robot)
    for joint in robot.actuated[:12]:
        found[f"gear ratio, {_words(joint)}", ""] = robot.gear_ratio(joint)
        found[f"rotor inertia at the joint, {_words(joint)}", "kg·m²"] = float(robot.model.armature[robot.index(joint)])
        limit = robot.limits[joint].effort
        if 0.0 < limit < np.inf:
            found[f"limit of torque, {_words(joint)}", unit_of("u", measured[joint])] = float(limit)
    return found


def _share(t: Array, on: NDArray[np.bool_]) -> float:
    """Returns the share of the time in which something is on, between 0 and 1."""
    return float((np.diff(t) * (on[:-1] & on[1:])).sum() / (t[-1] - t[0]))


def _effort(column: str) -> str:
    """Returns in words what has the force or torque of a column."""
    return _words(split_column_name(column)[1]) + PAIR * of_a_pair(column)


def _words(name: str) -> str:
    return name.replace("_", " ")
