"""The zero dynamics of the bounding gait, (5.13) to (5.21): whether its outputs stay at zero, and how they return.

The outputs are those of (5.9) and (5.18), with their rates. The motion is that of the event-exact simulation, whose
equations of motion do not contain the outputs.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.gaits.bounding_law import evolution, phases_of
from spear_pin.gaits.virtual_constraints import errors
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import rebuilt
from spear_pin.hybrid.result import Moment, Options, Run, Segment
from spear_pin.hybrid.run import run
from spear_pin.model.robot import Robot

OFFSET = 1e-3  # rad: of the outputs at first
LEFT = 0.05  # of them when they have come back
SAMPLES = 40  # a segment


def largest_output(robot: Robot, stride: Run) -> float:
    """Returns the largest output in a stride of a robot, through every reset, in rad."""
    return max(float(np.abs(_outputs(robot, segment)[1]).max()) for segment in _constrained(robot, stride))


def decay(system: HybridSystem, stride: Run, epsilon: float | None = None) -> float:
    """Returns the time, in ε, in which outputs fall from `OFFSET` to the share `LEFT` in a stride's longest phase.

    With critical damping they fall by the factor (1 + t/ε) exp(-t/ε).

    Args:
        system: system of the bounding gait.
        stride: a stride of the gait.
        epsilon: ε, in s; None means the gait's own.

    Raises:
        BadValue: the phase is too short for this.
    """
    robot, law = system.robot, system.law if epsilon is None else replace(system.law, epsilon=epsilon)
    longest = max(_constrained(robot, stride), key=lambda each: each.pieces[-1].end - each.pieces[0].begin)
    piece = longest.pieces[0]
    state = piece.state(np.array([piece.begin]))[:, 0]
    q, v = state[: robot.nq].copy(), state[robot.nq : robot.nq + robot.nv]
    phase = next(phase for phase in phases_of(robot) if phase.name == longest.domain.phase)
    q[(phase.landing or phase.legs[0]).hip] += OFFSET  # a leg that is high above the ground
    moment = Moment(q, v, phase.name, longest.held, piece.begin)
    changed = rebuilt(system, law=law)
    t, outputs = _outputs(robot, run(changed, moment, 1, Options(keep=True)).segments[0])
    size = np.abs(outputs).max(axis=1)
    back = np.flatnonzero(size <= LEFT * size[0])
    if back.size == 0:
        raise BadValue("epsilon", law.epsilon, f"one with which the outputs return within {t[-1] - t[0]:.3f} s")
    i = int(back[0])
    when = np.interp(-LEFT * size[0], -size[i - 1 : i + 1], t[i - 1 : i + 1])
    return float((when - t[0]) / law.epsilon)


def _constrained(robot: Robot, stride: Run) -> list[Segment]:
    """Returns the parts of a run that have virtual constraints."""
    names = {phase.name for phase in phases_of(robot)}
    return [segment for segment in stride.segments if segment.domain.phase in names and segment.pieces]


def _outputs(robot: Robot, segment: Segment) -> tuple[Array, Array]:
    """Returns times since the phase began, in s, (n,), and the outputs, in rad, (n, m)."""
    outputs = next(phase.outputs for phase in phases_of(robot) if phase.name == segment.domain.phase)
    times, values = [], []
    for piece in segment.pieces:
        t = np.linspace(piece.begin, piece.end, SAMPLES)
        for now, state in zip(t, piece.state(t).T, strict=True):
            q, v = state[: robot.nq], state[robot.nq : robot.nq + robot.nv]
            times.append(now)
            values.append(errors(outputs, evolution(segment.held), q, v)[0])
    return np.array(times), np.array(values, dtype=float)
