"""Identity of functions that are compiled: their code, and every value it sees besides its arguments."""

from __future__ import annotations

import sys
import sysconfig
from collections.abc import Iterator, Mapping, Set
from dis import get_instructions
from functools import cache, partial
from types import CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

INSTALLED = tuple({sysconfig.get_path(kind) for kind in ("stdlib", "purelib", "platlib")})
GLOBALS, IMPORTS = frozenset({"LOAD_GLOBAL", "LOAD_NAME"}), frozenset({"IMPORT_NAME"})
ABSENT = object()  # in place of what is not bound yet, or is a built-in
ALIKE = (int, float, complex, str)  # what is often made anew and equal


class Same:
    """A value that equals only itself; it is kept, so that its identity stays its own."""

    def __init__(self, value: Any) -> None:
        self._value = value

    def __hash__(self) -> int:
        return id(self._value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other._value is self._value


class Reader:
    """Says what functions are, and whether what they read has been bound anew, or changed in place, since.

    Functions are equal if their code, their defaults, and what they close over and read of globals are: those made
    anew with every system are the same ones, one edited in a notebook is another. What is met again is told by its
    place. A function of an installed library that is called is not looked into, nor is an object that is no container,
    except that whose method is compiled.
    """

    def __init__(self) -> None:
        self._bindings: dict[tuple[int, str], tuple[Mapping[str, Any], Any]] = {}
        self._met: dict[int, Any] = {}  # functions and mutable containers
        self._functions: list[tuple[FunctionType, CodeType, Any, Any]] = []  # with code and defaults
        self._cells: list[tuple[CellType, Any]] = []  # with what they hold
        self._containers: list[tuple[Any, tuple[Any, ...]]] = []  # with their contents
        self._within = 0  # functions

    def identity(self, value: Any) -> Any:
        """Hashable identity of a value, equal to that of an equal value and of no other."""
        if isinstance(value, MethodType):
            owner = value.__self__
            return self.identity(value.__func__), self.identity(owner), self.identity(getattr(owner, "__dict__", None))
        if isinstance(value, partial):
            return "partial", self.identity(value.func), self.identity(value.args), self.identity(value.keywords)
        if isinstance(value, tuple):
            return type(value), tuple(map(self.identity, value))
        if isinstance(value, FunctionType):
            if self._within and _is_of_a_library(value):
                return Same(value)
        elif not isinstance(value, (np.ndarray, Mapping, list)):
            try:
                hash(value)
            except TypeError:
                return frozenset(value) if isinstance(value, Set) else Same(value)
            return value  # equal if it is frozen, else only the same
        if id(value) in self._met:
            return "met", list(self._met).index(id(value))
        self._met[id(value)] = value
        if isinstance(value, FunctionType):
            self._functions.append((value, value.__code__, value.__defaults__, value.__kwdefaults__))
            self._cells += [(cell, _content(cell)) for cell in value.__closure__ or ()]
            return self._function(value)
        self._containers.append((value, _items(value)))
        return self._contents(value)

    def current(self) -> bool:
        """Whether all functions have the code, defaults and globals that they had, and containers their contents."""
        for function, code, defaults, named in self._functions:  # loops, as it is asked for every batch
            if (
                function.__code__ is not code
                or function.__defaults__ is not defaults
                or function.__kwdefaults__ is not named
            ):
                return False
        for cell, content in self._cells:
            if _content(cell) is not content:
                return False
        for (_, name), (namespace, value) in self._bindings.items():
            if namespace.get(name, ABSENT) is not value:
                return False
        return all(_alike(_items(value), items) for value, items in self._containers)

    def _contents(self, value: Any) -> Any:
        if isinstance(value, np.ndarray):
            return "array", value.shape, self.identity(tuple(value.ravel().tolist()))
        if isinstance(value, Mapping):  # whose order a law may go by
            return "mapping", tuple((key, self.identity(item)) for key, item in value.items())
        return type(value), tuple(map(self.identity, value))

    def _function(self, function: FunctionType) -> Any:
        self._within += 1
        defaults = self.identity((function.__defaults__, function.__kwdefaults__))
        known = tuple((name, self.identity(value)) for name, value in self._seen(function))
        self._within -= 1
        return function.__code__, defaults, known

    def _seen(self, function: FunctionType) -> Iterator[tuple[str, Any]]:
        """Values that it closes over, and globals that it reads, of itself or of a module, imported in it or not."""
        code = function.__code__
        names = _names(code)
        own = self._bound(function.__globals__, _names(code, GLOBALS))
        imported = [(name, sys.modules[name]) for name in sorted(_names(code, IMPORTS) & sys.modules.keys())]
        for name, value in [*_closed_over(function), *own, *imported]:
            yield name, value
            if isinstance(value, ModuleType):
                yield from self._bound(vars(value), names & vars(value).keys())

    def _bound(self, namespace: dict[str, Any], names: frozenset[str]) -> list[tuple[str, Any]]:
        bound = [(name, namespace.get(name, ABSENT)) for name in sorted(names)]
        self._bindings |= {(id(namespace), name): (namespace, value) for name, value in bound}
        return [(name, value) for name, value in bound if value is not ABSENT]


def _closed_over(function: FunctionType) -> list[tuple[str, Any]]:
    contents = map(_content, function.__closure__ or ())
    named = zip(function.__code__.co_freevars, contents, strict=True)
    return [(name, content) for name, content in named if content is not ABSENT]


def _content(cell: CellType) -> Any:
    try:
        return cell.cell_contents
    except ValueError:  # nothing yet
        return ABSENT


def _is_of_a_library(function: FunctionType) -> bool:
    """Whether it is installed, and not made anew with every system."""
    return function.__code__.co_filename.startswith(INSTALLED) and "<locals>" not in function.__qualname__


def _items(value: Any) -> tuple[Any, ...]:
    """Everything that can be replaced in a container."""
    if isinstance(value, np.ndarray):
        return *value.shape, *value.ravel().tolist()
    return (*value.keys(), *value.values()) if isinstance(value, Mapping) else tuple(value)


def _alike(some: tuple[Any, ...], others: tuple[Any, ...]) -> bool:
    """Whether they hold the same objects, or numbers."""
    pairs = zip(some, others, strict=False)
    return len(some) == len(others) and all(
        one is other or (type(one) is type(other) and isinstance(one, ALIKE) and one == other) for one, other in pairs
    )


@cache
def _names(code: CodeType, operations: frozenset[str] | None = None) -> frozenset[str]:
    """Names that it reads, also in the functions in it: by some operations, or as globals, attributes and imports."""
    read = (each.argval for each in get_instructions(code) if operations and each.opname in operations)
    inner = (_names(part, operations) for part in code.co_consts if isinstance(part, CodeType))
    return frozenset(read if operations else code.co_names).union(*inner)
