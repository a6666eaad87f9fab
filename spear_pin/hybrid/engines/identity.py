"""What tells functions apart that are compiled: their code, and every value it sees besides its arguments."""

from __future__ import annotations

import sysconfig
from collections.abc import Iterator, Mapping, Set
from functools import cache, partial
from types import CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

INSTALLED = tuple({sysconfig.get_path(kind) for kind in ("stdlib", "purelib", "platlib")})


class Same:
    """A value that equals only itself; it is kept, so that its identity stays its own."""

    def __init__(self, value: Any) -> None:
        self._value = value

    def __hash__(self) -> int:
        return id(self._value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other._value is self._value


class Reader:
    """Says what functions are, and whether what they read has been bound anew since.

    Functions are equal if their code, their defaults, and what they close over and read of globals are: those made
    anew with every system are the same ones, one edited in a notebook is another. A function of an installed library
    that is called is not looked into, nor is an object that is no container.
    """

    def __init__(self) -> None:
        self._globals: dict[tuple[int, str], tuple[Mapping[str, Any], Any]] = {}
        self._functions: dict[int, tuple[FunctionType, Any]] = {}
        self._within: list[FunctionType] = []

    def identity(self, value: Any) -> Any:
        """What equals that of an equal value, and of no other; it can be hashed."""
        if isinstance(value, FunctionType):
            return self._function(value)
        if isinstance(value, MethodType):
            return self.identity(value.__func__), self.identity(value.__self__)
        if isinstance(value, partial):
            return "partial", self.identity(value.func), self.identity(value.args), self.identity(value.keywords)
        if isinstance(value, np.ndarray):
            return "array", value.shape, self.identity(value.tolist())
        if isinstance(value, Mapping):
            return "mapping", frozenset((key, self.identity(item)) for key, item in value.items())
        if isinstance(value, (list, tuple)):
            return type(value), tuple(map(self.identity, value))
        try:
            hash(value)
        except TypeError:
            return frozenset(value) if isinstance(value, Set) else Same(value)
        return value  # equal if it is frozen, else only the same

    def current(self) -> bool:
        """Whether all functions have the code, defaults and globals that they had."""
        return all(_parts(function) == parts for function, parts in self._functions.values()) and all(
            name in namespace and namespace[name] is value for (_, name), (namespace, value) in self._globals.items()
        )

    def _function(self, function: FunctionType) -> Any:
        if self._within and _is_of_a_library(function):
            return Same(function)
        if function in self._within:
            return "recursion", function.__qualname__
        self._within.append(function)
        self._functions[id(function)] = function, _parts(function)
        defaults = function.__defaults__, function.__kwdefaults__
        known = tuple((name, self.identity(value)) for name, value in self._seen(function))
        self._within.pop()
        return function.__code__, self.identity(defaults), known

    def _seen(self, function: FunctionType) -> Iterator[tuple[str, Any]]:
        """Values that it closes over, and globals that it reads, of itself or of a module."""
        names = _names(function.__code__)
        for name, value in [*_closed_over(function), *self._bound(function.__globals__, names)]:
            yield name, value
            if isinstance(value, ModuleType):
                yield from self._bound(vars(value), names)

    def _bound(self, namespace: dict[str, Any], names: frozenset[str]) -> list[tuple[str, Any]]:
        bound = [(name, namespace[name]) for name in sorted(names & namespace.keys())]
        self._globals |= {(id(namespace), name): (namespace, value) for name, value in bound}
        return bound


def _closed_over(function: FunctionType) -> list[tuple[str, Any]]:
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    return [(name, cell.cell_contents) for name, cell in cells if cell != CellType()]


def _is_of_a_library(function: FunctionType) -> bool:
    """Whether it is installed, and not made anew with every system."""
    return function.__code__.co_filename.startswith(INSTALLED) and "<locals>" not in function.__qualname__


def _parts(function: FunctionType) -> tuple[Any, ...]:
    return function.__code__, function.__defaults__, function.__kwdefaults__


@cache
def _names(code: CodeType) -> frozenset[str]:
    """Names of globals and attributes that it reads, also in the functions in it."""
    inner = (_names(part) for part in code.co_consts if isinstance(part, CodeType))
    return frozenset(code.co_names).union(*inner)
