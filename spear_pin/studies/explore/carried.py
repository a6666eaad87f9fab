"""A gait whose numbers a user changes: Newton's method carries it to the new numbers.

A gait is seldom stable, so simulation does not settle to one. Each gait is found from the nearest known gait, step by
step where one step is too far. Where two branches of gaits exist, the result is on the branch to which this leads.
"""

from __future__ import annotations

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple

from spear_pin.errors import NoGait, SpearError
from spear_pin.gaits.gait import Gait
from spear_pin.gaits.leading import lead_along
from spear_pin.gaits.search import gait_beside
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.parameters import number, with_numbers
from spear_pin.hybrid.result import State
from spear_pin.studies.explore.knobs import Knob, Knobs, Subject
from spear_pin.studies.explore.motion import Motion, periodic

STEPS = 3  # Newton's methods that may fail on the way to one answer
REACH = 0.15  # of a slider's range, farther than which no step goes at first
PATIENCE = 0.06  # s for each pair of coordinates, after which none is begun: a step takes longer for larger robots
LONGEST = 30.0  # s more, after which none goes on
MEMORY = 200  # gaits that are known at most
RTOL = 1e-9
LATE = "Newton's method takes too long"


class Kept(NamedTuple):
    """A measure whose value is a knob, and the parameter that is solved for it."""

    measure: str
    parameter: str


@dataclass(frozen=True)
class Known:
    """A gait that was found: the numbers on the sliders, the state, and what was solved for."""

    numbers: tuple[float, ...]
    state: State
    solved: Mapping[str, float]


@dataclass(frozen=True, eq=False)
class Carried(Subject):
    """A gait with knobs: numbers of law, springs, ground and robot, and measures that parameters are solved for.

    Attributes:
        kind: kind of the motion, for its page.
        gait: with the default numbers, without event feedback.
        knobs: knobs by name.
        title: title of the page.
        kept: by knob, the measure whose value the knob is.
        source: name or path of the gait, from which a saved program loads it.
        known: gaits found so far, the default one first.
    """

    kind: str
    gait: Gait
    knobs: Mapping[str, Knob]
    title: str
    kept: Mapping[str, Kept] = field(default_factory=dict)
    source: str = "gait.json"
    known: list[Known] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Stores the default gait as the first known one."""
        solved = {each.parameter: number(self.gait.system, each.parameter) for each in self.kept.values()}
        self.known.append(Known(self.at().numbers, self.gait.state, solved))

    def system(self, values: Mapping[str, float]) -> HybridSystem:
        """Returns the system with these numbers, what is solved for unchanged."""
        return with_numbers(self.gait.system, self.changed(values))

    def changed(self, values: Mapping[str, float]) -> dict[str, float]:
        """Returns the numbers of the system that differ from the default ones."""
        defaults = self.at().values
        return {name: x for name, x in values.items() if name not in self.kept and x != defaults[name]}

    def wanted_of(self, values: Mapping[str, float]) -> dict[str, float]:
        """Returns the measures that are kept, with their values."""
        return {each.measure: values[name] for name, each in self.kept.items()}

    def held(self, kept: bool) -> Mapping[str, str]:
        """Returns the parameters that are solved for, each with the measure that it keeps."""
        return {each.parameter: each.measure for each in self.kept.values()}

    def moved(self, name: str, values: Mapping[str, float]) -> Mapping[str, float]:
        """Returns the parameter that a knob changes; none for the value of a measure that is kept."""
        return {} if name in self.kept else {name: 1.0}

    @property
    def start(self) -> State:
        """State of the gait on its section."""
        return self.gait.state

    @property
    def thorough(self) -> Sequence[Knobs]:
        """Numbers for a gait near the first."""
        name, knob = next(iter(self.knobs.items()))
        return (self.at().turned(**{name: round(1.002 * knob.default, knob.digits)}),)

    def nearest(self, numbers: tuple[float, ...]) -> Known:
        """Returns the nearest known gait."""
        return min(self.known, key=lambda each: self.distance(each.numbers, numbers))

    def distance(self, one: tuple[float, ...], other: tuple[float, ...]) -> float:
        """Returns the largest difference of two settings, with each number relative to its range."""
        spans = [knob.high - knob.low for knob in self.knobs.values()]
        return max(abs(a - b) / span for a, b, span in zip(one, other, spans, strict=True))

    def remember(self, known: Known) -> None:
        """Stores a known gait, and drops the oldest except the first."""
        self.known.append(known)
        del self.known[1:-MEMORY]


class Underway(NoGait):
    """Raised when there is no more time; gaits found on the way are stored, so that a repeated call gets farther."""


def carry_gait(knobs: Knobs) -> Motion:
    """Finds a cycle of the gait with these numbers.

    Args:
        knobs: the numbers of a `Carried`.

    Raises:
        Underway: there was no more time; repeat the call.
        NoGait: no gait was found; the text says why, and how far the way led.
    """
    subject = knobs.subject
    assert isinstance(subject, Carried)
    if knobs == subject.at():
        return periodic(knobs, subject.gait)
    begun = subject.nearest(knobs.numbers)
    distance, failures = max(subject.distance(begun.numbers, knobs.numbers), 1e-12), 0
    patience = PATIENCE * subject.gait.system.robot.nv**2
    until = math.inf if len(subject.known) == 1 else time.perf_counter() + patience  # at first it is compiled
    found: list[Gait] = []

    def solve(share: float, near: Known) -> Known:
        numbers = tuple(a + share * (b - a) for a, b in zip(begun.numbers, knobs.numbers, strict=True))
        wanted = knobs if share == 1.0 else replace(knobs, numbers=numbers)
        try:
            gait = _beside(wanted, near, until)
        except NoGait:
            raise
        except SpearError as error:
            raise NoGait(str(error), math.inf) from None
        found.append(gait)
        subject.remember(there := Known(wanted.numbers, gait.state, gait.parameters))
        return there

    def enough() -> bool:
        nonlocal failures
        failures += 1
        return failures >= STEPS or time.perf_counter() > until

    step = REACH / distance
    way = lead_along(solve, begun, first=step, shortest=0.0, longest=step, enough=enough)
    if way.failure is None:
        return periodic(knobs, found[-1])
    told = f"{_said(subject, way.end)} none was found beyond: {way.failure.reason}"
    late = failures < STEPS and way.end is not begun
    raise (Underway if late else NoGait)(told, way.failure.residual) from None


def _beside(knobs: Knobs, near: Known, until: float) -> Gait:
    """Finds the gait with these numbers by Newton's method from a known one alone, begun before a time."""

    def check_time(iteration: int, residual: float) -> None:
        if time.perf_counter() > until + (LONGEST if iteration else 0.0):
            raise NoGait(LATE, residual)

    subject = knobs.subject
    assert isinstance(subject, Carried)
    check_time(0, math.inf)
    system = with_numbers(knobs.system, near.solved)
    target = subject.wanted_of(knobs.values)
    return gait_beside(system, near.state, list(near.solved), target, RTOL, check_time)


def _said(subject: Carried, near: Known) -> str:
    """Returns in words the numbers of the last gait on the way that are not the default ones."""
    told = [
        f"{knob.label.lower()} {value:.4g}" + ("" if knob.unit in ("", "1") else f" {knob.unit}")
        for knob, value in zip(subject.knobs.values(), near.numbers, strict=True)
        if not math.isclose(value, knob.default, rel_tol=1e-9, abs_tol=1e-12)
    ]
    return f"There is a gait at {', '.join(told) or 'the default numbers'}, and"
