"""Compiles a system's domains and impacts when they are first needed, and keeps them."""

from __future__ import annotations

from collections import Counter, OrderedDict
from functools import cached_property
from typing import Any

from spear_pin.hybrid.automaton import HybridSystem
from spear_pin.hybrid.domain import Domain
from spear_pin.hybrid.engines import structure, taylor
from spear_pin.hybrid.engines.feet import CompiledFeet, compile_feet
from spear_pin.hybrid.engines.identity import Reader
from spear_pin.hybrid.engines.taylor import Code, Ready
from spear_pin.hybrid.engines.taylor_single import CompiledImpact, Single, impact
from spear_pin.hybrid.lanes.groups import Held
from spear_pin.model.equations import mechanism_of

KEPT = 16  # number of systems whose compiled parts are kept


class Compilation:
    """Compiled parts that lanes of a system share, whatever their numbers.

    Args:
        system: the system.
        code: how its domains are compiled.
    """

    def __init__(self, system: HybridSystem, code: Code) -> None:
        structure.check_law(system.law)
        self.system, self.mechanism = system, mechanism_of(system.robot)
        self.robot = structure.robot_numbers(system, self.mechanism)
        self._code = code
        # domains are kept with their compiled form, so that Python does not reuse their ids
        self._domains: dict[Any, Ready] = {}
        self._singles: dict[Any, Single] = {}
        self._entries = Counter[Any]()  # by ids, too: the system keeps its domains
        self._impacts: dict[str, CompiledImpact] = {}
        self._reader = Reader()
        for function in () if system.ground.plane else (system.ground.above, system.ground.axes):
            self._reader.identity(function)

    def current(self) -> bool:
        """Tells whether the functions of the compiled domains are unchanged since they were compiled."""
        return self._reader.current()

    def watch(self, domain: Domain) -> None:
        """Watches the functions of a domain that is compiled."""
        for function in structure.functions(domain):
            self._reader.identity(function)

    def domain(self, domain: Domain, held: Held) -> Ready:
        """Returns a domain compiled for the held values.

        Raises:
            TypeError: the domain cannot be compiled, since a latch branches on a value.
        """
        key = id(domain), structure.shape_of(held)
        if key not in self._domains:
            self.watch(domain)
            one = structure.Structure(self.system, domain, held, self.mechanism)
            self._domains[key] = Ready(domain, taylor.compile_domain(one, self._code))
        return self._domains[key]

    def count_entry(self, domain: Domain, held: Held) -> int:
        """Counts how often a domain is entered for held values of their shape; returns the number."""
        key = id(domain), structure.shape_of(held)
        self._entries[key] += 1
        return self._entries[key]

    def single(self, domain: Domain, held: Held) -> Single:
        """Returns a domain compiled for one lane and for the held values."""
        key = id(domain), structure.shape_of(held)
        if key not in self._singles:
            self._singles[key] = Single(self.domain(domain, held))
        return self._singles[key]

    def impact(self, toe: str) -> CompiledImpact:
        """Returns the compiled impact of a toe."""
        if toe not in self._impacts:
            self._impacts[toe] = impact(self._whole, toe, self._code.level)
        return self._impacts[toe]

    @cached_property
    def feet(self) -> CompiledFeet:
        """The compiled motion of the toes.

        Raises:
            NotSymbolic: the ground does not take symbols.
        """
        return compile_feet(self._whole, self._code.level)

    @cached_property
    def _whole(self) -> structure.Structure:
        return structure.Structure(self.system, self.system.domains[0], {}, self.mechanism)


_kept: OrderedDict[Any, Compilation] = OrderedDict()


def compilation(system: HybridSystem, code: Code) -> Compilation:
    """Returns a system's compilation, and keeps those of the last `KEPT` systems."""
    key = id(system), code
    found = _kept.pop(key, None)
    if found is None or not found.current():
        found = Compilation(system, code)
    _kept[key] = found  # the system is kept with it, so that its identity stays its own
    if len(_kept) > KEPT:
        _kept.popitem(last=False)
    return found
