"""Record of a run of a hybrid system: its segments, events, work by cycle, and why it ended."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from spear_pin.arrays import Array
from spear_pin.errors import BadValue, UnknownName
from spear_pin.hybrid.domain import Domain, Guard, Held
from spear_pin.hybrid.reasons import REASONS
from spear_pin.hybrid.trajectory import Event
from spear_pin.kinds import typed

State = tuple[Array, Array]


@dataclass(frozen=True)
class Moment:
    """A point in the middle of a phase, with the values held, from which a run can continue.

    Attributes:
        q: configuration, (nq,).
        v: velocity, (nv,).
        phase: name of the phase.
        held: held values.
        t: time since the phase began, in s.
    """

    q: Array
    v: Array
    phase: str
    held: Held
    t: float = 0.0


SHORTEST_STEP = 1e-7  # s: shorter steps make no progress
FINEST = 1e-13  # relative tolerance that doubles allow
EVALUATIONS = 60_000  # most right-hand sides of one cycle; a gait's cycle takes some thousands, even at rtol 1e-13


@dataclass(frozen=True)
class Piece:
    """One accepted integration step, or its part up to an event; times count from the beginning of the phase."""

    begin: float
    end: float
    state: Callable[[Any], Array]


@dataclass
class Segment:
    """Motion in one domain between two events.

    Attributes:
        domain: the domain.
        held: held values.
        cycle: number of the cycle.
        began: absolute time of the phase's beginning, in s.
        pieces: steps of the integrator.
        ended: event that ends the segment; None for a knot of a spring's curve, and where the motion breaks off.
    """

    domain: Domain
    held: Held
    cycle: int
    began: float
    pieces: list[Piece] = field(default_factory=list)
    ended: Guard | None = None


@dataclass
class Run:
    """A run in progress or finished.

    Attributes:
        start: (q, v) at the beginning.
        state: (q, v) at the end.
        held: values held at the end.
        domain: the last domain.
        segments: the motion, if it was kept and not handed over.
        events: the events.
        work: energy by flow in each whole cycle, in J.
        change: change of the stored energy in each whole cycle, in J.
        stored: change of the energy in the hardware's inductances, in J.
        durations: time in each phase in the last whole cycle, in s.
        cycles: number of whole cycles.
        reason: why the run ended, a key of `REASONS`.
        detail: place or cause of the end, in words.
        evaluations: number of right-hand sides evaluated.
    """

    start: State
    state: State
    held: Held
    domain: Domain
    segments: list[Segment] = field(default_factory=list)
    events: list[Event] = field(default_factory=list)
    work: list[Array] = field(default_factory=list)
    change: list[float] = field(default_factory=list)
    stored: list[float] = field(default_factory=list)
    durations: Mapping[str, float] = field(default_factory=dict)
    cycles: int = 0
    reason: str = ""
    detail: str = ""
    evaluations: int = 0

    @property
    def message(self) -> str:
        """The reason in a sentence."""
        return REASONS[self.reason] + (f" ({self.detail})" if self.detail else "")

    def event(self, name: str) -> Event:
        """Returns the last event with a name.

        Raises:
            UnknownName: no event with that name happened.
        """
        for event in reversed(self.events):
            if event.name == name:
                return event
        raise UnknownName("event of this run", name, sorted({event.name for event in self.events}))


@typed
@dataclass(frozen=True)
class Options:
    """Options for the computation of a run.

    Attributes:
        rtol: relative tolerance of the integrator; systems with hardware use a tenth of it, 1e-13 at least.
        atol: absolute tolerance; None means 0.01 rtol; systems with hardware use a tenth of it.
        max_evaluations: most evaluations of right-hand sides.
        keep: whether to keep the motion, as dense output, for sampling.
        max_step: longest step of the integrator, in s; None leaves it to the integrator, which takes 0.05 s at most.
        sample_time: time from sample to sample of the law, in s, see `hybrid.sampled`; None for a continuous law.
        latency: time from a sample until its torques act, in s.
    """

    rtol: float = 1e-9
    atol: float | None = None
    max_evaluations: int = 2_000_000
    keep: bool = False
    max_step: float | None = None
    sample_time: float | None = None
    latency: float = 0.0

    def __post_init__(self) -> None:
        """Checks the fields."""
        if not FINEST <= self.rtol <= 1e-2:
            raise BadValue("rtol", self.rtol, "a number from 1e-13 to 1e-2")
        if not self.max_evaluations >= 1:
            raise BadValue("max_evaluations", self.max_evaluations, "at least 1")
        if self.atol is not None and not 0 < self.atol <= 1e-2:
            raise BadValue("atol", self.atol, "a number above 0 and at most 1e-2")
        if self.max_step is not None and not SHORTEST_STEP <= self.max_step <= 0.5:
            raise BadValue("max_step", self.max_step, f"a number from {SHORTEST_STEP:g} to 0.5, in s")
        if self.sample_time is not None and not 1e-5 <= self.sample_time <= 1.0:
            raise BadValue("sample_time", self.sample_time, "None, or a number from 1e-5 to 1, in s")
        if not 0.0 <= self.latency <= (0.0 if self.sample_time is None else 1.0):
            raise BadValue("latency", self.latency, "from 0 to 1, in s, and 0 without a sample_time")
