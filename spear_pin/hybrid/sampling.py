"""Samples a run phase by phase while it proceeds, so that its dense output need not be kept."""

from __future__ import annotations

from array import array
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from spear_pin.arrays import Array
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held
from spear_pin.hybrid.filippov import flow_of
from spear_pin.hybrid.path_springs import PathSampler, PathSprings, engaged_in
from spear_pin.hybrid.result import Segment
from spear_pin.model.robot_posture import find_spanned

NUMERIC = ("t", "q", "v", "a", "u", "tau", "friction", "force", "spring", "current", "reference")


def sprung_joints(system: HybridSystem) -> tuple[str, ...]:
    """Returns the names of the coordinates on which springs of a system act, in the order of their mounts."""
    mounts = [mount for domain in system.domains for mount in domain.mounts]
    return tuple(dict.fromkeys(joint for mount in mounts for joint in find_spanned(mount.along, system.robot)))


class Sampler:
    """Takes the segments of a run one after the other; `arrays` returns the samples, on both sides of every event.

    The segments of a phase share its samples in proportion to their durations.
    """

    def __init__(self, system: HybridSystem, least: int) -> None:
        """Prepares a sampler of a system, with at least so many samples a phase."""
        self.springs = sprung_joints(system)
        self._system, self._least = system, least
        self._along = PathSampler(system)
        self._phase: list[Segment] = []  # segments of the present phase
        self._columns = {name: array("d") for name in NUMERIC}  # flat: a list of rows takes five times the memory
        self._held: list[Held] = []  # of each segment
        self._parts: list[tuple[Domain, int, int]] = []  # domain, cycle and number of samples of each segment

    def add(self, segment: Segment) -> None:
        """Takes a finished segment."""
        if self._phase and segment.began != self._phase[0].began:
            self._sample_phase()
        self._phase.append(segment)

    def arrays(self, y: Array) -> dict[str, Any]:
        """Returns the samples by field of a `Trajectory`, after all segments were added; y is the final state."""
        last = self._phase[-1]
        self._sample_phase()
        if not self._parts:  # no time has passed
            self._sample(last, np.zeros(1), y[None])
        domains, cycles, counts = zip(*self._parts, strict=True)
        n = sum(counts)
        shapes = {"t": (n,), "force": (n, len(self._system.robot.toes), self._system.robot.dimension)}
        numbers = {
            name: np.asarray(column).reshape(shapes.get(name, (n, -1))) for name, column in self._columns.items()
        }
        mounted = [self._engaged(*part) for part in zip(domains, self._held, strict=True)]

        def spread(values: Sequence[Any], kind: type) -> NDArray[Any]:
            return np.repeat(np.array(values, dtype=kind), counts, axis=0)

        return numbers | {
            "engaged": spread([[joint in joints for joint in self.springs] for joints in mounted], bool),
            "domain": spread([domain.name for domain in domains], str),
            "phase": spread([domain.phase for domain in domains], str),
            "cycle": spread(cycles, np.int64),
        }

    @property
    def by_path(self) -> PathSprings | None:
        """What the springs do along their paths, after `arrays`; None if columns of joints tell all."""
        return self._along.springs()

    def _engaged(self, domain: Domain, held: Held) -> set[str]:
        """Returns the names of the coordinates on which springs are engaged."""
        robot = self._system.robot
        return {joint for mount in engaged_in(domain, held) for joint in find_spanned(mount.along, robot)}

    def _sample_phase(self) -> None:
        moving = [segment for segment in self._phase if segment.pieces]
        for segment in moving:
            begin, end, whole = segment.pieces[0].begin, segment.pieces[-1].end, moving[-1].pieces[-1].end
            if end == begin:
                continue  # left as soon as entered
            # exactly so many for a whole phase, whatever the rounding of its end
            count = 2 + int(np.ceil(self._least * (end - begin) / whole - 1e-6))
            times = np.linspace(begin, end, count)
            pieces = np.searchsorted([piece.end for piece in segment.pieces[:-1]], times)
            states = [np.atleast_2d(segment.pieces[i].state(times[pieces == i]).T) for i in np.unique(pieces)]
            self._sample(segment, times, np.vstack(states))
        self._phase = []

    def _sample(self, segment: Segment, times: Array, states: Array) -> None:
        robot, columns = self._system.robot, self._columns
        flow = flow_of(self._system, segment.domain, segment.held)
        if segment.domain.crossing is not None:  # the shares of two toes may not exist at its end
            exist = [bool(np.isfinite(flow(t, y)).all()) for t, y in zip(times, states, strict=True)]
            times, states = times[exist], states[exist]
        for t, y in zip(times, states, strict=True):
            flow(t, y)
            set_out = flow.sets_out
            flow.arrive(t, y)
            if set_out:  # since the sample before a toe may have got its velocity's direction
                flow(t, y)
            columns["a"].extend(flow.a)
            columns["u"].extend(flow.u)
            columns["tau"].extend(flow.tau)
            columns["friction"].extend(flow.friction)
            for toe in robot.toes:
                columns["force"].extend(flow.force(toe))
            columns["spring"].extend(flow.spring_torque(joint) for joint in self.springs)
            self._along.add(segment.domain, segment.held, y[: robot.nq], flow.pulls)
            if flow.driven is not None:
                columns["current"].extend(flow.driven.currents)
                columns["reference"].extend(flow.driven.references)
        columns["t"].extend(segment.began + times)
        columns["q"].frombytes(states[:, : robot.nq].tobytes())
        columns["v"].frombytes(states[:, robot.nq : robot.nq + robot.nv].tobytes())
        self._parts.append((segment.domain, segment.cycle, len(times)))
        self._held.append(segment.held)
