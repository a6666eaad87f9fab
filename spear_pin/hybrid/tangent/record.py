"""Run a cycle and keep its arcs, by the fast engine where heyoka is installed; what is not plain is refused."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from functools import cached_property
from typing import Any
from weakref import WeakKeyDictionary

import numpy as np

from spear_pin.arrays import Array
from spear_pin.hybrid.arc import Arc, Record, Runner
from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain, Held, Reset
from spear_pin.hybrid.engines import taylor
from spear_pin.hybrid.engines.structure import Structure, shape_of
from spear_pin.hybrid.engines.taylor import Code
from spear_pin.hybrid.lanes.compilation import Compilation
from spear_pin.hybrid.lanes.lone_runner import Lap, LoneRunner
from spear_pin.hybrid.lanes.numbers import Numbers
from spear_pin.hybrid.orders import Order
from spear_pin.hybrid.rules.latching import latched
from spear_pin.hybrid.rules.start import start
from spear_pin.hybrid.tangent.fields import TangentFeet, TangentField, tangent_feet, tangent_field
from spear_pin.hybrid.tangent.reference_runner import ReferenceRunner
from spear_pin.hybrid.tangent.resets import NotDifferentiable

PLAIN = "the cycle does not close, or what happens in it is not plain"
TOL = 1e-15
_fields: WeakKeyDictionary[Compilation, dict[Any, TangentField]] = WeakKeyDictionary()
_feet: WeakKeyDictionary[Compilation, dict[tuple[str, ...], TangentFeet]] = WeakKeyDictionary()


def many(system: HybridSystem, given: Mapping[str, Array]) -> Numbers:
    """The numbers of lanes for `Recorder`, which differ in those that are given, (n,) each."""
    # optimised, code would run in half the time, and take twelve times as long to compile
    return Numbers(system, given, Code(TOL, unrolled=system.robot.nv <= taylor.UNROLLED, level=0))


class CompiledRunner:
    """A lane's cycles by the fast engine, see `hybrid.arc.Runner`.

    Args:
        numbers: the lanes'.
        lane: which of them.
    """

    def __init__(self, numbers: Numbers, lane: int) -> None:
        self._runner, self._toes = LoneRunner(numbers, lane, keep=True), len(numbers.system.robot.toes)

    @property
    def why(self) -> str:
        """What the last cycle of which there is no record was refused for."""
        return self._runner.why

    def lap(self, phase: str, y: Array, held: Held) -> Lap | None:
        """The cycle, None where it calls for a second look."""
        return self._runner.lap(phase, y, held, [math.inf] * self._toes)


class Recorder:
    """Cycles of a system, as records.

    Args:
        system: the system.
        numbers: of many lanes, which takes heyoka (default: the system's own alone).
        lane: which of them.

    Attributes:
        planar: the robot's dynamics.
        law: parameters of the law.
        numbers: run-time parameters ahead of what is held, (p,).
        end: state at the end of the last cycle, (2 nv,).
        order: the order of its events.
    """

    def __init__(self, system: HybridSystem, numbers: Numbers | None = None, lane: int = 0) -> None:
        self.system, self._nv = system, system.robot.nv
        self._numbers = many(system, {}) if numbers is None else numbers
        self.planar, self.law = self._numbers.planar, self._numbers.law_of(lane)
        alone = numbers is None and not taylor.available()
        self._runner: Runner = ReferenceRunner(system) if alone else CompiledRunner(self._numbers, lane)
        self.numbers = np.array(self._numbers.constants(lane), dtype=float)
        self.end = np.empty(0)
        self.order: Order = ()
        # the system keeps its domains, so that their identities stay
        self._fields = _fields.setdefault(self._numbers.compilation, {})
        self._feet = _feet.setdefault(self._numbers.compilation, {})

    @cached_property
    def start(self) -> tuple[str, tuple[Reset, ...]]:
        """The phase that begins at the section, and the resets that say what is held."""
        return start(self.system, True)

    def cycle(self, y: Array) -> Sequence[Arc]:
        """The arcs of a cycle from a state just behind the section, (2 nv,).

        Raises:
            NotDifferentiable: it does not close, or what happens in it is not plain.
        """
        lap = self.lap(y)
        self.end, self.order = lap.y, lap.order
        return lap.arcs

    def lap(self, y: Array) -> Record:
        """A cycle from a state just behind the section, (2 nv,).

        Raises:
            NotDifferentiable: it does not close, or what happens in it is not plain.
        """
        phase, resets = self.start
        held = latched({}, resets, y[: self._nv].tolist(), y[self._nv :].tolist(), self.law)
        lap = self.motion(phase, y, held)
        if lap is None:
            raise NotDifferentiable(f"{PLAIN}: {self._runner.why}")
        return lap

    def motion(self, phase: str, y: Array, held: Held) -> Record | None:
        """The motion from the beginning of a phase to the section, None where it does not close plainly.

        Args:
            phase: the phase.
            y: state there, (2 nv,).
            held: what is held there.
        """
        return self._runner.lap(phase, y, held)

    def field(self, domain: Domain, held: Held) -> TangentField:
        """What a domain's derivatives are taken from."""
        key = id(domain), shape_of(held)
        if key not in self._fields:
            self._fields[key] = tangent_field(Structure(self.system, domain, held, self.planar))
        return self._fields[key]

    def feet(self, toes: tuple[str, ...]) -> TangentFeet:
        """What the derivatives of an impact are taken from."""
        if toes not in self._feet:
            self._feet[toes] = tangent_feet(Structure(self.system, self.system.domains[0], {}, self.planar), toes)
        return self._feet[toes]
