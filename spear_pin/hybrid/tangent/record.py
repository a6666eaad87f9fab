"""Runs a cycle and keeps its arcs, by the fast engine where heyoka is installed; refuses events with no derivative."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from functools import cached_property, lru_cache
from itertools import count
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Record
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.batch import is_unrolled
from spear_pin.hybrid.clutch import Clock
from spear_pin.hybrid.domain import Domain, Held, Reset
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.engines.structure import Structure, shape_of
from spear_pin.hybrid.engines.taylor import Code
from spear_pin.hybrid.lanes.compilation import Compilation
from spear_pin.hybrid.lanes.lone_runner import LoneRunner
from spear_pin.hybrid.lanes.numbers import Numbers as Numbers
from spear_pin.hybrid.parameters import with_parameters
from spear_pin.hybrid.rules.latching import latch_values
from spear_pin.hybrid.rules.start import start
from spear_pin.hybrid.tangent.fields import TangentFeet, TangentField, tangent_feet, tangent_field
from spear_pin.hybrid.tangent.reference_runner import ReferenceRunner
from spear_pin.hybrid.tangent.resets import NotDifferentiable
from spear_pin.model.path import Joints

PLAIN = "the cycle does not close, or has an event without a derivative"
TOL = 1e-15
CYCLES = 3  # cycles in space that take as long as compiling
_fields: WeakKeyDictionary[Compilation, dict[Any, TangentField]] = WeakKeyDictionary()
_feet: WeakKeyDictionary[Compilation, dict[Any, TangentFeet]] = WeakKeyDictionary()


def many(system: HybridSystem, given: Mapping[str, Array]) -> Numbers:
    """Returns the numbers of lanes for `Recorder`; lanes differ in the given numbers, (n,) each."""
    # optimised code would run in half the time, but take twelve times as long to compile
    return Numbers(system, given, Code(TOL, unrolled=is_unrolled(system), level=0))


@lru_cache(taylor.MOST)
def by_reference(structure: Structure) -> Iterator[int]:
    """Returns what counts the cycles that the reference engine runs before the fast one is compiled."""
    return count()


class Recorder:
    """Runs cycles of a system, and keeps them as records.

    Args:
        system: the system.
        numbers: numbers of many lanes, which needs heyoka (default: only the system's own numbers).
        lane: index of the lane.

    Attributes:
        mechanism: the robot's dynamics.
        law: parameters of the law.
        numbers: run-time parameters, which come before the held values, (p,).
    """

    def __init__(self, system: HybridSystem, numbers: Numbers | None = None, lane: int = 0) -> None:
        self._numbers = many(system, {}) if numbers is None else numbers
        self.system, self._nv = system, system.robot.nv
        self.mechanism, self.law = self._numbers.mechanism, self._numbers.law_of(lane)
        self._lane = lane
        self.numbers = np.array(self._numbers.constants(lane), dtype=float)
        self._why = ""
        self._own = {domain.key: domain for domain in system.domains}
        # the system keeps its domains, so that their ids stay the same
        self._fields = _fields.setdefault(self._numbers.compilation, {})
        self._feet = _feet.setdefault(self._numbers.compilation, {})

    @cached_property
    def start(self) -> tuple[str, tuple[Reset, ...]]:
        """The phase that begins at the section, and the resets that latch the held values."""
        return start(self.system, True)

    def lap(self, y: Array) -> Record:
        """Runs a cycle from a state just after the section, (2 nv,), and returns its record.

        Raises:
            NotDifferentiable: the cycle does not close, or has an event without a derivative.
        """
        phase, resets = self.start
        clock = Clock(0.0, self.system.springs, self.system)
        held = latch_values(
            {}, resets, y[: self._nv].tolist(), y[self._nv :].tolist(), self.law, begins=True, clock=clock
        )
        found = self.motion(phase, y, held)
        if found is None:
            raise NotDifferentiable(f"{PLAIN}: {self._why}")
        return found

    def motion(self, phase: str, y: Array, held: Held) -> Record | None:
        """Runs the motion from the beginning of a phase to the section; returns None if it does not close plainly.

        Args:
            phase: the phase.
            y: state at the beginning of the phase, (2 nv,).
            held: values held at that state.
        """
        runner = self._fast or self._slow
        found, self._why = runner.lap(phase, y, held), runner.why
        return found

    @cached_property
    def _fast(self) -> LoneRunner | None:
        system = self.system
        if not taylor.available() or system.pins:
            return None
        own = Structure(system, system.domains[0], {}, self.mechanism)
        ready = system.robot.planar or next(by_reference(own)) >= CYCLES
        return LoneRunner(self._numbers, self._lane, keep=True) if ready else None

    @cached_property
    def _slow(self) -> ReferenceRunner:
        return ReferenceRunner(with_parameters(self.system, self._numbers.of_lane(self._lane)))

    def field(self, domain: Domain, held: Held) -> TangentField:
        """Returns the tangent field that gives a domain's derivatives."""
        domain = self._own[domain.key]  # a runner's system may have other numbers, and domains of its own
        key = id(domain), shape_of(held)
        if key not in self._fields:
            self._numbers.compilation.watch(domain)
            self._fields[key] = tangent_field(Structure(self.system, domain, held, self.mechanism))
        return self._fields[key]

    def feet(self, toes: tuple[str, ...], grips: tuple[Joints, ...] = ()) -> TangentFeet:
        """Returns the tangent feet that give the derivatives of an impact."""
        if (toes, grips) not in self._feet:
            own = Structure(self.system, self.system.domains[0], {}, self.mechanism)
            self._feet[toes, grips] = tangent_feet(own, toes, grips)
        return self._feet[toes, grips]
