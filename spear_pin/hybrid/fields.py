"""Numbers in fields of dataclasses, of dataclasses in them, and in tuples."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any, TypeVar

import numpy as np

D = TypeVar("D")
FLOATS = frozenset({float, np.float64})  # the types of most values: checked first, as this is called often
ADDED = "added to "  # begins the names of held values that are added to numbers of the law


def with_fields(instance: D, values: Mapping[str, Any]) -> D:
    """Returns a dataclass with other values in some fields, its own or those of dataclasses in it.

    The values need not be valid numbers. What has no fields, such as the None of a system without a law, stays itself.
    """
    names = field_names(instance)
    if names is None:
        return instance
    other = object.__new__(type(instance))
    for name in names:
        value = getattr(instance, name)
        if name in values:
            value = values[name]
        elif field_names(value) is not None:
            value = with_fields(value, values)
        object.__setattr__(other, name, value)
    return other


def field_names(value: Any) -> tuple[str, ...] | None:
    """Returns the names of a value's fields; None if it is no dataclass."""
    kind: Any = type(value)
    return _field_names(kind)


@cache
def _field_names(kind: Any) -> tuple[str, ...] | None:
    return tuple(field.name for field in fields(kind)) if is_dataclass(kind) else None


def names_of(law: Any) -> set[str]:
    """Returns the names of the fields of a law, and of dataclasses in it."""
    inner = [getattr(law, field.name) for field in fields(law)]
    nested = [names_of(part) for part in inner if is_dataclass(part) and not isinstance(part, type)]
    return {field.name for field in fields(law)}.union(*nested)


def adjust_law(law: D, held: Mapping[str, Any]) -> D:
    """Returns the parameters of a law with the held values added that are meant for them, see `ADDED`."""
    added = {name.removeprefix(ADDED): value for name, value in held.items() if name.startswith(ADDED)}
    if not added:
        return law
    return with_fields(law, {name: value_in(law, name) + value for name, value in added.items()})


def value_in(law: Any, name: str) -> Any:
    """Returns the value of a field of a dataclass, or of a dataclass in it, by its name."""
    if name in vars(law):
        return getattr(law, name)
    inner = [part for part in vars(law).values() if is_dataclass(part) and not isinstance(part, type)]
    return next(value_in(part, name) for part in inner if name in names_of(part))


def flatten(values: Collection[Any]) -> list[Any]:
    """Returns the numbers among values, in nested tuples of values and in fields of dataclasses, in their order."""
    if FLOATS.issuperset(map(type, values)):
        return list(values)
    flat: list[Any] = []
    for value in values:
        if isinstance(value, tuple):
            flat += flatten(value)
        elif (names := field_names(value)) is not None:
            flat += flatten([getattr(value, name) for name in names])
        elif is_number(value):
            flat.append(value)
    return flat


def map_nested(function: Callable[[Any], Any], value: Any) -> Any:
    """Applies a function to a value, or to all values in nested tuples."""
    return tuple(map_nested(function, each) for each in value) if isinstance(value, tuple) else function(value)


def is_number(value: Any) -> bool:
    """Tells whether a value is a number of any kind, or a symbol."""
    return not (value is None or isinstance(value, (bool, str)))
