"""Electricity that drives take in a cycle, with losses in gears, and how much torque their envelopes leave."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.polynomial import legendre

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.sensitivity.along_arcs import find_powered
from spear_pin.gaits.sensitivity.heat import drive_of, motors_of_joint
from spear_pin.gaits.sensitivity.measure import DualMeasure, Group, total
from spear_pin.gaits.sensitivity.signals import Pieces, peak, roots
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.column_names import lengths, unit_of
from spear_pin.hybrid.tangent.collocation import POINTS, rule
from spear_pin.hybrid.tangent.derivative import Derivative
from spear_pin.model.catalogue import size_motor
from spear_pin.model.motor import Drive, Motor

ELECTRICITY, RESERVE = "electricity", "reserve_"
STILL = 1e-9  # rad/s: a slower joint counts as held at rest against its gears, despite rounding


class _Joint(NamedTuple):
    """A drive behind a joint.

    Attributes:
        drive: the drive of each motor.
        motors: number of motors that share the joint's torque.
        constant: N kt with the robot's ratio, in N·m/A.
        change: relative derivative of `constant`, (c,).
        resistance: resistance of a motor of the robot's size, in Ω.
        wider: relative derivative of that size, minus that of the resistance, (c,).
    """

    drive: Drive
    motors: int
    constant: float
    change: Array
    resistance: float
    wider: Array


def electricity(cycle: Derivative, drives: Mapping[str, Drive], names: Sequence[str], d: int) -> tuple[Group, ...]:
    """Returns the measures `electricity_JOINT` and `electricity`, their sum, in J, and `reserve_JOINT`, in N·m.

    `electricity_JOINT` is ∫ max(V i, 0) dt over a cycle, for all motors of the joint: energy that motors give back is
    not stored. `reserve_JOINT` is the least torque that a motor has to spare, at the joint. It is negative where the
    motor cannot give its torque. Where the motor brakes, the help of the gears is not counted. A motor's greatest speed
    does not enter. Gears have the robot's ratio, which may vary, and the drive's efficiency. The drive's motor is that
    of size 1. The sum exists where all joints have drives.

    Args:
        cycle: the cycle.
        drives: drives by the names of their joints; a joint in a pair of legs has two.
        names: names of the parameters.
        d: number of coordinates ahead of the parameters.

    Raises:
        UnknownName: when a measure is found, if its joint has no motor torque.
        BadValue: when a measure is found, if a motor's resistance or torque constant is not known.
    """
    robot = cycle.system.robot

    def joints() -> Iterator[tuple[str, _Joint, list[Pieces], list[Pieces]]]:
        for name, drive in drives.items():
            joint = _joint(cycle.system, name, drive, names, d)
            yield name, joint, *find_powered(cycle.stretches, robot, name)

    def taken(of: Mapping[str, DualMeasure]) -> dict[str, DualMeasure]:
        parts = {f"{ELECTRICITY}_{name}": DualMeasure(*_drawn(u, w, joint), "J") for name, joint, u, w in joints()}
        whole = {ELECTRICITY: total([*parts.values()])} if set(drives) == set(robot.actuated) else {}
        return {**parts, **whole}

    def reserves(of: Mapping[str, DualMeasure]) -> dict[str, DualMeasure]:
        units = {name: unit_of("u", measured) for name, measured in lengths(robot).items()}
        return {RESERVE + name: DualMeasure(*_reserve(u, w, joint), units[name]) for name, joint, u, w in joints()}

    return Group(f"{ELECTRICITY}(_.*)?", taken), Group(f"{RESERVE}.*", reserves)


def check_gears(system: HybridSystem, motors: Mapping[str, Motor | Drive]) -> None:
    """Refuses drives with gears other than the robot's.

    Raises:
        BadValue: a ratio differs from the robot's.
        UnknownName: a joint has no motor torque.
    """
    for joint, each in motors.items():
        if isinstance(each, Drive) and not math.isclose(each.gearbox.ratio, system.robot.gear_ratio(joint)):
            expected = (
                f"{system.robot.gear_ratio(joint):g}, as the robot has; change it there: vary(robot, {joint}_ratio=...)"
            )
            raise BadValue(f"ratio of the drive of {joint}", each.gearbox.ratio, expected)


def _joint(system: HybridSystem, name: str, drive: Drive, names: Sequence[str], d: int) -> _Joint:
    motors, kt = motors_of_joint(system, name), drive.motor.known("torque_constant")
    (ratio, size), (of_ratio, of_size) = drive_of(system, name, names, d)
    resistance = size_motor(drive.motor, float(size)).known("resistance")
    return _Joint(drive, motors, ratio * kt, of_ratio / ratio, resistance, of_size / size)


def _drawn(torque: Sequence[Pieces], speed: Sequence[Pieces], joint: _Joint) -> tuple[float, Array]:
    """Returns ∫ max(V i, 0) dt over all motors, and its derivative.

    Where the joint turns back under torque, the gears' losses change sides and the power jumps, so the place moves.
    """
    total, change = 0.0, np.zeros(torque[0].derivatives.shape[1])
    for u, w in zip(torque, speed, strict=True):
        last: float | None = None  # power where the interval before ends
        for i, h in enumerate(u.stretch.carried.lengths.tolist()):
            U, dU, W, dW = u.series[i] / joint.motors, u.slopes(i) / joint.motors, w.series[i], w.slopes(i)
            still = np.abs(W).sum() < STILL
            turns = [] if still else roots(W)
            marks = sorted([-1.0, 1.0, *turns, *roots(U), *roots(_returns(U, W, joint))])
            for left, right in zip(marks[:-1], marks[1:], strict=True):
                drives = still or bool(_at(0.5 * (left + right), U) * _at(0.5 * (left + right), W) >= 0.0)
                x = np.concatenate([left + (right - left) * rule(POINTS).nodes, [left, right]])
                weights = 0.5 * h * (right - left) * rule(POINTS).weights
                power, slopes = _power(_at(x, U), _at(x, W), _at(x, dU), _at(x, dW), drives, joint)
                total += float(weights @ power[:-2])
                change = change + slopes[:, :-2] @ weights
                begin, end = power[-2:].tolist()
                if last is None:
                    change = change - begin * u.stretch.since
                elif left in turns:
                    moved = -_at(left, dW) / _at(left, legendre.legder(W))
                    change = change + 0.5 * h * (last - begin) * moved
                last = end
        change = change + (last or 0.0) * u.stretch.tau
    return joint.motors * total, joint.motors * change


def _at(x: Any, coefficients: Any) -> Any:
    """Returns the values of Legendre series, (k,) or (k, c), at places on [-1, 1]."""
    return legendre.legval(x, coefficients)


def _returns(U: Array, W: Array, joint: _Joint) -> Array:
    """Returns R η u / (N kt)² + ω, which changes sign where a braking motor begins or ends to give power back."""
    return np.asarray(joint.resistance * joint.drive.gearbox.efficiency / joint.constant**2 * U + W)


def _power(u: Array, w: Array, du: Array, dw: Array, drives: bool, joint: _Joint) -> tuple[Array, Array]:
    """Returns the power max(V i, 0) of one motor, R i² + N kt ω i, and its derivatives, (c, points).

    It is as `Drive.bus_power` of the current `Drive.current`.

    Args:
        u: torques of a motor at the joint, in N·m, (points,).
        w: speeds of the joint, in rad/s, (points,).
        du: derivatives of the torques, (c, points).
        dw: derivatives of the speeds, (c, points).
        drives: whether the motor drives, or brakes.
        joint: the drive.
    """
    share = joint.drive.gearbox.efficiency ** (-1.0 if drives else 1.0)
    heat = joint.resistance * (share / joint.constant) ** 2
    power = heat * u * u + share * u * w
    slopes = (2.0 * heat * u + share * w) * du + share * u * dw
    slopes -= heat * u * u * (2.0 * joint.change + joint.wider)[:, None]
    return np.where(power > 0.0, power, 0.0), np.where(power > 0.0, slopes, 0.0)


def _reserve(torque: Sequence[Pieces], speed: Sequence[Pieces], joint: _Joint) -> tuple[float, Array]:
    """Returns the least difference between envelope and torque, to either side, and its derivative.

    The envelope is N kt i η, with the largest current i that supply and amplifier give. Above the no-load speed, where
    i always brakes, it is N kt i / η.
    """
    drive, c, change, wider = joint.drive, joint.constant, joint.change, joint.wider
    resistance, efficiency, missed = joint.resistance, drive.gearbox.efficiency, list[Pieces]()
    for side in (1.0, -1.0):
        asked = [each.times(side / joint.motors) for each in torque]
        for share in (efficiency, 1.0 / efficiency):  # the smaller envelope counts, for driving or braking current
            stall, slope = share * c * drive.bus / resistance, side * share * c**2 / resistance
            missed += [
                one.plus(other.times(slope, slope * (2.0 * change + wider))).plus(-stall, -stall * (change + wider))
                for one, other in zip(asked, speed, strict=True)
            ]
        if drive.current_limit is not None:
            most = efficiency * c * drive.current_limit
            missed += [one.plus(-most, -most * change) for one in asked]
    value, along = peak(missed)
    return -value, -along
