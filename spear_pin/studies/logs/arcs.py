"""Arcs: the parts of a log over which a played leg is shot, one for each stance and flight that can be used."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.studies.logs.log import Log
from spear_pin.studies.logs.measured import STANCE, Measured
from spear_pin.studies.logs.phases import GAP, LogPhase, find_phases
from spear_pin.studies.logs.shooting import with_torques

SETTLE = 0.012  # s after a touchdown that are left out: the foot bounces, and the leg rings
MARGIN = 0.002  # s on both sides of a lift-off, which is not known better
RATE = 8  # samples from which a first rate follows
Places = NDArray[np.intp]


@dataclass(frozen=True)
class LogArc:
    """A phase of a log that is shot over.

    Attributes:
        phase: the phase.
        t: times of its samples, (n,), in s.
        positions: measured positions at them, (n, m).
        torques: torques of the motors at them, (n, nu).
        near: configuration at the first sample, (nv,), with the toe on the ground.
        touchdown: measured positions at touchdown, (m,), where springs are latched.
        base: rates of the base at the first sample of a flight, in m/s, from the push-off; None for a stance.
        beside: what else was measured, of coordinates of the base, (n, o); NaN where nothing was.
    """

    phase: LogPhase
    t: Array
    positions: Array
    torques: Array
    near: Array
    touchdown: Array
    base: Array | None
    beside: Array

    @property
    def seen(self) -> Array:
        """All that was measured, (n, m + o)."""
        return np.hstack([self.positions, self.beside])


def find_arcs(
    system: HybridSystem,
    joints: Measured,
    log: Log,
    settle: float,
    whole: bool = False,
    torques: bool = True,
    beside: Sequence[str] = (),
) -> tuple[list[LogArc], list[LogPhase]]:
    """Returns the arcs of a log, and the phases that are left out.

    Args:
        system: the leg.
        joints: its measured joints.
        log: the log.
        settle: time after each touchdown that is left out, in s; half of it before one.
        whole: whether a stance goes on to the next touchdown.
        torques: whether the log needs the torques of all motors.
        beside: names of coordinates of the base whose positions are taken as well.
    """
    found, left_out = list[LogArc](), list[LogPhase]()
    ratios = {joint: system.robot.gear_ratio(joint) for joint in system.robot.actuated}
    applied = with_torques(log, system.robot.actuated, ratios, torques)
    positions = np.column_stack([log[name] for name in joints.joints])
    others = np.array([log[name] for name in beside]).reshape(len(beside), len(log.t)).T
    good = np.isfinite(positions).all(axis=1) & np.isfinite(applied).all(axis=1)
    near, touchdown = None, positions[good][0]
    phases = find_phases(system.robot, log)
    for i, phase in enumerate(phases):
        stance, ends = phase.name == STANCE, phase.end
        begin = phase.begin + (settle if stance else MARGIN)
        if whole and stance and i + 1 < len(phases):
            ends = phases[i + 1].end
        end = ends - (MARGIN if stance and ends == phase.end else settle / 2)
        inside = np.flatnonzero(good & (log.t >= begin) & (log.t <= end))
        before = np.flatnonzero(good & (log.t <= phase.begin))
        if stance:
            touchdown = np.array([np.interp(phase.begin, log.t[good], each) for each in positions[good].T])
        if not stance and len(before) < RATE:
            phase = replace(phase, left_out=phase.left_out or "its lift-off is not in the log")
        elif len(inside) < RATE:
            phase = replace(phase, left_out=phase.left_out or f"only {len(inside)} samples of it can be used")
        elif (hole := float(np.diff(log.t[inside]).max())) > GAP:
            phase = replace(phase, left_out=phase.left_out or f"{1e3 * hole:.0f} ms have no position or torque")
        if phase.left_out:
            left_out.append(phase)
            continue
        near = joints.configuration(positions[inside[0]], near)
        base = None if stance else _base(joints, log.t, positions, before[-RATE:], log.t[inside[0]], near)
        arc = log.t[inside], positions[inside], applied[inside]
        found.append(LogArc(phase, *arc, near, touchdown, base, others[inside]))
    return found, left_out


def fit_rates(joints: Measured, name: str, t: Array, positions: Array, place: int) -> Array:
    """Returns the leading rates at the first or the last of some samples, by a parabola through them."""
    lines = np.polyfit(t - t[place], positions, 2)[1]
    return np.array([lines[joints.rows.index(row)] for row in joints.leading[name]])


def _base(joints: Measured, t: Array, positions: Array, last: Places, time: float, near: Array) -> Array:
    """Returns the rates of the base in flight: until the last samples before lift-off the toe was at rest.

    Args:
        joints: the measured joints.
        t: times of all samples, (n,).
        positions: measured positions at them, (n, m).
        last: places of the last samples in stance.
        time: the time for which the rates are.
        near: a configuration nearby.
    """
    rates = fit_rates(joints, STANCE, t[last], positions[last], -1)
    at = joints.state(STANCE, positions[last[-1]], rates, near)[joints.robot.nv :]
    falls = [joints.gravity if joints.robot.coordinates[row] == "boom_z" else 0.0 for row in joints.base]
    slower: Array = at[joints.base] - np.array(falls) * (time - t[last[-1]])
    return slower
