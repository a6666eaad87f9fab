"""Electricity that drives take in a cycle, with losses in gears, and how much torque their envelopes leave."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.polynomial import legendre

from spear_pin.arrays import Array
from spear_pin.gaits.sensitivity.drives import Behind
from spear_pin.gaits.sensitivity.signals import Pieces, peak, roots
from spear_pin.hybrid.tangent.collocation import POINTS, rule

STILL = 1e-9  # rad/s: a slower joint counts as held at rest against its gears, despite rounding


def find_drawn(torque: Sequence[Pieces], speed: Sequence[Pieces], joint: Behind) -> tuple[float, Array]:
    """Returns ∫ max(V i, 0) dt over all motors, in J, and its derivative: what motors give back is not stored.

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


def _returns(U: Array, W: Array, joint: Behind) -> Array:
    """Returns R η u / (N kt)² + ω, which changes sign where a braking motor begins or ends to give power back."""
    return np.asarray(joint.resistance.x * joint.drive.gearbox.efficiency / joint.constant.x**2 * U + W)


def _power(u: Array, w: Array, du: Array, dw: Array, drives: bool, joint: Behind) -> tuple[Array, Array]:
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
    heat = share**2 * joint.resistance / (joint.constant * joint.constant)
    power = heat.x * u * u + share * u * w
    slopes = (2.0 * heat.x * u + share * w) * du + share * u * dw + heat.d[:, None] * u * u
    return np.where(power > 0.0, power, 0.0), np.where(power > 0.0, slopes, 0.0)


def find_reserve(torque: Sequence[Pieces], speed: Sequence[Pieces], joint: Behind) -> tuple[float, Array]:
    """Returns the least difference between envelope and torque, to either side, in N·m, and its derivative.

    It is negative where the motor cannot give its torque. Where the motor brakes, the help of the gears is not counted,
    and its greatest speed does not enter. The envelope is N kt i η, with the largest current i that supply and
    amplifier give. Above the no-load speed, where i always brakes, it is N kt i / η.
    """
    drive, c, efficiency, missed = joint.drive, joint.constant, joint.drive.gearbox.efficiency, list[Pieces]()
    for side in (1.0, -1.0):
        asked = [each.times(side / joint.motors) for each in torque]
        for share in (efficiency, 1.0 / efficiency):  # the smaller envelope counts, for driving or braking current
            stall, slope = share * drive.bus * c / joint.resistance, side * share * c * c / joint.resistance
            missed += [
                one.plus(other.times(slope.x, slope.d)).plus(-stall.x, -stall.d)
                for one, other in zip(asked, speed, strict=True)
            ]
        if drive.current_limit is not None:
            most = efficiency * drive.current_limit * c
            missed += [one.plus(-most.x, -most.d) for one in asked]
    value, along = peak(missed)
    return -value, -along
