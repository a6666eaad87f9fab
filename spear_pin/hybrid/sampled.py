"""A law that a computer runs: computed from the state at its samples, applied late, held in between.

The torques that act are a held value, so the motion between two of their changes is as exact as any other.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from spear_pin.arrays import Array
from spear_pin.errors import BadValue
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.hybrid.filippov import flow_of
from spear_pin.hybrid.modes import choose

COMMANDED = "commanded torques"  # their name in `held`
TOGETHER = 1e-12  # s: a sample this close ahead is taken now


class Loop:
    """The samples of a law, and the torques that are on their way to the motors.

    Samples are taken at multiples of the sample time from the beginning of the run. What events latch is exact, and the
    law reads it at its next sample. The torques of the first sample act at once, unless a moment has torques that act.

    Attributes:
        system: the system whose motors give the torques that act.

    Args:
        system: the system with the law.
        sample_time: time from sample to sample, in s.
        latency: time from a sample until its torques act, in s.

    Raises:
        BadValue: the system has hardware.
    """

    def __init__(self, system: HybridSystem, sample_time: float, latency: float) -> None:
        if system.hardware is not None:
            raise BadValue("sample_time", sample_time, "None for a system with hardware, whose loop is its own")
        self.system = replace(system, domains=tuple(replace(domain, law=_acting) for domain in system.domains))
        self._own, self._domains = system, {domain.key: domain for domain in system.domains}
        self._sample_time, self._latency = sample_time, latency
        self._taken = 1
        self._waiting: deque[tuple[float, tuple[float, ...]]] = deque()

    def begin(self, phase: str, held: Held, t: float, y: Array) -> Held:
        """Returns the values held at the beginning of a run, with the torques that act."""
        if COMMANDED in held:
            self._taken = 0
            return held
        return {**held, COMMANDED: tuple(map(float, choose(self._own, phase, held, t, y).u))}

    @property
    def next(self) -> float:
        """Time of the next sample or change of torques, in s since the run began."""
        sample = self._taken * self._sample_time
        return min(sample, self._waiting[0][0]) if self._waiting else sample

    def is_due(self, now: float) -> bool:
        """Tells whether a sample or a change of torques is due."""
        return now >= self.next - TOGETHER

    def passed(self, now: float, domain: Domain, held: Held, t: float, y: Array) -> Held:
        """Takes the sample that is due, and returns the held values with the torques that act from now on.

        Args:
            now: time since the run began, in s.
            domain: the domain.
            held: held values.
            t: time since the phase began, in s.
            y: the state.
        """
        if now >= self._taken * self._sample_time - TOGETHER:
            flow = flow_of(self._own, self._domains.get(domain.key) or self._own.of_phase(domain.phase)[0], held)
            flow(t, y)
            self._waiting.append((self._taken * self._sample_time + self._latency, tuple(map(float, flow.u))))
            self._taken += 1
        while self._waiting and now >= self._waiting[0][0] - TOGETHER:
            held = {**held, COMMANDED: self._waiting.popleft()[1]}
        return held


def _acting(t: Any, q: Any, v: Any, held: Held, p: Any, dyn: Dynamics, ops: Operations) -> Sequence[Any]:
    torques: Sequence[Any] = held[COMMANDED]
    return torques
