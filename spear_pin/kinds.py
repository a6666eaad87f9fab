"""Arguments of the wrong kind, refused by what the annotations say before anything is done with them.

Not by beartype or typeguard: they take neither symbols nor NumPy's scalars for numbers, nor lists for tuples, and say
in paragraphs what has to be one line.
"""

from __future__ import annotations

import inspect
import os
import types
import typing
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import cache, wraps
from numbers import Real
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, cast

import numpy as np
from numpy.typing import ArrayLike

from spear_pin.errors import BadValue, SpearError

T = TypeVar("T", bound=Callable[..., Any])


class Kind(NamedTuple):
    """Values an annotation accepts, its words, and whether it is a number, of which functions say more themselves."""

    accepts: Callable[[Any], bool]
    words: str
    numeric: bool = False


def typed(target: T) -> T:
    """A function that raises `BadValue` for an argument of the wrong kind; a dataclass, for a field.

    Kinds are classes, numbers (symbols count as such), texts, collections and functions. What an annotation says
    beyond that, such as an array's shape, is left to the function; and so are numbers and a dataclass's fields at
    first, for a check of its own says which are valid.
    """
    if isinstance(target, type):
        kind: Any = target
        kind.__init__ = _built(kind.__init__, f"{kind.__name__}.")
        return target
    return cast(T, _called(target))


def _called(function: Any) -> Any:
    check = _check(function, "")

    @wraps(function)
    def called(*arguments: Any, **named: Any) -> Any:
        check(arguments, named, False)
        try:
            return function(*arguments, **named)
        except SpearError:
            raise
        except Exception:
            check(arguments, named, True)
            raise

    return called


def _built(function: Any, prefix: str) -> Any:
    check = _check(function, prefix)

    @wraps(function)
    def built(*arguments: Any, **named: Any) -> None:
        try:
            function(*arguments, **named)
        except SpearError:
            raise
        except Exception:
            check(arguments, named, True)
            raise
        check(arguments, named, True)

    return built


def _check(function: Any, prefix: str) -> Callable[[tuple[Any, ...], dict[str, Any], bool], None]:
    """Raises `BadValue` for the first argument of the wrong kind, of numbers only if they are meant too."""
    signature = inspect.signature(function)

    @cache
    def kinds() -> dict[str, Kind]:
        found = {name: _kind(_evaluated(each, function)) for name, each in signature.parameters.items()}
        return {name: kind for name, kind in found.items() if kind is not None}

    def check(arguments: tuple[Any, ...], named: dict[str, Any], numbers: bool) -> None:
        try:
            given = signature.bind(*arguments, **named).arguments
        except TypeError:  # the function says it better
            return
        for name, kind in kinds().items():
            if name in given and (numbers or not kind.numeric) and not kind.accepts(given[name]):
                raise BadValue(f"{prefix}{name}", given[name], kind.words) from None

    return check


def _evaluated(parameter: inspect.Parameter, function: Any) -> Any:
    """The annotation; Any where there is none, or it names what is imported for type checkers only."""
    if parameter.annotation is parameter.empty or parameter.kind in (parameter.VAR_POSITIONAL, parameter.VAR_KEYWORD):
        return Any
    try:
        return eval(parameter.annotation, vars(inspect.getmodule(function)))
    except NameError:
        return Any


def _kind(annotation: Any) -> Kind | None:
    if annotation is Any or annotation is object:
        return None
    if annotation in PLAIN:
        return PLAIN[annotation]
    origin = typing.get_origin(annotation)
    if origin in (typing.Union, types.UnionType):
        return _either([_kind(part) for part in typing.get_args(annotation)])
    parts = typing.get_args(annotation)
    if origin in (Sequence, Iterable) and parts == (str,):
        return Kind(_are_names, "names")
    if origin is tuple:
        return _tuple(parts)
    if origin is Mapping:
        return _mapping(_kind(parts[1]))
    if origin in COLLECTIONS:
        return COLLECTIONS[origin]
    if isinstance(annotation, type) and origin is None and _can_be_asked(annotation):
        article = "an" if annotation.__name__[0] in "AEIOU" else "a"
        return Kind(lambda value: isinstance(value, annotation), f"{article} {annotation.__name__}")
    return None


def _either(kinds: list[Kind | None]) -> Kind | None:
    known = [kind for kind in kinds if kind is not None]
    if len(known) < len(kinds):
        return None
    words, numeric = " or ".join(kind.words for kind in known), any(kind.numeric for kind in known)
    return Kind(lambda value: any(kind.accepts(value) for kind in known), words, numeric)


def _tuple(parts: tuple[Any, ...]) -> Kind:
    """Of so many items, or of any number, each of its kind."""
    if parts[-1] is Ellipsis:
        item = _kind(parts[0])
        words = "a tuple" + (f", each item {item.words}" if item else "")
        return Kind(lambda value: _is_sized(value) and (item is None or all(map(item.accepts, value))), words)
    kinds = [_kind(part) for part in parts]

    def accepts(value: Any) -> bool:
        fits = _is_sized(value) and len(value) == len(kinds)
        return fits and all(kind is None or kind.accepts(item) for kind, item in zip(kinds, value, strict=True))

    words = ", ".join(kind.words if kind else "an array" for kind in kinds)
    return Kind(accepts, f"a tuple of {words}")


def _mapping(item: Kind | None) -> Kind:
    def accepts(value: Any) -> bool:
        return isinstance(value, Mapping) and (item is None or all(map(item.accepts, value.values())))

    return Kind(accepts, f"a mapping to {item.words}" if item else "a mapping")


def _can_be_asked(annotation: Any) -> bool:
    """Whether what is an instance can be told."""
    return not getattr(annotation, "_is_protocol", False) or getattr(annotation, "_is_runtime_protocol", False)


def _is_sized(value: Any) -> bool:
    return hasattr(value, "__len__") and not isinstance(value, (str, bytes, Mapping))


def _are_numbers(value: Any) -> bool:
    try:
        return np.asarray(value).dtype.kind in "fiuc"
    except (TypeError, ValueError):
        return False


def _is_number(value: Any) -> bool:
    """Whether it is one, or a symbol for one."""
    if isinstance(value, (bool, np.bool_, complex, Mapping)):
        return False
    return isinstance(value, Real) or (hasattr(value, "__neg__") and not getattr(value, "shape", ()))


def _are_names(value: Any) -> bool:
    """Whether it has some; who looks them up says which is none."""
    return isinstance(value, Iterable) and not isinstance(value, (str, bytes, Mapping))


def _instance(*classes: type) -> Callable[[Any], bool]:
    return lambda value: isinstance(value, classes)


PLAIN: dict[Any, Kind] = {
    float: Kind(_is_number, "a number", True),
    int: Kind(lambda value: _is_number(value) and value % 1 == 0, "a whole number", True),
    ArrayLike: Kind(_are_numbers, "numbers"),
    bool: Kind(lambda value: isinstance(value, bool) or type(value).__name__ == "bool", "True or False"),
    str: Kind(_instance(str), "a text"),
    Path: Kind(_instance(os.PathLike), "a path"),
    None: Kind(lambda value: value is None, "None"),
    type(None): Kind(lambda value: value is None, "None"),
}
COLLECTIONS: dict[Any, Kind] = {
    Sequence: Kind(_is_sized, "a sequence"),
    Iterable: Kind(_instance(Iterable), "an iterable"),
    Callable: Kind(callable, "a function"),
}
