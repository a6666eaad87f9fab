"""Recovery of a gait from pushes in mid-flight, one at a time, with every event, and over a grid of pushes."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.periodic import chart
from spear_pin.hybrid.result import Moment, Options
from spear_pin.hybrid.run import run
from spear_pin.kinds import typed

RECOVERED = 0.01  # of the first section error
NOTHING = 1e-7  # section error that the fixed point's and the integrator's own errors leave


@dataclass(frozen=True)
class Recovery:
    """Outcome of a run of a disturbed gait.

    Attributes:
        errors: distance from the fixed point at each section crossing, in the section's coordinates (m, rad, m/s,
            rad/s, Euclidean); the first is the disturbance as it arrives there.
        domains: names of the domains that it went through besides those of the undisturbed gait.
        reason: why the run ended, a key of `REASONS`.
        message: the reason in a sentence.
        strides: section crossings until the error stays below 1 % of the first; None if it never does.
    """

    errors: Array
    domains: tuple[str, ...]
    reason: str
    message: str
    strides: int | None

    @property
    def recovered(self) -> bool:
        """Whether the error fell below 1 % of the first one and stayed there."""
        return self.strides is not None


@typed
def midway(gait: Gait, phase: str, fraction: float = 0.5, rtol: float = 1e-9) -> Moment:
    """Returns the gait's own state in the middle of a phase.

    Args:
        gait: the gait.
        phase: name of the phase.
        fraction: fraction of the phase's duration that has passed.
        rtol: relative tolerance of the integrator.

    Raises:
        BadValue: the gait does not pass through that phase, or the fraction is not between 0 and 1.
    """
    if not 0.0 < fraction < 1.0:
        raise BadValue("fraction", fraction, "between 0 and 1")
    result = run(gait.system, gait.state, 1, Options(rtol=rtol, keep=True))
    segments = [segment for segment in result.segments if segment.domain.phase == phase and segment.pieces]
    if not segments:
        raise UnknownName("phase", phase, result.durations)
    begin, end = segments[0].pieces[0].begin, segments[-1].pieces[-1].end
    time = begin + fraction * (end - begin)
    for segment in segments:
        for piece in segment.pieces:
            if piece.begin <= time <= piece.end:
                y, nq = piece.state(time), gait.system.robot.nq
                q, v = y[:nq].copy(), y[nq : nq + gait.system.robot.nv].copy()
                return Moment(q, v, phase, segment.held, time)
    raise BadValue("fraction", fraction, "a time within the phase")


@typed
def push_moment(
    gait: Gait, moment: Moment, q: Mapping[str, float] | None = None, v: Mapping[str, float] | None = None
) -> Moment:
    """Returns a moment with additions to coordinates and velocities.

    Args:
        gait: the gait, for the names of the coordinates.
        moment: the moment.
        q: additions to coordinates, in m or rad, by name.
        v: additions to velocities, in m/s or rad/s, by name.

    Raises:
        UnknownName: there is no such coordinate.
    """
    robot = gait.system.robot
    parts = moment.q.copy(), moment.v.copy()
    for part, added in zip(parts, (q or {}, v or {}), strict=True):
        for name, value in added.items():
            part[robot.index(name)] += value
    return replace(moment, q=parts[0], v=parts[1])


@typed
def recover(gait: Gait, moment: Moment, strides: int = 25, rtol: float = 1e-8) -> Recovery:
    """Simulates on from a disturbed moment in the full automaton, and tells whether the gait comes back.

    Args:
        gait: the gait.
        moment: the moment at which the simulation begins.
        strides: number of section crossings after the first.
        rtol: relative tolerance of the integrator.
    """
    system = gait.system
    local = chart(system, gait.state)
    result = run(system, moment, strides, Options(rtol=rtol))
    crossings = [event for event in result.events if event.name == system.section]
    errors = np.array([np.linalg.norm(local.coordinates((event.q, event.v))) for event in crossings])
    usual = {"posterior_stance", "flight_1", "anterior_stance", "flight_2"}
    domains = tuple(dict.fromkeys(event.domain for event in result.events if event.domain not in usual))
    settled: int | None = None
    if result.reason == "complete":
        above = np.flatnonzero(errors > max(RECOVERED * errors[0], NOTHING))
        first = int(above[-1]) + 1 if len(above) else 0
        settled = first if first < len(errors) else None
    return Recovery(errors, domains, result.reason, result.message, settled)


@typed
def basin(
    gait: Gait,
    phase: str,
    axes: Mapping[str, ArrayLike],
    strides: int = 25,
    rtol: float = 1e-7,
    on_point: Callable[[int], object] = lambda n: None,
) -> Array:
    """Returns strides to recovery over a grid of pushes in the middle of a phase; NaN without recovery in time.

    Args:
        gait: the gait.
        phase: name of the phase.
        axes: two velocities by name, each with the values to add, in m/s or rad/s.
        strides: number of strides within which the gait must recover.
        rtol: relative tolerance of the integrator.
        on_point: called with the number of finished points.

    Returns:
        array with a row for each value of the first axis, a column for each of the second.

    Raises:
        BadValue: there are not two axes.
    """
    if len(axes) != 2:
        raise BadValue("axes", axes, "two velocities by name")
    (first, rows), (second, columns) = ((name, np.asarray(values, dtype=float)) for name, values in axes.items())
    moment = midway(gait, phase)
    result = np.full((len(rows), len(columns)), np.nan)
    for i, a in enumerate(rows):
        for j, b in enumerate(columns):
            found = recover(gait, push_moment(gait, moment, v={first: float(a), second: float(b)}), strides, rtol)
            if found.strides is not None:
                result[i, j] = found.strides
            on_point(i * len(columns) + j + 1)
    return result


@typed
def airborne(gait: Gait) -> tuple[str, ...]:
    """Returns the names of the gait's phases with no toe on the ground."""
    return tuple(dict.fromkeys(d.phase for d in gait.system.domains if all(mode == OPEN for mode in d.contacts)))
