"""Identity of functions that are compiled: their code, and every value that it reads besides its arguments."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Mapping, Set
from dis import get_instructions
from functools import cache, partial
from types import CellType, CodeType, FunctionType, MethodType, ModuleType
from typing import Any

import numpy as np

from spear_pin.hybrid.own import INSTALLED

GLOBALS, IMPORTS = frozenset({"LOAD_GLOBAL", "LOAD_NAME"}), frozenset({"IMPORT_NAME"})
ABSENT = object()  # stands for a name that is not bound yet, or is a built-in
ALIKE = (int, float, complex, str)  # types whose equal values are often made anew


class Same:
    """A value that equals only itself; it is kept, so that Python does not reuse its id."""

    def __init__(self, value: Any) -> None:
        self._value = value

    def __hash__(self) -> int:
        return id(self._value)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Same) and other._value is self._value


class Reader:
    """Identifies functions, and tells whether the values that they read have since been rebound or changed in place.

    Two functions are equal if their code, their defaults, their closures and the globals that they read are equal. So
    a function made anew with every system stays the same, and a function edited in a notebook becomes another. A value
    met again is identified by its place. The reader does not look into functions of installed libraries, nor into
    objects that are no containers, except for the object whose method is compiled.
    """

    def __init__(self) -> None:
        self._bindings: dict[tuple[int, str], tuple[Mapping[str, Any], Any]] = {}
        self._met: dict[int, Any] = {}  # functions and mutable containers
        self._functions: list[tuple[FunctionType, CodeType, Any, Any]] = []  # with code and defaults
        self._cells: list[tuple[CellType, Any]] = []  # with what they hold
        self._containers: list[tuple[Any, tuple[Any, ...]]] = []  # with their contents
        self._within = 0  # depth of nested functions

    def identity(self, value: Any) -> Any:
        """Returns a hashable identity of a value; two identities are equal only if their values are."""
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
        """Tells whether all functions still have their code, defaults and globals, and containers their contents."""
        for function, code, defaults, named in self._functions:  # loops, since every batch calls this
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
        if isinstance(value, Mapping):  # a law may depend on its order
            return "mapping", tuple((key, self.identity(item)) for key, item in value.items())
        return type(value), tuple(map(self.identity, value))

    def _function(self, function: FunctionType) -> Any:
        self._within += 1
        defaults = self.identity((function.__defaults__, function.__kwdefaults__))
        known = tuple((name, self.identity(value)) for name, value in self._seen(function))
        self._within -= 1
        return function.__code__, defaults, known

    def _seen(self, function: FunctionType) -> Iterator[tuple[str, Any]]:
        """Yields the values that a function closes over, and the globals that it reads directly or from a module."""
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
    except ValueError:  # the cell is empty
        return ABSENT


def _is_of_a_library(function: FunctionType) -> bool:
    """Tells whether a function is installed with a library, and not made anew with every system."""
    return function.__code__.co_filename.startswith(INSTALLED) and "<locals>" not in function.__qualname__


def _items(value: Any) -> tuple[Any, ...]:
    """Returns everything that can be replaced in a container."""
    if isinstance(value, np.ndarray):
        return *value.shape, *value.ravel().tolist()
    return (*value.keys(), *value.values()) if isinstance(value, Mapping) else tuple(value)


def _alike(some: tuple[Any, ...], others: tuple[Any, ...]) -> bool:
    """Tells whether two tuples hold the same objects or equal numbers."""
    pairs = zip(some, others, strict=False)
    return len(some) == len(others) and all(
        one is other or (type(one) is type(other) and isinstance(one, ALIKE) and one == other) for one, other in pairs
    )


@cache
def _names(code: CodeType, operations: frozenset[str] | None = None) -> frozenset[str]:
    """Returns the names that code and its inner functions read, by some operations or by any."""
    read = (each.argval for each in get_instructions(code) if operations and each.opname in operations)
    inner = (_names(part, operations) for part in code.co_consts if isinstance(part, CodeType))
    return frozenset(read if operations else code.co_names).union(*inner)
