"""A statement of the source, and what checking it finds."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Literal, TypeAlias, get_args

from spear_pin.studies.statements.criteria import Criterion, Value

Verdict = Literal["agrees", "differs", "cannot be known", "failed"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
Study: TypeAlias = "Callable[[], Value] | partial[Value]"


@dataclass(frozen=True)
class Statement:
    """What the source states, and how it is checked.

    Attributes:
        id: that it is called by.
        place: where the source states it.
        says: what, in words of our own.
        finds: what the numbers of `study` are.
        study: a function of a module, or a `functools.partial` of one, that finds them; None where nothing can be.
        unit: of these numbers.
        printed: the source's number; None where it has none.
        criterion: what the numbers have to meet; None where the source gives nothing to hold them against.
        unknown: why it cannot be known, if so.
        remark: what else a reader should know.
        assumes: ids of the assumptions that the numbers rest on.
        exhibit: id of the figure or table that shows it, if one does.
    """

    id: str
    place: str
    says: str
    finds: str = ""
    study: Study | None = None
    unit: str = ""
    printed: Value | None = None
    criterion: Criterion | None = None
    unknown: str = ""
    remark: str = ""
    assumes: tuple[str, ...] = ()
    exhibit: str = ""

    @property
    def command(self) -> str:
        """What to type to have the numbers again; empty where there is no study."""
        return "" if self.study is None else command_of(self.study)


@dataclass(frozen=True)
class Finding:
    """What checking a statement finds.

    Attributes:
        id: of the statement.
        value: the numbers; None where there are none.
        verdict: whether they meet the criterion.
        reason: why it failed or cannot be known; else empty.
    """

    id: str
    value: Value | None
    verdict: Verdict
    reason: str = ""


def check(statement: Statement) -> Finding:
    """Make the numbers of a statement and hold them against its criterion; what goes wrong is part of the finding."""
    value: Value | None = None
    if statement.study is not None:
        try:
            value = _floats(statement.study())
        except Exception as error:  # one row of a report must not take the others with it
            return Finding(statement.id, None, "failed", f"{type(error).__name__}: {error}")
        if not all(map(math.isfinite, value if isinstance(value, tuple) else (value,))):
            return Finding(statement.id, None, "failed", f"not a finite number: {value}")
    if statement.unknown or statement.criterion is None or value is None:
        return Finding(statement.id, value, "cannot be known", statement.unknown)
    return Finding(statement.id, value, "agrees" if statement.criterion.holds(value) else "differs")


def _floats(value: Value) -> Value:
    """Plain numbers, of NumPy's too."""
    return tuple(map(float, value)) if isinstance(value, tuple) else float(value)


def command_of(function: Callable[..., object]) -> str:
    """The line for a shell that calls a function of a module, or a partial of one, and prints what it returns."""
    whole = function if isinstance(function, partial) else partial(function)
    words = [*map(repr, whole.args), *(f"{name}={value!r}" for name, value in whole.keywords.items())]
    name = whole.func.__name__
    call = f"from {whole.func.__module__} import {name}; print({name}({', '.join(words)}))"
    return f'python -c "{call}"'
