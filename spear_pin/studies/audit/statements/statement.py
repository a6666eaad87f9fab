"""A statement of the source, and what checking it finds."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any, Literal, TypeAlias, get_args

from spear_pin.errors import BadValue
from spear_pin.studies.audit.statements.assumptions import ASSUMPTIONS, Assumption, Other
from spear_pin.studies.audit.statements.criteria import Criterion, Value

Verdict = Literal["agrees", "differs", "by construction", "cannot be known", "failed"]
VERDICTS: tuple[Verdict, ...] = get_args(Verdict)
RULES: dict[Verdict, str] = {
    "agrees": "The numbers found meet the criterion that stands beside them; where they rest on an assumption, with "
    "each of its alternatives, too.",
    "differs": "They do not, with none of the alternatives.",
    "by construction": "They meet it, and could not do otherwise: the model, the law, the robot's file or the choice "
    "of a motor was made from the very statement. That is no evidence for it.",
    "cannot be known": "It rests on something that the source does not print and that one of ours stands in for, its "
    "records, its motors, its gaits; or the criterion is met with some alternatives and not with others; or the "
    "source gives no measure.",
    "failed": "Its numbers could not be made, or what holds by construction does not.",
}
Study: TypeAlias = "Callable[[], Value] | partial[Value]"


@dataclass(frozen=True)
class Statement:
    """Statement of the source, and how it is checked.

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
        built: why its numbers could not meet the criterion any less, if so: it then holds by construction.
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
    built: str = ""
    remark: str = ""
    assumes: tuple[str, ...] = ()
    exhibit: str = ""

    @property
    def command(self) -> str:
        """Line to type to have the numbers again; empty where there is no study."""
        return "" if self.study is None else command_of(self.study)

    @property
    def assumptions(self) -> tuple[Assumption, ...]:
        """Assumptions that the numbers rest on."""
        return tuple(assumption for assumption in ASSUMPTIONS if assumption.id in self.assumes)

    @property
    def others(self) -> tuple[Other, ...]:
        """Alternatives that the numbers are looked at with, too; none where there is nothing to judge."""
        if self.unknown or self.built or self.criterion is None:
            return ()
        return tuple(other for assumption in self.assumptions for other in assumption.others)


@dataclass(frozen=True)
class Case:
    """Numbers of a statement with something else assumed.

    Attributes:
        label: what.
        value: the numbers.
        holds: whether they meet the criterion.
    """

    label: str
    value: Value
    holds: bool


@dataclass(frozen=True)
class Finding:
    """Result of checking a statement.

    Attributes:
        id: of the statement.
        value: the numbers; None where there are none.
        verdict: by `RULES`.
        reason: why it failed, cannot be known or holds by construction; else empty.
        cases: the numbers with what else could be assumed.
    """

    id: str
    value: Value | None
    verdict: Verdict
    reason: str = ""
    cases: tuple[Case, ...] = ()

    @classmethod
    def of(cls, data: dict[str, Any]) -> Finding:
        """From `dataclasses.asdict` by way of JSON, which has lists for tuples."""
        cases = tuple(Case(**case | {"value": _value(case["value"])}) for case in data["cases"])
        return cls(**data | {"value": _value(data["value"]), "cases": cases})


def check(statement: Statement) -> Finding:
    """Make the numbers of a statement and judge it by `RULES`; what goes wrong is part of the finding."""
    value: Value | None = None
    others: list[tuple[Other, Value]] = []
    if statement.study is not None:
        try:
            value = _numbers(statement.study)
            others = [(other, _numbers(partial(statement.study, **dict([other.given])))) for other in statement.others]
        except Exception as error:  # one row of a report must not take the others with it
            return Finding(statement.id, None, "failed", f"{type(error).__name__}: {error}")
    if statement.unknown or statement.criterion is None or value is None:
        return Finding(statement.id, value, "cannot be known", statement.unknown)
    met = statement.criterion.holds(value)
    if statement.built:
        if met:
            return Finding(statement.id, value, "by construction", statement.built)
        return Finding(statement.id, value, "failed", f"not so, though by construction: {statement.built}")
    if standing_in := [assumption.what for assumption in statement.assumptions if assumption.stands_in]:
        return Finding(statement.id, value, "cannot be known", f"Not in the source: {'; '.join(standing_in)}.")
    cases = tuple(Case(other.label, found, statement.criterion.holds(found)) for other, found in others)
    if {case.holds for case in cases} <= {met}:
        return Finding(statement.id, value, "agrees" if met else "differs", cases=cases)
    return Finding(
        statement.id, value, "cannot be known", "It depends on what is assumed: the criterion is met by some.", cases
    )


def _value(data: Any) -> Any:
    return tuple(data) if isinstance(data, list) else data


def _numbers(study: Callable[..., Any]) -> Value:
    """Numbers that a study finds as plain ones, NumPy's too; each finite."""
    value = study()
    numbers = tuple(map(float, value)) if isinstance(value, tuple) else float(value)
    if not all(map(math.isfinite, numbers if isinstance(numbers, tuple) else (numbers,))):
        raise BadValue("what is found", numbers, "finite")
    return numbers


def command_of(function: Callable[..., object]) -> str:
    """The line for a shell that calls a function of a module, or a partial of one, and prints what it returns."""
    whole = function if isinstance(function, partial) else partial(function)
    words = [*map(repr, whole.args), *(f"{name}={value!r}" for name, value in whole.keywords.items())]
    name = whole.func.__name__
    call = f"from {whole.func.__module__} import {name}; print({name}({', '.join(words)}))"
    return f'python -c "{call}"'
